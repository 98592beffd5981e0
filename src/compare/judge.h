/* Somebody's image against the reference, pixel by pixel: is each value what storing the right one
 * in their format gives, or near enough? */
#ifndef PEEL_COMPARE_JUDGE_H
#define PEEL_COMPARE_JUDGE_H

#include "compare/given.h"

typedef struct JudgeDesc {
    const Image *theirs;    /* FORMAT_RGBA32F, encoded, as GivenReading.encoded */
    const Image *reference; /* FORMAT_RGBA32F, linear, of the same size */
    /* The reference's own 8-bit display, FORMAT_RGBA8; NULL: none. For the count of equal values.
     */
    const Image *display;
    /* FORMAT_RGBA32F, linear: their values may be this far from these. Both NULL: from the
     * reference by `tolerance`. Where slack is infinite, too. */
    const Image *center, *slack;
    GivenEncoding encoding;               /* of their first three channels */
    PixelFormat format, reference_format; /* what each side stores */
    int channels;                         /* that are compared: the first 1 … 4 */
    double tolerance;                     /* relative to max(1, |value|) */
} JudgeDesc;

/* The value that differs most: encoded as theirs. */
typedef struct JudgeWorst {
    bool is;
    int x, y, channel;
    double theirs, reference;
    double ulp; /* representable values between them in their format; −1: one is no number */
} JudgeWorst;

/* Every pixel is counted once, by its worst channel. */
typedef struct JudgeFigures {
    uint64_t pixels;
    uint64_t occupied;  /* where the reference is unlike its top left pixel */
    uint64_t equal;     /* the same bits */
    uint64_t stored;    /* what storing in their format explains */
    uint64_t within;    /* the tolerance or the bound beyond that */
    uint64_t edge;      /* not within, but between the values of the reference's 3×3 pixels around:
                         * an outline that lies a little elsewhere */
    uint64_t beyond;    /* none of these; nonfinite ones included */
    uint64_t nonfinite; /* theirs is NaN or infinite and the reference is not */
    double max_abs;     /* encoded, of finite values */
    double rmse;        /* the same, over the compared channels */
    double correlation; /* of brightness, −1 … 1; 1 where one side has only one */
    JudgeWorst worst;   /* of the pixels beyond; else of those at edges, else of all that are not
                         * equal */
    bool agree;
} JudgeFigures;

/* Agree: of the occupied pixels at most one in a hundred is at an edge, and one in ten thousand, or
 * 4 of at least 400, beyond: outlines and crossings that another rasterizer puts elsewhere.
 * NO_MEMORY is possible. */
Result judge(const JudgeDesc *desc, JudgeFigures *out);

#endif

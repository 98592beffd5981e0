/* Which known mistake explains somebody's image.
 *
 * Every mistake of the catalogue (frame/mutation.h), and pairs of the best ones where none explains
 * all, is rendered by ref with the same settings, brought into the form of their file (study/fit.h)
 * and compared with it. explains = 1 − squared residual / that of the reference as it is, from 0 to
 * 1, each pixel's residual capped so that a few strays decide nothing.
 *
 * A mistake explains exactly where no value is beyond quantisation. Nothing is guessed between
 * mistakes that make the same file, or that both explain exactly: they are reported as equals. */
#ifndef PEEL_STUDY_DIAGNOSE_H
#define PEEL_STUDY_DIAGNOSE_H

#include "compare/given.h"
#include "frame/frame.h"
#include "frame/mutation.h"

/* A mistake that explains less is not named: see README for what was measured. */
#define DIAGNOSE_EXPLAINS 0.95

typedef enum DiagnoseVerdict {
    DIAGNOSE_AGREES = 0,
    DIAGNOSE_MISTAKE,
    DIAGNOSE_UNKNOWN
} DiagnoseVerdict;

/* Why it agrees, or does not. */
typedef enum DiagnoseReason {
    DIAGNOSE_QUANTISED = 0, /* agrees: no value is beyond quantisation */
    DIAGNOSE_TOLERATED,     /* agrees: few pixels are beyond the tolerance (fit_tolerates) */
    DIAGNOSE_COLORS,        /* agrees so far as colours go; their alpha is neither meaning */
    DIAGNOSE_EXACT,         /* mistake: explains exactly */
    DIAGNOSE_NEARLY,        /* mistake: explains at least DIAGNOSE_EXPLAINS */
    DIAGNOSE_NOTHING        /* unknown */
} DiagnoseReason;

/* One mistake, or two. */
typedef struct DiagnoseRow {
    uint64_t mutations; /* bits of mutation_bit */
    double explains;
    uint64_t beyond;   /* pixels with a value beyond quantisation; 0: explains exactly */
    GivenMeaning form; /* in which their image fits it best */
    double squares;    /* of residuals, see study/fit.h */
    int group;         /* the same number: the same file */
    int rank;          /* from 1; equals have the same */
} DiagnoseRow;

/* The pixel at which the two best differ most in how far they are from theirs; stored values. */
typedef struct DiagnosePixel {
    int x, y; /* from the top left */
    float theirs[4], reference[4], first[4], second[4];
} DiagnosePixel;

typedef enum DiagnoseClass {
    DIAGNOSE_PIXEL_AGREES = 0,   /* the reference is within quantisation */
    DIAGNOSE_PIXEL_EXPLAINED,    /* the best mistake is, the reference is not */
    DIAGNOSE_PIXEL_NEARER,       /* neither; the mistake is nearer by half or more */
    DIAGNOSE_PIXEL_UNEXPLAINED,  /* neither */
    DIAGNOSE_PIXEL_CONTRADICTED, /* the reference is, the mistake is not */
    DIAGNOSE_PIXEL_CLASSES
} DiagnoseClass;

typedef struct Diagnosis {
    DiagnoseVerdict verdict;
    DiagnoseReason reason;
    GivenMeaning form;                  /* of the best mistake; else of the reference */
    PixelFormat format;                 /* of their file */
    char described[128];                /* their file and what it was taken for */
    uint64_t pixels, beyond, over, far; /* of the reference: as in FitResult */
    uint64_t nonfinite;         /* theirs that are NaN or infinite: no rendering explains them */
    DiagnoseRow *rows;          /* by rank; mistakes that change nothing here left out */
    size_t count, equals;       /* equals: how many share the first rank */
    uint64_t invisible;         /* mistakes that change nothing of what their file holds */
    size_t rendered;            /* images of ref */
    bool has_pixel, has_second; /* has_second: else second is the reference */
    DiagnosePixel pixel;
    size_t second; /* row */
    /* FORMAT_RGBA32F, rows from the top: values as their file stores them, alpha 1 where it means
     * nothing. best is the reference where it agrees, or no mistake explains anything. */
    Image theirs, reference, best;
    uint8_t *classes; /* a DiagnoseClass for every pixel */
    uint64_t class_counts[DIAGNOSE_PIXEL_CLASSES];
    double time_ms;
} Diagnosis;

/* given: of desc's size, else INTERNAL; desc: of METHOD_PEEL or METHOD_FORWARD, without mutations,
 * else BAD_INPUT. options: what is known of their image's meaning. Renders up to MUTATION_COUNT
 * and 15 more images, one after the other. The caller frees with diagnose_free; on failure there
 * is nothing to free. */
Result diagnose_run(const Scene *scene, const RenderDesc *desc, const GivenImage *given,
                    const GivenMeaning *options, Renderer ref, Diagnosis *out);
void diagnose_free(Diagnosis *diagnosis);

/* "not-premultiplied", "peel-bias-1e-4 + layers-reversed". */
enum {
    DIAGNOSE_NAME = 80
};
const char *diagnose_name(uint64_t mutations, char out[DIAGNOSE_NAME]);
const char *diagnose_verdict_name(DiagnoseVerdict verdict); /* "agrees", …; static */
const char *diagnose_class_text(DiagnoseClass class);       /* one line; static */

#endif

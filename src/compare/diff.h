/* Two images, value by value: what idiff says of them, and the distance in stored values.
 *
 * Source of the thresholds and of the figures' names: OpenImageIO's idiff 2.4. A value that is NaN
 * or infinite is counted, and left out of all averages. NaN on both sides is equal, and so are
 * infinities of one sign; not finite against anything else is always a failure. */
#ifndef PEEL_COMPARE_DIFF_H
#define PEEL_COMPARE_DIFF_H

#include "image/deep.h"
#include "image/planes.h"

/* A value is over a threshold when its error exceeds both `absolute` and `relative` times the mean
 * of the two magnitudes; a pixel is when one of its values is. */
typedef struct DiffThreshold {
    double absolute, relative;
    double percent;   /* of the pixels that may be over */
    uint64_t allowed; /* or so many */
    double hard;      /* no error may exceed it, whatever is allowed */
} DiffThreshold;

typedef struct DiffOptions {
    DiffThreshold fail, warn;
    bool warn_always; /* else only where some pixel is over `fail`, as idiff 2.4 has it */
    bool perceptual;  /* test, too, whether the difference is seen (compare/perceive.h) */
    int worst;        /* pixels to keep, from 0 */
    size_t max_bytes; /* of an image in memory, and of the perceptual test; 0: no limit */
} DiffOptions;

DiffOptions diff_options_default(void); /* idiff's: 1e-6, nothing allowed, no hard limit */

typedef enum DiffVerdict {
    DIFF_PASS = 0,
    DIFF_WARNING,
    DIFF_FAILURE
} DiffVerdict;

enum {
    DIFF_SIDES = 2,
    DIFF_BINS = 7, /* of distances: 0, 1, 2 to 3, 4 to 15, 16 to 255, 256 to 65535, more */
    DIFF_WORST_MAX = 10000
};

const char *diff_bin_text(int bin); /* "0", "1", "2-3", …; static */

/* How a channel differs. Errors are |a − b|; a channel that one side lacks is 0 there. */
typedef struct DiffChannel {
    char *name; /* without control characters, as a part's */
    const char *kinds[DIFF_SIDES]; /* "float", "half", "unorm8", …; NULL where it is missing */
    uint64_t values;
    uint64_t differing; /* not the same stored value; NaN equals NaN */
    uint64_t nan[DIFF_SIDES], infinite[DIFF_SIDES];
    uint64_t finite;             /* values finite on both sides: those the averages are of */
    double mean, rms, psnr, max; /* psnr: for the greater of 1 and the greatest magnitude; NaN
                                    where nothing is finite */
    bool has_max;                /* some error is not 0 */
    int max_x, max_y;            /* where max is first */
    /* Distances in representable values: of the stored ones where both sides store the same kind,
     * else of floats; a NaN against a number has none. has_ulp: false where a side is missing. */
    bool has_ulp;
    uint32_t max_ulp;
    uint64_t bins[DIFF_BINS];
} DiffChannel;

/* A pixel of the table of the worst, or the place of the greatest finite error. */
typedef struct DiffPixel {
    int x, y, channel;
    uint32_t sample; /* of a deep pixel */
    double error;    /* INFINITY where one side alone is not finite, or the counts differ */
    bool counts;     /* of samples differ: no channel's values */
    bool has_ulp;    /* not where one side alone is NaN */
    uint32_t ulp;    /* of the channel */
    double *values[DIFF_SIDES]; /* of all channels; the part's */
} DiffPixel;

/* What a pixel is, in DiffPart.flags. */
enum {
    DIFF_DIFFERS = 1, /* some stored value does */
    DIFF_OVER_WARN = 2,
    DIFF_OVER_FAIL = 4
};

typedef struct DiffPart {
    char *name; /* "" of an only part */
    bool deep;
    bool lacks[DIFF_SIDES];        /* one side has no such part: a failure, and all else is 0 */
    int x, y, width, height;       /* of the pixels, in the file's coordinates */
    uint64_t pixels, differing;    /* pixels with a stored value that does */
    uint64_t over_warn, over_fail; /* pixels */
    uint64_t broken;               /* pixels not finite on one side alone, or of two counts */
    uint64_t values, differing_values, nonfinite[DIFF_SIDES]; /* values, over all channels */
    int first[3]; /* x, y, channel of the first value that differs as it is stored, if one does */
    /* Over all channels, as in DiffChannel, but for integers (ids) beside others: where these
     * differ a pixel is over the thresholds, but by how much says nothing. */
    double mean, rms, psnr, max;
    DiffPixel max_at; /* has values where max > 0 */
    DiffChannel *channels;
    int channel_count;
    DiffPixel *worst; /* by error, greatest first, then in reading order */
    int worst_count;
    double *values_block;
    uint8_t *flags; /* width · height, row 0 at the top */
    float *errors;  /* likewise: a pixel's greatest error; NaN where it is infinite or none */
    uint64_t samples[DIFF_SIDES]; /* deep: in all */
    uint64_t counts_differ;       /* deep: pixels with another number of samples */
    int count_at[2];              /* the first of them */
    uint32_t counts_there[DIFF_SIDES];
    char *not_compared[DIFF_SIDES]; /* deep: channels of one side, commas between; NULL: none */
    bool perceived;                 /* it was tested whether the difference is seen */
    uint64_t seen; /* and in so many pixels it is: a failure beyond fail.percent of them */
    DiffVerdict verdict;
} DiffPart;

/* a and b: of one size, with one channel in common at least. Of the names all that either has,
 * those of a first. The caller frees with diff_part_free, after NO_MEMORY too. */
Result diff_planes(const Planes *a, const Planes *b, const DiffOptions *options, DiffPart *out);

/* Z, R, G, B, A, and depth.window, materialid and primitiveid where both sides have them, or of
 * these only `channels` (commas between; NULL: all): of all samples of the pixels that have equally
 * many on both sides. Others differ and fail. BAD_INPUT for a channel that is not compared,
 * NO_MEMORY; the caller frees *out, after a failure too. */
Result diff_deep(const DeepImage *a, const DeepImage *b, const char *channels,
                 const DiffOptions *options, DiffPart *out);

void diff_part_free(DiffPart *part);
/* Only the figures stay. */
void diff_part_release_pixels(DiffPart *part);

/* (a − b) · scale of every channel, or its magnitude, as floats, in the window of a. The caller
 * frees *out. */
Result diff_image(const Planes *a, const Planes *b, double scale, bool magnitude, Planes *out);

#endif

/* Folding pairs of stored values into the figures of a DiffPart. Private to compare/diff*.c. */
#ifndef PEEL_COMPARE_DIFF_FOLD_H
#define PEEL_COMPARE_DIFF_FOLD_H

#include "compare/diff.h"

/* How a channel is stored. */
typedef struct FoldChannel {
    const char *name;
    bool has[DIFF_SIDES]; /* where it is missing its bits are 0, which is 0 in every kind */
    FormatKind kind[DIFF_SIDES];
    uint32_t unorm_max[DIFF_SIDES];
} FoldChannel;

typedef struct FoldSums {
    double sum, squares, peak;
} FoldSums;

typedef struct Fold {
    const DiffOptions *options;
    const FoldChannel *channels;
    DiffPart *part;
    FoldSums *sums;  /* of each channel */
    bool integers;   /* there is nothing else: they count in the part's averages */
    int capacity;    /* of part->worst */
    double greatest; /* error of all channels, integers too */
    bool broken, over_fail;
    uint8_t flags;
    DiffPixel pixel; /* the one being folded */
} Fold;

/* *part: zeroed but for name, deep and the size. The channels must outlive the fold. The caller
 * frees with fold_free, and *part with diff_part_free, after NO_MEMORY too. */
Result fold_begin(const DiffOptions *options, const FoldChannel *channels, int count,
                  DiffPart *part, Fold *out);

/* For each pixel in reading order: begin, its values (sample: of a deep pixel), end. */
void fold_pixel(Fold *fold, int x, int y);
void fold_value(Fold *fold, int index, uint32_t sample, uint32_t a_bits, uint32_t b_bits);
void fold_break(Fold *fold); /* the pixel cannot be compared: it fails */
void fold_pixel_end(Fold *fold);

/* A stored value of one side, as bits. */
typedef uint32_t (*FoldFetch)(const void *context, int side, int channel, const DiffPixel *pixel);

/* The averages, the verdict, and the values of the pixels in the table. */
Result fold_finish(Fold *fold, FoldFetch fetch, const void *context);
void fold_free(Fold *fold);

#endif

/* Figures of the difference between two buffers or images. Nothing here knows who drew what. */
#ifndef PEEL_COMPARE_METRICS_H
#define PEEL_COMPARE_METRICS_H

#include "compare/structure.h"
#include "frame/frame.h"
#include "image/image.h"

#include <stdbool.h>
#include <stdint.h>

/* Difference of one named trace buffer, channel value by channel value. */
typedef struct BufferMetrics {
    char name[48];
    uint64_t values;    /* compared */
    uint64_t differing; /* stored bits differ, two NaNs apart */
    uint32_t max_ulp;   /* greatest distance in representable values */
    double max_abs;     /* greatest absolute difference; unorm scaled to [0, 1] */
    bool has_first;
    int first[3]; /* x, y, channel of the first differing value, from the top left */
} BufferMetrics;

/* Difference of two final images over R, G, B and A. */
typedef struct FinalMetrics {
    uint64_t pixels;
    uint64_t differing; /* pixels with any differing bit */
    uint64_t nonfinite; /* pixels where a or b is NaN or infinite: left out of the averages */
    double max_abs, mean_abs, rmse; /* over channel values */
    double psnr; /* dB for peak 1; INFINITY when equal, NaN when no pixel is finite */
    uint32_t max_ulp;
} FinalMetrics;

/* Difference where both sides see the same fragments in the same order. */
typedef struct UnaffectedMetrics {
    uint64_t pixels;   /* with the same structure */
    uint64_t occupied; /* of those, with a fragment: the others show only the background */
    double max_abs;
    double max_rel; /* relative to max(1, |b|) */
    /* 99th percentile of a pixel's greatest relative difference: over all these pixels, or over the
     * occupied ones, whichever is greater, so that background neither hides nor is hidden. */
    double p99_rel;
    double p999_rel; /* the 99.9th, alike */
} UnaffectedMetrics;

/* How a's difference from b compares with what it may be, where both sides see the same fragments
 * in the same order. A pixel's ratio is the greatest over its channels. */
typedef struct BoundMetrics {
    uint64_t pixels;    /* with the same fragments, at least one */
    uint64_t exceeded;  /* of those, with a channel beyond its bound */
    uint64_t unbounded; /* of those, with a channel whose bound is infinite */
    bool has_first;
    int first[2];                         /* x, y of the first that exceeds, from the top left */
    double max_ratio;                     /* of error over bound */
    double median_ratio, p99_ratio;       /* of the pixels' ratios */
    double median, p99;                   /* of the pixels' greatest bounds */
    double rounding_median, rounding_p99; /* the same of b's own */
} BoundMetrics;

/* Folds the differences of a rectangle of two buffers of one format into metrics (zeroed or from
 * earlier rectangles): rows of a_row_bytes and b_row_bytes, the rectangle's corner at (x, y) of
 * the buffer. Rectangles must come in reading order for `first` to be the first. */
void metrics_buffer(BufferMetrics *metrics, PixelFormat format, int x, int y, int width, int height,
                    const void *a, size_t a_row_bytes, const void *b, size_t b_row_bytes);

/* a and b: FORMAT_RGBA32F of one size. */
void metrics_final(const Image *a, const Image *b, FinalMetrics *out);

/* 99th percentile (nearest rank) over all pixels of a pixel's greatest absolute difference; where
 * either is not finite that is infinite. a and b as above. NO_MEMORY on failure. */
Result metrics_p99(const Image *a, const Image *b, double *out);

/* same: width·height bytes, a StructureSame each. NO_MEMORY on failure. */
Result metrics_unaffected(const Image *a, const Image *b, const uint8_t *same,
                          UnaffectedMetrics *out);

/* a: final; truth: with its bounds. NO_MEMORY on failure. */
Result metrics_bound(const Image *a, const Frame *truth, const uint8_t *same, BoundMetrics *out);

#endif

/* A picture of the difference between two images. */
#ifndef PEEL_REPORT_HEATMAP_H
#define PEEL_REPORT_HEATMAP_H

#include "image/image.h"

/* The scale: each pixel's greatest absolute channel difference d, on a logarithmic scale from
 * HEATMAP_LOW to HEATMAP_HIGH. Equal pixels are black, below the scale the darkest colour, above
 * it the brightest; NaN or infinity is magenta, a colour that the scale does not have. */
#define HEATMAP_LOW  1e-8
#define HEATMAP_HIGH 1.0

/* a and b: FORMAT_RGBA32F of one size; *out FORMAT_RGBA8, the caller frees. */
Result heatmap_image(const Image *a, const Image *b, Image *out);

/* The same, smaller: each pixel of *out shows the greatest difference of block·block pixels (fewer
 * at the right and bottom edges), so that a single differing pixel stays visible. */
Result heatmap_reduced(const Image *a, const Image *b, int block, Image *out);

/* The same of differences that are known: width · height, NaN for NaN and infinity. */
Result heatmap_differences(const float *differences, int width, int height, Image *out);

/* The legend's colours, left (low) to right (high): *out FORMAT_RGBA8, the caller frees. */
Result heatmap_scale(int width, int height, Image *out);

#endif

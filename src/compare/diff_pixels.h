/* The figures of a diff of two images in memory. */
#ifndef PEEL_COMPARE_DIFF_PIXELS_H
#define PEEL_COMPARE_DIFF_PIXELS_H

#include "compare/diff.h"
#include "number/format.h"

/* a and b: width · height pixels of one format, whose channels are R, G, B, A; nothing is copied.
 * The caller frees *out with diff_part_free, after NO_MEMORY too. */
Result diff_pixels(PixelFormat format, int width, int height, const void *a, const void *b,
                   const DiffOptions *options, DiffPart *out);

#endif

/* Whether a person would see that two images differ, pixel by pixel.
 *
 * Source: H. Yee, "A Perceptual Metric for Production Testing", Journal of Graphics Tools 9(4),
 * 2004: contrast sensitivity, masking by contrast, and the threshold at the luminance to which the
 * eye has adapted. It will not model motion, nor displays other than this one: white is 100 cd/m²,
 * the image fills 45 degrees across. */
#ifndef PEEL_COMPARE_PERCEIVE_H
#define PEEL_COMPARE_PERCEIVE_H

#include "image/planes.h"

/* Whether both have R, G and B. */
bool perceive_possible(const Planes *a, const Planes *b);

/* How many pixels of two images of one size look different. Floats and halves are linear light of
 * sRGB's primaries, unorm is encoded as sRGB is; what is not finite or below 0 counts as 0.
 * NO_MEMORY, also where it would take more than max_bytes (0: no limit). */
Result perceive_count(const Planes *a, const Planes *b, size_t max_bytes, uint64_t *out);

#endif

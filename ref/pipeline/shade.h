/* The lighting pass of one pixel: frame/shading.h through number/op.h. */
#ifndef PEEL_REF_SHADE_H
#define PEEL_REF_SHADE_H

#include "frame/view.h"
#include "ref/pipeline/buffers.h"

/* From fetched G-buffer values to the premultiplied source colour; false where the alpha test
 * discards. Flushing mode. */
bool shade_pixel(const View *view, const Texel *texel, float source[4]);

/* Resolve: final colour over the background from an accumulated pixel whose transmittance to the
 * background is `transmittance`. Flushing mode. */
void shade_final(const View *view, const float accum[4], float transmittance, float final[4]);

/* The display transform of a final colour to RGBA8. fused: see op_pow. Flushing mode. */
void shade_display(bool fused, const float final[4], uint8_t display[4]);

#endif

/* Fixed-function blending as llvmpipe computes it, per accumulation format.
 * Callers are in flushing mode (op_enter). */
#ifndef PEEL_NUMBER_BLEND_H
#define PEEL_NUMBER_BLEND_H

#include "number/blend_equation.h"
#include "number/format.h"

/* Clears one pixel to (0, 0, 0, 1): no colour, full transmittance. */
void blend_clear(PixelFormat format, void *pixel);

/* glBlendFuncSeparate(DST_ALPHA, ONE, ZERO, ONE_MINUS_SRC_ALPHA): source is a premultiplied
 * colour and its alpha, put behind what pixel already holds; pixel's alpha is transmittance.
 * Source: Bavoil, Myers, "Order Independent Transparency with Dual Depth Peeling", 2008. */
void blend_under(PixelFormat format, const float source[4], void *pixel);

/* glBlendFunc(DST_ALPHA, ONE) on all four channels: the original program's opaque pass. */
void blend_opaque_seed(PixelFormat format, const float source[4], void *pixel);

/* glBlendFuncSeparate(ONE, ONE_MINUS_SRC_ALPHA, ZERO, ONE_MINUS_SRC_ALPHA): a premultiplied source
 * in front of what pixel holds; pixel's alpha is transmittance. */
void blend_over(PixelFormat format, const float source[4], void *pixel);

/* glBlendFunc(ONE, ONE): all channels of the format are summed. */
void blend_add(PixelFormat format, const float source[4], void *pixel);

/* glBlendFunc(ZERO, ONE_MINUS_SRC_COLOR): every channel of pixel times 1 less the source's. */
void blend_product(PixelFormat format, const float source[4], void *pixel);

/* glBlendEquation(GL_MAX): the greater of each channel; the pixel's where they are equal or one is
 * NaN. */
void blend_max(PixelFormat format, const float source[4], void *pixel);

/* glBlendFunc(SRC_ALPHA, ONE_MINUS_SRC_ALPHA) on all four channels: an alpha of 1 puts the source
 * in the pixel's place, one of 0 leaves the pixel. */
void blend_replace(PixelFormat format, const float source[4], void *pixel);

/* glBlendFunc(ONE_MINUS_DST_ALPHA, ONE): fills a pixel of zeros, leaves one whose alpha is 1. */
void blend_keep(PixelFormat format, const float source[4], void *pixel);

/* Any equation, of count pixels. fused: see op_muladd; it matters in formats of one channel whose
 * factors are complementary, where the driver interpolates. */
void blend_pixels(const BlendEquation *equation, bool fused, PixelFormat format, size_t count,
                  const float (*source)[4], void *pixels);

#endif

/* What storing in a format, fetching and blending add to the bound of single precision; exact
 * bounds are the truth's own, which stores nothing. The formats' rules are those of
 * ref/pipeline/NUMBERS.md, "Stored formats" and "Blending". */
#ifndef PEEL_REF_TRUTH_BOUND_STORE_H
#define PEEL_REF_TRUTH_BOUND_STORE_H

#include "frame/view.h"
#include "ref/truth/bounded.h"

#include <stdbool.h>

/* A channel of a colour format, stored and fetched. */
Bounded bound_store(PixelFormat format, Bounded x);

/* A window depth, stored and fetched. */
Bounded bound_store_depth(PixelFormat format, Bounded depth);

/* A normal as two octahedral channels of 16 bits. */
void bound_store_octahedral(Bounded normal[3]);

/* The position that a stored depth gives, about the exact one. (x, y): the pixel, y up. */
void bound_unproject(const Unprojection *from, Bounded depth, int x, int y, Bounded position[3]);

/* Puts source, premultiplied colour and alpha, under rgba: colour and transmittance. */
void bound_blend_under(PixelFormat format, const Bounded source[4], Bounded rgba[4]);

#endif

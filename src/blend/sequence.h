/* Sequences: n layers blended front to back (the under-blend) from the cleared pixel, with what the
 * result exactly is, what that is correctly rounded, and the bound in which every sane arithmetic
 * ends.
 *
 * Formats with alpha: rgba8, rgba16, rgba16f, rgba32f. Layer k is a premultiplied colour c and its
 * alpha a; the pixel holds a colour C and its transmittance T, at first (0, 0, 0, 1):
 *     C ← C + c·T      T ← T·(1 − a)
 * Sources are those of VECTORS_SEQUENCES (blend/vectors.h), none negative; of unorm formats they
 * are codes. As vectors, they are functions of specification and index.
 *
 * The bound. F are the numbers of the format (codes / greatest code; halves; floats), down(x) and
 * up(x) the nearest of them with down(x) ≤ x ≤ up(x). A sane arithmetic
 *  - may first store the source: c becomes something in [down(c), up(c)], and a likewise (codes,
 *    which are floats next to one: it, or by truncation the one below);
 *  - computes 1 − a, c·T, T·(1 − a) and the sum each faithfully: to one of the two neighbours of
 *    the real result among the numbers that it works with. F is among these, so that the result is
 *    in [down(x), up(x)]. Where F are codes it may work with halves (rgba8) or floats (rgba16)
 *    instead, among which codes are not: then fetching and storing are such operations too;
 *  - may flush: what is below the least normal half (of rgba32f and rgba16: float) may become 0;
 *  - stores both after every layer, to nearest or toward zero: to one of the two neighbours, of
 *    unorm formats after clamping to [0, 1].
 * As nothing is negative, every operation is monotone in C, T and c and antitone in a, so that the
 * ends of the operands' intervals give those of the result. What is fused, or computed with more
 * digits, rounds less often or to nearer numbers and stays inside. The ends are numbers of the
 * format, computed in double: products of two of them are exact there, and a sum that is not has
 * its error's sign looked at before it is moved outward. */
#ifndef PEEL_BLEND_SEQUENCE_H
#define PEEL_BLEND_SEQUENCE_H

#include "blend/arithmetic.h"
#include "blend/vectors.h"
#include "number/rational.h"

enum {
    SEQUENCE_LAYERS_MAX = 256,
    SEQUENCE_COUNT = 2550 /* every number of layers once with each kind of layers */
};

/* Sequence `index` of spec, whose set is VECTORS_SEQUENCES: the number of its layers, in
 * [2, SEQUENCE_LAYERS_MAX], and its sources, front first. source: room for SEQUENCE_LAYERS_MAX. */
int sequence_make(const VectorSpec *spec, uint64_t index, float (*source)[4]);

/* What is special about it: "all layers equal"; static. */
const char *sequence_what(uint64_t index);

/* The cleared pixel: no colour, full transmittance. */
void sequence_clear(PixelFormat format, void *pixel);

/* The pixel after each layer of the under-blend. The combination must not be refused. pixels: room
 * for `layers` of the format. */
void sequence_blend(const Arithmetic *arithmetic, PixelFormat format, int layers,
                    const float (*source)[4], void *pixels);

/* The real result of sources as they are (of unorm formats: of the codes they are stored as).
 * exact: four, initialised. */
void sequence_exact(PixelFormat format, int layers, const float (*source)[4], Rational exact[4]);

/* The exact result rounded once, to nearest even, into a pixel of the format. */
void sequence_round(PixelFormat format, const Rational exact[4], void *pixel);

/* The bound of each channel after the last layer: stored values at its ends or between are inside.
 * Of unorm formats they are codes. */
void sequence_bound(PixelFormat format, int layers, const float (*source)[4], double low[4],
                    double high[4]);

/* Whether channel c of the pixel is within its bound. */
bool sequence_inside(PixelFormat format, const void *pixel, int c, const double low[4],
                     const double high[4]);

#endif

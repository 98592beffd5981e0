/* Sequences: n layers blended front to back (the under-blend) from the cleared pixel, with what the
 * result exactly is, what that is correctly rounded, and the bound in which every sane arithmetic
 * ends.
 *
 * Formats with alpha: rgba8, rgba16, rgba16f, rgba32f. Layer k is a premultiplied colour c and its
 * alpha a; the pixel holds a colour C and its transmittance T, at first (0, 0, 0, 1):
 *     C ← C + c·T      T ← T·(1 − a)
 * Sources are those of VECTORS_SEQUENCES (blend/vectors.h), none negative; of unorm formats they
 * are codes. Everything here is of specification and index, as vectors are.
 *
 * The bound. Write F for the numbers of the format (codes / greatest code; halves; floats), down(x)
 * and up(x) for the nearest ones of F with down(x) ≤ x ≤ up(x). A sane arithmetic
 *  - may first store the source: c and a become something in [down(c), up(c)], [down(a), up(a)];
 *  - computes 1 − a, c·T, T·(1 − a) and the sum each faithfully: the result is one of the two
 *    neighbours of the real one among the numbers it works with; these have F among them, so the
 *    result is in [down(x), up(x)]. Or it works with floats where F are codes, which floats are
 *    not: then it is within one unit of a float (2^-23 of x) too;
 *  - may flush: what is below F's (or float's) least normal number may become 0;
 *  - stores both after every layer, to nearest or toward zero: again one of the two neighbours; of
 *    unorm formats after clamping to [0, 1].
 * As nothing is negative, every operation is monotone in C, c and T and antitone in a, so intervals
 * of each follow from their ends. They are carried in double, each end moved outward by one unit
 * after every operation, which is more than double's rounding. Fusing and wider working formats
 * only round less, hence stay inside. */
#ifndef PEEL_BLEND_SEQUENCE_H
#define PEEL_BLEND_SEQUENCE_H

#include "blend/arithmetic.h"
#include "blend/vectors.h"

#include <gmp.h>

enum {
    SEQUENCE_LAYERS_MAX = 256
};

/* Sequence `index` of spec, whose set is VECTORS_SEQUENCES: the number of its layers, in
 * [2, SEQUENCE_LAYERS_MAX], and its sources, front first. source: room for SEQUENCE_LAYERS_MAX. */
int sequence_make(const VectorSpec *spec, uint64_t index, float (*source)[4]);

/* What is special about it: "cleared by an opaque layer", "random"; static. */
const char *sequence_what(const VectorSpec *spec, uint64_t index);

/* The pixel after each layer. pixels: room for `layers` of the format. */
void sequence_blend(const Arithmetic *arithmetic, PixelFormat format, int layers,
                    const float (*source)[4], void *pixels);

/* The real result, of sources as they are (of unorm formats: the codes they are stored as). */
typedef struct SequenceExact {
    mpq_t channel[4];
} SequenceExact;

void sequence_exact_init(SequenceExact *exact);
void sequence_exact_clear(SequenceExact *exact);
void sequence_exact(PixelFormat format, int layers, const float (*source)[4], SequenceExact *exact);

/* Rounded once, to nearest even, into a pixel of the format. */
void sequence_round(PixelFormat format, const SequenceExact *exact, void *pixel);

/* The bound of each channel after the last layer; stored values at or between its ends are inside
 * (of unorm formats: code / greatest code). */
void sequence_bound(PixelFormat format, int layers, const float (*source)[4], double low[4],
                    double high[4]);

#endif

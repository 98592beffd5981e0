/* Exact numbers: fractions of any size, and infinity and NaN, which fractions cannot say.
 *
 * What floats, halves and codes stand for is a fraction, and so is every sum and product of them:
 * nothing here rounds but rational_round. Infinities and NaN follow IEEE 754: inf − inf, 0·inf and
 * whatever has a NaN are NaN. As of all numbers of GMP, exhausted memory ends the program. */
#ifndef PEEL_NUMBER_RATIONAL_H
#define PEEL_NUMBER_RATIONAL_H

#include "number/format.h"

#include <gmp.h>
#include <stdbool.h>

typedef enum RationalKind {
    RATIONAL_FINITE = 0,
    RATIONAL_INFINITE,
    RATIONAL_NAN
} RationalKind;

typedef struct Rational {
    mpq_t value; /* canonical; 0 unless finite */
    RationalKind kind;
    bool negative; /* of an infinity, or of a zero that was −0; sums and products have no −0 */
} Rational;

/* Every Rational is initialised (to 0) before its first use, and cleared after the last. */
void rational_init(Rational *out);
void rational_clear(Rational *rational);

/* Results may be operands. */
void rational_copy(const Rational *a, Rational *out);
void rational_set(double x, Rational *out); /* exactly */
void rational_set_ratio(unsigned long numerator, unsigned long denominator, Rational *out);
void rational_add(const Rational *a, const Rational *b, Rational *out);
void rational_sub(const Rational *a, const Rational *b, Rational *out);
void rational_mul(const Rational *a, const Rational *b, Rational *out);
void rational_one_minus(const Rational *a, Rational *out);
/* The number where the other is NaN. */
void rational_min(const Rational *a, const Rational *b, Rational *out);
void rational_max(const Rational *a, const Rational *b, Rational *out);
void rational_clamp(const Rational *a, Rational *out); /* to [0, 1]; NaN gives 0 */

/* The same number; NaN is equal to NaN, −0 to 0. */
bool rational_equal(const Rational *a, const Rational *b);
bool rational_is_zero(const Rational *a);

/* To the nearest number of `bits` bits (at most 53), ties to even, that is a multiple of
 * 2^lowest; infinity from half a unit above the greatest, which is below 2^(highest + 1). */
double rational_round(const Rational *a, int bits, int lowest, int highest);
double rational_to_double(const Rational *a);
float rational_to_float(const Rational *a);

/* The stored bits of the number of the format nearest to a, ties to even; unorm formats clamp. */
uint32_t rational_store(const Rational *a, PixelFormat format);

/* What the bits of a channel of the format stand for. */
void rational_fetch(uint32_t bits, PixelFormat format, Rational *out);

/* error in units in the last place that the format has at the number `at`; of unorm formats, in
 * codes. Not finite where one of them is not, unless the error is 0. */
double rational_ulps(const Rational *error, const Rational *at, PixelFormat format);

#endif

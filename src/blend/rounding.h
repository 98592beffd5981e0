/* Rounding of exact values to fewer digits, in any direction, without the processor's modes.
 *
 * A value that no double holds is rounded to odd first: the double on either side of it whose last
 * bit is set. Rounding that to at most 51 digits, in any direction, gives what rounding the exact
 * value once would have given. Source: Boldo, Melquiond, "Emulation of a FMA and correctly rounded
 * sums: proved algorithms using rounding to odd", IEEE Trans. Computers 57(4), 2008.
 * Callers are NOT in flushing mode. */
#ifndef PEEL_BLEND_ROUNDING_H
#define PEEL_BLEND_ROUNDING_H

#include "blend/arithmetic.h"

/* A binary format: digits with the hidden one, exponent of the least normal number, most finite. */
typedef struct Digits {
    int digits, exponent_least;
    double most;
} Digits;

extern const Digits rounding_float, rounding_half;

/* The sum of at most four doubles, rounded to odd. Those of zeros have IEEE's sign, x − x is +0.
 * Finite terms must be multiples of 2^-1000 and below 2^1000; others give what adding them gives.
 */
double rounding_sum(int count, const double terms[]);

/* x·y rounded to odd, for a product within 2^±900. */
double rounding_product(double x, double y);

/* x, 0 or not below 2^-1000, which is a value of at most 51 digits or was rounded to odd, rounded
 * to the digits. Overflow gives infinity or the most finite number, as IEEE says for the direction.
 */
double rounding_to(const Digits *digits, BlendRounding rounding, double x);

/* The same; what is then below the least normal number is the zero of its sign. Tiny is decided
 * after rounding to the digits without a bound of the exponent, as x86 does. */
double rounding_flushed(const Digits *digits, BlendRounding rounding, double x);

/* x rounded to an integer. */
double rounding_integer(BlendRounding rounding, double x);

#endif

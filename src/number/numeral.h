/* Numbers as people and files write them: the shortest decimal, hexadecimal floats, fractions. */
#ifndef PEEL_NUMBER_NUMERAL_H
#define PEEL_NUMBER_NUMERAL_H

#include "base/result.h"
#include "number/rational.h"

#include <stddef.h>

enum {
    NUMERAL_MAX = 40, /* room for a number and its final 0 */
    NUMERAL_BOTH = 64 /* for one in both forms */
};

/* Each returns out. NaN is "nan" whatever its sign. */

/* The fewest decimal digits that read back as the same float; an exponent only where they would
 * not do below 10^9. Values that are no floats: as the nearest float. */
const char *numeral_float(double value, char out[NUMERAL_MAX]);
const char *numeral_double(double value, char out[NUMERAL_MAX]); /* as the same double */

/* "0x1.8p-1": exact. */
const char *numeral_hex(double value, char out[NUMERAL_MAX]);

/* "0.75 (0x1.8p-1)". */
const char *numeral_both(double value, char out[NUMERAL_BOTH]);

/* "1/3", "13421773/2^27" where a denominator is a large power of two, "16777215*2^104" where a
 * whole number has such a factor; "inf", "-inf", "nan". The caller frees; never NULL. */
char *numeral_fraction(const Rational *a);

/* Reads `length` characters, blanks around them apart: decimal ("-0.5", "1e-3"), hexadecimal float
 * ("0x1.8p-1"), fraction of any two of these ("1/3", "128/255"), a power of two in their place
 * ("3*2^-24", "1/2^10"), "inf", "nan" with or without sign. Exact: nothing is rounded. BAD_INPUT
 * with the text and what was expected, but without a place, which the caller knows. */
Result numeral_read(const char *text, size_t length, Rational *out);

#endif

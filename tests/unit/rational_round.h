/* Rounding of rational numbers, for the tests of blend/: another way than blend/rounding.c's. */
#ifndef PEEL_TESTS_RATIONAL_ROUND_H
#define PEEL_TESTS_RATIONAL_ROUND_H

#include "blend/arithmetic.h"

#include <gmp.h>
#include <math.h>

typedef struct RationalFormat {
    int digits, exponent_least; /* with the hidden one; of the least normal number */
    double most;
} RationalFormat;

static const RationalFormat rational_float = {24, -126, 0x1.fffffep127};
static const RationalFormat rational_half = {11, -14, 65504.0};

/* x·2^power. */
static inline void rational_scale(mpq_t x, int power)
{
    if (power < 0)
        mpq_div_2exp(x, x, (unsigned long)-power);
    else
        mpq_mul_2exp(x, x, (unsigned long)power);
}

/* A positive x to a whole number. *tie: it lay half-way. */
static inline void rational_whole(mpq_t x, BlendRounding rounding, bool negative, mpz_t out,
                                  bool *tie)
{
    mpz_t rest;
    mpz_init(rest);
    mpz_fdiv_qr(out, rest, mpq_numref(x), mpq_denref(x));
    bool inexact = mpz_sgn(rest) != 0;
    mpz_mul_ui(rest, rest, 2);
    int half = mpz_cmp(rest, mpq_denref(x));
    *tie = inexact && half == 0;
    bool up = rounding == BLEND_NEAREST_EVEN   ? half > 0 || (half == 0 && mpz_odd_p(out))
              : rounding == BLEND_NEAREST_AWAY ? half >= 0
              : rounding == BLEND_UPWARD       ? inexact && !negative
                                               : false;
    if (up)
        mpz_add_ui(out, out, 1);
    mpz_clear(rest);
}

/* The greatest e with 2^e ≤ x; x is positive. */
static inline int rational_exponent(mpq_t x)
{
    int e = (int)mpz_sizeinbase(mpq_numref(x), 2) - (int)mpz_sizeinbase(mpq_denref(x), 2);
    mpq_t power;
    mpq_init(power);
    mpq_set_ui(power, 1, 1);
    rational_scale(power, e);
    if (mpq_cmp(x, power) < 0)
        e--;
    mpq_clear(power);
    return e;
}

/* value in the format; 0 is +0 unless a negative value became 0. With flush, what is below the
 * least normal number when rounded without a bound of the exponent is 0. */
static inline double rational_round(const RationalFormat *format, BlendRounding rounding,
                                    bool flush, mpq_t value, bool *tie)
{
    *tie = false;
    if (mpq_sgn(value) == 0)
        return 0.0;
    bool negative = mpq_sgn(value) < 0;
    mpq_t x;
    mpz_t whole;
    mpq_init(x);
    mpz_init(whole);
    mpq_abs(x, value);
    int unit = rational_exponent(x) - (format->digits - 1);
    int least = format->exponent_least - (format->digits - 1);
    if (unit < least && !flush)
        unit = least;
    rational_scale(x, -unit);
    rational_whole(x, rounding, negative, whole, tie);
    double rounded = ldexp(mpz_get_d(whole), unit);
    mpq_clear(x);
    mpz_clear(whole);
    if (flush && rounded < ldexp(1.0, format->exponent_least))
        rounded = 0.0;
    if (rounded > format->most)
        rounded = rounding == BLEND_TOWARD_ZERO || (rounding == BLEND_UPWARD && negative)
                      ? format->most
                      : INFINITY;
    return negative ? -rounded : rounded;
}

#endif

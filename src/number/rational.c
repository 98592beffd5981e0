#include "number/rational.h"

#include <math.h>
#include <string.h>

void rational_init(Rational *out)
{
    mpq_init(out->value);
    out->kind = RATIONAL_FINITE;
    out->negative = false;
}

void rational_clear(Rational *rational)
{
    mpq_clear(rational->value);
}

static void set_special(RationalKind kind, bool negative, Rational *out)
{
    mpq_set_ui(out->value, 0, 1);
    out->kind = kind;
    out->negative = negative;
}

static void set_finite(Rational *out)
{
    out->kind = RATIONAL_FINITE;
    out->negative = false;
}

void rational_copy(const Rational *a, Rational *out)
{
    mpq_set(out->value, a->value);
    out->kind = a->kind;
    out->negative = a->negative;
}

void rational_set(double x, Rational *out)
{
    if (!isfinite(x)) {
        set_special(isnan(x) ? RATIONAL_NAN : RATIONAL_INFINITE, !isnan(x) && x < 0.0, out);
        return;
    }
    mpq_set_d(out->value, x);
    out->kind = RATIONAL_FINITE;
    out->negative = x == 0.0 && signbit(x);
}

void rational_set_ratio(unsigned long numerator, unsigned long denominator, Rational *out)
{
    mpq_set_ui(out->value, numerator, denominator);
    mpq_canonicalize(out->value);
    set_finite(out);
}

/* −1, 0 or 1. */
static int sign(const Rational *a)
{
    return a->kind == RATIONAL_FINITE ? mpq_sgn(a->value) : a->negative ? -1 : 1;
}

static void sum(const Rational *a, const Rational *b, bool subtract, Rational *out)
{
    bool b_negative = b->negative != subtract;
    if (a->kind == RATIONAL_NAN || b->kind == RATIONAL_NAN ||
        (a->kind == RATIONAL_INFINITE && b->kind == RATIONAL_INFINITE &&
         a->negative != b_negative)) {
        set_special(RATIONAL_NAN, false, out);
    } else if (a->kind == RATIONAL_INFINITE || b->kind == RATIONAL_INFINITE) {
        set_special(RATIONAL_INFINITE, a->kind == RATIONAL_INFINITE ? a->negative : b_negative,
                    out);
    } else {
        (subtract ? mpq_sub : mpq_add)(out->value, a->value, b->value);
        set_finite(out);
    }
}

void rational_add(const Rational *a, const Rational *b, Rational *out)
{
    sum(a, b, false, out);
}

void rational_sub(const Rational *a, const Rational *b, Rational *out)
{
    sum(a, b, true, out);
}

void rational_mul(const Rational *a, const Rational *b, Rational *out)
{
    if (a->kind == RATIONAL_FINITE && b->kind == RATIONAL_FINITE) {
        mpq_mul(out->value, a->value, b->value);
        set_finite(out);
        return;
    }
    int product = sign(a) * sign(b);
    bool is_nan = a->kind == RATIONAL_NAN || b->kind == RATIONAL_NAN || product == 0;
    set_special(is_nan ? RATIONAL_NAN : RATIONAL_INFINITE, !is_nan && product < 0, out);
}

void rational_one_minus(const Rational *a, Rational *out)
{
    Rational one;
    rational_init(&one);
    rational_set(1.0, &one);
    rational_sub(&one, a, out);
    rational_clear(&one);
}

/* Of two that are not NaN. */
static int compare(const Rational *a, const Rational *b)
{
    int a_infinite = a->kind == RATIONAL_INFINITE ? sign(a) : 0;
    int b_infinite = b->kind == RATIONAL_INFINITE ? sign(b) : 0;
    return a_infinite || b_infinite ? a_infinite - b_infinite : mpq_cmp(a->value, b->value);
}

static void choose(const Rational *a, const Rational *b, int order, Rational *out)
{
    if (a->kind == RATIONAL_NAN || b->kind == RATIONAL_NAN)
        rational_copy(a->kind == RATIONAL_NAN ? b : a, out);
    else
        rational_copy(compare(a, b) * order > 0 ? a : b, out);
}

void rational_min(const Rational *a, const Rational *b, Rational *out)
{
    choose(a, b, -1, out);
}

void rational_max(const Rational *a, const Rational *b, Rational *out)
{
    choose(a, b, 1, out);
}

void rational_clamp(const Rational *a, Rational *out)
{
    bool high = a->kind == RATIONAL_INFINITE && !a->negative;
    if (a->kind == RATIONAL_FINITE && mpq_sgn(a->value) >= 0 && mpq_cmp_ui(a->value, 1, 1) <= 0)
        rational_copy(a, out);
    else
        rational_set(high || (a->kind == RATIONAL_FINITE && mpq_sgn(a->value) > 0) ? 1.0 : 0.0,
                     out);
}

bool rational_equal(const Rational *a, const Rational *b)
{
    if (a->kind != b->kind)
        return false;
    return a->kind == RATIONAL_NAN || compare(a, b) == 0;
}

bool rational_is_zero(const Rational *a)
{
    return a->kind == RATIONAL_FINITE && mpq_sgn(a->value) == 0;
}

/* ---- rounding ---- */

/* The power of two that is the unit of numbers like a, which is finite and not 0. */
static long unit_of(const mpq_t a, int bits, int lowest)
{
    mpz_srcptr numerator = mpq_numref(a), denominator = mpq_denref(a);
    long power =
        (long)mpz_sizeinbase(numerator, 2) - (long)mpz_sizeinbase(denominator, 2); /* or 1 above */
    mpz_t shifted;
    mpz_init(shifted);
    if (power >= 0) {
        mpz_mul_2exp(shifted, denominator, (mp_bitcnt_t)power);
        power -= mpz_cmpabs(numerator, shifted) < 0;
    } else {
        mpz_mul_2exp(shifted, numerator, (mp_bitcnt_t)-power);
        power -= mpz_cmpabs(shifted, denominator) < 0;
    }
    mpz_clear(shifted);
    return power - bits + 1 > lowest ? power - bits + 1 : lowest;
}

/* |a| in units of 2^unit, to the nearest integer, ties to even. */
static double whole_units(const mpq_t a, long unit)
{
    mpz_t quotient, rest, divisor;
    mpz_inits(quotient, rest, divisor, NULL);
    mpz_abs(rest, mpq_numref(a));
    mpz_set(divisor, mpq_denref(a));
    if (unit >= 0)
        mpz_mul_2exp(divisor, divisor, (mp_bitcnt_t)unit);
    else
        mpz_mul_2exp(rest, rest, (mp_bitcnt_t)-unit);
    mpz_tdiv_qr(quotient, rest, rest, divisor);
    mpz_mul_2exp(rest, rest, 1);
    int side = mpz_cmp(rest, divisor);
    if (side > 0 || (side == 0 && mpz_odd_p(quotient)))
        mpz_add_ui(quotient, quotient, 1);
    double units = mpz_get_d(quotient);
    mpz_clears(quotient, rest, divisor, NULL);
    return units;
}

double rational_round(const Rational *a, int bits, int lowest, int highest)
{
    if (a->kind == RATIONAL_NAN)
        return NAN;
    if (a->kind == RATIONAL_INFINITE)
        return a->negative ? -INFINITY : INFINITY;
    int sign_of = mpq_sgn(a->value);
    if (sign_of == 0)
        return a->negative ? -0.0 : 0.0;
    long unit = unit_of(a->value, bits, lowest);
    if (unit + bits - 1 > highest)
        return sign_of < 0 ? -INFINITY : INFINITY;
    double rounded = ldexp(whole_units(a->value, unit), (int)unit);
    if (rounded >= ldexp(1.0, highest) * 2.0) /* 2^1024 is infinity, as it should be */
        rounded = INFINITY;
    return sign_of * rounded;
}

double rational_to_double(const Rational *a)
{
    return rational_round(a, 53, -1074, 1023);
}

float rational_to_float(const Rational *a)
{
    return (float)rational_round(a, 24, -149, 127);
}

/* ---- formats ---- */

/* Of a number that is a half. */
static uint32_t half_bits(double half)
{
    uint32_t minus = signbit(half) ? 0x8000u : 0;
    double size = fabs(half);
    int exponent;
    if (isnan(half))
        return 0x7e00u;
    if (isinf(half))
        return minus | 0x7c00u;
    if (size < 0x1p-14)
        return minus | (uint32_t)(size * 0x1p24);
    double mantissa = frexp(size, &exponent); /* in [0.5, 1) */
    return minus | ((uint32_t)(exponent + 14) << 10) | ((uint32_t)(mantissa * 2048.0) & 1023u);
}

static uint32_t code_of(const Rational *a, uint32_t most)
{
    Rational scaled, factor;
    rational_init(&scaled);
    rational_init(&factor);
    rational_set((double)most, &factor);
    rational_clamp(a, &scaled);
    rational_mul(&scaled, &factor, &scaled);
    double code = rational_is_zero(&scaled) ? 0.0 : whole_units(scaled.value, 0);
    rational_clear(&scaled);
    rational_clear(&factor);
    return (uint32_t)code;
}

uint32_t rational_store(const Rational *a, PixelFormat format)
{
    const FormatInfo *info = format_info(format);
    if (info->kind == KIND_UNORM)
        return code_of(a, info->unorm_max);
    if (info->kind == KIND_HALF)
        return half_bits(rational_round(a, 11, -24, 15));
    float x = rational_to_float(a);
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return x != x ? 0x7fc00000u : bits;
}

void rational_fetch(uint32_t bits, PixelFormat format, Rational *out)
{
    const FormatInfo *info = format_info(format);
    float x;
    if (info->kind == KIND_UNORM) {
        rational_set_ratio(bits, info->unorm_max, out);
    } else if (info->kind == KIND_HALF) {
        rational_set((double)half_to_float((uint16_t)bits), out);
    } else {
        memcpy(&x, &bits, sizeof x);
        rational_set((double)x, out);
    }
}

double rational_ulps(const Rational *error, const Rational *at, PixelFormat format)
{
    const FormatInfo *info = format_info(format);
    if (rational_is_zero(error))
        return 0.0;
    if (error->kind != RATIONAL_FINITE || at->kind != RATIONAL_FINITE)
        return error->kind == RATIONAL_INFINITE ? (error->negative ? -INFINITY : INFINITY) : NAN;
    int bits = info->kind == KIND_HALF ? 11 : 24, lowest = info->kind == KIND_HALF ? -24 : -149;
    Rational units;
    rational_init(&units);
    if (info->kind == KIND_UNORM) {
        rational_set((double)info->unorm_max, &units);
        mpq_mul(units.value, error->value, units.value);
    } else {
        long unit = rational_is_zero(at) ? lowest : unit_of(at->value, bits, lowest);
        if (unit >= 0)
            mpq_div_2exp(units.value, error->value, (mp_bitcnt_t)unit);
        else
            mpq_mul_2exp(units.value, error->value, (mp_bitcnt_t)-unit);
    }
    double ulps = rational_to_double(&units);
    rational_clear(&units);
    return ulps;
}

#include "blend/rounding.h"

#include <float.h>
#include <math.h>
#include <string.h>

const Digits rounding_float = {24, -126, FLT_MAX};
const Digits rounding_half = {11, -14, 65504.0};

/* The neighbour of x on the side of rest whose last bit is set, where x + rest is inexact. */
static double to_odd(double x, double rest)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    if (rest == 0.0 || rest != rest || bits & 1)
        return x;
    bits = (rest > 0.0) == (x > 0.0) ? bits + 1 : bits - 1;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* *a + *b exactly: *a becomes the rounded sum, *b what it lacks. Source: Knuth, "The Art of
 * Computer Programming" 2, 4.2.2, theorem B. */
static void two_sum(double *a, double *b)
{
    double sum = *a + *b, second = sum - *a;
    *b = (*a - (sum - second)) + (*b - second);
    *a = sum;
}

/* Shewchuk's expansion: parts that do not overlap, the greatest last. Its bits below the first part
 * that does not fit into the sum are less than that part, so its sign is that of all that is left
 * out. Source: Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
 * Predicates", 1997, theorem 10. */
double rounding_sum(int count, const double terms[])
{
    double parts[4] = {0}, plain = terms[0];
    for (int i = 1; i < count; i++)
        plain += terms[i];
    if (!isfinite(plain))
        return plain;
    for (int i = 0; i < count; i++) {
        double grown = terms[i];
        for (int k = 0; k < i; k++)
            two_sum(&grown, &parts[k]);
        parts[i] = grown;
    }
    double sum = parts[count - 1], rest = 0.0;
    for (int i = count - 2; i >= 0 && rest == 0.0; i--) {
        rest = parts[i];
        two_sum(&sum, &rest);
    }
    if (sum == 0.0)
        return plain == 0.0 ? plain : 0.0;
    return to_odd(sum, rest);
}

double rounding_product(double x, double y)
{
    double product = x * y;
    return isfinite(product) ? to_odd(product, fma(x, y, -product)) : product;
}

double rounding_integer(BlendRounding rounding, double x)
{
    double low = floor(x), part = x - low;
    bool up = false;
    switch (rounding) {
    case BLEND_NEAREST_EVEN:
        up = part > 0.5 || (part == 0.5 && fmod(low, 2.0) != 0.0);
        break;
    case BLEND_TOWARD_ZERO:
        up = part > 0.0 && x < 0.0;
        break;
    case BLEND_NEAREST_AWAY:
        up = part > 0.5 || (part == 0.5 && x > 0.0);
        break;
    case BLEND_UPWARD:
        up = part > 0.0;
        break;
    }
    return copysign(up ? low + 1.0 : low, x);
}

static double overflowed(const Digits *digits, BlendRounding rounding, double x)
{
    bool most = rounding == BLEND_TOWARD_ZERO || (rounding == BLEND_UPWARD && x < 0.0);
    return copysign(most ? digits->most : INFINITY, x);
}

/* x, not 0 and finite, to multiples of 2^unit. */
static double to_unit(BlendRounding rounding, int unit, double x)
{
    return ldexp(rounding_integer(rounding, ldexp(x, -unit)), unit);
}

/* The same on the bits of x, whose last `cut` digits go; 0 < cut < 52. A carry moves on into the
 * exponent as it should. */
static double cut_digits(BlendRounding rounding, int cut, double x)
{
    uint64_t bits, part = (UINT64_C(1) << cut) - 1, half = UINT64_C(1) << (cut - 1);
    memcpy(&bits, &x, sizeof bits);
    switch (rounding) {
    case BLEND_NEAREST_EVEN:
        bits += half - 1 + (bits >> cut & 1);
        break;
    case BLEND_TOWARD_ZERO:
        break;
    case BLEND_NEAREST_AWAY:
        bits += half;
        break;
    case BLEND_UPWARD:
        bits += x > 0.0 ? part : 0;
        break;
    }
    bits &= ~part;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* x, not 0 and finite, to the digits where its unit is not below 2^unit_least. */
static double to_digits(const Digits *digits, BlendRounding rounding, int unit_least, double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    int exponent = (int)(bits >> 52 & 0x7ff) - 1023, unit = exponent - (digits->digits - 1);
    if (unit < unit_least)
        unit = unit_least;
    int cut = unit - (exponent - 52);
    double rounded = cut < 52 ? cut_digits(rounding, cut, x) : to_unit(rounding, unit, x);
    return fabs(rounded) > digits->most ? overflowed(digits, rounding, x) : rounded;
}

double rounding_to(const Digits *digits, BlendRounding rounding, double x)
{
    if (x == 0.0 || !isfinite(x))
        return x;
    return to_digits(digits, rounding, digits->exponent_least - (digits->digits - 1), x);
}

double rounding_flushed(const Digits *digits, BlendRounding rounding, double x)
{
    if (x == 0.0 || !isfinite(x))
        return x;
    double rounded = to_digits(digits, rounding, -1022, x);
    return fabs(rounded) < ldexp(1.0, digits->exponent_least) ? copysign(0.0, x) : rounded;
}

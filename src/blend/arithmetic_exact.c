/* Exactly rounded blending.
 *
 * Floats and halves: a factor is 0, 1, x or 1 − x of a stored operand x, so a result is a sum of at
 * most four products of two floats: s·f ± d·g with s·(1 − x) = s − s·x. A product of two floats has
 * 48 digits and lies between 2^-298 and 2^256, so doubles hold each; their sum is rounded to odd,
 * and that once to the format (rounding.h). Unorm formats: s·f ± d·g in codes is an integer below
 * 2^33 in units of 1/most², divided by most; most is odd, so no quotient is halfway between
 * two codes. */
#include "blend/arithmetic_parts.h"
#include "blend/rounding.h"

#include <math.h>

/* The result, rounded to odd; value(inf) and value(NaN) as IEEE's operations give them. */
static double exact_sum(const ChannelOperands *o, FactorBase f, FactorBase g, BlendFunc func)
{
    double s = func == BLEND_FUNC_REVERSE_SUBTRACT ? -o->source : o->source;
    double d = func == BLEND_FUNC_SUBTRACT ? -o->destination : o->destination;
    double first = s * (f.complement ? 1.0 - f.base : f.base);
    double second = d * (g.complement ? 1.0 - g.base : g.base);
    if (!isfinite(first) || !isfinite(second))
        return first + second;
    /* 1.0 − x is 0 only where x is 1, and a product of floats is 0 only where a factor is. */
    if (first == 0.0 && second == 0.0)
        return first + second;
    double terms[4];
    int count = 0;
    terms[count++] = f.complement ? s : s * f.base;
    if (f.complement)
        terms[count++] = -s * f.base;
    terms[count++] = g.complement ? d : d * g.base;
    if (g.complement)
        terms[count++] = -d * g.base;
    double sum = rounding_sum(count, terms);
    return sum == 0.0 ? 0.0 : sum; /* x − x is +0 */
}

/* The greater or less; a number rather than NaN; +0 is greater than −0. */
static double extreme(double s, double d, bool greatest)
{
    if (s != s || d != d)
        return s != s ? d : s;
    if (s == d)
        return signbit(s) == greatest ? d : s;
    return (s > d) == greatest ? s : d;
}

static double exact_float(const ChannelOperands *o, const ChannelEquation *channel, FactorBase f,
                          FactorBase g)
{
    if (channel->func == BLEND_FUNC_MIN || channel->func == BLEND_FUNC_MAX)
        return extreme(o->source, o->destination, channel->func == BLEND_FUNC_MAX);
    return exact_sum(o, f, g, channel->func);
}

static double exact_code(const ChannelOperands *o, const ChannelEquation *channel, FactorBase f,
                         FactorBase g)
{
    if (channel->func == BLEND_FUNC_MIN || channel->func == BLEND_FUNC_MAX)
        return extreme(o->source, o->destination, channel->func == BLEND_FUNC_MAX);
    int64_t most = (int64_t)o->one;
    int64_t first = (int64_t)(o->source * (f.complement ? o->one - f.base : f.base));
    int64_t second = (int64_t)(o->destination * (g.complement ? o->one - g.base : g.base));
    int64_t sum = channel->func == BLEND_FUNC_SUBTRACT           ? first - second
                  : channel->func == BLEND_FUNC_REVERSE_SUBTRACT ? second - first
                                                                 : first + second;
    if (sum <= 0)
        return 0.0;
    int64_t code = (2 * sum + most) / (2 * most);
    return (double)(code < most ? code : most);
}

static double stored_code(float x, double most)
{
    double scaled = (double)x * most; /* exact: 24 + 16 digits */
    if (!(scaled > 0.0))
        return 0.0;
    return scaled < most ? rounding_integer(BLEND_NEAREST_EVEN, scaled) : most;
}

static double if_exact(double product, double rounded)
{
    return product == rounded ? product : NAN;
}

/* A product that doubles hold, NaN where none does. */
static double shown_product(double x, double y)
{
    return if_exact(x * y, rounding_product(x, y));
}

static double shown_factor(FactorBase f, double one)
{
    double terms[2] = {one, -f.base};
    return f.complement ? if_exact(one - f.base, rounding_sum(2, terms)) : f.base;
}

static void show(const ChannelOperands *o, const ChannelEquation *channel, FactorBase f,
                 FactorBase g, double sum, BlendSteps *steps)
{
    bool products = channel->func != BLEND_FUNC_MIN && channel->func != BLEND_FUNC_MAX;
    *steps = (BlendSteps){.source = o->source, .destination = o->destination, .codes = o->one > 1};
    steps->source_factor = products ? shown_factor(f, o->one) : o->one;
    steps->destination_factor = products ? shown_factor(g, o->one) : o->one;
    steps->source_product = steps->codes ? NAN : shown_product(o->source, steps->source_factor);
    steps->destination_product =
        steps->codes ? NAN : shown_product(o->destination, steps->destination_factor);
    steps->sum = sum;
}

uint32_t arithmetic_exact(const BlendEquation *equation, PixelFormat format, const float source[4],
                          const void *pixel, int channel, BlendSteps *steps)
{
    const FormatInfo *info = format_info(format);
    ChannelEquation part = channel_equation(equation, channel);
    bool unorm = info->kind == KIND_UNORM;
    ChannelOperands o = {
        .one = unorm ? (double)info->unorm_max : 1.0,
        .source = (double)source[channel],
        .source_alpha = (double)source[3],
        .destination = arithmetic_value(info->kind, format_bits(format, pixel, channel)),
    };
    o.destination_alpha =
        info->channels < 4 ? o.one : arithmetic_value(info->kind, format_bits(format, pixel, 3));
    if (unorm) {
        o.source = stored_code(source[channel], o.one);
        o.source_alpha = stored_code(source[3], o.one);
    }
    FactorBase f = arithmetic_factor(part.source, part.alpha, &o);
    FactorBase g = arithmetic_factor(part.destination, part.alpha, &o);
    double value, sum = NAN;
    if (unorm) {
        value = exact_code(&o, &part, f, g);
    } else {
        sum = exact_float(&o, &part, f, g);
        value = rounding_to(info->kind == KIND_HALF ? &rounding_half : &rounding_float,
                            BLEND_NEAREST_EVEN, sum);
    }
    if (steps)
        show(&o, &part, f, g, sum, steps);
    return arithmetic_bits(info->kind, value);
}

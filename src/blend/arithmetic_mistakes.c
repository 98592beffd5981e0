/* What programs get wrong, put into arithmetic_steps.c's operations. */
#include "blend/arithmetic_parts.h"
#include "blend/rounding.h"

#include <math.h>

static bool has(const Arithmetic *a, BlendMistake mistake)
{
    return a->mistakes >> mistake & 1;
}

static BlendFactor other_alpha(BlendFactor factor)
{
    return factor == FACTOR_DST_ALPHA             ? FACTOR_ONE_MINUS_DST_ALPHA
           : factor == FACTOR_ONE_MINUS_DST_ALPHA ? FACTOR_DST_ALPHA
                                                  : factor;
}

BlendEquation mistake_equation(const Arithmetic *a, const BlendEquation *equation)
{
    BlendEquation e = *equation;
    if (has(a, MISTAKE_ALPHA_AS_COLOR))
        e = (BlendEquation){e.source, e.destination, e.source, e.destination, e.func, e.func};
    if (has(a, MISTAKE_FACTORS_SWAPPED))
        e = (BlendEquation){e.destination,  e.source, e.destination_alpha,
                            e.source_alpha, e.func,   e.func_alpha};
    if (has(a, MISTAKE_COVERAGE))
        e = (BlendEquation){other_alpha(e.source),
                            other_alpha(e.destination),
                            other_alpha(e.source_alpha),
                            other_alpha(e.destination_alpha),
                            e.func,
                            e.func_alpha};
    return e;
}

double mistake_source(const Arithmetic *a, double x, double alpha, bool color)
{
    if (color && has(a, MISTAKE_UNPREMULTIPLIED) && alpha != 0.0)
        x = rounding_to(&rounding_float, BLEND_NEAREST_EVEN, x / alpha);
    if (color && has(a, MISTAKE_ALPHA_TWICE))
        x = rounding_to(&rounding_float, BLEND_NEAREST_EVEN, x * alpha);
    if (has(a, MISTAKE_CLAMPED_EARLY))
        x = !(x > 0.0) ? 0.0 : x < 1.0 ? x : 1.0;
    return x;
}

void mistake_operands(const Arithmetic *a, bool color, ChannelOperands *o)
{
    if (has(a, MISTAKE_DESTINATION_ALPHA_ONE)) {
        o->destination_alpha = o->one;
        if (!color)
            o->destination = o->one;
    }
    if (has(a, MISTAKE_EIGHT_BITS) || has(a, MISTAKE_EIGHT_BITS_SHIFTED)) {
        o->one = 255.0;
        o->source = floor(o->source / 256.0);
        o->source_alpha = floor(o->source_alpha / 256.0);
        o->destination = floor(o->destination / 256.0);
        o->destination_alpha = floor(o->destination_alpha / 256.0);
    }
    if (color && has(a, MISTAKE_GAMMA)) {
        o->source = rounding_to(&rounding_float, BLEND_NEAREST_EVEN, o->source * o->source);
        o->destination =
            rounding_to(&rounding_float, BLEND_NEAREST_EVEN, o->destination * o->destination);
    }
}

EarlyOut mistake_early_out(const Arithmetic *a, const BlendEquation *equation,
                           const ChannelOperands *o)
{
    bool loose = has(a, MISTAKE_EARLY_OUT_254);
    if (!loose && !has(a, MISTAKE_EARLY_OUT))
        return EARLY_OUT_NO;
    double margin = loose ? o->one / 255.0 : 0.0;
    if (equation->destination == FACTOR_ONE_MINUS_SRC_ALPHA && o->source_alpha >= o->one - margin)
        return EARLY_OUT_SOURCE;
    if (equation->source == FACTOR_DST_ALPHA && o->destination_alpha <= margin)
        return EARLY_OUT_KEEP;
    return EARLY_OUT_NO;
}

double mistake_complement(const Arithmetic *a, double one, double x)
{
    if (!has(a, MISTAKE_COMPLEMENT_CODES) || !isfinite(x))
        return NAN;
    double code = rounding_integer(BLEND_NEAREST_EVEN, x / one * 255.0);
    return rounding_to(&rounding_float, BLEND_NEAREST_EVEN, (255.0 - code) / 255.0);
}

double mistake_sum(const Arithmetic *a, bool color, double sum)
{
    if (color && has(a, MISTAKE_GAMMA))
        sum = sum > 0.0 ? sqrt(sum) : sum;
    if (has(a, MISTAKE_THROUGH_HALF))
        sum = rounding_to(&rounding_half, BLEND_NEAREST_EVEN, sum);
    if (has(a, MISTAKE_NAN_ZERO) && sum != sum)
        sum = 0.0;
    return sum;
}

double mistake_code(const Arithmetic *a, double one, double code)
{
    if (has(a, MISTAKE_WRAPS))
        return (double)((int64_t)code & (int64_t)one); /* one is 2^bits − 1 */
    code = code < 0.0 ? 0.0 : code < one ? code : one;
    if (has(a, MISTAKE_EIGHT_BITS))
        code *= 257.0;
    if (has(a, MISTAKE_EIGHT_BITS_SHIFTED))
        code *= 256.0;
    return code;
}

const char *mistake_refuses(const Arithmetic *a, PixelFormat format)
{
    bool unorm = format_info(format)->kind == KIND_UNORM, codes = a->precision == PRECISION_CODES;
    if (has(a, MISTAKE_WRAPS) && !codes)
        return "wrapping is of codes: expected precision=codes";
    if ((has(a, MISTAKE_EIGHT_BITS) || has(a, MISTAKE_EIGHT_BITS_SHIFTED)) &&
        (!codes || format != FORMAT_RGBA16))
        return "too few bits are of codes of 16: expected rgba16 and precision=codes";
    if (has(a, MISTAKE_EARLY_OUT) && unorm)
        return "of unorm formats leaving out at alpha 1 changes nothing: expected a float format";
    if (has(a, MISTAKE_CLAMPED_EARLY) && unorm)
        return "unorm formats clamp the source rightly: expected a float format";
    if (has(a, MISTAKE_CLAMPED_LATE) && (!unorm || codes || a->source_stored))
        return "a late clamp is of sources that are not codes: expected rgba8 or rgba16 and float";
    if ((has(a, MISTAKE_COMPLEMENT_CODES) || has(a, MISTAKE_THROUGH_HALF) ||
         has(a, MISTAKE_GAMMA)) &&
        codes)
        return "this mistake is of floats: expected another precision than codes";
    return NULL;
}

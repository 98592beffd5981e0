/* Blending one operation after the other, each rounded as the fields of Arithmetic say. */
#include "blend/arithmetic_parts.h"
#include "blend/rounding.h"

#include <math.h>

static double rounded(const Arithmetic *a, double x)
{
    if (a->precision == PRECISION_DOUBLE)
        return x;
    const Digits *digits = a->precision == PRECISION_HALF ? &rounding_half : &rounding_float;
    return a->flush ? rounding_flushed(digits, a->rounding, x)
                    : rounding_to(digits, a->rounding, x);
}

static double add(const Arithmetic *a, double x, double y)
{
    if (a->precision == PRECISION_DOUBLE)
        return x + y;
    return rounded(a, rounding_sum(2, (double[]){x, y}));
}

/* Halves and floats: the product is exact in double. */
static double multiply(const Arithmetic *a, double x, double y)
{
    return rounded(a, x * y);
}

/* x·y + z. */
static double multiply_add(const Arithmetic *a, double x, double y, double z)
{
    if (a->precision == PRECISION_DOUBLE)
        return fma(x, y, z);
    return rounded(a, rounding_sum(2, (double[]){x * y, z}));
}

static double clamped(double x)
{
    return !(x > 0.0) ? 0.0 : x < 1.0 ? x : 1.0;
}

/* A value to the format, as a number in it; of unorm formats the code. */
static double stored(const FormatInfo *info, BlendRounding rounding, double x)
{
    if (info->kind == KIND_UNORM) {
        double code = rounding_integer(rounding, rounding_product(clamped(x), info->unorm_max));
        return code < info->unorm_max ? code : info->unorm_max;
    }
    return rounding_to(info->kind == KIND_HALF ? &rounding_half : &rounding_float, rounding, x);
}

/* A stored number as an operand. */
static double fetched(const Arithmetic *a, const FormatInfo *info, double number)
{
    if (a->precision == PRECISION_CODES)
        return number;
    if (info->kind == KIND_UNORM) {
        /* The quotient in double is no tie of fewer digits: the greatest code is odd. */
        number /= info->unorm_max;
        Arithmetic nearest = *a;
        nearest.rounding = BLEND_NEAREST_EVEN;
        return rounded(&nearest, number);
    }
    return rounded(a, number);
}

/* A source as an operand: fixed-point targets clamp it (GL 4.6 core, 17.3.6). */
static double taken(const Arithmetic *a, const FormatInfo *info, double x)
{
    if (a->precision == PRECISION_CODES || a->source_stored)
        return fetched(a, info, stored(info, a->store, x));
    bool clamps = info->kind == KIND_UNORM && !(a->mistakes & 1u << MISTAKE_CLAMPED_LATE);
    return rounded(a, clamps ? clamped(x) : x);
}

/* An operand times its factor. Of codes nobody multiplies by the factor 1. */
static double factored(const Arithmetic *a, const ChannelOperands *o, BlendFactor factor,
                       bool alpha, double x, double y)
{
    if (a->precision != PRECISION_CODES)
        return multiply(a, x, y);
    if (factor == FACTOR_ONE || (factor == FACTOR_SRC_ALPHA_SATURATE && alpha))
        return x;
    return (double)arithmetic_code_product(a->product, o->one > 255.0 ? 16 : 8, (int64_t)x,
                                           (int64_t)y);
}

static double factor_value(const Arithmetic *a, const ChannelOperands *o, FactorBase f)
{
    if (!f.complement)
        return f.base;
    double wrong = mistake_complement(a, o->one, f.base);
    if (wrong == wrong)
        return wrong;
    return a->precision == PRECISION_CODES ? o->one - f.base : add(a, 1.0, -f.base);
}

/* From factors to the sum, in *steps. */
static void compute(const Arithmetic *a, const ChannelOperands *o, const ChannelEquation *part,
                    BlendSteps *steps)
{
    double s = o->source, d = o->destination;
    if (part->func == BLEND_FUNC_MIN || part->func == BLEND_FUNC_MAX) {
        steps->source_factor = steps->destination_factor = o->one;
        steps->source_product = s;
        steps->destination_product = d;
        steps->sum = (part->func == BLEND_FUNC_MAX ? s > d : s < d) ? s : d;
        return;
    }
    double f = factor_value(a, o, arithmetic_factor(part->source, part->alpha, o));
    double g = factor_value(a, o, arithmetic_factor(part->destination, part->alpha, o));
    double p = factored(a, o, part->source, part->alpha, s, f);
    double q = factored(a, o, part->destination, part->alpha, d, g);
    steps->source_factor = f;
    steps->destination_factor = g;
    steps->source_product = p;
    steps->destination_product = q;
    double sign_p = part->func == BLEND_FUNC_REVERSE_SUBTRACT ? -1.0 : 1.0;
    double sign_q = part->func == BLEND_FUNC_SUBTRACT ? -1.0 : 1.0;
    if (a->precision == PRECISION_CODES)
        steps->sum = sign_p * p + sign_q * q;
    else if (!a->fused)
        steps->sum = add(a, sign_p * p, sign_q * q);
    else if (part->destination == FACTOR_ONE)
        steps->sum = multiply_add(a, sign_p * s, f, sign_q * q);
    else
        steps->sum = multiply_add(a, sign_q * d, g, sign_p * p);
}

/* The operands of a channel. */
static ChannelOperands operands_of(const Arithmetic *a, const FormatInfo *info, PixelFormat format,
                                   const float source[4], const void *pixel, int channel)
{
    double alpha = (double)source[3];
    double s = mistake_source(a, (double)source[channel], alpha, channel < 3);
    ChannelOperands o = {
        .one = a->precision == PRECISION_CODES ? (double)info->unorm_max : 1.0,
        .source = taken(a, info, s),
        .source_alpha = taken(a, info, mistake_source(a, alpha, alpha, false)),
        .destination =
            fetched(a, info, arithmetic_value(info->kind, format_bits(format, pixel, channel))),
    };
    o.destination_alpha = o.one;
    if (info->channels == 4)
        o.destination_alpha =
            fetched(a, info, arithmetic_value(info->kind, format_bits(format, pixel, 3)));
    return o;
}

uint32_t arithmetic_store(const Arithmetic *arithmetic, const FormatInfo *info, double sum)
{
    double value = stored(info, arithmetic->store, sum);
    if (info->kind == KIND_HALF && arithmetic->flush && fabs(value) < 0x1p-14)
        value = copysign(0.0, value);
    return arithmetic_bits(info->kind, value);
}

uint32_t arithmetic_stepwise(const Arithmetic *arithmetic, const BlendEquation *equation,
                             PixelFormat format, const float source[4], const void *pixel,
                             int channel, BlendSteps *steps)
{
    const FormatInfo *info = format_info(format);
    bool color = channel < 3;
    BlendEquation done = mistake_equation(arithmetic, equation);
    ChannelEquation part = channel_equation(&done, channel);
    ChannelOperands o = operands_of(arithmetic, info, format, source, pixel, channel);
    if (color && info->channels == 4 && arithmetic->mistakes & 1u << MISTAKE_ALPHA_FIRST) {
        Arithmetic first = *arithmetic;
        first.mistakes &= ~(1u << MISTAKE_ALPHA_FIRST);
        uint32_t alpha = arithmetic_stepwise(&first, equation, format, source, pixel, 3, NULL);
        o.destination_alpha = fetched(arithmetic, info, arithmetic_value(info->kind, alpha));
    }
    EarlyOut early = mistake_early_out(arithmetic, &done, &o);
    mistake_operands(arithmetic, color, &o);
    BlendSteps local;
    BlendSteps *out = steps ? steps : &local;
    *out = (BlendSteps){.source = o.source,
                        .destination = o.destination,
                        .codes = arithmetic->precision == PRECISION_CODES};
    if (early == EARLY_OUT_KEEP) {
        out->sum = o.destination;
        return format_bits(format, pixel, channel);
    }
    compute(arithmetic, &o, &part, out);
    if (early == EARLY_OUT_SOURCE)
        out->sum = out->source_product;
    out->sum = mistake_sum(arithmetic, color, out->sum);
    if (arithmetic->precision == PRECISION_CODES)
        return arithmetic_bits(info->kind, mistake_code(arithmetic, o.one, out->sum));
    return arithmetic_store(arithmetic, info, out->sum);
}

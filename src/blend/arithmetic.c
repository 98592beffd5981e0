#include "blend/arithmetic.h"

#include "blend/arithmetic_parts.h"
#include "blend/rounding.h"
#include "number/blend.h"
#include "number/op.h"

#include <math.h>
#include <string.h>

const PixelFormat arithmetic_formats[ARITHMETIC_FORMATS] = {
    FORMAT_RGBA8, FORMAT_RGBA16, FORMAT_RGBA16F, FORMAT_RGBA32F, FORMAT_RG32F, FORMAT_R32F};

static bool is_blended(PixelFormat format)
{
    for (int i = 0; i < ARITHMETIC_FORMATS; i++)
        if (arithmetic_formats[i] == format)
            return true;
    return false;
}

bool arithmetic_find_format(const char *name, PixelFormat *out)
{
    PixelFormat format;
    if (!format_find(name, &format) || !is_blended(format))
        return false;
    *out = format;
    return true;
}

const char *arithmetic_refuses(const Arithmetic *arithmetic, const BlendEquation *equation,
                               PixelFormat format)
{
    const FormatInfo *info = format_info(format);
    if (!is_blended(format))
        return "nothing is blended in this format: expected rgba8, rgba16, rgba16f, rgba32f, rg32f "
               "or r32f";
    if (arithmetic->kind == ARITHMETIC_STEPS && arithmetic->precision == PRECISION_CODES &&
        info->kind != KIND_UNORM)
        return "arithmetic of codes needs a unorm format: expected rgba8 or rgba16";
    if (arithmetic->kind == ARITHMETIC_STEPS && arithmetic->precision == PRECISION_DOUBLE &&
        (arithmetic->rounding != BLEND_NEAREST_EVEN || arithmetic->flush))
        return "double operations are rounded to nearest, without flushing";
    (void)equation; /* all are defined */
    return arithmetic->kind == ARITHMETIC_STEPS ? mistake_refuses(arithmetic, format) : NULL;
}

FactorBase arithmetic_factor(BlendFactor factor, bool alpha, const ChannelOperands *o)
{
    switch (factor) {
    case FACTOR_ZERO:
        return (FactorBase){0.0, false};
    case FACTOR_SRC_COLOR:
    case FACTOR_ONE_MINUS_SRC_COLOR:
        return (FactorBase){o->source, factor != FACTOR_SRC_COLOR};
    case FACTOR_DST_COLOR:
    case FACTOR_ONE_MINUS_DST_COLOR:
        return (FactorBase){o->destination, factor != FACTOR_DST_COLOR};
    case FACTOR_SRC_ALPHA:
    case FACTOR_ONE_MINUS_SRC_ALPHA:
        return (FactorBase){o->source_alpha, factor != FACTOR_SRC_ALPHA};
    case FACTOR_DST_ALPHA:
    case FACTOR_ONE_MINUS_DST_ALPHA:
        return (FactorBase){o->destination_alpha, factor != FACTOR_DST_ALPHA};
    case FACTOR_SRC_ALPHA_SATURATE:
        if (alpha)
            break;
        if (rounding_sum(3, (double[]){o->source_alpha, o->destination_alpha, -o->one}) < 0.0)
            return (FactorBase){o->source_alpha, false};
        return (FactorBase){o->destination_alpha, true};
    default:
        break;
    }
    return (FactorBase){o->one, false};
}

uint32_t arithmetic_bits(FormatKind kind, double value)
{
    if (kind == KIND_UNORM)
        return (uint32_t)value;
    if (value != value)
        return kind == KIND_HALF ? 0x7e00u : 0x7fc00000u;
    return kind == KIND_HALF ? half_from_float((float)value) : op_bits((float)value);
}

double arithmetic_value(FormatKind kind, uint32_t bits)
{
    if (kind == KIND_UNORM)
        return bits;
    return (double)(kind == KIND_HALF ? half_to_float((uint16_t)bits) : op_from_bits(bits));
}

void arithmetic_put(PixelFormat format, void *pixel, int channel, uint32_t bits)
{
    int bytes = format_info(format)->channel_bytes;
    unsigned char *at = (unsigned char *)pixel + channel * bytes;
    uint16_t word = (uint16_t)bits;
    if (bytes == 1)
        *at = (unsigned char)bits;
    else if (bytes == 2)
        memcpy(at, &word, sizeof word);
    else
        memcpy(at, &bits, sizeof bits);
}

static void blend_plain(const Arithmetic *arithmetic, const BlendEquation *equation,
                        PixelFormat format, const float source[4], void *pixel)
{
    BlendSteps steps[4];
    arithmetic_steps(arithmetic, equation, format, source, pixel, steps);
    for (int i = 0; i < format_info(format)->channels; i++)
        /* NOLINTNEXTLINE(clang-analyzer-core.CallAndMessage): these were set */
        arithmetic_put(format, pixel, i, steps[i].stored);
}

void arithmetic_blend(const Arithmetic *arithmetic, const BlendEquation *equation,
                      PixelFormat format, size_t count, const float (*source)[4], void *pixels)
{
    size_t bytes = format_pixel_bytes(format);
    if (arithmetic->kind == ARITHMETIC_DRIVER) {
        uint32_t saved = op_enter();
        blend_pixels(equation, arithmetic->fused, format, count, source, pixels);
        op_leave(saved);
        return;
    }
    if (arithmetic_codes_blend(arithmetic, equation, format, count, source, pixels) ||
        arithmetic_floats_blend(arithmetic, equation, format, count, source, pixels))
        return;
    for (size_t i = 0; i < count; i++)
        blend_plain(arithmetic, equation, format, source[i], (char *)pixels + i * bytes);
}

/* What the driver's operations are, one by one. */
static Arithmetic driver_steps(PixelFormat format)
{
    FormatKind kind = format_info(format)->kind;
    if (kind == KIND_UNORM)
        return (Arithmetic){
            .kind = ARITHMETIC_STEPS, .precision = PRECISION_CODES, .product = CODES_DRIVER};
    return (Arithmetic){
        .kind = ARITHMETIC_STEPS, .store = BLEND_TOWARD_ZERO, .flush = kind == KIND_FLOAT};
}

void arithmetic_steps(const Arithmetic *arithmetic, const BlendEquation *equation,
                      PixelFormat format, const float source[4], const void *pixel,
                      BlendSteps out[4])
{
    Arithmetic steps = arithmetic->kind == ARITHMETIC_DRIVER ? driver_steps(format) : *arithmetic;
    int channels = format_info(format)->channels;
    for (int i = 0; i < channels; i++)
        out[i].stored =
            arithmetic->kind == ARITHMETIC_EXACT
                ? arithmetic_exact(equation, format, source, pixel, i, &out[i])
                : arithmetic_stepwise(&steps, equation, format, source, pixel, i, &out[i]);
    if (arithmetic->kind != ARITHMETIC_DRIVER)
        return;
    unsigned char blended[16];
    memcpy(blended, pixel, format_pixel_bytes(format));
    arithmetic_blend(arithmetic, equation, format, 1, (const float(*)[4])source, blended);
    for (int i = 0; i < channels; i++)
        out[i].stored = format_bits(format, blended, i);
}

#include "blend/arithmetic.h"

#include "blend/arithmetic_parts.h"
#include "blend/rounding.h"
#include "number/blend.h"
#include "number/op.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define STEPS(...)                                                                                 \
    {                                                                                              \
        .kind = ARITHMETIC_STEPS, __VA_ARGS__                                                      \
    }

static const ArithmeticInfo infos[] = {
    {"exact",
     "the exact result of the stored operands, rounded once to nearest even",
     {.kind = ARITHMETIC_EXACT},
     false},
    {"driver", "Mesa llvmpipe's, as measured", {.kind = ARITHMETIC_DRIVER}, false},
    {"separate", "float operations, each rounded to nearest, stored to nearest",
     STEPS(.precision = PRECISION_FLOAT), false},
    {"separate-truncated", "float operations, each rounded to nearest, stored toward zero",
     STEPS(.store = BLEND_TOWARD_ZERO), false},
    {"fused", "the last product is added without being rounded; stored to nearest",
     STEPS(.fused = true), false},
    {"fused-truncated", "the same, stored toward zero",
     STEPS(.fused = true, .store = BLEND_TOWARD_ZERO), false},
    {"codes-nearest", "integers, a*b/max to nearest: t = ab + 128; (t + (t >> 8)) >> 8",
     STEPS(.precision = PRECISION_CODES), false},
    {"codes-driver", "integers: t = ab; t += t >> 8; (t + 128) >> 8",
     STEPS(.precision = PRECISION_CODES, .product = CODES_DRIVER), false},
    {"codes-shift", "integers, the product shifted without rounding: ab >> 8",
     STEPS(.precision = PRECISION_CODES, .product = CODES_SHIFT), true},
    {"factors-swapped", "source's and destination's factor interchanged",
     STEPS(.mistakes = 1u << MISTAKE_FACTORS_SWAPPED), true},
};

enum {
    INFO_COUNT = sizeof infos / sizeof *infos
};

size_t arithmetic_count(void)
{
    return INFO_COUNT;
}

const ArithmeticInfo *arithmetic_info(size_t i)
{
    return &infos[i];
}

static const char *const precisions[] = {"float", "half", "double", "codes", NULL};
static const char *const roundings[] = {"nearest", "truncate", "away", "up", NULL};
static const char *const products[] = {"nearest",     "driver",     "floor",         "shift",
                                       "shift-round", "shift-most", "shift-stretch", NULL};
static const char *const answers[] = {"no", "yes", NULL};
static const char *const mistakes[] = {"factors-swapped", NULL};

static int find(const char *const *names, const char *text, size_t length)
{
    for (int i = 0; names[i]; i++)
        if (strlen(names[i]) == length && memcmp(names[i], text, length) == 0)
            return i;
    return -1;
}

typedef enum Field {
    FIELD_PRECISION = 0,
    FIELD_ROUNDING,
    FIELD_STORE,
    FIELD_PRODUCT,
    FIELD_FUSED,
    FIELD_FLUSH,
    FIELD_SOURCE_STORED,
    FIELD_MISTAKE,
    FIELD_COUNT
} Field;

static const struct {
    const char *key, *expected;
    const char *const *values;
} fields[FIELD_COUNT] = {
    [FIELD_PRECISION] = {"precision", "float, half, double or codes", precisions},
    [FIELD_ROUNDING] = {"rounding", "nearest, truncate, away or up", roundings},
    [FIELD_STORE] = {"store", "nearest, truncate, away or up", roundings},
    [FIELD_PRODUCT] = {"product",
                       "nearest, driver, floor, shift, shift-round, shift-most or shift-stretch",
                       products},
    [FIELD_FUSED] = {"fused", "yes or no", answers},
    [FIELD_FLUSH] = {"flush", "yes or no", answers},
    [FIELD_SOURCE_STORED] = {"source-stored", "yes or no", answers},
    [FIELD_MISTAKE] = {"mistake", "a mistake's name", mistakes},
};

static void set_field(Arithmetic *out, Field field, int value)
{
    switch (field) {
    case FIELD_PRECISION:
        out->precision = (BlendPrecision)value;
        break;
    case FIELD_ROUNDING:
        out->rounding = (BlendRounding)value;
        break;
    case FIELD_STORE:
        out->store = (BlendRounding)value;
        break;
    case FIELD_PRODUCT:
        out->product = (CodeProduct)value;
        break;
    case FIELD_FUSED:
        out->fused = value;
        break;
    case FIELD_FLUSH:
        out->flush = value;
        break;
    case FIELD_SOURCE_STORED:
        out->source_stored = value;
        break;
    default:
        out->mistakes |= 1u << value;
    }
}

static Result parse_field(const char *text, size_t length, Arithmetic *out)
{
    const char *equals = memchr(text, '=', length);
    for (int i = 0; equals && i < FIELD_COUNT; i++) {
        size_t key = (size_t)(equals - text);
        if (strlen(fields[i].key) != key || memcmp(fields[i].key, text, key) != 0)
            continue;
        int value = find(fields[i].values, equals + 1, length - key - 1);
        if (value < 0)
            return result_fail(RESULT_BAD_INPUT, "arithmetic: '%.*s': expected %s", (int)length,
                               text, fields[i].expected);
        set_field(out, (Field)i, value);
        return RESULT_OK;
    }
    return result_fail(RESULT_BAD_INPUT,
                       "arithmetic: '%.*s': expected a name, or key=value of precision, rounding, "
                       "store, product, fused, flush, source-stored, mistake",
                       (int)length, text);
}

Result arithmetic_parse(const char *text, Arithmetic *out)
{
    for (size_t i = 0; i < INFO_COUNT; i++)
        if (strcmp(infos[i].name, text) == 0) {
            *out = infos[i].arithmetic;
            return RESULT_OK;
        }
    Arithmetic parsed = {.kind = ARITHMETIC_STEPS};
    for (const char *end;; text = end + 1) {
        end = strchr(text, ',');
        Result result = parse_field(text, end ? (size_t)(end - text) : strlen(text), &parsed);
        if (result != RESULT_OK)
            return result;
        if (!end)
            break;
    }
    if (parsed.precision == PRECISION_DOUBLE && parsed.rounding != BLEND_NEAREST_EVEN)
        return result_fail(RESULT_BAD_INPUT,
                           "arithmetic: precision=double: expected rounding=nearest");
    *out = parsed;
    return RESULT_OK;
}

typedef void DriverBlend(PixelFormat format, const float source[4], void *pixel);

static DriverBlend *driver_blend(const BlendEquation *equation)
{
    static DriverBlend *const blends[EQUATION_COUNT + 1] = {
        [EQUATION_UNDER] = blend_under,      [EQUATION_ADD] = blend_add,
        [EQUATION_MAX] = blend_max,          [EQUATION_PRODUCT] = blend_product,
        [EQUATION_SEED] = blend_opaque_seed, [EQUATION_OVER_TRANSMITTANCE] = blend_over,
        [EQUATION_REPLACE] = blend_replace,  [EQUATION_KEEP] = blend_keep,
    };
    return blends[equation_id(equation)];
}

const char *arithmetic_refuses(const Arithmetic *arithmetic, const BlendEquation *equation,
                               PixelFormat format)
{
    const FormatInfo *info = format_info(format);
    bool narrow = format == FORMAT_RG32F || format == FORMAT_R32F;
    if (format != FORMAT_RGBA32F && format != FORMAT_RGBA16F && format != FORMAT_RGBA16 &&
        format != FORMAT_RGBA8 && !narrow)
        return "nothing is blended in this format: expected rgba8, rgba16, rgba16f, rgba32f, rg32f "
               "or r32f";
    if (arithmetic->kind == ARITHMETIC_STEPS && arithmetic->precision == PRECISION_CODES &&
        info->kind != KIND_UNORM)
        return "arithmetic of codes needs a unorm format: expected rgba8 or rgba16";
    if (arithmetic->kind == ARITHMETIC_DRIVER) {
        DriverBlend *blend = driver_blend(equation);
        if (!blend ||
            (narrow && blend != blend_add && blend != blend_max && blend != blend_product))
            return "the driver's arithmetic is not known for this equation";
    }
    return NULL;
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
        arithmetic_put(format, pixel, i, steps[i].stored);
}

void arithmetic_blend(const Arithmetic *arithmetic, const BlendEquation *equation,
                      PixelFormat format, size_t count, const float (*source)[4], void *pixels)
{
    size_t bytes = format_pixel_bytes(format);
    if (arithmetic->kind == ARITHMETIC_DRIVER) {
        DriverBlend *blend = driver_blend(equation);
        uint32_t saved = op_enter();
        for (size_t i = 0; i < count; i++)
            blend(format, source[i], (char *)pixels + i * bytes);
        op_leave(saved);
        return;
    }
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

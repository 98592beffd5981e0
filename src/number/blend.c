#include "number/blend.h"

#define LANES 1
#include "number/blend_lanes.h"

#include <assert.h>

/* a·b/(2^bits − 1) as the driver rounds it: not always correctly, see NUMBERS.md. bits ≤ 16. */
static uint32_t multiply(int bits, uint32_t a, uint32_t b)
{
    uint32_t product = a * b;
    product += product >> bits;
    return (product + (1u << (bits - 1))) >> bits;
}

/* Of integers: one factor of the source, one of the destination. */
typedef enum Equation {
    EQUATION_UNDER,   /* s·T + d */
    EQUATION_OVER,    /* s + d·(1 − source alpha) */
    EQUATION_REPLACE, /* s·(source alpha) + d·(1 − source alpha) */
    EQUATION_KEEP,    /* s·(1 − T) + d */
    EQUATION_ADD,
    EQUATION_PRODUCT, /* d·(1 − s) */
    EQUATION_MAX
} Equation;

static uint32_t unorm_equation(Equation equation, int bits, uint32_t s, uint32_t d,
                               uint32_t source_alpha, uint32_t transmittance)
{
    uint32_t most = (1u << bits) - 1, sum = s + d;
    if (equation == EQUATION_MAX)
        return s > d ? s : d;
    if (equation == EQUATION_UNDER)
        sum = multiply(bits, s, transmittance) + d;
    if (equation == EQUATION_PRODUCT)
        return multiply(bits, d, most - s);
    if (equation == EQUATION_OVER)
        sum = s + multiply(bits, d, most - source_alpha);
    if (equation == EQUATION_REPLACE)
        sum = multiply(bits, s, source_alpha) + multiply(bits, d, most - source_alpha);
    if (equation == EQUATION_KEEP)
        sum = multiply(bits, s, most - transmittance) + d;
    return sum < most ? sum : most;
}

/* RGBA8 and RGBA16: the source is stored first, then the arithmetic is that of integers.
 * transmits: alpha is T·(1 − s), as in the under-blend; else it is blended as the colours are. */
static void unorm_blend(PixelFormat format, Equation equation, bool transmits,
                        const float source[4], void *pixel)
{
    const FormatInfo *info = format_info(format);
    int bits = 8 * info->channel_bytes;
    uint32_t transmittance = format_bits(format, pixel, 3);
    unsigned char stored[4 * sizeof(uint16_t)];
    format_store(format, source, stored);
    uint32_t source_alpha = format_bits(format, stored, 3);
    for (int i = 0; i < 4; i++) {
        uint32_t s = format_bits(format, stored, i), d = format_bits(format, pixel, i);
        uint32_t value = unorm_equation(equation, bits, s, d, source_alpha, transmittance);
        if (i == 3 && transmits)
            value = multiply(bits, transmittance, info->unorm_max - s);
        if (bits == 8)
            ((uint8_t *)pixel)[i] = (uint8_t)value;
        else
            ((uint16_t *)pixel)[i] = (uint16_t)value;
    }
}

/* Half floats are blended as floats and truncated, and there the driver keeps denormals. */
static __attribute__((noinline)) void under16f(const float source[4], float dst[4])
{
    float transmittance = dst[3];
    for (int i = 0; i < 3; i++)
        dst[i] = source[i] * transmittance + dst[i];
    dst[3] = source[3] * 0.0f + transmittance * (1.0f - source[3]);
}

static __attribute__((noinline)) void seed16f(const float source[4], float dst[4])
{
    float transmittance = dst[3];
    for (int i = 0; i < 4; i++)
        dst[i] = source[i] * transmittance + dst[i];
}

static void half_blend(void (*blend)(const float source[4], float dst[4]), const float source[4],
                       void *pixel)
{
    float dst[4];
    format_fetch(FORMAT_RGBA16F, pixel, dst);
    uint32_t flushing = op_suspend();
    blend(source, dst);
    op_leave(flushing);
    format_store(FORMAT_RGBA16F, dst, pixel);
}

void blend_clear(PixelFormat format, void *pixel)
{
    format_store(format, (const float[4]){0, 0, 0, 1}, pixel);
}

void blend_under(PixelFormat format, const float source[4], void *pixel)
{
    switch (format) {
    case FORMAT_RGBA32F:
        blend_lanes_under(source, pixel);
        return;
    case FORMAT_RGBA16F:
        half_blend(under16f, source, pixel);
        return;
    case FORMAT_RGBA16:
    case FORMAT_RGBA8:
        unorm_blend(format, EQUATION_UNDER, true, source, pixel);
        return;
    default:
        assert(!"not an accumulation format");
    }
}

void blend_opaque_seed(PixelFormat format, const float source[4], void *pixel)
{
    switch (format) {
    case FORMAT_RGBA32F:
        blend_lanes_seed(source, pixel);
        return;
    case FORMAT_RGBA16F:
        half_blend(seed16f, source, pixel);
        return;
    case FORMAT_RGBA16:
    case FORMAT_RGBA8:
        unorm_blend(format, EQUATION_UNDER, false, source, pixel);
        return;
    default:
        assert(!"not an accumulation format");
    }
}

static void over32f(const float source[4], float dst[4])
{
    float keep = op_sub(1.0f, source[3]), transmittance = dst[3];
    for (int i = 0; i < 3; i++)
        dst[i] = op_canonical(op_add(source[i], op_mul(dst[i], keep)));
    dst[3] = op_canonical(op_add(op_mul(source[3], 0.0f), op_mul(transmittance, keep)));
}

static __attribute__((noinline)) void over16f(const float source[4], float dst[4])
{
    float keep = 1.0f - source[3], transmittance = dst[3];
    for (int i = 0; i < 3; i++)
        dst[i] = source[i] + dst[i] * keep;
    dst[3] = source[3] * 0.0f + transmittance * keep;
}

static __attribute__((noinline)) void add16f(const float source[4], float dst[4])
{
    for (int i = 0; i < 4; i++)
        dst[i] = source[i] + dst[i];
}

static __attribute__((noinline)) void max16f(const float source[4], float dst[4])
{
    for (int i = 0; i < 4; i++)
        dst[i] = source[i] > dst[i] ? source[i] : dst[i];
}

void blend_over(PixelFormat format, const float source[4], void *pixel)
{
    if (format == FORMAT_RGBA32F)
        over32f(source, pixel);
    else if (format == FORMAT_RGBA16F)
        half_blend(over16f, source, pixel);
    else
        unorm_blend(format, EQUATION_OVER, true, source, pixel);
}

void blend_add(PixelFormat format, const float source[4], void *pixel)
{
    float *dst = pixel;
    if (format == FORMAT_RGBA16F)
        half_blend(add16f, source, pixel);
    else if (format_info(format)->kind == KIND_UNORM)
        unorm_blend(format, EQUATION_ADD, false, source, pixel);
    else
        for (int i = 0; i < format_info(format)->channels; i++)
            dst[i] = op_canonical(op_add(source[i], dst[i]));
}

void blend_max(PixelFormat format, const float source[4], void *pixel)
{
    float *dst = pixel;
    if (format == FORMAT_RGBA16F)
        half_blend(max16f, source, pixel);
    else if (format_info(format)->kind == KIND_UNORM)
        unorm_blend(format, EQUATION_MAX, false, source, pixel);
    else
        for (int i = 0; i < format_info(format)->channels; i++)
            dst[i] = op_flush(source[i] > dst[i] ? source[i] : dst[i]);
}

static __attribute__((noinline)) void replace16f(const float source[4], float dst[4])
{
    float alpha = source[3], keep = 1.0f - alpha;
    for (int i = 0; i < 4; i++)
        dst[i] = source[i] * alpha + dst[i] * keep;
}

static __attribute__((noinline)) void keep16f(const float source[4], float dst[4])
{
    float room = 1.0f - dst[3];
    for (int i = 0; i < 4; i++)
        dst[i] = source[i] * room + dst[i];
}

void blend_replace(PixelFormat format, const float source[4], void *pixel)
{
    float *dst = pixel, keep = op_sub(1.0f, source[3]);
    if (format == FORMAT_RGBA16F)
        half_blend(replace16f, source, pixel);
    else if (format_info(format)->kind == KIND_UNORM)
        unorm_blend(format, EQUATION_REPLACE, false, source, pixel);
    else
        for (int i = 0; i < 4; i++)
            dst[i] = op_canonical(op_add(op_mul(source[i], source[3]), op_mul(dst[i], keep)));
}

void blend_keep(PixelFormat format, const float source[4], void *pixel)
{
    if (format == FORMAT_RGBA16F) {
        half_blend(keep16f, source, pixel);
        return;
    }
    if (format_info(format)->kind == KIND_UNORM) {
        unorm_blend(format, EQUATION_KEEP, false, source, pixel);
        return;
    }
    float *dst = pixel, room = op_sub(1.0f, dst[3]);
    for (int i = 0; i < 4; i++)
        dst[i] = op_canonical(op_add(op_mul(source[i], room), dst[i]));
}

static __attribute__((noinline)) void product16f(const float source[4], float dst[4])
{
    for (int i = 0; i < 4; i++)
        dst[i] = dst[i] * (1.0f - source[i]);
}

void blend_product(PixelFormat format, const float source[4], void *pixel)
{
    float *dst = pixel;
    if (format == FORMAT_RGBA16F)
        half_blend(product16f, source, pixel);
    else if (format_info(format)->kind == KIND_UNORM)
        unorm_blend(format, EQUATION_PRODUCT, false, source, pixel);
    else
        for (int i = 0; i < format_info(format)->channels; i++)
            dst[i] = op_canonical(op_mul(dst[i], op_sub(1.0f, source[i])));
}

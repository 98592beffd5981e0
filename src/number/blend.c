#include "number/blend.h"

#include "number/op.h"

#include <assert.h>

static void under32f(const float source[4], float dst[4])
{
    float transmittance = dst[3];
    for (int i = 0; i < 3; i++)
        dst[i] = op_canonical(op_add(op_mul(source[i], transmittance), dst[i]));
    /* The factor ZERO is a multiplication by 0 in the driver too. */
    dst[3] = op_canonical(
        op_add(op_mul(source[3], 0.0f), op_mul(transmittance, op_sub(1.0f, source[3]))));
}

static void seed32f(const float source[4], float dst[4])
{
    float transmittance = dst[3];
    for (int i = 0; i < 4; i++)
        dst[i] = op_canonical(op_add(op_mul(source[i], transmittance), dst[i]));
}

/* Source and destination are 16-bit integers, and so is the arithmetic. Not a correctly rounded
 * a·b/65535: see NUMBERS.md. */
static uint32_t multiply16(uint32_t a, uint32_t b)
{
    uint32_t product = a * b;
    product += product >> 16;
    return (product + 32768u) >> 16;
}

static uint16_t add_product16(uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t sum = multiply16(a, b) + c;
    return (uint16_t)(sum < 65535u ? sum : 65535u);
}

static void under16(const float source[4], uint16_t dst[4])
{
    uint32_t transmittance = dst[3];
    for (int i = 0; i < 3; i++)
        dst[i] = add_product16(unorm16_from_float(source[i]), transmittance, dst[i]);
    dst[3] = (uint16_t)multiply16(transmittance, 65535u - unorm16_from_float(source[3]));
}

static void seed16(const float source[4], uint16_t dst[4])
{
    uint32_t transmittance = dst[3];
    for (int i = 0; i < 4; i++)
        dst[i] = add_product16(unorm16_from_float(source[i]), transmittance, dst[i]);
}

static uint32_t multiply8(uint32_t a, uint32_t b)
{
    uint32_t product = a * b;
    product += product >> 8;
    return (product + 128u) >> 8;
}

static uint8_t add_product8(uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t sum = multiply8(a, b) + c;
    return (uint8_t)(sum < 255u ? sum : 255u);
}

static void under8(const float source[4], uint8_t dst[4])
{
    uint32_t transmittance = dst[3];
    for (int i = 0; i < 3; i++)
        dst[i] = add_product8(unorm8_from_float(source[i]), transmittance, dst[i]);
    dst[3] = (uint8_t)multiply8(transmittance, 255u - unorm8_from_float(source[3]));
}

static void seed8(const float source[4], uint8_t dst[4])
{
    uint32_t transmittance = dst[3];
    for (int i = 0; i < 4; i++)
        dst[i] = add_product8(unorm8_from_float(source[i]), transmittance, dst[i]);
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
        under32f(source, pixel);
        return;
    case FORMAT_RGBA16F:
        half_blend(under16f, source, pixel);
        return;
    case FORMAT_RGBA16:
        under16(source, pixel);
        return;
    case FORMAT_RGBA8:
        under8(source, pixel);
        return;
    default:
        assert(!"not an accumulation format");
    }
}

void blend_opaque_seed(PixelFormat format, const float source[4], void *pixel)
{
    switch (format) {
    case FORMAT_RGBA32F:
        seed32f(source, pixel);
        return;
    case FORMAT_RGBA16F:
        half_blend(seed16f, source, pixel);
        return;
    case FORMAT_RGBA16:
        seed16(source, pixel);
        return;
    case FORMAT_RGBA8:
        seed8(source, pixel);
        return;
    default:
        assert(!"not an accumulation format");
    }
}

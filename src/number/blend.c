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

/* The accumulation formats that view_build lets through. */
static bool is_unorm16(PixelFormat format)
{
    assert(format == FORMAT_RGBA16 || format == FORMAT_RGBA32F);
    return format == FORMAT_RGBA16;
}

void blend_clear(PixelFormat format, void *pixel)
{
    if (is_unorm16(format))
        memcpy(pixel, (const uint16_t[4]){0, 0, 0, 65535}, 4 * sizeof(uint16_t));
    else
        memcpy(pixel, (const float[4]){0, 0, 0, 1}, 4 * sizeof(float));
}

void blend_under(PixelFormat format, const float source[4], void *pixel)
{
    if (is_unorm16(format))
        under16(source, pixel);
    else
        under32f(source, pixel);
}

void blend_opaque_seed(PixelFormat format, const float source[4], void *pixel)
{
    if (is_unorm16(format))
        seed16(source, pixel);
    else
        seed32f(source, pixel);
}

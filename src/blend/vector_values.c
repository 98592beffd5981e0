/* Lists of codes and of special values. */
#include "blend/vector_values.h"

#include "number/op.h"

#include <assert.h>

/* Of 16 bits: both ends and the middle, 8-bit codes widened (times 257), powers of two and their
 * neighbours counted from either end, and codes without a pattern. */
static uint32_t code16(uint32_t k)
{
    enum {
        POWERS = 27
    };
    if (k < 32)
        return k;
    if (k < 64)
        return 65535 - (k - 32);
    if (k < 96)
        return 32752 + (k - 64);
    if (k < 160)
        return 257 * (4 * (k - 96) + 2);
    k -= 160;
    if (k < 2 * POWERS) {
        uint32_t power = (1u << (6 + k % POWERS / 3)) + k % 3 - 1;
        return k < POWERS ? power : 65535 - power;
    }
    return (k + 1) * 40503u & 65535u;
}

uint32_t vector_values_code(PixelFormat format, uint32_t k)
{
    assert(k < VECTOR_CODES);
    return format_info(format)->unorm_max == 255 ? k : code16(k);
}

float vector_values_unorm(PixelFormat format, uint32_t code)
{
    return (float)((double)code / format_info(format)->unorm_max);
}

static const float float_specials[] = {
    0.0f,
    -0.0f,
    0x1p-149f,
    -0x1p-149f,
    0x1.8p-148f,
    0x1p-130f,
    0x1p-127f,
    0x1.fffffcp-127f, /* the greatest denormal */
    -0x1.fffffcp-127f,
    0x1p-126f,
    -0x1p-126f,
    0x1.000002p-126f,
    0x1p-100f,
    0x1p-75f, /* its square is half the least denormal */
    0x1.000002p-75f,
    0x1p-64f,
    0x1.fffffep-64f,
    0x1p-63f, /* its square is the least normal number */
    0x1.6a09e6p-62f,
    0x1p-25f,
    0x1.000002p-25f,
    0x1p-24f,
    0x1.8p-24f,
    0x1p-23f,
    0x1p-12f,
    0x1.010102p-8f, /* 1/255 */
    0x1.99999ap-4f, /* 1/10 */
    0x1.555556p-2f, /* 1/3 */
    -0x1.555556p-2f,
    0.5f,
    -0.5f,
    0x1.010102p-1f, /* 128/255 */
    0x1.fdfdfep-1f, /* 254/255 */
    0x1.ffcp-1f,    /* 1 − 2^-11 */
    0x1.fffffep-1f, /* 1 − 2^-24 */
    -0x1.fffffep-1f,
    1.0f,
    -1.0f,
    0x1.000002p+0f,
    -0x1.000002p+0f,
    0x1.004p+0f,
    1.5f,
    2.0f,
    3.0f,
    255.0f,
    2049.0f,
    65504.0f,
    -65504.0f,
    0x1.ffdffep+15f, /* the last that rounds to the half 65504 */
    65520.0f,        /* the first that rounds to infinity */
    -65520.0f,
    65536.0f,
    0x1p+24f,
    0x1.000002p+24f,
    0x1.fffffep+63f,
    0x1p+64f, /* its square overflows */
    0x1.fffffep+102f,
    0x1p+103f, /* half a unit of the greatest float */
    0x1p+127f,
    0x1.fffffep+127f,
    -0x1.fffffep+127f,
    INFINITY,
    -INFINITY,
    NAN,
};

/* Halves, and floats half-way between two of them or next to there. */
static const float half_sources[] = {
    0.0f,
    -0.0f,
    0x1p-149f,
    0x1.fffffcp-127f,
    0x1p-126f,
    0x1p-26f,
    0x1p-25f, /* half the least denormal half */
    -0x1p-25f,
    0x1.000002p-25f,
    0x1p-24f,
    0x1.8p-24f,
    -0x1.8p-24f,
    0x1.7ffffep-24f,
    0x1p-15f,
    0x1.ff8p-15f,    /* the greatest denormal */
    0x1.ffcp-15f,    /* half-way from there to the least normal one */
    0x1.ffbffep-15f, /* below */
    0x1p-14f,
    -0x1p-14f,
    0x1.002p-14f, /* half-way to the next */
    0x1p-12f,
    0x1p-11f,
    0x1.010102p-8f,
    0x1.99999ap-4f,
    0x1.555556p-2f,
    -0x1.555556p-2f,
    0x1.554p-2f,
    0.5f,
    -0.5f,
    0x1.010102p-1f,
    0x1.fdfdfep-1f,
    0x1.ffcp-1f, /* 1 − 2^-11 */
    -0x1.ffcp-1f,
    0x1.ffdffep-1f,
    0x1.ffep-1f, /* half-way from 1 − 2^-11 to 1 */
    0x1.fffffep-1f,
    1.0f,
    -1.0f,
    0x1.000002p+0f,
    0x1.001ffep+0f,
    0x1.002p+0f, /* half-way from 1 to 1 + 2^-10 */
    0x1.002002p+0f,
    0x1.004p+0f,
    0x1.006p+0f, /* half-way, and to the other side when ties go to even */
    1.5f,
    2.0f,
    3.0f,
    255.0f,
    2048.0f,
    2049.0f,
    2051.0f,
    -2051.0f,
    65504.0f,
    -65504.0f,
    65512.0f,
    0x1.ffdffep+15f,
    65520.0f,
    -65520.0f,
    65536.0f,
    0x1p+64f,
    0x1.fffffep+127f,
    INFINITY,
    -INFINITY,
    NAN,
};

static const uint16_t half_specials[] = {
    0x0000, 0x8000, 0x0001, 0x8001, 0x0002, 0x0003, 0x0100, 0x0200, 0x03ff, 0x83ff,
    0x0400, 0x8400, 0x0401, 0x0600, 0x0800, 0x0c00, 0x1000, 0x1400, 0x1c04, /* 1/255 */
    0x2400, 0x2e66, 0x3400, 0x3555, 0xb555, 0x37ff, 0x3800, 0xb800, 0x3801, 0x3804,
    0x3a00, 0x3bf8, 0x3bfe, 0x3bff, 0xbbff, 0x3c00, 0xbc00, 0x3c01, 0xbc01, 0x3c02, /* 1 + 2^-9 */
    0x3e00, 0x3fff, 0x4000, 0x4001, 0x4200, 0x4900, 0x5bf8, 0x5c00, 0x67ff, 0x6800,
    0x6801, 0x7000, 0x77ff, 0x7800, 0x7801, 0xf800, 0x7bfd, 0x7bfe, 0xfbfe, 0x7bff, /* 65504 */
    0xfbff, 0x7c00, 0xfc00, 0x7e00, 0xbe00,
};

_Static_assert(sizeof float_specials == VECTOR_SPECIALS * sizeof(float), "special floats");
_Static_assert(sizeof half_sources == VECTOR_SPECIALS * sizeof(float), "special half sources");
_Static_assert(sizeof half_specials == VECTOR_SPECIALS * sizeof(uint16_t), "special halves");

static uint32_t unorm_special(PixelFormat format, uint32_t k)
{
    uint32_t max = format_info(format)->unorm_max;
    if (k < 16)
        return k;
    if (k < 32)
        return max - (k - 16);
    if (k < 48)
        return max / 2 - 7 + (k - 32);
    return (2 * k - 95) * (max / 32);
}

/* Out of range, tiny, codes, and half-way between two codes, as well as floats can be. */
static float unorm_special_source(PixelFormat format, uint32_t k)
{
    static const float bare[] = {
        -INFINITY,      -0x1.fffffep+127f, -1.0f,     -0x1p-24f, -0x1p-149f, -0.0f,
        0.0f,           0x1p-149f,         0x1p-126f, 0x1p-30f,  NAN,        INFINITY,
        0x1.fffffep-1f, 0x1.000002p+0f,    1.5f,      255.0f,    65536.0f,   0x1p+31f,
        0x1p+32f,       0x1.fffffep+127f,
    };
    enum {
        BARE = sizeof bare / sizeof *bare
    };
    if (k < BARE)
        return bare[k];
    k -= BARE;
    if (k % 2 == 0)
        return vector_values_unorm(format, unorm_special(format, k * 3 / 2));
    double half = unorm_special(format, k * 3 / 2) + 0.5, max = format_info(format)->unorm_max;
    float middle = (float)(half < max ? half / max : 0.5 / max);
    return op_from_bits(op_bits(middle) + k / 2 % 3 - 1);
}

float vector_values_special_source(PixelFormat format, uint32_t k)
{
    assert(k < VECTOR_SPECIALS);
    FormatKind kind = format_info(format)->kind;
    return kind == KIND_FLOAT  ? float_specials[k]
           : kind == KIND_HALF ? half_sources[k]
                               : unorm_special_source(format, k);
}

uint32_t vector_values_special_bits(PixelFormat format, uint32_t k)
{
    assert(k < VECTOR_SPECIALS);
    FormatKind kind = format_info(format)->kind;
    return kind == KIND_FLOAT  ? op_bits(float_specials[k])
           : kind == KIND_HALF ? half_specials[k]
                               : unorm_special(format, k);
}

uint32_t vector_values_bits(PixelFormat format, float x)
{
    const FormatInfo *info = format_info(format);
    if (info->kind == KIND_FLOAT)
        return op_bits(x);
    if (info->kind == KIND_HALF)
        return half_from_float(x);
    double code = (double)x * info->unorm_max + 0.5;
    return !(code > 0.0) ? 0 : code < info->unorm_max ? (uint32_t)code : info->unorm_max;
}

#include "number/format.h"

#include "number/op.h"

#include <assert.h>
#include <string.h>

static const FormatInfo infos[FORMAT_COUNT + 1] = {
    [FORMAT_RGBA32F] = {"rgba32f", KIND_FLOAT, 4, 4, 0},
    [FORMAT_RGBA16F] = {"rgba16f", KIND_HALF, 4, 2, 0},
    [FORMAT_RGBA16] = {"rgba16", KIND_UNORM, 4, 2, 65535},
    [FORMAT_RGBA8] = {"rgba8", KIND_UNORM, 4, 1, 255},
    [FORMAT_RG16] = {"rg16", KIND_UNORM, 2, 2, 65535},
    [FORMAT_RG32F] = {"rg32f", KIND_FLOAT, 2, 4, 0},
    [FORMAT_D32F] = {"d32f", KIND_FLOAT, 1, 4, 0},
    [FORMAT_D24] = {"d24", KIND_UNORM, 1, 4, 16777215},
    [FORMAT_D16] = {"d16", KIND_UNORM, 1, 4, 65535},
    [FORMAT_R32UI] = {"r32ui", KIND_UINT, 1, 4, 0},
    [FORMAT_R32F] = {"r32f", KIND_FLOAT, 1, 4, 0},
    [FORMAT_NONE] = {"none", KIND_UINT, 0, 0, 0},
};

const FormatInfo *format_info(PixelFormat format)
{
    return &infos[format];
}

bool format_find(const char *name, PixelFormat *out)
{
    for (int i = 0; i < FORMAT_COUNT; i++)
        if (strcmp(infos[i].name, name) == 0) {
            *out = (PixelFormat)i;
            return true;
        }
    return false;
}

size_t format_pixel_bytes(PixelFormat format)
{
    return (size_t)infos[format].channels * (size_t)infos[format].channel_bytes;
}

uint32_t format_bits(PixelFormat format, const void *pixel, int channel)
{
    const FormatInfo *info = &infos[format];
    const unsigned char *at = (const unsigned char *)pixel + channel * info->channel_bytes;
    uint32_t bits = 0;
    if (info->channel_bytes == 1) {
        bits = *at;
    } else if (info->channel_bytes == 2) {
        uint16_t half;
        memcpy(&half, at, sizeof half);
        bits = half;
    } else {
        memcpy(&bits, at, sizeof bits);
    }
    return bits;
}

void format_set_bits(PixelFormat format, void *pixel, int channel, uint32_t bits)
{
    const FormatInfo *info = &infos[format];
    unsigned char *at = (unsigned char *)pixel + channel * info->channel_bytes;
    uint16_t word = (uint16_t)bits;
    if (info->channel_bytes == 1)
        *at = (unsigned char)bits;
    else if (info->channel_bytes == 2)
        memcpy(at, &word, sizeof word);
    else
        memcpy(at, &bits, sizeof bits);
}

float format_channel(PixelFormat format, const void *pixel, int channel)
{
    const FormatInfo *info = &infos[format];
    uint32_t bits = format_bits(format, pixel, channel);
    switch (info->kind) {
    case KIND_FLOAT:
        return op_from_bits(bits);
    case KIND_HALF:
        return half_to_float((uint16_t)bits);
    case KIND_UNORM:
        return (float)((double)bits / info->unorm_max);
    case KIND_UINT:
        break;
    }
    return (float)bits;
}

void format_store(PixelFormat format, const float value[4], void *pixel)
{
    const FormatInfo *info = &infos[format];
    uint8_t *bytes = pixel;
    assert(info->channels != 1 || format == FORMAT_R32F);
    for (int i = 0; i < info->channels; i++) {
        uint16_t word;
        if (info->kind == KIND_FLOAT) {
            memcpy(bytes + 4 * i, &value[i], sizeof value[i]);
        } else if (info->channel_bytes == 1) {
            bytes[i] = unorm8_from_float(value[i]);
        } else {
            word =
                info->kind == KIND_UNORM ? unorm16_from_float(value[i]) : half_from_float(value[i]);
            memcpy(bytes + 2 * i, &word, sizeof word);
        }
    }
}

void format_fetch(PixelFormat format, const void *pixel, float value[4])
{
    const FormatInfo *info = &infos[format];
    const uint8_t *bytes = pixel;
    assert(info->channels != 1 || format == FORMAT_R32F);
    for (int i = info->channels; i < 4; i++)
        value[i] = i == 3 ? 1.0f : 0.0f;
    for (int i = 0; i < info->channels; i++) {
        uint16_t word;
        if (info->kind == KIND_FLOAT) {
            memcpy(&value[i], bytes + 4 * i, sizeof value[i]);
        } else if (info->channel_bytes == 1) {
            value[i] = unorm8_to_float(bytes[i]);
        } else {
            memcpy(&word, bytes + 2 * i, sizeof word);
            value[i] = info->kind == KIND_UNORM ? unorm16_to_float(word) : half_to_float(word);
        }
    }
}

uint8_t unorm8_from_float(float x)
{
    return (uint8_t)op_round_to_int(op_mul(op_saturate(x), 255.0f));
}

float unorm8_to_float(uint8_t i)
{
    return op_mul((float)i, (float)(1.0 / 255.0));
}

uint16_t unorm16_from_float(float x)
{
    return (uint16_t)op_round_to_int(op_mul(op_saturate(x), 65535.0f));
}

uint16_t unorm16_from_clear(float x)
{
    return (uint16_t)op_add(op_mul(op_saturate(x), 65535.0f), 0.5f);
}

float unorm16_to_float(uint16_t i)
{
    return op_mul((float)i, (float)(1.0 / 65535.0));
}

uint16_t half_from_float(float x)
{
    uint32_t bits = op_bits(x);
    uint32_t sign = bits >> 16 & 0x8000u;
    uint32_t exponent = bits >> 23 & 0xffu;
    uint32_t mantissa = bits & 0x7fffffu;
    if (exponent == 255)
        return (uint16_t)(sign | 0x7c00u | (mantissa ? 0x200u | mantissa >> 13 : 0));
    int power = (int)exponent - 127;
    if (power > 15)
        return (uint16_t)(sign | 0x7bffu);
    if (power >= -14)
        return (uint16_t)(sign | (uint32_t)(power + 15) << 10 | mantissa >> 13);
    if (power < -24 || exponent == 0)
        return (uint16_t)sign;
    return (uint16_t)(sign | (mantissa | 0x800000u) >> (-1 - power));
}

float half_to_float(uint16_t half)
{
    uint32_t sign = (uint32_t)(half & 0x8000u) << 16;
    uint32_t exponent = half >> 10 & 31u;
    uint32_t mantissa = half & 1023u;
    if (exponent == 31)
        return op_from_bits(sign | 0x7f800000u | (mantissa ? 0x400000u | mantissa << 13 : 0));
    if (exponent)
        return op_from_bits(sign | (exponent + 112) << 23 | mantissa << 13);
    float magnitude = (float)mantissa * 0x1p-24f; /* exact, and normal as a float */
    return op_from_bits(sign | op_bits(magnitude));
}

float depth32f_from_float(float z)
{
    /* The order of the two tests is the driver's: NaN becomes 1, not 0. */
    z = op_flush(z);
    float low = z < 1.0f ? z : 1.0f;
    return low > 0.0f ? low : 0.0f;
}

uint32_t depth24_from_float(float z)
{
    return (uint32_t)op_round_to_int(op_mul(depth32f_from_float(z), 16777215.0f));
}

float depth24_to_float(uint32_t depth)
{
    return op_mul((float)depth, (float)(1.0 / 16777215.0));
}

uint32_t depth16_from_float(float z)
{
    /* 128 has a unit of 2^-16 in its mantissa. */
    return op_bits(op_add(op_mul(depth32f_from_float(z), 65535.0f / 65536.0f), 128.0f)) & 0xffffu;
}

float depth16_to_float(uint32_t depth)
{
    return op_mul((float)depth, (float)(1.0 / 65535.0));
}

/* Maps the bits of a sign-magnitude number to integers in the order of the numbers; −0 and +0
 * are neighbours. */
static int64_t ordered(uint32_t magnitude, bool negative)
{
    return negative ? -(int64_t)magnitude - 1 : (int64_t)magnitude;
}

static uint32_t distance(int64_t a, int64_t b)
{
    return (uint32_t)(a > b ? a - b : b - a);
}

uint32_t ulp_distance(float a, float b)
{
    if (a != a || b != b)
        return a != a && b != b ? 0 : UINT32_MAX;
    return distance(ordered(op_bits(a) & 0x7fffffffu, op_bits(a) >> 31),
                    ordered(op_bits(b) & 0x7fffffffu, op_bits(b) >> 31));
}

uint32_t ulp_distance_half(uint16_t a, uint16_t b)
{
    bool a_nan = (a & 0x7fffu) > 0x7c00u, b_nan = (b & 0x7fffu) > 0x7c00u;
    if (a_nan || b_nan)
        return a_nan && b_nan ? 0 : UINT32_MAX;
    return distance(ordered(a & 0x7fffu, a >> 15), ordered(b & 0x7fffu, b >> 15));
}

uint32_t format_ulp(FormatKind kind, uint32_t a, uint32_t b)
{
    if (kind == KIND_FLOAT)
        return ulp_distance(op_from_bits(a), op_from_bits(b));
    if (kind == KIND_HALF)
        return ulp_distance_half((uint16_t)a, (uint16_t)b);
    return a > b ? a - b : b - a;
}

bool format_overflowed(PixelFormat format, const void *pixel)
{
    const FormatInfo *info = &infos[format];
    bool overflowed = false;
    for (int i = 0; i < info->channels; i++) {
        uint32_t bits = format_bits(format, pixel, i);
        if (info->kind == KIND_HALF)
            overflowed |= (bits & 0x7fffu) >= 0x7bffu;
        if (info->kind == KIND_FLOAT)
            overflowed |= (bits & 0x7f800000u) == 0x7f800000u;
    }
    return overflowed;
}

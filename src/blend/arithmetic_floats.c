/* Float operations to nearest, many pixels at a time, with the processor's own: what
 * arithmetic_steps.c defines channel by channel, bit-compared with it by
 * tests/unit/test_arithmetic_steps.c. With flush in flushing mode, without it outside. */
#include "blend/arithmetic_parts.h"
#include "number/blend_codes.h"
#include "number/blend_float.h"
#include "number/op.h"

#include <math.h>
#include <string.h>

#define ALWAYS_INLINE static inline __attribute__((always_inline))

enum {
    BLOCK = 64 /* pixels whose sums wait to be stored */
};

ALWAYS_INLINE float muladd(bool flush, float a, float b, float c)
{
    return flush ? op_fma(a, b, c) : fmaf(a, b, c);
}

ALWAYS_INLINE float sum_of(bool flush, bool fused, const ChannelEquation *part, float s, float d,
                           float source_alpha, float destination_alpha)
{
    if (blend_func_extreme(part->func))
        return (part->func == BLEND_FUNC_MAX ? s > d : s < d) ? s : d;
    float f =
        blend_float_factor(flush, part->alpha, part->source, s, d, source_alpha, destination_alpha);
    float g = blend_float_factor(flush, part->alpha, part->destination, s, d, source_alpha,
                                 destination_alpha);
    if (part->func == BLEND_FUNC_REVERSE_SUBTRACT)
        s = -s;
    if (part->func == BLEND_FUNC_SUBTRACT)
        d = -d;
    if (!fused)
        return blend_float_add(flush, blend_float_mul(flush, s, f), blend_float_mul(flush, d, g));
    if (part->destination == FACTOR_ONE)
        return muladd(flush, s, f, d);
    return muladd(flush, d, g, blend_float_mul(flush, s, f));
}

typedef struct FloatBlend {
    ChannelEquation rgb, alpha;
    const FormatInfo *info;
    bool fused;
} FloatBlend;

/* Operands in, sums out; both 4·count. */
ALWAYS_INLINE void sums_of(bool flush, const FloatBlend *blend, size_t count,
                           const float (*source)[4], float (*stored)[4])
{
    int channels = blend->info->channels;
    bool unorm = blend->info->kind == KIND_UNORM;
    for (size_t k = 0; k < count; k++) {
        float s[4];
        for (int i = 0; i < 4; i++) {
            s[i] = source[k][i];
            if (unorm)
                s[i] = s[i] > 0.0f ? s[i] < 1.0f ? s[i] : 1.0f : 0.0f;
            if (flush) {
                s[i] = op_flush(s[i]);
                stored[k][i] = op_flush(stored[k][i]);
            }
        }
        float destination_alpha = stored[k][3];
        for (int i = 0; i < channels; i++)
            stored[k][i] = sum_of(flush, blend->fused, i == 3 ? &blend->alpha : &blend->rgb, s[i],
                                  stored[k][i], s[3], destination_alpha);
    }
}

static __attribute__((noinline)) void sums_kept(const FloatBlend *blend, size_t count,
                                                const float (*source)[4], float (*stored)[4])
{
    sums_of(false, blend, count, source, stored);
}

static __attribute__((noinline)) void sums_flushed(const FloatBlend *blend, size_t count,
                                                   const float (*source)[4], float (*stored)[4])
{
    sums_of(true, blend, count, source, stored);
}

static void block(const Arithmetic *arithmetic, PixelFormat format, const FloatBlend *blend,
                  size_t count, const float (*source)[4], unsigned char *pixels)
{
    float values[BLOCK][4];
    size_t bytes = format_pixel_bytes(format);
    const FormatInfo *info = blend->info;
    for (size_t k = 0; k < count; k++)
        for (int i = 0; i < 4; i++)
            values[k][i] =
                i < info->channels ? format_channel(format, pixels + bytes * k, i) : 1.0f;
    if (arithmetic->flush) {
        uint32_t mode = op_enter();
        sums_flushed(blend, count, source, values);
        op_leave(mode);
    } else {
        sums_kept(blend, count, source, values);
    }
    for (size_t k = 0; k < count; k++)
        for (int i = 0; i < info->channels; i++)
            arithmetic_put(format, pixels + bytes * k, i,
                           arithmetic_store(arithmetic, info, (double)values[k][i]));
}

bool arithmetic_floats_blend(const Arithmetic *arithmetic, const BlendEquation *equation,
                             PixelFormat format, size_t count, const float (*source)[4],
                             void *pixels)
{
    const FloatBlend blend = {.rgb = channel_equation(equation, 0),
                              .alpha = channel_equation(equation, 3),
                              .info = format_info(format),
                              .fused = arithmetic->fused};
    if (arithmetic->kind != ARITHMETIC_STEPS || arithmetic->mistakes ||
        arithmetic->precision != PRECISION_FLOAT || arithmetic->rounding != BLEND_NEAREST_EVEN ||
        arithmetic->source_stored)
        return false;
    for (size_t at = 0; at < count; at += BLOCK) {
        size_t left = count - at;
        block(arithmetic, format, &blend, left < BLOCK ? left : BLOCK, source + at,
              (unsigned char *)pixels + at * format_pixel_bytes(format));
    }
    return true;
}

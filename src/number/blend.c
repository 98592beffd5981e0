/* One model of all equations, after what llvmpipe's code for them does: which products it leaves
 * out, and where it factors out what both have. The functions with names are instances of it with a
 * constant equation, so that the compiler leaves nothing of the model's decisions. */
#include "number/blend.h"

#include "number/blend_codes.h"
#include "number/blend_float.h"
#include "number/op.h"

#include <assert.h>

#define ALWAYS_INLINE static inline __attribute__((always_inline))

/* The colours' or alpha's part of an equation. Factors are vectors of four channels to the driver,
 * so one is a constant only where the colours' and alpha's are the same constant: nothing is
 * multiplied by the constant 1, and a product with the constant 0 is not there. */
typedef struct Part {
    BlendFactor source, destination;
    BlendFunc func;
    bool alpha;
    bool source_one, source_none, destination_one, destination_none;
    bool linked; /* floats whose factors are looked at together: see linked_sum */
} Part;

ALWAYS_INLINE BlendFactor without_alpha(BlendFactor factor)
{
    return factor == FACTOR_DST_ALPHA             ? FACTOR_ONE
           : factor == FACTOR_ONE_MINUS_DST_ALPHA ? FACTOR_ZERO
                                                  : factor;
}

ALWAYS_INLINE bool is_constant(BlendFactor value, BlendFactor rgb, BlendFactor alpha,
                               bool has_alpha)
{
    if (alpha == FACTOR_SRC_ALPHA_SATURATE)
        alpha = FACTOR_ONE;
    return rgb == value && (!has_alpha || alpha == value);
}

ALWAYS_INLINE Part part_of(const BlendEquation *equation, int channels, bool alpha)
{
    BlendEquation e = *equation;
    bool has_alpha = channels == 4;
    if (blend_func_extreme(e.func))
        e.source = e.destination = FACTOR_ONE;
    if (blend_func_extreme(e.func_alpha))
        e.source_alpha = e.destination_alpha = FACTOR_ONE;
    if (!has_alpha) {
        e.source = without_alpha(e.source);
        e.destination = without_alpha(e.destination);
    }
    bool same = e.source == e.destination && (!has_alpha || e.source_alpha == e.destination_alpha);
    return (Part){
        .source = alpha ? e.source_alpha : e.source,
        .destination = alpha ? e.destination_alpha : e.destination,
        .func = alpha ? e.func_alpha : e.func,
        .alpha = alpha,
        .source_one = is_constant(FACTOR_ONE, e.source, e.source_alpha, has_alpha),
        .source_none = is_constant(FACTOR_ZERO, e.source, e.source_alpha, has_alpha),
        .destination_one = is_constant(FACTOR_ONE, e.destination, e.destination_alpha, has_alpha),
        .destination_none = is_constant(FACTOR_ZERO, e.destination, e.destination_alpha, has_alpha),
        .linked = same || channels == 1,
    };
}

/* ---- floats; with flush in flushing mode, without it outside ----------------------------------
 */

ALWAYS_INLINE float combine(bool flush, BlendFunc func, float a, float b)
{
    return func == BLEND_FUNC_ADD        ? blend_float_add(flush, a, b)
           : func == BLEND_FUNC_SUBTRACT ? blend_float_sub(flush, a, b)
                                         : blend_float_sub(flush, b, a);
}

/* x and 1 − x, or 1 and 0. */
ALWAYS_INLINE bool complementary(BlendFactor a, BlendFactor b)
{
    return ((int)a ^ 1) == (int)b && a != FACTOR_SRC_ALPHA_SATURATE;
}

ALWAYS_INLINE bool is_complement(BlendFactor factor)
{
    return factor == FACTOR_ZERO || (factor != FACTOR_ONE && (int)factor % 2 == 1);
}

/* from + x·(to − from). */
ALWAYS_INLINE float lerp(bool flush, bool fused, float x, float from, float to)
{
    float delta = blend_float_sub(flush, to, from);
    if (fused)
        return flush ? op_fma(x, delta, from) : __builtin_fmaf(x, delta, from);
    return blend_float_add(flush, blend_float_mul(flush, x, delta), from);
}

/* Complementary factors, of formats with one channel only: s·x ± d·(1 − x) as a linear
 * interpolation, or as (s + d)·x less one of them. f and g are the factors' values. */
ALWAYS_INLINE float complement_sum(bool flush, bool fused, const Part *part, float s, float d,
                                   float f, float g)
{
    bool swapped = is_complement(part->source); /* the destination's factor is x */
    float x = swapped ? g : f;
    if (part->func == BLEND_FUNC_ADD)
        return swapped ? lerp(flush, fused, x, s, d) : lerp(flush, fused, x, d, s);
    float sum = blend_float_mul(flush, blend_float_add(flush, s, d), x);
    if (part->func == BLEND_FUNC_SUBTRACT)
        return swapped ? blend_float_sub(flush, s, sum) : blend_float_sub(flush, sum, d);
    return swapped ? blend_float_sub(flush, sum, s) : blend_float_sub(flush, d, sum);
}

ALWAYS_INLINE float float_channel(bool flush, bool fused, const Part *part, float s, float d,
                                  float source_alpha, float destination_alpha)
{
    if (part->func == BLEND_FUNC_MIN)
        return s < d ? s : d;
    if (part->func == BLEND_FUNC_MAX)
        return s > d ? s : d;
    float f =
        blend_float_factor(flush, part->alpha, part->source, s, d, source_alpha, destination_alpha);
    float g = blend_float_factor(flush, part->alpha, part->destination, s, d, source_alpha,
                                 destination_alpha);
    if (part->linked && complementary(part->source, part->destination))
        return complement_sum(flush, fused, part, s, d, f, g);
    if (part->linked && part->source == part->destination) { /* (s ± d)·f */
        float sum = combine(flush, part->func, s, d);
        return part->source_none  ? 0.0f
               : part->source_one ? op_kept(sum)
                                  : blend_float_mul(flush, sum, f);
    }
    float p = part->source_none  ? 0.0f
              : part->source_one ? op_kept(s)
                                 : blend_float_mul(flush, s, f);
    float q = part->destination_none  ? 0.0f
              : part->destination_one ? op_kept(d)
                                      : blend_float_mul(flush, d, g);
    if (part->destination_none && part->func != BLEND_FUNC_REVERSE_SUBTRACT)
        return op_kept(p);
    if (part->source_none && part->func != BLEND_FUNC_SUBTRACT)
        return op_kept(q);
    return combine(flush, part->func, p, q);
}

ALWAYS_INLINE void float_channels(bool flush, bool fused, const Part parts[2], int channels,
                                  const float s[4], const float d[4], float out[4])
{
    float destination_alpha = channels == 4 ? d[3] : 1.0f;
    for (int i = 0; i < channels; i++)
        out[i] = op_canonical(
            float_channel(flush, fused, &parts[i == 3], s[i], d[i], s[3], destination_alpha));
}

/* A denormal that went through no operation is flushed where it is stored. */
ALWAYS_INLINE void float_pixel(bool fused, const Part parts[2], int channels, const float source[4],
                               float *pixel)
{
    float out[4];
    float_channels(true, fused, parts, channels, source, pixel, out);
    for (int i = 0; i < channels; i++)
        pixel[i] = blend_func_extreme(parts[i == 3].func) ? op_flush(out[i]) : out[i];
}

/* Half floats are blended as floats and truncated, and there the driver keeps denormals. */
typedef void HalfBlend(const Part parts[2], const float s[4], const float d[4], float out[4]);

static __attribute__((noinline)) void half_channels(const Part parts[2], const float s[4],
                                                    const float d[4], float out[4])
{
    float_channels(false, false, parts, 4, s, d, out);
}

ALWAYS_INLINE void half_pixel(HalfBlend *blend, const Part parts[2], const float source[4],
                              void *pixel)
{
    float d[4], out[4];
    format_fetch(FORMAT_RGBA16F, pixel, d);
    uint32_t flushing = op_suspend();
    blend(parts, source, d, out);
    op_leave(flushing);
    format_store(FORMAT_RGBA16F, out, pixel);
}

/* ---- integers ---------------------------------------------------------------------------------
 */

/* a·b/(2^bits − 1) as the driver rounds it: not always correctly, see NUMBERS.md. bits ≤ 16. */
ALWAYS_INLINE uint32_t multiply(int bits, uint32_t a, uint32_t b)
{
    uint32_t product = a * b;
    product += product >> bits;
    return (product + (1u << (bits - 1))) >> bits;
}

ALWAYS_INLINE uint32_t code_channel(int bits, const Part *part, int64_t s, int64_t d,
                                    int64_t source_alpha, int64_t destination_alpha)
{
    int64_t most = (1 << bits) - 1;
    if (blend_func_extreme(part->func))
        return (uint32_t)blend_codes_combine(part->func, s, d);
    int64_t f =
        blend_codes_factor(most, part->source, part->alpha, s, d, source_alpha, destination_alpha);
    int64_t g = blend_codes_factor(most, part->destination, part->alpha, s, d, source_alpha,
                                   destination_alpha);
    /* A product with 0 is 0 and one with 1 is the other factor. */
    int64_t p = part->source == FACTOR_ONE ? s : multiply(bits, (uint32_t)s, (uint32_t)f);
    int64_t q = part->destination == FACTOR_ONE ? d : multiply(bits, (uint32_t)d, (uint32_t)g);
    int64_t sum = blend_codes_combine(part->func, p, q);
    return (uint32_t)(sum < 0 ? 0 : sum < most ? sum : most);
}

/* RGBA8 and RGBA16: the source is stored first, then the arithmetic is that of integers. */
ALWAYS_INLINE void code_pixel(int bits, const Part parts[2], const float source[4], void *pixel)
{
    PixelFormat format = bits == 8 ? FORMAT_RGBA8 : FORMAT_RGBA16;
    unsigned char stored[4 * sizeof(uint16_t)];
    format_store(format, source, stored);
    int64_t source_alpha = format_bits(format, stored, 3);
    int64_t destination_alpha = format_bits(format, pixel, 3);
    for (int i = 0; i < 4; i++) {
        uint32_t value =
            code_channel(bits, &parts[i == 3], format_bits(format, stored, i),
                         format_bits(format, pixel, i), source_alpha, destination_alpha);
        if (bits == 8)
            ((uint8_t *)pixel)[i] = (uint8_t)value;
        else
            ((uint16_t *)pixel)[i] = (uint16_t)value;
    }
}

/* ---- pixels -----------------------------------------------------------------------------------
 */

ALWAYS_INLINE void blend_pixel(HalfBlend *half, bool fused, const BlendEquation *equation,
                               PixelFormat format, size_t count, const float (*source)[4],
                               void *pixels)
{
    const Part parts[2] = {part_of(equation, 4, false), part_of(equation, 4, true)};
    const Part narrow[2] = {part_of(equation, 2, false), part_of(equation, 2, true)};
    const Part single[2] = {part_of(equation, 1, false), part_of(equation, 1, true)};
    switch (format) {
    case FORMAT_RGBA32F:
        for (size_t i = 0; i < count; i++)
            float_pixel(fused, parts, 4, source[i], (float *)pixels + 4 * i);
        return;
    case FORMAT_RG32F:
        for (size_t i = 0; i < count; i++)
            float_pixel(fused, narrow, 2, source[i], (float *)pixels + 2 * i);
        return;
    case FORMAT_R32F:
        for (size_t i = 0; i < count; i++)
            float_pixel(fused, single, 1, source[i], (float *)pixels + i);
        return;
    case FORMAT_RGBA16F:
        for (size_t i = 0; i < count; i++)
            half_pixel(half, parts, source[i], (uint16_t *)pixels + 4 * i);
        return;
    case FORMAT_RGBA16:
        for (size_t i = 0; i < count; i++)
            code_pixel(16, parts, source[i], (uint16_t *)pixels + 4 * i);
        return;
    case FORMAT_RGBA8:
        for (size_t i = 0; i < count; i++)
            code_pixel(8, parts, source[i], (uint8_t *)pixels + 4 * i);
        return;
    default:
        assert(!"not an accumulation format");
    }
}

void blend_pixels(const BlendEquation *equation, bool fused, PixelFormat format, size_t count,
                  const float (*source)[4], void *pixels)
{
    blend_pixel(half_channels, fused, equation, format, count, source, pixels);
}

void blend_clear(PixelFormat format, void *pixel)
{
    format_store(format, (const float[4]){0, 0, 0, 1}, pixel);
}

/* A function of its own for one equation. None of them has complementary factors in a format of one
 * channel that ref blends in, so it does not matter whether the driver fuses. */
#define NAMED(name, ...)                                                                           \
    static const BlendEquation name##_equation = __VA_ARGS__;                                      \
    static __attribute__((noinline)) void name##_half(const Part parts[2], const float s[4],       \
                                                      const float d[4], float out[4])              \
    {                                                                                              \
        (void)parts;                                                                               \
        const Part own[2] = {part_of(&name##_equation, 4, false),                                  \
                             part_of(&name##_equation, 4, true)};                                  \
        float_channels(false, false, own, 4, s, d, out);                                           \
    }                                                                                              \
    void name(PixelFormat format, const float source[4], void *pixel)                              \
    {                                                                                              \
        blend_pixel(name##_half, false, &name##_equation, format, 1, (const float(*)[4])source,    \
                    pixel);                                                                        \
    }

NAMED(blend_under, BLEND_EQUATION_UNDER)
NAMED(blend_opaque_seed, BLEND_EQUATION_SEED)
NAMED(blend_over, BLEND_EQUATION_OVER_TRANSMITTANCE)
NAMED(blend_add, BLEND_EQUATION_ADD)
NAMED(blend_product, BLEND_EQUATION_PRODUCT)
NAMED(blend_max, BLEND_EQUATION_MAX)
NAMED(blend_replace, BLEND_EQUATION_REPLACE)
NAMED(blend_keep, BLEND_EQUATION_KEEP)

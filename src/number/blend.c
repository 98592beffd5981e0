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
    CODES_UNDER,   /* s·T + d */
    CODES_OVER,    /* s + d·(1 − source alpha) */
    CODES_REPLACE, /* s·(source alpha) + d·(1 − source alpha) */
    CODES_KEEP,    /* s·(1 − T) + d */
    CODES_ADD,
    CODES_PRODUCT, /* d·(1 − s) */
    CODES_MAX
} Equation;

static uint32_t unorm_equation(Equation equation, int bits, uint32_t s, uint32_t d,
                               uint32_t source_alpha, uint32_t transmittance)
{
    uint32_t most = (1u << bits) - 1, sum = s + d;
    if (equation == CODES_MAX)
        return s > d ? s : d;
    if (equation == CODES_UNDER)
        sum = multiply(bits, s, transmittance) + d;
    if (equation == CODES_PRODUCT)
        return multiply(bits, d, most - s);
    if (equation == CODES_OVER)
        sum = s + multiply(bits, d, most - source_alpha);
    if (equation == CODES_REPLACE)
        sum = multiply(bits, s, source_alpha) + multiply(bits, d, most - source_alpha);
    if (equation == CODES_KEEP)
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
        unorm_blend(format, CODES_UNDER, true, source, pixel);
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
        unorm_blend(format, CODES_UNDER, false, source, pixel);
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
        unorm_blend(format, CODES_OVER, true, source, pixel);
}

void blend_add(PixelFormat format, const float source[4], void *pixel)
{
    float *dst = pixel;
    if (format == FORMAT_RGBA16F)
        half_blend(add16f, source, pixel);
    else if (format_info(format)->kind == KIND_UNORM)
        unorm_blend(format, CODES_ADD, false, source, pixel);
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
        unorm_blend(format, CODES_MAX, false, source, pixel);
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
        unorm_blend(format, CODES_REPLACE, false, source, pixel);
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
        unorm_blend(format, CODES_KEEP, false, source, pixel);
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
        unorm_blend(format, CODES_PRODUCT, false, source, pixel);
    else
        for (int i = 0; i < format_info(format)->channels; i++)
            dst[i] = op_canonical(op_mul(dst[i], op_sub(1.0f, source[i])));
}

/* ---- any equation ---- */

/* What the driver makes of factors before it blends. */
typedef struct Class {
    BlendFactor source, destination;
    BlendFunc func;
    bool source_absent, destination_absent; /* its product is the constant 0, and is not added */
    bool source_plain, destination_plain; /* the factor is the constant 1: nothing is multiplied */
    bool linked;                          /* see linked_blend */
} Class;

static inline BlendFactor without_alpha(BlendFactor factor)
{
    return factor == FACTOR_DST_ALPHA             ? FACTOR_ONE
           : factor == FACTOR_ONE_MINUS_DST_ALPHA ? FACTOR_ZERO
                                                  : factor;
}

static inline bool extreme(BlendFunc func)
{
    return func == BLEND_FUNC_MIN || func == BLEND_FUNC_MAX;
}

static inline bool constant(BlendFactor value, BlendFactor rgb, BlendFactor alpha, int channels)
{
    if (channels == 4 && alpha == FACTOR_SRC_ALPHA_SATURATE)
        alpha = FACTOR_ONE;
    return rgb == value && (channels < 4 || alpha == value);
}

static inline Class class_of(const BlendEquation *equation, int channels, bool alpha)
{
    BlendEquation e = *equation;
    if (extreme(e.func))
        e.source = e.destination = FACTOR_ONE;
    if (extreme(e.func_alpha))
        e.source_alpha = e.destination_alpha = FACTOR_ONE;
    if (channels < 4) {
        e.source = without_alpha(e.source);
        e.destination = without_alpha(e.destination);
    }
    Class class = {.source = alpha ? e.source_alpha : e.source,
                   .destination = alpha ? e.destination_alpha : e.destination,
                   .func = alpha ? e.func_alpha : e.func};
    class.source_absent = constant(FACTOR_ZERO, e.source, e.source_alpha, channels);
    class.source_plain = constant(FACTOR_ONE, e.source, e.source_alpha, channels);
    class.destination_absent = constant(FACTOR_ZERO, e.destination, e.destination_alpha, channels);
    class.destination_plain = constant(FACTOR_ONE, e.destination, e.destination_alpha, channels);
    class.linked = channels == 1 || (e.source == e.destination &&
                                     (channels < 4 || e.source_alpha == e.destination_alpha));
    return class;
}

static inline float plus(bool flush, float a, float b)
{
    return flush ? op_add(a, b) : a + b;
}

static inline float minus(bool flush, float a, float b)
{
    return flush ? op_sub(a, b) : a - b;
}

static inline float times(bool flush, float a, float b)
{
    return flush ? op_mul(a, b) : a * b;
}

static inline float factor_value(bool flush, BlendFactor factor, bool alpha, float s, float d,
                                 float source_alpha, float destination_alpha)
{
    float room;
    switch (factor) {
    case FACTOR_ZERO:
        return 0.0f;
    case FACTOR_SRC_COLOR:
        return s;
    case FACTOR_ONE_MINUS_SRC_COLOR:
        return minus(flush, 1.0f, s);
    case FACTOR_DST_COLOR:
        return d;
    case FACTOR_ONE_MINUS_DST_COLOR:
        return minus(flush, 1.0f, d);
    case FACTOR_SRC_ALPHA:
        return source_alpha;
    case FACTOR_ONE_MINUS_SRC_ALPHA:
        return minus(flush, 1.0f, source_alpha);
    case FACTOR_DST_ALPHA:
        return destination_alpha;
    case FACTOR_ONE_MINUS_DST_ALPHA:
        return minus(flush, 1.0f, destination_alpha);
    case FACTOR_SRC_ALPHA_SATURATE:
        if (alpha)
            return 1.0f;
        room = minus(flush, 1.0f, destination_alpha);
        return source_alpha < room ? source_alpha : room;
    default:
        return 1.0f;
    }
}

static inline float combine(bool flush, BlendFunc func, float a, float b)
{
    return func == BLEND_FUNC_ADD        ? plus(flush, a, b)
           : func == BLEND_FUNC_SUBTRACT ? minus(flush, a, b)
                                         : minus(flush, b, a);
}

static inline bool complementary(BlendFactor a, BlendFactor b)
{
    return (a ^ 1) == b && a != FACTOR_SRC_ALPHA_SATURATE && b != FACTOR_SRC_ALPHA_SATURATE;
}

static inline float lerp(bool flush, bool fused, float x, float from, float to)
{
    float delta = minus(flush, to, from);
    if (!fused)
        return plus(flush, times(flush, x, delta), from);
    return flush ? op_fma(x, delta, from) : __builtin_fmaf(x, delta, from);
}

static inline float float_channel(bool flush, bool fused, const Class *class, bool alpha, float s,
                                  float d, float source_alpha, float destination_alpha)
{
    if (class->func == BLEND_FUNC_MIN)
        return s < d ? s : d;
    if (class->func == BLEND_FUNC_MAX)
        return s > d ? s : d;
    float f = factor_value(flush, class->source, alpha, s, d, source_alpha, destination_alpha);
    float g = factor_value(flush, class->destination, alpha, s, d, source_alpha, destination_alpha);
    if (class->linked && complementary(class->source, class->destination)) {
        bool inverse =
            class->source == FACTOR_ZERO || (class->source != FACTOR_ONE && class->source & 1);
        if (class->func == BLEND_FUNC_ADD)
            return inverse ? lerp(flush, fused, g, s, d) : lerp(flush, fused, f, d, s);
        float sum = times(flush, plus(flush, s, d), inverse ? g : f);
        if (class->func == BLEND_FUNC_SUBTRACT)
            return inverse ? minus(flush, s, sum) : minus(flush, sum, d);
        return inverse ? minus(flush, sum, s) : minus(flush, d, sum);
    }
    if (class->linked && class->source == class->destination) {
        if (class->source_absent)
            return 0.0f;
        float sum = combine(flush, class->func, s, d);
        return class->source_plain ? sum : times(flush, sum, f);
    }
    float p = class->source_plain ? s : times(flush, s, f);
    float q = class->destination_plain ? d : times(flush, d, g);
    if (class->source_absent)
        p = 0.0f;
    if (class->destination_absent)
        q = 0.0f;
    if (class->destination_absent && (class->func != BLEND_FUNC_REVERSE_SUBTRACT))
        return p;
    if (class->source_absent && class->func != BLEND_FUNC_SUBTRACT)
        return q;
    return combine(flush, class->func, p, q);
}

static __attribute__((noinline)) void float_pixel(bool flush, bool fused,
                                                  const BlendEquation *equation, int channels,
                                                  const float s[4], const float d[4], float out[4])
{
    for (int i = 0; i < channels; i++) {
        Class class = class_of(equation, channels, i == 3);
        out[i] = float_channel(flush, fused, &class, i == 3, s[i], d[i], s[3], d[3]);
    }
}

static inline uint32_t code_factor(int bits, BlendFactor factor, bool alpha, uint32_t s, uint32_t d,
                                   uint32_t source_alpha, uint32_t destination_alpha)
{
    uint32_t most = (1u << bits) - 1;
    switch (factor) {
    case FACTOR_ZERO:
        return 0;
    case FACTOR_SRC_COLOR:
        return s;
    case FACTOR_ONE_MINUS_SRC_COLOR:
        return most - s;
    case FACTOR_DST_COLOR:
        return d;
    case FACTOR_ONE_MINUS_DST_COLOR:
        return most - d;
    case FACTOR_SRC_ALPHA:
        return source_alpha;
    case FACTOR_ONE_MINUS_SRC_ALPHA:
        return most - source_alpha;
    case FACTOR_DST_ALPHA:
        return destination_alpha;
    case FACTOR_ONE_MINUS_DST_ALPHA:
        return most - destination_alpha;
    case FACTOR_SRC_ALPHA_SATURATE:
        if (alpha)
            return most;
        return source_alpha < most - destination_alpha ? source_alpha : most - destination_alpha;
    default:
        return most;
    }
}

static inline uint32_t code_combine(uint32_t most, BlendFunc func, uint32_t a, uint32_t b)
{
    if (func == BLEND_FUNC_ADD)
        return a + b < most ? a + b : most;
    if (func == BLEND_FUNC_SUBTRACT)
        return a > b ? a - b : 0;
    return b > a ? b - a : 0;
}

static inline uint32_t code_channel(int bits, const Class *class, bool alpha, uint32_t s,
                                    uint32_t d, uint32_t source_alpha, uint32_t destination_alpha)
{
    uint32_t most = (1u << bits) - 1;
    if (class->func == BLEND_FUNC_MIN)
        return s < d ? s : d;
    if (class->func == BLEND_FUNC_MAX)
        return s > d ? s : d;
    uint32_t f = code_factor(bits, class->source, alpha, s, d, source_alpha, destination_alpha);
    uint32_t g =
        code_factor(bits, class->destination, alpha, s, d, source_alpha, destination_alpha);
    return code_combine(most, class->func, multiply(bits, s, f), multiply(bits, d, g));
}

static void code_pixel(const BlendEquation *equation, PixelFormat format, const float source[4],
                       void *pixel)
{
    int bits = 8 * format_info(format)->channel_bytes;
    unsigned char stored[4 * sizeof(uint16_t)];
    format_store(format, source, stored);
    uint32_t s[4], d[4];
    for (int i = 0; i < 4; i++) {
        s[i] = format_bits(format, stored, i);
        d[i] = format_bits(format, pixel, i);
    }
    for (int i = 0; i < 4; i++) {
        Class class = class_of(equation, 4, i == 3);
        uint32_t value = code_channel(bits, &class, i == 3, s[i], d[i], s[3], d[3]);
        if (bits == 8)
            ((uint8_t *)pixel)[i] = (uint8_t)value;
        else
            ((uint16_t *)pixel)[i] = (uint16_t)value;
    }
}

void blend_pixel(const BlendEquation *equation, bool fused, PixelFormat format,
                 const float source[4], void *pixel)
{
    const FormatInfo *info = format_info(format);
    float d[4], out[4];
    if (info->kind == KIND_UNORM) {
        code_pixel(equation, format, source, pixel);
        return;
    }
    format_fetch(format, pixel, d);
    if (info->kind == KIND_HALF) {
        uint32_t flushing = op_suspend();
        float_pixel(false, fused, equation, 4, source, d, out);
        op_leave(flushing);
    } else {
        float_pixel(true, fused, equation, info->channels, source, d, out);
        for (int i = 0; i < info->channels; i++)
            out[i] = op_canonical(out[i]);
    }
    format_store(format, out, pixel);
}

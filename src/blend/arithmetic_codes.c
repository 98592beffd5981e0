/* Unorm pixels in integers, many at a time: what arithmetic_exact.c and arithmetic_steps.c define
 * channel by channel, bit-compared with them by tests/unit/test_arithmetic_steps.c. */
#include "blend/arithmetic_parts.h"
#include "number/blend_codes.h"

#include <string.h>

/* What does not change from pixel to pixel. */
typedef struct CodeBlend {
    ChannelEquation rgb, alpha;
    CodeProduct product;
    bool exact; /* both products and their sum are rounded once */
    int bits;
    int64_t most;
} CodeBlend;

/* x·most rounded to nearest even: exact in double, and the sum's unit is 1. NaN is 0. */
static int64_t code_of(float x, int64_t most)
{
    double scaled = (double)x * (double)most;
    scaled = scaled > 0.0 ? scaled < (double)most ? scaled : (double)most : 0.0;
    return (int64_t)((scaled + 0x1p52) - 0x1p52);
}

static inline bool is_one(BlendFactor factor, bool alpha)
{
    return factor == FACTOR_ONE || (factor == FACTOR_SRC_ALPHA_SATURATE && alpha);
}

static inline int64_t channel_of(const CodeBlend *blend, const ChannelEquation *part, int64_t s,
                                 int64_t d, int64_t source_alpha, int64_t destination_alpha)
{
    if (blend_func_extreme(part->func))
        return blend_codes_combine(part->func, s, d);
    int64_t f = blend_codes_factor(blend->most, part->source, part->alpha, s, d, source_alpha,
                                   destination_alpha);
    int64_t g = blend_codes_factor(blend->most, part->destination, part->alpha, s, d, source_alpha,
                                   destination_alpha);
    int64_t most = blend->most, sum;
    if (blend->exact) {
        sum = blend_codes_combine(part->func, s * f, d * g);
        sum = sum > 0 ? (2 * sum + most) / (2 * most) : 0;
    } else {
        if (!is_one(part->source, part->alpha))
            s = arithmetic_code_product(blend->product, blend->bits, s, f);
        if (!is_one(part->destination, part->alpha))
            d = arithmetic_code_product(blend->product, blend->bits, d, g);
        sum = blend_codes_combine(part->func, s, d);
    }
    return sum < 0 ? 0 : sum < most ? sum : most;
}

static void blend8(const CodeBlend *blend, const float source[4], uint8_t *pixel)
{
    int64_t s[4], d[4];
    for (int i = 0; i < 4; i++) {
        s[i] = code_of(source[i], 255);
        d[i] = pixel[i];
    }
    for (int i = 0; i < 4; i++)
        pixel[i] =
            (uint8_t)channel_of(blend, i < 3 ? &blend->rgb : &blend->alpha, s[i], d[i], s[3], d[3]);
}

static void blend16(const CodeBlend *blend, const float source[4], void *pixel)
{
    uint16_t stored[4];
    int64_t s[4];
    memcpy(stored, pixel, sizeof stored);
    int64_t destination_alpha = stored[3];
    for (int i = 0; i < 4; i++)
        s[i] = code_of(source[i], 65535);
    for (int i = 0; i < 4; i++)
        stored[i] = (uint16_t)channel_of(blend, i < 3 ? &blend->rgb : &blend->alpha, s[i],
                                         stored[i], s[3], destination_alpha);
    memcpy(pixel, stored, sizeof stored);
}

bool arithmetic_codes_blend(const Arithmetic *arithmetic, const BlendEquation *equation,
                            PixelFormat format, size_t count, const float (*source)[4],
                            void *pixels)
{
    const FormatInfo *info = format_info(format);
    bool exact = arithmetic->kind == ARITHMETIC_EXACT;
    if (info->kind != KIND_UNORM ||
        (!exact &&
         (arithmetic->kind != ARITHMETIC_STEPS || arithmetic->mistakes ||
          arithmetic->precision != PRECISION_CODES || arithmetic->store != BLEND_NEAREST_EVEN)))
        return false;
    CodeBlend blend = {.rgb = channel_equation(equation, 0),
                       .alpha = channel_equation(equation, 3),
                       .product = arithmetic->product,
                       .exact = exact,
                       .bits = 8 * info->channel_bytes,
                       .most = info->unorm_max};
    for (size_t i = 0; i < count; i++)
        if (info->channel_bytes == 1)
            blend8(&blend, source[i], (uint8_t *)pixels + 4 * i);
        else
            blend16(&blend, source[i], (uint16_t *)pixels + 4 * i);
    return true;
}

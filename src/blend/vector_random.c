/* Random vectors: seeded mixes, in each of which other things go wrong. */
#include "blend/vector_values.h"
#include "number/op.h"

#include <math.h>

/* A multiple of 2^-24 in [0, 1]. */
static float unit(Random *random)
{
    return (float)(random_bits(random) % 0x1000001u) * 0x1p-24f;
}

static float of_sign(Random *random, float x)
{
    return random_bits(random) & 1 ? -x : x;
}

/* A random significand, and 2^low ≤ |x| < 2^high; low ≥ −126. */
static float wide(Random *random, int low, int high)
{
    uint64_t bits = random_bits(random);
    uint32_t exponent = (uint32_t)(127 + low + (int)((bits >> 32) % (uint64_t)(high - low)));
    return op_from_bits(exponent << 23 | ((uint32_t)bits & 0x7fffffu));
}

/* Few significant bits, so that products and sums often end half-way. */
static float coarse(Random *random)
{
    uint64_t bits = random_bits(random);
    int width = 1 + (int)((bits >> 32) % 13), shift = (int)((bits >> 40) % 12);
    return ldexpf((float)(bits & ((1u << width) - 1)), -shift);
}

/* Alphas that programs have special cases for, or should not have. */
static float edge_alpha(Random *random)
{
    static const float alphas[] = {0.0f,           0x1p-24f,     0x1.010102p-8f, 0x1.fdfdfep-1f,
                                   0x1.ffcp-1f,    0x1.ff8p-1f,  0x1.fffffep-1f, 1.0f,
                                   0x1.000002p+0f, 0x1.004p+0f,  -0x1p-24f,      -1.0f,
                                   0x1p-149f,      0x1.fffep-1f, 0.5f,           2.0f};
    return alphas[random_bits(random) % (sizeof alphas / sizeof *alphas)];
}

typedef enum Mix {
    MIX_UNIT = 0,
    MIX_LAYERS, /* premultiplied colours on what layers before them left */
    MIX_CODES,  /* 8-bit content */
    MIX_COARSE,
    MIX_WIDE,
    MIX_CANCEL,
    MIX_SPECIAL,
    MIX_EDGES,
    MIX_COUNT
} Mix;

static float mixed(PixelFormat format, Mix mix, Random *random, bool alpha)
{
    int reach = format_info(format)->kind == KIND_HALF ? 20 : 120;
    switch (mix) {
    case MIX_CODES:
        return (float)((double)(random_bits(random) % 256) / 255.0);
    case MIX_COARSE:
        return of_sign(random, coarse(random));
    case MIX_WIDE:
        return of_sign(random, wide(random, alpha ? -30 : -reach, alpha ? 5 : reach));
    case MIX_CANCEL:
        return wide(random, -4, 4);
    case MIX_SPECIAL:
        return vector_values_special_source(format,
                                            (uint32_t)(random_bits(random) % VECTOR_SPECIALS));
    case MIX_EDGES:
        return alpha ? edge_alpha(random) : of_sign(random, wide(random, -12, 12));
    default:
        return unit(random);
    }
}

/* Colours at most as great as their alpha, and bright ones. */
static void premultiply(Random *random, float color[4])
{
    float exposure = random_bits(random) & 7 ? 1.0f : 16.0f;
    for (int c = 0; c < 3; c++)
        color[c] = color[c] * color[3] * exposure;
}

/* What a product of the source takes away, to some units in the last place. */
static uint32_t cancelled(PixelFormat format, Random *random, float source, float factor)
{
    uint32_t bits = vector_values_bits(format, -(source * factor));
    return bits + (uint32_t)(random_bits(random) % 5) - 2;
}

static void random_float(PixelFormat format, Random *random, Vector *out)
{
    Mix mix = (Mix)(random_bits(random) % MIX_COUNT);
    float destination[4];
    for (int c = 0; c < 4; c++) {
        out->source[c] = mixed(format, mix, random, c == 3);
        destination[c] = mixed(format, mix, random, c == 3);
    }
    if (mix == MIX_LAYERS) {
        premultiply(random, out->source);
        premultiply(random, destination);
        destination[3] = 1.0f - destination[3];
    }
    for (int c = 0; c < 4; c++)
        out->destination[c] = vector_values_bits(format, destination[c]);
    if (mix != MIX_CANCEL)
        return;
    float factors[3] = {destination[3], out->source[3], 1.0f};
    for (int c = 0; c < 3; c++)
        out->destination[c] = cancelled(format, random, out->source[c], factors[c]);
}

static uint32_t random_code(PixelFormat format, Mix mix, Random *random)
{
    uint64_t bits = random_bits(random);
    if (mix == MIX_SPECIAL)
        return vector_values_code(format, (uint32_t)(bits % VECTOR_CODES));
    if (mix == MIX_CODES) /* of 8 bits, widened where there are more */
        return (uint32_t)(bits % 256) * (format_info(format)->unorm_max / 255);
    return (uint32_t)(bits % (format_info(format)->unorm_max + 1));
}

static void random_unorm(PixelFormat format, Random *random, Vector *out)
{
    Mix mix = (Mix)(random_bits(random) % MIX_COUNT);
    uint32_t source[4], max = format_info(format)->unorm_max;
    for (int c = 0; c < 4; c++) {
        source[c] = random_code(format, mix, random);
        out->destination[c] = random_code(format, mix, random);
    }
    if (mix == MIX_EDGES) {
        uint64_t bits = random_bits(random);
        source[3] = bits & 4 ? (uint32_t)bits & 3 : max - ((uint32_t)bits & 3);
        out->destination[3] = bits & 32 ? (uint32_t)bits >> 3 & 3 : max - ((uint32_t)bits >> 3 & 3);
    }
    for (int c = 0; c < 3 && mix == MIX_LAYERS; c++) {
        source[c] = (uint32_t)((uint64_t)source[c] * source[3] / max);
        uint32_t covered = max - out->destination[3];
        out->destination[c] = (uint32_t)((uint64_t)out->destination[c] * covered / max);
    }
    for (int c = 0; c < 4; c++)
        out->source[c] = vector_values_unorm(format, source[c]);
}

void vector_values_random(PixelFormat format, Random *random, Vector *out)
{
    if (format_info(format)->kind == KIND_UNORM)
        random_unorm(format, random, out);
    else
        random_float(format, random, out);
}

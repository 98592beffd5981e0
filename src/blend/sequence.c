#include "blend/sequence.h"

#include "base/random.h"
#include "blend/vector_values.h"
#include "number/op.h"

#include <math.h>
#include <string.h>

/* ---- layers ---------------------------------------------------------------------------------- */

typedef enum Layers {
    LAYERS_RANDOM = 0,
    LAYERS_EQUAL,
    LAYERS_ALTERNATING,
    LAYERS_FAINT,  /* alpha 1/255 */
    LAYERS_NEARLY, /* alpha just below 1 */
    LAYERS_HOLES,  /* every third layer has alpha 0 */
    LAYERS_OPAQUE, /* alpha 1 in the middle */
    LAYERS_THIN,   /* alphas up to 1/8 */
    LAYERS_EDGES,  /* alphas at both ends */
    LAYERS_BRIGHT, /* colours above their alpha; of unorm formats 1 */
    LAYERS_COUNT
} Layers;

static const char *const kinds[LAYERS_COUNT] = {
    "random layers",
    "all layers equal",
    "two layers in turn",
    "every alpha 1/255",
    "every alpha just below 1",
    "every third alpha 0",
    "an opaque layer in the middle",
    "thin layers: alphas up to 1/8",
    "alphas 0, 1 and next to them",
    "colours brighter than their alpha",
};

static Layers kind_of(uint64_t index)
{
    return (Layers)(index % LAYERS_COUNT);
}

const char *sequence_what(uint64_t index)
{
    return kinds[kind_of(index)];
}

static uint32_t below(Random *random, uint32_t count)
{
    return (uint32_t)(random_bits(random) % count);
}

/* An alpha of so many levels, which are the format's codes or 2^24. */
static uint32_t level_alpha(Layers kind, Random *random, uint32_t levels)
{
    uint32_t pick = below(random, 4), near = pick & 1 ? 1 : 0;
    switch (kind) {
    case LAYERS_FAINT:
        return levels / 255;
    case LAYERS_NEARLY:
        return levels - 1;
    case LAYERS_THIN:
        return below(random, levels / 8 + 1);
    case LAYERS_EDGES:
        return pick & 2 ? levels - near : near;
    default:
        return below(random, levels + 1);
    }
}

static void layer_codes(PixelFormat format, Layers kind, Random *random, float out[4])
{
    uint32_t max = format_info(format)->unorm_max, alpha = level_alpha(kind, random, max);
    for (int c = 0; c < 3; c++)
        out[c] =
            vector_values_unorm(format, kind == LAYERS_BRIGHT ? max : below(random, alpha + 1));
    out[3] = vector_values_unorm(format, alpha);
}

static void layer_floats(PixelFormat format, Layers kind, Random *random, float out[4])
{
    static const float nearly[] = {0x1.fffffep-1f, 0x1.ffcp-1f, 0x1.fdfdfep-1f, 0x1.ffdffep-1f};
    uint32_t levels = 1u << 24;
    float alpha = (float)level_alpha(kind, random, levels) * 0x1p-24f;
    if (kind == LAYERS_FAINT)
        alpha = (float)(1.0 / 255.0);
    if (kind == LAYERS_NEARLY)
        alpha = nearly[below(random, 4)];
    if (kind == LAYERS_EDGES && format == FORMAT_RGBA16F && alpha > 0.5f && alpha < 1.0f)
        alpha = 0x1.ffcp-1f;
    double most = kind == LAYERS_BRIGHT ? 16.0 : (double)alpha;
    for (int c = 0; c < 3; c++)
        out[c] = (float)(most * (double)below(random, levels + 1) * 0x1p-24);
    out[3] = alpha;
}

static void make_layer(PixelFormat format, Layers kind, Random *random, float out[4])
{
    if (format_info(format)->kind == KIND_UNORM)
        layer_codes(format, kind, random, out);
    else
        layer_floats(format, kind, random, out);
}

int sequence_make(const VectorSpec *spec, uint64_t index, float (*source)[4])
{
    Layers kind = kind_of(index);
    int layers = 2 + (int)(index / LAYERS_COUNT % (SEQUENCE_LAYERS_MAX - 1));
    Random random = random_seed(spec->seed ^ (index + 1) * 0x9e3779b97f4a7c15u);
    random = random_seed(random_bits(&random));
    int period = kind == LAYERS_EQUAL ? 1 : kind == LAYERS_ALTERNATING ? 2 : layers;
    for (int i = 0; i < layers; i++) {
        if (i >= period) {
            memcpy(source[i], source[i - period], sizeof *source);
            continue;
        }
        make_layer(spec->format, kind, &random, source[i]);
        if (kind == LAYERS_HOLES && i % 3 == 1)
            memset(source[i], 0, sizeof *source);
        if (kind == LAYERS_OPAQUE && i == layers / 2)
            source[i][3] = 1.0f;
    }
    return layers;
}

/* ---- results --------------------------------------------------------------------------------- */

void sequence_clear(PixelFormat format, void *pixel)
{
    for (int c = 0; c < 4; c++)
        format_set_bits(format, pixel, c, vector_values_bits(format, c == 3 ? 1.0f : 0.0f));
}

void sequence_blend(const Arithmetic *arithmetic, PixelFormat format, int layers,
                    const float (*source)[4], void *pixels)
{
    const BlendEquation *under = &equation_info(EQUATION_UNDER)->equation;
    size_t size = format_pixel_bytes(format);
    char *pixel = pixels;
    sequence_clear(format, pixel);
    for (int i = 0; i < layers; i++, pixel += size) {
        if (i)
            memcpy(pixel, pixel - size, size);
        arithmetic_blend(arithmetic, under, format, 1, source + i, pixel);
    }
}

static void operand(PixelFormat format, float source, Rational *out)
{
    uint32_t max = format_info(format)->unorm_max;
    if (max)
        rational_set_ratio(vector_values_bits(format, source), max, out);
    else
        rational_set((double)source, out);
}

void sequence_exact(PixelFormat format, int layers, const float (*source)[4], Rational exact[4])
{
    Rational value;
    rational_init(&value);
    for (int c = 0; c < 4; c++)
        rational_set(c == 3, &exact[c]);
    for (int i = 0; i < layers; i++) {
        for (int c = 0; c < 3; c++) {
            operand(format, source[i][c], &value);
            rational_mul(&value, &exact[3], &value);
            rational_add(&exact[c], &value, &exact[c]);
        }
        operand(format, source[i][3], &value);
        rational_one_minus(&value, &value);
        rational_mul(&exact[3], &value, &exact[3]);
    }
    rational_clear(&value);
}

void sequence_round(PixelFormat format, const Rational exact[4], void *pixel)
{
    for (int c = 0; c < 4; c++)
        format_set_bits(format, pixel, c, rational_store(&exact[c], format));
}

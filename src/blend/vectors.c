#include "blend/vectors.h"

#include "blend/vector_values.h"

#include <string.h>

enum {
    SPECIAL_TRIPLES = VECTOR_SPECIALS * VECTOR_SPECIALS * VECTOR_SPECIALS
};

const char *vectors_set_name(VectorSet set)
{
    static const char *const names[VECTORS_SET_COUNT] = {"exhaustive", "directed", "random",
                                                         "sequences"};
    return names[set];
}

static bool has_color(PixelFormat format)
{
    return format == FORMAT_RGBA8 || format == FORMAT_RGBA16 || format == FORMAT_RGBA16F ||
           format == FORMAT_RGBA32F || format == FORMAT_RG32F || format == FORMAT_R32F;
}

Result vectors_check(const VectorSpec *spec)
{
    const FormatInfo *info = format_info(spec->format);
    const char *name = vectors_set_name(spec->set);
    if (!has_color(spec->format))
        return result_fail(RESULT_BAD_INPUT,
                           "vectors of %s: expected rgba8, rgba16, rgba16f, rgba32f, rg32f or r32f",
                           info->name);
    if (spec->set == VECTORS_EXHAUSTIVE && info->kind != KIND_UNORM)
        return result_fail(RESULT_BAD_INPUT, "%s vectors of %s: expected rgba8 or rgba16", name,
                           info->name);
    if (spec->set == VECTORS_SEQUENCES && info->channels != 4)
        return result_fail(RESULT_BAD_INPUT, "%s of %s: expected a format with alpha", name,
                           info->name);
    if (spec->seed > VECTORS_NUMBER_MAX || spec->count > VECTORS_NUMBER_MAX)
        return result_fail(RESULT_BAD_INPUT, "%s vectors: a seed or index above 2^53 - 1", name);
    return RESULT_OK;
}

uint64_t vectors_count(const VectorSpec *spec)
{
    if (spec->set == VECTORS_EXHAUSTIVE)
        return (uint64_t)VECTOR_CODES * VECTOR_CODES * VECTOR_CODES;
    if (spec->set == VECTORS_DIRECTED)
        return SPECIAL_TRIPLES + vector_values_constructed(spec->format);
    return spec->count;
}

/* The places in a list of n that vector `index` takes its values from. */
typedef struct Places {
    uint32_t source[4], destination[4];
} Places;

static Places places(uint64_t index, uint32_t n)
{
    uint32_t i = (uint32_t)(index / n / n % n), j = (uint32_t)(index / n % n),
             k = (uint32_t)(index % n);
    return (Places){{i, k, n - 1 - i, (i + j + k) % n}, {k, i, n - 1 - k, j}};
}

static void make_triple(const VectorSpec *spec, uint64_t index, Vector *out)
{
    bool codes = spec->set == VECTORS_EXHAUSTIVE;
    Places at = places(index, codes ? VECTOR_CODES : VECTOR_SPECIALS);
    for (int c = 0; c < 4; c++) {
        if (codes) {
            uint32_t code = vector_values_code(spec->format, at.source[c]);
            out->source[c] = vector_values_unorm(spec->format, code);
            out->destination[c] = vector_values_code(spec->format, at.destination[c]);
        } else {
            out->source[c] = vector_values_special_source(spec->format, at.source[c]);
            out->destination[c] = vector_values_special_bits(spec->format, at.destination[c]);
        }
    }
}

/* A generator for each vector, not one for all, so that any vector can be made alone. */
static Random random_of(uint64_t seed, uint64_t index)
{
    Random random = random_seed(seed);
    random = random_seed(random_bits(&random) ^ index);
    return random_seed(random_bits(&random));
}

static void make(const VectorSpec *spec, uint64_t index, Vector *out)
{
    Random random = random_of(spec->seed, index);
    if (spec->set == VECTORS_RANDOM)
        vector_values_random(spec->format, &random, out);
    else if (spec->set == VECTORS_DIRECTED && index >= SPECIAL_TRIPLES)
        vector_values_construct(spec->format, index - SPECIAL_TRIPLES, out);
    else
        make_triple(spec, index, out);
}

/* All 256 codes of rgba8 in their order: what the loop below does, without a detour for each. */
static void make_codes(const float unorm[VECTOR_CODES], uint64_t first, size_t count,
                       float (*source)[4], unsigned char (*destination)[4])
{
    for (size_t v = 0; v < count; v++) {
        Places at = places(first + v, VECTOR_CODES);
        for (int c = 0; c < 4; c++) {
            source[v][c] = unorm[at.source[c]];
            destination[v][c] = (unsigned char)at.destination[c];
        }
    }
}

void vectors_make(const VectorSpec *spec, uint64_t first, size_t count, float (*source)[4],
                  void *destination)
{
    size_t size = format_pixel_bytes(spec->format);
    int channels = format_info(spec->format)->channels;
    if (spec->set == VECTORS_EXHAUSTIVE && spec->format == FORMAT_RGBA8) {
        float unorm[VECTOR_CODES];
        for (uint32_t k = 0; k < VECTOR_CODES; k++)
            unorm[k] = vector_values_unorm(FORMAT_RGBA8, k);
        make_codes(unorm, first, count, source, destination);
        return;
    }
    for (size_t v = 0; v < count; v++) {
        Vector vector;
        make(spec, first + v, &vector);
        memcpy(source[v], vector.source, sizeof vector.source);
        for (int c = 0; c < channels; c++)
            format_set_bits(spec->format, (char *)destination + v * size, c, vector.destination[c]);
    }
}

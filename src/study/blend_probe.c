#include "study/blend_probe.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Places of codes in the exhaustive sets' list of 256, simple ones and their neighbours. */
static const uint8_t simple[] = {0, 255, 1, 2, 4, 8, 16, 32, 64, 128, 127, 129, 254, 253, 85, 170};

enum {
    SIMPLE = sizeof simple
};

static size_t part_count(VectorSet set, PixelFormat format, size_t most)
{
    VectorSpec spec = {.set = set, .format = format, .count = most};
    if (vectors_check(&spec) != RESULT_OK)
        return 0;
    uint64_t count = vectors_count(&spec);
    return count < most ? (size_t)count : most;
}

/* Vector i of `count` that are taken from the set, evenly. */
static uint64_t pick(VectorSet set, uint64_t of, size_t count, size_t i)
{
    if (set == VECTORS_EXHAUSTIVE && i < (size_t)SIMPLE * SIMPLE * SIMPLE)
        return (uint64_t)simple[i / (SIMPLE * SIMPLE)] << 16 |
               (uint64_t)simple[i / SIMPLE % SIMPLE] << 8 | simple[i % SIMPLE];
    return (uint64_t)i * of / count;
}

static void fill(BlendProbe *probe, VectorSet set, size_t count)
{
    VectorSpec spec = {.set = set, .format = probe->format, .count = count};
    size_t bytes = format_pixel_bytes(probe->format);
    for (size_t i = 0; i < count; i++) {
        size_t at = probe->count++;
        probe->set[at] = set;
        probe->index[at] = pick(set, vectors_count(&spec), count, i);
        vectors_make(&spec, probe->index[at], 1, probe->source + at,
                     probe->destination + at * bytes);
    }
}

Result blend_probe_make(const BlendEquation *equation, PixelFormat format, size_t most,
                        BlendProbe *out)
{
    static const VectorSet sets[] = {VECTORS_EXHAUSTIVE, VECTORS_DIRECTED, VECTORS_RANDOM};
    size_t counts[3], sum = 0;
    *out = (BlendProbe){.equation = *equation, .format = format};
    for (int i = 0; i < 3; i++)
        sum += counts[i] = part_count(sets[i], format, most / (i == 0 ? 2 : 3));
    out->source = memory_array(sum, sizeof *out->source);
    out->destination = memory_array(sum, format_pixel_bytes(format));
    out->set = memory_array(sum, sizeof *out->set);
    out->index = memory_array(sum, sizeof *out->index);
    if (!out->source || !out->destination || !out->set || !out->index)
        return RESULT_NO_MEMORY;
    for (int i = 0; i < 3; i++)
        fill(out, sets[i], counts[i]);
    return RESULT_OK;
}

void blend_probe_free(BlendProbe *probe)
{
    free(probe->source);
    free(probe->destination);
    free(probe->set);
    free(probe->index);
    *probe = (BlendProbe){0};
}

unsigned char *blend_probe_blend(const BlendProbe *probe, const Arithmetic *arithmetic)
{
    size_t bytes = format_pixel_bytes(probe->format);
    unsigned char *pixels = memory_array(probe->count, bytes);
    if (!pixels)
        return NULL;
    memcpy(pixels, probe->destination, probe->count * bytes);
    arithmetic_blend(arithmetic, &probe->equation, probe->format, probe->count,
                     (const float(*)[4])probe->source, pixels);
    return pixels;
}

/* Whether the channel of `at` is none of the others'. */
static bool is_apart(const BlendProbe *probe, const unsigned char *one, size_t count,
                     const unsigned char *const *others, size_t at, int channel)
{
    FormatKind kind = format_info(probe->format)->kind;
    size_t offset = at * format_pixel_bytes(probe->format);
    uint32_t got = format_bits(probe->format, one + offset, channel);
    for (size_t i = 0; i < count; i++)
        if (format_ulp(kind, got, format_bits(probe->format, others[i] + offset, channel)) == 0)
            return false;
    return true;
}

bool blend_probe_apart(const BlendProbe *probe, const unsigned char *one, size_t count,
                       const unsigned char *const *others, BlendExample *out)
{
    const FormatInfo *info = format_info(probe->format);
    size_t bytes = format_pixel_bytes(probe->format), found = SIZE_MAX;
    int least = 0, channel = 0;
    for (size_t i = 0; i < probe->count; i++) {
        if (memcmp(one + i * bytes, others[0] + i * bytes, bytes) == 0)
            continue;
        for (int k = 0; k < info->channels; k++) {
            BlendCase here = {&probe->equation,
                              probe->format,
                              k,
                              probe->source[i],
                              probe->destination + i * bytes,
                              true};
            int complexity = blend_case_complexity(&here);
            if ((found != SIZE_MAX && complexity >= least) ||
                !is_apart(probe, one, count, others, i, k))
                continue;
            found = i;
            least = complexity;
            channel = k;
        }
    }
    if (found == SIZE_MAX)
        return false;
    *out =
        (BlendExample){.set = probe->set[found],
                       .index = probe->index[found],
                       .channel = channel,
                       .complexity = least,
                       .expected = format_bits(probe->format, others[0] + found * bytes, channel),
                       .got = format_bits(probe->format, one + found * bytes, channel)};
    out->ulp = format_ulp(info->kind, out->expected, out->got);
    memcpy(out->source, probe->source[found], sizeof out->source);
    memcpy(out->pixel, probe->destination + found * bytes, bytes);
    return true;
}

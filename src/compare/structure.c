#include "compare/structure.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX

/* One side's ids of one tile: layer k of pixel p is ids[k·TRACE_TILE² + p]. */
typedef struct Layers {
    const TraceStore *store;
    int opaque; /* buffer index or −1 */
    int *peel;  /* buffer indices */
    int count;
    uint32_t *opaque_ids;
    uint32_t *ids;
} Layers;

enum {
    TILE_PIXELS = TRACE_TILE * TRACE_TILE
};

static void layers_free(Layers *layers)
{
    free(layers->peel);
    free(layers->opaque_ids);
    free(layers->ids);
}

static Result layers_open(const TraceStore *store, Layers *out)
{
    *out = (Layers){.store = store, .opaque = store_find(store, "opaque.primitive")};
    char name[48];
    size_t capacity = 0;
    for (int k = 0;; k++) {
        snprintf(name, sizeof name, "peel.%d.primitive", k);
        int index = store_find(store, name);
        if (index < 0)
            break;
        Result result =
            memory_grow((void **)&out->peel, &capacity, (size_t)k + 1, sizeof *out->peel);
        if (result != RESULT_OK)
            return result;
        out->peel[out->count++] = index;
    }
    out->opaque_ids = memory_array(TILE_PIXELS, sizeof *out->opaque_ids);
    out->ids = memory_array((size_t)out->count * TILE_PIXELS, sizeof *out->ids);
    return out->opaque_ids && out->ids ? RESULT_OK : RESULT_NO_MEMORY;
}

static Result layers_load(Layers *layers, int x, int y, int width, int height)
{
    size_t row = TRACE_TILE * sizeof(uint32_t);
    Result result = RESULT_OK;
    memset(layers->opaque_ids, 0xff, TILE_PIXELS * sizeof(uint32_t));
    if (layers->opaque >= 0)
        result =
            store_read(layers->store, layers->opaque, x, y, width, height, layers->opaque_ids, row);
    for (int k = 0; result == RESULT_OK && k < layers->count; k++)
        result = store_read(layers->store, layers->peel[k], x, y, width, height,
                            layers->ids + (size_t)k * TILE_PIXELS, row);
    return result;
}

/* Pixel p's ids from front to back; returns how many. */
static int gather(const Layers *layers, int p, uint32_t *out)
{
    int count = 0;
    for (int k = 0; k < layers->count; k++) {
        uint32_t id = layers->ids[(size_t)k * TILE_PIXELS + (size_t)p];
        if (id != NONE)
            out[count++] = id;
    }
    return count;
}

static int find(const uint32_t *ids, int count, uint32_t id)
{
    for (int i = 0; i < count; i++)
        if (ids[i] == id)
            return i;
    return -1;
}

/* A layer that the raw peel test took again is no fragment more. Returns the new count. */
static int drop_repetitions(uint32_t *ids, int count)
{
    int kept = 0;
    for (int i = 0; i < count; i++)
        if (kept == 0 || ids[i] != ids[kept - 1])
            ids[kept++] = ids[i];
    return kept;
}

/* Two different sequences, their common ends cut off. */
static void count_differences(const uint32_t *a, int count_a, const uint32_t *b, int count_b,
                              StructureCounts *out)
{
    while (count_a && count_b && a[0] == b[0]) {
        a++, b++;
        count_a--, count_b--;
    }
    while (count_a && count_b && a[count_a - 1] == b[count_b - 1])
        count_a--, count_b--;
    int common = 0, last = -1;
    for (int i = 0; i < count_a; i++) {
        int rank = find(b, count_b, a[i]);
        if (rank < 0) {
            out->only_a++;
            continue;
        }
        common++;
        out->order_inversions += rank < last;
        last = rank;
    }
    if (count_b > common)
        out->only_b += (uint64_t)(count_b - common);
}

typedef struct Comparison {
    Layers a, b;
    uint32_t *sequence_a, *sequence_b;
} Comparison;

static StructureSame compare_pixel(Comparison *comparison, int p, StructureCounts *out)
{
    bool flip = comparison->a.opaque_ids[p] != comparison->b.opaque_ids[p];
    out->opaque_flips += flip;
    int count_a = gather(&comparison->a, p, comparison->sequence_a);
    int count_b = gather(&comparison->b, p, comparison->sequence_b);
    if (count_a != count_b || memcmp(comparison->sequence_a, comparison->sequence_b,
                                     (size_t)count_a * sizeof(uint32_t)) != 0) {
        count_a = drop_repetitions(comparison->sequence_a, count_a);
        count_b = drop_repetitions(comparison->sequence_b, count_b);
        count_differences(comparison->sequence_a, count_a, comparison->sequence_b, count_b, out);
        return STRUCTURE_DIFFERS;
    }
    if (flip)
        return STRUCTURE_DIFFERS;
    return count_a == 0 && comparison->a.opaque_ids[p] == NONE ? STRUCTURE_EMPTY : STRUCTURE_SAME;
}

static Result compare_tiles(Comparison *comparison, int width, int height, uint8_t *same,
                            StructureCounts *out)
{
    for (int y = 0; y < height; y += TRACE_TILE)
        for (int x = 0; x < width; x += TRACE_TILE) {
            int w = width - x < TRACE_TILE ? width - x : TRACE_TILE;
            int h = height - y < TRACE_TILE ? height - y : TRACE_TILE;
            Result result = layers_load(&comparison->a, x, y, w, h);
            if (result == RESULT_OK)
                result = layers_load(&comparison->b, x, y, w, h);
            if (result != RESULT_OK)
                return result;
            for (int row = 0; row < h; row++)
                for (int column = 0; column < w; column++)
                    same[(size_t)(y + row) * (size_t)width + (size_t)(x + column)] =
                        compare_pixel(comparison, row * TRACE_TILE + column, out);
        }
    return RESULT_OK;
}

Result structure_compare(const TraceStore *a, const TraceStore *b, int width, int height,
                         uint8_t *same, StructureCounts *out)
{
    *out = (StructureCounts){0};
    Comparison comparison = {0};
    Result result = layers_open(a, &comparison.a);
    if (result == RESULT_OK)
        result = layers_open(b, &comparison.b);
    if (result == RESULT_OK) {
        comparison.sequence_a = memory_array((size_t)comparison.a.count, sizeof(uint32_t));
        comparison.sequence_b = memory_array((size_t)comparison.b.count, sizeof(uint32_t));
        result = comparison.sequence_a && comparison.sequence_b
                     ? compare_tiles(&comparison, width, height, same, out)
                     : RESULT_NO_MEMORY;
    }
    free(comparison.sequence_a);
    free(comparison.sequence_b);
    layers_free(&comparison.a);
    layers_free(&comparison.b);
    return result;
}

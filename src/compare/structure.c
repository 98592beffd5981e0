#include "compare/structure.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX

/* One side's ids of one tile: layer k of pixel p is ids[k·TRACE_TILE² + p]; and its depths. */
typedef struct Layers {
    const TraceStore *store;
    int opaque;        /* buffer index or −1 */
    int *peel, *depth; /* buffer indices; depth NULL: not asked for */
    int count;
    uint32_t *opaque_ids;
    uint32_t *ids, *depths;
} Layers;

enum {
    TILE_PIXELS = TRACE_TILE * TRACE_TILE
};

static void layers_free(Layers *layers)
{
    free(layers->peel);
    free(layers->depth);
    free(layers->opaque_ids);
    free(layers->ids);
    free(layers->depths);
}

/* Indices of buffers peel.K.`what`, to *out, which the caller frees, and how many. */
static Result find_layers(const TraceStore *store, const char *what, int **out, int *count)
{
    char name[48];
    size_t capacity = 0;
    for (*count = 0;; ++*count) {
        snprintf(name, sizeof name, "peel.%d.%s", *count, what);
        int index = store_find(store, name);
        if (index < 0)
            return RESULT_OK;
        Result result = memory_grow((void **)out, &capacity, (size_t)*count + 1, sizeof **out);
        if (result != RESULT_OK)
            return result;
        (*out)[*count] = index;
    }
}

static Result layers_open(const TraceStore *store, bool deep, Layers *out)
{
    int depths = 0;
    *out = (Layers){.store = store, .opaque = store_find(store, "opaque.primitive")};
    Result result = find_layers(store, "primitive", &out->peel, &out->count);
    if (result == RESULT_OK && deep)
        result = find_layers(store, "depth", &out->depth, &depths);
    if (result != RESULT_OK)
        return result;
    if (deep && depths < out->count)
        return result_fail(RESULT_INTERNAL, "trace: %d depths of %d layers", depths, out->count);
    size_t ids = (size_t)out->count * TILE_PIXELS;
    out->opaque_ids = memory_array(TILE_PIXELS, sizeof *out->opaque_ids);
    out->ids = memory_array(ids, sizeof *out->ids);
    out->depths = deep ? memory_array(ids, sizeof *out->depths) : NULL;
    return out->opaque_ids && out->ids && (out->depths || !deep) ? RESULT_OK : RESULT_NO_MEMORY;
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
    for (int k = 0; layers->depths && result == RESULT_OK && k < layers->count; k++)
        result = store_read(layers->store, layers->depth[k], x, y, width, height,
                            layers->depths + (size_t)k * TILE_PIXELS, row);
    return result;
}

/* Pixel p's ids and depths from front to back, to out's arrays. */
static void gather(const Layers *layers, int p, StructurePixel *out)
{
    for (int k = 0; k < layers->count; k++) {
        size_t at = (size_t)k * TILE_PIXELS + (size_t)p;
        if (layers->ids[at] == NONE)
            continue;
        if (out->depths)
            out->depths[out->count] = layers->depths[at];
        out->ids[out->count++] = layers->ids[at];
    }
}

bool structure_same(const StructurePixel *a, const StructurePixel *b)
{
    return a->opaque == b->opaque && a->count == b->count &&
           (a->count == 0 || memcmp(a->ids, b->ids, (size_t)a->count * sizeof *a->ids) == 0);
}

int structure_find(const uint32_t *ids, int count, uint32_t id)
{
    for (int i = 0; i < count; i++)
        if (ids[i] == id)
            return i;
    return -1;
}

int structure_drop_repetitions(uint32_t *ids, int count)
{
    int kept = 0;
    for (int i = 0; i < count; i++)
        if (structure_find(ids, kept, ids[i]) < 0)
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
        int rank = structure_find(b, count_b, a[i]);
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

/* ---- all pixels ---- */

typedef struct Sides {
    Layers layers[STRUCTURE_STORES_MAX];
    StructurePixel pixels[STRUCTURE_STORES_MAX]; /* with the arrays of one pixel */
    int count;
} Sides;

static Result open_sides(const TraceStore *const stores[], int count, int deep, Sides *out)
{
    *out = (Sides){.count = count};
    for (int i = 0; i < count; i++) {
        Result result = layers_open(stores[i], i == deep, &out->layers[i]);
        if (result != RESULT_OK)
            return result;
        StructurePixel *pixel = &out->pixels[i];
        size_t layers = (size_t)out->layers[i].count;
        pixel->ids = memory_array(layers, sizeof *pixel->ids);
        pixel->depths = i == deep ? memory_array(layers, sizeof *pixel->depths) : NULL;
        if (!pixel->ids || (i == deep && !pixel->depths))
            return RESULT_NO_MEMORY;
    }
    return RESULT_OK;
}

static void visit_pixel(Sides *sides, int p, size_t pixel, StructureVisit visit, void *context)
{
    StructurePixel pixels[STRUCTURE_STORES_MAX];
    memcpy(pixels, sides->pixels, sizeof pixels);
    for (int i = 0; i < sides->count; i++) {
        pixels[i].opaque = sides->layers[i].opaque_ids[p];
        gather(&sides->layers[i], p, &pixels[i]);
    }
    visit(context, pixel, pixels);
}

static Result visit_tiles(Sides *sides, int width, int height, StructureVisit visit, void *context)
{
    for (int y = 0; y < height; y += TRACE_TILE)
        for (int x = 0; x < width; x += TRACE_TILE) {
            int w = width - x < TRACE_TILE ? width - x : TRACE_TILE;
            int h = height - y < TRACE_TILE ? height - y : TRACE_TILE;
            for (int i = 0; i < sides->count; i++) {
                Result result = layers_load(&sides->layers[i], x, y, w, h);
                if (result != RESULT_OK)
                    return result;
            }
            for (int row = 0; row < h; row++)
                for (int column = 0; column < w; column++)
                    visit_pixel(sides, row * TRACE_TILE + column,
                                (size_t)(y + row) * (size_t)width + (size_t)(x + column), visit,
                                context);
        }
    return RESULT_OK;
}

Result structure_visit(const TraceStore *const stores[], int count, int deep, int width, int height,
                       StructureVisit visit, void *context)
{
    Sides sides;
    Result result = open_sides(stores, count, deep, &sides);
    if (result == RESULT_OK)
        result = visit_tiles(&sides, width, height, visit, context);
    for (int i = 0; i < count; i++) {
        free(sides.pixels[i].ids);
        free(sides.pixels[i].depths);
        layers_free(&sides.layers[i]);
    }
    return result;
}

/* ---- two stores ---- */

typedef struct Comparison {
    uint8_t *same;
    StructureCounts *counts;
} Comparison;

static StructureSame compare_sides(StructurePixel *a, StructurePixel *b, StructureCounts *out)
{
    if (structure_same(a, b))
        return a->count == 0 && a->opaque == NONE ? STRUCTURE_EMPTY : STRUCTURE_SAME;
    out->opaque_flips += a->opaque != b->opaque;
    a->count = structure_drop_repetitions(a->ids, a->count);
    b->count = structure_drop_repetitions(b->ids, b->count);
    count_differences(a->ids, a->count, b->ids, b->count, out);
    return STRUCTURE_DIFFERS;
}

static void compare_pixel(void *context, size_t pixel, StructurePixel *sides)
{
    Comparison *comparison = context;
    comparison->same[pixel] = (uint8_t)compare_sides(&sides[0], &sides[1], comparison->counts);
}

Result structure_compare(const TraceStore *a, const TraceStore *b, int width, int height,
                         uint8_t *same, StructureCounts *out)
{
    const TraceStore *const stores[] = {a, b};
    Comparison comparison = {same, out};
    *out = (StructureCounts){0};
    return structure_visit(stores, 2, -1, width, height, compare_pixel, &comparison);
}

#include "ref/pipeline/count.h"

#include "base/memory.h"
#include "ref/pipeline/fragment.h"
#include "ref/pipeline/methods/minmax.h"

#include <stdlib.h>
#include <string.h>

enum {
    TILE_PIXELS = TILE_DEFAULT * TILE_DEFAULT
};

typedef struct CountFragment {
    FragmentDepth depth;
    uint32_t pixel; /* of the tile */
} CountFragment;

/* The fragments of one tile: as they are drawn, then by pixel. */
typedef struct CountTile {
    const Pass *pass;
    PixelRect rect;
    const Primitive *primitive; /* at hand */
    uint32_t opaque[TILE_PIXELS], first[TILE_PIXELS + 2];
    CountFragment *drawn;
    FragmentDepth *sorted;
    size_t count, capacity;
    bool failed; /* no memory */
} CountTile;

typedef struct Count {
    RenderDesc desc;
    Pass pass;
    LayerCount *pixels;
} Count;

/* ---- drawing ---- */

static uint32_t local_pixel(const CountTile *tile, int x, int y)
{
    return (uint32_t)(y - tile->rect.y0) * TILE_DEFAULT + (uint32_t)(x - tile->rect.x0);
}

static void visit_opaque(void *context, const Setup *setup, int x, int y)
{
    CountTile *tile = context;
    uint32_t *stored = &tile->opaque[local_pixel(tile, x, y)];
    FragmentDepth depth = pass_fragment_depth(tile->pass, setup, x, y);
    if (pass_depth_test(tile->pass, depth.key, *stored) &&
        !fragment_masked(tile->pass, setup, tile->primitive, x, y))
        *stored = depth.key;
}

static bool grow(CountTile *tile)
{
    size_t capacity = tile->capacity ? 2 * tile->capacity : TILE_PIXELS;
    CountFragment *drawn = realloc(tile->drawn, capacity * sizeof *drawn);
    tile->failed |= !drawn;
    if (!drawn)
        return false;
    tile->drawn = drawn;
    tile->capacity = capacity;
    return true;
}

static void visit_transparent(void *context, const Setup *setup, int x, int y)
{
    CountTile *tile = context;
    uint32_t pixel = local_pixel(tile, x, y);
    FragmentDepth depth = pass_fragment_depth(tile->pass, setup, x, y);
    if (pass_hidden(tile->pass, depth, tile->opaque[pixel]) ||
        (tile->count == tile->capacity && !grow(tile)))
        return;
    tile->drawn[tile->count++] = (CountFragment){depth, pixel};
}

static inline __attribute__((always_inline)) void
draw(CountTile *tile, uint32_t index, const Bins *bins, const PrimitiveList *list, SetupVisit visit)
{
    for (size_t i = bins->first[index]; i < bins->first[index + 1]; i++) {
        Setup setup;
        tile->primitive = &list->items[bins->item[i]];
        pass_setup(tile->pass, tile->primitive, &setup);
        setup_visit(&setup, tile->rect, visit, tile);
    }
}

/* ---- counting ---- */

/* Counting sort: drawn[] to sorted[], first[p] … first[p + 1] of pixel p. */
static bool sort_by_pixel(CountTile *tile)
{
    tile->sorted = memory_array(tile->count, sizeof *tile->sorted);
    if (!tile->sorted)
        return false;
    memset(tile->first, 0, sizeof tile->first);
    for (size_t i = 0; i < tile->count; i++)
        tile->first[tile->drawn[i].pixel + 2]++;
    for (int p = 1; p < TILE_PIXELS + 1; p++)
        tile->first[p + 1] += tile->first[p];
    for (size_t i = 0; i < tile->count; i++)
        tile->sorted[tile->first[tile->drawn[i].pixel + 1]++] = tile->drawn[i].depth;
    return true;
}

/* By stored depth, then by depth: from 0 to 1. */
static int in_front(const void *left, const void *right)
{
    const FragmentDepth *a = left, *b = right;
    if (a->key != b->key)
        return a->key < b->key ? -1 : 1;
    return a->z < b->z ? -1 : a->z > b->z;
}

static void reverse(FragmentDepth *depths, size_t count)
{
    for (size_t i = 0; i < count / 2; i++) {
        FragmentDepth depth = depths[i];
        depths[i] = depths[count - 1 - i];
        depths[count - 1 - i] = depth;
    }
}

/* Goes through a pixel's fragments, nearest first, as peels would. */
static LayerCount count_pixel(const Pass *pass, const FragmentDepth *depths, size_t count)
{
    LayerCount layers = {.fragments = (uint32_t)count};
    uint32_t peel = 0, id = 0;
    float distance = 0.0f;
    for (size_t i = 0; i < count; i++) {
        FragmentDepth depth = depths[i];
        if (i == 0 || (depth.key != peel && !pass_peeled(pass, depth, peel))) {
            peel = depth.key;
            layers.peels++;
        }
        if (i == 0 || depth.key == id || pass_behind(pass, depth.key, id)) {
            id = depth.key;
            layers.ids++;
        }
        float here = minmax_distance(pass, depth.z);
        layers.depths += i == 0 || here != distance;
        distance = here;
    }
    return layers;
}

static void count_tile(const CountTile *tile, LayerCount *pixels)
{
    for (int y = tile->rect.y0; y <= tile->rect.y1; y++)
        for (int x = tile->rect.x0; x <= tile->rect.x1; x++) {
            uint32_t p = local_pixel(tile, x, y);
            FragmentDepth *depths = tile->sorted + tile->first[p];
            size_t count = tile->first[p + 1] - tile->first[p];
            qsort(depths, count, sizeof *depths, in_front);
            if (tile->pass->reversed)
                reverse(depths, count);
            pixels[(size_t)y * (size_t)tile->pass->view.width + (size_t)x] =
                count_pixel(tile->pass, depths, count);
        }
}

static Result tile_task(void *context, uint32_t index, int worker)
{
    const Count *count = context;
    const Pass *pass = &count->pass;
    (void)worker;
    CountTile *tile = memory_array(1, sizeof *tile);
    if (!tile)
        return RESULT_NO_MEMORY;
    uint32_t saved = op_enter(), far = depth_key_far(pass->depth_format, pass->desc->depth_range);
    tile->pass = pass;
    tile->rect = pass_tile_rect(pass, index);
    for (int i = 0; i < TILE_PIXELS; i++)
        tile->opaque[i] = far;
    draw(tile, index, &pass->opaque_bins, &pass->geometry.opaque, visit_opaque);
    draw(tile, index, &pass->transparent_bins, &pass->geometry.transparent, visit_transparent);
    bool done = !tile->failed && sort_by_pixel(tile);
    if (done)
        count_tile(tile, count->pixels);
    op_leave(saved);
    free(tile->drawn);
    free(tile->sorted);
    free(tile);
    return done ? RESULT_OK : RESULT_NO_MEMORY;
}

/* ---- the frame ---- */

static void most(uint32_t *most_of, uint32_t value)
{
    *most_of = value > *most_of ? value : *most_of;
}

static Result sum(const Count *count, LayerCounts *out)
{
    size_t pixels = (size_t)count->pass.view.width * (size_t)count->pass.view.height;
    for (size_t i = 0; i < pixels; i++) {
        const LayerCount *pixel = &count->pixels[i];
        most(&out->most.fragments, pixel->fragments);
        most(&out->most.peels, pixel->peels);
        most(&out->most.ids, pixel->ids);
        most(&out->most.depths, pixel->depths);
        out->fragments += pixel->fragments;
        out->peels += pixel->peels;
    }
    out->histogram = memory_array(out->most.fragments + (size_t)1, sizeof *out->histogram);
    out->peel_histogram = memory_array(out->most.peels + (size_t)1, sizeof *out->peel_histogram);
    if (!out->histogram || !out->peel_histogram)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < pixels; i++) {
        out->histogram[count->pixels[i].fragments]++;
        out->peel_histogram[count->pixels[i].peels]++;
    }
    return RESULT_OK;
}

Result count_layers(const Scene *scene, const RenderDesc *desc, LayerCounts *out)
{
    Count count = {.desc = *desc};
    count.desc.tile = TILE_DEFAULT;
    *out = (LayerCounts){0};
    Result result = pass_create(scene, &count.desc, false, &count.pass);
    if (result != RESULT_OK)
        return result;
    Pass *pass = &count.pass;
    uint64_t pixels = (uint64_t)desc->width * (uint64_t)desc->height;
    uint64_t images =
        pixels * (format_pixel_bytes(FORMAT_RGBA32F) + format_pixel_bytes(FORMAT_RGBA8));
    out->geometry_bytes = pass->bytes - images;
    out->opaque_primitives = pass->geometry.opaque.count;
    out->transparent_primitives = pass->geometry.transparent.count;
    result = pass_reserve(pass, pixels * sizeof *count.pixels);
    count.pixels = result == RESULT_OK ? memory_array((size_t)pixels, sizeof *count.pixels) : NULL;
    if (result == RESULT_OK)
        result = count.pixels ? pool_run(pass->pool, pass->tile_count, tile_task, &count)
                              : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = sum(&count, out);
    out->bytes = pass->bytes;
    free(count.pixels);
    pass_free(pass);
    if (result != RESULT_OK)
        layers_free(out);
    return result;
}

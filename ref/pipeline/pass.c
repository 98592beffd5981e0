#include "ref/pipeline/pass.h"

#include "base/memory.h"
#include "ref/pipeline/mutate.h"

#include <stdlib.h>

typedef struct TileRange {
    uint32_t x0, y0, x1, y1; /* tiles, both ends included */
} TileRange;

static TileRange tiles_of(const Pass *pass, const Primitive *primitive)
{
    const PixelRect *box = &primitive->box;
    uint32_t tile = (uint32_t)pass->tile;
    return (TileRange){(uint32_t)box->x0 / tile, (uint32_t)box->y0 / tile, (uint32_t)box->x1 / tile,
                       (uint32_t)box->y1 / tile};
}

/* Counting sort by tile of a list cut into chunks: each counts its primitives per tile, prefix sums
 * in order of tile and chunk turn counts into places, and each puts its indices there. */
typedef struct Binning {
    Pass *pass;
    const PrimitiveList *list;
    Bins *bins;
    uint32_t chunks;
    size_t *places; /* per chunk, per tile */
} Binning;

enum {
    BINNING_CHUNKS = 16
};

static void bin_chunk(const Binning *binning, uint32_t chunk, bool put)
{
    const Pass *pass = binning->pass;
    size_t *places = binning->places + (size_t)chunk * pass->tile_count;
    size_t end = binning->list->count * (chunk + 1) / binning->chunks;
    for (size_t i = binning->list->count * chunk / binning->chunks; i < end; i++) {
        TileRange r = tiles_of(pass, &binning->list->items[i]);
        for (uint32_t y = r.y0; y <= r.y1; y++)
            for (uint32_t x = r.x0; x <= r.x1; x++) {
                size_t place = places[y * pass->tile_columns + x]++;
                if (put)
                    binning->bins->item[place] = (uint32_t)i;
            }
    }
}

static Result count_chunk(void *context, uint32_t chunk, int worker)
{
    (void)worker;
    bin_chunk(context, chunk, false);
    return RESULT_OK;
}

static Result put_chunk(void *context, uint32_t chunk, int worker)
{
    (void)worker;
    bin_chunk(context, chunk, true);
    return RESULT_OK;
}

static void count_to_place(const Binning *binning)
{
    uint32_t tiles = binning->pass->tile_count;
    size_t sum = 0;
    for (uint32_t tile = 0; tile < tiles; tile++) {
        binning->bins->first[tile] = sum;
        for (uint32_t chunk = 0; chunk < binning->chunks; chunk++) {
            size_t *place = &binning->places[(size_t)chunk * tiles + tile], count = *place;
            *place = sum;
            sum += count;
        }
    }
    binning->bins->first[tiles] = sum;
}

static Result bin(Pass *pass, const PrimitiveList *list, Bins *out)
{
    Binning binning = {.pass = pass, .list = list, .bins = out, .chunks = BINNING_CHUNKS};
    /* Places for many chunks of few primitives would cost more than they save. */
    if (list->count / BINNING_CHUNKS < pass->tile_count)
        binning.chunks = 1;
    out->first = memory_array(pass->tile_count + (size_t)1, sizeof *out->first);
    binning.places = memory_array((size_t)binning.chunks * pass->tile_count, sizeof(size_t));
    Result result = out->first && binning.places ? RESULT_OK : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = pool_run(pass->pool, binning.chunks, count_chunk, &binning);
    if (result == RESULT_OK) {
        count_to_place(&binning);
        result = pass_reserve(pass, out->first[pass->tile_count] * sizeof *out->item);
    }
    if (result == RESULT_OK) {
        out->item = memory_array(out->first[pass->tile_count], sizeof *out->item);
        result = out->item ? pool_run(pass->pool, binning.chunks, put_chunk, &binning)
                           : RESULT_NO_MEMORY;
    }
    free(binning.places);
    return result;
}

Result pass_reserve(Pass *pass, uint64_t bytes)
{
    pass->bytes += bytes;
    if (pass->bytes <= pass->limit)
        return RESULT_OK;
    return result_fail(RESULT_NO_MEMORY,
                       "ref: %d×%d needs at least %llu KiB, the limit is %llu KiB "
                       "(--max-memory)",
                       pass->view.width, pass->view.height, (unsigned long long)(pass->bytes >> 10),
                       (unsigned long long)(pass->limit >> 10));
}

/* The frame's images, and what geometry_build allocates: vertices, and each primitive twice. What
 * clipping adds is small and not foreseen. */
static Result reserve_geometry(Pass *pass)
{
    uint64_t bytes = (uint64_t)pass->view.width * (uint64_t)pass->view.height *
                     (format_pixel_bytes(FORMAT_RGBA32F) + format_pixel_bytes(FORMAT_RGBA8));
    for (size_t i = 0; i < pass->view.draw_count; i++) {
        const Mesh *mesh = &pass->scene->meshes[pass->view.draws[i].mesh];
        bytes += mesh->vertex_count * sizeof(Vertex) +
                 2 * (uint64_t)mesh->triangle_count * sizeof(Primitive);
    }
    return pass_reserve(pass, bytes);
}

Result pass_create(const Scene *scene, const RenderDesc *desc, bool traced, Pass *out)
{
    *out = (Pass){
        .desc = desc,
        .scene = scene,
        .limit = desc->max_memory ? desc->max_memory : RENDER_MEMORY_DEFAULT,
        .fused = !desc->unfused,
        .reversed = desc->depth_range == DEPTH_RANGE_REVERSED,
        .depth_format = render_desc_depth(desc),
    };
    Result result = view_build(scene, desc, &out->view); /* checks desc, too */
    if (result != RESULT_OK)
        return result;
    out->layout = render_desc_layout(desc);
    if (desc->mutations)
        mutate_view(scene, desc, &out->view);
    /* A mistake may depend on what a right frame does not need. */
    needs_derive(scene, &out->view, desc, traced || desc->mutations, &out->needs);
    for (int i = 0; i < 2; i++)
        out->stored[i] = needs_layout(&out->needs, desc, i == 1);
    out->tile = desc->tile ? desc->tile : TILE_DEFAULT;
    uint32_t tile = (uint32_t)out->tile;
    out->tile_columns = ((uint32_t)desc->width + tile - 1) / tile;
    out->tile_count = out->tile_columns * (((uint32_t)desc->height + tile - 1) / tile);
    out->pool = pool_create(desc->threads);
    result = out->pool ? reserve_geometry(out) : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = geometry_build(scene, &out->view, out->fused, out->pool, &out->geometry);
    if (result == RESULT_OK)
        result = bin(out, &out->geometry.opaque, &out->opaque_bins);
    if (result == RESULT_OK)
        result = bin(out, &out->geometry.transparent, &out->transparent_bins);
    if (result != RESULT_OK)
        pass_free(out);
    return result;
}

static void free_bins(Bins *bins)
{
    free(bins->first);
    free(bins->item);
}

void pass_free(Pass *pass)
{
    free_bins(&pass->opaque_bins);
    free_bins(&pass->transparent_bins);
    geometry_free(&pass->geometry);
    pool_destroy(pass->pool);
    view_free(&pass->view);
    *pass = (Pass){0};
}

static bool meets(const Primitive *primitive, PixelRect rect)
{
    const PixelRect *box = &primitive->box;
    return box->x0 <= rect.x1 && box->x1 >= rect.x0 && box->y0 <= rect.y1 && box->y1 >= rect.y0;
}

/* The one tile's bin. */
static Result bin_part(const PrimitiveList *list, PixelRect rect, Bins *out)
{
    size_t count = 0, room = 1;
    Result result = RESULT_OK;
    out->first = memory_array(2, sizeof *out->first);
    out->item = memory_array(room, sizeof *out->item);
    if (!out->first || !out->item)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < list->count && result == RESULT_OK; i++) {
        if (!meets(&list->items[i], rect))
            continue;
        void *item = out->item;
        result = memory_grow(&item, &room, count + 1, sizeof *out->item);
        out->item = item;
        if (result == RESULT_OK)
            out->item[count++] = (uint32_t)i;
    }
    out->first[1] = count;
    return result;
}

Result pass_part(const Pass *whole, const RenderDesc *desc, PixelRect rect, Pool *pool, Pass *out)
{
    *out = *whole;
    out->desc = desc;
    out->pool = pool;
    out->opaque_bins = out->transparent_bins = (Bins){0};
    out->view.width = rect.x1 - rect.x0 + 1;
    out->view.height = rect.y1 - rect.y0 + 1;
    out->x0 = rect.x0;
    out->y0 = rect.y0;
    out->tile = TILE_MAX;
    out->tile_columns = out->tile_count = 1;
    Result result = bin_part(&out->geometry.opaque, rect, &out->opaque_bins);
    if (result == RESULT_OK)
        result = bin_part(&out->geometry.transparent, rect, &out->transparent_bins);
    if (result != RESULT_OK)
        pass_part_free(out);
    return result;
}

void pass_part_free(Pass *part)
{
    free_bins(&part->opaque_bins);
    free_bins(&part->transparent_bins);
    *part = (Pass){0};
}

PixelRect pass_tile_rect(const Pass *pass, uint32_t tile)
{
    int x0 = pass->x0 + (int)(tile % pass->tile_columns) * pass->tile;
    int y0 = pass->y0 + (int)(tile / pass->tile_columns) * pass->tile;
    int x1 = x0 + pass->tile - 1, y1 = y0 + pass->tile - 1;
    int right = pass->x0 + pass->view.width - 1, top = pass->y0 + pass->view.height - 1;
    return (PixelRect){(int16_t)x0, (int16_t)y0, (int16_t)(x1 < right ? x1 : right),
                       (int16_t)(y1 < top ? y1 : top)};
}

void pass_counts_add(PassCounts *sum, const PassCounts *tile)
{
    sum->max = tile->max > sum->max ? tile->max : sum->max;
    sum->fragments += tile->fragments;
    sum->peeled += tile->peeled;
    sum->repeated += tile->repeated;
    sum->shaded += tile->shaded;
    sum->overflowed += tile->overflowed;
    sum->remaining += tile->remaining;
    sum->residual_pixels += tile->residual_pixels;
    sum->residual_max =
        tile->residual_max > sum->residual_max ? tile->residual_max : sum->residual_max;
}

void pass_counts_report(const PassCounts *counts, Frame *frame)
{
    frame->layers.max = counts->max;
    frame->layers.fragments = counts->fragments;
    frame->layers.repeated = counts->repeated;
    frame->layers.overflowed = counts->overflowed;
    frame->fragments_shaded = counts->shaded;
    frame->layers.lost_to_pass_limit = counts->remaining;
    frame->layers.lost_to_ties =
        counts->fragments - (counts->peeled - counts->repeated) - counts->remaining;
    frame->residual_max = counts->residual_max;
    frame->residual_pixels = counts->residual_pixels;
}

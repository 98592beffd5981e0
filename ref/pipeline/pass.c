#include "ref/pipeline/pass.h"

#include "base/memory.h"
#include "frame/shading.h"

#include <stdlib.h>

typedef struct TileRange {
    uint32_t x0, y0, x1, y1; /* tiles, both ends included */
} TileRange;

static TileRange tiles_of(const Pass *pass, const Primitive *primitive)
{
    const Vertex *vertices = pass->geometry.vertices;
    const Vertex *const corners[3] = {&vertices[primitive->vertex[0]],
                                      &vertices[primitive->vertex[1]],
                                      &vertices[primitive->vertex[2]]};
    PixelRect box = setup_bounds(corners, pass->view.width, pass->view.height);
    return (TileRange){(uint32_t)box.x0 / TILE, (uint32_t)box.y0 / TILE, (uint32_t)box.x1 / TILE,
                       (uint32_t)box.y1 / TILE};
}

/* Counting sort by tile: counts, prefix sums, then the indices in draw order. */
static Result bin(Pass *pass, const PrimitiveList *list, Bins *out)
{
    out->first = memory_array(pass->tile_count + (size_t)2, sizeof *out->first);
    if (!out->first)
        return RESULT_NO_MEMORY;
    size_t *next = out->first + 1; /* next[t] ends up as first[t + 1] */
    for (size_t i = 0; i < list->count; i++) {
        TileRange r = tiles_of(pass, &list->items[i]);
        for (uint32_t y = r.y0; y <= r.y1; y++)
            for (uint32_t x = r.x0; x <= r.x1; x++)
                next[y * pass->tile_columns + x + 1]++;
    }
    for (uint32_t t = 0; t < pass->tile_count; t++)
        next[t + 1] += next[t];
    Result result = pass_reserve(pass, next[pass->tile_count] * sizeof *out->item);
    if (result != RESULT_OK)
        return result;
    out->item = memory_array(next[pass->tile_count], sizeof *out->item);
    if (!out->item)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < list->count; i++) {
        TileRange r = tiles_of(pass, &list->items[i]);
        for (uint32_t y = r.y0; y <= r.y1; y++)
            for (uint32_t x = r.x0; x <= r.x1; x++)
                out->item[next[y * pass->tile_columns + x]++] = (uint32_t)i;
    }
    return RESULT_OK;
}

Result pass_reserve(Pass *pass, uint64_t bytes)
{
    pass->bytes += bytes;
    if (pass->bytes <= pass->limit)
        return RESULT_OK;
    return result_fail(RESULT_NO_MEMORY,
                       "ref: %d×%d needs %llu KiB, the limit is %llu KiB "
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
        .layout = render_desc_layout(desc),
    };
    Result result = view_build(scene, desc, &out->view);
    if (result != RESULT_OK)
        return result;
    needs_derive(scene, &out->view, desc, traced, &out->needs);
    for (int i = 0; i < 2; i++)
        out->stored[i] = needs_layout(&out->needs, desc, i == 1);
    out->tile_columns = ((uint32_t)desc->width + TILE - 1) / TILE;
    out->tile_count = out->tile_columns * (((uint32_t)desc->height + TILE - 1) / TILE);
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

void pass_free(Pass *pass)
{
    free(pass->opaque_bins.first);
    free(pass->opaque_bins.item);
    free(pass->transparent_bins.first);
    free(pass->transparent_bins.item);
    geometry_free(&pass->geometry);
    pool_destroy(pass->pool);
    view_free(&pass->view);
    *pass = (Pass){0};
}

PixelRect pass_tile_rect(const Pass *pass, uint32_t tile)
{
    int x0 = (int)(tile % pass->tile_columns) * TILE, y0 = (int)(tile / pass->tile_columns) * TILE;
    int x1 = x0 + TILE - 1, y1 = y0 + TILE - 1;
    return (PixelRect){x0, y0, x1 < pass->view.width ? x1 : pass->view.width - 1,
                       y1 < pass->view.height ? y1 : pass->view.height - 1};
}

void pass_setup(const Pass *pass, const Primitive *primitive, Setup *out)
{
    const Vertex *vertices = pass->geometry.vertices;
    const Vertex *const corners[3] = {&vertices[primitive->vertex[0]],
                                      &vertices[primitive->vertex[1]],
                                      &vertices[primitive->vertex[2]]};
    setup_triangle(corners, pass->view.draws[primitive->draw].flipped, pass->view.width,
                   pass->view.height, out);
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

float pass_background_weight(const Pass *pass, const float accum[4], float opaque_alpha)
{
    if (pass->desc->opaque_blend == OPAQUE_BLEND_SEED && opaque_alpha > SHADING_ALPHA_TEST)
        return 0.0f;
    return accum[3];
}

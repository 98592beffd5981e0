#include "ref/truth/pixel_truth.h"

#include "base/memory.h"
#include "ref/truth/fragments.h"
#include "ref/truth/lit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct PixelTruth {
    RenderDesc desc;
    View view;
    Pool *pool;
    Soup soup;
    TileFragments fragments; /* of the tile looked at last */
    int64_t tile;            /* its number, -1: none */
};

Result pixel_truth_open(const Scene *scene, const RenderDesc *desc, PixelTruth **out)
{
    *out = NULL;
    PixelTruth *truth = memory_array(1, sizeof *truth);
    if (!truth)
        return RESULT_NO_MEMORY;
    truth->desc = *desc;
    truth->desc.draw_order = DRAW_ORDER_SCENE; /* triangles are numbered as they come */
    truth->tile = -1;
    size_t limit = desc->max_memory ? desc->max_memory : RENDER_MEMORY_DEFAULT;
    Result result = view_build(scene, &truth->desc, &truth->view);
    if (result == RESULT_OK) {
        truth->pool = pool_create(desc->threads);
        result = truth->pool ? soup_build(scene, &truth->view, truth->pool, limit, &truth->soup)
                             : RESULT_NO_MEMORY;
        truth->fragments.limit_bytes = limit;
    }
    if (result == RESULT_OK)
        *out = truth;
    else
        pixel_truth_close(truth);
    return result;
}

void pixel_truth_close(PixelTruth *truth)
{
    if (!truth)
        return;
    fragments_free(&truth->fragments);
    soup_free(&truth->soup);
    if (truth->pool)
        pool_destroy(truth->pool);
    view_free(&truth->view);
    free(truth);
}

static void fill_fragment(const PixelTruth *truth, const Fragment *fragment, const Lit *lit,
                          HistoryFragment *out)
{
    const Draw *draw = soup_draw(&truth->soup, fragment->triangle)->draw;
    const MaterialSample *material = &lit->surface.material;
    HistorySurface *surface = &out->surface;
    out->primitive = soup_primitive(&truth->soup, fragment->triangle);
    out->instance = draw->instance;
    out->mesh = draw->mesh;
    out->material = draw->material;
    out->transparent = draw->transparent;
    out->front = !fragment->back;
    out->z = out->depth = fragment->depth;
    out->distance = lit->z;
    memcpy(surface->position, lit->surface.position, sizeof surface->position);
    memcpy(surface->normal, lit->surface.normal, sizeof surface->normal);
    memcpy(surface->base, material->base_color, sizeof surface->base);
    surface->roughness = material->roughness;
    surface->metallic = material->metallic;
    surface->occlusion = material->occlusion;
    surface->lit = lit->alpha > 0.0;
    for (int i = 0; i < 3; i++)
        surface->source[i] = lit->rgb[i] * lit->alpha;
    surface->source[3] = lit->alpha;
}

static Result put_fragment(const PixelTruth *truth, const Fragment *fragment, int x, int y,
                           int peel, double rgba[4], History *out)
{
    Lit lit;
    lit_fragment(&truth->soup, &truth->desc, fragment, x, y, &lit);
    HistoryFragment *added = history_add_fragment(out);
    if (!added)
        return RESULT_NO_MEMORY;
    fill_fragment(truth, fragment, &lit, added);
    added->fate = peel == HISTORY_NONE ? HISTORY_SEEN : HISTORY_PEELED;
    added->peel = peel;
    if (!(rgba[3] > 0.0) || !added->surface.lit)
        return RESULT_OK;
    HistoryStep *step = history_add_step(out);
    if (!step)
        return RESULT_NO_MEMORY;
    *step = (HistoryStep){.target = "accum",
                          .equation = "under",
                          .format = "double",
                          .channels = 4,
                          .fragment = (int)out->fragment_count - 1,
                          .stored = true};
    if (peel == HISTORY_NONE)
        snprintf(step->step, sizeof step->step, "opaque");
    else
        snprintf(step->step, sizeof step->step, "peel.%d", peel);
    memcpy(step->source, added->surface.source, sizeof step->source);
    memcpy(step->before, rgba, sizeof step->before);
    lit_blend(&lit, rgba);
    memcpy(step->after, rgba, sizeof step->after);
    return RESULT_OK;
}

static void put_results(const PixelTruth *truth, const double rgba[4], History *out)
{
    for (int i = 0; i < 4; i++)
        out->accum[i] = rgba[i];
    for (int i = 0; i < 3; i++) {
        out->final[i] = rgba[i] + rgba[3] * truth->view.background[i];
        out->display[i] = radiance_display(out->final[i]);
    }
    out->final[3] = 1.0 - rgba[3];
    out->display[3] = 255;
}

Result pixel_truth_history(PixelTruth *truth, int x, int y, History *out)
{
    const View *view = &truth->view;
    TileFragments *tile = &truth->fragments;
    *out = (History){.renderer = "truth",
                     .x = x,
                     .y = y,
                     .method = truth->desc.method,
                     .accum_format = "double",
                     .depth_format = "double",
                     .note = "fragments behind the opaque surface are not kept"};
    if (x < 0 || y < 0 || x >= view->width || y >= view->height)
        return result_fail(RESULT_BAD_INPUT,
                           "pixel %d,%d: expected 0,0 to %d,%d, from the top left", x, y,
                           view->width - 1, view->height - 1);
    uint32_t number = (uint32_t)(y / TRACE_TILE * truth->soup.tile_columns + x / TRACE_TILE);
    Result result = RESULT_OK;
    if (truth->tile != (int64_t)number)
        result = fragments_collect(&truth->soup, &truth->desc, number, tile);
    truth->tile = result == RESULT_OK ? (int64_t)number : -1;
    if (result != RESULT_OK)
        return result;
    int pixel = y % TRACE_TILE * TRACE_TILE + x % TRACE_TILE, up = view->height - 1 - y;
    double rgba[4] = {0.0, 0.0, 0.0, 1.0};
    for (uint32_t i = tile->first[pixel]; i < tile->first[pixel + 1] && result == RESULT_OK; i++)
        result =
            put_fragment(truth, &tile->sorted[i], x, up, (int)(i - tile->first[pixel]), rgba, out);
    out->transmittance = rgba[3];
    if (result == RESULT_OK && tile->opaque[pixel].triangle != FRAGMENT_NO_TRIANGLE)
        result = put_fragment(truth, &tile->opaque[pixel], x, up, HISTORY_NONE, rgba, out);
    put_results(truth, rgba, out);
    return result;
}

/* Deferred depth peeling, the definition path: scalar, pass by pass over whole buffers, traced.
 *
 * This work is based on: Luigi Rapetta, "OpenGL 4.6 Deferred Renderer with Deferred Depth
 * Peeling"; Cass Everitt, "Interactive Order-Independent Transparency", NVIDIA, 2001.
 *
 * Opaque geometry pass; then peels, each a geometry pass that keeps the nearest fragment behind
 * the previous peel and in front of the opaque depth, and a lighting pass blended under; then the
 * opaque lighting pass, blended under; then the background. Two depth buffers take turns; the
 * color buffers of the peels are shared. */
#include "ref/pipeline/methods/methods.h"

#include "base/memory.h"
#include "ref/pipeline/stage.h"

#include <stdlib.h>

typedef struct Peel {
    int peel;
    GBuffer layer;        /* its depth is the current peel's */
    Image previous_depth; /* the other of the two depth buffers */
    int limit;            /* of peels */
    /* Of mistakes only: the first peel is tested too; how many layers a pixel has, NULL where that
     * does not matter. */
    bool stale;
    uint32_t *layers;
} Peel;

/* ---- geometry pass ---- */

static void visit_fragment(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    Stage *stage = visit->stage;
    const Peel *peel = stage->method;
    const Pass *pass = stage->pass;
    size_t pixel = stage_pixel(pass, x, y);
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    if (pass_hidden(pass, depth, stage_key(&stage->opaque.depth, pixel)))
        return;
    if (peel->peel == 0)
        stage->fragments[pixel]++;
    else if (pass_peeled(pass, depth, stage_key(&peel->previous_depth, pixel)))
        return;
    stage_keep(visit, setup, x, y, depth);
}

/* The same with mistaken tests. */
static void visit_mutated(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    Stage *stage = visit->stage;
    const Peel *peel = stage->method;
    const Pass *pass = stage->pass;
    size_t fetched = mutate_fetch(pass, x, y);
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    if (mutate_hidden(pass, depth, stage_key(&stage->opaque.depth, fetched)))
        return;
    if (peel->peel == 0)
        stage->fragments[stage_pixel(pass, x, y)]++;
    if ((peel->peel > 0 || peel->stale) &&
        mutate_peeled(pass, depth, stage_key(&peel->previous_depth, fetched)))
        return;
    stage_keep(visit, setup, x, y, depth);
}

static void geometry_tile(Stage *stage, uint32_t tile)
{
    Peel *peel = stage->method;
    const Bins *bins = &stage->pass->transparent_bins;
    StageVisit visit = {
        .stage = stage, .target = &peel->layer, .list = &stage->pass->geometry.transparent};
    if (stage->pass->desc->mutations)
        stage_draw(bins, tile, visit_mutated, &visit);
    else
        stage_draw(bins, tile, visit_fragment, &visit);
    stage_shade_winners(&visit, tile);
}

/* ---- what a pass limit left behind ---- */

static void visit_remaining(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    Stage *stage = visit->stage;
    const Peel *peel = stage->method;
    const Pass *pass = stage->pass;
    size_t pixel = stage_pixel(pass, x, y);
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    if (!pass_hidden(pass, depth, stage_key(&stage->opaque.depth, pixel)) &&
        pass_remains(pass, depth, stage_key(&peel->previous_depth, pixel)))
        stage->remaining[pixel]++;
}

static void remaining_tile(Stage *stage, uint32_t tile)
{
    StageVisit visit = {.stage = stage, .list = &stage->pass->geometry.transparent};
    stage_draw(&stage->pass->transparent_bins, tile, visit_remaining, &visit);
    stage_count_remaining(stage, tile);
}

/* ---- peels ---- */

static void clear_layer(Stage *stage)
{
    Peel *peel = stage->method;
    const Pass *pass = stage->pass;
    DepthRange range = pass->desc->depth_range;
    gbuffer_clear_colors(&peel->layer);
    mutate_clear(pass, &peel->layer);
    if (peel->peel < 2 || !mutate_has(pass, MUTATION_PEEL_DEPTH_NOT_CLEARED))
        gbuffer_clear_depth(&peel->layer.depth, range);
    if (peel->peel > 0 && mutate_has(pass, MUTATION_ONE_DEPTH_BUFFER))
        gbuffer_clear_depth(&peel->previous_depth, range);
}

/* Geometry pass of the next peel. *stop: it yielded nothing (auto with the raw test: nothing new),
 * and there is nothing to blend or to count. */
static Result draw_peel(Stage *stage, bool *stop)
{
    Peel *peel = stage->method;
    const RenderDesc *desc = stage->pass->desc;
    clear_layer(stage);
    Result result = stage_run(stage, geometry_tile);
    uint64_t drawn, repeated;
    stage_count_drawn(&peel->layer, peel->peel > 0 ? &peel->previous_depth : NULL, &drawn,
                      &repeated);
    bool stale = desc->passes == 0 && desc->peel_test == PEEL_TEST_RAW && repeated == drawn;
    *stop = drawn == 0 || stale;
    if (!*stop) {
        stage->counts.peeled += drawn;
        stage->counts.repeated += repeated;
    }
    return result;
}

/* Leaves in the layer, which is lit already, only what is in the middle of its pixel's layers. */
static void keep_middle(const Peel *peel)
{
    const Image *diffuse = &peel->layer.diffuse;
    size_t bytes = format_pixel_bytes(diffuse->format);
    for (size_t i = 0; i < (size_t)diffuse->width * (size_t)diffuse->height; i++)
        if (peel->layers[i] != 2 * (uint32_t)peel->peel + 1)
            memset((char *)diffuse->pixels + i * bytes, 0, bytes);
}

static bool is_peeled(const Stage *stage, const Primitive *primitive, FragmentDepth depth,
                      size_t pixel)
{
    const Peel *peel = stage->method;
    (void)primitive;
    return peel->peel > 0 &&
           pass_peeled(stage->pass, depth, stage_key(&peel->previous_depth, pixel));
}

/* Lighting pass of a peel. */
static Result light_peel(Stage *stage)
{
    const Peel *peel = stage->method;
    Result result = stage_put_gbuffer(stage, peel->peel, &peel->layer);
    if (result == RESULT_OK)
        result = details_put_rejected(stage, peel->peel, &peel->layer.primitive, is_peeled);
    if (mutate_has(stage->pass, MUTATION_ACCUMULATION_CLEARED))
        stage_clear_accum(stage);
    if (result == RESULT_OK)
        result = stage_light(stage, &peel->layer, true);
    if (result == RESULT_OK)
        result = stage_put_source(stage, peel->peel);
    if (result == RESULT_OK && peel->layers) {
        keep_middle(peel);
        result = stage_light(stage, &peel->layer, true);
    }
    return result == RESULT_OK ? stage_put(stage, peel->peel, "accum", &stage->accum) : result;
}

/* Peeling that may repeat layers ends after as many peels as the deepest pixel needs. */
static void limit_repeats(const Stage *stage, Peel *peel)
{
    const Pass *pass = stage->pass;
    uint32_t most = 1;
    if (pass->desc->passes > 0 || !mutate_repeats(pass))
        return;
    for (size_t i = 0; i < (size_t)pass->view.width * (size_t)pass->view.height; i++)
        most = stage->fragments[i] > most ? stage->fragments[i] : most;
    if (most < (uint32_t)peel->limit)
        peel->limit = (int)most;
}

/* light: what follows a geometry pass that drew something. */
static Result peels(Stage *stage, Result (*light)(Stage *stage))
{
    Peel *peel = stage->method;
    for (peel->peel = 0; peel->peel < peel->limit; peel->peel++) {
        bool stop;
        Result result = draw_peel(stage, &stop);
        if (result == RESULT_OK && stop)
            break;
        if (result == RESULT_OK)
            result = light(stage);
        if (result != RESULT_OK)
            return result;
        if (peel->peel == 0 || !mutate_has(stage->pass, MUTATION_DEPTH_NOT_SWAPPED))
            image_swap(&peel->layer.depth, &peel->previous_depth);
        if (peel->peel == 0)
            limit_repeats(stage, peel);
        stage->frame->peels = peel->peel + 1;
    }
    return RESULT_OK;
}

/* ---- mistakes that depend on what the whole frame peels ---- */

static bool needs_rehearsal(const Pass *pass)
{
    return mutate_has(pass, MUTATION_PREVIOUS_DEPTH_STALE) ||
           mutate_has(pass, MUTATION_PASSES_SHORT) || mutate_has(pass, MUTATION_DUAL_MIDDLE_TWICE);
}

/* In place of the lighting pass. */
static Result count_layer(Stage *stage)
{
    const Peel *peel = stage->method;
    const Image *primitive = &peel->layer.primitive;
    for (size_t i = 0; i < (size_t)primitive->width * (size_t)primitive->height; i++)
        peel->layers[i] += ((const uint32_t *)primitive->pixels)[i] != PRIMITIVE_NONE;
    return RESULT_OK;
}

/* The frame before this one, without its light: leaves its last depth in previous_depth. */
static Result rehearse(Stage *stage)
{
    Peel *peel = stage->method;
    const Pass *pass = stage->pass;
    size_t pixels = (size_t)pass->view.width * (size_t)pass->view.height;
    peel->layers = memory_array(pixels, sizeof *peel->layers);
    Result result = peel->layers ? peels(stage, count_layer) : RESULT_NO_MEMORY;
    peel->stale = mutate_has(pass, MUTATION_PREVIOUS_DEPTH_STALE);
    peel->limit = render_desc_pass_limit(pass->desc);
    if (mutate_has(pass, MUTATION_PASSES_SHORT))
        peel->limit = stage->frame->peels > 0 ? stage->frame->peels - 1 : 0;
    if (!mutate_has(pass, MUTATION_DUAL_MIDDLE_TWICE)) {
        free(peel->layers);
        peel->layers = NULL;
    }
    memset(stage->fragments, 0, pixels * sizeof *stage->fragments);
    stage->counts = (PassCounts){0};
    stage->frame->peels = 0;
    return result;
}

/* ---- the frame ---- */

static Result run(Stage *stage)
{
    Peel *peel = stage->method;
    const Pass *pass = stage->pass;
    peel->limit = render_desc_pass_limit(pass->desc);
    Result result = stage_opaque(stage);
    if (result == RESULT_OK && needs_rehearsal(pass))
        result = rehearse(stage);
    bool first = mutate_has(pass, MUTATION_OPAQUE_BLENDED_FIRST);
    if (result == RESULT_OK && first)
        result = stage_light(stage, &stage->opaque, false);
    if (result == RESULT_OK)
        result = peels(stage, light_peel);
    if (result != RESULT_OK)
        return result;
    stage->frame->geometry_passes = pass_geometry_passes(pass, stage->frame->peels);
    if (!pass->desc->mutations && pass_may_leave(pass, stage->frame->peels, peel->limit))
        result = stage_run(stage, remaining_tile);
    if (result != RESULT_OK)
        return result;
    return first ? stage_resolve(stage) : stage_finish(stage);
}

Result peel_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    Peel peel = {0};
    Stage stage;
    uint64_t pixels = (uint64_t)pass->view.width * (uint64_t)pass->view.height;
    uint64_t own = pixels * format_pixel_bytes(pass->depth_format);
    if (needs_rehearsal(pass))
        own += pixels * sizeof *peel.layers;
    Result result =
        stage_create(pass, trace, frame, &peel, stage_gbuffer_bytes(pass, true) + own, &stage);
    if (result != RESULT_OK)
        return result;
    result = gbuffer_create(pass->desc, &pass->stored[1], &peel.layer);
    if (result == RESULT_OK)
        result = image_create(pass->view.width, pass->view.height, pass->depth_format,
                              &peel.previous_depth);
    if (result == RESULT_OK)
        result = run(&stage);
    free(peel.layers);
    gbuffer_free(&peel.layer);
    image_free(&peel.previous_depth);
    stage_free(&stage);
    return result;
}

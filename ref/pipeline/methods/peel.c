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

#include "ref/pipeline/stage.h"

typedef struct Peel {
    int peel;
    GBuffer layer;        /* its depth is the current peel's */
    Image previous_depth; /* the other of the two depth buffers */
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

static void geometry_tile(Stage *stage, uint32_t tile)
{
    Peel *peel = stage->method;
    StageVisit visit = {
        .stage = stage, .target = &peel->layer, .list = &stage->pass->geometry.transparent};
    stage_draw(&stage->pass->transparent_bins, tile, visit_fragment, &visit);
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

/* ---- the frame ---- */

/* Geometry pass of the next peel. *stop: it yielded nothing (auto with the raw test: nothing new),
 * and there is nothing to blend or to count. */
static Result draw_peel(Stage *stage, bool *stop)
{
    Peel *peel = stage->method;
    const RenderDesc *desc = stage->pass->desc;
    gbuffer_clear(&peel->layer, desc->depth_range);
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

static Result peels(Stage *stage)
{
    Peel *peel = stage->method;
    int limit = render_desc_pass_limit(stage->pass->desc);
    for (peel->peel = 0; peel->peel < limit; peel->peel++) {
        bool stop;
        Result result = draw_peel(stage, &stop);
        if (result == RESULT_OK && stop)
            break;
        if (result == RESULT_OK)
            result = stage_put_gbuffer(stage, peel->peel, &peel->layer);
        if (result == RESULT_OK)
            result = stage_light(stage, &peel->layer, true);
        if (result == RESULT_OK)
            result = stage_put(stage, peel->peel, "accum", &stage->accum);
        if (result != RESULT_OK)
            return result;
        image_swap(&peel->layer.depth, &peel->previous_depth);
        stage->frame->peels = peel->peel + 1;
    }
    stage->frame->geometry_passes = pass_geometry_passes(stage->pass, stage->frame->peels);
    return pass_may_leave(stage->pass, stage->frame->peels, limit)
               ? stage_run(stage, remaining_tile)
               : RESULT_OK;
}

Result peel_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    Peel peel = {0};
    Stage stage;
    uint64_t depth_bytes = (uint64_t)pass->view.width * (uint64_t)pass->view.height *
                           format_pixel_bytes(pass->depth_format);
    Result result = stage_create(pass, trace, frame, &peel,
                                 stage_gbuffer_bytes(pass, true) + depth_bytes, &stage);
    if (result != RESULT_OK)
        return result;
    result = gbuffer_create(pass->desc, &pass->stored[1], &peel.layer);
    if (result == RESULT_OK)
        result = image_create(pass->view.width, pass->view.height, pass->depth_format,
                              &peel.previous_depth);
    if (result == RESULT_OK)
        result = stage_opaque(&stage);
    if (result == RESULT_OK)
        result = peels(&stage);
    if (result == RESULT_OK)
        result = stage_finish(&stage);
    gbuffer_free(&peel.layer);
    image_free(&peel.previous_depth);
    stage_free(&stage);
    return result;
}

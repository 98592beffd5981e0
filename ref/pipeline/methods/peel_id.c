/* Deferred depth peeling by depth and primitive, the definition path.
 *
 * This work is based on: Cass Everitt, "Interactive Order-Independent Transparency", NVIDIA, 2001;
 * Luigi Rapetta, "OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling". The second key is
 * ours.
 *
 * As peel.c, but the layers are ordered by (stored depth, primitive id), so that fragments of one
 * depth are layers of their own, and neither the depth function nor the order of drawing decides
 * which one is lost. Of equal depths the smaller id is in front with DEPTH_LESS, the greater with
 * DEPTH_LEQUAL. A peel keeps the first fragment that comes after the previous layer and is not
 * hidden; "after" always compares stored depths (a raw test only decides what is hidden), so no
 * layer is found twice. A bias leaves out what is behind the previous depth, but not farther than
 * it; fragments at the previous depth itself are kept.
 *
 * One triangle can give a pixel two fragments of the same depth only where the clipper cut it and
 * its pieces, snapped, overlap. Then the later piece is kept, the other is lost to a tie.
 *
 * A peel is three geometry passes, as in gl: depth, primitive, G-buffer. The trace has the buffers
 * of peel, and peel.K.id (FORMAT_R32UI), the buffer of selected ids. */
#include "ref/pipeline/methods/methods.h"

#include "ref/pipeline/stage.h"

typedef struct PeelId {
    int peel;
    GBuffer layer;                     /* its depth and ids are the current peel's */
    Image previous_depth, previous_id; /* the others of the two pairs that take turns */
} PeelId;

static inline uint32_t previous_id(const PeelId *state, size_t pixel)
{
    return ((const uint32_t *)state->previous_id.pixels)[pixel];
}

/* ---- geometry pass ---- */

/* Keeps the fragment if it comes before what is kept; of one triangle's pieces, the later. */
static inline void keep(const StageVisit *visit, size_t pixel, uint32_t key)
{
    const Pass *pass = visit->stage->pass;
    uint32_t *depth = (uint32_t *)visit->target->depth.pixels + pixel;
    uint32_t *id = (uint32_t *)visit->target->primitive.pixels + pixel;
    if (*id != PRIMITIVE_NONE) {
        bool first = key == *depth ? !pass_id_before(pass, *id, visit->primitive->id)
                                   : pass_depth_test(pass, key, *depth);
        if (!first)
            return;
    }
    *depth = key;
    *id = visit->primitive->id;
    visit->stage->winner[pixel] = (uint32_t)(visit->primitive - visit->list->items);
}

static void visit_fragment(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    Stage *stage = visit->stage;
    const PeelId *state = stage->method;
    const Pass *pass = stage->pass;
    size_t pixel = stage_pixel(pass, x, y);
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    if (pass_hidden(pass, depth, stage_key(&stage->opaque.depth, pixel)))
        return;
    if (state->peel == 0)
        stage->fragments[pixel]++;
    else if (!pass_comes_after(pass, depth.key, visit->primitive->id,
                               stage_key(&state->previous_depth, pixel), previous_id(state, pixel)))
        return;
    keep(visit, pixel, depth.key);
}

static void geometry_tile(Stage *stage, uint32_t tile)
{
    PeelId *state = stage->method;
    StageVisit visit = {
        .stage = stage, .target = &state->layer, .list = &stage->pass->geometry.transparent};
    stage_draw(&stage->pass->transparent_bins, tile, visit_fragment, &visit);
    stage_shade_winners(&visit, tile);
}

/* ---- what a pass limit left behind ---- */

static void visit_remaining(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    Stage *stage = visit->stage;
    const PeelId *state = stage->method;
    const Pass *pass = stage->pass;
    size_t pixel = stage_pixel(pass, x, y);
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    if (!pass_hidden(pass, depth, stage_key(&stage->opaque.depth, pixel)) &&
        pass_comes_after(pass, depth.key, visit->primitive->id,
                         stage_key(&state->previous_depth, pixel), previous_id(state, pixel)))
        stage->remaining[pixel]++;
}

static void remaining_tile(Stage *stage, uint32_t tile)
{
    StageVisit visit = {.stage = stage, .list = &stage->pass->geometry.transparent};
    stage_draw(&stage->pass->transparent_bins, tile, visit_remaining, &visit);
    stage_count_remaining(stage, tile);
}

/* ---- the frame ---- */

/* Geometry passes of the next peel; *drawn: the pixels it has. */
static Result draw_peel(Stage *stage, uint64_t *drawn)
{
    PeelId *state = stage->method;
    uint64_t repeated;
    gbuffer_clear(&state->layer, stage->pass->desc->depth_range);
    Result result = stage_run(stage, geometry_tile);
    stage_count_drawn(&state->layer, NULL, drawn, &repeated);
    stage->counts.peeled += *drawn;
    return result;
}

static bool is_peeled(const Stage *stage, const Primitive *primitive, FragmentDepth depth,
                      size_t pixel)
{
    const PeelId *state = stage->method;
    return state->peel > 0 &&
           !pass_comes_after(stage->pass, depth.key, primitive->id,
                             stage_key(&state->previous_depth, pixel), previous_id(state, pixel));
}

/* Traces and blends the layer that was drawn. */
static Result blend_peel(Stage *stage)
{
    PeelId *state = stage->method;
    Result result = stage_put_gbuffer(stage, state->peel, &state->layer);
    if (result == RESULT_OK)
        result = stage_put(stage, state->peel, "id", &state->layer.primitive);
    if (result == RESULT_OK)
        result = details_put_rejected(stage, state->peel, &state->layer.primitive, is_peeled);
    if (result == RESULT_OK)
        result = stage_light(stage, &state->layer, true);
    if (result == RESULT_OK)
        result = stage_put_source(stage, state->peel);
    if (result == RESULT_OK)
        result = stage_put(stage, state->peel, "accum", &stage->accum);
    image_swap(&state->layer.depth, &state->previous_depth);
    image_swap(&state->layer.primitive, &state->previous_id);
    return result;
}

static Result peels(Stage *stage)
{
    PeelId *state = stage->method;
    Frame *frame = stage->frame;
    int limit = render_desc_pass_limit(stage->pass->desc);
    for (state->peel = 0; state->peel < limit; state->peel++) {
        uint64_t drawn;
        Result result = draw_peel(stage, &drawn);
        if (result == RESULT_OK && drawn == 0)
            break;
        if (result == RESULT_OK)
            result = blend_peel(stage);
        if (result != RESULT_OK)
            return result;
        frame->peels = state->peel + 1;
    }
    frame->geometry_passes = 3 * frame->peels + (frame->peels < limit);
    return frame->peels == limit ? stage_run(stage, remaining_tile) : RESULT_OK;
}

static Result make(const Pass *pass, PeelId *out)
{
    int width = pass->view.width, height = pass->view.height;
    Result result = gbuffer_create(pass->desc, &pass->stored[1], &out->layer);
    if (result == RESULT_OK)
        result = image_create(width, height, pass->depth_format, &out->previous_depth);
    if (result == RESULT_OK)
        result = image_create(width, height, FORMAT_R32UI, &out->previous_id);
    return result;
}

Result peel_id_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    PeelId state = {0};
    Stage stage;
    uint64_t previous_bytes =
        (uint64_t)pass->view.width * (uint64_t)pass->view.height *
        (format_pixel_bytes(pass->depth_format) + format_pixel_bytes(FORMAT_R32UI));
    Result result = stage_create(pass, trace, frame, &state,
                                 stage_gbuffer_bytes(pass, true) + previous_bytes, &stage);
    if (result != RESULT_OK)
        return result;
    result = make(pass, &state);
    if (result == RESULT_OK)
        result = stage_opaque(&stage);
    if (result == RESULT_OK)
        result = peels(&stage);
    if (result == RESULT_OK)
        result = stage_finish(&stage);
    gbuffer_free(&state.layer);
    image_free(&state.previous_depth);
    image_free(&state.previous_id);
    stage_free(&stage);
    return result;
}

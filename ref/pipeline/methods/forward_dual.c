/* Dual depth peeling, shaded in the geometry pass; the definition path.
 *
 * This work is based on: Louis Bavoil, Kevin Myers, "Order Independent Transparency with Dual Depth
 * Peeling", NVIDIA, 2008.
 *
 * Three targets, all drawn with MAX: the min-max depths (minmax.h); the front colour, premultiplied
 * with 1 − transmittance in alpha, to which the nearest fragment adds itself and which every other
 * fragment of the pixel passes on; the back colour, cleared per peel, which a full-screen pass puts
 * over the back accumulation. At the end the front is put under the empty accumulation, which
 * copies it and leaves T = 1 − its alpha, then the back accumulation under that with 1 − its T as
 * alpha; then the opaque surfaces, lit as ever.
 *
 * Of several fragments at one depth the greatest of each channel is kept: they count as one layer,
 * and the rest as lost. Fixed-point formats clamp each layer's colour to 1 before it is weighted,
 * from either side.
 *
 * Trace: forward-dual.first.depth (step 0), and of peel K forward-dual.K.depth, .front, .back and
 * .back_accum; peel.K.primitive, front layers first. */
#include "ref/pipeline/methods/methods.h"

#include "ref/pipeline/methods/minmax.h"

typedef struct ForwardDual {
    MinMax minmax;
    Image previous_front, front, back; /* in the accumulation's format */
} ForwardDual;

/* ---- geometry pass ---- */

/* The front colour with one more layer under it. */
static void add_front(const float front[4], const float source[4], float out[4])
{
    float transmittance = op_sub(1.0f, front[3]);
    for (int i = 0; i < 3; i++)
        out[i] = op_add(front[i], op_mul(source[i], transmittance));
    out[3] = op_sub(1.0f, op_mul(transmittance, op_sub(1.0f, source[3])));
}

/* The premultiplied colour; false where the alpha test leaves nothing. */
static bool shade(const StageVisit *visit, const Setup *setup, int x, int y, float source[4])
{
    const Pass *pass = visit->stage->pass;
    ShadeForm form = pass_shade_form(pass, true);
    Texel texel;
    fragment_surface(pass, setup, visit->primitive, x, y, &texel);
    if (!stage_shade(visit->stage, stage_pixel(pass, x, y), visit->primitive->id, &form, &texel,
                     source))
        return false;
    if (format_info(pass->desc->accum)->kind == KIND_UNORM)
        for (int i = 0; i < 4; i++)
            source[i] = op_saturate(source[i]);
    return true;
}

static void visit_fragment(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    Stage *stage = visit->stage;
    const ForwardDual *dual = stage->method;
    MinMaxFragment fragment;
    if (!minmax_visible(visit, setup, x, y, &fragment))
        return;
    PixelFormat format = dual->front.format;
    float front[4], back[4] = {0}, source[4];
    format_fetch(format, minmax_pixel(&dual->previous_front, fragment.pixel), front);
    if ((fragment.side == MINMAX_FRONT || fragment.side == MINMAX_BACK) &&
        shade(visit, setup, x, y, source)) {
        minmax_count_shaded(stage, x, y);
        if (fragment.side == MINMAX_FRONT)
            add_front(front, source, front);
        else
            memcpy(back, source, sizeof back);
    }
    blend_max(format, front, minmax_pixel(&dual->front, fragment.pixel));
    blend_max(format, back, minmax_pixel(&dual->back, fragment.pixel));
}

static void geometry_tile(Stage *stage, uint32_t tile)
{
    StageVisit visit = {.stage = stage, .list = &stage->pass->geometry.transparent};
    stage_draw(&stage->pass->transparent_bins, tile, visit_fragment, &visit);
}

static void clear_targets(Stage *stage)
{
    ForwardDual *dual = stage->method;
    image_swap(&dual->front, &dual->previous_front);
    minmax_clear_zero(&dual->front);
    minmax_clear_zero(&dual->back);
}

/* ---- blending ---- */

static void blend_tile(Stage *stage, uint32_t tile)
{
    ForwardDual *dual = stage->method;
    PixelFormat format = dual->back.format;
    PixelRect rect = pass_tile_rect(stage->pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            size_t pixel = stage_pixel(stage->pass, x, y);
            float source[4];
            format_fetch(format, minmax_pixel(&dual->back, pixel), source);
            stage_blend(stage, blend_over, "over", "back",
                        *(uint32_t *)minmax_pixel(&dual->minmax.back_id, pixel), source,
                        &dual->minmax.back, pixel);
        }
}

static Result blend_back(Stage *stage)
{
    ForwardDual *dual = stage->method;
    Result result = minmax_put(stage, "front", &dual->front);
    if (result == RESULT_OK)
        result = minmax_put(stage, "back", &dual->back);
    if (result == RESULT_OK)
        result = stage_run(stage, blend_tile);
    return result == RESULT_OK ? minmax_put(stage, "back_accum", &dual->minmax.back) : result;
}

static float front_transmittance(const Stage *stage, size_t pixel)
{
    const ForwardDual *dual = stage->method;
    float front[4];
    format_fetch(dual->front.format, minmax_pixel(&dual->front, pixel), front);
    return 1.0f - front[3];
}

static void compose_tile(Stage *stage, uint32_t tile)
{
    const ForwardDual *dual = stage->method;
    PixelRect rect = pass_tile_rect(stage->pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            size_t pixel = stage_pixel(stage->pass, x, y);
            float front[4];
            format_fetch(dual->front.format, minmax_pixel(&dual->front, pixel), front);
            stage_blend(stage, blend_under, "under", "accum", PRIMITIVE_NONE, front, &stage->accum,
                        pixel);
        }
}

/* ---- the frame ---- */

static const MinMaxMethod method = {clear_targets, geometry_tile, blend_back, front_transmittance};

static Result allocate(const Pass *pass, ForwardDual *dual)
{
    int width = pass->view.width, height = pass->view.height;
    PixelFormat format = pass->desc->accum;
    Result result = minmax_create(pass, &method, &dual->minmax);
    if (result == RESULT_OK)
        result = image_create(width, height, format, &dual->previous_front);
    if (result == RESULT_OK)
        result = image_create(width, height, format, &dual->front);
    return result == RESULT_OK ? image_create(width, height, format, &dual->back) : result;
}

Result forward_dual_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    ForwardDual dual = {0};
    Stage stage;
    uint64_t colors = (uint64_t)pass->view.width * (uint64_t)pass->view.height * 3 *
                      format_pixel_bytes(pass->desc->accum);
    Result result = stage_create(pass, trace, frame, &dual, minmax_bytes(pass) + colors, &stage);
    if (result != RESULT_OK)
        return result;
    result = allocate(pass, &dual);
    if (result == RESULT_OK)
        result = stage_opaque(&stage);
    if (result == RESULT_OK)
        result = minmax_peels(&stage);
    if (result == RESULT_OK)
        result = stage_run(&stage, compose_tile);
    if (result == RESULT_OK)
        result = minmax_compose(&stage);
    if (result == RESULT_OK)
        result = stage_finish(&stage);
    minmax_free(&dual.minmax);
    image_free(&dual.previous_front);
    image_free(&dual.front);
    image_free(&dual.back);
    stage_free(&stage);
    return result;
}

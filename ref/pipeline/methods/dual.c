/* Deferred dual depth peeling, the definition path.
 *
 * This work is based on: Louis Bavoil, Kevin Myers, "Order Independent Transparency with Dual Depth
 * Peeling", NVIDIA, 2008, inside the pipeline of: Luigi Rapetta, "OpenGL 4.6 Deferred Renderer with
 * Deferred Depth Peeling", whose report names it as a possible improvement.
 *
 * A peel's geometry pass draws seven targets: the min-max depths with MAX (minmax.h), and for the
 * nearest and the farthest fragment three colours each, which must replace and not be mixed:
 *   normal    octahedral normal in two channels, opacity, mask
 *   diffuse   base colour, mask
 *   material  roughness, metallic, occlusion, mask
 * all RGBA32F with --gbuffer full, else RGBA16, RGBA8 and RGBA8. A fragment writes all of them, its
 * own with mask 1 and the others with 0: with LEQUAL the mask is the source's alpha and the last
 * fragment of a depth replaces the others (blend_replace), with LESS it is the target's and the
 * first stays (blend_keep). Whatever desc->position says, the position follows from the distance in
 * the min-max buffer of the pass before.
 *
 * The front layer is lit and blended under the accumulation, the back layer lit and blended over
 * the back accumulation, which at the end goes under the front's with 1 − its T as alpha; then the
 * opaque surfaces, lit as ever.
 *
 * Trace: dual.first.depth (step 0), and of peel K dual.K.depth, .front_normal, .front_diffuse,
 * .front_material, .back_normal, .back_diffuse, .back_material and .back_accum; peel.K.accum, the
 * accumulation of the fronts; peel.K.primitive, front layers first. */
#include "ref/pipeline/methods/methods.h"

#include "ref/pipeline/methods/minmax.h"

enum {
    TARGET_NORMAL,
    TARGET_DIFFUSE,
    TARGET_MATERIAL,
    TARGETS
};

typedef struct Dual {
    MinMax minmax;
    Image front[TARGETS], back[TARGETS];
} Dual;

static PixelFormat target_format(const RenderDesc *desc, int target)
{
    return render_desc_dual_format(desc, target == TARGET_NORMAL);
}

/* ---- geometry pass ---- */

/* What a fragment writes to the targets of its side. A mask of 0 leaves the other side's as they
 * are, because they hold no -0: nothing is drawn there. */
static void write_targets(const StageVisit *visit, const Setup *setup, int x, int y, size_t pixel,
                          const Image targets[TARGETS])
{
    const Pass *pass = visit->stage->pass;
    Texel texel;
    float normal[2];
    fragment_surface(pass, setup, visit->primitive, x, y, &texel);
    encode_octahedral(texel.normal, normal);
    const float *base = texel.diffuse, *material = texel.material;
    const float source[TARGETS][4] = {
        [TARGET_NORMAL] = {normal[0], normal[1], base[3], 1.0f},
        [TARGET_DIFFUSE] = {base[0], base[1], base[2], 1.0f},
        [TARGET_MATERIAL] = {material[0], material[1], material[2], 1.0f},
    };
    for (int i = 0; i < TARGETS; i++)
        (pass->desc->depth_func == DEPTH_LEQUAL ? blend_replace : blend_keep)(
            targets[i].format, source[i], minmax_pixel(&targets[i], pixel));
}

static void visit_fragment(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    const Dual *dual = visit->stage->method;
    MinMaxFragment fragment;
    if (!minmax_visible(visit, setup, x, y, &fragment))
        return;
    if (fragment.side == MINMAX_FRONT)
        write_targets(visit, setup, x, y, fragment.pixel, dual->front);
    else if (fragment.side == MINMAX_BACK)
        write_targets(visit, setup, x, y, fragment.pixel, dual->back);
}

static void geometry_tile(Stage *stage, uint32_t tile)
{
    StageVisit visit = {.stage = stage, .list = &stage->pass->geometry.transparent};
    stage_draw(&stage->pass->transparent_bins, tile, visit_fragment, &visit);
}

static void clear_targets(Stage *stage)
{
    Dual *dual = stage->method;
    for (int i = 0; i < TARGETS; i++) {
        minmax_clear_zero(&dual->front[i]);
        minmax_clear_zero(&dual->back[i]);
    }
}

/* ---- lighting ---- */

static bool light_pixel(Stage *stage, const Image targets[TARGETS], float distance,
                        uint32_t primitive, int x, int y, float color[4])
{
    const Pass *pass = stage->pass;
    ShadeForm form = pass_shade_form(pass, true);
    size_t pixel = stage_pixel(pass, x, y);
    float fetched[TARGETS][4];
    Texel texel;
    for (int i = 0; i < TARGETS; i++)
        format_fetch(targets[i].format, minmax_pixel(&targets[i], pixel), fetched[i]);
    decode_octahedral(fetched[TARGET_NORMAL], texel.normal);
    decode_position(&pass->view.unprojection, minmax_depth(pass, distance), x, y, texel.position);
    for (int i = 0; i < 3; i++) {
        texel.diffuse[i] = fetched[TARGET_DIFFUSE][i];
        texel.material[i] = fetched[TARGET_MATERIAL][i];
    }
    texel.diffuse[3] = fetched[TARGET_NORMAL][2];
    if (!stage_shade(stage, pixel, primitive, &form, &texel, color))
        return false;
    minmax_count_shaded(stage, x, y);
    return true;
}

static void light_tile(Stage *stage, uint32_t tile)
{
    const Dual *dual = stage->method;
    PixelRect rect = pass_tile_rect(stage->pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            size_t pixel = stage_pixel(stage->pass, x, y);
            const float *limits = minmax_pixel(&dual->minmax.previous, pixel);
            uint32_t front = *(uint32_t *)minmax_pixel(&dual->minmax.front_id, pixel);
            uint32_t back = *(uint32_t *)minmax_pixel(&dual->minmax.back_id, pixel);
            float color[4];
            if (light_pixel(stage, dual->front, op_neg(limits[0]), front, x, y, color))
                stage_blend(stage, blend_under, "under", "accum", front, color, &stage->accum,
                            pixel);
            if (light_pixel(stage, dual->back, limits[1], back, x, y, color))
                stage_blend(stage, blend_over, "over", "back", back, color, &dual->minmax.back,
                            pixel);
        }
}

static Result light_layers(Stage *stage)
{
    static const char *const names[2][TARGETS] = {
        {"front_normal", "front_diffuse", "front_material"},
        {"back_normal", "back_diffuse", "back_material"}};
    Dual *dual = stage->method;
    Result result = RESULT_OK;
    for (int i = 0; i < TARGETS && result == RESULT_OK; i++) {
        result = minmax_put(stage, names[0][i], &dual->front[i]);
        if (result == RESULT_OK)
            result = minmax_put(stage, names[1][i], &dual->back[i]);
    }
    if (result == RESULT_OK)
        result = stage_run(stage, light_tile);
    if (result == RESULT_OK)
        result = stage_put(stage, dual->minmax.peel, "accum", &stage->accum);
    return result == RESULT_OK ? minmax_put(stage, "back_accum", &dual->minmax.back) : result;
}

static float front_transmittance(const Stage *stage, size_t pixel)
{
    float accum[4];
    format_fetch(stage->accum.format, minmax_pixel(&stage->accum, pixel), accum);
    return accum[3];
}

/* ---- the frame ---- */

static const MinMaxMethod method = {clear_targets, geometry_tile, light_layers,
                                    front_transmittance};

static Result allocate(const Pass *pass, Dual *dual)
{
    int width = pass->view.width, height = pass->view.height;
    Result result = minmax_create(pass, &method, &dual->minmax);
    for (int i = 0; i < TARGETS && result == RESULT_OK; i++) {
        PixelFormat format = target_format(pass->desc, i);
        result = image_create(width, height, format, &dual->front[i]);
        if (result == RESULT_OK)
            result = image_create(width, height, format, &dual->back[i]);
    }
    return result;
}

static void release(Dual *dual)
{
    minmax_free(&dual->minmax);
    for (int i = 0; i < TARGETS; i++) {
        image_free(&dual->front[i]);
        image_free(&dual->back[i]);
    }
}

Result dual_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    Dual dual = {0};
    Stage stage;
    uint64_t colors = 0, pixels = (uint64_t)pass->view.width * (uint64_t)pass->view.height;
    for (int i = 0; i < TARGETS; i++)
        colors += 2 * pixels * format_pixel_bytes(target_format(pass->desc, i));
    Result result = stage_create(pass, trace, frame, &dual, minmax_bytes(pass) + colors, &stage);
    if (result != RESULT_OK)
        return result;
    result = allocate(pass, &dual);
    if (result == RESULT_OK)
        result = stage_opaque(&stage);
    if (result == RESULT_OK)
        result = minmax_peels(&stage);
    if (result == RESULT_OK)
        result = minmax_compose(&stage);
    if (result == RESULT_OK)
        result = stage_finish(&stage);
    release(&dual);
    stage_free(&stage);
    return result;
}

/* peel.h: rendering. */
#include "frame/frame.h"
#include "frame/method.h"
#include "library/convert.h"
#include "library/peel_scene.h"
#include "number/op.h"
#include "ref/pipeline/pipeline.h"
#include "ref/truth/truth.h"

#include <string.h>

_Static_assert((int)PEEL_GBUFFER_SEED == GBUFFER_SEED &&
                   (int)PEEL_GBUFFER_COMPACT == GBUFFER_COMPACT,
               "one numbering");
_Static_assert((int)PEEL_DEPTH_ZERO_ONE == DEPTH_RANGE_ZERO_ONE &&
                   (int)PEEL_DEPTH_REVERSED == DEPTH_RANGE_REVERSED,
               "one numbering");
_Static_assert((int)PEEL_CULL_OPAQUE == CULL_SEED && (int)PEEL_CULL_NONE == CULL_NONE,
               "one numbering");
_Static_assert((int)PEEL_SIMD_SCALAR == SIMD_SCALAR && (int)PEEL_SIMD_AVX512 == SIMD_AVX512,
               "one numbering");

const char *peel_method_name(size_t i, const char **what)
{
    if (i >= METHOD_COUNT)
        return NULL;
    const MethodInfo *method = method_info((MethodId)i);
    if (what)
        *what = method->summary;
    return method->name;
}

/* ---- settings ---- */

static Result find_method(const PeelSettings *settings, RenderDesc *desc)
{
    const MethodInfo *method = method_find(settings->method ? settings->method : "peel");
    if (!method)
        return result_fail(RESULT_BAD_INPUT,
                           "method \"%s\": expected one that peel_method_name gives",
                           settings->method);
    desc->method = method->id;
    return RESULT_OK;
}

static Result find_weight(const PeelSettings *settings, RenderDesc *desc)
{
    static const int equations[] = {
        [WEIGHT_9] = 9, [WEIGHT_7] = 7, [WEIGHT_8] = 8, [WEIGHT_10] = 10};
    for (int i = 0; i <= WEIGHT_10; i++)
        if (settings->weight_equation == equations[i]) {
            desc->weight = (WeightEquation)i;
            return RESULT_OK;
        }
    if (settings->weight_equation == 0)
        return RESULT_OK;
    return result_fail(RESULT_BAD_INPUT, "weight equation %d: expected 7, 8, 9 or 10",
                       settings->weight_equation);
}

/* What else is out of range, render_desc_check says. */
static Result make_desc(const PeelSettings *settings, RenderDesc *out)
{
    *out = (RenderDesc){
        .width = settings->width,
        .height = settings->height,
        .camera = settings->camera,
        .lights = settings->lights,
        .passes = settings->passes,
        .depth = convert_format(settings->depth),
        .accum = convert_format(settings->accum),
        .gbuffer = (GBufferFormat)settings->gbuffer,
        .position = settings->reconstruct_position ? POSITION_RECONSTRUCT : POSITION_BUFFER,
        .depth_range = (DepthRange)settings->depth_range,
        .depth_func = settings->less_or_equal ? DEPTH_LEQUAL : DEPTH_LESS,
        .peel_test = settings->raw_test ? PEEL_TEST_RAW : PEEL_TEST_STORED,
        .cull = (CullMode)settings->cull,
        .normals = settings->normals_kept ? NORMALS_KEPT : NORMALS_FACED,
        .ggx = settings->stable_highlight ? GGX_STABLE : GGX_SOURCE,
        .back_light = settings->back_light,
        .bias = settings->bias,
        .shading = settings->phong ? SHADING_PHONG : SHADING_GGX,
        .sort = settings->sort_triangles ? SORT_TRIANGLES : SORT_OBJECTS,
        .nodes_per_pixel = settings->nodes_per_pixel,
        .post = settings->edges ? POST_EDGES : POST_NONE,
        .unfused = settings->unfused,
        .ref_path = settings->definition_path ? REF_PATH_DEFINITION : REF_PATH_AUTO,
        .simd = (SimdChoice)settings->simd,
        .tile = settings->tile,
        .threads = settings->threads,
        .max_memory = settings->max_memory,
    };
    Result result = find_method(settings, out);
    return result == RESULT_OK ? find_weight(settings, out) : result;
}

/* ---- buffers ---- */

/* Hands buffers on to the caller, and keeps the accumulation where it is wanted. */
typedef struct Tap {
    TraceSink sink;
    const PeelTrace *trace; /* may be NULL */
    Image *accum;           /* may be NULL; empty until it came */
    bool stopped;
} Tap;

static Result keep_accum(Image *accum, const TraceBuffer *buffer)
{
    size_t row_bytes = (size_t)buffer->width * format_pixel_bytes(buffer->format);
    Result result = RESULT_OK;
    if (!accum->pixels)
        result = image_create(buffer->image_width, buffer->image_height, buffer->format, accum);
    for (int row = 0; result == RESULT_OK && row < buffer->height; row++)
        memcpy(image_pixel(accum, buffer->x, buffer->y + row),
               (const char *)buffer->pixels + (size_t)row * buffer->row_bytes, row_bytes);
    return result;
}

static Result tap_put(TraceSink *sink, const TraceBuffer *buffer)
{
    Tap *tap = (Tap *)sink;
    const PeelBuffer given = {
        .name = buffer->name,
        .step = buffer->step,
        .format = convert_from_format(buffer->format),
        .image_width = buffer->image_width,
        .image_height = buffer->image_height,
        .x = buffer->x,
        .y = buffer->y,
        .width = buffer->width,
        .height = buffer->height,
        .pixels = buffer->pixels,
        .row_bytes = buffer->row_bytes,
    };
    if (tap->accum && strcmp(buffer->name, "accum") == 0) {
        Result result = keep_accum(tap->accum, buffer);
        if (result != RESULT_OK)
            return result;
    }
    if (!tap->trace || tap->trace->put(tap->trace->context, &given) == 0)
        return RESULT_OK;
    tap->stopped = true;
    return result_fail(RESULT_BAD_INPUT, "stopped by the caller at %s", buffer->name);
}

/* ---- results ---- */

static void fill_figures(const Frame *frame, PeelFigures *out)
{
    const LayerStats *layers = &frame->layers;
    *out = (PeelFigures){
        .passes = frame->peels,
        .geometry_passes = frame->geometry_passes,
        .fragments = layers->fragments,
        .max_layers = layers->max,
        .fragments_shaded = frame->fragments_shaded,
        .lost_to_ties = layers->lost_to_ties,
        .lost_to_pass_limit = layers->lost_to_pass_limit,
        .lost_to_overflow = layers->lost_to_overflow,
        .repeated = layers->repeated,
        .overflowed = layers->overflowed,
        .residual_max = frame->residual_max,
        .residual_pixels = frame->residual_pixels,
        .ties = layers->ties,
        .coverage_differs = layers->coverage_differs,
        .buffer_bytes = frame->buffer_bytes,
        .time_ms = frame->time_ms,
        .cpu_ms = frame->cpu_ms,
        .threads = frame->threads,
    };
}

static void copy_image(const Image *image, void *out)
{
    if (out && image->pixels)
        memcpy(out, image->pixels,
               (size_t)image->width * (size_t)image->height * format_pixel_bytes(image->format));
}

/* Apart from peel_scene_render, so that its arithmetic stays within the environment set there. */
static __attribute__((noinline)) PeelResult render(const PeelScene *scene, const RenderDesc *desc,
                                                   const PeelTrace *trace, Renderer renderer,
                                                   const PeelImages *images, PeelFigures *figures)
{
    Frame frame;
    Image accum = {0};
    Tap tap = {.sink = {.put = tap_put}, .trace = trace, .accum = images->accum ? &accum : NULL};
    TraceSink *sink = trace || images->accum ? &tap.sink : NULL;
    Result result = renderer(&scene->scene, desc, sink, &frame);
    if (result == RESULT_OK) {
        copy_image(&frame.final, images->linear);
        copy_image(&frame.display, images->display);
        copy_image(&frame.bound, images->bound);
        copy_image(&accum, images->accum);
        if (figures)
            fill_figures(&frame, figures);
    }
    frame_free(&frame);
    image_free(&accum);
    return tap.stopped ? PEEL_STOPPED : convert_result(result);
}

static Result check_wishes(const PeelSettings *settings, const PeelTrace *trace,
                           const PeelImages *images)
{
    if (settings->renderer != PEEL_REF && settings->renderer != PEEL_TRUTH)
        return result_fail(RESULT_BAD_INPUT, "renderer %d: expected PEEL_REF or PEEL_TRUTH",
                           (int)settings->renderer);
    if (images->accum && settings->renderer != PEEL_REF)
        return result_fail(RESULT_BAD_INPUT, "images.accum: expected NULL of PEEL_TRUTH, which "
                                             "stores no accumulation");
    if (images->bound && settings->renderer != PEEL_TRUTH)
        return result_fail(RESULT_BAD_INPUT,
                           "images.bound: expected NULL of PEEL_REF, whose errors PEEL_TRUTH "
                           "bounds");
    if (trace && !trace->put)
        return result_fail(RESULT_BAD_INPUT, "trace.put is NULL, expected a function");
    return RESULT_OK;
}

PeelResult peel_scene_render(const PeelScene *scene, const PeelSettings *settings,
                             const PeelTrace *trace, const PeelImages *images, PeelFigures *figures)
{
    if (!scene || !settings || !images)
        return convert_missing("peel_scene_render", !scene      ? "scene"
                                                    : !settings ? "settings"
                                                                : "images");
    RenderDesc desc;
    Result result = check_wishes(settings, trace, images);
    if (result == RESULT_OK)
        result = make_desc(settings, &desc);
    if (result != RESULT_OK)
        return convert_result(result);
    desc.bound = images->bound != NULL;
    Renderer renderer = settings->renderer == PEEL_REF ? pipeline_render : truth_render;
    uint32_t environment = op_suspend();
    PeelResult rendered = render(scene, &desc, trace, renderer, images, figures);
    op_leave(environment);
    return rendered;
}

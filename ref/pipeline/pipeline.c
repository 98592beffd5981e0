#include "ref/pipeline/pipeline.h"

#include "base/clock.h"
#include "frame/method.h"
#include "frame/mutation.h"
#include "ref/pipeline/methods/methods.h"
#include "ref/pipeline/mutate.h"
#include "ref/pipeline/stage.h"
#include "ref/pipeline/tile.h"

#include <stdio.h>

/* One row per method: see frame/method.h. tile is NULL where there is only the definition. */
static const struct {
    Result (*definition)(Pass *pass, TraceSink *trace, Frame *frame);
    Result (*tile)(Pass *pass, Frame *frame);
} methods[METHOD_COUNT] = {
    [METHOD_DUAL] = {dual_render, NULL},
    [METHOD_FORWARD_DUAL] = {forward_dual_render, NULL},
    [METHOD_PEEL] = {peel_render, tile_render},
    [METHOD_PEEL_ID] = {peel_id_render, NULL},
    [METHOD_LINKED_LIST] = {linked_list_render, NULL},
    [METHOD_FORWARD] = {forward_render, NULL},
    [METHOD_WEIGHTED_AVERAGE] = {weighted_average_render, NULL},
    [METHOD_WEIGHTED_SUM] = {weighted_sum_render, NULL},
    [METHOD_WEIGHTED_BLENDED] = {weighted_blended_render, NULL},
    [METHOD_PAINTER] = {painter_render, NULL},
};

Result pipeline_definition(Pass *pass, TraceSink *trace, Frame *out)
{
    const RenderDesc *desc = pass->desc;
    *out = (Frame){.fused = pass->fused};
    Result result = image_create(desc->width, desc->height, FORMAT_RGBA32F, &out->final);
    if (result == RESULT_OK)
        result = image_create(desc->width, desc->height, FORMAT_RGBA8, &out->display);
    return result == RESULT_OK ? methods[desc->method].definition(pass, trace, out) : result;
}

static Result render(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    Pass pass;
    Result result = pass_create(scene, desc, trace != NULL, &pass);
    if (result != RESULT_OK)
        return result;
    bool opaque_only = !needs_has(&pass.needs, NEED_TRANSPARENT);
    bool definition = trace || desc->ref_path == REF_PATH_DEFINITION ||
                      !methods[desc->method].tile || pass.geometry.wide ||
                      (desc->mutations & ~MUTATE_VIEW);
    out->threads = pool_threads(pass.pool);
    out->fused = pass.fused;
    snprintf(out->version, sizeof out->version, "Peel %s", PEEL_VERSION);
    snprintf(out->renderer, sizeof out->renderer, "ref (%s path)",
             definition ? "definition" : "tile");
    result = image_create(desc->width, desc->height, FORMAT_RGBA32F, &out->final);
    if (result == RESULT_OK)
        result = image_create(desc->width, desc->height, FORMAT_RGBA8, &out->display);
    if (result == RESULT_OK)
        result = !definition   ? methods[desc->method].tile(&pass, out)
                 : opaque_only ? stage_opaque_only(&pass, out)
                               : methods[desc->method].definition(&pass, trace, out);
    out->buffer_bytes = pass.bytes;
    pass_free(&pass);
    return result;
}

/* Mistakes as settings where they are settings. */
static Result apply_mutations(const RenderDesc *desc, RenderDesc *out)
{
    mutation_apply(desc, out);
    if (desc->mutations == 0)
        return RESULT_OK;
    if (desc->mutations >> MUTATION_COUNT)
        return result_fail(RESULT_BAD_INPUT, "mutations %#llx: expected bits below %d",
                           (unsigned long long)desc->mutations, (int)MUTATION_COUNT);
    if (desc->method != METHOD_PEEL && desc->method != METHOD_FORWARD)
        return result_fail(RESULT_BAD_INPUT,
                           "mutations of method %s: expected method peel or forward",
                           method_info(desc->method)->name);
    return RESULT_OK;
}

Result pipeline_render(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    *out = (Frame){0};
    Clock start = clock_now();
    RenderDesc applied;
    Result result = apply_mutations(desc, &applied);
    if (result == RESULT_OK)
        result = render(scene, &applied, trace, out);
    if (result != RESULT_OK) {
        frame_free(out);
        return result;
    }
    clock_elapsed(&start, &out->time_ms, &out->cpu_ms);
    return RESULT_OK;
}

#include "gl_renderer.h"

#include "base/clock.h"
#include "fuses.h"
#include "methods/methods.h"
#include "number/op.h"
#include "readback.h"

#include <stdio.h>

static Result read_result(Passes *passes, Frame *out)
{
    const Targets *targets = &passes->targets;
    Result result = image_create(targets->width, targets->height, FORMAT_RGBA32F, &out->final);
    if (result == RESULT_OK)
        result = image_create(targets->width, targets->height, FORMAT_RGBA8, &out->display);
    if (result != RESULT_OK)
        return result;
    readback_color(targets, targets->resolve_buffer, 0, FORMAT_RGBA32F, READBACK_TOP_DOWN,
                   out->final.pixels);
    readback_color(targets, targets->resolve_buffer, 1, FORMAT_RGBA8, READBACK_TOP_DOWN,
                   out->display.pixels);
    result = context_check(passes->context, "frame");
    if (result != RESULT_OK)
        return result;
    return trace_put(passes->trace, "display", out->peels + 2, FORMAT_RGBA8, targets->width,
                     targets->height, out->display.pixels);
}

static void describe_driver(Frame *out)
{
    snprintf(out->version, sizeof out->version, "%s", (const char *)gl.GetString(GL_VERSION));
    snprintf(out->renderer, sizeof out->renderer, "%s", (const char *)gl.GetString(GL_RENDERER));
    out->threads = context_threads();
}

/* One row per method: see frame/method.h. */
static Result (*const methods[METHOD_COUNT])(Passes *passes, Frame *out) = {
    [METHOD_DUAL] = gl_dual,
    [METHOD_FORWARD_DUAL] = gl_forward_dual,
    [METHOD_PEEL] = gl_peel,
    [METHOD_PEEL_ID] = gl_peel_id,
    [METHOD_LINKED_LIST] = gl_linked_list,
    [METHOD_FORWARD] = gl_forward,
    [METHOD_WEIGHTED_AVERAGE] = gl_weighted_average,
    [METHOD_WEIGHTED_SUM] = gl_weighted_sum,
    [METHOD_WEIGHTED_BLENDED] = gl_weighted_blended,
    [METHOD_PAINTER] = gl_painter,
};

/* Not inlined: see op_enter. */
static __attribute__((noinline)) Result render_in(Context *context, const Scene *scene,
                                                  const RenderDesc *desc, const View *view,
                                                  TraceSink *trace, Frame *out)
{
    describe_driver(out);
    FusesMode mode;
    Result result = fuses_detect(context, &mode);
    if (result != RESULT_OK)
        return result;
    if (mode == FUSES_UNKNOWN)
        result_warn("%s does not interpolate as llvmpipe does: its bits will differ from ref's",
                    out->renderer);
    out->fused = mode == FUSES_YES;
    Clock start = clock_now();
    Passes passes;
    result = passes_create(context, scene, desc, view, trace, &passes);
    if (result != RESULT_OK)
        return result;
    result = needs_has(&passes.needs, NEED_TRANSPARENT) ? methods[desc->method](&passes, out)
                                                        : passes_opaque_only(&passes, out);
    if (result == RESULT_OK) {
        passes_resolve(&passes);
        result = read_result(&passes, out);
    }
    out->buffer_bytes =
        passes.targets.bytes + passes.meshes.bytes + passes.lights.bytes + passes.textures.bytes;
    passes_destroy(&passes);
    clock_elapsed(&start, &out->time_ms, &out->cpu_ms);
    return result;
}

Result gl_render(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    *out = (Frame){0};
    View view;
    Result result = view_build(scene, desc, &view);
    if (result != RESULT_OK)
        return result;
    Context *context;
    result = context_open(desc->threads, &context);
    if (result == RESULT_OK) {
        /* Triangles of a batch that needed clipping are set up in the calling thread, where Mesa
         * does not itself flush denormals as its own threads do. */
        uint32_t saved = op_enter();
        result = render_in(context, scene, desc, &view, trace, out);
        op_leave(saved);
        context_close(context);
    }
    view_free(&view);
    if (result != RESULT_OK)
        frame_free(out);
    return result;
}

Result gl_driver_fuses(int threads, bool *fused)
{
    Context *context;
    Result result = context_open(threads, &context);
    if (result != RESULT_OK)
        return result;
    FusesMode mode;
    result = fuses_detect(context, &mode);
    context_close(context);
    if (result == RESULT_OK && mode == FUSES_UNKNOWN)
        result = result_fail(RESULT_NO_GL, "OpenGL: depths interpolated with or without fused "
                                           "multiply-add expected, the driver follows neither");
    *fused = result == RESULT_OK && mode == FUSES_YES;
    return result;
}

#include "gl_renderer.h"

#include "fuses.h"
#include "methods/peel.h"
#include "readback.h"

#include <stdio.h>
#include <time.h>

static double clock_ms(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static Result read_result(Passes *passes, TraceSink *trace, Frame *out)
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
    return trace_put(trace, "display", out->peels + 2, FORMAT_RGBA8, targets->width,
                     targets->height, out->display.pixels);
}

static void describe_driver(Frame *out)
{
    snprintf(out->version, sizeof out->version, "%s", (const char *)gl.GetString(GL_VERSION));
    snprintf(out->renderer, sizeof out->renderer, "%s", (const char *)gl.GetString(GL_RENDERER));
    out->threads = context_threads();
}

static Result render_in(Context *context, const Scene *scene, const RenderDesc *desc,
                        const View *view, TraceSink *trace, Frame *out)
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
    double wall_ms = clock_ms(CLOCK_MONOTONIC), cpu_ms = clock_ms(CLOCK_PROCESS_CPUTIME_ID);
    Passes passes;
    result = passes_create(context, scene, desc, view, &passes);
    if (result != RESULT_OK)
        return result;
    result = gl_peel(&passes, trace, out);
    if (result == RESULT_OK) {
        passes_resolve(&passes);
        result = read_result(&passes, trace, out);
    }
    out->buffer_bytes = passes.targets.bytes + passes.meshes.bytes + passes.lights.bytes;
    passes_destroy(&passes);
    out->time_ms = clock_ms(CLOCK_MONOTONIC) - wall_ms;
    out->cpu_ms = clock_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu_ms;
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
        result = render_in(context, scene, desc, &view, trace, out);
        context_close(context);
    }
    view_free(&view);
    if (result != RESULT_OK)
        frame_free(out);
    return result;
}

Result gl_driver_fuses(bool *fused)
{
    Context *context;
    Result result = context_open(0, &context);
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

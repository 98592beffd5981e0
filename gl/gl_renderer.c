#include "gl_renderer.h"

#include "base/clock.h"
#include "base/memory.h"
#include "fuses.h"
#include "methods/methods.h"
#include "number/op.h"
#include "readback.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    LLVMPIPE_STEPS = 65535 /* of a loop. Source: Mesa's lp_bld_limits.h */
};

struct GlSession {
    Context *context;
    RenderDesc desc;
    View view;
    Passes passes;
    const GlMethod *method;
    void *state; /* the method's */
    FusesMode fuses;
    Clock opened; /* when the upload began */
};

/* One row per method: see frame/method.h. */
static const GlMethod *const methods[METHOD_COUNT] = {
    [METHOD_DUAL] = &gl_dual,
    [METHOD_FORWARD_DUAL] = &gl_forward_dual,
    [METHOD_PEEL] = &gl_peel,
    [METHOD_PEEL_ID] = &gl_peel_id,
    [METHOD_LINKED_LIST] = &gl_linked_list,
    [METHOD_FORWARD] = &gl_forward,
    [METHOD_WEIGHTED_AVERAGE] = &gl_weighted_average,
    [METHOD_WEIGHTED_SUM] = &gl_weighted_sum,
    [METHOD_WEIGHTED_BLENDED] = &gl_weighted_blended,
    [METHOD_PAINTER] = &gl_painter,
};

/* What stands for the method where there is nothing transparent. */
static Result create_opaque(Passes *passes, void *into)
{
    *(Passes **)into = passes;
    return RESULT_OK;
}

static Result draw_opaque(void *of, Frame *out)
{
    return passes_opaque_only(*(Passes **)of, out);
}

static void destroy_opaque(void *of)
{
    (void)of;
}

static const GlMethod opaque_only = {sizeof(Passes *), create_opaque, draw_opaque, destroy_opaque};

/* Triangles of a batch that needed clipping are set up in the calling thread, where Mesa does not
 * itself flush denormals as its own threads do. So all of it runs in flushing mode; the functions
 * that do are not inlined: see op_enter. */
typedef Result (*Stage)(GlSession *session, Frame *out);

static Result run_flushing(Stage stage, GlSession *session, Frame *out)
{
    Result result = context_use(session->context);
    if (result != RESULT_OK)
        return result;
    uint32_t saved = op_enter();
    result = stage(session, out);
    op_leave(saved);
    return result;
}

/* ---- open and close ---- */

static __attribute__((noinline)) Result set_up(GlSession *session, Frame *unused)
{
    (void)unused;
    Result result = fuses_detect(session->context, &session->fuses);
    if (result != RESULT_OK)
        return result;
    if (session->fuses == FUSES_UNKNOWN)
        result_warn("%s does not interpolate as llvmpipe does: its bits will differ from ref's",
                    (const char *)gl.GetString(GL_RENDERER));
    else if (session->view.light_count > LLVMPIPE_STEPS)
        return result_fail(RESULT_UNSUPPORTED,
                           "gl: %zu lights, expected at most %d: llvmpipe ends every loop of a "
                           "shader there",
                           session->view.light_count, LLVMPIPE_STEPS);
    session->opened = clock_now();
    Passes in = session->passes;
    result = passes_create(&in, &session->passes);
    if (result != RESULT_OK)
        return result;
    bool opaque = needs_has(&session->passes.needs, NEED_OPAQUE);
    bool transparent = needs_has(&session->passes.needs, NEED_TRANSPARENT);
    if (!transparent && !(opaque && session->passes.options.every_pass))
        session->method = &opaque_only;
    session->state = memory_array(1, session->method->state_size);
    if (!session->state)
        return RESULT_NO_MEMORY;
    return session->method->create(&session->passes, session->state);
}

static Result open_session(const Scene *scene, const GlOptions *options, TraceSink *trace,
                           GlSession *out)
{
    Result result = view_build(scene, &out->desc, &out->view);
    if (result == RESULT_OK)
        result = context_open(out->desc.threads, &out->context);
    if (result != RESULT_OK)
        return result;
    out->method = methods[out->desc.method];
    out->passes = (Passes){.context = out->context,
                           .scene = scene,
                           .desc = &out->desc,
                           .view = &out->view,
                           .trace = trace,
                           .options = *options};
    out->passes.options.every_pass = options->every_pass && out->desc.passes > 0;
    return run_flushing(set_up, out, NULL);
}

Result gl_session_open(const Scene *scene, const RenderDesc *desc, const GlOptions *options,
                       TraceSink *trace, GlSession **out)
{
    static const GlOptions none = {0};
    *out = memory_array(1, sizeof **out);
    if (!*out)
        return RESULT_NO_MEMORY;
    (*out)->desc = *desc;
    Result result = open_session(scene, options ? options : &none, trace, *out);
    if (result != RESULT_OK) {
        gl_session_close(*out);
        *out = NULL;
    }
    return result;
}

void gl_session_close(GlSession *session)
{
    if (!session)
        return;
    if (session->context && context_use(session->context) == RESULT_OK && session->method) {
        if (session->state)
            session->method->destroy(session->state);
        passes_destroy(&session->passes);
    }
    context_close(session->context);
    free(session->state);
    view_free(&session->view);
    free(session);
}

/* ---- a frame ---- */

static void describe_driver(const GlSession *session, Frame *out)
{
    snprintf(out->version, sizeof out->version, "%s", (const char *)gl.GetString(GL_VERSION));
    snprintf(out->renderer, sizeof out->renderer, "%s", (const char *)gl.GetString(GL_RENDERER));
    out->threads = context_threads();
    out->fused = session->fuses == FUSES_YES;
}

static __attribute__((noinline)) Result draw(GlSession *session, Frame *out)
{
    Passes *passes = &session->passes;
    Clock start = clock_now();
    passes_begin(passes);
    Result result = session->method->draw(session->state, out);
    if (result != RESULT_OK)
        return result;
    passes_resolve(passes);
    result = context_check(session->context, "frame"); /* which finishes it */
    clock_elapsed(&start, &out->time_ms, &out->cpu_ms);
    out->buffer_bytes = passes->targets.bytes + passes->meshes.bytes + passes->lights.bytes +
                        passes->textures.bytes;
    describe_driver(session, out);
    return result;
}

static __attribute__((noinline)) Result read_images(GlSession *session, Frame *out)
{
    const Targets *targets = &session->passes.targets;
    Result result = image_create(targets->width, targets->height, FORMAT_RGBA32F, &out->final);
    if (result == RESULT_OK)
        result = image_create(targets->width, targets->height, FORMAT_RGBA8, &out->display);
    if (result != RESULT_OK)
        return result;
    readback_color(targets, targets->resolve_buffer, 0, FORMAT_RGBA32F, READBACK_TOP_DOWN,
                   out->final.pixels);
    readback_color(targets, targets->resolve_buffer, 1, FORMAT_RGBA8, READBACK_TOP_DOWN,
                   out->display.pixels);
    result = context_check(session->context, "read-back");
    if (result != RESULT_OK)
        return result;
    return trace_put(session->passes.trace, "display", out->peels + 2, FORMAT_RGBA8, targets->width,
                     targets->height, out->display.pixels);
}

Result gl_session_frame(GlSession *session, bool images, Frame *out)
{
    *out = (Frame){0};
    Result result = run_flushing(draw, session, out);
    if (result == RESULT_OK && images)
        result = run_flushing(read_images, session, out);
    if (result != RESULT_OK)
        frame_free(out);
    return result;
}

Result gl_render(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    *out = (Frame){0};
    GlSession *session;
    Result result = gl_session_open(scene, desc, NULL, trace, &session);
    if (result != RESULT_OK)
        return result;
    result = gl_session_frame(session, true, out);
    Clock opened = session->opened;
    gl_session_close(session);
    if (result == RESULT_OK)
        clock_elapsed(&opened, &out->time_ms, &out->cpu_ms);
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

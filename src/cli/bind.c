#include "cli/bind.h"

#include "gl/gl_renderer.h"
#include "ref/pipeline/pipeline.h"
#include "ref/truth/truth.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const Renderer bind_renderers[RENDERER_COUNT] = {
    [RENDERER_REF] = pipeline_render,
    [RENDERER_GL] = gl_render,
    [RENDERER_TRUTH] = truth_render,
};

int bind_find_renderer(const char *name)
{
    for (int i = 0; i < RENDERER_COUNT; i++)
        if (strcmp(threeway_renderer_name(i), name) == 0)
            return i;
    return -1;
}

/* ---- renderers of a benchmark ---------------------------------------------------------------- */

/* A renderer without anything to keep between frames. */
typedef struct Stateless {
    const Scene *scene;
    const RenderDesc *desc;
    Renderer renderer;
} Stateless;

static Result open_stateless(const Scene *scene, const RenderDesc *desc, Renderer renderer,
                             void **state)
{
    Stateless *stateless = malloc(sizeof *stateless);
    *state = stateless;
    if (!stateless)
        return result_fail(RESULT_NO_MEMORY, "out of memory");
    *stateless = (Stateless){scene, desc, renderer};
    return RESULT_OK;
}

static Result open_ref(const Scene *scene, const RenderDesc *desc, void **state)
{
    return open_stateless(scene, desc, bind_renderers[RENDERER_REF], state);
}

static Result open_truth(const Scene *scene, const RenderDesc *desc, void **state)
{
    return open_stateless(scene, desc, bind_renderers[RENDERER_TRUTH], state);
}

static Result frame_stateless(void *state, bool images, Frame *out)
{
    const Stateless *stateless = state;
    (void)images; /* it always makes them */
    return stateless->renderer(stateless->scene, stateless->desc, NULL, out);
}

static Result open_gl(const Scene *scene, const RenderDesc *desc, bool reject_early, void **state)
{
    const GlOptions options = {.every_pass = true, .reject_early = reject_early};
    GlSession *session;
    char threads[16];
    snprintf(threads, sizeof threads, "%d", desc->threads);
    setenv("LP_NUM_THREADS", threads, 1); /* read once, by the process's first context */
    Result result = gl_session_open(scene, desc, &options, NULL, &session);
    *state = session;
    return result;
}

static Result open_gl_plain(const Scene *scene, const RenderDesc *desc, void **state)
{
    return open_gl(scene, desc, false, state);
}

static Result open_gl_early(const Scene *scene, const RenderDesc *desc, void **state)
{
    return open_gl(scene, desc, true, state);
}

static Result frame_gl(void *state, bool images, Frame *out)
{
    return gl_session_frame(state, images, out);
}

static void close_gl(void *state)
{
    gl_session_close(state);
}

const BenchRenderer bind_bench[BENCH_RENDERERS] = {
    [BENCH_REF] = {open_ref, frame_stateless, free},
    [BENCH_GL] = {open_gl_plain, frame_gl, close_gl},
    [BENCH_GL_EARLY] = {open_gl_early, frame_gl, close_gl},
    [BENCH_TRUTH] = {open_truth, frame_stateless, free},
};

/* The painter: transparent objects or triangles sorted by their centroids and blended over each
 * other, far to near.
 *
 * This work is based on: M. Newell, R. Newell, T. Sancha, "A Solution to the Hidden Surface
 * Problem", ACM 1972, without its splitting. The order: frame/sort.h. */
#include "methods/methods.h"

#include "base/progress.h"
#include "frame/sort.h"
#include "program.h"

/* Uniforms are set where the draw changes: sorted triangles often come one by one. */
static void draw_runs(const Passes *passes, GLuint program, const Sort *sort)
{
    gl.UseProgram(program);
    for (size_t i = 0; i < sort->count; i++) {
        const SortRun *run = &sort->runs[i];
        const Draw *draw = &passes->view->draws[run->draw];
        if (i == 0 || run->draw != run[-1].draw)
            passes_use_draw(passes, program, draw);
        passes_draw_triangles(passes, draw, run->first, run->count);
    }
}

static Result paint(const Passes *passes, GLuint program, const Sort *sort, Frame *out)
{
    const Targets *targets = &passes->targets;
    uint64_t samples;
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, targets->plain_buffer);
    passes_bind_opaque_depth(passes);
    gl.Enable(GL_BLEND);
    passes_blend_over();
    passes_begin_count(passes, &samples);
    draw_runs(passes, program, sort);
    Result result = passes_end_count(passes, "painter", &samples);
    gl.Disable(GL_BLEND);
    progress_add();
    out->peels = samples > 0;
    out->geometry_passes = 1;
    return result;
}

typedef struct Painter {
    Passes *passes;
    GLuint program;
} Painter;

static Result create(Passes *passes, void *into)
{
    const PassesSource source = {
        .surface = true, .peel_test = true, .shade = true, .main = shader_painter_frag};
    const RenderDesc *desc = passes->desc;
    Painter *state = into;
    state->passes = passes;
    Result result = targets_reserve(&passes->targets,
                                    (size_t)sort_bytes(passes->scene, passes->view, desc->sort));
    if (result == RESULT_OK)
        result = passes_program(passes, "painter", desc->back_light ? "#define BACK_LIGHT\n" : "",
                                &source, &state->program);
    return result;
}

static Result draw(void *of, Frame *out)
{
    const Painter *state = of;
    Passes *passes = state->passes;
    Sort sort = {0};
    Result result = sort_far_to_near(passes->scene, passes->view, passes->desc->sort, &sort);
    if (result == RESULT_OK)
        result = passes_opaque(passes);
    if (result == RESULT_OK)
        result = paint(passes, state->program, &sort, out);
    if (result == RESULT_OK)
        result = passes_trace_accum(passes, "painter.layers", 1);
    if (result == RESULT_OK)
        result = passes_finish(passes, out->peels);
    sort_free(&sort);
    return result;
}

static void destroy(void *of)
{
    Painter *state = of;
    gl.DeleteProgram(state->program);
}

const GlMethod gl_painter = {sizeof(Painter), create, draw, destroy};

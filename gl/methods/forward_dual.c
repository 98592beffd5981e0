/* Dual depth peeling, shaded in the geometry pass.
 *
 * This work is based on: L. Bavoil, K. Myers, "Order Independent Transparency with Dual Depth
 * Peeling", NVIDIA, 2008. Min-max depths, front and back colour are three targets, all drawn with
 * MAX blending; the front colour is read from the peel before and passed on, the back colour is
 * blended over an accumulation of its own by a full-screen pass. Buffers and their meaning: those
 * of ref/pipeline/methods/forward_dual.c. */
#include "methods/methods.h"

#include "methods/limits.h"
#include "program.h"

#include <stdio.h>

typedef struct ForwardDual {
    Limits limits;
    GLuint peel, copy; /* programs */
    GLuint front[2], back;
    GLuint buffers[2]; /* framebuffers: limits, front and back of a peel; as limits_current */
} ForwardDual;

enum {
    UNIT_PREVIOUS_FRONT = 5
};

static const float zero[4] = {0.0f, 0.0f, 0.0f, 0.0f};

static Result build_program(const Passes *passes, GLuint *out)
{
    const PassesSource source = {.surface = true,
                                 .peel_test = true,
                                 .shade = true,
                                 .minmax = true,
                                 .main = shader_forward_dual_frag};
    bool unorm = format_info(passes->desc->accum)->kind == KIND_UNORM;
    char defines[64];
    snprintf(defines, sizeof defines, "%s%s", unorm ? "#define ACCUM_UNORM\n" : "",
             passes->desc->back_light ? "#define BACK_LIGHT\n" : "");
    return passes_program(passes, "forward dual peel", defines, &source, out);
}

static Result create(Passes *passes, void *into)
{
    ForwardDual *state = into;
    Targets *targets = &passes->targets;
    Result result = limits_create(passes, &state->limits);
    if (result == RESULT_OK)
        result = build_program(passes, &state->peel);
    if (result == RESULT_OK)
        result = limits_copy_program(passes, "", &state->copy);
    if (result == RESULT_OK)
        result = targets_texture(targets, targets->accum_format, &state->back);
    for (int i = 0; i < 2 && result == RESULT_OK; i++) {
        result = targets_texture(targets, targets->accum_format, &state->front[i]);
        const GLuint colors[3] = {state->limits.textures[i], state->front[i], state->back};
        if (result == RESULT_OK)
            result = targets_framebuffer(3, colors, 0, &state->buffers[i]);
    }
    return result;
}

static void destroy(void *of)
{
    ForwardDual *state = of;
    gl.DeleteProgram(state->peel);
    gl.DeleteProgram(state->copy);
    gl.DeleteFramebuffers(2, state->buffers);
    gl.DeleteTextures(2, state->front);
    gl.DeleteTextures(1, &state->back);
    limits_destroy(&state->limits);
}

static Result trace_peel(const ForwardDual *state, int peel)
{
    const Limits *limits = &state->limits;
    PixelFormat format = limits->passes->targets.accum_format;
    GLuint buffer = state->buffers[limits_current(peel)];
    Result result = limits_trace(limits, peel, "depth", buffer, 0, FORMAT_RG32F);
    if (result == RESULT_OK)
        result = limits_trace(limits, peel, "front", buffer, 1, format);
    if (result == RESULT_OK)
        result = limits_trace(limits, peel, "back", buffer, 2, format);
    if (result == RESULT_OK)
        result = limits_trace(limits, peel, "back_accum", limits->back_buffer, 0, format);
    return result;
}

static Result draw_peel(void *context, int peel)
{
    const ForwardDual *state = context;
    const Limits *limits = &state->limits;
    GLuint buffer = state->buffers[limits_current(peel)];
    gl.ClearNamedFramebufferfv(buffer, GL_COLOR, 1, zero);
    gl.ClearNamedFramebufferfv(buffer, GL_COLOR, 2, zero);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, buffer);
    limits_bind(limits, peel);
    gl.BindTextureUnit(UNIT_PREVIOUS_FRONT, state->front[limits_previous(peel)]);
    gl.Enable(GL_BLEND);
    gl.BlendEquation(GL_MAX);
    passes_draw_list(limits->passes, state->peel, true);
    gl.BlendEquation(GL_FUNC_ADD);
    passes_blend_over();
    gl.BindTextureUnit(0, state->back);
    passes_fullscreen(limits->passes, state->copy, limits->back_buffer);
    gl.Disable(GL_BLEND);
    Result result = context_check(limits->passes->context, "dual peel");
    return result == RESULT_OK ? trace_peel(state, peel) : result;
}

/* The front colour of the last peel, under the empty accumulation; then the back. */
static void compose(const ForwardDual *state, int peels)
{
    const Passes *passes = state->limits.passes;
    gl.BindTextureUnit(0, state->front[limits_previous(peels)]);
    passes_blend_under();
    gl.Enable(GL_BLEND);
    passes_fullscreen(passes, state->copy, passes->targets.plain_buffer);
    gl.Disable(GL_BLEND);
    limits_compose(&state->limits);
}

static Result draw(void *of, Frame *out)
{
    ForwardDual *state = of;
    Passes *passes = state->limits.passes;
    for (int i = 0; i < 2; i++)
        gl.ClearNamedFramebufferfv(state->buffers[i], GL_COLOR, 1, zero);
    Result result = passes_opaque(passes);
    if (result == RESULT_OK)
        result = limits_peels(&state->limits, out, draw_peel, state);
    if (result != RESULT_OK)
        return result;
    compose(state, out->peels);
    return passes_finish(passes, out->peels);
}

const GlMethod gl_forward_dual = {sizeof(ForwardDual), create, draw, destroy};

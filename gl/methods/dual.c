/* Deferred dual depth peeling.
 *
 * This work is based on: L. Bavoil, K. Myers, "Order Independent Transparency with Dual Depth
 * Peeling", NVIDIA, 2008, inside the pipeline of: L. Rapetta, "OpenGL 4.6 Deferred Renderer with
 * Deferred Depth Peeling". A peel's geometry pass draws seven targets: the min-max depths with MAX,
 * and two G-buffers that replace, with a mask in alpha. Each layer is then lit by a full-screen
 * pass; the front's is blended under the accumulation, the back's over one of its own. Buffers and
 * their meaning: those of ref/pipeline/methods/dual.c. */
#include "methods/methods.h"

#include "methods/limits.h"
#include "program.h"

#include <stdio.h>

enum {
    SIDE_FRONT,
    SIDE_BACK,
    SIDES
};
enum {
    TARGET_NORMAL,
    TARGET_DIFFUSE,
    TARGET_MATERIAL,
    TARGETS
};
#define ATTACHMENTS (1 + SIDES * TARGETS)

typedef struct Dual {
    Limits limits;
    GLuint peel, light[SIDES]; /* programs */
    GLuint color[SIDES][TARGETS];
    GLuint buffers[2]; /* framebuffers: limits and all colours; as limits_current */
} Dual;

static PixelFormat target_format(const RenderDesc *desc, int target)
{
    return render_desc_dual_format(desc, target == TARGET_NORMAL);
}

/* ---- objects ---- */

static Result build_programs(const Passes *passes, Dual *state)
{
    static const char *const light[SIDES] = {"#define LIGHT_FRONT\n", "#define LIGHT_BACK\n"};
    const PassesSource geometry = {.surface = true,
                                   .peel_test = true,
                                   .octahedral = true,
                                   .minmax = true,
                                   .main = shader_dual_frag};
    const PassesSource lighting = {.octahedral = true,
                                   .shade = true,
                                   .unproject = true,
                                   .minmax = true,
                                   .main = shader_dual_frag};
    Result result = passes_program(passes, "dual peel", "", &geometry, &state->peel);
    for (int side = 0; side < SIDES && result == RESULT_OK; side++) {
        char defines[64];
        snprintf(defines, sizeof defines, "%s%s", light[side],
                 passes->desc->back_light ? "#define BACK_LIGHT\n" : "");
        result = passes_program(passes, "dual lighting", defines, &lighting, &state->light[side]);
    }
    return result;
}

static Result create(Passes *passes, void *into)
{
    Dual *state = into;
    GLuint attached[ATTACHMENTS];
    Result result = limits_create(passes, &state->limits);
    if (result == RESULT_OK)
        result = build_programs(passes, state);
    for (int i = 0; i < SIDES * TARGETS && result == RESULT_OK; i++) {
        GLuint *color = &state->color[i / TARGETS][i % TARGETS];
        result = targets_texture(&passes->targets, target_format(passes->desc, i % TARGETS), color);
        attached[1 + i] = *color;
    }
    for (int i = 0; i < 2 && result == RESULT_OK; i++) {
        attached[0] = state->limits.textures[i];
        result = targets_framebuffer(ATTACHMENTS, attached, 0, &state->buffers[i]);
    }
    return result;
}

static void destroy(void *of)
{
    Dual *state = of;
    gl.DeleteProgram(state->peel);
    gl.DeleteFramebuffers(2, state->buffers);
    for (int side = 0; side < SIDES; side++) {
        gl.DeleteProgram(state->light[side]);
        gl.DeleteTextures(TARGETS, state->color[side]);
    }
    limits_destroy(&state->limits);
}

/* ---- a peel ---- */

static Result trace_peel(const Dual *state, int peel)
{
    static const char *const names[ATTACHMENTS] = {
        "depth",       "front_normal", "front_diffuse", "front_material",
        "back_normal", "back_diffuse", "back_material"};
    const Limits *limits = &state->limits;
    const Passes *passes = limits->passes;
    Result result = RESULT_OK;
    for (int i = 0; i < ATTACHMENTS && result == RESULT_OK; i++)
        result = limits_trace(limits, peel, names[i], state->buffers[limits_current(peel)], i,
                              i ? target_format(passes->desc, (i - 1) % TARGETS) : FORMAT_RG32F);
    if (result == RESULT_OK)
        result = limits_trace(limits, peel, "back_accum", limits->back_buffer, 0,
                              passes->targets.accum_format);
    return result == RESULT_OK ? passes_trace_peel_accum(passes, peel) : result;
}

static void draw_geometry(const Dual *state, int peel)
{
    static const float zero[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    const Passes *passes = state->limits.passes;
    GLuint buffer = state->buffers[limits_current(peel)];
    bool last_stays = passes->desc->depth_func == DEPTH_LEQUAL;
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, buffer);
    limits_bind(&state->limits, peel);
    gl.Enable(GL_BLEND);
    gl.BlendEquationi(0, GL_MAX);
    for (int i = 1; i < ATTACHMENTS; i++) {
        gl.ClearNamedFramebufferfv(buffer, GL_COLOR, i, zero);
        if (last_stays)
            gl.BlendFunci((GLuint)i, GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
        else
            gl.BlendFunci((GLuint)i, GL_ONE_MINUS_DST_ALPHA, GL_ONE);
    }
    passes_draw_list(passes, state->peel, true);
    gl.BlendEquation(GL_FUNC_ADD);
}

static void light(const Dual *state, int peel, int side)
{
    const Limits *limits = &state->limits;
    const Passes *passes = limits->passes;
    for (GLuint i = 0; i < TARGETS; i++)
        gl.BindTextureUnit(i, state->color[side][i]);
    limits_bind_previous(limits, peel);
    if (side == SIDE_FRONT)
        passes_blend_under();
    else
        passes_blend_over();
    passes_fullscreen(passes, state->light[side],
                      side == SIDE_FRONT ? passes->targets.plain_buffer : limits->back_buffer);
}

static Result draw_peel(void *context, int peel)
{
    const Dual *state = context;
    draw_geometry(state, peel);
    light(state, peel, SIDE_FRONT);
    light(state, peel, SIDE_BACK);
    gl.Disable(GL_BLEND);
    Result result = context_check(state->limits.passes->context, "dual peel");
    return result == RESULT_OK ? trace_peel(state, peel) : result;
}

static Result draw(void *of, Frame *out)
{
    Dual *state = of;
    Passes *passes = state->limits.passes;
    Result result = passes_opaque(passes);
    if (result == RESULT_OK)
        result = limits_peels(&state->limits, out, draw_peel, state);
    if (result != RESULT_OK)
        return result;
    limits_compose(&state->limits);
    return passes_finish(passes, out->peels);
}

const GlMethod gl_dual = {sizeof(Dual), create, draw, destroy};

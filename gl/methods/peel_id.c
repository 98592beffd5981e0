/* Deferred depth peeling by depth and primitive: keeps coplanar layers, whatever the draw order.
 *
 * This work is based on: C. Everitt, "Interactive Order-Independent Transparency", 2001;
 * L. Rapetta, "OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling". The second key is ours.
 *
 * What a layer is: ref/pipeline/methods/peel_id.c. Each peel is three geometry passes: the depth
 * of the first fragments after the previous layer; among the fragments at that depth, the first
 * primitive, by an atomic maximum on an image of ranks; and the G-buffer of that fragment. A
 * triangle's depths are the same bits in all three. The last, empty peel is a depth pass alone. */
#include "methods/methods.h"

#include "base/progress.h"
#include "program.h"
#include "readback.h"

#include <stdio.h>

enum {
    UNIFORM_FIRST_PRIMITIVE = 10
};

typedef struct PeelId {
    Passes *passes;
    Frame *frame;
    GLuint depth[2], select[2]; /* programs, of the first peel and of the next */
    GLuint gbuffer;
    Layer layers[2];        /* take turns: a depth each, and one set of colours */
    GLuint depth_buffer[2]; /* framebuffers of the depths alone */
    GLuint rank[2], rank_buffer[2];
    GLuint previous_code; /* see render_desc_needs_previous_code: here whatever the peel test */
} PeelId;

/* ---- set-up ---- */

static Result build_programs(PeelId *state)
{
    static const char *const next[2] = {"", "#define AFTER_LAYER\n"};
    const Passes *passes = state->passes;
    const char *order = passes->desc->depth_func == DEPTH_LEQUAL ? "#define GREATER_FIRST\n" : "";
    PassesSource source = {.surface = true, .peel_test = true, .main = shader_peel_id_frag};
    char defines[96];
    Result result = RESULT_OK;
    for (int i = 0; i < 2 && result == RESULT_OK; i++) {
        snprintf(defines, sizeof defines, "#define PASS_DEPTH\n%s%s", order, next[i]);
        result = passes_program(passes, "peel depth", defines, &source, &state->depth[i]);
        snprintf(defines, sizeof defines, "#define PASS_SELECT\n%s%s", order, next[i]);
        if (result == RESULT_OK)
            result = passes_program(passes, "peel select", defines, &source, &state->select[i]);
    }
    source.octahedral = source.gbuffer = true;
    snprintf(defines, sizeof defines, "#define PASS_GBUFFER\n%s", order);
    if (result == RESULT_OK)
        result = passes_program(passes, "peel G-buffer", defines, &source, &state->gbuffer);
    return result;
}

static Result create(Passes *passes, void *into)
{
    PeelId *state = into;
    Targets *targets = &passes->targets;
    state->passes = passes;
    Result result = build_programs(state);
    for (int i = 0; i < 2 && result == RESULT_OK; i++) {
        result = targets_layer(targets, i ? &state->layers[0] : NULL, &state->layers[i]);
        if (result == RESULT_OK)
            result = targets_framebuffer(0, NULL, state->layers[i].depth, &state->depth_buffer[i]);
        if (result == RESULT_OK)
            result = targets_texture(targets, FORMAT_R32UI, &state->rank[i]);
        if (result == RESULT_OK)
            result = targets_framebuffer(1, &state->rank[i], 0, &state->rank_buffer[i]);
    }
    if (result == RESULT_OK && render_desc_needs_previous_code(passes->desc))
        result = targets_texture(targets, FORMAT_R32UI, &state->previous_code);
    return result;
}

static void destroy(void *of)
{
    PeelId *state = of;
    for (int i = 0; i < 2; i++) {
        gl.DeleteProgram(state->depth[i]);
        gl.DeleteProgram(state->select[i]);
    }
    gl.DeleteProgram(state->gbuffer);
    targets_destroy_layer(&state->layers[1], true);
    targets_destroy_layer(&state->layers[0], false);
    gl.DeleteFramebuffers(2, state->depth_buffer);
    gl.DeleteFramebuffers(2, state->rank_buffer);
    gl.DeleteTextures(2, state->rank);
    gl.DeleteTextures(1, &state->previous_code);
}

/* ---- the three passes ---- */

/* The transparent draws to framebuffer, depth test on. */
static void draw_triangles(const PeelId *state, GLuint program, GLuint framebuffer)
{
    const View *view = state->passes->view;
    progress_add();
    state->frame->geometry_passes++;
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    gl.UseProgram(program);
    gl.Enable(GL_DEPTH_TEST);
    for (size_t i = 0; i < view->draw_count; i++) {
        const Draw *item = &view->draws[i];
        if (!item->transparent)
            continue;
        gl.ProgramUniform1ui(program, UNIFORM_FIRST_PRIMITIVE, item->first_primitive);
        passes_draw_range(state->passes, program, item, 0, UINT32_MAX);
    }
    gl.Disable(GL_DEPTH_TEST);
}

/* Texture units of shaders/peel_id.frag.glsl. */
static Result bind_previous(const PeelId *state, int peel)
{
    const int other = 1 - (peel & 1);
    passes_bind_opaque_depth(state->passes);
    if (peel == 0)
        return RESULT_OK;
    Result result = targets_copy_code(&state->passes->targets, state->layers[other].buffer,
                                      state->previous_code);
    gl.BindTextureUnit(4, state->previous_code ? state->previous_code : state->layers[other].depth);
    gl.BindTextureUnit(5, state->rank[other]);
    return result;
}

/* *samples: fragments that passed, 0 when nothing is left to peel; NULL: not counted. Whichever
 * function desc has: fragments of one depth are told apart later. */
static Result draw_depth(PeelId *state, int peel, uint64_t *samples)
{
    const Passes *passes = state->passes;
    Result result = bind_previous(state, peel);
    if (result != RESULT_OK)
        return result;
    passes_clear_layer(passes, &state->layers[peel & 1]);
    passes_depth_test(passes->desc, DEPTH_LEQUAL);
    passes_begin_count(passes, samples);
    draw_triangles(state, state->depth[peel > 0], state->depth_buffer[peel & 1]);
    return passes_end_count(passes, "depth pass", samples);
}

static void draw_selected(PeelId *state, int peel)
{
    static const GLuint none[4] = {0, 0, 0, 0};
    const int at = peel & 1;
    gl.DepthFunc(GL_EQUAL);
    gl.ClearNamedFramebufferuiv(state->rank_buffer[at], GL_COLOR, 0, none);
    gl.BindImageTexture(0, state->rank[at], 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
    draw_triangles(state, state->select[peel > 0], state->depth_buffer[at]);
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
    gl.BindTextureUnit(5, state->rank[at]);
    draw_triangles(state, state->gbuffer, state->layers[at].buffer);
    passes_depth_test(state->passes->desc, state->passes->desc->depth_func);
}

/* ---- the frame ---- */

/* Ranks as primitive ids, UINT32_MAX where there is none. */
static Result trace_ids(const PeelId *state, int peel)
{
    const Passes *passes = state->passes;
    const Targets *targets = &passes->targets;
    size_t pixels = (size_t)targets->width * (size_t)targets->height;
    uint32_t *ids = passes->pixels;
    readback_color(targets, state->rank_buffer[peel & 1], 0, FORMAT_R32UI, READBACK_TOP_DOWN, ids);
    for (size_t i = 0; i < pixels; i++)
        ids[i] = passes->desc->depth_func == DEPTH_LEQUAL ? ids[i] - 1 : ~ids[i];
    return trace_put_peel(passes->trace, peel, "id", FORMAT_R32UI, targets->width, targets->height,
                          ids);
}

static Result trace_peel(const PeelId *state, int peel)
{
    const Passes *passes = state->passes;
    Result result = readback_trace_gbuffer(&passes->targets, state->layers[peel & 1].buffer, peel,
                                           passes->trace, passes->pixels);
    if (result == RESULT_OK)
        result = trace_ids(state, peel);
    return result == RESULT_OK ? passes_trace_peel_accum(passes, peel) : result;
}

/* One peel. *more: false when nothing was left. */
static Result run_peel(void *context, int peel, bool *more)
{
    PeelId *state = context;
    const bool every = state->passes->options.every_pass;
    uint64_t samples = 0;
    Result result = draw_depth(state, peel, every ? NULL : &samples);
    *more = result == RESULT_OK && (samples > 0 || every);
    if (!*more)
        return result;
    draw_selected(state, peel);
    state->frame->peels = peel + 1;
    passes_light_layer(state->passes, &state->layers[peel & 1]);
    return state->passes->trace ? trace_peel(state, peel) : RESULT_OK;
}

static Result draw(void *of, Frame *out)
{
    PeelId *state = of;
    Passes *passes = state->passes;
    state->frame = out;
    Result result = passes_opaque(passes);
    if (result == RESULT_OK)
        result = passes_peels(passes, run_peel, state);
    return result == RESULT_OK ? passes_finish(passes, out->peels) : result;
}

const GlMethod gl_peel_id = {sizeof(PeelId), create, draw, destroy};

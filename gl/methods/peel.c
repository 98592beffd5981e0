/* Deferred depth peeling.
 *
 * This work is based on: L. Rapetta, "OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling";
 * C. Everitt, "Interactive Order-Independent Transparency", 2001. Opaque geometry is drawn once;
 * each peel is a geometry pass behind the previous one, shaded by a full-screen pass and blended
 * under what is in front of it; the opaque surfaces are shaded last.
 *
 * Forward peeling (Everitt 2001; L. Bavoil, K. Myers, "Order Independent Transparency with Dual
 * Depth Peeling", NVIDIA, 2008) has the same passes and other shaders: shaders/forward.frag.glsl
 * stores lit colours, and shaders/compose.frag.glsl blends them as they are. */
#include "methods/methods.h"

#include "base/memory.h"
#include "base/progress.h"
#include "readback.h"

#include <stdlib.h>

typedef struct Peel {
    Passes *passes;
    Frame *frame;
    GLuint first, next;   /* programs */
    Layer layers[2];      /* take turns: a depth each, and one set of colours */
    GLuint previous_code; /* see render_desc_needs_previous_code */
    /* Read back by the raw test to see repeated layers; NULL otherwise. */
    uint32_t *depth[2]; /* this peel's and the previous one's, as bits */
    void *material;
} Peel;

static Result create(Passes *passes, void *into)
{
    Peel *state = into;
    const RenderDesc *desc = passes->desc;
    size_t pixels = (size_t)desc->width * (size_t)desc->height;
    state->passes = passes;
    Result result =
        passes_geometry_program(passes, "first peel", "#define TRANSPARENT\n", &state->first);
    if (result == RESULT_OK)
        result = passes_geometry_program(passes, "next peel",
                                         "#define TRANSPARENT\n#define NEXT_PEEL\n", &state->next);
    if (result == RESULT_OK)
        result = targets_layer(&passes->targets, NULL, &state->layers[0]);
    if (result == RESULT_OK)
        result = targets_layer(&passes->targets, &state->layers[0], &state->layers[1]);
    if (result == RESULT_OK && render_desc_needs_previous_code(desc))
        result = targets_texture(&passes->targets, FORMAT_R32UI, &state->previous_code);
    if (result != RESULT_OK || desc->peel_test != PEEL_TEST_RAW)
        return result;
    state->depth[0] = memory_array(pixels, sizeof(uint32_t));
    state->depth[1] = memory_array(pixels, sizeof(uint32_t));
    state->material = memory_array(pixels, 4 * sizeof(float));
    return state->depth[0] && state->depth[1] && state->material ? RESULT_OK : RESULT_NO_MEMORY;
}

static void destroy(void *of)
{
    Peel *state = of;
    gl.DeleteProgram(state->first);
    gl.DeleteProgram(state->next);
    targets_destroy_layer(&state->layers[1], true);
    targets_destroy_layer(&state->layers[0], false);
    gl.DeleteTextures(1, &state->previous_code);
    free(state->depth[0]);
    free(state->depth[1]);
    free(state->material);
}

/* Compares a peel's depths with the previous peel's: *repeated counts the pixels that have a
 * fragment at the same stored depth, *fresh those that have one at another. A pixel has a fragment
 * where its material's fourth channel is not 0; its depth may equal the cleared one. */
static void count_repeats(const Peel *state, int peel, uint64_t *repeated, uint64_t *fresh)
{
    const Targets *targets = &state->passes->targets;
    GLuint framebuffer = state->layers[peel & 1].buffer;
    PixelFormat format = targets->color_format[GBUFFER_MATERIAL];
    uint32_t *depth = state->depth[peel & 1], *previous = state->depth[1 - (peel & 1)];
    readback_depth(targets, framebuffer, READBACK_BOTTOM_UP, depth);
    readback_color(targets, framebuffer, targets->attachment[GBUFFER_MATERIAL], format,
                   READBACK_BOTTOM_UP, state->material);
    *repeated = *fresh = 0;
    size_t pixels = (size_t)targets->width * (size_t)targets->height;
    size_t stride = format_pixel_bytes(format);
    for (size_t i = 0; i < pixels; i++) {
        if (format_channel(format, (const char *)state->material + i * stride, 3) == 0.0f)
            continue;
        if (peel > 0 && depth[i] == previous[i])
            ++*repeated;
        else
            ++*fresh;
    }
}

/* *samples: fragments that passed, 0 when nothing is left to peel; NULL: not counted. */
static Result draw_peel(Peel *state, int peel, uint64_t *samples)
{
    const Passes *passes = state->passes;
    const Targets *targets = &passes->targets;
    const Layer *layer = &state->layers[peel & 1], *previous = &state->layers[1 - (peel & 1)];
    passes_clear_layer(passes, layer);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, layer->buffer);
    if (peel > 0) {
        Result result = targets_copy_code(targets, previous->buffer, state->previous_code);
        if (result != RESULT_OK)
            return result;
        gl.BindTextureUnit(0, state->previous_code ? state->previous_code : previous->depth);
    }
    passes_bind_opaque_depth(passes);
    return passes_draw_counted(passes, peel > 0 ? state->next : state->first, true, samples);
}

static Result trace_peel(const Peel *state, int peel)
{
    const Passes *passes = state->passes;
    Result result = readback_trace_gbuffer(&passes->targets, state->layers[peel & 1].buffer, peel,
                                           passes->trace, passes->pixels);
    return result == RESULT_OK ? passes_trace_peel_accum(passes, peel) : result;
}

/* One peel. *more: false when it brought nothing new and was left out. */
static Result run_peel(void *context, int peel, bool *more)
{
    Peel *state = context;
    const Passes *passes = state->passes;
    const bool every = passes->options.every_pass;
    uint64_t samples = 0;
    *more = false;
    progress_add();
    state->frame->geometry_passes++;
    Result result = draw_peel(state, peel, every ? NULL : &samples);
    if (result != RESULT_OK || (samples == 0 && !every))
        return result;
    if (passes->desc->peel_test == PEEL_TEST_RAW && !every) {
        uint64_t repeated, fresh;
        count_repeats(state, peel, &repeated, &fresh);
        if (passes->desc->passes == 0 && fresh == 0)
            return RESULT_OK;
        state->frame->layers.repeated += repeated;
    }
    *more = true;
    state->frame->peels = peel + 1;
    passes_light_layer(passes, &state->layers[peel & 1]);
    return passes->trace ? trace_peel(state, peel) : RESULT_OK;
}

static Result draw(void *of, Frame *out)
{
    Peel *state = of;
    Passes *passes = state->passes;
    state->frame = out;
    Result result = passes_opaque(passes);
    if (result == RESULT_OK)
        result = passes_peels(passes, run_peel, state);
    return result == RESULT_OK ? passes_finish(passes, out->peels) : result;
}

const GlMethod gl_peel = {sizeof(Peel), create, draw, destroy};
const GlMethod gl_forward = {sizeof(Peel), create, draw, destroy};

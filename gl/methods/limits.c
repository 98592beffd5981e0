#include "methods/limits.h"

#include "base/progress.h"
#include "frame/method.h"
#include "program.h"
#include "readback.h"

#include <stdio.h>

static const float no_layer[4] = {-2.0f, -2.0f, 0.0f, 0.0f};

enum {
    UNIT_PREVIOUS_LIMITS = 4
};

Result limits_copy_program(const Passes *passes, const char *defines, GLuint *out)
{
    const PassesSource source = {.minmax = true, .main = shader_minmax_frag};
    return passes_program(passes, "full-screen min-max", defines, &source, out);
}

static Result build_programs(Limits *limits)
{
    const PassesSource first = {
        .surface = true, .peel_test = true, .minmax = true, .main = shader_minmax_frag};
    Result result = passes_program(limits->passes, "first min-max", "#define FIRST_PASS\n", &first,
                                   &limits->first);
    if (result == RESULT_OK)
        result = limits_copy_program(limits->passes, "#define COUNT\n", &limits->count);
    if (result == RESULT_OK)
        result =
            limits_copy_program(limits->passes, "#define TRANSMITTANCE\n", &limits->copy_under);
    return result;
}

Result limits_create(Passes *passes, Limits *out)
{
    Targets *targets = &passes->targets;
    *out = (Limits){.passes = passes};
    Result result = build_programs(out);
    for (int i = 0; i < 2 && result == RESULT_OK; i++) {
        result = targets_texture(targets, FORMAT_RG32F, &out->textures[i]);
        if (result == RESULT_OK)
            result = targets_framebuffer(1, &out->textures[i], 0, &out->buffers[i]);
    }
    if (result == RESULT_OK)
        result = targets_texture(targets, targets->accum_format, &out->back);
    if (result == RESULT_OK)
        result = targets_framebuffer(1, &out->back, 0, &out->back_buffer);
    return result;
}

void limits_destroy(Limits *limits)
{
    gl.DeleteProgram(limits->first);
    gl.DeleteProgram(limits->count);
    gl.DeleteProgram(limits->copy_under);
    gl.DeleteFramebuffers(2, limits->buffers);
    gl.DeleteFramebuffers(1, &limits->back_buffer);
    gl.DeleteTextures(2, limits->textures);
    gl.DeleteTextures(1, &limits->back);
    *limits = (Limits){0};
}

/* ---- tracing ---- */

static Result trace(const Limits *limits, const char *step_name, int step, const char *what,
                    GLuint framebuffer, int attachment, PixelFormat format)
{
    const Passes *passes = limits->passes;
    char name[48];
    if (!passes->trace)
        return RESULT_OK;
    snprintf(name, sizeof name, "%s.%s.%s", method_info(passes->desc->method)->name, step_name,
             what);
    readback_color(&passes->targets, framebuffer, attachment, format, READBACK_TOP_DOWN,
                   passes->pixels);
    return trace_put(passes->trace, name, step, format, passes->targets.width,
                     passes->targets.height, passes->pixels);
}

Result limits_trace(const Limits *limits, int peel, const char *what, GLuint framebuffer,
                    int attachment, PixelFormat format)
{
    char number[16];
    snprintf(number, sizeof number, "%d", peel);
    return trace(limits, number, peel + 1, what, framebuffer, attachment, format);
}

/* ---- passes ---- */

void limits_bind(const Limits *limits, int peel)
{
    passes_bind_opaque_depth(limits->passes);
    limits_bind_previous(limits, peel);
}

void limits_bind_previous(const Limits *limits, int peel)
{
    gl.BindTextureUnit(UNIT_PREVIOUS_LIMITS, limits->textures[limits_previous(peel)]);
}

static Result draw_first(const Limits *limits)
{
    const Passes *passes = limits->passes;
    gl.ClearNamedFramebufferfv(limits->buffers[0], GL_COLOR, 0, no_layer);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, limits->buffers[0]);
    limits_bind(limits, 0);
    gl.Enable(GL_BLEND);
    gl.BlendEquation(GL_MAX);
    passes_draw_list(passes, limits->first, true);
    gl.BlendEquation(GL_FUNC_ADD);
    gl.Disable(GL_BLEND);
    Result result = context_check(passes->context, "min-max pass");
    return result == RESULT_OK
               ? trace(limits, "first", 0, "depth", limits->buffers[0], 0, FORMAT_RG32F)
               : result;
}

/* Whether any pixel has a layer in that of the two. Draws to the other buffer, which the next peel
 * clears: not another pass over the scene, but one over the pixels, tells that nothing is left. */
static Result any_layer(const Limits *limits, int which, bool *any)
{
    const Passes *passes = limits->passes;
    uint64_t samples;
    gl.BindTextureUnit(0, limits->textures[which]);
    passes_begin_count(passes, &samples);
    passes_fullscreen(passes, limits->count, limits->buffers[1 - which]);
    Result result = passes_end_count(passes, "count of pixels with layers", &samples);
    *any = samples > 0;
    return result;
}

Result limits_peels(Limits *limits, Frame *frame, Result (*draw_peel)(void *state, int peel),
                    void *state)
{
    static const float no_color_all_transmitted[4] = {0.0f, 0.0f, 0.0f, 1.0f};
    int most = render_desc_pass_limit(limits->passes->desc);
    bool any = false;
    gl.ClearNamedFramebufferfv(limits->back_buffer, GL_COLOR, 0, no_color_all_transmitted);
    progress_add();
    frame->geometry_passes = 1;
    Result result = draw_first(limits);
    if (result == RESULT_OK)
        result = any_layer(limits, 0, &any);
    for (int peel = 0; peel < most && any && result == RESULT_OK; peel++) {
        progress_add();
        gl.ClearNamedFramebufferfv(limits->buffers[limits_current(peel)], GL_COLOR, 0, no_layer);
        result = draw_peel(state, peel);
        if (result == RESULT_OK)
            result = any_layer(limits, limits_current(peel), &any);
        frame->geometry_passes++;
        frame->peels = peel + 1;
    }
    return result;
}

void limits_compose(const Limits *limits)
{
    gl.BindTextureUnit(0, limits->back);
    passes_blend_under();
    gl.Enable(GL_BLEND);
    passes_fullscreen(limits->passes, limits->copy_under, limits->passes->targets.plain_buffer);
    gl.Disable(GL_BLEND);
}

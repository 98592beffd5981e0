#include "sums.h"

#include "base/memory.h"
#include "base/progress.h"
#include "readback.h"

#include <stdio.h>
#include <stdlib.h>

static Result make_programs(Sums *sums)
{
    const Passes *passes = sums->passes;
    const PassesSource geometry = {
        .surface = true, .peel_test = true, .shade = true, .main = sums->method.shader};
    const PassesSource combine = {.main = sums->method.shader};
    char defines[128];
    snprintf(defines, sizeof defines, "%s%s", sums->method.defines,
             passes->desc->back_light ? "#define BACK_LIGHT\n" : "");
    Result result = passes_program(passes, sums->method.name, defines, &geometry, &sums->geometry);
    if (result == RESULT_OK)
        result = passes_program(passes, sums->method.name, "#define COMBINE\n", &combine,
                                &sums->combine);
    return result;
}

Result sums_create(Passes *passes, const SumsMethod *method, void *state)
{
    Sums *sums = state;
    Targets *targets = &passes->targets;
    sums->passes = passes;
    sums->method = *method;
    sums->format[0] = render_desc_sum_format(passes->desc);
    sums->format[1] = FORMAT_R32F;
    sums->count = *sums->method.second ? 2 : 1;
    sums->pixels = memory_array((size_t)targets->width * (size_t)targets->height,
                                format_pixel_bytes(sums->format[0]));
    Result result = sums->pixels ? make_programs(sums) : RESULT_NO_MEMORY;
    for (int i = 0; i < sums->count && result == RESULT_OK; i++)
        result = targets_texture(targets, sums->format[i], &sums->texture[i]);
    return result == RESULT_OK ? targets_framebuffer(sums->count, sums->texture, 0, &sums->buffer)
                               : result;
}

void sums_destroy(void *state)
{
    Sums *sums = state;
    gl.DeleteProgram(sums->geometry);
    gl.DeleteProgram(sums->combine);
    gl.DeleteFramebuffers(1, &sums->buffer);
    gl.DeleteTextures(2, sums->texture);
    free(sums->pixels);
}

static Result draw(Sums *sums, Frame *out)
{
    const Passes *passes = sums->passes;
    const float zero[4] = {0}, start[4] = {sums->method.start};
    uint64_t samples;
    gl.ClearNamedFramebufferfv(sums->buffer, GL_COLOR, 0, zero);
    if (sums->count > 1)
        gl.ClearNamedFramebufferfv(sums->buffer, GL_COLOR, 1, start);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, sums->buffer);
    passes_bind_opaque_depth(passes);
    gl.Enable(GL_BLEND);
    gl.BlendFunc(GL_ONE, GL_ONE);
    if (sums->count > 1)
        gl.BlendFunci(1, sums->method.source, sums->method.destination);
    /* Without a depth attachment there is no depth test. */
    Result result = passes_draw_counted(passes, sums->geometry, true, &samples);
    gl.Disable(GL_BLEND);
    progress_add();
    out->geometry_passes = 1;
    out->peels = samples > 0;
    return result;
}

/* Counts the sums that overflowed; to the trace, if there is one. */
static Result read_sums(Sums *sums, Frame *out)
{
    const Passes *passes = sums->passes;
    const Targets *targets = &passes->targets;
    size_t pixels = (size_t)targets->width * (size_t)targets->height;
    Result result = RESULT_OK;
    for (int i = 0; i < (passes->trace ? sums->count : 1) && result == RESULT_OK; i++) {
        PixelFormat format = sums->format[i];
        char name[48];
        readback_color(targets, sums->buffer, i, format, READBACK_TOP_DOWN, sums->pixels);
        for (size_t k = 0; k < pixels && i == 0; k++)
            out->layers.overflowed += format_overflowed(format, (const char *)sums->pixels +
                                                                    k * format_pixel_bytes(format));
        snprintf(name, sizeof name, "%s.%s", sums->method.name,
                 i == 0 ? "sum" : sums->method.second);
        result = trace_put(passes->trace, name, 1, format, targets->width, targets->height,
                           sums->pixels);
    }
    return result;
}

static void combine(const Sums *sums)
{
    for (GLuint i = 0; i < (GLuint)sums->count; i++)
        gl.BindTextureUnit(i, sums->texture[i]);
    passes_blend_under();
    gl.Enable(GL_BLEND);
    passes_fullscreen(sums->passes, sums->combine, sums->passes->targets.plain_buffer);
    gl.Disable(GL_BLEND);
}

Result sums_draw(void *state, Frame *out)
{
    Sums *sums = state;
    Result result = passes_opaque(sums->passes);
    if (result == RESULT_OK)
        result = draw(sums, out);
    if (result == RESULT_OK)
        result = read_sums(sums, out);
    if (result != RESULT_OK)
        return result;
    combine(sums);
    return passes_finish(sums->passes, out->peels);
}

#include "lab_draw.h"

#include "formats.h"
#include "program.h"

#include <stdio.h>
#include <string.h>

GLuint lab_texture(PixelFormat format, int width, int height)
{
    GLuint texture;
    gl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl.TextureStorage2D(texture, 1, formats_gl(format)->internal, width, height);
    gl.TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return texture;
}

Result lab_target(PixelFormat color_format, int colors, PixelFormat depth_format, int width,
                  int height, LabTarget *out)
{
    GLenum buffers[LAB_COLORS_MAX];
    *out = (LabTarget){.color_format = color_format,
                       .depth_format = depth_format,
                       .colors = colors,
                       .width = width,
                       .height = height};
    gl.CreateFramebuffers(1, &out->framebuffer);
    for (int i = 0; i < colors; i++) {
        buffers[i] = GL_COLOR_ATTACHMENT0 + (GLenum)i;
        out->color[i] = lab_texture(color_format, width, height);
        gl.NamedFramebufferTexture(out->framebuffer, buffers[i], out->color[i], 0);
    }
    if (colors > 0)
        gl.NamedFramebufferDrawBuffers(out->framebuffer, colors, buffers);
    if (depth_format != FORMAT_NONE) {
        out->depth = lab_texture(depth_format, width, height);
        gl.NamedFramebufferTexture(out->framebuffer, GL_DEPTH_ATTACHMENT, out->depth, 0);
    }
    gl.BindFramebuffer(GL_FRAMEBUFFER, out->framebuffer);
    gl.Viewport(0, 0, width, height);
    GLenum status = gl.CheckNamedFramebufferStatus(out->framebuffer, GL_DRAW_FRAMEBUFFER);
    if (status == GL_FRAMEBUFFER_COMPLETE)
        return RESULT_OK;
    lab_target_destroy(out);
    return result_fail(RESULT_NO_GL, "OpenGL: no framebuffer of %s and %s: status 0x%04x",
                       format_info(color_format)->name, format_info(depth_format)->name, status);
}

void lab_target_destroy(LabTarget *target)
{
    gl.DeleteFramebuffers(1, &target->framebuffer);
    gl.DeleteTextures(LAB_COLORS_MAX, target->color);
    gl.DeleteTextures(1, &target->depth);
}

void lab_read_depth(const LabTarget *target, uint32_t *out)
{
    const GlFormat *names = formats_gl(target->depth_format);
    gl.ReadPixels(0, 0, target->width, target->height, names->format, names->type, out);
    formats_narrow_depth(target->depth_format, out, (size_t)target->width * (size_t)target->height);
}

void lab_read_color(const LabTarget *target, int i, void *out)
{
    const GlFormat *names = formats_gl(target->color_format);
    gl.NamedFramebufferReadBuffer(target->framebuffer, GL_COLOR_ATTACHMENT0 + (GLenum)i);
    gl.ReadPixels(0, 0, target->width, target->height, names->format, names->type, out);
}

Result lab_use(GlLab *lab, const char *defines)
{
    for (int i = 0; i < LAB_PROGRAMS; i++)
        if (lab->programs[i].program && strcmp(lab->programs[i].defines, defines) == 0) {
            gl.UseProgram(lab->programs[i].program);
            return RESULT_OK;
        }
    LabProgram *slot = &lab->programs[lab->next_program];
    lab->next_program = (lab->next_program + 1) % LAB_PROGRAMS;
    gl.DeleteProgram(slot->program);
    snprintf(slot->defines, sizeof slot->defines, "%s", defines);
    Result result = program_build("experiment", defines, shader_experiment_vert,
                                  shader_experiment_frag, &slot->program);
    if (result == RESULT_OK)
        gl.UseProgram(slot->program);
    return result;
}

void lab_upload(GlLab *lab, const Experiment *experiment, int texels)
{
    const float(*operands[2])[4] = {experiment->a, experiment->b};
    int rows = texels / EXPERIMENT_WIDTH, rest = texels % EXPERIMENT_WIDTH;
    for (int i = 0; i < 2; i++) {
        if (!operands[i])
            continue;
        if (rows > 0)
            gl.TextureSubImage2D(lab->operands[i], 0, 0, 0, EXPERIMENT_WIDTH, rows, GL_RGBA,
                                 GL_FLOAT, operands[i]);
        if (rest > 0)
            gl.TextureSubImage2D(lab->operands[i], 0, 0, rows, rest, 1, GL_RGBA, GL_FLOAT,
                                 operands[i] + (size_t)rows * EXPERIMENT_WIDTH);
    }
}

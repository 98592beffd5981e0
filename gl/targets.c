#include "targets.h"

#include "base/memory.h"
#include "formats.h"
#include "readback.h"

#include <stdlib.h>
#include <string.h>

static void choose_formats(const RenderDesc *desc, const Needs *needs, Targets *out)
{
    GBufferLayout layout = needs_layout(needs, desc, needs_has(needs, NEED_TRANSPARENT));
    out->depth_format = render_desc_depth(desc);
    out->accum_format = desc->accum;
    out->lit = desc->method == METHOD_FORWARD;
    out->color_format[GBUFFER_NORMAL] = layout.normal;
    out->color_format[GBUFFER_POSITION] = layout.position;
    out->color_format[GBUFFER_DIFFUSE] = layout.diffuse;
    out->color_format[GBUFFER_MATERIAL] = layout.material;
    for (int i = 0; i < GBUFFER_TARGETS; i++)
        out->attachment[i] = out->color_format[i] == FORMAT_NONE ? -1 : out->color_count++;
}

static Result check_limits(const Context *context, const RenderDesc *desc)
{
    const ContextLimits *limits = context_limits(context);
    int width =
        limits->viewport[0] < limits->texture_size ? limits->viewport[0] : limits->texture_size;
    int height =
        limits->viewport[1] < limits->texture_size ? limits->viewport[1] : limits->texture_size;
    if (desc->width > width || desc->height > height)
        return result_fail(RESULT_BAD_INPUT, "size %dx%d: the OpenGL driver allows %dx%d at most",
                           desc->width, desc->height, width, height);
    if (limits->draw_buffers < 8)
        return result_fail(RESULT_NO_GL, "OpenGL: 8 draw buffers expected, the driver has %d",
                           limits->draw_buffers);
    return RESULT_OK;
}

Result targets_reserve(Targets *targets, size_t bytes)
{
    targets->bytes += bytes;
    if (targets->bytes <= targets->limit)
        return RESULT_OK;
    return result_fail(RESULT_NO_MEMORY,
                       "gl: %d×%d needs at least %zu KiB, the limit is %zu KiB (--max-memory)",
                       targets->width, targets->height, targets->bytes >> 10, targets->limit >> 10);
}

Result targets_buffer(Targets *targets, size_t bytes, GLuint *out)
{
    *out = 0;
    Result result = targets_reserve(targets, bytes);
    if (result != RESULT_OK)
        return result;
    gl.CreateBuffers(1, out);
    gl.NamedBufferStorage(*out, (GLsizeiptr)bytes, NULL, GL_DYNAMIC_STORAGE_BIT);
    return RESULT_OK;
}

void targets_free_buffer(Targets *targets, size_t bytes, GLuint *buffer)
{
    if (*buffer)
        targets->bytes -= bytes;
    gl.DeleteBuffers(1, buffer);
    *buffer = 0;
}

Result targets_texture(Targets *targets, PixelFormat format, GLuint *out)
{
    *out = 0;
    Result result = targets_reserve(targets, format_pixel_bytes(format) * (size_t)targets->width *
                                                 (size_t)targets->height);
    if (result != RESULT_OK)
        return result;
    gl.CreateTextures(GL_TEXTURE_2D, 1, out);
    gl.TextureStorage2D(*out, 1, formats_gl(format)->internal, targets->width, targets->height);
    gl.TextureParameteri(*out, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TextureParameteri(*out, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return RESULT_OK;
}

Result targets_framebuffer(int count, const GLuint *color, GLuint depth, GLuint *out)
{
    GLenum buffers[8];
    gl.CreateFramebuffers(1, out);
    for (int i = 0; i < count; i++) {
        buffers[i] = GL_COLOR_ATTACHMENT0 + (GLenum)i;
        gl.NamedFramebufferTexture(*out, buffers[i], color[i], 0);
    }
    gl.NamedFramebufferDrawBuffers(*out, count, buffers);
    if (depth)
        gl.NamedFramebufferTexture(*out, GL_DEPTH_ATTACHMENT, depth, 0);
    GLenum status = gl.CheckNamedFramebufferStatus(*out, GL_DRAW_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE)
        return result_fail(RESULT_NO_GL, "OpenGL: a framebuffer is not complete: status 0x%04x",
                           status);
    GLint samples = 0;
    gl.GetNamedFramebufferParameteriv(*out, GL_SAMPLES, &samples);
    if (samples != 0)
        return result_fail(RESULT_NO_GL, "OpenGL: no multisampling expected, %d samples found",
                           samples);
    return RESULT_OK;
}

Result targets_layer(Targets *targets, const Layer *shared, Layer *out)
{
    GLuint attached[GBUFFER_TARGETS];
    *out = (Layer){0};
    Result result = targets_texture(targets, targets->depth_format, &out->depth);
    for (int i = 0; i < GBUFFER_TARGETS && result == RESULT_OK; i++) {
        if (targets->attachment[i] < 0)
            continue;
        if (shared)
            out->color[i] = shared->color[i];
        else
            result = targets_texture(targets, targets->color_format[i], &out->color[i]);
        attached[targets->attachment[i]] = out->color[i];
    }
    if (result == RESULT_OK)
        result = targets_framebuffer(targets->color_count, attached, out->depth, &out->buffer);
    if (result == RESULT_OK)
        result = targets_framebuffer(1, &targets->accum, out->depth, &out->light_buffer);
    return result;
}

void targets_destroy_layer(Layer *layer, bool shares_color)
{
    gl.DeleteFramebuffers(1, &layer->buffer);
    gl.DeleteFramebuffers(1, &layer->light_buffer);
    gl.DeleteTextures(1, &layer->depth);
    if (!shares_color)
        gl.DeleteTextures(GBUFFER_TARGETS, layer->color);
    *layer = (Layer){0};
}

static Result make_opaque(const Needs *needs, Targets *out)
{
    if (needs_has(needs, NEED_OPAQUE))
        return targets_layer(out, NULL, &out->opaque);
    Result result = targets_texture(out, out->depth_format, &out->opaque.depth);
    return result == RESULT_OK
               ? targets_framebuffer(0, NULL, out->opaque.depth, &out->opaque.buffer)
               : result;
}

static Result make(const RenderDesc *desc, const Needs *needs, Targets *out)
{
    Result result = targets_texture(out, out->accum_format, &out->accum);
    if (result == RESULT_OK)
        result = make_opaque(needs, out);
    if (result == RESULT_OK && render_desc_needs_code(desc))
        result = targets_texture(out, FORMAT_R32UI, &out->opaque_code);
    if (result == RESULT_OK)
        result = targets_texture(out, FORMAT_RGBA32F, &out->final);
    if (result == RESULT_OK)
        result = targets_texture(out, FORMAT_RGBA8, &out->display);
    if (result == RESULT_OK)
        result = targets_framebuffer(1, &out->accum, 0, &out->plain_buffer);
    const GLuint resolved[] = {out->final, out->display};
    if (result == RESULT_OK)
        result = targets_framebuffer(2, resolved, 0, &out->resolve_buffer);
    return result;
}

Result targets_create(Context *context, const RenderDesc *desc, const Needs *needs, Targets *out)
{
    *out = (Targets){.width = desc->width,
                     .height = desc->height,
                     .limit = desc->max_memory ? desc->max_memory : RENDER_MEMORY_DEFAULT};
    choose_formats(desc, needs, out);
    Result result = check_limits(context, desc);
    if (result == RESULT_OK)
        result = make(desc, needs, out);
    if (result == RESULT_OK)
        result = context_check(context, "framebuffers");
    if (result == RESULT_NO_GL)
        result = result_fail(result, "gl: %d×%d: the driver refuses such images: %s", desc->width,
                             desc->height, result_message());
    if (result != RESULT_OK)
        targets_destroy(out);
    return result;
}

void targets_destroy(Targets *targets)
{
    targets_destroy_layer(&targets->opaque, false);
    gl.DeleteFramebuffers(1, &targets->plain_buffer);
    gl.DeleteFramebuffers(1, &targets->resolve_buffer);
    gl.DeleteTextures(1, &targets->opaque_code);
    gl.DeleteTextures(1, &targets->accum);
    gl.DeleteTextures(1, &targets->final);
    gl.DeleteTextures(1, &targets->display);
    *targets = (Targets){0};
}

Result targets_copy_code(const Targets *targets, GLuint framebuffer, GLuint code)
{
    if (!code)
        return RESULT_OK;
    size_t pixels = (size_t)targets->width * (size_t)targets->height;
    uint32_t *codes = memory_array(pixels, sizeof *codes);
    if (!codes)
        return RESULT_NO_MEMORY;
    readback_depth(targets, framebuffer, READBACK_BOTTOM_UP, codes);
    gl.TextureSubImage2D(code, 0, 0, 0, targets->width, targets->height, GL_RED_INTEGER,
                         GL_UNSIGNED_INT, codes);
    free(codes);
    return RESULT_OK;
}

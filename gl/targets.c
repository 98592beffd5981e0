#include "targets.h"

#include "base/memory.h"
#include "formats.h"
#include "readback.h"

#include <stdlib.h>
#include <string.h>

static void choose_formats(const RenderDesc *desc, Targets *out)
{
    GBufferLayout layout = render_desc_layout(desc);
    out->depth_format = render_desc_depth(desc);
    out->accum_format = desc->accum;
    out->color_format[GBUFFER_NORMAL] = layout.normal;
    out->color_format[GBUFFER_POSITION] = layout.position;
    out->color_format[GBUFFER_DIFFUSE] = layout.diffuse;
    out->color_format[GBUFFER_MATERIAL] = layout.material;
    for (int i = 0; i < GBUFFER_TARGETS; i++)
        out->attachment[i] = out->color_format[i] == FORMAT_NONE ? -1 : out->color_count++;
}

/* Only a 24-bit depth compared as stored is ambiguous when it is fetched as a float: the two
 * greatest are both 1. The opaque depth can be either of them, a previous peel's only where the
 * near plane is at 1. */
static bool needs_code(const RenderDesc *desc)
{
    return render_desc_depth(desc) == FORMAT_D24 && desc->peel_test == PEEL_TEST_STORED;
}

static bool needs_previous_code(const RenderDesc *desc)
{
    return needs_code(desc) && desc->depth_range == DEPTH_RANGE_REVERSED;
}

static size_t count_bytes(const RenderDesc *desc, const Targets *targets)
{
    size_t pixel = 3 * format_pixel_bytes(targets->depth_format);
    for (int i = 0; i < GBUFFER_TARGETS; i++)
        pixel += 2 * format_pixel_bytes(targets->color_format[i]);
    pixel += format_pixel_bytes(targets->accum_format);
    pixel += format_pixel_bytes(FORMAT_RGBA32F) + format_pixel_bytes(FORMAT_RGBA8);
    pixel += format_pixel_bytes(FORMAT_R32UI) * (needs_code(desc) + needs_previous_code(desc));
    return pixel * (size_t)desc->width * (size_t)desc->height;
}

static Result check_limits(const Context *context, const RenderDesc *desc, size_t bytes)
{
    const ContextLimits *limits = context_limits(context);
    int width =
        limits->viewport[0] < limits->texture_size ? limits->viewport[0] : limits->texture_size;
    int height =
        limits->viewport[1] < limits->texture_size ? limits->viewport[1] : limits->texture_size;
    if (desc->width > width || desc->height > height)
        return result_fail(RESULT_BAD_INPUT, "size %dx%d: the OpenGL driver allows %dx%d at most",
                           desc->width, desc->height, width, height);
    if (limits->draw_buffers < GBUFFER_TARGETS)
        return result_fail(RESULT_NO_GL, "OpenGL: %d draw buffers expected, the driver has %d",
                           (int)GBUFFER_TARGETS, limits->draw_buffers);
    size_t most = desc->max_memory ? desc->max_memory : RENDER_MEMORY_DEFAULT;
    if (bytes > most)
        return result_fail(RESULT_NO_MEMORY,
                           "gl: %d×%d needs %zu KiB, the limit is %zu KiB (--max-memory)",
                           desc->width, desc->height, bytes >> 10, most >> 10);
    return RESULT_OK;
}

static GLuint make_texture(const Targets *targets, PixelFormat format)
{
    GLuint texture;
    gl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl.TextureStorage2D(texture, 1, formats_gl(format)->internal, targets->width, targets->height);
    gl.TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return texture;
}

static void make_textures(const RenderDesc *desc, Targets *out)
{
    out->opaque_depth = make_texture(out, out->depth_format);
    for (int i = 0; i < 2; i++)
        out->peel_depth[i] = make_texture(out, out->depth_format);
    for (int i = 0; i < GBUFFER_TARGETS; i++) {
        if (out->attachment[i] < 0)
            continue;
        out->opaque_color[i] = make_texture(out, out->color_format[i]);
        out->peel_color[i] = make_texture(out, out->color_format[i]);
    }
    if (needs_code(desc))
        out->opaque_code = make_texture(out, FORMAT_R32UI);
    if (needs_previous_code(desc))
        out->previous_code = make_texture(out, FORMAT_R32UI);
    out->accum = make_texture(out, out->accum_format);
    out->final = make_texture(out, FORMAT_RGBA32F);
    out->display = make_texture(out, FORMAT_RGBA8);
}

/* depth 0: no depth attachment. */
static Result make_framebuffer(int count, const GLuint *color, GLuint depth, GLuint *out)
{
    GLenum buffers[GBUFFER_TARGETS];
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

/* The G-buffer's textures in the order of their attachments, without gaps. */
static Result make_gbuffer(const Targets *targets, const GLuint color[GBUFFER_TARGETS],
                           GLuint depth, GLuint *out)
{
    GLuint attached[GBUFFER_TARGETS];
    for (int i = 0; i < GBUFFER_TARGETS; i++)
        if (targets->attachment[i] >= 0)
            attached[targets->attachment[i]] = color[i];
    return make_framebuffer(targets->color_count, attached, depth, out);
}

static Result make_framebuffers(Targets *out)
{
    Result result = make_gbuffer(out, out->opaque_color, out->opaque_depth, &out->opaque_buffer);
    for (int i = 0; i < 2 && result == RESULT_OK; i++)
        result = make_gbuffer(out, out->peel_color, out->peel_depth[i], &out->peel_buffer[i]);
    if (result == RESULT_OK)
        result = make_framebuffer(1, &out->accum, 0, &out->plain_buffer);
    const GLuint resolved[] = {out->final, out->display};
    if (result == RESULT_OK)
        result = make_framebuffer(2, resolved, 0, &out->resolve_buffer);
    return result;
}

Result targets_create(Context *context, const RenderDesc *desc, Targets *out)
{
    *out = (Targets){.width = desc->width, .height = desc->height};
    choose_formats(desc, out);
    out->bytes = count_bytes(desc, out);
    Result result = check_limits(context, desc, out->bytes);
    if (result == RESULT_OK) {
        make_textures(desc, out);
        result = context_check(context, "textures");
    }
    if (result == RESULT_OK)
        result = make_framebuffers(out);
    if (result == RESULT_OK)
        result = context_check(context, "framebuffers");
    if (result != RESULT_OK)
        targets_destroy(out);
    return result;
}

void targets_destroy(Targets *targets)
{
    gl.DeleteFramebuffers(1, &targets->opaque_buffer);
    gl.DeleteFramebuffers(2, targets->peel_buffer);
    gl.DeleteFramebuffers(1, &targets->plain_buffer);
    gl.DeleteFramebuffers(1, &targets->resolve_buffer);
    gl.DeleteTextures(1, &targets->opaque_depth);
    gl.DeleteTextures(GBUFFER_TARGETS, targets->opaque_color);
    gl.DeleteTextures(1, &targets->opaque_code);
    gl.DeleteTextures(1, &targets->previous_code);
    gl.DeleteTextures(2, targets->peel_depth);
    gl.DeleteTextures(GBUFFER_TARGETS, targets->peel_color);
    gl.DeleteTextures(1, &targets->accum);
    gl.DeleteTextures(1, &targets->final);
    gl.DeleteTextures(1, &targets->display);
    *targets = (Targets){0};
}

Result targets_copy_code(Targets *targets, GLuint framebuffer, GLuint code)
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

#include "readback.h"

#include "formats.h"

#include <stdio.h>
#include <string.h>

static void swap_rows(unsigned char *a, unsigned char *b, size_t bytes)
{
    unsigned char block[4096];
    for (size_t at = 0; at < bytes; at += sizeof block) {
        size_t part = bytes - at < sizeof block ? bytes - at : sizeof block;
        memcpy(block, a + at, part);
        memcpy(a + at, b + at, part);
        memcpy(b + at, block, part);
    }
}

static void flip(const Targets *targets, PixelFormat format, void *pixels)
{
    unsigned char *rows = pixels;
    size_t row_bytes = (size_t)targets->width * format_pixel_bytes(format);
    for (int top = 0, bottom = targets->height - 1; top < bottom; top++, bottom--)
        swap_rows(rows + (size_t)top * row_bytes, rows + (size_t)bottom * row_bytes, row_bytes);
}

static void read_pixels(const Targets *targets, PixelFormat format, ReadbackRows rows, void *pixels)
{
    const GlFormat *names = formats_gl(format);
    gl.ReadPixels(0, 0, targets->width, targets->height, names->format, names->type, pixels);
    if (rows == READBACK_TOP_DOWN)
        flip(targets, format, pixels);
}

void readback_color(const Targets *targets, GLuint framebuffer, int attachment, PixelFormat format,
                    ReadbackRows rows, void *pixels)
{
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    gl.NamedFramebufferReadBuffer(framebuffer, GL_COLOR_ATTACHMENT0 + (GLenum)attachment);
    read_pixels(targets, format, rows, pixels);
}

void readback_depth(const Targets *targets, GLuint framebuffer, ReadbackRows rows, void *pixels)
{
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    read_pixels(targets, targets->depth_format, rows, pixels);
    formats_narrow_depth(targets->depth_format, pixels,
                         (size_t)targets->width * (size_t)targets->height);
}

static Result put(const Targets *targets, int peel, const char *what, PixelFormat format,
                  TraceSink *trace, const void *pixels)
{
    char name[48];
    if (peel >= 0)
        return trace_put_peel(trace, peel, what, format, targets->width, targets->height, pixels);
    snprintf(name, sizeof name, "opaque.%s", what);
    return trace_put(trace, name, 0, format, targets->width, targets->height, pixels);
}

Result readback_trace_gbuffer(const Targets *targets, GLuint framebuffer, int peel,
                              TraceSink *trace, void *scratch)
{
    const char *const names[GBUFFER_TARGETS] = {"normal", "position",
                                                targets->lit ? "color" : "diffuse", "material"};
    readback_depth(targets, framebuffer, READBACK_TOP_DOWN, scratch);
    Result result = put(targets, peel, "depth", targets->depth_format, trace, scratch);
    for (int i = 0; i < GBUFFER_TARGETS && result == RESULT_OK; i++) {
        PixelFormat format = targets->color_format[i];
        if (format == FORMAT_NONE)
            continue;
        readback_color(targets, framebuffer, targets->attachment[i], format, READBACK_TOP_DOWN,
                       scratch);
        result = put(targets, peel, names[i], format, trace, scratch);
    }
    return result;
}

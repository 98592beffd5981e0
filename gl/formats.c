#include "formats.h"

static const GlFormat formats[FORMAT_COUNT] = {
    [FORMAT_RGBA32F] = {GL_RGBA32F, GL_RGBA, GL_FLOAT},
    [FORMAT_RGBA16F] = {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT},
    [FORMAT_RGBA16] = {GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT},
    [FORMAT_RGBA8] = {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE},
    [FORMAT_RG16] = {GL_RG16, GL_RG, GL_UNSIGNED_SHORT},
    [FORMAT_RG32F] = {GL_RG32F, GL_RG, GL_FLOAT},
    [FORMAT_D32F] = {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT},
    [FORMAT_D24] = {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT},
    [FORMAT_D16] = {GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT},
    [FORMAT_R32UI] = {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT},
    [FORMAT_R32F] = {GL_R32F, GL_RED, GL_FLOAT},
};

const GlFormat *formats_gl(PixelFormat format)
{
    return &formats[format];
}

void formats_narrow_depth(PixelFormat format, uint32_t *codes, size_t count)
{
    /* The driver widens 24 or 16 bits to 32 by repeating the leading ones. */
    int shift = format == FORMAT_D24 ? 8 : format == FORMAT_D16 ? 16 : 0;
    for (size_t i = 0; shift && i < count; i++)
        codes[i] >>= shift;
}

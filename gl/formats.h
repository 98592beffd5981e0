/* How OpenGL names the stored formats. */
#ifndef PEEL_GL_FORMATS_H
#define PEEL_GL_FORMATS_H

#include "api.h"
#include "number/format.h"

typedef struct GlFormat {
    GLenum internal;     /* of a texture */
    GLenum format, type; /* of pixels sent and read back: the stored bits, 32 of D24 and D16 */
} GlFormat;

const GlFormat *formats_gl(PixelFormat format); /* static */

/* Codes of D24 and D16 as read back, to codes as the format has them; nothing for others. */
void formats_narrow_depth(PixelFormat format, uint32_t *codes, size_t count);

#endif

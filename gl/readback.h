/* Reading buffers back: stored values in their stored formats. */
#ifndef PEEL_GL_READBACK_H
#define PEEL_GL_READBACK_H

#include "frame/trace.h"
#include "targets.h"

typedef enum ReadbackRows {
    READBACK_TOP_DOWN = 0,
    READBACK_BOTTOM_UP
} ReadbackRows;

/* Colour attachment `attachment` of framebuffer, whose format is `format`. pixels: room for
 * width·height pixels of it, tightly packed. */
void readback_color(const Targets *targets, GLuint framebuffer, int attachment, PixelFormat format,
                    ReadbackRows rows, void *pixels);

/* Depth of framebuffer: floats, or the integers of FORMAT_D24 and FORMAT_D16 in uint32_t. */
void readback_depth(const Targets *targets, GLuint framebuffer, ReadbackRows rows, void *pixels);

/* Depth and G-buffer of framebuffer to the trace: under "opaque." for peel −1, else under
 * "peel.K.". scratch: room for width·height pixels of 16 bytes. */
Result readback_trace_gbuffer(const Targets *targets, GLuint framebuffer, int peel,
                              TraceSink *trace, void *scratch);

#endif

/* The history of single pixels, by the definition path itself: the pixel is drawn alone, with all
 * passes of its method, watched and traced, so that what is told is what happens. */
#ifndef PEEL_REF_RETRACE_H
#define PEEL_REF_RETRACE_H

#include "frame/history.h"
#include "frame/pixel_trace.h"

typedef struct Retrace Retrace;

/* Transforms the scene once, for many pixels; scene must outlive *out. Where it depends on the
 * whole frame how many passes there are, that is drawn once. As pipeline_render fails, and
 * UNSUPPORTED with mutations. The caller closes. */
Result retrace_open(const Scene *scene, const RenderDesc *desc, Retrace **out);
void retrace_close(Retrace *retrace); /* NULL is fine */

/* (x, y): from the top left; BAD_INPUT outside the frame. The caller frees *out with history_free,
 * after a failure too. */
Result retrace_pixel(Retrace *retrace, int x, int y, History *out);

/* The same from what another renderer, gl, traced of this pixel: the frame of the same scene and
 * settings. Layers are told by their depths; the sources, which cannot be read back, are lit by
 * ref's formula from the traced G-buffer, or are ref's where no G-buffer is traced. renderer:
 * static. frame: its final and display images. */
Result retrace_traced(Retrace *retrace, const char *renderer, const PixelTrace *trace,
                      const Frame *frame, History *out);

#endif

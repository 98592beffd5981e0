/* What the files of retrace.h share. */
#ifndef PEEL_REF_RETRACE_STATE_H
#define PEEL_REF_RETRACE_STATE_H

#include "ref/pipeline/retrace.h"
#include "ref/pipeline/retrace_fragments.h"

struct Retrace {
    const Scene *scene;
    RenderDesc desc;
    Pass pass;         /* of the whole frame */
    Pool *pool;        /* of one thread, for parts */
    Geometry unculled; /* empty where nothing is culled */
    AllTriangles all;
};

/* Pixels below are from the top left. */

Result retrace_check_pixel(const Retrace *retrace, int x, int y);

/* An empty history with its names. */
History retrace_begin(const Retrace *retrace, const char *renderer, int x, int y);

/* retrace_find_fragments of the whole frame. */
Result retrace_find_at(const Retrace *retrace, int x, int y, History *out);

/* A lit surface and its terms: texel was shaded, and gave source. Flushing mode. */
Result retrace_put_shading(const Pass *pass, History *history, HistorySurface *surface,
                           const ShadeForm *form, const Texel *texel, const float source[4]);

/* The accumulation and the images, and the transmittance in front of the opaque surface. (x, y): in
 * frame. */
void retrace_put_results(const PixelTrace *trace, const Frame *frame, int x, int y, History *out);

#endif

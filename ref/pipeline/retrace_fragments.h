/* Every fragment of a pixel, and what became of each: by what was traced of the pixel's passes. */
#ifndef PEEL_REF_RETRACE_FRAGMENTS_H
#define PEEL_REF_RETRACE_FRAGMENTS_H

#include "frame/history.h"
#include "frame/pixel_trace.h"
#include "ref/pipeline/pass.h"

/* A triangle with corners beyond the near or the far plane. */
typedef struct CutTriangle {
    uint32_t vertex[3], id, draw;
} CutTriangle;

/* All triangles of a scene: those that are culled too, and those that are cut. */
typedef struct AllTriangles {
    const Geometry *geometry; /* of nothing culled */
    CutTriangle *cut;
    size_t cut_count, cut_room;
} AllTriangles;

/* NO_MEMORY on failure; the caller frees cut. geometry: of nothing culled. */
Result retrace_find_cut(const Pass *pass, const Geometry *geometry, AllTriangles *out);

/* Appends the fragments at window pixel (x, y), y up, without fates but for HISTORY_CULLED,
 * HISTORY_CLIPPED and HISTORY_FILL_RULE. Flushing mode. NO_MEMORY on failure. */
Result retrace_find_fragments(const Pass *pass, const AllTriangles *all, int x, int y,
                              History *out);

void retrace_copy(double *out, const float *values, int count);
void retrace_put_surface(const Texel *texel, HistorySurface *out);

/* Whether the pipeline drew it: it is not culled, clipped or its neighbour's. */
static inline bool retrace_drawn(const HistoryFragment *fragment)
{
    return fragment->fate != HISTORY_CULLED && fragment->fate != HISTORY_CLIPPED &&
           fragment->fate != HISTORY_FILL_RULE;
}

/* ---- retrace_fate.c ---- */

/* Gives the drawn fragments their fates and tests. overflowed: a list may have lost some. Flushing
 * mode. NO_MEMORY on failure. */
Result retrace_decide(const Pass *pass, const PixelTrace *trace, bool overflowed, History *out);

#endif

/* How far a pixel's colour may be from the truth's: of exact arithmetic (the truth's own rounding)
 * and of the pipeline in single precision with desc's formats, for a pixel in which both see the
 * same fragments in the same order.
 *
 * Rigorous: every step of the pipeline is bounded from the mesh's floats to the resolved colour
 * (single.h, bound_texture.h, radiance_bound.h, bound_store.h). Infinite where nothing can be said:
 * a piece of a triangle so thin that snapping may turn it, a highlight whose denominator may be 0
 * in single precision. */
#ifndef PEEL_REF_TRUTH_BOUND_H
#define PEEL_REF_TRUTH_BOUND_H

#include "ref/truth/bounded.h"
#include "ref/truth/fragments.h"
#include "ref/truth/radiance_bound.h"

/* A soup's triangles as bounds look at them. The latest are kept, as neighbouring pixels have the
 * same; so every thread has its own. */
typedef struct BoundTriangles BoundTriangles;

size_t bound_triangles_bytes(void);

/* NULL: no memory. soup must outlive it; fused: the pipeline's multiply-adds are. */
BoundTriangles *bound_triangles_create(const Soup *soup, bool fused);

void bound_triangles_destroy(BoundTriangles *triangles);

/* What the lighting pass has of a fragment: interpolated and, but in forward methods, stored in the
 * G-buffer. (x, y): its pixel, y up. */
void bound_surface(BoundTriangles *triangles, const RenderDesc *desc, const Fragment *fragment,
                   int x, int y, BoundedSurface *surface);

/* What may be of a triangle at a pixel, y up: whether its pieces, snapped by any rounding, may
 * cover the centre, and whether they must; which window depths its plane, and the pipeline in
 * desc's format, may have there. Not certain either where a texture's alpha, or a facing that
 * depends on rounding, may discard it. */
typedef struct BoundFragment {
    bool possible, certain;
    double exact[2], stored[2]; /* least and greatest; −∞ and ∞ where nothing can be said */
} BoundFragment;

void bound_fragment(BoundTriangles *triangles, const RenderDesc *desc, uint32_t triangle, int x,
                    int y, BoundFragment *out);

/* Whether the pipeline may have two fragments of a triangle at a pixel, y up. */
bool bound_may_repeat(BoundTriangles *triangles, uint32_t triangle, int x, int y);

/* Puts a fragment behind rgba, colour so far and transmittance: (0, 0, 0, 1) to begin with. */
void bound_blend(BoundTriangles *triangles, const RenderDesc *desc, const Fragment *fragment, int x,
                 int y, Bounded rgba[4]);

/* Linear RGB over the background and coverage, from the above. */
void bound_resolve(const View *view, PixelFormat accum, Bounded rgba[4]);

#endif

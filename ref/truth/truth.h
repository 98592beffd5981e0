/* The ground truth: every fragment, sorted by exact depth, shaded and composited in double.
 *
 * Shares its inputs with the pipelines (the scene's floats, the view's float matrices and lights)
 * and none of their rasterizing, sorting, shading or blending. Coverage follows the GL contract
 * (clipped pieces snapped to 1/256 pixel); depth and attributes are those of the exact, unclipped,
 * unsnapped triangle at the pixel's centre. No pass limit, no stored formats: desc's method,
 * passes, depth, accum, gbuffer, position, peel_test, ggx, opaque_blend and unfused change nothing.
 *
 * Textures are sampled at exact, perspective-correct uv. At the borders of nearest texels, of a
 * mask's holes, and where alpha crosses SHADING_ALPHA_TEST, the picture jumps; a pixel whose centre
 * lies within single precision of one may be on the other side of it in the pipelines.
 *
 * The order is certain: depths are compared as exact numbers of the floats that all renderers share
 * (plane.h, order.h), and equal ones are equal by proof. What is shaded is computed in double.
 * Source: Carpenter, "The A-buffer, an Antialiased Hidden Surface Method", SIGGRAPH 1984. */
#ifndef PEEL_REF_TRUTH_H
#define PEEL_REF_TRUTH_H

#include "frame/frame.h"

/* See Renderer. The trace receives opaque.primitive and peel.K.primitive by rectangles (steps 0
 * and K + 1), nothing else; a layer that a rectangle does not have is not sent for it. The same
 * bits for any number of threads.
 *
 * Memory: the triangles' corners, the list of triangles of each tile, the images, and one tile's
 * fragments per worker; NO_MEMORY naming the need when that exceeds desc->max_memory.
 *
 * out->layers.coverage_differs counts (triangle, pixel) pairs where snapped coverage, which makes
 * the picture, and unsnapped coverage (the exact triangle within the view volume, same tie rule)
 * disagree, and the fragment matters where it exists: it is transparent and in front of the
 * nearest opaque fragment, or is that fragment. A pixel that snapping hands from one triangle to
 * its neighbour counts twice.
 *
 * out->layers.ties counts transparent fragments whose depth is exactly that of the fragment in front
 * of them at their pixel, or that are hidden by an opaque fragment at exactly their depth.
 * comparisons and exact_comparisons count what it took; drawing order changes them. */
Result truth_render(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out);

#endif

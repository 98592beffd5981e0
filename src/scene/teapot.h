/* The Utah teapot, tessellated from its Bézier patches. */
#ifndef PEEL_SCENE_TEAPOT_H
#define PEEL_SCENE_TEAPOT_H

#include "scene/scene.h"

/* 1.2 units high, y up, its base centred on the origin, spout towards +x; 9,312 triangles.
 * Vertices are shared where position and normal agree; triangles that the patches collapse at the
 * poles are left out; normals are the surface's own, of unit length. The lid does not touch the
 * rim, as in the original: the surface is not closed.
 * The caller frees *out (shapes_free). NO_MEMORY is the only failure.
 *
 * Source of the control points: M. Newell, "The Utilization of Procedure Models in Digital Image
 * Synthesis", PhD thesis, University of Utah, 1975, with the bottom that F. Crow published in "The
 * Origins of the Teapot", IEEE Computer Graphics and Applications 7(1), 1987: 32 patches of 306
 * points, given here as the curves they are made of. */
Result teapot_mesh(Mesh *out);

#endif

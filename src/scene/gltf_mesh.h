/* One primitive from Assimp to a Mesh. */
#ifndef PEEL_SCENE_GLTF_MESH_H
#define PEEL_SCENE_GLTF_MESH_H

#include "scene/scene.h"

struct aiMesh;

/* triangles: how many the file has; Assimp drops those with an index out of range, which is
 * refused here. Vertices that no triangle uses are left out (Assimp repeats a vertex array for
 * every primitive that shares it), the order of the rest is kept; without normals every triangle
 * gets its own vertices and its flat normal, as glTF demands (0 0 1 where it has no area).
 * label names the primitive in messages. The caller frees *out; BAD_INPUT or NO_MEMORY leave it
 * empty. Texture coordinates come back from Assimp's 1 − v, to within 2^-25. */
Result gltf_mesh_convert(const struct aiMesh *from, size_t triangles, const char *label, Mesh *out);

#endif

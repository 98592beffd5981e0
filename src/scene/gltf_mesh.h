/* One primitive from Assimp to a Mesh. */
#ifndef PEEL_SCENE_GLTF_MESH_H
#define PEEL_SCENE_GLTF_MESH_H

#include "scene/scene.h"

struct aiMesh;

/* triangles: how many the file has; Assimp drops those with an index out of range, which is
 * refused here. Vertices that no triangle uses are left out (Assimp repeats a vertex array for
 * every primitive that shares it), the order of the rest is kept; without normals every triangle
 * gets its own vertices and its flat normal, as glTF demands (0 0 1 where it has no area).
 * uv: 2 per vertex of the file, or NULL; Assimp's own (1 − v, rounded) are not used. Its vertices
 * are the file's, in the file's order, whatever the indices: checked by their count, and by
 * test_gltf_texture. label names the primitive in messages. The caller frees *out; BAD_INPUT or
 * NO_MEMORY leave it empty. */
Result gltf_mesh_convert(const struct aiMesh *from, size_t triangles, const float *uv,
                         const char *label, Mesh *out);

#endif

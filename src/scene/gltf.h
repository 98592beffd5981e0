/* glTF 2.0 in (through Assimp) and out (our own writer). */
#ifndef PEEL_SCENE_GLTF_H
#define PEEL_SCENE_GLTF_H

#include "scene/scene.h"

/* Loads a .gltf or .glb file. Geometry is unaltered: triangulated only, vertex arrays shared as
 * in the file. Missing normals are made flat, as glTF demands. A scene without cameras gets a
 * framing camera, one without lights the default lights. What the file has and Peel does not
 * model is named in one warning.
 * Extras (on nodes; the only ones Assimp passes on): see data/scenes/README or gltf_write.
 * Fails with BAD_INPUT, IO, NO_MEMORY or UNSUPPORTED and a one-line message; *out is then empty. */
Result gltf_load(const char *path, Scene *out);

/* Writes .gltf (buffers embedded) or .glb by the extension, to a temporary name, then renames. */
Result gltf_write(const Scene *scene, const char *path);

#endif

/* Assimp's C API, given a reduced document and nothing else that it could misread. */
#ifndef PEEL_SCENE_GLTF_ASSIMP_H
#define PEEL_SCENE_GLTF_ASSIMP_H

#include "scene/gltf_json.h"

struct aiScene;

/* Imports what gltf_json_reduced leaves of the document, external buffers relative to path; no
 * post-processing. *out is released with gltf_assimp_release. BAD_INPUT with Assimp's message. */
Result gltf_assimp_import(const char *path, const GltfJson *json, const struct aiScene **out);
void gltf_assimp_release(const struct aiScene *scene); /* NULL is fine */

#endif

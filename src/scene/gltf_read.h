/* A glTF 2.0 file to its checked JSON. */
#ifndef PEEL_SCENE_GLTF_READ_H
#define PEEL_SCENE_GLTF_READ_H

#include "scene/gltf_json.h"

/* Reads and checks a file: every reference and extent that geometry and nodes rest on, nodes form
 * a tree. BAD_INPUT, IO, NO_MEMORY, UNSUPPORTED (version 1, a required extension that changes the
 * geometry); *out is then empty. Free with gltf_json_free. */
Result gltf_read(const char *path, GltfJson *out);

#endif

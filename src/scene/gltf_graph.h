/* The checks of scenes, nodes, cameras and lights. */
#ifndef PEEL_SCENE_GLTF_GRAPH_H
#define PEEL_SCENE_GLTF_GRAPH_H

#include "scene/gltf_json.h"

/* Checks what hangs on the scene to draw, after gltf_check; sets json's scene and notes. */
Result gltf_graph_check(const char *path, GltfJson *json);

#endif

/* The checks of buffers, accessors and meshes, and what all checks are made with. The first breach
 * is the message. */
#ifndef PEEL_SCENE_GLTF_CHECK_H
#define PEEL_SCENE_GLTF_CHECK_H

#include "scene/gltf_json.h"

/* What a check needs to know and to name. */
typedef struct GltfCheck {
    const char *path;
    GltfJson *json;
} GltfCheck;

/* Checks json->root but for its graph, sets its notes. */
Result gltf_check(const char *path, GltfJson *json);

/* BAD_INPUT, "PATH: WHAT INDEX: expected EXPECTED". */
Result gltf_fail(const GltfCheck *check, const char *what, size_t index, const char *expected);

/* A member of the top level and how many elements it has. */
const json_t *gltf_array(const GltfCheck *check, const char *key);
size_t gltf_count(const GltfCheck *check, const char *key);

bool gltf_valid_index(const json_t *value, size_t limit); /* absent, or an integer below limit */
bool gltf_required_index(const json_t *object, const char *key, size_t limit);
bool gltf_valid_numbers(const json_t *value, size_t count); /* absent, or count numbers */
void gltf_note(const GltfCheck *check, GltfNote which);

#endif

/* The JSON of a checked glTF 2.0 file: looked up, and reduced to what Peel models.
 *
 * Assimp 5.2.5 trusts its input in places (a skin without matrices, a line loop without a valid
 * index and a nested graph crash or hang it), drops triangles with bad indices behind a log line,
 * and loses what its scene has no place for (no zfar, which node holds which light). So it is
 * given only geometry, materials and nodes, after gltf_read has checked them; the rest is taken
 * from here.
 *
 * Source: glTF 2.0 specification, chapters 3 to 5; KHR_lights_punctual. */
#ifndef PEEL_SCENE_GLTF_JSON_H
#define PEEL_SCENE_GLTF_JSON_H

#include "base/result.h"

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

/* A primitive's mode: those from triangles to fan are drawn. */
enum {
    MODE_TRIANGLES = 4,
    MODE_FAN = 6
};

/* An accessor's componentType. */
enum {
    TYPE_INT8 = 5120,
    TYPE_UINT8,
    TYPE_INT16,
    TYPE_UINT16,
    TYPE_UINT32 = 5125,
    TYPE_FLOAT
};

enum {
    GLTF_STRIDE_END = 253 /* a byteStride is less */
};

/* GL's names for what a sampler may say. */
enum {
    FILTER_NEAREST = 9728,
    FILTER_LINEAR,
    SAMPLER_REPEAT = 10497,
    SAMPLER_CLAMP = 33071,
    SAMPLER_MIRROR = 33648
};

/* What a file may have and Peel does not model; a bit each. */
typedef enum GltfNote {
    NOTE_TEXTURES = 0,
    NOTE_IMAGES,
    NOTE_TEXTURE_TRANSFORMS,
    NOTE_EMISSIVE,
    NOTE_COLORS,
    NOTE_UVS,
    NOTE_NO_UVS,
    NOTE_POINTS_LINES,
    NOTE_MORPHS,
    NOTE_SKINS,
    NOTE_ANIMATIONS,
    NOTE_ORTHOGRAPHIC,
    NOTE_DIRECTIONAL,
    NOTE_SPOT,
    NOTE_SCENES,
    NOTE_COUNT
} GltfNote;

typedef struct GltfJson {
    json_t *root;
    size_t scene;          /* index of the scene to draw */
    unsigned char *binary; /* the BIN chunk, in `file`; NULL if there is none */
    size_t binary_count;
    unsigned char *file;
    uint32_t notes; /* 1 << GltfNote */
} GltfJson;

void gltf_json_free(GltfJson *json); /* what gltf_read made */

/* A new document with nothing but triangles, materials' factors and nodes. The indices of nodes,
 * meshes and materials are kept; the uri of a buffer is its index, and its byteLength may be up to
 * GLTF_STRIDE_END more than it has. Without memory it may lack parts: see base/json_memory.h. */
json_t *gltf_json_reduced(const GltfJson *json);

/* One warning that names everything noted, extensions included; silent when there is nothing. */
void gltf_json_warn(const GltfJson *json, const char *path);

/* Whether a primitive is drawn: triangles, strips and fans. */
bool gltf_json_drawn(const json_t *primitive);

/* The element of the top-level array `key`; NULL when there is none. */
json_t *gltf_json_element(const GltfJson *json, const char *key, size_t index);

/* The size of a componentType; 0 for an unknown one. */
size_t gltf_json_component_bytes(size_t type);

/* A checked non-negative integer member, or fallback. */
size_t gltf_json_index(const json_t *object, const char *key, size_t fallback);

#endif

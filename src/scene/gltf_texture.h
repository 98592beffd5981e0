/* A document's textures to the scene's. */
#ifndef PEEL_SCENE_GLTF_TEXTURE_H
#define PEEL_SCENE_GLTF_TEXTURE_H

#include "scene/builder.h"
#include "scene/gltf_bytes.h"
#include "scene/texture.h"

#define GLTF_TEXTURE_MAX_TEXELS ((uint64_t)1 << 28) /* of a whole file */

/* What a texture of ours is made of: equal keys give one texture. */
typedef struct GltfTextureKey {
    size_t image;
    TextureEncoding encoding;
    TextureWrap wrap_s, wrap_t;
    bool nearest;
    uint32_t texture; /* 1 + ours */
} GltfTextureKey;

typedef struct GltfTextures {
    GltfBytes *bytes;
    GltfTextureKey *keys;
    size_t key_count, key_room;
    uint64_t texels; /* so far */
} GltfTextures;

void gltf_texture_free(GltfTextures *textures); /* the keys only */

/* The texture that a checked texture info names, decoded once: 1 + its index in the builder's
 * scene. info NULL gives 0, and so does a failure, which the builder keeps: BAD_INPUT for broken
 * images and more than GLTF_TEXTURE_MAX_TEXELS in all, IO, NO_MEMORY. */
uint32_t gltf_texture_add(GltfTextures *textures, Builder *builder, const json_t *info,
                          TextureEncoding encoding);

#endif

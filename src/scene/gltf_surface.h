/* The checks of materials, textures, samplers and images, and which textures a material uses. */
#ifndef PEEL_SCENE_GLTF_SURFACE_H
#define PEEL_SCENE_GLTF_SURFACE_H

#include "scene/gltf_check.h"

/* Every material, texture, sampler and image; sets notes for what is not modelled. */
Result gltf_surface_check(const GltfCheck *check);

/* The texture info at key, "baseColorTexture" or "metallicRoughnessTexture", of a checked material
 * (NULL is glTF's default material); NULL where there is none or it is left out: its texture has no
 * image that core glTF knows, or it wants other texture coordinates than the base colour's. */
const json_t *gltf_surface_texture(const GltfJson *json, const json_t *material, const char *key);

/* The attribute that holds the texture coordinates of a primitive's material: "TEXCOORD_0" unless
 * its textures say otherwise. Whether it has any texture. */
enum {
    UV_NAME_SIZE = 32
};
bool gltf_surface_uv_name(const GltfJson *json, const json_t *primitive, char out[UV_NAME_SIZE]);

#endif

/* The scene's textures to a document's. */
#ifndef PEEL_SCENE_GLTF_TEXTURE_WRITE_H
#define PEEL_SCENE_GLTF_TEXTURE_WRITE_H

#include "scene/scene.h"

#include <jansson.h>

/* A document's arrays; an image, a sampler and a texture each with the same index. */
typedef struct GltfTextureArrays {
    json_t *images, *samplers, *textures;
    uint32_t *index[2]; /* by TextureEncoding: 1 + the document's index of each of the scene's
                           textures; 0 where no material uses it so */
} GltfTextureArrays;

/* Where images go in a binary file; put is NULL for data uris. */
typedef struct GltfImageSink {
    Result (*put)(void *context, const unsigned char *bytes, size_t count, size_t *view);
    void *context;
} GltfImageSink;

/* Every texture that a material uses, as an embedded PNG of 8 bits. What 8 bits do not hold is
 * rounded, with a warning that begins with path. Free with gltf_texture_write_free, after a failure
 * too. NO_MEMORY, or UNSUPPORTED for more texels than a PNG holds here. */
Result gltf_texture_write(const Scene *scene, const char *path, const GltfImageSink *sink,
                          GltfTextureArrays *out);
void gltf_texture_write_free(GltfTextureArrays *arrays);

#endif

/* The scene's meshes and lights in the driver's memory. */
#ifndef PEEL_GL_UPLOAD_H
#define PEEL_GL_UPLOAD_H

#include "context.h"
#include "frame/needs.h"

/* Where a mesh lies in the shared buffers. */
typedef struct MeshRange {
    uint32_t first_index;
    uint32_t index_count;
    int32_t base_vertex;
} MeshRange;

/* All meshes in one vertex array: attribute 0 position, and where they are needed 1 normal, 2 uv;
 * 32-bit indices. */
typedef struct Meshes {
    GLuint vertex_array, vertices, indices;
    MeshRange *ranges; /* one per mesh of the scene */
    size_t bytes;      /* of the buffers */
} Meshes;

/* UNSUPPORTED when the scene has more than 2^31 − 1 vertices or indices. */
Result upload_meshes(Context *context, const Scene *scene, const Needs *needs, Meshes *out);
void upload_free_meshes(Meshes *meshes); /* leaves an empty one */

/* The lights as three vec4 each, in a uniform block, or where they do not fit, a storage block. */
typedef struct LightBuffer {
    GLuint buffer; /* 0 without lights */
    bool storage;
    bool ranges; /* some light has one */
    size_t bytes;
} LightBuffer;

/* UNSUPPORTED when there are more lights than a storage block of the driver's holds. */
Result upload_lights(Context *context, const View *view, LightBuffer *out);
void upload_free_lights(LightBuffer *lights);

/* The scene's textures as RGBA32F, level 0. */
typedef struct Textures {
    GLuint *names; /* 0 of one that is not wanted */
    size_t count, bytes;
} Textures;

/* wanted: see needs_textures. NO_MEMORY when used bytes and the textures need more than
 * desc->max_memory (4 GiB if 0), BAD_INPUT when a texture is larger than the driver's. */
Result upload_textures(Context *context, const Scene *scene, const bool *wanted,
                       const RenderDesc *desc, size_t used, Textures *out);
void upload_free_textures(Textures *textures);

#endif

/* The packed G-buffer node of a linked list of fragments, the same in every renderer.
 *
 * 16 bytes, and 24 where the scene has textures: without them the material follows from the
 * primitive, so that a small table of materials takes the place of the last two words. Diffuse and
 * material are rounded as the compact G-buffer stores them.
 *
 * Source: A. Breust, "Deep Deferred Renderer". */
#ifndef PEEL_FRAME_NODE_H
#define PEEL_FRAME_NODE_H

#include "frame/view.h"

/* 32-bit words of a node. */
enum {
    NODE_NEXT,      /* index of the next node, or NODE_NONE */
    NODE_DEPTH,     /* gl_FragCoord.z, bits of a float */
    NODE_NORMAL,    /* octahedral, FORMAT_RG16 */
    NODE_PRIMITIVE, /* its id */
    NODE_WORDS,
    NODE_DIFFUSE = NODE_WORDS, /* FORMAT_RGBA8, with alpha */
    NODE_MATERIAL,             /* FORMAT_RGBA8: roughness, metallic, occlusion, 1 */
    NODE_WORDS_TEXTURED
};
#define NODE_NONE UINT32_MAX
/* gl's lists: room before the nodes are counted, a pixel; words before the pixels' heads. */
enum {
    NODES_GUESSED = 4,
    NODES_HEADER_WORDS = 4
};

/* Words of a node of this scene. */
static inline uint32_t node_words(const Scene *scene)
{
    return scene->texture_count > 0 ? NODE_WORDS_TEXTURED : NODE_WORDS;
}

/* Of the primitives from first_primitive up to the next entry's. 16 bytes: a uvec4. */
typedef struct NodeMaterial {
    uint32_t first_primitive, diffuse, material, padding;
} NodeMaterial;

/* The transparent draws' materials, by primitive id. *out: at least one element; the caller frees
 * it. *count may be 0. */
Result node_materials(const Scene *scene, const View *view, NodeMaterial **out, uint32_t *count);

/* The entry of a primitive; count > 0. */
static inline const NodeMaterial *node_material(const NodeMaterial *entries, uint32_t count,
                                                uint32_t primitive)
{
    uint32_t low = 0;
    while (count - low > 1) {
        uint32_t middle = low + (count - low) / 2;
        if (entries[middle].first_primitive <= primitive)
            low = middle;
        else
            count = middle;
    }
    return &entries[low];
}

#endif

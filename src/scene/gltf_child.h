/* gltf_load in a process of its own: whatever a broken file makes of Assimp or of the decoders of
 * its images, the caller gets a scene or a line that says why not. */
#ifndef PEEL_SCENE_GLTF_CHILD_H
#define PEEL_SCENE_GLTF_CHILD_H

#include "base/child.h"
#include "scene/scene.h"

/* What loading may take. max_memory: in bytes; 0: GLTF_CHILD_MEMORY and GLTF_CHILD_PER_BYTE times
 * the bytes of the file and of those that it names, GLTF_CHILD_MEMORY_MAX at most. Time grows with
 * the memory: GLTF_CHILD_SECONDS for each GiB that was begun. */
#define GLTF_CHILD_MEMORY     ((uint64_t)1 << 30)
#define GLTF_CHILD_MEMORY_MAX ((uint64_t)4 << 30)
enum {
    GLTF_CHILD_PER_BYTE = 128, /* a JPEG of 16 pixels a byte, at 16 bytes a texel, is half of it */
    GLTF_CHILD_SECONDS = 10
};
ChildLimits gltf_child_limits(uint64_t bytes, size_t max_memory);

/* As gltf_load, but also BAD_INPUT when the child crashes or takes too long, and NO_MEMORY when it
 * needs more than it may. The caller must have no other thread. */
Result gltf_child_load(const char *path, size_t max_memory, Scene *out);

#endif

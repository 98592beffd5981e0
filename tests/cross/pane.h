/* One square, for scenes of a few surfaces. */
#ifndef PEEL_TESTS_PANE_H
#define PEEL_TESTS_PANE_H

#include "base/memory.h"
#include "scene/scene.h"

#include <string.h>

/* From −half to half in x and y, at z, with one normal. The caller frees it with its scene. */
static inline Mesh pane_mesh(float half, float z, const float normal[3])
{
    static const uint32_t index[] = {0, 1, 2, 0, 2, 3};
    const float position[] = {-half, -half, z, half, -half, z, half, half, z, -half, half, z};
    Mesh mesh = {.vertex_count = 4, .triangle_count = 2};
    mesh.position = memory_array(12, sizeof(float));
    mesh.normal = memory_array(12, sizeof(float));
    mesh.index = memory_array(6, sizeof(uint32_t));
    memcpy(mesh.position, position, sizeof position);
    memcpy(mesh.index, index, sizeof index);
    for (int i = 0; i < 4; i++)
        memcpy(mesh.normal + 3 * i, normal, 3 * sizeof *normal);
    return mesh;
}

#endif

/* Scenes of transparent layers that fill the window, before an opaque one. */
#ifndef PEEL_TESTS_LAYERS_H
#define PEEL_TESTS_LAYERS_H

#include "scene/scene.h"

#include <math.h>
#include <string.h>

enum {
    LAYERS_MAX = 16
};

typedef struct Layers {
    Scene scene;
    Mesh mesh;
    float position[12], normal[12];
    uint32_t index[6];
    Material materials[LAYERS_MAX + 1];
    Instance instances[LAYERS_MAX + 1];
    Light light;
    Camera camera;
} Layers;

static inline void layers_square(Layers *layers)
{
    static const float x[4] = {-40, 40, 40, -40}, y[4] = {-40, -40, 40, 40};
    static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
    for (int i = 0; i < 4; i++) {
        layers->position[3 * i] = x[i];
        layers->position[3 * i + 1] = y[i];
        layers->normal[3 * i + 2] = 1.0f;
    }
    memcpy(layers->index, corners, sizeof corners);
    layers->mesh = (Mesh){.vertex_count = 4,
                          .triangle_count = 2,
                          .position = layers->position,
                          .normal = layers->normal,
                          .index = layers->index};
}

/* Layer i at view depth depths[i], drawn in that order; each has a colour and an alpha of its own.
 * Nothing to free; do not copy. */
static inline void layers_make(int count, const double *depths, Layers *out)
{
    memset(out, 0, sizeof *out);
    layers_square(out);
    for (int i = 0; i <= count; i++) {
        bool opaque = i == count;
        out->materials[i] = (Material){
            .name = "",
            .base_color = {0.1f + 0.05f * (float)(i * 7 % 16), 0.1f + 0.05f * (float)(i * 5 % 16),
                           0.1f + 0.05f * (float)(i * 11 % 16),
                           opaque ? 1.0f : 0.2f + 0.04f * (float)(i * 3 % 16)},
            .roughness = 0.5f,
            .occlusion = 1.0f,
            .alpha_mode = opaque ? ALPHA_OPAQUE : ALPHA_BLEND};
        out->instances[i] = (Instance){.name = "",
                                       .mesh = 0,
                                       .material = (uint32_t)i,
                                       .world = matrix_translate(0, 0, opaque ? -40 : -depths[i])};
    }
    out->light = (Light){.position = {3, 4, 0}, .color = {9, 8, 7}, .attenuation = {1, 0.1f, 0.1f}};
    out->camera = (Camera){
        .name = "", .world = matrix_identity(), .yfov = 0.8, .near = 0.125, .far = INFINITY};
    out->scene = (Scene){.name = "layers",
                         .mesh_count = 1,
                         .material_count = (size_t)count + 1,
                         .instance_count = (size_t)count + 1,
                         .light_count = 1,
                         .camera_count = 1,
                         .meshes = &out->mesh,
                         .materials = out->materials,
                         .instances = out->instances,
                         .lights = &out->light,
                         .cameras = &out->camera,
                         .ambient = {0.25f, 0.25f, 0.25f},
                         .background = {0.2f, 0.3f, 0.4f}};
}

/* Drawn in no order of depth. */
static inline void layers_ladder(int count, Layers *out)
{
    double depths[LAYERS_MAX] = {0};
    for (int i = 0; i < count; i++)
        depths[i] = 2.0 + 0.5 * (i * 5 % 17);
    layers_make(count, depths, out);
}

#endif

/* Scenes as a program of somebody else's would hand them to libpeel: arrays. */
#ifndef PEEL_TESTS_LIBRARY_SCENES_H
#define PEEL_TESTS_LIBRARY_SCENES_H

#include "library_calls.h"
#include "scene/scene.h"

#include <math.h>

static const float positions[12] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
static const float normals[12] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
static const float uvs[8] = {0, 1, 1, 1, 1, 0, 0, 0};
static const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
static const uint8_t codes[16] = {255, 0, 0,   255, 0,   255, 0,   255,
                                  0,   0, 255, 255, 128, 128, 128, 255};
static const double nearer[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.25, 0, 0.5, 1};

/* A pane of glass in front of a textured, opaque square; every part is the test's to spoil. */
typedef struct Small {
    PeelMesh mesh;
    PeelTexture texture;
    PeelMaterial materials[2];
    PeelInstance instances[2];
    PeelLight light;
    PeelCamera camera;
    PeelSceneDesc desc;
} Small;

static inline void small_scene(Small *out)
{
    *out = (Small){
        .mesh = {4, 2, positions, normals, uvs, indices},
        .texture = {.width = 2, .height = 2, .codes = codes, .srgb = true},
        .materials = {{.base_color = {1, 1, 1, 1},
                       .roughness = 0.5f,
                       .occlusion = 1,
                       .base_color_texture = 1},
                      {.base_color = {0.5f, 0.25f, 0.125f, 0.5f},
                       .roughness = 0.5f,
                       .occlusion = 1,
                       .alpha_mode = PEEL_TRANSPARENT}},
        .instances = {{0, 0, NULL}, {0, 1, nearer}},
        .light = {.position = {1, 2, 3}, .color = {5, 5, 5}, .attenuation = {1, 0, 0}},
        .camera = {.eye = {0, 0, 4},
                   .up = {0, 1, 0},
                   .yfov = 0.7,
                   .near_plane = 1,
                   .far_plane = INFINITY},
    };
    out->desc = (PeelSceneDesc){.mesh_count = 1,
                                .texture_count = 1,
                                .material_count = 2,
                                .instance_count = 2,
                                .light_count = 1,
                                .camera_count = 1,
                                .meshes = &out->mesh,
                                .textures = &out->texture,
                                .materials = out->materials,
                                .instances = out->instances,
                                .lights = &out->light,
                                .cameras = &out->camera,
                                .ambient = {0.25f, 0.25f, 0.25f}};
}

static inline PeelScene *create(const Small *small)
{
    PeelScene *scene = NULL;
    GOOD(peel_scene_create(&small->desc, &scene));
    return scene;
}

/* A built-in scene, as arrays: what somebody's own loader would hand over. */
typedef struct Arrays {
    PeelMesh *meshes;
    PeelTexture *textures;
    PeelMaterial *materials;
    PeelInstance *instances;
    PeelLight *lights;
    PeelCamera *cameras;
    PeelSceneDesc desc;
} Arrays;

static inline void *rows(size_t count, size_t size)
{
    void *array = calloc(count + 1, size);
    ck_assert_ptr_nonnull(array);
    return array;
}

static inline void show_meshes(const Scene *scene, Arrays *out)
{
    out->meshes = rows(scene->mesh_count, sizeof *out->meshes);
    for (size_t i = 0; i < scene->mesh_count; i++) {
        const Mesh *from = &scene->meshes[i];
        out->meshes[i] =
            (PeelMesh){from->vertex_count, from->triangle_count, from->position, from->normal,
                       from->uv,           from->index};
    }
    out->textures = rows(scene->texture_count, sizeof *out->textures);
    for (size_t i = 0; i < scene->texture_count; i++) {
        const Texture *from = &scene->textures[i];
        out->textures[i] = (PeelTexture){.width = from->width,
                                         .height = from->height,
                                         .texels = from->texels,
                                         .nearest = from->nearest,
                                         .wrap_s = (PeelWrap)from->wrap_s,
                                         .wrap_t = (PeelWrap)from->wrap_t};
    }
}

static inline void show_surfaces(const Scene *scene, Arrays *out)
{
    out->materials = rows(scene->material_count, sizeof *out->materials);
    for (size_t i = 0; i < scene->material_count; i++) {
        const Material *from = &scene->materials[i];
        PeelMaterial *to = &out->materials[i];
        *to = (PeelMaterial){.roughness = from->roughness,
                             .metallic = from->metallic,
                             .occlusion = from->occlusion,
                             .alpha_mode = (PeelAlphaMode)from->alpha_mode,
                             .alpha_cutoff = from->alpha_cutoff,
                             .double_sided = from->double_sided,
                             .base_color_texture = from->base_color_texture,
                             .metallic_roughness_texture = from->metallic_roughness_texture};
        memcpy(to->base_color, from->base_color, sizeof to->base_color);
    }
    out->instances = rows(scene->instance_count, sizeof *out->instances);
    for (size_t i = 0; i < scene->instance_count; i++) {
        const Instance *from = &scene->instances[i];
        out->instances[i] = (PeelInstance){from->mesh, from->material, from->world.m};
    }
}

static inline void show(const Scene *scene, Arrays *out)
{
    *out = (Arrays){0};
    show_meshes(scene, out);
    show_surfaces(scene, out);
    out->lights = rows(scene->light_count, sizeof *out->lights);
    for (size_t i = 0; i < scene->light_count; i++) {
        const Light *from = &scene->lights[i];
        out->lights[i].range = from->range;
        memcpy(out->lights[i].position, from->position, sizeof from->position);
        memcpy(out->lights[i].color, from->color, sizeof from->color);
        memcpy(out->lights[i].attenuation, from->attenuation, sizeof from->attenuation);
    }
    out->cameras = rows(scene->camera_count, sizeof *out->cameras);
    for (size_t i = 0; i < scene->camera_count; i++) {
        const Camera *from = &scene->cameras[i];
        out->cameras[i] = (PeelCamera){.world = from->world.m,
                                       .yfov = from->yfov,
                                       .near_plane = from->near,
                                       .far_plane = from->far};
    }
    out->desc = (PeelSceneDesc){scene->mesh_count,
                                scene->texture_count,
                                scene->material_count,
                                scene->instance_count,
                                scene->light_count,
                                scene->camera_count,
                                out->meshes,
                                out->textures,
                                out->materials,
                                out->instances,
                                out->lights,
                                out->cameras,
                                {0},
                                {0}};
    memcpy(out->desc.ambient, scene->ambient, sizeof scene->ambient);
    memcpy(out->desc.background, scene->background, sizeof scene->background);
}

static inline void hide(Arrays *arrays)
{
    free(arrays->meshes);
    free(arrays->textures);
    free(arrays->materials);
    free(arrays->instances);
    free(arrays->lights);
    free(arrays->cameras);
}

#endif

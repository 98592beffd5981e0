/* Fills a Scene piece by piece, for generators and loaders. The first failure sticks: later calls
 * do nothing and builder_finish returns it, so that callers need not check each step. */
#ifndef PEEL_SCENE_BUILDER_H
#define PEEL_SCENE_BUILDER_H

#include "scene/scene.h"

typedef struct Builder {
    Scene scene;
    Result result; /* with its message already recorded */
    size_t mesh_room, texture_room, material_room, instance_room, light_room, camera_room;
} Builder;

/* An empty scene with ambient light 0.25 and a black background; name is copied. */
Builder builder_begin(const char *name);

/* made: what the maker of *mesh returned; the builder takes the mesh over even on failure and
 * empties *mesh. Returns its index. */
uint32_t builder_mesh(Builder *builder, Result made, Mesh *mesh);

/* Likewise; the index + 1 is returned, as Material wants it. */
uint32_t builder_texture(Builder *builder, Result made, Texture *texture);

/* These copy what they are given, names included (NULL is ""); the index is returned. */
uint32_t builder_material(Builder *builder, const Material *material, const char *name);
void builder_instance(Builder *builder, const Instance *instance, const char *name);
void builder_light(Builder *builder, const Light *light);
void builder_camera(Builder *builder, const Camera *camera, const char *name);

/* Validates and hands over the scene, or frees it and leaves *out empty. */
Result builder_finish(Builder *builder, Scene *out);

#endif

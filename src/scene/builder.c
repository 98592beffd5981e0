#include "scene/builder.h"

#include "base/memory.h"
#include "scene/shapes.h"

#include <stdlib.h>
#include <string.h>

static char *copy_name(Builder *builder, const char *name)
{
    char *copy = strdup(name ? name : "");
    if (!copy)
        builder->result = result_fail(RESULT_NO_MEMORY, "out of memory: a name");
    return copy;
}

/* Makes room for one more element in a scene array; false after a failure. */
static bool grow(Builder *builder, void **array, size_t *room, size_t count, size_t size)
{
    if (!builder->result)
        builder->result = memory_grow(array, room, count + 1, size);
    return !builder->result;
}

Builder builder_begin(const char *name)
{
    Builder builder = {.scene = {.ambient = {0.25f, 0.25f, 0.25f}}};
    builder.scene.name = copy_name(&builder, name);
    return builder;
}

uint32_t builder_mesh(Builder *builder, Result made, Mesh *mesh)
{
    Scene *scene = &builder->scene;
    if (!builder->result)
        builder->result = made;
    void *array = scene->meshes;
    if (grow(builder, &array, &builder->mesh_room, scene->mesh_count, sizeof *mesh)) {
        scene->meshes = array;
        scene->meshes[scene->mesh_count++] = *mesh;
        *mesh = (Mesh){0};
        return (uint32_t)(scene->mesh_count - 1);
    }
    shapes_free(mesh);
    return 0;
}

uint32_t builder_texture(Builder *builder, Result made, Texture *texture)
{
    Scene *scene = &builder->scene;
    if (!builder->result)
        builder->result = made;
    void *array = scene->textures;
    if (grow(builder, &array, &builder->texture_room, scene->texture_count, sizeof *texture)) {
        scene->textures = array;
        scene->textures[scene->texture_count++] = *texture;
        *texture = (Texture){0};
        return (uint32_t)scene->texture_count;
    }
    free(texture->texels);
    *texture = (Texture){0};
    return 0;
}

uint32_t builder_material(Builder *builder, const Material *material, const char *name)
{
    Scene *scene = &builder->scene;
    void *array = scene->materials;
    if (!grow(builder, &array, &builder->material_room, scene->material_count, sizeof *material))
        return 0;
    scene->materials = array;
    Material *added = &scene->materials[scene->material_count++];
    *added = *material;
    added->name = copy_name(builder, name);
    return (uint32_t)(scene->material_count - 1);
}

void builder_instance(Builder *builder, const Instance *instance, const char *name)
{
    Scene *scene = &builder->scene;
    void *array = scene->instances;
    if (!grow(builder, &array, &builder->instance_room, scene->instance_count, sizeof *instance))
        return;
    scene->instances = array;
    Instance *added = &scene->instances[scene->instance_count++];
    *added = *instance;
    added->name = copy_name(builder, name);
}

void builder_light(Builder *builder, const Light *light)
{
    Scene *scene = &builder->scene;
    void *array = scene->lights;
    if (!grow(builder, &array, &builder->light_room, scene->light_count, sizeof *light))
        return;
    scene->lights = array;
    scene->lights[scene->light_count++] = *light;
}

void builder_camera(Builder *builder, const Camera *camera, const char *name)
{
    Scene *scene = &builder->scene;
    void *array = scene->cameras;
    if (!grow(builder, &array, &builder->camera_room, scene->camera_count, sizeof *camera))
        return;
    scene->cameras = array;
    Camera *added = &scene->cameras[scene->camera_count++];
    *added = *camera;
    added->name = copy_name(builder, name);
}

Result builder_finish(Builder *builder, Scene *out)
{
    Result result = builder->result;
    *out = (Scene){0};
    if (!result)
        result = scene_validate(&builder->scene);
    if (result)
        scene_free(&builder->scene);
    else
        *out = builder->scene;
    *builder = (Builder){0};
    return result;
}

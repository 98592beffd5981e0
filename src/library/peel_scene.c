/* peel.h: scenes. Copies the caller's arrays; scene_validate says what is wrong with them. */
#include "library/peel_scene.h"

#include "base/memory.h"
#include "library/convert.h"
#include "number/op.h"
#include "scene/builder.h"
#include "scene/texture.h"

#include <stdlib.h>
#include <string.h>

_Static_assert((int)PEEL_REPEAT == WRAP_REPEAT && (int)PEEL_CLAMP == WRAP_CLAMP &&
                   (int)PEEL_MIRROR == WRAP_MIRROR,
               "one numbering");
_Static_assert((int)PEEL_OPAQUE == ALPHA_OPAQUE && (int)PEEL_MASK == ALPHA_MASK &&
                   (int)PEEL_TRANSPARENT == ALPHA_BLEND,
               "one numbering");

/* count elements of size bytes; NULL stays NULL, which scene_validate names. */
static Result copy(const void *from, size_t count, size_t size, void **out)
{
    *out = from ? memory_array(count, size) : NULL;
    if (!from)
        return RESULT_OK;
    if (!*out)
        return RESULT_NO_MEMORY;
    memcpy(*out, from, count * size);
    return RESULT_OK;
}

/* Of what builder_mesh takes over whatever comes of it. */
static Result copy_mesh(const PeelMesh *from, Mesh *out)
{
    void *parts[4] = {0};
    size_t vertices = from->vertex_count;
    Result result = copy(from->positions, vertices, 3 * sizeof(float), &parts[0]);
    if (result == RESULT_OK)
        result = copy(from->normals, vertices, 3 * sizeof(float), &parts[1]);
    if (result == RESULT_OK)
        result = copy(from->uvs, vertices, 2 * sizeof(float), &parts[2]);
    if (result == RESULT_OK)
        result = copy(from->indices, from->triangle_count, 3 * sizeof(uint32_t), &parts[3]);
    *out = (Mesh){.vertex_count = from->vertex_count,
                  .triangle_count = from->triangle_count,
                  .position = parts[0],
                  .normal = parts[1],
                  .uv = parts[2],
                  .index = parts[3]};
    return result;
}

static Result copy_texture(size_t number, const PeelTexture *from, Texture *out)
{
    Result result = RESULT_OK;
    *out = (Texture){.width = from->width, .height = from->height};
    bool fits = from->width >= 1 && from->width <= TEXTURE_MAX_PIXELS && from->height >= 1 &&
                from->height <= TEXTURE_MAX_PIXELS; /* else scene_validate names the size */
    if (!from->texels == !from->codes)
        return result_fail(RESULT_BAD_INPUT,
                           "texture %zu: %s texels and codes, expected one of them", number,
                           from->codes ? "both" : "neither");
    if (fits && from->codes) {
        /* It is only read. */
        const Image image = {(int)from->width, (int)from->height, FORMAT_RGBA8,
                             (void *)(uintptr_t)from->codes};
        result = texture_from_image(&image, from->srgb ? TEXTURE_SRGB : TEXTURE_LINEAR, out);
    } else if (fits) {
        void *texels;
        result = copy(from->texels, (size_t)from->width * from->height, 4 * sizeof(float), &texels);
        out->texels = texels;
    }
    out->wrap_s = (TextureWrap)from->wrap_s;
    out->wrap_t = (TextureWrap)from->wrap_t;
    out->nearest = from->nearest;
    return result;
}

static void add_material(Builder *builder, const PeelMaterial *from)
{
    Material material = {
        .roughness = from->roughness,
        .metallic = from->metallic,
        .occlusion = from->occlusion,
        .alpha_mode = (AlphaMode)from->alpha_mode,
        .alpha_cutoff = from->alpha_cutoff,
        .double_sided = from->double_sided,
        .base_color_texture = from->base_color_texture,
        .metallic_roughness_texture = from->metallic_roughness_texture,
    };
    memcpy(material.base_color, from->base_color, sizeof material.base_color);
    builder_material(builder, &material, NULL);
}

static Matrix matrix_of(const double *elements)
{
    Matrix matrix = matrix_identity();
    if (elements)
        memcpy(matrix.m, elements, sizeof matrix.m);
    return matrix;
}

static void add_light(Builder *builder, const PeelLight *from)
{
    Light light = {.range = from->range};
    memcpy(light.position, from->position, sizeof light.position);
    memcpy(light.color, from->color, sizeof light.color);
    memcpy(light.attenuation, from->attenuation, sizeof light.attenuation);
    builder_light(builder, &light);
}

static void add_camera(Builder *builder, size_t number, const PeelCamera *from)
{
    Camera camera = {.world = matrix_of(from->world),
                     .yfov = from->yfov,
                     .near = from->near_plane,
                     .far = from->far_plane};
    if (!from->world) {
        Matrix view = matrix_look_at(from->eye, from->target, from->up);
        if (!builder->result && !matrix_invert_affine(&view, &camera.world))
            builder->result =
                result_fail(RESULT_BAD_INPUT,
                            "camera %zu: eye, target and up give no view, expected finite numbers, "
                            "another target than eye, and up beside the gaze",
                            number);
    }
    scene_unscale_camera(&camera);
    builder_camera(builder, &camera, NULL);
}

static void add_all(const PeelSceneDesc *desc, Builder *builder)
{
    for (size_t i = 0; i < desc->mesh_count && !builder->result; i++) {
        Mesh mesh;
        Result made = copy_mesh(&desc->meshes[i], &mesh);
        builder_mesh(builder, made, &mesh);
    }
    for (size_t i = 0; i < desc->texture_count && !builder->result; i++) {
        Texture texture;
        Result made = copy_texture(i, &desc->textures[i], &texture);
        builder_texture(builder, made, &texture);
    }
    for (size_t i = 0; i < desc->material_count && !builder->result; i++)
        add_material(builder, &desc->materials[i]);
    for (size_t i = 0; i < desc->instance_count && !builder->result; i++) {
        const PeelInstance *from = &desc->instances[i];
        const Instance instance = {
            .mesh = from->mesh, .material = from->material, .world = matrix_of(from->world)};
        builder_instance(builder, &instance, NULL);
    }
    for (size_t i = 0; i < desc->light_count && !builder->result; i++)
        add_light(builder, &desc->lights[i]);
    for (size_t i = 0; i < desc->camera_count && !builder->result; i++)
        add_camera(builder, i, &desc->cameras[i]);
    memcpy(builder->scene.ambient, desc->ambient, sizeof desc->ambient);
    memcpy(builder->scene.background, desc->background, sizeof desc->background);
}

/* Apart from peel_scene_create, so that its arithmetic stays within the environment set there. */
static __attribute__((noinline)) Result create(const PeelSceneDesc *desc, Scene *out)
{
    Builder builder = builder_begin(NULL);
    add_all(desc, &builder);
    Result result = builder_finish(&builder, out);
    if (result == RESULT_OK && out->camera_count == 0) {
        result = scene_add_framing_camera(out);
        if (result == RESULT_OK)
            result = scene_validate(out);
    }
    if (result != RESULT_OK)
        scene_free(out);
    return result;
}

static PeelResult check_arrays(const PeelSceneDesc *desc)
{
    const struct {
        size_t count;
        const void *array;
        const char *name;
    } arrays[] = {
        {desc->mesh_count, desc->meshes, "meshes"},
        {desc->texture_count, desc->textures, "textures"},
        {desc->material_count, desc->materials, "materials"},
        {desc->instance_count, desc->instances, "instances"},
        {desc->light_count, desc->lights, "lights"},
        {desc->camera_count, desc->cameras, "cameras"},
    };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        if (arrays[i].count && !arrays[i].array)
            return convert_missing("peel_scene_create", arrays[i].name);
    return PEEL_OK;
}

PeelResult peel_scene_create(const PeelSceneDesc *desc, PeelScene **out)
{
    if (!desc || !out)
        return convert_missing("peel_scene_create", desc ? "out" : "desc");
    PeelResult checked = check_arrays(desc);
    if (checked)
        return checked;
    PeelScene *scene = memory_array(1, sizeof *scene);
    if (!scene)
        return PEEL_NO_MEMORY;
    uint32_t environment = op_suspend();
    Result result = create(desc, &scene->scene);
    op_leave(environment);
    if (result == RESULT_OK)
        *out = scene;
    else
        free(scene);
    return convert_result(result);
}

void peel_scene_free(PeelScene *scene)
{
    if (scene)
        scene_free(&scene->scene);
    free(scene);
}

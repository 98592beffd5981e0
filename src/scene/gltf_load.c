#include "base/memory.h"
#include "base/text.h"
#include "scene/builder.h"
#include "scene/gltf.h"
#include "scene/gltf_assimp.h"
#include "scene/gltf_mesh.h"
#include "scene/gltf_read.h"
#include "scene/gltf_surface.h"
#include "scene/gltf_texture.h"

#include <assimp/material.h>
#include <assimp/scene.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a primitive is made of: equal keys give one mesh of ours. */
typedef struct MeshKey {
    size_t position, normal, uv, indices, mode;
    uint32_t mesh; /* ours */
} MeshKey;

typedef struct Loader {
    const char *path;
    const GltfJson *json;
    const struct aiScene *assimp;
    Builder builder;
    GltfBytes bytes;
    GltfTextures textures;
    uint32_t *materials; /* ours, by Assimp's index; UINT32_MAX until used */
    MeshKey *keys;
    size_t key_count, key_room;
    char node_name[128]; /* of the node at hand, for messages */
} Loader;

static Result fail(Loader *loader, const char *expected)
{
    if (!loader->builder.result)
        loader->builder.result = result_fail(RESULT_BAD_INPUT, "%s: %s: expected %s", loader->path,
                                             loader->node_name, expected);
    return loader->builder.result;
}

/* ---- materials ------------------------------------------------------------------------------ */

/* The array functions: those of one value are inline in Assimp's header and nowhere else, so that a
 * build without inlining does not link. */
static float material_float(const struct aiMaterial *from, const char *key, float fallback)
{
    float value = fallback;
    unsigned room = 1;
    aiGetMaterialFloatArray(from, key, 0, 0, &value, &room);
    return value;
}

static bool material_flag(const struct aiMaterial *from, const char *key)
{
    int value = 0;
    unsigned room = 1;
    aiGetMaterialIntegerArray(from, key, 0, 0, &value, &room);
    return value != 0;
}

/* Assimp fills in glTF's defaults: base colour 1, metallic 1, roughness 1, OPAQUE, cutoff 0.5.
 * number: of the same material in the document; SIZE_MAX for the default one. */
static uint32_t add_material(Loader *loader, const struct aiMaterial *from, size_t number)
{
    const json_t *json = gltf_json_element(loader->json, "materials", number);
    Builder *builder = &loader->builder;
    Material material = {.occlusion = 1.0f};
    struct aiColor4D color = {1.0f, 1.0f, 1.0f, 1.0f};
    struct aiString mode = {0}, name = {0};
    aiGetMaterialColor(from, "$clr.base", 0, 0, &color);
    aiGetMaterialString(from, "$mat.gltf.alphaMode", 0, 0, &mode);
    aiGetMaterialString(from, "?mat.name", 0, 0, &name);
    memcpy(material.base_color, (const float[4]){color.r, color.g, color.b, color.a},
           sizeof material.base_color);
    material.metallic = material_float(from, "$mat.metallicFactor", 1.0f);
    material.roughness = material_float(from, "$mat.roughnessFactor", 1.0f);
    material.alpha_cutoff = material_float(from, "$mat.gltf.alphaCutoff", 0.5f);
    if (material.alpha_cutoff > 0.0f) /* what is denormal would be read as 0, and discard nothing */
        material.alpha_cutoff = fmaxf(material.alpha_cutoff, FLT_MIN);
    material.double_sided = material_flag(from, "$mat.twosided");
    if (strcmp(mode.data, "BLEND") == 0)
        material.alpha_mode = ALPHA_BLEND;
    else if (strcmp(mode.data, "MASK") == 0)
        material.alpha_mode = ALPHA_MASK;
    material.base_color_texture = gltf_texture_add(
        &loader->textures, builder, gltf_surface_texture(loader->json, json, "baseColorTexture"),
        TEXTURE_SRGB);
    material.metallic_roughness_texture = gltf_texture_add(
        &loader->textures, builder,
        gltf_surface_texture(loader->json, json, "metallicRoughnessTexture"), TEXTURE_LINEAR);
    /* Assimp cuts a long one off, within a character even. */
    const char *own_name = json_string_value(json_object_get(json, "name"));
    uint32_t added = builder_material(builder, &material, own_name ? own_name : name.data);
    /* Here, and lights and cameras below, while the number in the document is known. */
    if (!builder->result)
        builder->result =
            scene_validate_material(&builder->scene, &builder->scene.materials[added], number);
    return added;
}

/* ---- nodes ---------------------------------------------------------------------------------- */

/* An Assimp matrix is row-major: a1 to a4 is the first row. */
static Matrix from_assimp(const struct aiMatrix4x4 *a)
{
    return (Matrix){{(double)a->a1, (double)a->b1, (double)a->c1, (double)a->d1, (double)a->a2,
                     (double)a->b2, (double)a->c2, (double)a->d2, (double)a->a3, (double)a->b3,
                     (double)a->c3, (double)a->d3, (double)a->a4, (double)a->b4, (double)a->c4,
                     (double)a->d4}};
}

static bool same_key(const MeshKey *a, const MeshKey *b)
{
    return a->position == b->position && a->normal == b->normal && a->uv == b->uv &&
           a->indices == b->indices && a->mode == b->mode;
}

static Result make_mesh(Loader *loader, const MeshKey *key, const struct aiMesh *from,
                        const char *label, Mesh *out)
{
    const json_t *position = gltf_json_element(loader->json, "accessors", key->position);
    size_t vertices = gltf_json_index(position, "count", 0), count = vertices;
    if (key->indices != SIZE_MAX)
        count =
            gltf_json_index(gltf_json_element(loader->json, "accessors", key->indices), "count", 0);
    if (from->mNumVertices != vertices)
        return result_fail(RESULT_BAD_INPUT, "%s: %u vertices from Assimp, expected the file's %zu",
                           label, from->mNumVertices, vertices);
    float *uv = NULL;
    Result result = key->uv == SIZE_MAX ? RESULT_OK : gltf_bytes_uv(&loader->bytes, key->uv, &uv);
    if (!result)
        result = gltf_mesh_convert(from, key->mode == MODE_TRIANGLES ? count / 3 : count - 2, uv,
                                   label, out);
    free(uv);
    return result;
}

static uint32_t find_mesh(Loader *loader, const json_t *primitive, const struct aiMesh *from,
                          const char *label)
{
    const json_t *attributes = json_object_get(primitive, "attributes");
    char uv[UV_NAME_SIZE];
    gltf_surface_uv_name(loader->json, primitive, uv);
    MeshKey key = {.position = gltf_json_index(attributes, "POSITION", SIZE_MAX),
                   .normal = gltf_json_index(attributes, "NORMAL", SIZE_MAX),
                   .uv = gltf_json_index(attributes, uv, SIZE_MAX),
                   .indices = gltf_json_index(primitive, "indices", SIZE_MAX),
                   .mode = gltf_json_index(primitive, "mode", MODE_TRIANGLES)};
    for (size_t i = 0; i < loader->key_count; i++)
        if (same_key(&loader->keys[i], &key))
            return loader->keys[i].mesh;
    void *keys = loader->keys;
    if (!loader->builder.result)
        loader->builder.result =
            memory_grow(&keys, &loader->key_room, loader->key_count + 1, sizeof key);
    if (loader->builder.result)
        return 0;
    loader->keys = keys;
    Mesh mesh = {0};
    Result made = make_mesh(loader, &key, from, label, &mesh);
    key.mesh = builder_mesh(&loader->builder, made, &mesh);
    loader->keys[loader->key_count++] = key;
    return key.mesh;
}

/* The material of a primitive, Assimp's number being `number`: one for every material of the
 * document, though not always the same one, and one more for the default material. */
static uint32_t find_material(Loader *loader, const json_t *primitive, unsigned number)
{
    uint32_t *material = &loader->materials[number];
    if (*material == UINT32_MAX)
        *material = add_material(loader, loader->assimp->mMaterials[number],
                                 gltf_json_index(primitive, "material", SIZE_MAX));
    return *material;
}

static void add_instances(Loader *loader, const json_t *node, const struct aiNode *from,
                          const Matrix *world)
{
    size_t number = gltf_json_index(node, "mesh", SIZE_MAX), i;
    unsigned drawn = 0;
    const json_t *json_mesh = gltf_json_element(loader->json, "meshes", number), *primitive;
    const char *name = json_string_value(json_object_get(node, "name"));
    json_array_foreach(json_object_get(json_mesh, "primitives"), i, primitive)
    {
        if (!gltf_json_drawn(primitive) || loader->builder.result)
            continue;
        if (drawn >= from->mNumMeshes) {
            fail(loader, "as many primitives as Assimp gives");
            return;
        }
        char label[256];
        const struct aiMesh *mesh = loader->assimp->mMeshes[from->mMeshes[drawn++]];
        snprintf(label, sizeof label, "%s: mesh %zu primitive %zu", loader->path, number, i);
        Instance instance = {.world = *world, .mesh = find_mesh(loader, primitive, mesh, label)};
        instance.material = find_material(loader, primitive, mesh->mMaterialIndex);
        builder_instance(&loader->builder, &instance, name);
    }
}

/* A node's matrix without the mirroring in its scale. Of a matrix that mirrors, only whether it
 * does is known: as if by all three axes. */
static Matrix unmirror(const json_t *node, Matrix local)
{
    const json_t *scale = json_object_get(node, "scale");
    bool all = json_object_get(node, "matrix") && matrix_determinant3(&local) < 0.0;
    for (size_t c = 0; c < 3; c++)
        if (all || json_number_value(json_array_get(scale, c)) < 0.0)
            for (size_t r = 0; r < 3; r++)
                local.m[4 * c + r] = -local.m[4 * c + r];
    return local;
}

/* glTF's camera knows no scale: its axes are those of the nodes without mirroring, `upright`, and
 * brought back to unit length. Source: glTF 2.0, 3.10.1 (the view matrix). */
static void add_camera(Loader *loader, const json_t *node, const Matrix *world,
                       const Matrix *upright)
{
    size_t number = gltf_json_index(node, "camera", SIZE_MAX);
    const json_t *from = gltf_json_element(loader->json, "cameras", number);
    const json_t *perspective = json_object_get(from, "perspective");
    const char *name = json_string_value(json_object_get(node, "name"));
    Builder *builder = &loader->builder;
    if (!perspective)
        return;
    const json_t *far = json_object_get(perspective, "zfar");
    Camera camera = {.world = *upright,
                     .yfov = json_number_value(json_object_get(perspective, "yfov")),
                     .near = json_number_value(json_object_get(perspective, "znear")),
                     .far = far ? json_number_value(far) : INFINITY};
    memcpy(camera.world.m + 12, world->m + 12, 3 * sizeof *world->m);
    scene_unscale_camera(&camera);
    if (!name)
        name = json_string_value(json_object_get(from, "name"));
    builder_camera(builder, &camera, name);
    if (!builder->result)
        builder->result =
            scene_validate_camera(&builder->scene.cameras[builder->scene.camera_count - 1], number);
}

/* Three numbers of an extra into out; false where it is absent. */
static bool extra_triple(Loader *loader, const json_t *node, const char *key, float out[3])
{
    const json_t *value = json_object_get(json_object_get(node, "extras"), key);
    if (!value)
        return false;
    for (size_t i = 0; i < 3; i++) {
        const json_t *number = json_array_get(value, i);
        if (json_array_size(value) != 3 || !json_is_number(number)) {
            fail(loader, "three numbers as the extras ambient, background and attenuation");
            return false;
        }
        out[i] = (float)json_number_value(number);
    }
    return true;
}

static void add_light(Loader *loader, const json_t *node, const Matrix *world)
{
    const json_t *extensions = json_object_get(loader->json->root, "extensions");
    const json_t *reference =
        json_object_get(json_object_get(node, "extensions"), "KHR_lights_punctual");
    size_t number = gltf_json_index(reference, "light", SIZE_MAX);
    const json_t *from = json_array_get(
        json_object_get(json_object_get(extensions, "KHR_lights_punctual"), "lights"), number);
    const char *type = json_string_value(json_object_get(from, "type"));
    if (!type || strcmp(type, "point") != 0)
        return;
    const json_t *color = json_object_get(from, "color");
    const json_t *intensity = json_object_get(from, "intensity");
    Light light = {.attenuation = {0.0f, 0.0f, 1.0f}};
    for (size_t i = 0; i < 3; i++) {
        float factor = color ? (float)json_number_value(json_array_get(color, i)) : 1.0f;
        light.color[i] = factor * (intensity ? (float)json_number_value(intensity) : 1.0f);
        light.position[i] = world->m[12 + i];
    }
    light.range = (float)json_number_value(json_object_get(from, "range")); /* 0 without one */
    extra_triple(loader, node, "attenuation", light.attenuation);
    builder_light(&loader->builder, &light);
    if (!loader->builder.result)
        loader->builder.result = scene_validate_light(&light, number);
}

static void read_surroundings(Loader *loader, const json_t *node)
{
    Scene *scene = &loader->builder.scene;
    const json_t *turn =
        json_object_get(json_object_get(node, "extras"), "light_degrees_per_second");
    extra_triple(loader, node, "ambient", scene->ambient);
    extra_triple(loader, node, "background", scene->background);
    if (json_is_number(turn))
        scene->light_degrees_per_second = json_number_value(turn);
    else if (turn)
        fail(loader, "a number as the extra light_degrees_per_second");
}

/* Assimp's nodes and the file's, side by side: same children in the same order. */
static void add_node(Loader *loader, size_t number, const struct aiNode *from, const Matrix *parent,
                     const Matrix *upright_parent)
{
    if (loader->builder.result)
        return;
    const json_t *node = gltf_json_element(loader->json, "nodes", number);
    const json_t *children = json_object_get(node, "children");
    const char *name = json_string_value(json_object_get(node, "name"));
    Matrix local = from_assimp(&from->mTransformation);
    Matrix world = matrix_multiply(parent, &local), upright = unmirror(node, local);
    upright = matrix_multiply(upright_parent, &upright);
    snprintf(loader->node_name, sizeof loader->node_name, "node %zu (%.80s)", number,
             name ? name : "unnamed");
    for (int i = 0; i < 16; i++)
        if (!isfinite(local.m[i]))
            fail(loader, "a finite matrix in single precision");
    if (local.m[3] != 0.0 || local.m[7] != 0.0 || local.m[11] != 0.0 || local.m[15] != 1.0)
        fail(loader, "an affine matrix, with a last row of 0 0 0 1");
    add_instances(loader, node, from, &world);
    add_camera(loader, node, &world, &upright);
    add_light(loader, node, &world);
    read_surroundings(loader, node);
    if (json_array_size(children) != from->mNumChildren) {
        fail(loader, "as many children as Assimp gives");
        return;
    }
    for (unsigned i = 0; i < from->mNumChildren; i++)
        add_node(loader, (size_t)json_integer_value(json_array_get(children, i)),
                 from->mChildren[i], &world, &upright);
}

/* Assimp puts several roots below one of its own, and uses a single one as it is. */
static void add_roots(Loader *loader)
{
    const json_t *scene = gltf_json_element(loader->json, "scenes", loader->json->scene);
    const json_t *roots = json_object_get(scene, "nodes");
    const struct aiNode *top = loader->assimp->mRootNode;
    Matrix identity = matrix_identity();
    size_t count = json_array_size(roots);
    snprintf(loader->node_name, sizeof loader->node_name, "scene %zu", loader->json->scene);
    if (count > 1 && count != top->mNumChildren) {
        fail(loader, "as many root nodes as Assimp gives");
        return;
    }
    for (size_t i = 0; i < count; i++)
        add_node(loader, (size_t)json_integer_value(json_array_get(roots, i)),
                 count == 1 ? top : top->mChildren[i], &identity, &identity);
}

/* ---- the whole ------------------------------------------------------------------------------ */

static Result convert(Loader *loader, Scene *out)
{
    const char *slash = strrchr(loader->path, '/');
    char *name = strdup(slash ? slash + 1 : loader->path);
    size_t materials = loader->assimp->mNumMaterials;
    loader->materials = memory_array(materials, sizeof *loader->materials);
    if (!name || !loader->materials) {
        free(name);
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory", loader->path);
    }
    *strrchr(name, '.') = 0; /* the extension was checked */
    text_make_utf8(name);
    memset(loader->materials, 0xff, materials * sizeof *loader->materials);
    loader->builder = builder_begin(name);
    free(name);
    add_roots(loader);
    return builder_finish(&loader->builder, out);
}

/* A file without cameras or lights gets ours. */
static Result complete(Scene *scene)
{
    Result result = RESULT_OK;
    bool added = scene->camera_count == 0 || scene->light_count == 0;
    if (scene->light_count == 0)
        result = scene_add_default_lights(scene);
    if (!result && scene->camera_count == 0)
        result = scene_add_framing_camera(scene);
    return result || !added ? result : scene_validate(scene);
}

/* The file's name before a message about its parts, unless it is there already. */
static Result name_file(const char *path, Result result)
{
    if (!result || strncmp(result_message(), path, strlen(path)) == 0)
        return result;
    char *message = strdup(result_message());
    if (message)
        result_fail(result, "%s: %s", path, message);
    free(message);
    return result;
}

Result gltf_load_files(const char *path, GltfFile file, void *context, Scene *out)
{
    *out = (Scene){0};
    GltfJson json;
    Result result = gltf_read(path, &json);
    if (result)
        return name_file(path, result);
    Loader loader = {.path = path, .json = &json, .bytes = {.path = path, .json = &json}};
    loader.textures.bytes = &loader.bytes;
    if (file)
        result = gltf_bytes_files(&loader.bytes, file, context);
    if (!result)
        result = gltf_assimp_import(path, &json, &loader.assimp);
    if (!result)
        result = convert(&loader, out);
    if (!result)
        result = complete(out);
    if (result)
        scene_free(out);
    else
        gltf_json_warn(&json, path);
    gltf_assimp_release(loader.assimp);
    free(loader.materials);
    free(loader.keys);
    gltf_texture_free(&loader.textures);
    gltf_bytes_free(&loader.bytes);
    gltf_json_free(&json);
    return name_file(path, result);
}

Result gltf_load(const char *path, Scene *out)
{
    return gltf_load_files(path, NULL, NULL, out);
}

#include "base/file.h"
#include "base/memory.h"
#include "scene/gltf.h"
#include "scene/gltf_file.h"
#include "scene/gltf_json.h"
#include "scene/gltf_texture_write.h"
#include "scene/texture.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Source of names and numbers: glTF 2.0 specification, chapters 3 and 5; KHR_lights_punctual. */
enum {
    TARGET_VERTICES = 34962,
    TARGET_INDICES = 34963
};

/* A material on a mesh is a mesh of its own in glTF; its accessors are shared. */
typedef struct Pair {
    uint32_t mesh, material;
} Pair;

typedef struct Writer {
    const Scene *scene;
    unsigned char *bytes; /* the one buffer */
    size_t byte_count, byte_room;
    json_t *views, *accessors;
    GltfTextureArrays textures;
    uint32_t *first_accessor; /* per mesh; UINT32_MAX where no instance uses it */
    Pair *pairs;
    size_t pair_count, pair_room;
    Result result;
    bool out_of_json; /* a jansson call failed: memory is exhausted */
} Writer;

/* ---- JSON ----------------------------------------------------------------------------------- */

/* Both take over value; NULL counts as a failure. */
static void put(Writer *writer, json_t *object, const char *key, json_t *value)
{
    if (json_object_set_new(object, key, value))
        writer->out_of_json = true;
}

static void append(Writer *writer, json_t *array, json_t *value)
{
    if (json_array_append_new(array, value))
        writer->out_of_json = true;
}

static void put_integer(Writer *writer, json_t *object, const char *key, size_t value)
{
    put(writer, object, key, json_integer((json_int_t)value));
}

static void put_name(Writer *writer, json_t *object, const char *name)
{
    if (name && *name)
        put(writer, object, "name", json_string(name));
}

/* Leaves out an array that glTF does not allow to be empty. */
static void put_array(Writer *writer, json_t *object, const char *key, json_t *array)
{
    if (array && json_array_size(array) == 0)
        json_decref(array);
    else
        put(writer, object, key, array);
}

static json_t *floats(Writer *writer, const float *values, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; i++)
        append(writer, array, json_real((double)values[i]));
    return array;
}

static json_t *doubles(Writer *writer, const double *values, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; i++)
        append(writer, array, json_real(values[i]));
    return array;
}

/* ---- buffer --------------------------------------------------------------------------------- */

/* A view of `size` bytes at the end of the buffer, on a 4-byte boundary: borrowed, NULL after a
 * failure. */
static json_t *add_view(Writer *writer, const void *data, size_t size)
{
    size_t begin = writer->byte_count, end = begin + (size + 3) / 4 * 4;
    void *bytes = writer->bytes;
    if (!writer->result)
        writer->result = memory_grow(&bytes, &writer->byte_room, end, 1);
    if (writer->result)
        return NULL;
    writer->bytes = bytes;
    memset(writer->bytes + begin, 0, end - begin);
    memcpy(writer->bytes + begin, data, size);
    writer->byte_count = end;
    json_t *view = json_object();
    put_integer(writer, view, "buffer", 0);
    put_integer(writer, view, "byteOffset", begin);
    put_integer(writer, view, "byteLength", size);
    append(writer, writer->views, view);
    return writer->out_of_json ? NULL : view;
}

/* A view and an accessor of all of it, which is returned for further properties (borrowed; NULL
 * after a failure). */
static json_t *add_accessor(Writer *writer, const void *data, size_t size, int target, int type,
                            const char *shape, size_t count)
{
    json_t *view = add_view(writer, data, size);
    if (!view)
        return NULL;
    put_integer(writer, view, "target", (size_t)target);
    json_t *accessor = json_object();
    put_integer(writer, accessor, "bufferView", json_array_size(writer->views) - 1);
    put_integer(writer, accessor, "componentType", (size_t)type);
    put_integer(writer, accessor, "count", count);
    put(writer, accessor, "type", json_string(shape));
    append(writer, writer->accessors, accessor);
    return accessor;
}

static void add_positions(Writer *writer, const Mesh *mesh)
{
    float low[3], high[3];
    memcpy(low, mesh->position, sizeof low);
    memcpy(high, mesh->position, sizeof high);
    for (size_t i = 3; i < (size_t)mesh->vertex_count * 3; i++) {
        low[i % 3] = mesh->position[i] < low[i % 3] ? mesh->position[i] : low[i % 3];
        high[i % 3] = mesh->position[i] > high[i % 3] ? mesh->position[i] : high[i % 3];
    }
    json_t *accessor =
        add_accessor(writer, mesh->position, (size_t)mesh->vertex_count * 3 * sizeof(float),
                     TARGET_VERTICES, TYPE_FLOAT, "VEC3", mesh->vertex_count);
    if (!accessor)
        return;
    put(writer, accessor, "min", floats(writer, low, 3));
    put(writer, accessor, "max", floats(writer, high, 3));
}

/* 16 bits where they do; 65535 itself means a restart and is not an index. */
static void add_indices(Writer *writer, const Mesh *mesh)
{
    size_t count = (size_t)mesh->triangle_count * 3;
    if (mesh->vertex_count > UINT16_MAX) {
        add_accessor(writer, mesh->index, count * sizeof(uint32_t), TARGET_INDICES, TYPE_UINT32,
                     "SCALAR", count);
        return;
    }
    uint16_t *narrow = memory_array(count, sizeof *narrow);
    if (!narrow) {
        writer->result = RESULT_NO_MEMORY;
        return;
    }
    for (size_t i = 0; i < count; i++)
        narrow[i] = (uint16_t)mesh->index[i];
    add_accessor(writer, narrow, count * sizeof *narrow, TARGET_INDICES, TYPE_UINT16, "SCALAR",
                 count);
    free(narrow);
}

/* Accessors in the order position, normal, indices, uv (if any). */
static void add_geometry(Writer *writer, uint32_t index)
{
    const Mesh *mesh = &writer->scene->meshes[index];
    writer->first_accessor[index] = (uint32_t)json_array_size(writer->accessors);
    add_positions(writer, mesh);
    add_accessor(writer, mesh->normal, (size_t)mesh->vertex_count * 3 * sizeof(float),
                 TARGET_VERTICES, TYPE_FLOAT, "VEC3", mesh->vertex_count);
    add_indices(writer, mesh);
    if (mesh->uv)
        add_accessor(writer, mesh->uv, (size_t)mesh->vertex_count * 2 * sizeof(float),
                     TARGET_VERTICES, TYPE_FLOAT, "VEC2", mesh->vertex_count);
}

/* A texture's PNG file, for gltf_texture_write. */
static Result embed_image(void *context, const unsigned char *bytes, size_t count, size_t *view)
{
    Writer *writer = context;
    *view = json_array_size(writer->views);
    return add_view(writer, bytes, count) ? RESULT_OK : writer->result;
}

/* ---- pieces --------------------------------------------------------------------------------- */

static size_t find_pair(Writer *writer, const Instance *instance)
{
    for (size_t i = 0; i < writer->pair_count; i++)
        if (writer->pairs[i].mesh == instance->mesh &&
            writer->pairs[i].material == instance->material)
            return i;
    void *pairs = writer->pairs;
    if (!writer->result)
        writer->result =
            memory_grow(&pairs, &writer->pair_room, writer->pair_count + 1, sizeof(Pair));
    if (writer->result)
        return 0;
    writer->pairs = pairs;
    writer->pairs[writer->pair_count] = (Pair){instance->mesh, instance->material};
    return writer->pair_count++;
}

static json_t *mesh_json(Writer *writer, const Pair *pair)
{
    if (writer->first_accessor[pair->mesh] == UINT32_MAX)
        add_geometry(writer, pair->mesh);
    size_t first = writer->first_accessor[pair->mesh];
    json_t *attributes = json_object();
    put_integer(writer, attributes, "POSITION", first);
    put_integer(writer, attributes, "NORMAL", first + 1);
    if (writer->scene->meshes[pair->mesh].uv)
        put_integer(writer, attributes, "TEXCOORD_0", first + 3);
    json_t *primitive = json_object();
    put(writer, primitive, "attributes", attributes);
    put_integer(writer, primitive, "indices", first + 2);
    put_integer(writer, primitive, "material", pair->material);
    json_t *primitives = json_array(), *mesh = json_object();
    append(writer, primitives, primitive);
    put(writer, mesh, "primitives", primitives);
    return mesh;
}

/* number: 1 + index into the scene's textures, 0 for none. */
static void put_texture(Writer *writer, json_t *object, const char *key, uint32_t number,
                        TextureEncoding encoding)
{
    if (!number)
        return;
    json_t *info = json_object();
    put_integer(writer, info, "index", writer->textures.index[encoding][number - 1] - 1);
    put(writer, object, key, info);
}

static json_t *material_json(Writer *writer, const Material *material)
{
    static const char *const modes[] = {"OPAQUE", "MASK", "BLEND"};
    json_t *metallic_roughness = json_object(), *json = json_object();
    put_name(writer, json, material->name);
    put(writer, metallic_roughness, "baseColorFactor", floats(writer, material->base_color, 4));
    put(writer, metallic_roughness, "metallicFactor", json_real((double)material->metallic));
    put(writer, metallic_roughness, "roughnessFactor", json_real((double)material->roughness));
    put_texture(writer, metallic_roughness, "baseColorTexture", material->base_color_texture,
                TEXTURE_SRGB);
    put_texture(writer, metallic_roughness, "metallicRoughnessTexture",
                material->metallic_roughness_texture, TEXTURE_LINEAR);
    put(writer, json, "pbrMetallicRoughness", metallic_roughness);
    put(writer, json, "alphaMode", json_string(modes[material->alpha_mode]));
    if (material->alpha_mode == ALPHA_MASK)
        put(writer, json, "alphaCutoff", json_real((double)material->alpha_cutoff));
    put(writer, json, "doubleSided", json_boolean(material->double_sided));
    return json;
}

static json_t *camera_json(Writer *writer, const Camera *camera)
{
    json_t *perspective = json_object(), *json = json_object();
    put_name(writer, json, camera->name);
    put(writer, json, "type", json_string("perspective"));
    put(writer, perspective, "yfov", json_real(camera->yfov));
    put(writer, perspective, "znear", json_real(camera->near));
    if (isfinite(camera->far))
        put(writer, perspective, "zfar", json_real(camera->far));
    put(writer, json, "perspective", perspective);
    return json;
}

/* The intensity is a power of two, so that colour × intensity gives our floats back. */
static json_t *light_json(Writer *writer, const Light *light)
{
    float intensity = 1.0f, color[3];
    for (int i = 0; i < 3; i++)
        while (light->color[i] > intensity)
            intensity *= 2.0f;
    for (int i = 0; i < 3; i++)
        color[i] = light->color[i] / intensity;
    json_t *json = json_object();
    put(writer, json, "type", json_string("point"));
    put(writer, json, "color", floats(writer, color, 3));
    put(writer, json, "intensity", json_real((double)intensity));
    if (light->range > 0.0f)
        put(writer, json, "range", json_real((double)light->range));
    return json;
}

/* ---- nodes ---------------------------------------------------------------------------------- */

/* A translation, a matrix, or nothing at all. */
static void put_placement(Writer *writer, json_t *node, const Matrix *world)
{
    Matrix moved = matrix_translate(world->m[12], world->m[13], world->m[14]);
    bool translated = world->m[12] != 0.0 || world->m[13] != 0.0 || world->m[14] != 0.0;
    for (int i = 0; i < 16; i++)
        if (world->m[i] != moved.m[i]) {
            put(writer, node, "matrix", doubles(writer, world->m, 16));
            return;
        }
    if (translated)
        put(writer, node, "translation", doubles(writer, world->m + 12, 3));
}

static json_t *instance_node(Writer *writer, const Instance *instance)
{
    json_t *node = json_object();
    put_name(writer, node, instance->name);
    put_integer(writer, node, "mesh", find_pair(writer, instance));
    put_placement(writer, node, &instance->world);
    return node;
}

static json_t *camera_node(Writer *writer, size_t index)
{
    json_t *node = json_object();
    put_name(writer, node, writer->scene->cameras[index].name);
    put_integer(writer, node, "camera", index);
    put_placement(writer, node, &writer->scene->cameras[index].world);
    return node;
}

static json_t *light_node(Writer *writer, size_t index)
{
    const Light *light = &writer->scene->lights[index];
    json_t *node = json_object(), *reference = json_object(), *extensions = json_object();
    put(writer, node, "translation", doubles(writer, light->position, 3));
    put_integer(writer, reference, "light", index);
    put(writer, extensions, "KHR_lights_punctual", reference);
    put(writer, node, "extensions", extensions);
    if (light->attenuation[0] != 0.0f || light->attenuation[1] != 0.0f ||
        light->attenuation[2] != 1.0f) {
        json_t *extras = json_object();
        put(writer, extras, "attenuation", floats(writer, light->attenuation, 3));
        put(writer, node, "extras", extras);
    }
    return node;
}

/* What belongs to the whole scene and has no place in glTF. */
static json_t *surroundings_node(Writer *writer)
{
    const Scene *scene = writer->scene;
    json_t *extras = json_object(), *node = json_object();
    put(writer, extras, "ambient", floats(writer, scene->ambient, 3));
    put(writer, extras, "background", floats(writer, scene->background, 3));
    put(writer, extras, "light_degrees_per_second", json_real(scene->light_degrees_per_second));
    put(writer, node, "name", json_string("surroundings"));
    put(writer, node, "extras", extras);
    return node;
}

static void put_nodes(Writer *writer, json_t *root)
{
    const Scene *scene = writer->scene;
    json_t *nodes = json_array(), *order = json_array(), *entry = json_object();
    json_t *entries = json_array();
    append(writer, nodes, surroundings_node(writer));
    for (size_t i = 0; i < scene->instance_count; i++)
        append(writer, nodes, instance_node(writer, &scene->instances[i]));
    for (size_t i = 0; i < scene->camera_count; i++)
        append(writer, nodes, camera_node(writer, i));
    for (size_t i = 0; i < scene->light_count; i++)
        append(writer, nodes, light_node(writer, i));
    for (size_t i = 0; i < json_array_size(nodes); i++)
        append(writer, order, json_integer((json_int_t)i));
    put_name(writer, entry, scene->name);
    put(writer, entry, "nodes", order);
    append(writer, entries, entry);
    put_integer(writer, root, "scene", 0);
    put(writer, root, "scenes", entries);
    put(writer, root, "nodes", nodes);
}

static void put_lights(Writer *writer, json_t *root)
{
    if (writer->scene->light_count == 0)
        return;
    json_t *lights = json_array(), *extension = json_object(), *extensions = json_object();
    json_t *used = json_array();
    for (size_t i = 0; i < writer->scene->light_count; i++)
        append(writer, lights, light_json(writer, &writer->scene->lights[i]));
    put(writer, extension, "lights", lights);
    put(writer, extensions, "KHR_lights_punctual", extension);
    append(writer, used, json_string("KHR_lights_punctual"));
    put(writer, root, "extensionsUsed", used);
    put(writer, root, "extensions", extensions);
}

/* Everything but the buffer. */
static json_t *document(Writer *writer)
{
    const Scene *scene = writer->scene;
    json_t *root = json_object(), *asset = json_object();
    json_t *meshes = json_array(), *materials = json_array(), *cameras = json_array();
    writer->accessors = json_array();
    put(writer, asset, "version", json_string("2.0"));
    put(writer, asset, "generator", json_string("Peel"));
    put(writer, root, "asset", asset);
    put_lights(writer, root);
    put_nodes(writer, root);
    for (size_t i = 0; i < writer->pair_count; i++)
        append(writer, meshes, mesh_json(writer, &writer->pairs[i]));
    for (size_t i = 0; i < scene->material_count; i++)
        append(writer, materials, material_json(writer, &scene->materials[i]));
    for (size_t i = 0; i < scene->camera_count; i++)
        append(writer, cameras, camera_json(writer, &scene->cameras[i]));
    put_array(writer, root, "meshes", meshes);
    put_array(writer, root, "materials", materials);
    put_array(writer, root, "textures", json_incref(writer->textures.textures));
    put_array(writer, root, "samplers", json_incref(writer->textures.samplers));
    put_array(writer, root, "images", json_incref(writer->textures.images));
    put_array(writer, root, "cameras", cameras);
    put_array(writer, root, "accessors", writer->accessors);
    put_array(writer, root, "bufferViews", json_incref(writer->views));
    return root;
}

/* ---- the file ------------------------------------------------------------------------------- */

static void put_buffer(Writer *writer, json_t *root, bool binary)
{
    if (writer->byte_count == 0)
        return;
    json_t *buffer = json_object(), *buffers = json_array();
    put_integer(writer, buffer, "byteLength", writer->byte_count);
    if (!binary) {
        char *uri =
            gltf_file_data_uri("application/octet-stream", writer->bytes, writer->byte_count);
        put(writer, buffer, "uri", uri ? json_string(uri) : NULL);
        free(uri);
    }
    append(writer, buffers, buffer);
    put(writer, root, "buffers", buffers);
}

static Result write_document(Writer *writer, const char *path, bool binary)
{
    json_t *root = document(writer);
    put_buffer(writer, root, binary);
    Result result = writer->result;
    if (!result && writer->byte_count > INT32_MAX)
        result = result_fail(RESULT_UNSUPPORTED,
                             "%s: %zu bytes of geometry and images, expected below 2^31", path,
                             writer->byte_count);
    char *text = result || writer->out_of_json
                     ? NULL
                     : json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(17));
    if (!result && !text)
        result = result_fail(RESULT_NO_MEMORY, "%s: out of memory for the JSON text", path);
    if (!result && binary) {
        unsigned char *bytes = NULL;
        size_t count = 0;
        result = gltf_file_assemble(text, writer->bytes, writer->byte_count, &bytes, &count);
        if (!result)
            result = file_write(path, bytes, count);
        free(bytes);
    } else if (!result) {
        result = file_write(path, text, strlen(text));
    }
    free(text);
    json_decref(root);
    return result;
}

Result gltf_write(const Scene *scene, const char *path)
{
    int kind = gltf_file_kind(path);
    if (kind < 0)
        return result_fail(RESULT_BAD_INPUT, "%s: unknown extension, expected .gltf or .glb", path);
    for (size_t i = 0; i < scene->material_count; i++)
        if (scene->materials[i].occlusion != 1.0f)
            result_warn("%s: glTF has no factor for occlusion; material %zu's is dropped", path, i);
    Writer writer = {.scene = scene};
    writer.first_accessor = memory_array(scene->mesh_count, sizeof *writer.first_accessor);
    if (!writer.first_accessor)
        return RESULT_NO_MEMORY;
    memset(writer.first_accessor, 0xff, scene->mesh_count * sizeof *writer.first_accessor);
    writer.views = json_array();
    const GltfImageSink sink = {kind == 1 ? embed_image : NULL, &writer};
    Result result = gltf_texture_write(scene, path, &sink, &writer.textures);
    if (!result)
        result = write_document(&writer, path, kind == 1);
    gltf_texture_write_free(&writer.textures);
    json_decref(writer.views);
    free(writer.first_accessor);
    free(writer.pairs);
    free(writer.bytes);
    return result;
}

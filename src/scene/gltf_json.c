#include "scene/gltf_json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void gltf_json_free(GltfJson *json)
{
    json_decref(json->root);
    free(json->file);
    *json = (GltfJson){0};
}

/* ---- looking things up ---------------------------------------------------------------------- */

json_t *gltf_json_element(const GltfJson *json, const char *key, size_t index)
{
    return json_array_get(json_object_get(json->root, key), index);
}

size_t gltf_json_index(const json_t *object, const char *key, size_t fallback)
{
    const json_t *value = json_object_get(object, key);
    return json_is_integer(value) ? (size_t)json_integer_value(value) : fallback;
}

size_t gltf_json_component_bytes(size_t type)
{
    static const unsigned char sizes[] = {1, 1, 2, 2, 0, 4, 4};
    return type >= TYPE_INT8 && type <= TYPE_FLOAT ? sizes[type - TYPE_INT8] : 0;
}

bool gltf_json_drawn(const json_t *primitive)
{
    size_t mode = gltf_json_index(primitive, "mode", MODE_TRIANGLES);
    return mode >= MODE_TRIANGLES && mode <= MODE_FAN;
}

/* ---- reducing ------------------------------------------------------------------------------- */

/* A new object with those of the members that `from` has; they are shared, not copied. */
static json_t *pick(const json_t *from, const char *const *keys)
{
    json_t *object = json_object();
    for (; *keys; keys++) {
        json_t *value = json_object_get(from, *keys);
        if (value)
            json_object_set(object, *keys, value);
    }
    return object;
}

static json_t *reduced_mesh(const json_t *mesh)
{
    static const char *const mesh_keys[] = {"name", NULL};
    static const char *const keys[] = {"indices", "material", "mode", NULL};
    static const char *const attribute_keys[] = {"POSITION", "NORMAL", NULL};
    json_t *out = pick(mesh, mesh_keys), *primitives = json_array(), *primitive;
    size_t i;
    json_array_foreach(json_object_get(mesh, "primitives"), i, primitive)
    {
        if (!gltf_json_drawn(primitive))
            continue;
        json_t *kept = pick(primitive, keys);
        json_object_set_new(kept, "attributes",
                            pick(json_object_get(primitive, "attributes"), attribute_keys));
        json_array_append_new(primitives, kept);
    }
    json_object_set_new(out, "primitives", primitives);
    return out;
}

static json_t *reduced_material(const json_t *material)
{
    static const char *const keys[] = {"name", "alphaMode", "alphaCutoff", "doubleSided", NULL};
    static const char *const factors[] = {"baseColorFactor", "metallicFactor", "roughnessFactor",
                                          NULL};
    json_t *out = pick(material, keys);
    json_object_set_new(out, "pbrMetallicRoughness",
                        pick(json_object_get(material, "pbrMetallicRoughness"), factors));
    return out;
}

static json_t *reduced_node(const json_t *node)
{
    static const char *const keys[] = {"name",     "children", "matrix", "translation",
                                       "rotation", "scale",    "mesh",   NULL};
    return pick(node, keys);
}

static json_t *reduced_scene(const json_t *scene)
{
    static const char *const keys[] = {"nodes", NULL};
    return pick(scene, keys);
}

static json_t *reduced_buffer(const json_t *buffer)
{
    static const char *const keys[] = {"uri", "byteLength", NULL};
    return pick(buffer, keys);
}

/* A uri becomes its buffer's number. */
static void number_buffers(const json_t *buffers)
{
    json_t *buffer;
    size_t i;
    json_array_foreach(buffers, i, buffer)
    {
        if (json_object_get(buffer, "uri"))
            json_object_set_new(buffer, "uri", json_sprintf("%zu", i));
    }
}

static json_t *reduced_view(const json_t *view)
{
    static const char *const keys[] = {"buffer", "byteOffset", "byteLength", "byteStride", NULL};
    return pick(view, keys);
}

static json_t *reduced_accessor(const json_t *accessor)
{
    static const char *const keys[] = {"bufferView", "byteOffset", "componentType", "count", "type",
                                       "normalized", NULL};
    return pick(accessor, keys);
}

static void reduce_array(json_t *to, const json_t *from, const char *key,
                         json_t *(*reduce)(const json_t *))
{
    const json_t *array = json_object_get(from, key);
    if (!array)
        return;
    json_t *out = json_array(), *element;
    size_t i;
    json_array_foreach(array, i, element)
    {
        json_array_append_new(out, reduce(element));
    }
    json_object_set_new(to, key, out);
}

static void lengthen(json_t *object, size_t length)
{
    if (length > gltf_json_index(object, "byteLength", 0))
        json_object_set_new(object, "byteLength", json_integer((json_int_t)length));
}

/* Assimp wants a whole stride behind the last element, too, which glTF does not: a view that lacks
 * less than that gets it, and its buffer. */
static void complete_strides(const json_t *out)
{
    const json_t *views = json_object_get(out, "bufferViews");
    const json_t *accessor;
    size_t i;
    json_array_foreach(json_object_get(out, "accessors"), i, accessor)
    {
        json_t *view = json_array_get(views, gltf_json_index(accessor, "bufferView", SIZE_MAX));
        json_t *buffer = json_array_get(json_object_get(out, "buffers"),
                                        gltf_json_index(view, "buffer", SIZE_MAX));
        size_t stride = gltf_json_index(view, "byteStride", 0);
        size_t count = gltf_json_index(accessor, "count", 0);
        size_t room = gltf_json_index(view, "byteLength", 0);
        if (!buffer || count > UINT32_MAX)
            continue;
        size_t end = gltf_json_index(accessor, "byteOffset", 0) + stride * count;
        if (end <= room || end - room >= stride)
            continue;
        lengthen(view, end);
        lengthen(buffer, gltf_json_index(view, "byteOffset", 0) + end);
    }
}

json_t *gltf_json_reduced(const GltfJson *json)
{
    json_t *out = json_object(), *asset = json_object();
    json_object_set_new(asset, "version", json_string("2.0"));
    json_object_set_new(out, "asset", asset);
    json_object_set_new(out, "scene", json_integer((json_int_t)json->scene));
    reduce_array(out, json->root, "scenes", reduced_scene);
    reduce_array(out, json->root, "buffers", reduced_buffer);
    number_buffers(json_object_get(out, "buffers"));
    reduce_array(out, json->root, "bufferViews", reduced_view);
    reduce_array(out, json->root, "accessors", reduced_accessor);
    complete_strides(out);
    reduce_array(out, json->root, "meshes", reduced_mesh);
    reduce_array(out, json->root, "materials", reduced_material);
    reduce_array(out, json->root, "nodes", reduced_node);
    return out;
}

/* ---- warning -------------------------------------------------------------------------------- */

/* Appends ", text" as far as there is room. */
static void list(char *line, size_t size, const char *before, const char *text)
{
    size_t used = strlen(line);
    snprintf(line + used, size - used, "%s%s%s", used ? ", " : "", before, text);
}

void gltf_json_warn(const GltfJson *json, const char *path)
{
    static const char *const texts[NOTE_COUNT] = {
        [NOTE_TEXTURES] = "normal, occlusion and emissive textures",
        [NOTE_IMAGES] = "images other than PNG and JPEG",
        [NOTE_TEXTURE_TRANSFORMS] = "texture transforms",
        [NOTE_EMISSIVE] = "emissive colours",
        [NOTE_COLORS] = "vertex colours",
        [NOTE_UVS] = "metallic-roughness textures with other coordinates than the base colour's",
        [NOTE_NO_UVS] = "textures of surfaces without their coordinates",
        [NOTE_POINTS_LINES] = "points and lines",
        [NOTE_MORPHS] = "morph targets",
        [NOTE_SKINS] = "skins",
        [NOTE_ANIMATIONS] = "animations",
        [NOTE_ORTHOGRAPHIC] = "orthographic cameras",
        [NOTE_DIRECTIONAL] = "directional lights",
        [NOTE_SPOT] = "spot lights",
        [NOTE_SCENES] = "scenes other than the default",
    };
    char line[1024] = "";
    for (int i = 0; i < NOTE_COUNT; i++)
        if (json->notes & 1u << i)
            list(line, sizeof line, "", texts[i]);
    json_t *name;
    size_t i;
    json_array_foreach(json_object_get(json->root, "extensionsUsed"), i, name)
    {
        const char *text = json_string_value(name);
        if (text && strcmp(text, "KHR_lights_punctual") != 0)
            list(line, sizeof line, "extension ", text);
    }
    if (*line)
        result_warn("%s: not modelled and ignored: %s", path, line);
}

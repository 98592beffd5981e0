#include "scene/gltf_json.h"

#include "base/memory.h"
#include "scene/gltf_check.h"
#include "scene/gltf_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MODE_TRIANGLES = 4,
    MODE_FAN = 6
};

/* ---- reading -------------------------------------------------------------------------------- */

static uint32_t word(const unsigned char *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

/* Finds the chunks of a .glb of count bytes. Source: glTF 2.0, 4.4. */
static Result split_binary(const char *path, GltfJson *json, size_t count, const char **text,
                           size_t *length)
{
    const unsigned char *file = json->file;
    if (count < 20 || memcmp(file, "glTF", 4) != 0)
        return result_fail(RESULT_BAD_INPUT,
                           "%s: not a binary glTF file, expected to begin \"glTF\"", path);
    if (word(file + 4) != 2)
        return result_fail(RESULT_UNSUPPORTED, "%s: binary glTF version %u, expected 2", path,
                           word(file + 4));
    *text = (const char *)file + 20;
    *length = word(file + 12);
    if (memcmp(file + 16, "JSON", 4) != 0 || *length > count - 20 || word(file + 8) > count)
        return result_fail(RESULT_BAD_INPUT, "%s: truncated: %zu bytes, expected %u", path, count,
                           word(file + 8));
    size_t next = 20 + (*length + 3) / 4 * 4;
    if (count < next + 8)
        return RESULT_OK;
    if (memcmp(file + next + 4, "BIN", 4) != 0 || word(file + next) > count - next - 8)
        return result_fail(RESULT_BAD_INPUT, "%s: binary chunk is truncated or of unknown type",
                           path);
    json->binary = json->file + next + 8;
    json->binary_count = word(file + next);
    return RESULT_OK;
}

static Result check_version(const char *path, const json_t *root)
{
    const char *version =
        json_string_value(json_object_get(json_object_get(root, "asset"), "version"));
    if (!version)
        return result_fail(RESULT_BAD_INPUT, "%s: not a glTF file, expected asset.version", path);
    if (strncmp(version, "2.", 2) != 0)
        return result_fail(RESULT_UNSUPPORTED, "%s: glTF version %s, expected 2.0", path, version);
    return RESULT_OK;
}

static Result parse(const char *path, GltfJson *json)
{
    size_t count = 0, length = 0;
    const char *text = NULL;
    Result result = gltf_file_read(path, &json->file, &count);
    if (result)
        return result;
    if (gltf_file_kind(path) == 1) {
        result = split_binary(path, json, count, &text, &length);
    } else {
        text = (const char *)json->file;
        length = count;
        if (count >= 4 && memcmp(text, "glTF", 4) == 0)
            result =
                result_fail(RESULT_BAD_INPUT, "%s: binary glTF, expected the extension .glb", path);
    }
    if (result)
        return result;
    json_error_t error;
    json->root = json_loadb(text, length, JSON_REJECT_DUPLICATES, &error);
    if (!json->root)
        return result_fail(RESULT_BAD_INPUT, "%s: not glTF: line %d, column %d: %s", path,
                           error.line, error.column, error.text);
    return check_version(path, json->root);
}

Result gltf_json_read(const char *path, GltfJson *out)
{
    GltfJson json = {0};
    *out = json;
    if (gltf_file_kind(path) < 0)
        return result_fail(RESULT_BAD_INPUT, "%s: unknown extension, expected .gltf or .glb", path);
    Result result = parse(path, &json);
    if (!result)
        result = gltf_check(path, &json);
    if (result)
        gltf_json_free(&json);
    else
        *out = json;
    return result;
}

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
    static const char *const attribute_keys[] = {"POSITION", "NORMAL", "TEXCOORD_0", NULL};
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

json_t *gltf_json_reduced(const GltfJson *json)
{
    static const char *const keys[] = {"asset",       "scenes",    "buffers",
                                       "bufferViews", "accessors", NULL};
    json_t *out = pick(json->root, keys);
    json_object_set_new(out, "scene", json_integer((json_int_t)json->scene));
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
        [NOTE_TEXTURES] = "textures",
        [NOTE_EMISSIVE] = "emissive colours",
        [NOTE_COLORS] = "vertex colours",
        [NOTE_UVS] = "texture coordinates other than one set of floats",
        [NOTE_POINTS_LINES] = "points and lines",
        [NOTE_MORPHS] = "morph targets",
        [NOTE_SKINS] = "skins",
        [NOTE_ANIMATIONS] = "animations",
        [NOTE_ORTHOGRAPHIC] = "orthographic cameras",
        [NOTE_DIRECTIONAL] = "directional lights",
        [NOTE_SPOT] = "spot lights",
        [NOTE_RANGE] = "the range of lights",
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

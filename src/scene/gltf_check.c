#include "scene/gltf_check.h"

#include "scene/gltf_file.h"
#include "scene/gltf_surface.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static Result check_arrays(const GltfCheck *check)
{
    static const char *const keys[] = {"buffers",    "bufferViews", "accessors", "meshes",
                                       "nodes",      "scenes",      "materials", "cameras",
                                       "animations", "textures",    "samplers",  "images"};
    for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++) {
        const json_t *array = gltf_array(check, keys[k]), *element;
        size_t i;
        if (array && !json_is_array(array))
            return result_fail(RESULT_BAD_INPUT, "%s: %s: expected an array", check->path, keys[k]);
        json_array_foreach(array, i, element)
        {
            if (!json_is_object(element))
                return gltf_fail(check, keys[k], i, "an object");
        }
    }
    return RESULT_OK;
}

/* Extensions that must be understood: those that change only how a surface looks are warned of. */
static Result check_extensions(const GltfCheck *check)
{
    static const char *const harmless[] = {"KHR_lights_punctual", "KHR_materials_", "KHR_texture_",
                                           "EXT_texture_"};
    const json_t *names = gltf_array(check, "extensionsRequired"), *name;
    size_t i;
    if (names && !json_is_array(names))
        return result_fail(RESULT_BAD_INPUT, "%s: extensionsRequired: expected an array",
                           check->path);
    json_array_foreach(names, i, name)
    {
        const char *text = json_string_value(name);
        bool known = false;
        for (size_t k = 0; text && k < sizeof harmless / sizeof harmless[0]; k++)
            known = known || strncmp(text, harmless[k], strlen(harmless[k])) == 0;
        if (!known)
            return result_fail(RESULT_UNSUPPORTED,
                               "%s: requires the extension %s, which is not modelled", check->path,
                               text ? text : "?");
    }
    return RESULT_OK;
}

/* ---- buffers and accessors ------------------------------------------------------------------ */

/* An embedded buffer is as long as it says. */
static Result check_embedded(const GltfCheck *check, size_t index, const char *uri, size_t expected)
{
    unsigned char *bytes = NULL;
    size_t count = 0;
    Result result = gltf_file_uri(check->path, "buffer", index, uri, &bytes, &count);
    free(bytes);
    if (!result && count < expected)
        result = result_fail(RESULT_BAD_INPUT,
                             "%s: buffer %zu: its data uri is truncated: %zu bytes, expected %zu",
                             check->path, index, count, expected);
    return result;
}

/* An external one: Assimp leaks the open file when it is not. */
static Result check_external(const GltfCheck *check, size_t index, const char *uri, size_t expected)
{
    struct stat info;
    char *path = NULL;
    Result result = gltf_file_beside(check->path, uri, &path);
    if (result)
        return result;
    bool found = stat(path, &info) == 0 && S_ISREG(info.st_mode);
    free(path);
    if (!found)
        return result_fail(RESULT_BAD_INPUT, "%s: buffer %zu: no file %s beside it", check->path,
                           index, uri);
    if ((uint64_t)info.st_size < expected)
        return result_fail(RESULT_BAD_INPUT,
                           "%s: buffer %zu: %s is truncated: %lld bytes, expected %zu", check->path,
                           index, uri, (long long)info.st_size, expected);
    return RESULT_OK;
}

static Result check_buffer(const GltfCheck *check, size_t index, const json_t *buffer)
{
    const json_t *uri = json_object_get(buffer, "uri");
    const char *text = json_string_value(uri);
    size_t bytes = gltf_json_index(buffer, "byteLength", 0);
    if (!gltf_required_index(buffer, "byteLength", SIZE_MAX))
        return gltf_fail(check, "buffer", index, "a byteLength");
    if (uri && !text)
        return gltf_fail(check, "buffer", index, "a string as its uri");
    if (!uri && (index != 0 || bytes > check->json->binary_count))
        return gltf_fail(check, "buffer", index,
                         "a uri, or a binary chunk as long as its byteLength");
    if (!uri)
        return RESULT_OK;
    return strncmp(text, "data:", 5) == 0 ? check_embedded(check, index, text, bytes)
                                          : check_external(check, index, text, bytes);
}

static Result check_views(const GltfCheck *check)
{
    const json_t *element;
    size_t i;
    json_array_foreach(gltf_array(check, "buffers"), i, element)
    {
        Result result = check_buffer(check, i, element);
        if (result)
            return result;
    }
    json_array_foreach(gltf_array(check, "bufferViews"), i, element)
    {
        if (!gltf_required_index(element, "buffer", gltf_count(check, "buffers")))
            return gltf_fail(check, "bufferView", i, "a buffer that exists");
        const json_t *buffer =
            gltf_json_element(check->json, "buffers", gltf_json_index(element, "buffer", 0));
        size_t room = gltf_json_index(buffer, "byteLength", 0);
        if (!gltf_required_index(element, "byteLength", room + 1) ||
            !gltf_valid_index(json_object_get(element, "byteOffset"),
                              room - gltf_json_index(element, "byteLength", 0) + 1))
            return gltf_fail(check, "bufferView", i, "a range within its buffer");
        if (!gltf_valid_index(json_object_get(element, "byteStride"), GLTF_STRIDE_END))
            return gltf_fail(check, "bufferView", i, "a byteStride of at most 252");
    }
    return RESULT_OK;
}

/* Components of an accessor that geometry may use; 0 for the others. */
static size_t component_count(const json_t *accessor)
{
    static const char *const shapes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const char *shape = json_string_value(json_object_get(accessor, "type"));
    for (size_t i = 0; shape && i < sizeof shapes / sizeof shapes[0]; i++)
        if (strcmp(shape, shapes[i]) == 0)
            return i + 1;
    return 0;
}

/* An accessor of the given shape, its data within its view. */
static Result check_accessor(const GltfCheck *check, size_t index, size_t components)
{
    const json_t *accessor = gltf_json_element(check->json, "accessors", index);
    size_t bytes =
        gltf_json_component_bytes(gltf_json_index(accessor, "componentType", 0)) * components;
    size_t count = gltf_json_index(accessor, "count", 0);
    if (!bytes || component_count(accessor) != components)
        return gltf_fail(check, "accessor", index, "the type that its use asks for");
    if (!gltf_required_index(accessor, "count", UINT32_MAX) || count == 0)
        return gltf_fail(check, "accessor", index, "a count from 1 to 2^32 - 2");
    if (json_object_get(accessor, "sparse"))
        return result_fail(RESULT_UNSUPPORTED, "%s: accessor %zu: sparse, which is not modelled",
                           check->path, index);
    if (!gltf_required_index(accessor, "bufferView", gltf_count(check, "bufferViews")))
        return gltf_fail(check, "accessor", index, "a bufferView that exists");
    const json_t *view =
        gltf_json_element(check->json, "bufferViews", gltf_json_index(accessor, "bufferView", 0));
    size_t stride = gltf_json_index(view, "byteStride", 0), room, needed;
    stride = stride ? stride : bytes;
    room = gltf_json_index(view, "byteLength", 0);
    needed = stride * (count - 1) + bytes;
    if (stride < bytes || needed > room ||
        !gltf_valid_index(json_object_get(accessor, "byteOffset"), room - needed + 1))
        return gltf_fail(check, "accessor", index, "data within its bufferView");
    return RESULT_OK;
}

/* ---- meshes --------------------------------------------------------------------------------- */

/* What the components of an attribute may be: floats, or for texture coordinates also normalised
 * unsigned integers. */
static bool attribute_type(const json_t *accessor, bool integers)
{
    size_t type = gltf_json_index(accessor, "componentType", 0);
    return type == TYPE_FLOAT || (integers && (type == TYPE_UINT8 || type == TYPE_UINT16) &&
                                  json_is_true(json_object_get(accessor, "normalized")));
}

/* A vertex attribute with as many elements as POSITION; absent is fine. */
static Result check_attribute(const GltfCheck *check, size_t mesh, const json_t *attributes,
                              const char *name, size_t components)
{
    const json_t *value = json_object_get(attributes, name);
    bool integers = strncmp(name, "TEXCOORD_", 9) == 0;
    if (!value)
        return RESULT_OK;
    if (!gltf_valid_index(value, gltf_count(check, "accessors")))
        return gltf_fail(check, "mesh", mesh, "attributes whose accessors exist");
    size_t index = (size_t)json_integer_value(value);
    Result result = check_accessor(check, index, components);
    if (result)
        return result;
    const json_t *accessor = gltf_json_element(check->json, "accessors", index);
    const json_t *position =
        gltf_json_element(check->json, "accessors", gltf_json_index(attributes, "POSITION", 0));
    if (!attribute_type(accessor, integers))
        return gltf_fail(check, "accessor", index,
                         integers
                             ? "floats or normalized unsigned bytes or shorts for its attribute"
                             : "floats for a vertex attribute");
    if (gltf_json_index(accessor, "count", 0) != gltf_json_index(position, "count", 1))
        return gltf_fail(check, "mesh", mesh, "the same count for all attributes");
    return RESULT_OK;
}

static void note_colors(const GltfCheck *check, const json_t *attributes)
{
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)attributes, key, value)
    {
        if (strncmp(key, "COLOR_", 6) == 0)
            gltf_note(check, NOTE_COLORS);
    }
}

static Result check_indices(const GltfCheck *check, size_t mesh, const json_t *primitive)
{
    const json_t *attributes = json_object_get(primitive, "attributes");
    const json_t *value = json_object_get(primitive, "indices");
    size_t source =
        gltf_json_index(value ? primitive : attributes, value ? "indices" : "POSITION", SIZE_MAX);
    if (value) {
        if (!gltf_valid_index(value, gltf_count(check, "accessors")))
            return gltf_fail(check, "mesh", mesh, "indices whose accessor exists");
        Result result = check_accessor(check, source, 1);
        if (result)
            return result;
        size_t type = gltf_json_index(gltf_json_element(check->json, "accessors", source),
                                      "componentType", 0);
        if (type != TYPE_UINT8 && type != TYPE_UINT16 && type != TYPE_UINT32)
            return gltf_fail(check, "accessor", source, "unsigned integers for indices");
    }
    size_t count = gltf_json_index(gltf_json_element(check->json, "accessors", source), "count", 0);
    if (count < 3 ||
        (gltf_json_index(primitive, "mode", MODE_TRIANGLES) == MODE_TRIANGLES && count % 3 != 0))
        return gltf_fail(check, "mesh", mesh, "whole triangles in every primitive");
    return RESULT_OK;
}

static Result check_primitive(const GltfCheck *check, size_t mesh, const json_t *primitive)
{
    const json_t *attributes = json_object_get(primitive, "attributes");
    if (!json_is_object(primitive) || !json_is_object(attributes) ||
        !gltf_valid_index(json_object_get(primitive, "mode"), MODE_FAN + 1))
        return gltf_fail(check, "mesh", mesh, "primitives with attributes and a mode up to 6");
    if (!gltf_json_drawn(primitive)) {
        gltf_note(check, NOTE_POINTS_LINES);
        return RESULT_OK;
    }
    if (!json_object_get(attributes, "POSITION"))
        return gltf_fail(check, "mesh", mesh, "a POSITION in every primitive");
    if (!gltf_valid_index(json_object_get(primitive, "material"), gltf_count(check, "materials")))
        return gltf_fail(check, "mesh", mesh, "materials that exist");
    char uv[UV_NAME_SIZE];
    if (gltf_surface_uv_name(check->json, primitive, uv) && !json_object_get(attributes, uv))
        gltf_note(check, NOTE_NO_UVS);
    note_colors(check, attributes);
    if (json_object_get(primitive, "targets"))
        gltf_note(check, NOTE_MORPHS);
    Result result = check_attribute(check, mesh, attributes, "POSITION", 3);
    if (!result)
        result = check_attribute(check, mesh, attributes, "NORMAL", 3);
    if (!result)
        result = check_attribute(check, mesh, attributes, uv, 2);
    return result ? result : check_indices(check, mesh, primitive);
}

static Result check_meshes(const GltfCheck *check)
{
    const json_t *mesh, *primitive;
    size_t i, k;
    json_array_foreach(gltf_array(check, "meshes"), i, mesh)
    {
        const json_t *primitives = json_object_get(mesh, "primitives");
        if (!json_is_array(primitives) || json_array_size(primitives) == 0)
            return gltf_fail(check, "mesh", i, "at least one primitive");
        json_array_foreach(primitives, k, primitive)
        {
            Result result = check_primitive(check, i, primitive);
            if (result)
                return result;
        }
    }
    return RESULT_OK;
}

/* ---- shared with the other checks
 * ----------------------------------------------------------------- */

Result gltf_fail(const GltfCheck *check, const char *what, size_t index, const char *expected)
{
    return result_fail(RESULT_BAD_INPUT, "%s: %s %zu: expected %s", check->path, what, index,
                       expected);
}

const json_t *gltf_array(const GltfCheck *check, const char *key)
{
    return json_object_get(check->json->root, key);
}

size_t gltf_count(const GltfCheck *check, const char *key)
{
    return json_array_size(gltf_array(check, key));
}

bool gltf_valid_index(const json_t *value, size_t limit)
{
    return !value || (json_is_integer(value) && json_integer_value(value) >= 0 &&
                      (size_t)json_integer_value(value) < limit);
}

bool gltf_required_index(const json_t *object, const char *key, size_t limit)
{
    const json_t *value = json_object_get(object, key);
    return value && gltf_valid_index(value, limit);
}

bool gltf_valid_numbers(const json_t *value, size_t count)
{
    const json_t *element;
    size_t i;
    if (!value)
        return true;
    if (!json_is_array(value) || json_array_size(value) != count)
        return false;
    json_array_foreach(value, i, element)
    {
        if (!json_is_number(element))
            return false;
    }
    return true;
}

void gltf_note(const GltfCheck *check, GltfNote which)
{
    check->json->notes |= 1u << which;
}

Result gltf_check(const char *path, GltfJson *json)
{
    GltfCheck check = {path, json};
    Result result = check_arrays(&check);
    if (!result)
        result = check_extensions(&check);
    if (!result)
        result = check_views(&check);
    if (!result)
        result = gltf_surface_check(&check);
    return result ? result : check_meshes(&check);
}

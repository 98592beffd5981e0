#include "scene/gltf_read.h"

#include "base/file.h"
#include "base/json_memory.h"
#include "scene/gltf_check.h"
#include "scene/gltf_file.h"
#include "scene/gltf_graph.h"

#include <math.h>
#include <string.h>

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
    if (memcmp(file + 16, "JSON", 4) != 0)
        return result_fail(RESULT_BAD_INPUT, "%s: expected JSON as the first chunk", path);
    if (word(file + 8) > count)
        return result_fail(RESULT_BAD_INPUT, "%s: truncated: %zu bytes, expected %u", path, count,
                           word(file + 8));
    count = word(file + 8); /* what is behind is not of the file */
    if (count < 20 || *length > count - 20)
        return result_fail(RESULT_BAD_INPUT, "%s: JSON of %zu bytes in a file of %zu", path,
                           *length, count);
    size_t chunk;
    for (size_t next = 20 + (*length + 3) / 4 * 4; count >= next + 8; next += 8 + chunk) {
        chunk = ((size_t)word(file + next) + 3) / 4 * 4;
        if (word(file + next) > count - next - 8)
            return result_fail(RESULT_BAD_INPUT, "%s: a chunk of %u bytes is truncated", path,
                               word(file + next));
        if (memcmp(file + next + 4, "BIN", 4) == 0) { /* others are an extension's */
            json->binary = json->file + next + 8;
            json->binary_count = word(file + next);
            return RESULT_OK;
        }
    }
    return RESULT_OK;
}

static Result check_version(const char *path, const json_t *root)
{
    const char *version =
        json_string_value(json_object_get(json_object_get(root, "asset"), "version"));
    if (!version)
        return result_fail(RESULT_BAD_INPUT, "%s: not a glTF file, expected asset.version", path);
    const char *least =
        json_string_value(json_object_get(json_object_get(root, "asset"), "minVersion"));
    if (strncmp(version, "2.", 2) != 0 || (least && strcmp(least, "2.0") != 0))
        return result_fail(RESULT_UNSUPPORTED, "%s: glTF version %s, expected 2.0", path,
                           least ? least : version);
    return RESULT_OK;
}

/* A number that is whole and exact in double as an integer; else itself. */
static json_t *whole(json_t *value)
{
    double number = json_is_real(value) ? json_real_value(value) : 0.5;
    bool is_whole =
        floor(number) == number && fabs(number) <= 0x1p53 && (number || !signbit(number));
    return is_whole ? json_integer((json_int_t)number) : json_incref(value);
}

/* 4, 4.0 and 4e0 are one number. Source: glTF 2.0, 2.8 (JSON encoding). */
static void make_whole(json_t *value)
{
    const char *key;
    void *next;
    json_t *part;
    size_t i;
    json_object_foreach_safe(value, next, key, part)
    {
        make_whole(part);
        json_object_set_new(value, key, whole(part));
    }
    json_array_foreach(value, i, part)
    {
        make_whole(part);
        json_array_set_new(value, i, whole(part));
    }
}

static Result parse(const char *path, GltfJson *json)
{
    size_t count = 0, length = 0;
    const char *text = NULL;
    Result result = file_load(path, &json->file, &count);
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
    json_memory_begin();
    /* Integers of any size, in extras, say; of equal names the last counts, as glTF advises. */
    json->root = json_loadb(text, length, JSON_DECODE_INT_AS_REAL, &error);
    make_whole(json->root);
    result = json_memory_check(path, RESULT_OK);
    if (result)
        return result;
    if (!json->root)
        return result_fail(RESULT_BAD_INPUT, "%s: not glTF: line %d, column %d: %s", path,
                           error.line, error.column, error.text);
    return check_version(path, json->root);
}

Result gltf_read(const char *path, GltfJson *out)
{
    GltfJson json = {0};
    *out = json;
    if (gltf_file_kind(path) < 0)
        return result_fail(RESULT_BAD_INPUT, "%s: unknown extension, expected .gltf or .glb", path);
    Result result = parse(path, &json);
    if (!result)
        result = gltf_check(path, &json);
    if (!result)
        result = gltf_graph_check(path, &json);
    if (result)
        gltf_json_free(&json);
    else
        *out = json;
    return result;
}

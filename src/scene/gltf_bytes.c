#include "scene/gltf_bytes.h"

#include "base/file.h"
#include "base/memory.h"
#include "scene/gltf_file.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

void gltf_bytes_free(GltfBytes *bytes)
{
    size_t count = json_array_size(json_object_get(bytes->json->root, "buffers"));
    for (size_t i = 0; bytes->buffers && i < count; i++)
        free(bytes->buffers[i].owned);
    free(bytes->buffers);
    bytes->buffers = NULL;
}

static Result read_uri(const GltfBytes *bytes, const char *what, size_t index, const char *uri,
                       GltfSpan *out)
{
    Result result = gltf_file_uri(bytes->path, what, index, uri, &out->owned, &out->count);
    out->bytes = out->owned;
    return result;
}

static Result read_buffer(GltfBytes *bytes, size_t index, const GltfSpan **out)
{
    const json_t *buffer = gltf_json_element(bytes->json, "buffers", index);
    const char *uri = json_string_value(json_object_get(buffer, "uri"));
    size_t expected = gltf_json_index(buffer, "byteLength", 0);
    if (!bytes->buffers)
        bytes->buffers = memory_array(
            json_array_size(json_object_get(bytes->json->root, "buffers")), sizeof *bytes->buffers);
    if (!bytes->buffers)
        return RESULT_NO_MEMORY;
    GltfSpan *span = &bytes->buffers[index];
    *out = span;
    if (span->bytes)
        return RESULT_OK;
    if (!uri) {
        *span = (GltfSpan){.bytes = bytes->json->binary, .count = bytes->json->binary_count};
        return RESULT_OK;
    }
    Result result = read_uri(bytes, "buffer", index, uri, span);
    if (!result && span->count < expected) {
        result = result_fail(RESULT_BAD_INPUT, "%s: buffer %zu: %zu bytes, expected %zu",
                             bytes->path, index, span->count, expected);
        free(span->owned);
        *span = (GltfSpan){0};
    }
    return result;
}

/* A view's bytes, which the check found within the buffer's length. */
static Result read_view(GltfBytes *bytes, size_t index, GltfSpan *out)
{
    const json_t *view = gltf_json_element(bytes->json, "bufferViews", index);
    const GltfSpan *buffer = NULL;
    Result result = read_buffer(bytes, gltf_json_index(view, "buffer", 0), &buffer);
    if (result)
        return result;
    if (buffer->bytes) /* else it is empty, and so is every view of it */
        *out = (GltfSpan){.bytes = buffer->bytes + gltf_json_index(view, "byteOffset", 0),
                          .count = gltf_json_index(view, "byteLength", 0)};
    return RESULT_OK;
}

Result gltf_bytes_image(GltfBytes *bytes, size_t image, GltfSpan *out)
{
    const json_t *from = gltf_json_element(bytes->json, "images", image);
    const char *uri = json_string_value(json_object_get(from, "uri"));
    *out = (GltfSpan){0};
    return uri ? read_uri(bytes, "image", image, uri, out)
               : read_view(bytes, gltf_json_index(from, "bufferView", 0), out);
}

static uint64_t file_bytes(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISREG(info.st_mode) ? (uint64_t)info.st_size : 0;
}

Result gltf_bytes_files(const GltfBytes *bytes, GltfFile file, void *context)
{
    static const char *const arrays[] = {"buffers", "images"};
    Result result = file(context, bytes->path, file_bytes(bytes->path));
    for (int k = 0; k < 2; k++) {
        const json_t *element;
        size_t i;
        json_array_foreach(json_object_get(bytes->json->root, arrays[k]), i, element)
        {
            const char *uri = json_string_value(json_object_get(element, "uri"));
            char *path = NULL;
            if (uri && strncmp(uri, "data:", 5) != 0 &&
                gltf_file_beside(bytes->path, uri, &path) == RESULT_OK && !result)
                result = file(context, path, file_bytes(path));
            free(path);
        }
    }
    return result;
}

static float float_at(const unsigned char *at)
{
    uint32_t bits = at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Source: glTF 2.0, 3.6.2.2 (normalized integers). */
static float component_at(const unsigned char *at, size_t type)
{
    switch (type) {
    case TYPE_UINT8:
        return (float)at[0] / 255.0f;
    case TYPE_UINT16:
        return (float)(at[0] | at[1] << 8) / 65535.0f;
    default:
        return float_at(at);
    }
}

Result gltf_bytes_uv(GltfBytes *bytes, size_t accessor, float **out)
{
    const json_t *from = gltf_json_element(bytes->json, "accessors", accessor);
    size_t number = gltf_json_index(from, "bufferView", 0);
    const json_t *view = gltf_json_element(bytes->json, "bufferViews", number);
    size_t type = gltf_json_index(from, "componentType", 0);
    size_t count = gltf_json_index(from, "count", 0), size = gltf_json_component_bytes(type);
    size_t stride = gltf_json_index(view, "byteStride", 0);
    stride = stride ? stride : 2 * size;
    GltfSpan span = {0};
    *out = NULL;
    Result result = read_view(bytes, number, &span);
    if (result)
        return result;
    assert(span.bytes || count == 0); /* by the check of lengths */
    float *uv = memory_array(count, 2 * sizeof *uv);
    if (!uv)
        return RESULT_NO_MEMORY;
    const unsigned char *at = span.bytes + gltf_json_index(from, "byteOffset", 0);
    for (size_t i = 0; i < count; i++) {
        uv[2 * i] = component_at(at + i * stride, type);
        uv[2 * i + 1] = component_at(at + i * stride + size, type);
    }
    *out = uv;
    return RESULT_OK;
}

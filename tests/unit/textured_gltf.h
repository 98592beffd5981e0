/* A textured quad for tests, with texture coordinates of every type. */
#ifndef PEEL_TESTS_TEXTURED_GLTF_H
#define PEEL_TESTS_TEXTURED_GLTF_H

#include "small_gltf.h"
#include "small_png.h"

/* Coordinates that 1 − v would not give back. */
static const float textured_uv[8] = {0.1f, 1e-30f, -3.7f, 1e-9f, 0.3f, 16777217.0f, 2.5f, 0.7f};
static const uint16_t textured_shorts[8] = {0, 65535, 1, 32768, 40000, 3, 12345, 54321};
/* Four bytes apart. */
static const uint8_t textured_bytes[16] = {0, 255, 9, 9, 1, 128, 9, 9, 200, 3, 9, 9, 77, 99, 9, 9};

/* Accessors: 0 positions, 1 normals, 2 to 4 the coordinates above, 5 indices 0 1 2 0 2 3,
 * 6 indices 3 1 2 (vertex 0 unused). View 6 is what the image holds. */
static inline const char *write_textured(const char *members, const SmallPng *image)
{
    static char text[16384];
    static const uint16_t order[3] = {3, 1, 2};
    unsigned char bytes[180 + sizeof image->bytes];
    size_t extra = image ? image->count : 0;
    memcpy(bytes, quad, 96);
    memcpy(bytes + 96, textured_uv, 32);
    memcpy(bytes + 128, textured_shorts, 16);
    memcpy(bytes + 144, textured_bytes, 16);
    memcpy(bytes + 160, quad_indices, 12);
    memcpy(bytes + 172, order, 6);
    memset(bytes + 178, 0, 2);
    if (image)
        memcpy(bytes + 180, image->bytes, extra);
    char *uri = gltf_file_data_uri("application/octet-stream", bytes, 180 + extra);
    ck_assert_ptr_nonnull(uri);
    int length = snprintf(
        text, sizeof text,
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu,\"uri\":\"%s\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},"
        "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":48},"
        "{\"buffer\":0,\"byteOffset\":96,\"byteLength\":32},"
        "{\"buffer\":0,\"byteOffset\":128,\"byteLength\":16},"
        "{\"buffer\":0,\"byteOffset\":144,\"byteLength\":16,\"byteStride\":4},"
        "{\"buffer\":0,\"byteOffset\":160,\"byteLength\":18},"
        "{\"buffer\":0,\"byteOffset\":180,\"byteLength\":%zu}],\"accessors\":["
        "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
        "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
        "{\"bufferView\":2,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
        "{\"bufferView\":3,\"componentType\":5123,\"count\":4,\"type\":\"VEC2\","
        "\"normalized\":true},{\"bufferView\":4,\"componentType\":5121,\"count\":4,"
        "\"type\":\"VEC2\",\"normalized\":true},"
        "{\"bufferView\":5,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"},"
        "{\"bufferView\":5,\"byteOffset\":12,\"componentType\":5123,\"count\":3,"
        "\"type\":\"SCALAR\"}]," ONE_NODE ",%s}",
        180 + extra, uri, extra, members);
    free(uri);
    ck_assert_int_lt(length, (int)sizeof text);
    const char *path = scratch_path("textured.gltf");
    write_text(path, text);
    return path;
}

static inline void load_textured(const char *members, const SmallPng *image, Scene *out)
{
    load(write_textured(members, image), out);
}

/* A whole "images" element with the file embedded; valid until the fourth next call. */
static inline const char *image_member(const SmallPng *png)
{
    static char texts[4][2048];
    static int next;
    char *uri = gltf_file_data_uri("image/png", png->bytes, png->count);
    ck_assert_ptr_nonnull(uri);
    next = (next + 1) % 4;
    ck_assert_uint_lt(strlen(uri) + 12, sizeof texts[next]);
    snprintf(texts[next], sizeof texts[next], "{\"uri\":\"%s\"}", uri);
    free(uri);
    return texts[next];
}

/* 2 × 1 texels: red 64, green 128, blue 255, alpha 51; and their like. */
static const uint8_t textured_pixels[8] = {64, 128, 255, 51, 1, 2, 3, 255};

static inline SmallPng textured_png(void)
{
    return png_make(2, 1, 8, PNG_RGBA, textured_pixels, 8);
}

#define TEXTURED_ATTRIBUTES "{\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2}"
#define TEXTURED_MESH                                                                              \
    "\"meshes\":[{\"primitives\":[{\"attributes\":" TEXTURED_ATTRIBUTES                            \
    ",\"indices\":5,\"material\":0}]}]"

/* A material with texture 0 as its base colour. */
#define BASE_COLOR_0 "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}"
/* The mesh, the image of view 6, textures, and one material with the given texture infos. */
#define STORED_IMAGE "\"images\":[{\"bufferView\":6,\"mimeType\":\"image/png\"}]"
#define WITH(textures, infos)                                                                      \
    TEXTURED_MESH "," STORED_IMAGE ",\"textures\":[" textures                                      \
                  "],\"materials\":[{\"pbrMetallicRoughness\":{" infos "}}]"

#endif

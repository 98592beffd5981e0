/* Small glTF files for tests, and what is expected of loading them. */
#ifndef PEEL_TESTS_SMALL_GLTF_H
#define PEEL_TESTS_SMALL_GLTF_H

#include "scene/gltf.h"
#include "scene/gltf_file.h"

#include "scratch.h"
#include "testing.h"

#include <stdio.h>

/* Buffer of one quad: positions (48 bytes), normals (48), indices 0 1 2 0 2 3 (12), strip 0 1 3
 * 2 (8), all as accessors 0 to 3; accessor 4 is the positions
 * again, 5 the normals' floats as texture coordinates. */
static const float quad[24] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0,
                               0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
static const uint16_t quad_indices[10] = {0, 1, 2, 0, 2, 3, 0, 1, 3, 2};

static inline void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert(fputs(text, file) >= 0);
    fclose(file);
}

/* A document with the quad's buffer and the given members (from after the comma on). */
static inline const char *write_quad(const float *floats, const char *members)
{
    static char text[8192];
    unsigned char bytes[116];
    memcpy(bytes, floats, 96);
    memcpy(bytes + 96, quad_indices, 20);
    char *uri = gltf_file_data_uri("application/octet-stream", bytes, sizeof bytes);
    ck_assert_ptr_nonnull(uri);
    snprintf(text, sizeof text,
             "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,"
             "\"buffers\":[{\"byteLength\":116,\"uri\":\"%s\"}],\"bufferViews\":["
             "{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":48},"
             "{\"buffer\":0,\"byteOffset\":96,\"byteLength\":12},"
             "{\"buffer\":0,\"byteOffset\":108,\"byteLength\":8}],\"accessors\":["
             "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
             "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
             "{\"bufferView\":2,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"},"
             "{\"bufferView\":3,\"componentType\":5123,\"count\":4,\"type\":\"SCALAR\"},"
             "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
             "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"}],%s}",
             uri, members);
    free(uri);
    const char *path = scratch_path("small.gltf");
    write_text(path, text);
    return path;
}

/* One triangle without indices, its 36 bytes in the file that uri names. */
static inline const char *write_external(const char *uri)
{
    char text[1024];
    snprintf(text, sizeof text,
             "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],"
             "\"nodes\":[{\"mesh\":0}],\"buffers\":[{\"byteLength\":36,\"uri\":\"%s\"}],"
             "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,"
             "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}",
             uri);
    const char *path = scratch_path("external.gltf");
    write_text(path, text);
    return path;
}

#define QUAD_MESH                                                                                  \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2}]}]"
#define ONE_NODE "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}]"

/* Members, for snprintf: the quad and a point light on a scaled node, its range to be filled in. */
#define LIGHT_OF_RANGE                                                                             \
    QUAD_MESH ",\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0},{\"scale\":[2,2,2],"        \
              "\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],"                          \
              "\"extensionsUsed\":[\"KHR_lights_punctual\"],\"extensions\":{"                      \
              "\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\",\"range\":%s}]}}"

static inline void load(const char *path, Scene *out)
{
    Result result = gltf_load(path, out);
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

static inline void load_quad(const char *members, Scene *out)
{
    load(write_quad(quad, members), out);
}

/* What loading the file gave is as expected: no scene, and one line that names it and contains
 * part. */
static inline void refused_so(const char *path, Result result, const Scene *scene, Result expected,
                              const char *part)
{
    ck_assert_msg(result == expected, "%s: got %s, expected %s", path, result_text(result),
                  result_text(expected));
    ck_assert_ptr_null(scene->meshes);
    ck_assert_msg(strstr(result_message(), part) &&
                      strncmp(result_message(), path, strlen(path)) == 0,
                  "got \"%s\", expected \"%s\" in it", result_message(), part);
    ck_assert_ptr_null(strchr(result_message(), '\n'));
}

static inline void refused_file(const char *path, Result expected, const char *part)
{
    Scene scene;
    Result result = gltf_load(path, &scene);
    refused_so(path, result, &scene, expected, part);
}

static inline void refused(const char *members, Result expected, const char *part)
{
    refused_file(write_quad(quad, members), expected, part);
}

#endif

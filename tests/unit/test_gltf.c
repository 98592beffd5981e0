/* glTF out and in: what is written comes back, what is broken is refused, what is ignored is said.
 */
#include "base/file.h"
#include "scene/generate.h"

#include "current_gltf.h"
#include "small_gltf.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

/* ---- there and back ------------------------------------------------------------------------- */

static void same_mesh(const Mesh *a, const Mesh *b)
{
    ck_assert_uint_eq(a->vertex_count, b->vertex_count);
    ck_assert_uint_eq(a->triangle_count, b->triangle_count);
    ck_assert_mem_eq(a->position, b->position, (size_t)a->vertex_count * 3 * sizeof(float));
    ck_assert_mem_eq(a->normal, b->normal, (size_t)a->vertex_count * 3 * sizeof(float));
    ck_assert_mem_eq(a->index, b->index, (size_t)a->triangle_count * 3 * sizeof(uint32_t));
}

static void same_material(const Material *a, const Material *b)
{
    ck_assert_str_eq(a->name, b->name);
    ck_assert_mem_eq(a->base_color, b->base_color, sizeof a->base_color);
    ck_assert_float_bits(a->roughness, b->roughness);
    ck_assert_float_bits(a->metallic, b->metallic);
    ck_assert_float_bits(a->occlusion, b->occlusion);
    ck_assert_int_eq(a->alpha_mode, b->alpha_mode);
    ck_assert_int_eq(a->double_sided, b->double_sided);
}

static void same_matrix(const Matrix *a, const Matrix *b)
{
    float x[16], y[16];
    matrix_round(a, x);
    matrix_round(b, y);
    for (int i = 0; i < 16; i++)
        ck_assert(x[i] == y[i]); /* −0 may come back as 0 */
}

static void same_light(const Light *a, const Light *b)
{
    ck_assert_mem_eq(a->position, b->position, sizeof a->position);
    ck_assert_mem_eq(a->color, b->color, sizeof a->color);
    ck_assert_mem_eq(a->attenuation, b->attenuation, sizeof a->attenuation);
    ck_assert_float_bits(a->range, b->range);
}

static void same_scene(const Scene *a, const Scene *b)
{
    ck_assert_uint_eq(a->mesh_count, b->mesh_count);
    ck_assert_uint_eq(a->instance_count, b->instance_count);
    ck_assert_uint_eq(a->light_count, b->light_count);
    ck_assert_uint_eq(a->camera_count, b->camera_count);
    for (size_t i = 0; i < a->instance_count; i++) {
        const Instance *x = &a->instances[i], *y = &b->instances[i];
        ck_assert_str_eq(x->name, y->name);
        if (i == 0 || x->mesh != x[-1].mesh) /* once for a run of the same */
            same_mesh(&a->meshes[x->mesh], &b->meshes[y->mesh]);
        same_material(&a->materials[x->material], &b->materials[y->material]);
        same_matrix(&x->world, &y->world);
    }
    for (size_t i = 0; i < a->light_count; i++)
        same_light(&a->lights[i], &b->lights[i]);
    for (size_t i = 0; i < a->camera_count; i++) {
        const Camera *x = &a->cameras[i], *y = &b->cameras[i];
        ck_assert_str_eq(x->name, y->name);
        ck_assert(x->yfov == y->yfov && x->near == y->near && x->far == y->far);
        same_matrix(&x->world, &y->world);
    }
    ck_assert_mem_eq(a->ambient, b->ambient, sizeof a->ambient);
    ck_assert_mem_eq(a->background, b->background, sizeof a->background);
    ck_assert(a->light_degrees_per_second == b->light_degrees_per_second);
}

START_TEST(written_scenes_come_back)
{
    size_t count;
    const BuiltinScene *table = generate_table(&count);
    for (size_t i = 0; i < 2 * count; i++) {
        Scene made, read;
        char name[64];
        snprintf(name, sizeof name, "%s.%s", table[i / 2].name, i % 2 ? "glb" : "gltf");
        const char *path = scratch_path(name);
        ck_assert_int_eq(table[i / 2].generate(&made), RESULT_OK);
        ck_assert_msg(gltf_write(&made, path) == RESULT_OK, "%s", result_message());
        load(path, &read);
        ck_assert_str_eq(read.name, table[i / 2].name);
        same_scene(&made, &read);
        scene_free(&made);
        scene_free(&read);
    }
    ck_assert_int_eq(scratch_entries(), (int)(2 * count)); /* no temporary left */
}
END_TEST

/* The files of data/scenes are what the generators write today. If a scene is changed on purpose:
 * build/peel scenes NAME -o data/scenes/NAME.gltf. */
START_TEST(data_files_are_current)
{
    size_t count;
    const BuiltinScene *table = generate_table(&count);
    for (size_t i = 0; i < count; i++)
        current_gltf_check("scenes", table[i].name, table[i].generate);
}
END_TEST

START_TEST(unwritable_places)
{
    Scene scene;
    ck_assert_int_eq(generate_find("crossing_planes")->generate(&scene), RESULT_OK);
    ck_assert_int_eq(gltf_write(&scene, scratch_path("none/x.gltf")), RESULT_IO);
    ck_assert_int_eq(gltf_write(&scene, scratch_path("x.obj")), RESULT_BAD_INPUT);
    ck_assert_int_eq(scratch_entries(), 0);
    scene_free(&scene);
}
END_TEST

/* ---- what a file means ---------------------------------------------------------------------- */

/* A uri may have escapes; the document's own folder may have a % that is none. */
START_TEST(escaped_buffer_names)
{
    static const char *const names[][2] = {
        {"plain.bin", "plain.bin"},
        {"my%20buf.bin", "my buf.bin"},
        {"50%2525%25.bin", "50%25%.bin"},
        {"%e2%9C%93/%61.bin", "\u2713/a.bin"},
    };
    Scene scene;
    strcat(scratch_directory, "/100%41");
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char folder[128];
        const char *path = scratch_path(names[i][1]), *slash = strrchr(path, '/');
        snprintf(folder, sizeof folder, "%.*s", (int)(slash - path), path);
        ck_assert_int_eq(file_make_directories(folder), RESULT_OK);
        ck_assert_int_eq(file_write(path, quad, 36), RESULT_OK);
        load(write_external(names[i][0]), &scene);
        ck_assert_uint_eq(scene.meshes[0].vertex_count, 3);
        ck_assert_mem_eq(scene.meshes[0].position, quad, 36);
        scene_free(&scene);
        ck_assert_int_eq(unlink(path), 0);
    }
    *strrchr(scratch_directory, '/') = 0;
}
END_TEST

/* A binary file's first buffer may be another than its BIN chunk, and the chunk an extension's. */
START_TEST(binary_with_buffers_elsewhere)
{
    static const unsigned char unused[8] = {1, 2, 3};
    char text[8192];
    ck_assert_uint_lt(scratch_read(write_quad(quad, QUAD_MESH "," ONE_NODE), text, sizeof text),
                      sizeof text - 1);
    for (int i = 0; i < 3; i++) {
        Scene scene;
        size_t chunk = i ? sizeof unused : 0;
        unsigned char *bytes;
        size_t count;
        const char *path = scratch_path("elsewhere.glb");
        ck_assert_int_eq(gltf_file_assemble(text, unused, chunk, &bytes, &count), RESULT_OK);
        if (i == 2)
            memcpy(bytes + count - sizeof unused - 4, "MORE", 4);
        ck_assert_int_eq(file_write(path, bytes, count), RESULT_OK);
        load(path, &scene);
        ck_assert_uint_eq(scene.meshes[0].vertex_count, 4);
        ck_assert_mem_eq(scene.meshes[0].position, quad, 48);
        ck_assert_str_eq(scene.name, "elsewhere");
        scene_free(&scene);
        free(bytes);
    }
}
END_TEST

/* Nothing lies behind the last vertex, though a stride has room there: embedded, or the chunk. */
START_TEST(last_stride_may_be_short)
{
    float floats[22] = {0, 0, 0, 0, 0, 1, 7, 7, 1, 0, 0, 0, 0, 1, 7, 7, 0, 1, 0, 0, 0, 1};
    char *uri = gltf_file_data_uri("application/octet-stream", (unsigned char *)floats, 88);
    ck_assert_ptr_nonnull(uri);
    for (int binary = 0; binary < 2; binary++) {
        char text[1024];
        unsigned char *bytes;
        size_t count;
        Scene scene;
        const char *path = scratch_path(binary ? "short.glb" : "short.gltf");
        snprintf(text, sizeof text,
                 "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],"
                 "\"nodes\":[{\"mesh\":0}],\"buffers\":[{%s%s%s\"byteLength\":88}],"
                 "\"bufferViews\":[{\"buffer\":0,\"byteLength\":88,\"byteStride\":32}],"
                 "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,"
                 "\"type\":\"VEC3\"},{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5126,"
                 "\"count\":3,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":["
                 "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1}}]}]}",
                 binary ? "" : "\"uri\":\"", binary ? "" : uri, binary ? "" : "\",");
        if (binary) {
            ck_assert_int_eq(gltf_file_assemble(text, (unsigned char *)floats, 88, &bytes, &count),
                             RESULT_OK);
            ck_assert_int_eq(file_write(path, bytes, count), RESULT_OK);
            free(bytes);
        } else {
            write_text(path, text);
        }
        load(path, &scene);
        ck_assert_uint_eq(scene.meshes[0].vertex_count, 3);
        for (int i = 0; i < 3; i++) {
            ck_assert_mem_eq(scene.meshes[0].position + 3 * i, floats + 8 * i, 12);
            ck_assert_mem_eq(scene.meshes[0].normal + 3 * i, floats + 8 * i + 3, 12);
        }
        scene_free(&scene);
    }
    free(uri);
}
END_TEST

/* The scene's name is the file's, made of UTF-8 alone. */
START_TEST(name_of_other_bytes)
{
    Scene scene;
    const char *path = scratch_path("a\xff\xc3\xa9.gltf");
    char text[8192];
    ck_assert_uint_lt(scratch_read(write_quad(quad, QUAD_MESH "," ONE_NODE), text, sizeof text),
                      sizeof text - 1);
    write_text(path, text);
    load(path, &scene);
    ck_assert_str_eq(scene.name, "a?\xc3\xa9");
    scene_free(&scene);
}
END_TEST

/* Nodes that mirror place a camera and do not turn it: scaling is ignored (glTF 2.0, 3.10.1). */
START_TEST(camera_is_not_mirrored)
{
    Scene scene;
    load_quad(QUAD_MESH ",\"scenes\":[{\"nodes\":[0,1,2,3,4]}],\"nodes\":[{\"mesh\":0},"
                        "{\"camera\":0,\"scale\":[-1,-1,-1]},{\"camera\":0,\"scale\":[-2,1,-3]},"
                        "{\"camera\":0,\"matrix\":[-1,0,0,0,0,-1,0,0,0,0,-1,0,0,0,0,1]},"
                        "{\"children\":[5],\"scale\":[-1,1,1],\"translation\":[5,0,0]},"
                        "{\"camera\":0,\"translation\":[1,0,0],\"rotation\":[0,1,0,0]}],"
                        "\"cameras\":[{\"type\":\"perspective\",\"perspective\":"
                        "{\"yfov\":0.7,\"znear\":0.01}}]",
              &scene);
    ck_assert_uint_eq(scene.camera_count, 4);
    for (size_t i = 0; i < 4; i++) {
        double sign = i == 3 ? -1.0 : 1.0; /* half a turn about y */
        const double axes[3] = {sign, 1.0, sign};
        for (int c = 0; c < 3; c++)
            for (int r = 0; r < 3; r++)
                ck_assert_double_eq(scene.cameras[i].world.m[4 * c + r], c == r ? axes[c] : 0.0);
        ck_assert_double_eq(scene.cameras[i].world.m[12], i == 3 ? 4.0 : 0.0);
    }
    scene_free(&scene);
}
END_TEST

START_TEST(long_name)
{
    enum {
        LENGTH = 1400
    };
    char name[LENGTH + 1] = "", members[2048];
    Scene scene;
    for (int i = 0; i < LENGTH; i += 2)
        memcpy(name + i, "\xc3\xa9", 2);
    snprintf(members, sizeof members,
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":2,"
             "\"material\":0}]}],\"materials\":[{\"name\":\"y%s\"}]," ONE_NODE,
             name);
    load_quad(members, &scene);
    ck_assert_uint_eq(scene.material_count, 1);
    ck_assert_str_eq(scene.materials[0].name + 1, name);
    scene_free(&scene);
}
END_TEST

/* 0, 0.0 and 0e0 are one number, integers may be of any size, and of equal names the last counts
 * (glTF 2.0, 2.8). */
START_TEST(numbers_and_names)
{
    Scene scene;
    load_quad("\"meshes\":[{\"primitives\":[{\"mode\":4.0,\"attributes\":{\"POSITION\":0e0,"
              "\"NORMAL\":1.0},\"indices\":20e-1}]}],\"scene\":0.0,\"scenes\":[{\"nodes\":[7],"
              "\"nodes\":[0.0]}],\"nodes\":[{\"mesh\":0.0,\"translation\":[-0.0,1,2.5],"
              "\"extras\":{\"id\":18446744073709551615}}]",
              &scene);
    ck_assert_uint_eq(scene.instance_count, 1);
    ck_assert_uint_eq(scene.meshes[0].triangle_count, 2);
    ck_assert_double_eq(scene.instances[0].world.m[13], 1.0);
    ck_assert_double_eq(scene.instances[0].world.m[14], 2.5);
    scene_free(&scene);
}
END_TEST

START_TEST(camera_field_is_vertical)
{
    static const char *const aspects[] = {"", ",\"aspectRatio\":1.7777778", ",\"aspectRatio\":0.5",
                                          ",\"aspectRatio\":3.2"};
    for (size_t i = 0; i < sizeof aspects / sizeof aspects[0]; i++) {
        Scene scene;
        char members[1024];
        snprintf(members, sizeof members,
                 QUAD_MESH ",\"scenes\":[{\"nodes\":[0,1,2]}],\"nodes\":[{\"mesh\":0},"
                           "{\"camera\":0},{\"camera\":1,\"scale\":[2,2,2]}],\"cameras\":["
                           "{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.7,\"znear\":0.01,"
                           "\"zfar\":100%s}},{\"type\":\"perspective\",\"perspective\":"
                           "{\"yfov\":1.1,\"znear\":0.25%s}}]",
                 aspects[i], aspects[i]);
        load_quad(members, &scene);
        ck_assert_uint_eq(scene.camera_count, 2);
        ck_assert_double_eq(scene.cameras[0].yfov, 0.7);
        ck_assert_double_eq(scene.cameras[0].far, 100.0);
        ck_assert_double_eq(scene.cameras[1].yfov, 1.1);
        ck_assert(isinf(scene.cameras[1].far));
        ck_assert_double_eq(scene.cameras[1].world.m[0], 1.0); /* a camera has no scale */
        scene_free(&scene);
    }
}
END_TEST

START_TEST(defaults_where_the_file_says_nothing)
{
    Scene scene;
    load_quad(QUAD_MESH "," ONE_NODE, &scene);
    const Material *material = &scene.materials[scene.instances[0].material];
    for (int i = 0; i < 4; i++)
        ck_assert_float_bits(material->base_color[i], 1.0f);
    ck_assert_float_bits(material->metallic, 1.0f);
    ck_assert_float_bits(material->roughness, 1.0f);
    ck_assert_int_eq(material->alpha_mode, ALPHA_OPAQUE);
    ck_assert(!material->double_sided);
    ck_assert_float_bits(scene.ambient[0], 0.25f);
    ck_assert_float_bits(scene.background[0], 0.0f);
    ck_assert_uint_eq(scene.camera_count, 1);
    ck_assert_uint_eq(scene.light_count, 3);
    ck_assert_str_eq(scene.name, "small");
    scene_free(&scene);
}
END_TEST

START_TEST(material_factors)
{
    Scene scene;
    load_quad(
        "\"materials\":[{\"name\":\"a\"},{\"name\":\"b\",\"alphaMode\":\"MASK\",\"alphaCutoff\":"
        "0.25,\"doubleSided\":true,\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.1,0.2,0.3,"
        "0.4],\"metallicFactor\":0.5,\"roughnessFactor\":0.6}},{\"alphaMode\":\"BLEND\"},"
        "{\"alphaMode\":\"MASK\",\"alphaCutoff\":1e-40}],"
        "\"meshes\":[{\"primitives\":["
        "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2,\"material\":1},"
        "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2,\"material\":2},"
        "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2,\"material\":3}]}]," ONE_NODE,
        &scene);
    const Material *mask = &scene.materials[scene.instances[0].material];
    ck_assert_str_eq(mask->name, "b");
    ck_assert_float_bits(mask->base_color[3], 0.4f);
    ck_assert_float_bits(mask->metallic, 0.5f);
    ck_assert_float_bits(mask->roughness, 0.6f);
    ck_assert_float_bits(mask->alpha_cutoff, 0.25f);
    ck_assert_int_eq(mask->alpha_mode, ALPHA_MASK);
    ck_assert(mask->double_sided);
    ck_assert_int_eq(scene.materials[scene.instances[1].material].alpha_mode, ALPHA_BLEND);
    ck_assert_float_bits(scene.materials[scene.instances[1].material].alpha_cutoff, 0.5f);
    ck_assert_float_bits(scene.materials[scene.instances[2].material].alpha_cutoff, 0x1p-126f);
    ck_assert_uint_eq(scene.mesh_count, 1); /* the same accessors */
    scene_free(&scene);
}
END_TEST

START_TEST(strips_and_flat_normals)
{
    Scene scene;
    load_quad(
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":3,\"mode\":5},"
        "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"mode\":6}]}]," ONE_NODE,
        &scene);
    ck_assert_uint_eq(scene.mesh_count, 2);
    const Mesh *strip = &scene.meshes[0], *fan = &scene.meshes[1];
    ck_assert_uint_eq(strip->triangle_count, 2);
    ck_assert_uint_eq(strip->vertex_count, 6);
    for (size_t v = 0; v < 6; v++)
        ck_assert_float_bits(strip->normal[3 * v + 2], 1.0f); /* both triangles face front */
    ck_assert_uint_eq(fan->triangle_count, 2);
    ck_assert_mem_eq(fan->index, ((uint32_t[]){0, 1, 2, 0, 2, 3}), 6 * sizeof(uint32_t));
    scene_free(&scene);
}
END_TEST

/* The coordinates are (0, 0), (1, 0), (0, 1), (0, 0). */
START_TEST(texture_coordinates_come_back)
{
    static const float expected[8] = {0, 0, 1, 0, 0, 1, 0, 0};
    Scene scene, again;
    load_quad("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,"
              "\"TEXCOORD_0\":5},\"indices\":2}]}]," ONE_NODE,
              &scene);
    ck_assert_ptr_nonnull(scene.meshes[0].uv);
    ck_assert_mem_eq(scene.meshes[0].uv, expected, sizeof expected);
    const char *path = scratch_path("uv.glb");
    ck_assert_int_eq(gltf_write(&scene, path), RESULT_OK);
    load(path, &again);
    ck_assert_mem_eq(again.meshes[0].uv, expected, sizeof expected);
    same_mesh(&scene.meshes[0], &again.meshes[0]);
    scene_free(&scene);
    scene_free(&again);
}
END_TEST

START_TEST(nodes_multiply_from_the_root)
{
    Scene scene;
    load_quad(QUAD_MESH
              ",\"scenes\":[{\"nodes\":[2]}],\"nodes\":[{\"mesh\":0,\"translation\":[1,0,0]},"
              "{\"children\":[0],\"scale\":[2,3,4]},{\"children\":[1,3],\"rotation\":"
              "[0,0,0.70710678,0.70710678]},{\"mesh\":0,\"name\":\"second\"}]",
              &scene);
    ck_assert_uint_eq(scene.instance_count, 2);
    const double *m = scene.instances[0].world.m;
    ck_assert_double_eq_tol(m[12], 0.0, 1e-6); /* (1, 0, 0) scaled by 2, a quarter about z */
    ck_assert_double_eq_tol(m[13], 2.0, 1e-6);
    ck_assert_double_eq_tol(m[1], 2.0, 1e-6);
    ck_assert_double_eq_tol(m[4], -3.0, 1e-6);
    ck_assert_str_eq(scene.instances[1].name, "second");
    ck_assert_uint_eq(scene.mesh_count, 1);
    scene_free(&scene);
}
END_TEST

#define LIGHT_TAIL                                                                                 \
    "\"extensionsUsed\":[\"KHR_lights_punctual\"],\"extensions\":{\"KHR_lights_punctual\":"        \
    "{\"lights\":[{\"type\":\"point\",\"color\":[1,0.5,0.25],\"intensity\":6},"                    \
    "{\"type\":\"directional\"}]}}"
#define LIGHT_NODE "\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}"

/* Two nodes of the same name hold the same light: both shine. */
START_TEST(lights_and_extras)
{
    Scene scene;
    load_quad(QUAD_MESH
              ",\"scenes\":[{\"nodes\":[0,1,2]}],\"nodes\":[{\"mesh\":0,\"extras\":{"
              "\"ambient\":[0,0.5,1],\"background\":[1,2,3],\"light_degrees_per_second\":7}},"
              "{\"name\":\"l\",\"translation\":[1,2,3]," LIGHT_NODE "},"
              "{\"name\":\"l\"," LIGHT_NODE
              ",\"extras\":{\"attenuation\":[1,0.14,0.07]}}]," LIGHT_TAIL,
              &scene);
    ck_assert_uint_eq(scene.light_count, 2);
    ck_assert_double_eq(scene.lights[0].position[2], 3.0);
    ck_assert_float_bits(scene.lights[0].color[0], 6.0f);
    ck_assert_float_bits(scene.lights[0].color[2], 1.5f);
    ck_assert_float_bits(scene.lights[0].attenuation[0], 0.0f);
    ck_assert_float_bits(scene.lights[0].attenuation[2], 1.0f);
    ck_assert_float_bits(scene.lights[1].attenuation[1], 0.14f);
    ck_assert_float_bits(scene.lights[0].range, 0.0f);
    ck_assert_float_bits(scene.ambient[1], 0.5f);
    ck_assert_float_bits(scene.background[2], 3.0f);
    ck_assert_double_eq(scene.light_degrees_per_second, 7.0);
    scene_free(&scene);
}
END_TEST

/* Extras may be of any type, and what is not modelled is not looked at. */
START_TEST(extras_of_any_type)
{
    Scene scene;
    load_quad("\"extras\":[1],\"scenes\":[{\"nodes\":[0],\"extras\":[[1]],\"name\":1,"
              "\"extensions\":7}],\"nodes\":[{\"mesh\":0,\"extras\":\"x\"}],\"meshes\":["
              "{\"extras\":[2],\"weights\":\"x\",\"primitives\":[{\"attributes\":{\"POSITION\":0},"
              "\"indices\":2,\"extras\":[]}]}],\"materials\":[{\"extras\":false}]",
              &scene);
    ck_assert_uint_eq(scene_triangle_count(&scene), 2);
    scene_free(&scene);
}
END_TEST

/* ---- what is said --------------------------------------------------------------------------- */

/* What is printed on stderr while the document goes to a file, whose text is returned. */
static const char *said(const char *members)
{
    static char text[4096];
    Scene scene;
    const char *path = write_quad(quad, members), *log = scratch_path("stderr");
    int kept = dup(STDERR_FILENO);
    ck_assert_ptr_nonnull(freopen(log, "wb", stderr));
    result_warnings_enable(true);
    Result result = gltf_load(path, &scene);
    result_warnings_enable(false);
    fflush(stderr);
    dup2(kept, STDERR_FILENO);
    close(kept);
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
    scene_free(&scene);
    scratch_read(log, text, sizeof text);
    return text;
}

START_TEST(one_warning_names_everything)
{
    const char *text = said(
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"COLOR_0\":0},"
        "\"indices\":2,\"targets\":[{\"POSITION\":4}]},{\"attributes\":{\"POSITION\":0},\"mode\":2}"
        "]}],"
        "\"materials\":[{\"emissiveFactor\":[0,1,0],\"normalTexture\":{\"index\":0}}],"
        "\"animations\":[{}],\"cameras\":[{\"type\":\"orthographic\"}],"
        "\"scenes\":[{\"nodes\":[0,1,2]}],\"nodes\":[{\"mesh\":0,\"skin\":0},{\"camera\":0},"
        "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":1}}}]," LIGHT_TAIL);
    static const char *const parts[] = {"normal, occlusion and emissive textures",
                                        "emissive",
                                        "vertex colours",
                                        "points",
                                        "morph",
                                        "skins",
                                        "animations",
                                        "orthograph",
                                        "directional lights"};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        ck_assert_msg(strstr(text, parts[i]) != NULL, "got \"%s\", expected \"%s\" in it", text,
                      parts[i]);
    ck_assert_ptr_eq(strchr(text, '\n'), text + strlen(text) - 1); /* one line */
    ck_assert_ptr_null(strstr(text, "range"));
}
END_TEST

/* A picture of one pixel, on a surface that says where of which. */
START_TEST(texture_without_coordinates)
{
    static const char form[] =
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":5},"
        "\"indices\":2,\"material\":0}]}],\"textures\":[{\"source\":0}],\"images\":[{\"uri\":"
        "\"data:;base64,"
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGM4AQAAygDJmcpdfgAA"
        "AABJRU5ErkJggg==\"}],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{"
        "\"index\":0,\"texCoord\":%d}}}]," ONE_NODE;
    char members[1024];
    for (int set = 0; set < 2; set++) {
        snprintf(members, sizeof members, form, set);
        const char *text = said(members);
        ck_assert_msg(!strstr(text, "textures of surfaces without their coordinates") == (set == 0),
                      "got \"%s\"", text);
    }
}
END_TEST

/* To the bit, written and read again; the node's scale does not stretch it. */
START_TEST(light_ranges)
{
    static const struct {
        const char *text;
        float range;
    } rows[] = {{"2.5", 2.5f},
                {"3", 3.0f},
                {"0.1", 0.1f},
                {"1e-45", 0x1p-149f},
                {"3.4028234e38", 0x1.fffffep127f}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char members[1024];
        Scene scene, again;
        snprintf(members, sizeof members, LIGHT_OF_RANGE, rows[i].text);
        ck_assert_str_eq(said(members), "");
        load_quad(members, &scene);
        ck_assert_uint_eq(scene.light_count, 1);
        ck_assert_float_bits(scene.lights[0].range, rows[i].range);
        const char *path = scratch_path("again.gltf");
        ck_assert_int_eq(gltf_write(&scene, path), RESULT_OK);
        load(path, &again);
        ck_assert_float_bits(again.lights[0].range, rows[i].range);
        scene_free(&scene);
        scene_free(&again);
    }
}
END_TEST

START_TEST(nothing_to_say)
{
    ck_assert_str_eq(said(QUAD_MESH "," ONE_NODE), "");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gltf");
    TCase *test = tcase_create("gltf");
    tcase_set_timeout(test, 120);
    tcase_add_checked_fixture(test, scratch_make, scratch_remove);
    tcase_add_test(test, written_scenes_come_back);
    tcase_add_test(test, data_files_are_current);
    tcase_add_test(test, unwritable_places);
    tcase_add_test(test, escaped_buffer_names);
    tcase_add_test(test, long_name);
    tcase_add_test(test, numbers_and_names);
    tcase_add_test(test, camera_field_is_vertical);
    tcase_add_test(test, camera_is_not_mirrored);
    tcase_add_test(test, defaults_where_the_file_says_nothing);
    tcase_add_test(test, material_factors);
    tcase_add_test(test, binary_with_buffers_elsewhere);
    tcase_add_test(test, last_stride_may_be_short);
    tcase_add_test(test, name_of_other_bytes);
    tcase_add_test(test, strips_and_flat_normals);
    tcase_add_test(test, texture_coordinates_come_back);
    tcase_add_test(test, nodes_multiply_from_the_root);
    tcase_add_test(test, lights_and_extras);
    tcase_add_test(test, extras_of_any_type);
    tcase_add_test(test, one_warning_names_everything);
    tcase_add_test(test, texture_without_coordinates);
    tcase_add_test(test, light_ranges);
    tcase_add_test(test, nothing_to_say);
    suite_add_tcase(suite, test);
    return testing_run(suite);
}

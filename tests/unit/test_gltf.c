/* glTF out and in: what is written comes back, what is broken is refused, what is ignored is said.
 */
#include "scene/generate.h"
#include "scene/gltf.h"
#include "scene/gltf_file.h"

#include "scratch.h"
#include "testing.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

/* ---- small files -------------------------------------------------------------------------------
 */

/* Buffer of one quad: positions (48 bytes), normals (48), indices 0 1 2 0 2 3 (12), strip 0 1 3 2
 * (8), all as accessors 0 to 3; accessor 4 is the positions again. */
static const float quad[24] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0,
                               0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
static const uint16_t quad_indices[10] = {0, 1, 2, 0, 2, 3, 0, 1, 3, 2};

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert(fputs(text, file) >= 0);
    fclose(file);
}

/* A document with the quad's buffer and the given members (from after the comma on). */
static const char *write_quad(const float *floats, const char *members)
{
    static char text[8192];
    unsigned char bytes[116];
    memcpy(bytes, floats, 96);
    memcpy(bytes + 96, quad_indices, 20);
    char *uri = gltf_file_data_uri(bytes, sizeof bytes);
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
             "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}],%s}",
             uri, members);
    free(uri);
    const char *path = scratch_path("small.gltf");
    write_text(path, text);
    return path;
}

#define QUAD_MESH                                                                                  \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2}]}]"
#define ONE_NODE "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}]"

static void load(const char *path, Scene *out)
{
    Result result = gltf_load(path, out);
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

static void load_quad(const char *members, Scene *out)
{
    load(write_quad(quad, members), out);
}

/* The file is refused with one line that names it and contains part. */
static void refused_file(const char *path, Result expected, const char *part)
{
    Scene scene;
    Result result = gltf_load(path, &scene);
    ck_assert_msg(result == expected, "%s: got %s, expected %s", path, result_text(result),
                  result_text(expected));
    ck_assert_ptr_null(scene.meshes);
    ck_assert_msg(strstr(result_message(), part) &&
                      strncmp(result_message(), path, strlen(path)) == 0,
                  "got \"%s\", expected \"%s\" in it", result_message(), part);
    ck_assert_ptr_null(strchr(result_message(), '\n'));
}

static void refused(const char *members, Result expected, const char *part)
{
    refused_file(write_quad(quad, members), expected, part);
}

/* ---- there and back ----------------------------------------------------------------------------
 */

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

static void same_scene(const Scene *a, const Scene *b)
{
    ck_assert_uint_eq(a->mesh_count, b->mesh_count);
    ck_assert_uint_eq(a->instance_count, b->instance_count);
    ck_assert_uint_eq(a->light_count, b->light_count);
    ck_assert_uint_eq(a->camera_count, b->camera_count);
    for (size_t i = 0; i < a->mesh_count; i++)
        same_mesh(&a->meshes[i], &b->meshes[i]);
    for (size_t i = 0; i < a->instance_count; i++) {
        const Instance *x = &a->instances[i], *y = &b->instances[i];
        ck_assert_str_eq(x->name, y->name);
        ck_assert_uint_eq(x->mesh, y->mesh);
        same_material(&a->materials[x->material], &b->materials[y->material]);
        same_matrix(&x->world, &y->world);
    }
    for (size_t i = 0; i < a->light_count; i++)
        ck_assert_mem_eq(&a->lights[i], &b->lights[i], sizeof(Light));
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
    for (size_t i = 0; i < count; i++) {
        Scene scene;
        char stored[256];
        unsigned char *expected, *got;
        size_t expected_count, got_count;
        const char *path = scratch_path("fresh.gltf");
        snprintf(stored, sizeof stored, "%s/data/scenes/%s.gltf", PEEL_SOURCE_DIR, table[i].name);
        ck_assert_int_eq(table[i].generate(&scene), RESULT_OK);
        ck_assert_int_eq(gltf_write(&scene, path), RESULT_OK);
        ck_assert_int_eq(gltf_file_read(path, &expected, &expected_count), RESULT_OK);
        ck_assert_msg(gltf_file_read(stored, &got, &got_count) == RESULT_OK, "%s",
                      result_message());
        ck_assert_msg(got_count == expected_count && memcmp(got, expected, got_count) == 0,
                      "%s differs from what the generator writes", stored);
        free(expected);
        free(got);
        scene_free(&scene);
    }
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

/* ---- what a file means -------------------------------------------------------------------------
 */

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
        "0.4],\"metallicFactor\":0.5,\"roughnessFactor\":0.6}},{\"alphaMode\":\"BLEND\"}],"
        "\"meshes\":[{\"primitives\":["
        "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2,\"material\":1},"
        "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2,\"material\":2}]}]," ONE_NODE,
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
    ck_assert_float_bits(scene.ambient[1], 0.5f);
    ck_assert_float_bits(scene.background[2], 3.0f);
    ck_assert_double_eq(scene.light_degrees_per_second, 7.0);
    scene_free(&scene);
}
END_TEST

/* ---- what is said ------------------------------------------------------------------------------
 */

/* stderr of loading the document goes to a file, whose text is returned. */
static const char *said(const char *members)
{
    static char text[4096];
    Scene scene;
    const char *path = write_quad(quad, members), *log = scratch_path("stderr");
    int kept = dup(STDERR_FILENO);
    ck_assert_ptr_nonnull(freopen(log, "wb", stderr));
    Result result = gltf_load(path, &scene);
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
    static const char *const parts[] = {"textures",   "emissive",   "vertex colours",
                                        "points",     "morph",      "skins",
                                        "animations", "orthograph", "directional lights"};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        ck_assert_msg(strstr(text, parts[i]) != NULL, "got \"%s\", expected \"%s\" in it", text,
                      parts[i]);
    ck_assert_ptr_eq(strchr(text, '\n'), text + strlen(text) - 1); /* one line */
    ck_assert_ptr_null(strstr(text, "range"));
}
END_TEST

START_TEST(nothing_to_say)
{
    ck_assert_str_eq(said(QUAD_MESH "," ONE_NODE), "");
}
END_TEST

/* ---- bad input ---------------------------------------------------------------------------------
 */

START_TEST(bad_files)
{
    refused_file("/no/such/file.gltf", RESULT_IO, "No such file");
    refused_file(scratch_path("small.obj"), RESULT_BAD_INPUT, "unknown extension");
    const char *folder = scratch_path("folder.glb");
    ck_assert_int_eq(rmdir(folder), -1);
    char command[256];
    snprintf(command, sizeof command, "mkdir %s", folder);
    ck_assert_int_eq(system(command), 0);
    refused_file(folder, RESULT_BAD_INPUT, "not a regular file");
    const char *text = scratch_path("text.gltf");
    write_text(text, "");
    refused_file(text, RESULT_BAD_INPUT, "not glTF");
    write_text(text, "solid cube\nendsolid\n");
    refused_file(text, RESULT_BAD_INPUT, "not glTF");
    write_text(text, "{\"asset\":{\"version\":\"1.0\"}}");
    refused_file(text, RESULT_UNSUPPORTED, "version 1.0");
    write_text(text, "{\"meshes\":[]}");
    refused_file(text, RESULT_BAD_INPUT, "asset.version");
    write_text(text, "glTF\2");
    refused_file(text, RESULT_BAD_INPUT, ".glb");
    const char *binary = scratch_path("binary.glb");
    write_text(binary, "{\"asset\":{\"version\":\"2.0\"}}");
    refused_file(binary, RESULT_BAD_INPUT, "glTF");
}
END_TEST

START_TEST(deep_garbage)
{
    enum {
        DEPTH = 200000
    };
    char *text = malloc(DEPTH + 1);
    ck_assert_ptr_nonnull(text);
    memset(text, '[', DEPTH);
    text[DEPTH] = 0;
    const char *path = scratch_path("deep.gltf");
    write_text(path, text);
    refused_file(path, RESULT_BAD_INPUT, "not glTF");
    free(text);
}
END_TEST

/* Every shortened copy of a .glb is refused; so is a .gltf without its external buffer. */
START_TEST(truncated_files)
{
    Scene scene;
    unsigned char *bytes;
    size_t count;
    const char *path = scratch_path("whole.glb"), *cut = scratch_path("cut.glb");
    ck_assert_int_eq(generate_find("crossing_planes")->generate(&scene), RESULT_OK);
    ck_assert_int_eq(gltf_write(&scene, path), RESULT_OK);
    scene_free(&scene);
    ck_assert_int_eq(gltf_file_read(path, &bytes, &count), RESULT_OK);
    for (size_t length = 0; length < count; length += 97) {
        FILE *file = fopen(cut, "wb");
        ck_assert_uint_eq(fwrite(bytes, 1, length, file), length);
        fclose(file);
        refused_file(cut, RESULT_BAD_INPUT, "");
    }
    free(bytes);
    path = scratch_path("external.gltf");
    write_text(
        path,
        "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
        "\"buffers\":[{\"byteLength\":36,\"uri\":\"none.bin\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,"
        "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}");
    refused_file(path, RESULT_BAD_INPUT, "none.bin");
    FILE *file = fopen(scratch_path("none.bin"), "wb");
    fputs("short", file);
    fclose(file);
    refused_file(path, RESULT_BAD_INPUT, "");
}
END_TEST

START_TEST(broken_geometry)
{
    float broken[24];
    memcpy(broken, quad, sizeof broken);
    broken[7] = NAN;
    refused_file(write_quad(broken, QUAD_MESH "," ONE_NODE), RESULT_BAD_INPUT,
                 "mesh 0 primitive 0: position 2 is not finite");
    broken[7] = 1.0f;
    broken[12] = INFINITY;
    refused_file(write_quad(broken, QUAD_MESH "," ONE_NODE), RESULT_BAD_INPUT,
                 "mesh 0 primitive 0: normal 0 is not finite");
    /* The normals' bytes read as indices: far out of range. */
    refused(
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":5}]}]," ONE_NODE,
        RESULT_BAD_INPUT, "mesh 0: expected indices whose accessor exists");
    refused("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":2}}]}]," ONE_NODE,
            RESULT_BAD_INPUT, "accessor 2");
    refused(
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":3}]}]," ONE_NODE,
        RESULT_BAD_INPUT, "mesh 0: expected whole triangles");
    refused("\"meshes\":[{\"primitives\":[]}]," ONE_NODE, RESULT_BAD_INPUT, "mesh 0");
    refused("\"meshes\":[{\"primitives\":[{\"attributes\":{\"NORMAL\":1}}]}]," ONE_NODE,
            RESULT_BAD_INPUT, "POSITION");
    refused("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0}]}]"
            "," ONE_NODE,
            RESULT_BAD_INPUT, "materials that exist");
    refused(
        "\"materials\":[{\"alphaMode\":\"GLASS\"}],\"meshes\":[{\"primitives\":[{\"attributes\":"
        "{\"POSITION\":0},\"material\":0,\"indices\":2}]}]," ONE_NODE,
        RESULT_BAD_INPUT, "alphaMode");
}
END_TEST

/* Assimp drops such triangles behind a log line. */
START_TEST(index_out_of_range)
{
    char text[2048];
    size_t length = scratch_read(write_quad(quad, QUAD_MESH "," ONE_NODE), text, sizeof text);
    const char *path = scratch_path("index.gltf");
    /* The positions' count is 3: index 3 is out of range. */
    char *count = strstr(text, "\"count\":4");
    ck_assert(length < sizeof text - 1 && count);
    count[8] = '3';
    count = strstr(count, "\"count\":4"); /* the normals' */
    count[8] = '3';
    write_text(path, text);
    refused_file(path, RESULT_BAD_INPUT,
                 "mesh 0 primitive 0: 1 of 2 triangles have an index out of range");
}
END_TEST

START_TEST(broken_nodes)
{
    refused(QUAD_MESH, RESULT_BAD_INPUT, "no scene to draw");
    refused(QUAD_MESH ",\"scenes\":[{\"nodes\":[3]}],\"nodes\":[{\"mesh\":0}]", RESULT_BAD_INPUT,
            "nodes that exist");
    refused(QUAD_MESH
            ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":[1]},{\"children\":[0]}]",
            RESULT_BAD_INPUT, "root nodes without a parent");
    refused(QUAD_MESH
            ",\"scenes\":[{\"nodes\":[]}],\"nodes\":[{\"children\":[1]},{\"children\":[0]}]",
            RESULT_BAD_INPUT, "no cycle");
    refused(QUAD_MESH ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":[1,1]},{\"mesh\":0}]",
            RESULT_BAD_INPUT, "one parent");
    refused(QUAD_MESH ",\"scenes\":[{\"nodes\":[0,0]}],\"nodes\":[{\"mesh\":0}]", RESULT_BAD_INPUT,
            "each once");
    refused(QUAD_MESH ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":1}]", RESULT_BAD_INPUT,
            "node 0: expected a mesh that exists");
    refused(QUAD_MESH
            ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"matrix\":[1,0,0,1,0,1,0,0,"
            "0,0,1,0,0,0,0,1]}]",
            RESULT_BAD_INPUT, "affine");
    refused(QUAD_MESH
            ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"scale\":[1e300,1,1]}]",
            RESULT_BAD_INPUT, "instance 0");
    refused(QUAD_MESH
            ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"translation\":[1,2]}]",
            RESULT_BAD_INPUT, "node 0");
    refused(QUAD_MESH
            ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"extras\":{\"ambient\":1}}]",
            RESULT_BAD_INPUT, "three numbers");
    refused(QUAD_MESH "," ONE_NODE ",\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]",
            RESULT_UNSUPPORTED, "KHR_draco_mesh_compression");
}
END_TEST

START_TEST(too_deep_a_graph)
{
    enum {
        NODES = 2000
    };
    char *text = malloc(NODES * 32 + 256), *end = text;
    ck_assert_ptr_nonnull(text);
    end +=
        sprintf(end, "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[");
    for (int i = 0; i < NODES; i++)
        end += sprintf(end, "{\"children\":[%d]},", i + 1);
    sprintf(end, "{}]}");
    const char *path = scratch_path("chain.gltf");
    write_text(path, text);
    refused_file(path, RESULT_BAD_INPUT, "depth");
    free(text);
}
END_TEST

/* ---- somebody else's files ---------------------------------------------------------------------
 */

START_TEST(cylinder_engine)
{
    const char *path =
        "/usr/share/assimp/models/glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb";
    Scene scene;
    uint64_t stored = 0;
    load(path, &scene);
    for (size_t i = 0; i < scene.mesh_count; i++)
        stored += scene.meshes[i].triangle_count;
    ck_assert_uint_eq(stored, 75730);
    ck_assert_uint_eq(scene_triangle_count(&scene), 121496);
    scene_free(&scene);
}
END_TEST

/* Every sample of assimp-testmodels loads, or is refused with one line. */
START_TEST(sample_models)
{
    FILE *list = popen("find /usr/share/assimp/models/glTF /usr/share/assimp/models/glTF2 "
                       "-name '*.gl[bt]*' -type f",
                       "r");
    char path[512];
    int files = 0, loaded = 0;
    result_warnings_enable(false);
    while (list && fgets(path, sizeof path, list)) {
        Scene scene;
        path[strcspn(path, "\n")] = 0;
        Result result = gltf_load(path, &scene);
        files++;
        loaded += result == RESULT_OK;
        if (result)
            ck_assert_msg(strncmp(result_message(), path, strlen(path)) == 0 &&
                              !strchr(result_message(), '\n'),
                          "%s: \"%s\"", path, result_message());
        scene_free(&scene);
    }
    result_warnings_enable(true);
    ck_assert_int_eq(pclose(list), 0);
    ck_assert_int_ge(files, 50);
    ck_assert_int_ge(loaded, 30);
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
    tcase_add_test(test, camera_field_is_vertical);
    tcase_add_test(test, defaults_where_the_file_says_nothing);
    tcase_add_test(test, material_factors);
    tcase_add_test(test, strips_and_flat_normals);
    tcase_add_test(test, nodes_multiply_from_the_root);
    tcase_add_test(test, lights_and_extras);
    tcase_add_test(test, one_warning_names_everything);
    tcase_add_test(test, nothing_to_say);
    tcase_add_test(test, bad_files);
    tcase_add_test(test, deep_garbage);
    tcase_add_test(test, truncated_files);
    tcase_add_test(test, broken_geometry);
    tcase_add_test(test, index_out_of_range);
    tcase_add_test(test, broken_nodes);
    tcase_add_test(test, too_deep_a_graph);
    tcase_add_test(test, cylinder_engine);
    tcase_add_test(test, sample_models);
    suite_add_tcase(suite, test);
    return testing_run(suite);
}

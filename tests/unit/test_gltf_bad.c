/* Broken glTF: every file is refused with one line, or loads; none crashes. */
#include "base/file.h"
#include "scene/generate.h"

#include "small_gltf.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

START_TEST(bad_files)
{
    refused_file("/no/such/file.gltf", RESULT_IO, "No such file");
    refused_file(scratch_path("small.obj"), RESULT_BAD_INPUT, "unknown extension");
    const char *folder = scratch_path("folder.glb");
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
    write_text(text, "{\"asset\":{\"version\":\"2.0\",\"minVersion\":\"2.1\"}}");
    refused_file(text, RESULT_UNSUPPORTED, "version 2.1, expected 2.0");
    write_text(text, "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":\"KHR_x\"}");
    refused_file(text, RESULT_BAD_INPUT, "extensionsRequired: expected an array");
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
    ck_assert_int_eq(file_load(path, &bytes, &count), RESULT_OK);
    for (size_t length = 0; length < count; length += 97) {
        FILE *file = fopen(cut, "wb");
        ck_assert_uint_eq(fwrite(bytes, 1, length, file), length);
        fclose(file);
        refused_file(cut, RESULT_BAD_INPUT, "");
    }
    free(bytes);
    path = write_external("none.bin");
    refused_file(path, RESULT_BAD_INPUT, "none.bin");
    FILE *file = fopen(scratch_path("none.bin"), "wb");
    fputs("short", file);
    fclose(file);
    refused_file(path, RESULT_BAD_INPUT, "none.bin is truncated: 5 bytes, expected 36");
}
END_TEST

START_TEST(embedded_buffers)
{
    static const char digits[] = "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA";
    char uri[256];
    Scene scene;
    snprintf(uri, sizeof uri, "data:application/octet-stream;base64,%.32s", digits);
    refused_file(write_external(uri), RESULT_BAD_INPUT,
                 "buffer 0: its data uri is truncated: 24 bytes, expected 36");
    snprintf(uri, sizeof uri, "data:application/octet-stream;base64,%.47s*", digits);
    refused_file(write_external(uri), RESULT_BAD_INPUT, "buffer 0: expected base64 digits");
    snprintf(uri, sizeof uri, "data:application/octet-stream,%s", digits);
    refused_file(write_external(uri), RESULT_BAD_INPUT, "buffer 0: expected ;base64");
    snprintf(uri, sizeof uri, "data:;a=b;base64,%.64s", digits); /* longer than it must be */
    load(write_external(uri), &scene);
    ck_assert_uint_eq(scene.meshes[0].triangle_count, 1);
    scene_free(&scene);
}
END_TEST

/* The header's length, then that of the JSON chunk, at words 2 and 3. */
START_TEST(binary_lengths)
{
    static const struct {
        size_t word;
        uint32_t value;
        const char *part;
    } cases[] = {{2, 0x7fffffff, "truncated: "},
                 {2, 0, "in a file of 0"},
                 {2, 24, "in a file of 24"},
                 {3, 0x7fffffff, "JSON of 2147483647 bytes in a file of "}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Scene scene;
        unsigned char *bytes;
        size_t count;
        const char *path = scratch_path("lengths.glb");
        ck_assert_int_eq(generate_find("crossing_planes")->generate(&scene), RESULT_OK);
        ck_assert_int_eq(gltf_write(&scene, path), RESULT_OK);
        scene_free(&scene);
        ck_assert_int_eq(file_load(path, &bytes, &count), RESULT_OK);
        memcpy(bytes + 4 * cases[i].word, &cases[i].value, 4);
        ck_assert_int_eq(file_write(path, bytes, count), RESULT_OK);
        free(bytes);
        refused_file(path, RESULT_BAD_INPUT, cases[i].part);
    }
}
END_TEST

START_TEST(malformed_escapes)
{
    static const char *const uris[] = {"a%2", "a%", "a%%20", "%g0.bin", "%0", "a%00.bin", "%-1"};
    for (size_t i = 0; i < sizeof uris / sizeof uris[0]; i++) {
        refused_file(write_external(uris[i]), RESULT_BAD_INPUT, "two hexadecimal digits");
        ck_assert_ptr_nonnull(strstr(result_message(), uris[i]));
    }
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
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":9}]}]," ONE_NODE,
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
            RESULT_BAD_INPUT, "node 0 (unnamed): expected a finite matrix");
    refused(QUAD_MESH
            ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"translation\":[1,2]}]",
            RESULT_BAD_INPUT, "node 0");
    refused(QUAD_MESH
            ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"extras\":{\"ambient\":1}}]",
            RESULT_BAD_INPUT, "three numbers");
    refused(QUAD_MESH ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"extras\":{"
                      "\"light_degrees_per_second\":1e13}}]",
            RESULT_BAD_INPUT, "1e+13 degrees per second, expected within 1e12");
    refused(QUAD_MESH ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"extensions\":{"
                      "\"KHR_lights_punctual\":{}}}]",
            RESULT_BAD_INPUT, "node 0: expected a light that exists");
    refused(QUAD_MESH "," ONE_NODE ",\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]",
            RESULT_UNSUPPORTED, "KHR_draco_mesh_compression");
}
END_TEST

START_TEST(broken_ranges)
{
    static const char *const ranges[] = {"0",    "-1",    "-0.0", "1e-60", "1e39",
                                         "null", "\"2\"", "[2]",  "true",  "{}"};
    char members[1024];
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        snprintf(members, sizeof members, LIGHT_OF_RANGE, ranges[i]);
        refused(members, RESULT_BAD_INPUT, "light 0: expected a finite number above 0");
    }
    static const char *const no_json[] = {"NaN", "Infinity", "1e400"};
    for (size_t i = 0; i < sizeof no_json / sizeof no_json[0]; i++) {
        snprintf(members, sizeof members, LIGHT_OF_RANGE, no_json[i]);
        refused(members, RESULT_BAD_INPUT, "");
    }
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

/* ---- somebody else's files ------------------------------------------------------------------ */

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
    ck_assert_int_eq(pclose(list), 0);
    ck_assert_int_ge(files, 50);
    ck_assert_int_ge(loaded, 30);
}
END_TEST

START_TEST(wrong_types)
{
    static const char *const members[] = {
        "\"pbrMetallicRoughness\":[\"no object\"]",
        "\"pbrMetallicRoughness\":{\"metallicFactor\":\"1\"}",
        "\"pbrMetallicRoughness\":{\"roughnessFactor\":[]}",
        "\"pbrMetallicRoughness\":{\"baseColorTexture\":0}",
        "\"pbrMetallicRoughness\":{\"baseColorFactor\":1}",
        "\"alphaCutoff\":\"0.5\"",
        "\"alphaMode\":1",
        "\"alphaMode\":\"\"",
        "\"alphaMode\":\"blend\"",
        "\"doubleSided\":1",
    };
    for (size_t i = 0; i < sizeof members / sizeof *members; i++) {
        char text[512];
        snprintf(text, sizeof text,
                 "\"materials\":[{%s}],\"meshes\":[{\"primitives\":[{\"attributes\":"
                 "{\"POSITION\":0},\"material\":0,\"indices\":2}]}]," ONE_NODE,
                 members[i]);
        refused(text, RESULT_BAD_INPUT, "material 0: expected ");
    }
}
END_TEST

/* One that is not of unit length would scale and shear. */
START_TEST(rotations)
{
    Scene scene;
    refused(QUAD_MESH
            ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"rotation\":[0,0,2,0]}]",
            RESULT_BAD_INPUT, "node 0: expected a unit quaternion");
    refused(QUAD_MESH
            ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"rotation\":[0,0,0,0]}]",
            RESULT_BAD_INPUT, "node 0: expected a unit quaternion");
    const char *rounded =
        write_quad(quad, QUAD_MESH ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,"
                                   "\"rotation\":[0,0,0.707,0.707]}]");
    ck_assert_msg(gltf_load(rounded, &scene) == RESULT_OK, "%s", result_message());
    scene_free(&scene);
}
END_TEST

/* Messages have the document's numbers, also behind materials, lights and cameras that nothing
 * uses. */
START_TEST(numbers)
{
    refused("\"materials\":[{},{},{\"pbrMetallicRoughness\":{\"metallicFactor\":2}}],"
            "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":2,"
            "\"indices\":2}]}]," ONE_NODE,
            RESULT_BAD_INPUT, "material 2: metallic is 2");
    refused(QUAD_MESH
            ",\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0},{\"camera\":1}],"
            "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":1}},"
            "{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":2,\"zfar\":1}}]",
            RESULT_BAD_INPUT, "camera 1: near 2 and far 1");
    refused(QUAD_MESH ",\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0},"
                      "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":1}}}],"
                      "\"extensionsUsed\":[\"KHR_lights_punctual\"],\"extensions\":{"
                      "\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\"},"
                      "{\"type\":\"point\",\"intensity\":1e13}]}}",
            RESULT_BAD_INPUT, "light 1: intensity is 1e+13");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gltf_bad");
    TCase *test = tcase_create("gltf_bad");
    tcase_set_timeout(test, 120);
    tcase_add_checked_fixture(test, scratch_make, scratch_remove);
    tcase_add_test(test, bad_files);
    tcase_add_test(test, numbers);
    tcase_add_test(test, rotations);
    tcase_add_test(test, deep_garbage);
    tcase_add_test(test, truncated_files);
    tcase_add_test(test, embedded_buffers);
    tcase_add_test(test, binary_lengths);
    tcase_add_test(test, malformed_escapes);
    tcase_add_test(test, broken_geometry);
    tcase_add_test(test, index_out_of_range);
    tcase_add_test(test, wrong_types);
    tcase_add_test(test, broken_nodes);
    tcase_add_test(test, broken_ranges);
    tcase_add_test(test, too_deep_a_graph);
    tcase_add_test(test, cylinder_engine);
    tcase_add_test(test, sample_models);
    suite_add_tcase(suite, test);
    return testing_run(suite);
}

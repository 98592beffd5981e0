/* ref/pipeline against OpenGL: scenes × settings × sizes, every buffer bit for bit.
 *
 * Prints a line of differing values per scene and setting, one number per size. The settings are
 * the default, each single change of it, and the original's profile. PEEL_TEST_FULL=1: everything;
 * without it the default in all sizes but the largest, and every other scene of each change, in the
 * small one. */
#include "bits.h"
#include "testing.h"

#include "gl/gl_renderer.h"
#include "scene/generate.h"
#include "scene/gltf.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MODELS "/usr/share/assimp/models/glTF2/" /* Debian's assimp-testmodels */

/* A built-in scene by name, or a file; masked: its blended materials are cut out instead. */
typedef struct NamedScene {
    const char *name, *file;
    bool masked;
} NamedScene;

static const NamedScene scenes[] = {
    {"teapot_hall", NULL, false},
    {"teapot_hall_stress", NULL, false},
    {"tutorial", NULL, false},
    {"chain", NULL, false},
    {"crossing_planes", NULL, false},
    {"alpha_ladder", NULL, false},
    {"lamps", NULL, false},
    {"BoxTextured", MODELS "BoxTextured-glTF/BoxTextured.gltf", false},
    {"ClearCoatTest", MODELS "ClearCoat-glTF/ClearCoatTest.gltf", false},
    {"ClearCoatTest, masked", MODELS "ClearCoat-glTF/ClearCoatTest.gltf", true},
    {"boxTexcoords", MODELS "BoxTexcoords-glTF/boxTexcoords.gltf", false},
};

typedef struct Setting {
    const char *name;
    bool seed;
    RenderDesc desc;
} Setting;

static const Setting settings[] = {
    {"default", false, {0}},
    {"depth d24", false, {.depth = FORMAT_D24}},
    {"depth d16", false, {.depth = FORMAT_D16}},
    {"accum rgba16f", false, {.accum = FORMAT_RGBA16F}},
    {"accum rgba16", false, {.accum = FORMAT_RGBA16}},
    {"accum rgba8", false, {.accum = FORMAT_RGBA8}},
    {"gbuffer seed", false, {.gbuffer = GBUFFER_SEED}},
    {"gbuffer compact", false, {.gbuffer = GBUFFER_COMPACT}},
    {"position reconstruct", false, {.position = POSITION_RECONSTRUCT}},
    {"cull seed", false, {.cull = CULL_SEED}},
    {"cull none", false, {.cull = CULL_NONE}},
    {"normals kept", false, {.normals = NORMALS_KEPT}},
    {"back-light on", false, {.back_light = true}},
    {"ggx stable", false, {.ggx = GGX_STABLE}},
    {"depth-func lequal", false, {.depth_func = DEPTH_LEQUAL}},
    {"depth-range zero-one", false, {.depth_range = DEPTH_RANGE_ZERO_ONE}},
    {"depth-range reversed", false, {.depth_range = DEPTH_RANGE_REVERSED}},
    {"peel-test raw", false, {.peel_test = PEEL_TEST_RAW}},
    {"passes 2", false, {.passes = 2}},
    {"bias", false, {.bias = 0x1p-10f}},
    {"bias, d24, reversed",
     false,
     {.bias = 0x1p-10f, .depth = FORMAT_D24, .depth_range = DEPTH_RANGE_REVERSED}},
    {"profile seed", true, {0}},
};

static const int sizes[][2] = {{1, 1}, {33, 17}, {640, 480}, {1920, 1080}};

enum {
    SCENES = sizeof scenes / sizeof scenes[0],
    SETTINGS = sizeof settings / sizeof settings[0],
    SIZES = sizeof sizes / sizeof sizes[0],
    SLICE_SIZE = 1, /* of every setting */
    LIGHTS = 4
};

static uint64_t all_values, all_differing, comparisons;

static void load(const NamedScene *from, Scene *out)
{
    Result result =
        from->file ? gltf_load(from->file, out) : generate_find(from->name)->generate(out);
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
    for (size_t i = 0; from->masked && i < out->material_count; i++)
        if (out->materials[i].alpha_mode == ALPHA_BLEND)
            out->materials[i].alpha_mode = ALPHA_MASK;
}

static bool is_wanted(int scene, int setting, int size)
{
    if (testing_full())
        return true;
    if (setting == 0)
        return size != SIZES - 1;
    return size == SLICE_SIZE && (scene + setting) % 2 == 0;
}

/* One line of the matrix; returns the differing values. */
static uint64_t run_setting(const Scene *scene, int scene_number, int number)
{
    const Setting *setting = &settings[number];
    uint64_t values = 0, differing = 0;
    Bits bits = {0};
    char first[sizeof bits.difference] = "";
    printf("%-22s %-21s", scenes[scene_number].name, setting->name);
    for (int size = 0; size < SIZES; size++) {
        RenderDesc desc = setting->desc;
        if (!is_wanted(scene_number, number, size)) {
            printf(" %9s", "-");
            continue;
        }
        if (setting->seed)
            render_desc_seed_profile(&desc);
        desc.width = sizes[size][0];
        desc.height = sizes[size][1];
        desc.lights = LIGHTS;
        bits_compare(scene, &desc, &bits);
        printf(" %9llu", (unsigned long long)bits.differing);
        fflush(stdout);
        values += bits.values;
        differing += bits.differing;
        comparisons++;
        if (bits.differing && !*first)
            memcpy(first, bits.difference, sizeof first);
    }
    printf(" %6d %14llu  %s\n", bits.peels, (unsigned long long)values, first);
    fflush(stdout);
    all_values += values;
    all_differing += differing;
    return differing;
}

static void print_head(void)
{
    bool fused;
    ck_assert_msg(gl_driver_fuses(0, &fused) == RESULT_OK, "%s", result_message());
    printf("differing values, --lights %d, --fma %s\n%-22s %-21s", LIGHTS, fused ? "on" : "off",
           "scene", "setting");
    for (int size = 0; size < SIZES; size++) {
        char text[16];
        snprintf(text, sizeof text, "%dx%d", sizes[size][0], sizes[size][1]);
        printf(" %9s", text);
    }
    printf(" %6s %14s\n", "peels", "values");
}

START_TEST(test_scene)
{
    Scene scene;
    uint64_t differing = 0;
    if (_i == 0)
        print_head();
    load(&scenes[_i], &scene);
    for (int setting = 0; setting < SETTINGS; setting++)
        differing += run_setting(&scene, _i, setting);
    scene_free(&scene);
    ck_assert_uint_eq(differing, 0);
}
END_TEST

START_TEST(test_totals)
{
    printf("comparisons: %llu, values: %llu, differing: %llu\n", (unsigned long long)comparisons,
           (unsigned long long)all_values, (unsigned long long)all_differing);
    fflush(stdout);
    ck_assert_uint_gt(all_values, 0);
    ck_assert_uint_eq(all_differing, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("settings");
    TCase *tcase = tcase_create("bits");
    tcase_set_timeout(tcase, 0); /* CTest's */
    tcase_add_loop_test(tcase, test_scene, 0, SCENES);
    tcase_add_test(tcase, test_totals);
    suite_add_tcase(suite, tcase);
    return testing_run_here(suite);
}

/* The two paths of ref/pipeline, and those methods that have one: the same bits and the same
 * counts, whatever the scene, the settings and the number of threads. */
#include "paths.h"

#include "base/memory.h"
#include "frame/shading.h"
#include "number/op.h"

#include <stdio.h>

/* PEEL_TEST_SEED=N runs the one case that a failure names; PEEL_TEST_COUNT=N more of them. */
static uint64_t environment(const char *name, uint64_t otherwise)
{
    const char *text = getenv(name);
    return text ? strtoull(text, NULL, 0) : otherwise;
}

static void check_case(uint64_t seed, uint64_t totals[4])
{
    static Soup soup;
    Random random = random_seed(paths_running = seed);
    soup_make(&random, &soup);
    if (scene_validate(&soup.scene) != RESULT_OK)
        ck_abort_msg("%s", result_message());
    RenderDesc desc = paths_desc(&random);
    Frame definition, tile;
    paths_render(&soup.scene, desc, REF_PATH_DEFINITION, NULL, &definition);
    desc.threads = 1 + (int)(random_bits(&random) % 8);
    paths_render_tile(&soup.scene, desc, &tile);
    paths_check_frames(&tile, &definition);
    totals[0] += tile.layers.fragments;
    totals[1] += tile.layers.lost_to_ties;
    totals[2] += tile.layers.lost_to_pass_limit;
    totals[3] += tile.layers.repeated;
    frame_free(&definition);
    frame_free(&tile);
}

START_TEST(test_soups)
{
    uint64_t totals[4] = {0}, only = environment("PEEL_TEST_SEED", 0);
    uint64_t count = environment("PEEL_TEST_COUNT", 400);
    if (only) {
        check_case(only, totals);
        return;
    }
    for (uint64_t seed = 1; seed <= count; seed++)
        check_case(seed, totals);
    for (int i = 0; i < 4; i++)
        ck_assert_msg(totals[i] > 0, "the soups never showed count %d", i);
}
END_TEST

/* ---- layers closer than the raw test can tell -------------------------------------------------
 */

/* With 24-bit depth and the raw test a layer one code behind another is discarded with it. A tile
 * that such a layer ends must count it as the frame does, however deep other tiles are. */
START_TEST(test_raw_test_loses_close_layers)
{
    static Soup soup;
    uint64_t lost = 0;
    for (int step = 1; step < 12; step++) {
        Random random = random_seed(1);
        soup_make(&random, &soup);
        soup.camera.yfov = 1.0;
        soup.camera.near = 1.0;
        soup.camera.far = 100.0;
        soup_square(&soup, 0, 5.0, -1, 0);
        soup_square(&soup, 1, 5.0 + step * 0x1p-20, -1, 0);
        for (uint32_t i = 2; i < 5; i++)
            soup_square(&soup, i, 5.0 + i, 0, 1);
        RenderDesc desc = {.width = 192,
                           .height = 20,
                           .depth = FORMAT_D24,
                           .peel_test = PEEL_TEST_RAW,
                           .threads = 1};
        for (desc.passes = 0; desc.passes < 4; desc.passes++) {
            Frame definition, tile;
            paths_render(&soup.scene, desc, REF_PATH_DEFINITION, NULL, &definition);
            paths_render(&soup.scene, desc, REF_PATH_TILE, NULL, &tile);
            paths_check_frames(&tile, &definition);
            if (desc.passes == 0) {
                ck_assert_int_eq(tile.peels, 3);
                ck_assert_uint_eq(tile.layers.lost_to_pass_limit, 0);
                lost += tile.layers.lost_to_ties;
            }
            frame_free(&definition);
            frame_free(&tile);
        }
    }
    ck_assert_uint_gt(lost, 0);
}
END_TEST

/* With the raw test a fragment in front of the far plane may be stored at the far end, where the
 * depth test does not let it pass, unless it is LEQUAL. */
START_TEST(test_raw_test_stores_the_far_end)
{
    static Soup soup;
    Random random = random_seed(1);
    soup_make(&random, &soup);
    soup.camera.yfov = 1.0;
    soup.camera.near = 1.0;
    soup.camera.far = 100.0;
    for (uint32_t i = 0; i < 5; i++)
        soup_square(&soup, i, 99.99, -1, 0);
    for (int func = DEPTH_LESS; func <= DEPTH_LEQUAL; func++) {
        RenderDesc desc = {.width = 40,
                           .height = 20,
                           .depth = FORMAT_D16,
                           .depth_func = (DepthFunc)func,
                           .peel_test = PEEL_TEST_RAW};
        Frame definition, tile;
        paths_render(&soup.scene, desc, REF_PATH_DEFINITION, NULL, &definition);
        paths_render(&soup.scene, desc, REF_PATH_TILE, NULL, &tile);
        ck_assert_uint_gt(definition.layers.fragments, 0);
        ck_assert_int_eq(definition.peels > 0, func == DEPTH_LEQUAL);
        paths_check_frames(&tile, &definition);
        frame_free(&definition);
        frame_free(&tile);
    }
}
END_TEST

/* Stored alphas on both sides of SHADING_ALPHA_TEST side by side, on squares that fill whole
 * blocks: what the test discards must not be blended, small as it is. */
START_TEST(test_alpha_test_in_whole_blocks)
{
    static Soup soup;
    Random random = random_seed(1);
    soup_make(&random, &soup);
    soup.camera.yfov = 1.0;
    soup.camera.near = 1.0;
    soup.camera.far = 100.0;
    soup.textures[0] = (Texture){
        .width = SOUP_TEXELS, .height = SOUP_TEXELS, .texels = soup.texels[0], .nearest = true};
    for (int i = 0; i < 4 * SOUP_TEXELS * SOUP_TEXELS; i++)
        soup.texels[0][i] = (float)(i / 4) / (SOUP_TEXELS * SOUP_TEXELS - 1);
    soup.scene.textures = soup.textures;
    soup.scene.texture_count = 1;
    for (uint32_t i = 0; i < 2; i++) {
        static const float uv[8] = {0, 0, 1, 0, 1, 1, 0, 1};
        soup_square(&soup, i, 5.0 + i, -1, 1);
        memcpy(soup.uv[i], uv, sizeof uv);
        soup.meshes[i].uv = soup.uv[i];
    }
    for (int i = 0; i < 8; i++)
        soup.materials[i].base_color_texture = soup.materials[i].metallic_roughness_texture = 0;
    soup.materials[2].base_color_texture = 1;
    soup.materials[2].base_color[3] = 2.0f * SHADING_ALPHA_TEST;
    RenderDesc desc = {.width = 192, .height = 20};
    Frame definition, tile;
    paths_render(&soup.scene, desc, REF_PATH_DEFINITION, NULL, &definition);
    ck_assert_float_lt(((const float *)image_pixel(&definition.final, 191, 0))[3], 1.0f);
    for (int simd = SIMD_AUTO; simd < SIMD_COUNT; simd++) {
        desc.simd = (SimdChoice)simd;
        paths_render_tile(&soup.scene, desc, &tile);
        paths_check_frames(&tile, &definition);
        frame_free(&tile);
    }
    frame_free(&definition);
}
END_TEST

/* ---- small things
 * --------------------------------------------------------------------------------
 */

START_TEST(test_empty)
{
    static Soup soup;
    Random random = random_seed(9);
    soup_make(&random, &soup);
    soup.scene.background[0] = 0.5f;
    soup.camera.world = matrix_translate(0, 0, -1e4); /* everything is behind */
    for (int path = REF_PATH_DEFINITION; path <= REF_PATH_TILE; path++) {
        Frame frame;
        paths_render(&soup.scene, (RenderDesc){.width = 70, .height = 3}, (RefPath)path, NULL,
                     &frame);
        ck_assert_int_eq(frame.peels, 0);
        ck_assert_uint_eq(frame.layers.fragments, 0);
        const float *pixel = image_pixel(&frame.final, 69, 2);
        ck_assert_float_bits(pixel[0], 0.5f);
        ck_assert_float_bits(pixel[3], 0.0f);
        frame_free(&frame);
    }
}
END_TEST

START_TEST(test_limits)
{
    static Soup soup;
    Random random = random_seed(9);
    soup_make(&random, &soup);
    Frame frame;
    RenderDesc desc = {.width = 640, .height = 480, .max_memory = 1 << 20};
    ck_assert_int_eq(pipeline_render(&soup.scene, &desc, NULL, &frame), RESULT_NO_MEMORY);
    ck_assert_ptr_null(frame.final.pixels);
    ck_assert_ptr_nonnull(strstr(result_message(), "--max-memory"));
    desc = (RenderDesc){.width = 8, .height = 8, .camera = 1};
    ck_assert_int_eq(pipeline_render(&soup.scene, &desc, NULL, &frame), RESULT_BAD_INPUT);
    ck_assert_ptr_null(frame.display.pixels);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("paths");
    TCase *tcase = tcase_create("paths");
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_soups);
    tcase_add_test(tcase, test_raw_test_loses_close_layers);
    tcase_add_test(tcase, test_raw_test_stores_the_far_end);
    tcase_add_test(tcase, test_alpha_test_in_whole_blocks);
    tcase_add_test(tcase, test_empty);
    tcase_add_test(tcase, test_limits);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

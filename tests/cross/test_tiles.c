/* ref's tile path on the built-in scenes: the bits of the definition path, whatever the
 * instructions, threads and size of tiles, and whatever the number of peels, formats and tests.
 *
 * Of the sizes and threads, each scene and kind of settings takes a third, over the kinds all with
 * all instructions. PEEL_TEST_FULL=1: all. */
#include "testing.h"

#include "frame/frame.h"
#include "ref/pipeline/pipeline.h"
#include "scene/generate.h"

#include <stdlib.h>

enum {
    WIDTH = 99, /* neither is a multiple of a tile */
    HEIGHT = 61
};

/* Settings that take different ways through the tile path. */
static const RenderDesc kinds[] = {
    {.passes = 0},
    {.passes = 3, .accum = FORMAT_RGBA16F},
    {.passes = 17, .depth_func = DEPTH_LEQUAL, .cull = CULL_NONE},
    {.passes = 1, .depth = FORMAT_D24, .gbuffer = GBUFFER_COMPACT, .accum = FORMAT_RGBA8},
    {.passes = 20, .depth_range = DEPTH_RANGE_REVERSED, .position = POSITION_RECONSTRUCT},
    {.passes = 0, .bias = 1e-4f, .unfused = true},
    {.passes = 5,
     .depth = FORMAT_D16,
     .accum = FORMAT_RGBA16,
     .gbuffer = GBUFFER_SEED,
     .peel_test = PEEL_TEST_RAW,
     .opaque_blend = OPAQUE_BLEND_SEED},
    {.passes = 0, .lights = -1},
};
enum {
    KINDS = sizeof kinds / sizeof *kinds
};

static void check_equal(const Image *got, const Image *expected, const char *scene,
                        const RenderDesc *desc)
{
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            if (memcmp(image_pixel(got, x, y), image_pixel(expected, x, y),
                       format_pixel_bytes(got->format)) != 0)
                ck_abort_msg("%s, passes %d, --simd %s --threads %d --tile %d: pixel (%d, %d) "
                             "differs",
                             scene, desc->passes, simd_name(desc->simd), desc->threads, desc->tile,
                             x, y);
}

static void check_variant(const Scene *scene, const char *name, const RenderDesc *desc,
                          const Frame *expected)
{
    Frame got;
    ck_assert_msg(pipeline_render(scene, desc, NULL, &got) == RESULT_OK, "%s", result_message());
    check_equal(&got.final, &expected->final, name, desc);
    check_equal(&got.display, &expected->display, name, desc);
    ck_assert_int_eq(got.peels, expected->peels);
    ck_assert_uint_eq(got.layers.max, expected->layers.max);
    ck_assert_uint_eq(got.layers.fragments, expected->layers.fragments);
    ck_assert_uint_eq(got.layers.lost_to_pass_limit, expected->layers.lost_to_pass_limit);
    ck_assert_uint_eq(got.fragments_shaded, expected->fragments_shaded);
    frame_free(&got);
}

static bool available(const Scene *scene, SimdChoice simd)
{
    RenderDesc desc = {.width = 1, .height = 1, .ref_path = REF_PATH_TILE, .simd = simd};
    Frame frame;
    Result result = pipeline_render(scene, &desc, NULL, &frame);
    if (result == RESULT_OK)
        frame_free(&frame);
    return result != RESULT_UNSUPPORTED;
}

/* Tiles, and the threads that they are shared by: each size with one number, and ref's own size
 * (0) with each. */
static const struct {
    int tile, threads;
} variants[] = {{8, 1}, {16, 2}, {32, 8}, {128, 2}, {256, 8}, {64, 1}, {0, 8}, {0, 1}, {0, 2}};
enum {
    VARIANTS = sizeof variants / sizeof *variants
};

/* All instructions, thread counts and sizes of tiles of one scene and kind. */
START_TEST(test_variants)
{
    int step = testing_full() ? 1 : 3;
    size_t count;
    const BuiltinScene *builtin = &generate_table(&count)[_i / KINDS];
    Scene scene;
    ck_assert(builtin->generate(&scene) == RESULT_OK);
    RenderDesc desc = kinds[_i % KINDS];
    desc.width = WIDTH;
    desc.height = HEIGHT;
    desc.lights = desc.lights ? desc.lights : 2;
    desc.ref_path = REF_PATH_DEFINITION;
    Frame expected;
    ck_assert(pipeline_render(&scene, &desc, NULL, &expected) == RESULT_OK);
    ck_assert_uint_gt(expected.fragments_shaded, 0);
    desc.ref_path = REF_PATH_TILE;
    for (desc.simd = SIMD_SCALAR; desc.simd < SIMD_COUNT; desc.simd++) {
        if (!available(&scene, desc.simd))
            continue;
        for (int i = (_i + (int)desc.simd) % step; i < VARIANTS; i += step) {
            desc.tile = variants[i].tile;
            desc.threads = variants[i].threads;
            check_variant(&scene, builtin->name, &desc, &expected);
        }
    }
    frame_free(&expected);
    scene_free(&scene);
}
END_TEST

int main(void)
{
    size_t count;
    generate_table(&count);
    Suite *suite = suite_create("tiles");
    TCase *tcase = tcase_create("tiles");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, test_variants, 0, (int)count * KINDS);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

/* image/deep, and the fragments that truth puts into it: scenes known by hand, built-in scenes
 * against truth's image and an independent compositor, memory limits. */
#include "image/deep.h"

#include "image/exr.h"
#include "image/exr_deep.h"
#include "scene/generate.h"
#include "scratch.h"
#include "truth_stage.h"

#include <float.h>
#include <math.h>

static const RenderDesc small = {.width = 8, .height = 8, .threads = 1};

static DeepImage render(const Scene *scene, const RenderDesc *desc, Frame *frame)
{
    DeepImage deep;
    ck_assert_msg(truth_render_deep(scene, desc, &deep, frame) == RESULT_OK, "%s",
                  result_message());
    return deep;
}

static bool same_sample(const DeepSample *a, const DeepSample *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

/* The quad's two triangles share a diagonal, so the primitive is 2 · quad or the next. */
static void check_pixels(const Stage *stage, const RenderDesc *desc, const DeepSample *expected,
                         uint32_t count)
{
    Frame frame;
    DeepImage deep = render(&stage->scene, desc, &frame);
    for (int y = 0; y < desc->height; y++)
        for (int x = 0; x < desc->width; x++) {
            uint32_t got_count;
            const DeepSample *got = deep_pixel(&deep, x, y, &got_count);
            EXPECT(got_count == count, "pixel %d,%d: %u samples, expected %u", x, y, got_count,
                   count);
            EXPECT((got == NULL) == (count == 0), "pixel %d,%d: samples at %p", x, y,
                   (const void *)got);
            for (uint32_t i = 0; i < count; i++) {
                DeepSample sample = got[i];
                sample.primitive &= ~1u;
                EXPECT(same_sample(&sample, &expected[i]),
                       "pixel %d,%d sample %u: %a %a %a %a, z %a, depth %a, primitive %u, "
                       "material %u",
                       x, y, i, (double)sample.rgba[0], (double)sample.rgba[1],
                       (double)sample.rgba[2], (double)sample.rgba[3], (double)sample.z,
                       (double)sample.depth, sample.primitive, sample.material);
            }
        }
    ck_assert_uint_eq(deep.sample_count, count * (uint64_t)(desc->width * desc->height));
    ck_assert_uint_eq(deep_most(&deep), count);
    frame_free(&frame);
    deep_free(&deep);
    ck_assert_ptr_null(deep.counts);
}

/* Window depth with near 1 and far 3. */
static float window(double z)
{
    return (float)(1.5 - 1.5 / z);
}

START_TEST(test_by_hand)
{
    Stage *stage = stage_new();
    memcpy(stage->scene.background, (const float[]){0.5f, 0, 1}, sizeof(float[3]));
    check_pixels(stage, &small, NULL, 0); /* the background is no sample */
    add_quad(stage, 2, 4, green);
    add_quad(stage, 1.5f, 4, red);
    const DeepSample samples[] = {
        {{0.5f, 0, 0, 0.5f}, 1.5f, window(1.5), 2, 1},
        {{0, 0.25f, 0, 0.25f}, 2, window(2), 0, 0},
        {{0, 0, 1, 1}, 2.5f, window(2.5), 4, 2},
    };
    check_pixels(stage, &small, samples, 2);
    add_quad(stage, 2.5f, 4, blue);
    check_pixels(stage, &small, samples, 3);
    add_quad(stage, 2.75f, 4, red); /* behind the opaque one: no sample */
    add_quad(stage, 2.5f, 4, red);  /* nor at it */
    check_pixels(stage, &small, samples, 3);
    RenderDesc reversed = small;
    reversed.depth_range = DEPTH_RANGE_REVERSED;
    reversed.height = 70;
    check_pixels(stage, &reversed, samples, 3); /* depth stays 0 near to 1 far */
    free(stage);
}
END_TEST

START_TEST(test_alpha_extremes)
{
    Stage *stage = stage_new();
    add_quad(stage, 1.25f, 4, (const float[]){1, 1, 1, 1e-4f}); /* fails the alpha test */
    add_quad(stage, 1.5f, 4, (const float[]){0, 1, 0, 1})->alpha_mode = ALPHA_BLEND;
    add_quad(stage, 2, 4, red); /* hidden by the one before, but a fragment */
    add_quad(stage, 2, 4, red); /* a tie */
    stage->instances[3].material = 2;
    const DeepSample samples[] = {
        {{0, 0, 0, 0}, 1.25f, window(1.25), 0, 0},
        {{0, 1, 0, 1}, 1.5f, window(1.5), 2, 1},
        {{0.5f, 0, 0, 0.5f}, 2, window(2), 4, 2},
        {{0.5f, 0, 0, 0.5f}, 2, window(2), 6, 2},
    };
    check_pixels(stage, &small, samples, 4);
    Frame frame;
    DeepImage deep = render(&stage->scene, &small, &frame);
    Image flat;
    ck_assert_int_eq(deep_flatten(&deep, &flat), RESULT_OK);
    ck_assert_mem_eq(flat.pixels, frame.final.pixels, 8 * 8 * 16);
    image_free(&flat);
    deep_free(&deep);
    frame_free(&frame);
    /* Light beyond single precision stays finite. */
    stage->scene.light_count = 1;
    stage->lights[0] = (Light){.color = {FLT_MAX, FLT_MAX, FLT_MAX}, .attenuation = {0, 0, 1e-30f}};
    deep = render(&stage->scene, &small, &frame);
    uint32_t count;
    const DeepSample *sample = deep_pixel(&deep, 4, 4, &count);
    ck_assert_uint_eq(count, 4);
    ck_assert_float_bits(sample[1].rgba[1], FLT_MAX);
    deep_free(&deep);
    frame_free(&frame);
    free(stage);
}
END_TEST

/* Two planes that leave the view volume through the near plane a thousandth of a pixel right of the
 * centres of column 4, which snapping moves to the centres: there both have depth 0, and the one
 * that comes first is farther from the eye. */
START_TEST(test_clamped_depth)
{
    Stage *stage = stage_new();
    const float cut = 0.125f + 1.0f / 4096;
    for (int i = 0; i < 2; i++) {
        add_quad(stage, 1, 4, red);
        for (int k = 0; k < 4; k++) {
            float *position = &stage->positions[i][3 * k];
            position[2] = -(1 + (float)(i + 1) * (position[0] - cut));
        }
    }
    Frame frame;
    DeepImage deep = render(&stage->scene, &small, &frame);
    for (int y = 0; y < 8; y++) {
        uint32_t count;
        const DeepSample *samples = deep_pixel(&deep, 4, y, &count);
        ck_assert_uint_eq(count, 2);
        ck_assert_uint_lt(samples[0].primitive, 2);
        for (int i = 0; i < 2; i++) {
            ck_assert_float_bits(samples[i].depth, 0);
            ck_assert_float_eq_tol(samples[i].z, 0.999721f, 1e-5f);
        }
        ck_assert_float_bits(samples[1].z, samples[0].z);
    }
    deep_free(&deep);
    frame_free(&frame);
    free(stage);
}
END_TEST

START_TEST(test_camera)
{
    Stage *stage = stage_new();
    stage->camera.world.m[12] = 3; /* the camera moves right, the world left */
    Frame frame;
    DeepImage deep = render(&stage->scene, &small, &frame);
    ck_assert(deep.has_camera);
    const float camera[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -3, 0, 0, 1};
    for (int i = 0; i < 16; i++)
        ck_assert_float_eq(deep.world_to_camera[i], camera[i]);
    /* (5, 1, −3) is at (2, 1, −3) of the camera: on the far plane. */
    const double point[4] = {5, 1, -3, 1};
    double ndc[4] = {0};
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 4; column++)
            ndc[row] += (double)deep.world_to_ndc[4 * column + row] * point[column];
    ck_assert_double_eq_tol(ndc[0] / ndc[3], 2.0 / 3.0, 1e-6);
    ck_assert_double_eq_tol(ndc[1] / ndc[3], 1.0 / 3.0, 1e-6);
    ck_assert_double_eq_tol(ndc[2] / ndc[3], 1.0, 1e-6);
    deep_free(&deep);
    frame_free(&frame);
    free(stage);
}
END_TEST

/* ---- built-in scenes ------------------------------------------------------------------------ */

/* R, G, B, A of both within 1e-6 relative to max(1, value). */
static void check_close(const Image *got, const Image *expected, const char *what)
{
    ck_assert_int_eq(got->width, expected->width);
    ck_assert_int_eq(got->height, expected->height);
    for (int i = 0; i < 4 * got->width * got->height; i++) {
        double a = (double)((float *)got->pixels)[i], b = (double)((float *)expected->pixels)[i];
        EXPECT(fabs(a - b) <= 1e-6 * fmax(1, fabs(b)),
               "%s, pixel %d,%d channel %d: %a, expected %a", what, i / 4 % got->width,
               i / 4 / got->width, i % 4, a, b);
    }
}

/* Order, and that the file gives back every sample. */
static void check_file(const DeepImage *deep, const char *path)
{
    DeepImage back;
    ck_assert_msg(exr_deep_write(deep, path) == RESULT_OK, "%s", result_message());
    ck_assert_msg(exr_deep_read(path, SIZE_MAX, &back) == RESULT_OK, "%s", result_message());
    ck_assert_uint_eq(back.sample_count, deep->sample_count);
    ck_assert_mem_eq(back.world_to_camera, deep->world_to_camera, sizeof back.world_to_camera);
    ck_assert_mem_eq(back.world_to_ndc, deep->world_to_ndc, sizeof back.world_to_ndc);
    for (int y = 0; y < deep->height; y++)
        for (int x = 0; x < deep->width; x++) {
            uint32_t count, back_count;
            const DeepSample *a = deep_pixel(deep, x, y, &count);
            const DeepSample *b = deep_pixel(&back, x, y, &back_count);
            EXPECT(count == back_count, "pixel %d,%d: %u samples, expected %u", x, y, back_count,
                   count);
            for (uint32_t i = 0; i < count; i++) {
                EXPECT(same_sample(&a[i], &b[i]), "pixel %d,%d: sample %u differs", x, y, i);
                EXPECT(i == 0 || (a[i - 1].z <= a[i].z && a[i - 1].depth <= a[i].depth),
                       "pixel %d,%d: sample %u is in front of the one before", x, y, i);
            }
        }
    deep_free(&back);
}

static void check_scene(const Scene *scene, const RenderDesc *desc)
{
    Frame plain, frame;
    ck_assert_int_eq(truth_render(scene, desc, NULL, &plain), RESULT_OK);
    DeepImage deep = render(scene, desc, &frame);
    size_t pixels = (size_t)desc->width * (size_t)desc->height;
    ck_assert_mem_eq(frame.final.pixels, plain.final.pixels, pixels * 16);
    ck_assert_mem_eq(frame.display.pixels, plain.display.pixels, pixels * 4);
    /* Every transparent fragment and every opaque one. */
    uint64_t opaque = 0;
    for (size_t i = 0; i < pixels; i++)
        opaque +=
            deep.counts[i] && deep.pixels[i][deep.counts[i] - 1].rgba[3] == 1.0f &&
            scene->materials[deep.pixels[i][deep.counts[i] - 1].material].alpha_mode != ALPHA_BLEND;
    ck_assert_uint_eq(deep.sample_count, frame.layers.fragments + opaque);
    const char *path = scratch_path("deep.exr"), *flattened = scratch_path("flat.exr");
    check_file(&deep, path);
    Image flat;
    ck_assert_int_eq(deep_flatten(&deep, &flat), RESULT_OK);
    check_close(&flat, &plain.final, "deep_flatten");
    image_free(&flat);
    char command[512], text[1024], name[64];
    snprintf(command, sizeof command, "oiiotool %s --flatten --ch R,G,B,A -d float -o %s 2>&1",
             path, flattened);
    ck_assert_msg(scratch_run(command, text, sizeof text) == 0, "%s", text);
    ck_assert_msg(exr_read(flattened, 0, &flat, name) == RESULT_OK, "%s", result_message());
    check_close(&flat, &plain.final, "oiiotool --flatten");
    image_free(&flat);
    deep_free(&deep);
    frame_free(&frame);
    frame_free(&plain);
}

START_TEST(test_scenes)
{
    size_t count;
    const BuiltinScene *scenes = generate_table(&count);
    for (size_t i = 0; i < count; i++) {
        Scene scene;
        ck_assert_int_eq(scenes[i].generate(&scene), RESULT_OK);
        memset(scene.background, 0, sizeof scene.background);
        check_scene(&scene, &(RenderDesc){.width = 130, .height = 73, .lights = 16});
        check_scene(&scene, &(RenderDesc){.width = 1, .height = 1, .lights = -1});
        scene_override_opacity(&scene, 1); /* nothing transparent */
        check_scene(&scene, &(RenderDesc){.width = 33, .height = 17, .lights = 1});
        size_t instances = scene.instance_count;
        scene.instance_count = 0;
        check_scene(&scene, &(RenderDesc){.width = 17, .height = 33, .threads = 1});
        scene.instance_count = instances;
        scene_free(&scene);
    }
}
END_TEST

START_TEST(test_threads)
{
    Scene scene;
    Frame frame[2];
    DeepImage deep[2];
    ck_assert_int_eq(generate_find("alpha_ladder")->generate(&scene), RESULT_OK);
    for (int i = 0; i < 2; i++)
        deep[i] = render(&scene, &(RenderDesc){.width = 200, .height = 140, .threads = 1 + 3 * i},
                         &frame[i]);
    ck_assert_uint_eq(deep[0].sample_count, deep[1].sample_count);
    ck_assert_uint_gt(deep[0].sample_count, 200 * 140);
    ck_assert_mem_eq(deep[0].counts, deep[1].counts, 200 * 140 * sizeof(uint32_t));
    for (int i = 0; i < 200 * 140; i++)
        for (uint32_t s = 0; s < deep[0].counts[i]; s++)
            EXPECT(same_sample(&deep[0].pixels[i][s], &deep[1].pixels[i][s]), "pixel %d", i);
    for (int i = 0; i < 2; i++) {
        deep_free(&deep[i]);
        frame_free(&frame[i]);
    }
    scene_free(&scene);
}
END_TEST

START_TEST(test_memory_limit)
{
    Stage *stage = stage_new();
    for (int i = 0; i < ITEMS_MAX; i++)
        add_quad(stage, 1.5f + (float)i / 16, 4, red);
    RenderDesc desc = {.width = 64, .height = 64, .threads = 1};
    Frame frame;
    DeepImage deep = render(&stage->scene, &desc, &frame);
    size_t need = frame.buffer_bytes, samples = deep.sample_count * sizeof(DeepSample);
    ck_assert_uint_eq(deep.sample_count, 8 * 64 * 64);
    ck_assert_uint_gt(deep.bytes, samples);
    ck_assert_uint_gt(need, deep.bytes);
    deep_free(&deep);
    frame_free(&frame);
    /* From nothing to just too little for the samples, in steps that end in all its parts. */
    bool in_deep = false;
    for (size_t limit = 1; limit < samples; limit += samples / 50) {
        desc.max_memory = limit;
        ck_assert_int_eq(truth_render_deep(&stage->scene, &desc, &deep, &frame), RESULT_NO_MEMORY);
        ck_assert_ptr_nonnull(strstr(result_message(), "--max-memory"));
        ck_assert_ptr_null(strchr(result_message(), '\n'));
        in_deep |= strstr(result_message(), "deep image") != NULL;
        ck_assert(!deep.counts && !deep.pixels && !deep.blocks && !frame.final.pixels);
    }
    ck_assert(in_deep);
    desc.max_memory = 4 * need;
    deep = render(&stage->scene, &desc, &frame);
    deep_free(&deep);
    frame_free(&frame);
    ck_assert_int_eq(deep_create(16384, 16384, 1 << 20, &deep), RESULT_NO_MEMORY);
    deep_free(&deep);
    ck_assert_int_eq(deep_create(0, 5, SIZE_MAX, &deep), RESULT_BAD_INPUT);
    deep_free(&deep);
    DeepSample *block;
    ck_assert_int_eq(deep_create(5, 5, SIZE_MAX, &deep), RESULT_OK);
    ck_assert_int_eq(deep_block(&deep, SIZE_MAX, &block), RESULT_NO_MEMORY);
    ck_assert_int_eq(deep_block(&deep, SIZE_MAX / 36, &block), RESULT_NO_MEMORY);
    ck_assert_ptr_null(block);
    ck_assert_uint_eq(deep.sample_count, 0);
    deep_free(&deep);
    free(stage);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("deep");
    TCase *tests = tcase_create("deep");
    tcase_set_timeout(tests, 120);
    tcase_add_checked_fixture(tests, scratch_make, scratch_remove);
    tcase_add_test(tests, test_by_hand);
    tcase_add_test(tests, test_alpha_extremes);
    tcase_add_test(tests, test_clamped_depth);
    tcase_add_test(tests, test_camera);
    tcase_add_test(tests, test_scenes);
    tcase_add_test(tests, test_threads);
    tcase_add_test(tests, test_memory_limit);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

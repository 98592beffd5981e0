/* What a trace with details tells is what the frame was made of: the colours, blended again, give
 * the accumulation's bits, and every fragment of every peel is thrown away or kept. */
#include "testing.h"

#include "compare/store.h"
#include "number/blend.h"
#include "number/op.h"
#include "ref/pipeline/pipeline.h"
#include "scene/generate.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Without ties. Nothing is behind the opaque surfaces, but in the second one plane of four is made
 * opaque. */
static const char *const scenes[] = {"tutorial", "crossing_planes"};

static const RenderDesc descs[] = {
    {.method = METHOD_PEEL},
    {.method = METHOD_PEEL, .accum = FORMAT_RGBA8, .depth_range = DEPTH_RANGE_REVERSED},
    {.method = METHOD_PEEL, .accum = FORMAT_RGBA16F, .gbuffer = GBUFFER_COMPACT, .passes = 2},
    {.method = METHOD_FORWARD},
    {.method = METHOD_PEEL_ID},
    {.method = METHOD_LINKED_LIST},
};

typedef struct Traced {
    TraceStore *store;
    Frame frame;
    RenderDesc desc;
} Traced;

static Traced trace(int scene_index, int desc_index, bool details)
{
    Scene scene;
    Traced traced = {.desc = descs[desc_index]};
    traced.desc.width = 96;
    traced.desc.height = 54;
    ck_assert_int_eq(generate_find(scenes[scene_index])->generate(&scene), RESULT_OK);
    if (scene_index == 1)
        scene.materials[1].alpha_mode = ALPHA_OPAQUE;
    ck_assert_int_eq(store_create(0, &traced.store), RESULT_OK);
    store_sink(traced.store)->details = details;
    ck_assert_int_eq(pipeline_render(&scene, &traced.desc, store_sink(traced.store), &traced.frame),
                     RESULT_OK);
    scene_free(&scene);
    return traced;
}

static void release(Traced *traced)
{
    store_destroy(traced->store);
    frame_free(&traced->frame);
}

/* A buffer's pixels: of peel K (−1: of none) and this name. */
static Image image_of(const Traced *traced, int peel, const char *what)
{
    char name[48];
    Image image;
    if (peel < 0)
        snprintf(name, sizeof name, "%s", what);
    else
        snprintf(name, sizeof name, "peel.%d.%s", peel, what);
    int index = store_find(traced->store, name);
    ck_assert_msg(index >= 0, "no %s", name);
    ck_assert_int_eq(store_image(traced->store, index, &image), RESULT_OK);
    return image;
}

/* ---- colours ---- */

/* Blends the colours under accum, whose pixels must then be those of the traced one. */
static void replay(const Traced *traced, int peel, const char *source, const char *after,
                   Image *accum)
{
    Image colors = image_of(traced, peel, source), want = image_of(traced, peel, after);
    size_t bytes = format_pixel_bytes(accum->format), blended = 0;
    for (int y = 0; y < accum->height; y++)
        for (int x = 0; x < accum->width; x++) {
            const float *color = image_pixel(&colors, x, y);
            void *pixel = image_pixel(accum, x, y);
            if (color[3] != 0.0f) {
                uint32_t saved = op_enter();
                blend_under(accum->format, color, pixel);
                op_leave(saved);
                blended++;
            }
            if (memcmp(pixel, image_pixel(&want, x, y), bytes) != 0)
                ck_abort_msg("peel %d, %s: pixel %d,%d differs", peel, after, x, y);
        }
    ck_assert_uint_gt(blended + (peel < 0), 0);
    image_free(&colors);
    image_free(&want);
}

START_TEST(test_source)
{
    Traced traced = trace(_i % 2, _i / 2, true);
    Image accum;
    ck_assert_int_eq(image_create(traced.desc.width, traced.desc.height, traced.desc.accum, &accum),
                     RESULT_OK);
    for (int y = 0; y < accum.height; y++)
        for (int x = 0; x < accum.width; x++)
            blend_clear(accum.format, image_pixel(&accum, x, y));
    ck_assert_int_gt(traced.frame.peels, 1);
    for (int peel = 0; peel < traced.frame.peels; peel++)
        replay(&traced, peel, "source", "accum", &accum);
    if (store_find(traced.store, "opaque.source") >= 0)
        replay(&traced, -1, "opaque.source", "accum", &accum);
    image_free(&accum);
    release(&traced);
}
END_TEST

/* ---- fragments ---- */

typedef struct Tests {
    Image hidden, peeled, farther, primitive;
} Tests;

static Tests tests_of(const Traced *traced, int peel)
{
    return (Tests){image_of(traced, peel, "hidden"), image_of(traced, peel, "peeled"),
                   image_of(traced, peel, "farther"), image_of(traced, peel, "primitive")};
}

static void tests_free(Tests *tests)
{
    image_free(&tests->hidden);
    image_free(&tests->peeled);
    image_free(&tests->farther);
    image_free(&tests->primitive);
}

static uint32_t word_at(const Image *image, size_t i)
{
    return ((const uint32_t *)image->pixels)[i];
}

/* Of peel K: what it throws away as peeled are the layers before it, and all its fragments are
 * those of the frame. Adds up the visible ones. */
static uint64_t check_peel(const Traced *traced, int peel, const uint32_t *layers, uint64_t *hidden)
{
    Tests tests = tests_of(traced, peel);
    size_t pixels = (size_t)traced->desc.width * (size_t)traced->desc.height;
    uint64_t visible = 0;
    for (size_t i = 0; i < pixels; i++) {
        bool kept = word_at(&tests.primitive, i) != UINT32_MAX;
        uint32_t peeled = word_at(&tests.peeled, i), farther = word_at(&tests.farther, i);
        ck_assert_uint_eq(peeled, layers[i]);
        ck_assert_msg(kept || farther == 0, "pixel %zu: %u farther than none", i, farther);
        visible += peeled + farther + kept;
        *hidden += word_at(&tests.hidden, i);
    }
    tests_free(&tests);
    return visible;
}

START_TEST(test_rejected)
{
    Traced traced = trace(_i % 2, _i / 2, true);
    size_t pixels = (size_t)traced.desc.width * (size_t)traced.desc.height;
    uint32_t *layers = calloc(pixels, sizeof *layers);
    uint64_t first_hidden = 0;
    for (int peel = 0; peel < traced.frame.peels; peel++) {
        uint64_t hidden = 0, visible = check_peel(&traced, peel, layers, &hidden);
        ck_assert_uint_eq(visible, traced.frame.layers.fragments);
        if (peel == 0)
            first_hidden = hidden;
        ck_assert_uint_eq(hidden, first_hidden);
        Image ids = image_of(&traced, peel, "primitive");
        for (size_t i = 0; i < pixels; i++)
            layers[i] += word_at(&ids, i) != UINT32_MAX;
        image_free(&ids);
    }
    ck_assert_int_eq(first_hidden > 0, _i % 2 == 1);
    free(layers);
    release(&traced);
}
END_TEST

START_TEST(test_without)
{
    Traced traced = trace(1, _i, false);
    for (int i = 0; i < store_count(traced.store); i++) {
        const char *name = store_buffer(traced.store, i)->name;
        ck_assert_msg(!strstr(name, "source") && !strstr(name, "hidden") &&
                          !strstr(name, "peeled") && !strstr(name, "farther"),
                      "%s was not asked for", name);
    }
    release(&traced);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("details");
    TCase *tcase = tcase_create("details");
    int count = (int)(sizeof descs / sizeof descs[0]);
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(tcase, test_source, 0, 2 * count);
    tcase_add_loop_test(tcase, test_rejected, 0, 2 * (count - 1)); /* lists have no such tests */
    tcase_add_loop_test(tcase, test_without, 0, count);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

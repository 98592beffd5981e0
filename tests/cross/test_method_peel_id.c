/* Method peel-id: ref/pipeline against OpenGL on random soups, and what the method promises. */
#include "methods.h"

#include "compare/structure.h"
#include "gl/gl_renderer.h"
#include "ref/truth/truth.h"

#include <stdio.h>
#include <string.h>

enum {
    SOUPS = 3 /* per setting */
};

/* ---- ref against gl ---------------------------------------------------------------------------
 */

static const RenderDesc variants[] = {
    {.passes = 0},
    {.depth_func = DEPTH_LEQUAL},
    {.depth = FORMAT_D24},
    {.depth = FORMAT_D24, .depth_func = DEPTH_LEQUAL, .gbuffer = GBUFFER_SEED},
    {.depth = FORMAT_D16, .accum = FORMAT_RGBA16F, .gbuffer = GBUFFER_COMPACT},
    {.depth_range = DEPTH_RANGE_ZERO_ONE, .passes = 2},
    {.depth_range = DEPTH_RANGE_REVERSED, .depth_func = DEPTH_LEQUAL},
    {.depth_range = DEPTH_RANGE_REVERSED, .depth = FORMAT_D24},
    {.depth_range = DEPTH_RANGE_REVERSED, .depth = FORMAT_D24, .peel_test = PEEL_TEST_RAW},
    {.depth_range = DEPTH_RANGE_REVERSED,
     .depth = FORMAT_D16,
     .depth_func = DEPTH_LEQUAL,
     .peel_test = PEEL_TEST_RAW},
    {.depth = FORMAT_D24, .peel_test = PEEL_TEST_RAW, .cull = CULL_NONE, .accum = FORMAT_RGBA8},
    {.depth = FORMAT_D16, .bias = 0.01f, .accum = FORMAT_RGBA16},
    {.bias = 0.001f, .normals = NORMALS_KEPT, .back_light = true},
    {.bias = 0.001f, .depth_range = DEPTH_RANGE_REVERSED, .depth = FORMAT_D24},
    {.opaque_blend = OPAQUE_BLEND_SEED, .ggx = GGX_STABLE, .passes = 3, .cull = CULL_SEED},
    {.position = POSITION_RECONSTRUCT, .draw_order = DRAW_ORDER_SHUFFLE, .draw_seed = 7},
};

START_TEST(test_bits)
{
    static Soup soup;
    uint64_t fragments = 0;
    for (uint64_t i = 0; i < SOUPS; i++) {
        RenderDesc desc = variants[_i];
        uint64_t seed = 1 + (uint64_t)_i * SOUPS + i;
        Bits bits;
        methods_make_soup(seed, METHOD_PEEL_ID, &desc, &soup);
        bits_compare(&soup.scene, &desc, &bits);
        ck_assert_msg(bits.differing == 0, "seed %llu: %s", (unsigned long long)seed,
                      bits.difference);
        fragments += bits.layers.fragments;
    }
    ck_assert_uint_gt(fragments, 0);
}
END_TEST

/* ---- promises ---------------------------------------------------------------------------------
 */

static void render(Renderer renderer, const Scene *scene, const RenderDesc *desc, TraceSink *sink,
                   Frame *out)
{
    methods_ok(renderer(scene, desc, sink, out));
}

/* Every fragment is a layer; peel loses those at equal depths. */
START_TEST(test_keeps_ties)
{
    static Soup soup;
    uint64_t tied = 0;
    for (uint64_t seed = 1; seed <= 4 * SOUP_KINDS; seed++) {
        RenderDesc desc = {.depth_func = (DepthFunc)(seed & 1)};
        Frame peel, peel_id;
        methods_make_soup(seed, METHOD_PEEL_ID, &desc, &soup);
        render(pipeline_render, &soup.scene, &desc, NULL, &peel_id);
        desc.method = METHOD_PEEL;
        render(pipeline_render, &soup.scene, &desc, NULL, &peel);
        ck_assert_uint_eq(peel_id.layers.fragments, peel.layers.fragments);
        ck_assert_uint_eq(peel_id.layers.lost_to_ties, 0);
        ck_assert_uint_eq((uint64_t)peel_id.peels, peel_id.layers.max);
        tied += peel.layers.lost_to_ties;
        frame_free(&peel);
        frame_free(&peel_id);
    }
    ck_assert_uint_gt(tied, 0);
}
END_TEST

/* Coplanar copies whose depths are the same bits: the layers are the truth's, in its order. */
START_TEST(test_truth_order)
{
    static Soup soup;
    RenderDesc desc = {.width = 192,
                       .height = 20,
                       .method = METHOD_PEEL_ID,
                       .depth_func = (DepthFunc)_i,
                       .draw_order = DRAW_ORDER_REVERSE};
    Random random = random_seed(5);
    Frame ref, truth;
    TraceStore *stores[2];
    soup_make(&random, &soup);
    soup.camera.yfov = 1.0;
    for (uint32_t i = 0; i < 5; i++)
        soup_square(&soup, i, i == 3 ? 1.5 : 2.0, -0.2 * (double)i, 0.9);
    methods_ok(scene_validate(&soup.scene));
    for (int i = 0; i < 2; i++)
        methods_ok(store_create(0, &stores[i]));
    render(pipeline_render, &soup.scene, &desc, store_sink(stores[0]), &ref);
    render(truth_render, &soup.scene, &desc, store_sink(stores[1]), &truth);
    ck_assert_uint_eq(ref.layers.lost_to_ties, 0);
    ck_assert_int_eq(ref.peels, 5);
    for (int peel = 0; peel < 5; peel++) {
        char name[32];
        Image ids[2];
        snprintf(name, sizeof name, "peel.%d.primitive", peel);
        for (int i = 0; i < 2; i++)
            methods_ok(store_image(stores[i], store_find(stores[i], name), &ids[i]));
        ck_assert_mem_eq(ids[0].pixels, ids[1].pixels, 192 * 20 * sizeof(uint32_t));
        for (int i = 0; i < 2; i++)
            image_free(&ids[i]);
    }
    for (int i = 0; i < 2; i++)
        store_destroy(stores[i]);
    frame_free(&ref);
    frame_free(&truth);
}
END_TEST

/* What the passes did not come to is counted, and so are three passes a peel. */
START_TEST(test_pass_limit)
{
    static Soup soup;
    RenderDesc desc = {0};
    Frame all, two;
    methods_make_soup(SOUP_PERSPECTIVE, METHOD_PEEL_ID, &desc, &soup);
    render(pipeline_render, &soup.scene, &desc, NULL, &all);
    desc.passes = 2;
    render(pipeline_render, &soup.scene, &desc, NULL, &two);
    ck_assert_int_gt(all.peels, 2);
    ck_assert_int_eq(all.geometry_passes, 3 * all.peels + 1);
    ck_assert_int_eq(two.geometry_passes, 3 * 2);
    ck_assert_uint_eq(two.layers.fragments, all.layers.fragments);
    ck_assert_uint_gt(two.layers.lost_to_pass_limit, 0);
    ck_assert_uint_eq(two.layers.lost_to_ties, 0);
    frame_free(&all);
    frame_free(&two);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("peel-id");
    TCase *bits = tcase_create("bits"), *tcase = tcase_create("promises");
    tcase_set_timeout(bits, 120);
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(bits, test_bits, 0, sizeof variants / sizeof *variants);
    suite_add_tcase(suite, bits);
    tcase_add_test(tcase, test_keeps_ties);
    tcase_add_loop_test(tcase, test_truth_order, 0, 2);
    tcase_add_test(tcase, test_pass_limit);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

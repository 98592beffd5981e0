/* ref/pipeline against OpenGL on seeded triangle soups, every buffer of the trace bit for bit. */
#include "bits.h"
#include "soup.h"
#include "testing.h"

#include "base/memory.h"
#include "ref/pipeline/pipeline.h"

#include <string.h>

static void ok(Result result)
{
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

static void make_soup(uint64_t seed, Soup *soup)
{
    Random random = random_seed(seed);
    soup_make(&random, soup);
    ok(scene_validate(&soup->scene));
}

/* Renders with both and asserts equal bits; returns ref's counts. */
static LayerStats compare(const Scene *scene, const RenderDesc *desc)
{
    Bits bits;
    bits_compare(scene, desc, &bits);
    ck_assert_msg(bits.differing == 0, "%s", bits.difference);
    return bits.layers;
}

static const RenderDesc variants[] = {
    {.passes = 0},
    {.depth = FORMAT_D24},
    {.depth = FORMAT_D24, .depth_func = DEPTH_LEQUAL, .gbuffer = GBUFFER_SEED},
    {.accum = FORMAT_RGBA16, .opaque_blend = OPAQUE_BLEND_SEED},
    {.depth = FORMAT_D16, .accum = FORMAT_RGBA16F},
    {.depth_range = DEPTH_RANGE_ZERO_ONE},
    {.depth_range = DEPTH_RANGE_REVERSED, .depth_func = DEPTH_LEQUAL},
    {.depth_range = DEPTH_RANGE_REVERSED, .depth = FORMAT_D24},
    {.depth_range = DEPTH_RANGE_REVERSED, .depth = FORMAT_D16, .peel_test = PEEL_TEST_RAW},
    {.depth = FORMAT_D16, .accum = FORMAT_RGBA8, .peel_test = PEEL_TEST_RAW},
    {.accum = FORMAT_RGBA8, .opaque_blend = OPAQUE_BLEND_SEED, .depth_func = DEPTH_LEQUAL},
    {.peel_test = PEEL_TEST_RAW, .cull = CULL_SEED},
    {.peel_test = PEEL_TEST_RAW, .depth = FORMAT_D24, .cull = CULL_NONE},
    {.normals = NORMALS_KEPT, .depth_func = DEPTH_LEQUAL, .passes = 3, .lights = -1},
    {.ggx = GGX_STABLE},
    {.back_light = true, .cull = CULL_NONE},
    {.ggx = GGX_STABLE, .back_light = true, .normals = NORMALS_KEPT, .accum = FORMAT_RGBA16F},
    {.ggx = GGX_STABLE, .back_light = true, .gbuffer = GBUFFER_SEED, .accum = FORMAT_RGBA8},
    {.gbuffer = GBUFFER_COMPACT},
    {.gbuffer = GBUFFER_COMPACT, .depth = FORMAT_D24, .peel_test = PEEL_TEST_RAW},
    {.gbuffer = GBUFFER_COMPACT, .depth_range = DEPTH_RANGE_REVERSED, .depth_func = DEPTH_LEQUAL},
    {.position = POSITION_RECONSTRUCT, .depth = FORMAT_D16},
    {.position = POSITION_RECONSTRUCT,
     .gbuffer = GBUFFER_SEED,
     .depth_range = DEPTH_RANGE_ZERO_ONE},
};

START_TEST(test_soup)
{
    static Soup soup;
    RenderDesc desc = variants[_i];
    uint64_t fragments = 0;
    desc.width = 97;
    desc.height = 61;
    for (uint64_t seed = 1; seed <= (testing_full() ? 3 : 2); seed++) {
        make_soup(seed * 100 + (uint64_t)_i, &soup);
        fragments += compare(&soup.scene, &desc).fragments;
    }
    ck_assert_uint_gt(fragments, 0);
}
END_TEST

/* Close to the near plane a raw 24-bit peel test finds layers again; elsewhere it does not. */
START_TEST(test_repeated_layers)
{
    static Soup soup;
    RenderDesc desc = {.width = 97, .height = 61};
    render_desc_seed_profile(&desc);
    make_soup(2, &soup);
    ck_assert_uint_gt(compare(&soup.scene, &desc).repeated, 0);
    desc.passes = 4;
    ck_assert_uint_gt(compare(&soup.scene, &desc).repeated, 0);
    desc.peel_test = PEEL_TEST_STORED;
    desc.passes = 0;
    ck_assert_uint_eq(compare(&soup.scene, &desc).repeated, 0);
}
END_TEST

/* More lights than a uniform block holds. */
START_TEST(test_many_lights)
{
    enum {
        MANY = 1500
    };
    static Soup soup;
    const RenderDesc desc = {.width = 23, .height = 17, .passes = 2};
    make_soup(11, &soup);
    Light *lights = memory_array(MANY, sizeof *lights);
    ck_assert_ptr_nonnull(lights);
    for (int i = 0; i < MANY; i++)
        lights[i] = soup.lights[i % SOUP_LIGHTS];
    soup.scene.lights = lights;
    soup.scene.light_count = MANY;
    ck_assert_uint_gt(compare(&soup.scene, &desc).fragments, 0);
    free(lights);
}
END_TEST

static Frame render(const Scene *scene, RenderDesc desc, float range)
{
    Frame frame;
    for (size_t i = 0; i < scene->light_count; i++)
        scene->lights[i].range = range;
    ok(scene_validate(scene));
    ck_assert_uint_gt(compare(scene, &desc).fragments, 0);
    ok(pipeline_render(scene, &desc, NULL, &frame));
    return frame;
}

static size_t differing(const Frame *a, const Frame *b)
{
    size_t count = 0, pixels = (size_t)a->final.width * (size_t)a->final.height;
    for (size_t i = 0; i < pixels; i++)
        count += memcmp((const float *)a->final.pixels + 4 * i,
                        (const float *)b->final.pixels + 4 * i, 4 * sizeof(float)) != 0;
    return count;
}

/* The same bits in both, whatever the range. Too short a one leaves exactly the ambient light, a
 * huge one exactly the light without end; one between cuts through what is seen. */
START_TEST(test_ranges)
{
    static Soup soup;
    RenderDesc desc = {.width = 97, .height = 61, .ggx = (GgxForm)_i, .back_light = _i};
    make_soup(4, &soup);
    soup.scene.light_count = SOUP_LIGHTS;
    Frame endless = render(&soup.scene, desc, 0.0f), tiny = render(&soup.scene, desc, 1e-3f);
    Frame cut = render(&soup.scene, desc, 4.0f), huge = render(&soup.scene, desc, 1e15f);
    desc.lights = -1;
    Frame ambient = render(&soup.scene, desc, 0.0f);
    size_t lit = differing(&endless, &ambient), left = differing(&cut, &ambient);
    ck_assert_uint_eq(differing(&tiny, &ambient), 0);
    ck_assert_uint_eq(differing(&huge, &endless), 0);
    ck_assert_uint_gt(left, lit / 8);
    ck_assert_uint_lt(left, lit);
    Frame *const frames[] = {&endless, &tiny, &cut, &huge, &ambient};
    for (size_t i = 0; i < sizeof frames / sizeof *frames; i++)
        frame_free(frames[i]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gl against ref");
    TCase *tcase = tcase_create("bits");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, test_soup, 0, sizeof variants / sizeof *variants);
    tcase_add_test(tcase, test_repeated_layers);
    tcase_add_test(tcase, test_many_lights);
    tcase_add_loop_test(tcase, test_ranges, 0, 2);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

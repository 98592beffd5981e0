/* ref/pipeline against OpenGL on seeded triangle soups, every buffer of the trace bit for bit. */
#include "bits.h"
#include "soup.h"
#include "testing.h"

#include "base/memory.h"

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
    for (uint64_t seed = 1; seed <= 3; seed++) {
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

int main(void)
{
    Suite *suite = suite_create("gl against ref");
    TCase *tcase = tcase_create("bits");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, test_soup, 0, sizeof variants / sizeof *variants);
    tcase_add_test(tcase, test_repeated_layers);
    tcase_add_test(tcase, test_many_lights);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

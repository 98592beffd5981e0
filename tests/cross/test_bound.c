/* The bound of what single precision may do (Frame.bound) against what ref does: on every built-in
 * scene and on random soups of every kind no pixel in which ref and truth see the same fragments in
 * the same order may exceed it, in any format.
 *
 * PEEL_TEST_SEED=N runs the one soup that a failure names; PEEL_TEST_COUNT=N that many, from there
 * or from 1. */
#include "pane.h"
#include "soup_kinds.h"
#include "testing.h"
#include "truths.h"

#include "frame/method.h"
#include "ref/truth/truth.h"
#include "scene/builder.h"
#include "scene/generate.h"

#include <stdio.h>

static void ok(Result result)
{
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

/* ---- one comparison -------------------------------------------------------------------------- */

/* Fails where a pixel exceeds its bound. */
static BoundMetrics compare(const Scene *scene, const RenderDesc *desc, const char *name)
{
    Truths truths;
    ok(truths_compare(scene, desc, &truths));
    BoundMetrics bound = truths.bound;
    if (bound.exceeded) {
        int x = bound.first[0], y = bound.first[1];
        const float *a = image_pixel(&truths.ref.final, x, y);
        const float *b = image_pixel(&truths.truth.final, x, y);
        const float *most = image_pixel(&truths.truth.bound, x, y);
        for (int c = 0; c < 4; c++)
            printf("%s: %d, %d: ref %.9g truth %.9g differ by %.3g, bound %.3g\n", name, x, y,
                   (double)a[c], (double)b[c], (double)fabsf(a[c] - b[c]), (double)most[c]);
    }
    ck_assert_msg(bound.exceeded == 0, "%s: %llu of %llu pixels exceed the bound, by %g at most",
                  name, (unsigned long long)bound.exceeded, (unsigned long long)bound.pixels,
                  bound.max_ratio);
    truths_free(&truths);
    return bound;
}

/* ---- built-in scenes ------------------------------------------------------------------------- */

/* lights: how many, 0 for all. One lamp reaches few pixels. */
static const struct {
    const char *name;
    int lights;
} scenes[] = {{"teapot_hall", 3},     {"teapot_hall_stress", 3}, {"tutorial", 0}, {"chain", 0},
              {"crossing_planes", 0}, {"alpha_ladder", 0},       {"lamps", 0}};
/* The formats and forms that change the arithmetic, each at least once. */
static const struct {
    const char *name;
    bool seed;
    RenderDesc desc;
} settings[] = {
    {"default", false, {0}},
    {"seed", true, {0}},
    {"compact, stable, unfused",
     false,
     {.gbuffer = GBUFFER_COMPACT, .ggx = GGX_STABLE, .unfused = true}},
    {"d24, rgba8, reversed, back light",
     false,
     {.position = POSITION_RECONSTRUCT,
      .depth = FORMAT_D24,
      .accum = FORMAT_RGBA8,
      .depth_range = DEPTH_RANGE_REVERSED,
      .back_light = true}},
    {"d16, rgba16f, zero-one",
     false,
     {.position = POSITION_RECONSTRUCT,
      .depth = FORMAT_D16,
      .accum = FORMAT_RGBA16F,
      .depth_range = DEPTH_RANGE_ZERO_ONE}},
    {"forward, phong, rgba16",
     false,
     {.method = METHOD_FORWARD, .shading = SHADING_PHONG, .accum = FORMAT_RGBA16}},
    {"linked-list", false, {.method = METHOD_LINKED_LIST}},
    {"peel-id, stable, kept normals, back light",
     false,
     {.method = METHOD_PEEL_ID, .ggx = GGX_STABLE, .normals = NORMALS_KEPT, .back_light = true}},
};

enum {
    SETTINGS = sizeof settings / sizeof *settings,
    WIDTH = 160,
    HEIGHT = 90
};

START_TEST(test_scenes)
{
    Scene scene;
    ok(generate_find(scenes[_i].name)->generate(&scene));
    scene.background[1] = 0.5f;
    for (int i = 0; i < SETTINGS; i++) {
        RenderDesc desc = settings[i].desc;
        char name[96];
        if (settings[i].seed)
            render_desc_seed_profile(&desc);
        desc.width = WIDTH;
        desc.height = HEIGHT;
        desc.lights = scenes[_i].lights;
        snprintf(name, sizeof name, "%s, %s", scenes[_i].name, settings[i].name);
        BoundMetrics bound = compare(&scene, &desc, name);
        printf("%-60s max %.3f median %.4f p99 %.4f bound %.3g unbounded %llu of %llu\n", name,
               bound.max_ratio, bound.median_ratio, bound.p99_ratio, bound.median,
               (unsigned long long)bound.unbounded, (unsigned long long)bound.pixels);
        /* It says something: nearly everywhere it is finite, and errors come near it. */
        ck_assert_uint_gt(bound.pixels, WIDTH * HEIGHT / 3);
        ck_assert_uint_le(bound.unbounded, bound.pixels / 20);
        ck_assert_double_gt(bound.max_ratio, 0.02);
        ck_assert_double_gt(bound.median_ratio, i == 3 ? 1e-3 : i == 0 ? 3e-3 : 0.0);
    }
    fflush(stdout);
    scene_free(&scene);
}
END_TEST

/* ---- panes that random scenes found ---------------------------------------------------------- */

/* A pane at the distance 2·size that a light at the height of the eye shines on. */
static const struct {
    const char *name;
    float size, normal[3], alpha;
    RenderDesc desc;
} panes[] = {
    {"alpha that 8 bits round to 0, tested again",
     1,
     {0, 0, 1},
     0.0019f,
     {.method = METHOD_FORWARD, .gbuffer = GBUFFER_SEED, .accum = FORMAT_RGBA8}},
    {"alpha that 16 bits round to more than the test",
     1,
     {0, 0, 1},
     0.0001f,
     {.method = METHOD_FORWARD, .gbuffer = GBUFFER_SEED, .accum = FORMAT_RGBA16}},
    {"normals that overflow over w", 1e-25f, {0, 6e14f, 8e14f}, 0.5f, {.shading = SHADING_PHONG}},
    {"normals too short for the guard", 1, {0, 0, 5e-11f}, 0.5f, {.ggx = GGX_STABLE}},
};

START_TEST(test_panes)
{
    const float size = panes[_i].size;
    Mesh mesh = pane_mesh(0.9f * size, -2.0f * size, panes[_i].normal);
    Builder builder = builder_begin(panes[_i].name);
    builder_mesh(&builder, RESULT_OK, &mesh);
    builder_material(&builder,
                     &(Material){.base_color = {1, 0.5f, 0.25f, panes[_i].alpha},
                                 .roughness = 0.3f,
                                 .occlusion = 1,
                                 .alpha_mode = ALPHA_BLEND,
                                 .double_sided = true},
                     NULL);
    builder_instance(&builder, &(Instance){.world = matrix_identity()}, NULL);
    builder_light(&builder, &(Light){.position = {0.3f, 0.3f, 1},
                                     .color = {1500, 1500, 1500},
                                     .attenuation = {1, 0, 0}});
    builder_camera(&builder,
                   &(Camera){.world = matrix_identity(),
                             .yfov = 1.0,
                             .near = 0.5 * (double)size,
                             .far = 10 * (double)size},
                   NULL);
    Scene scene;
    ok(builder_finish(&builder, &scene));
    RenderDesc desc = panes[_i].desc;
    desc.width = desc.height = 8;
    BoundMetrics bound = compare(&scene, &desc, panes[_i].name);
    ck_assert_uint_ge(bound.pixels, 16);
    scene_free(&scene);
}
END_TEST

/* ---- soups ----------------------------------------------------------------------------------- */

static RenderDesc random_desc(Random *random, SoupKind kind)
{
    static const int sizes[][2] = {{33, 17}, {97, 61}, {130, 70}, {65, 64}, {31, 200}};
    static const PixelFormat depths[] = {FORMAT_D32F, FORMAT_D24, FORMAT_D16};
    static const PixelFormat accums[] = {FORMAT_RGBA32F, FORMAT_RGBA32F, FORMAT_RGBA32F,
                                         FORMAT_RGBA16F, FORMAT_RGBA16,  FORMAT_RGBA8};
    static const MethodId methods[] = {METHOD_PEEL, METHOD_PEEL, METHOD_PEEL_ID, METHOD_FORWARD,
                                       METHOD_LINKED_LIST};
    const int *size = sizes[random_bits(random) % 5];
    RenderDesc desc = {.width = size[0], .height = size[1], .threads = 1};
    if (soup_kind_is_exact(kind)) {
        desc.width = 64;
        desc.height = 64;
    }
    if (random_bits(random) % 8 == 0)
        render_desc_seed_profile(&desc);
    else if (random_bits(random) % 2) {
        desc.accum = accums[random_bits(random) % 6];
        desc.gbuffer = (GBufferFormat)(random_bits(random) % 3);
        desc.position = (PositionSource)(random_bits(random) % 2);
        desc.depth = depths[random_bits(random) % 3];
    }
    desc.method = methods[random_bits(random) % 5];
    desc.depth_range = (DepthRange)(random_bits(random) % 3);
    desc.cull = (CullMode)(random_bits(random) % 3);
    desc.normals = (NormalMode)(random_bits(random) % 2);
    desc.ggx = (GgxForm)(random_bits(random) % 2);
    desc.back_light = random_bits(random) % 2;
    desc.opaque_blend = (OpaqueBlend)(random_bits(random) % 2);
    desc.shading = random_bits(random) % 8 ? SHADING_GGX : SHADING_PHONG;
    desc.unfused = random_bits(random) % 2;
    return desc;
}

static void run_case(uint64_t seed, BoundMetrics kinds[SOUP_KINDS])
{
    static Soup soup;
    SoupKind kind = (SoupKind)(seed % SOUP_KINDS);
    Random random = random_seed(seed);
    RenderDesc desc = random_desc(&random, kind);
    soup_make_kind(&random, kind, desc.width, desc.height, &soup);
    char name[64];
    snprintf(name, sizeof name, "PEEL_TEST_SEED=%llu (%s)", (unsigned long long)seed,
             soup_kind_name(kind));
    BoundMetrics bound = compare(&soup.scene, &desc, name);
    BoundMetrics *all = &kinds[kind];
    all->pixels += bound.pixels;
    all->unbounded += bound.unbounded;
    all->max_ratio = fmax(all->max_ratio, bound.max_ratio);
}

static uint64_t environment(const char *name, uint64_t otherwise)
{
    const char *text = getenv(name);
    return text ? strtoull(text, NULL, 0) : otherwise;
}

START_TEST(test_soups)
{
    static BoundMetrics kinds[SOUP_KINDS];
    uint64_t only = environment("PEEL_TEST_SEED", 0), first = only ? only : 1;
    uint64_t wanted = environment("PEEL_TEST_COUNT", only ? 1 : 180);
    for (uint64_t i = 0; i < wanted; i++)
        run_case(first + i, kinds);
    printf("%-16s %10s %10s %10s\n", "kind", "pixels", "unbounded", "max ratio");
    for (int kind = 0; kind < SOUP_KINDS; kind++) {
        printf("%-16s %10llu %10llu %10.3f\n", soup_kind_name((SoupKind)kind),
               (unsigned long long)kinds[kind].pixels, (unsigned long long)kinds[kind].unbounded,
               kinds[kind].max_ratio);
        ck_assert(wanted < 96 || kinds[kind].pixels > 0);
    }
    fflush(stdout);
}
END_TEST

/* ---- what it is asked for -------------------------------------------------------------------- */

START_TEST(test_refused)
{
    Scene scene;
    ok(generate_find("crossing_planes")->generate(&scene));
    for (int method = 0; method < METHOD_COUNT; method++) {
        RenderDesc desc = {.width = 8, .height = 8, .method = (MethodId)method, .bound = true};
        Frame frame;
        Result result = truth_render(&scene, &desc, NULL, &frame);
        ck_assert_int_eq(result == RESULT_OK, method_has_bound(&desc));
        ck_assert_int_eq(frame.bound.pixels != NULL, method_has_bound(&desc));
        frame_free(&frame);
    }
    RenderDesc desc = {.width = 8, .height = 8};
    Frame frame;
    ok(truth_render(&scene, &desc, NULL, &frame));
    ck_assert_ptr_null(frame.bound.pixels); /* not asked for */
    frame_free(&frame);
    scene_free(&scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("bound");
    TCase *tcase = tcase_create("bound");
    tcase_set_timeout(tcase, 0); /* CTest's */
    if (!getenv("PEEL_TEST_SEED"))
        tcase_add_loop_test(tcase, test_scenes, 0, (int)(sizeof scenes / sizeof *scenes));
    tcase_add_loop_test(tcase, test_panes, 0, (int)(sizeof panes / sizeof *panes));
    tcase_add_test(tcase, test_soups);
    tcase_add_test(tcase, test_refused);
    suite_add_tcase(suite, tcase);
    return testing_run_here(suite);
}

/* The methods of dual depth peeling, deferred and forward: ref/pipeline against OpenGL in every
 * buffer, and what they promise: the passes and counts of single peeling, ties, pass limits,
 * memory, and a bound against truth.
 *
 * PEEL_TEST_SEED=N runs the one random scene that a failure names; PEEL_TEST_COUNT=N that many. */
#include "layers.h"
#include "methods.h"

#include "compare/against.h"
#include "gl/gl_renderer.h"
#include "ref/truth/truth.h"
#include "scene/generate.h"
#include "study/threeway.h"

#include <math.h>
#include <stdio.h>

static const MethodId methods[] = {METHOD_DUAL, METHOD_FORWARD_DUAL};
#define METHODS (int)(sizeof methods / sizeof *methods)

static void same_bits(const Scene *scene, const RenderDesc *desc, Bits *out)
{
    bits_compare(scene, desc, out);
    ck_assert_msg(out->differing == 0, "%s", out->difference);
}

static void render_ref(const Scene *scene, const RenderDesc *desc, Frame *out)
{
    methods_ok(pipeline_render(scene, desc, NULL, out));
}

enum {
    WIDTH = 24,
    HEIGHT = 16,
    PIXELS = WIDTH * HEIGHT
};

/* ---- passes ---- */

static RenderDesc layers_desc(int method)
{
    return (RenderDesc){.width = WIDTH, .height = HEIGHT, .method = methods[method]};
}

START_TEST(test_pass_limit)
{
    static Layers layers;
    const double depths[9] = {2, 3, 4, 5, 6, 7, 8, 9, 10};
    RenderDesc desc = layers_desc(_i);
    Bits bits;
    Frame frame;
    layers_make(9, depths, &layers);
    for (desc.passes = 1; desc.passes <= 6; desc.passes++) {
        int taken = desc.passes < 5 ? desc.passes : 5;
        uint64_t left = taken < 5 ? (uint64_t)(9 - 2 * taken) : 0;
        double transmittance = 1.0;
        for (int i = 0; i < taken; i++)
            transmittance *= 1.0 - (double)layers.materials[i].base_color[3];
        if (desc.passes == 2 || desc.passes == 5)
            same_bits(&layers.scene, &desc, &bits);
        render_ref(&layers.scene, &desc, &frame);
        ck_assert_int_eq(frame.geometry_passes, 1 + taken);
        ck_assert_uint_eq(frame.layers.lost_to_pass_limit, left * PIXELS);
        ck_assert_uint_eq(frame.layers.lost_to_ties, 0);
        ck_assert_uint_eq(frame.residual_pixels, left ? PIXELS : 0);
        ck_assert_msg(fabs(frame.residual_max - (left ? transmittance : 0.0)) < 1e-6,
                      "got %g, expected %g", frame.residual_max, transmittance);
        frame_free(&frame);
    }
}
END_TEST

/* ---- equal depths ---- */

static bool same_image(const Frame *a, const Frame *b)
{
    return memcmp(a->final.pixels, b->final.pixels, PIXELS * 4 * sizeof(float)) == 0;
}

/* Of three layers `lost` coincides with another: either method counts it, and the image of the
 * deferred one is the same without it. */
static void check_tie(int method, DepthFunc func, const double depths[3], int lost)
{
    static Layers layers;
    RenderDesc desc = layers_desc(method);
    Bits bits;
    Frame all, without;
    desc.depth_func = func;
    layers_make(3, depths, &layers);
    same_bits(&layers.scene, &desc, &bits);
    render_ref(&layers.scene, &desc, &all);
    ck_assert_uint_eq(all.layers.fragments, 3 * PIXELS);
    ck_assert_uint_eq(all.layers.lost_to_ties, PIXELS);
    ck_assert_int_eq(all.peels, 1);
    for (size_t i = (size_t)lost; i < 3; i++)
        layers.instances[i] = layers.instances[i + 1];
    layers.scene.instance_count = 3;
    render_ref(&layers.scene, &desc, &without);
    if (methods[method] == METHOD_DUAL)
        ck_assert_msg(same_image(&all, &without), "the lost layer shows");
    frame_free(&all);
    frame_free(&without);
}

START_TEST(test_ties)
{
    const double front[3] = {3, 3, 5}, back[3] = {3, 5, 5};
    check_tie(_i, DEPTH_LESS, front, 1);
    check_tie(_i, DEPTH_LEQUAL, front, 0);
    check_tie(_i, DEPTH_LESS, back, 2);
    check_tie(_i, DEPTH_LEQUAL, back, 1);
}
END_TEST

/* Nearest and farthest at one depth: a front, drawn once. */
START_TEST(test_both_fronts)
{
    static Layers layers;
    const double depths[2] = {3, 3};
    RenderDesc desc = layers_desc(_i);
    Frame pair;
    Bits bits;
    layers_make(2, depths, &layers);
    same_bits(&layers.scene, &desc, &bits);
    render_ref(&layers.scene, &desc, &pair);
    ck_assert_int_eq(pair.geometry_passes, 2);
    ck_assert_uint_eq(pair.layers.lost_to_ties, PIXELS);
    /* The greater of both alphas where MAX mixes, else the first's. */
    float first = layers.materials[0].base_color[3], second = layers.materials[1].base_color[3];
    ck_assert_float_gt(second, first);
    frame_free(&pair);
    /* Without the opaque surface the coverage tells what was blended. */
    layers.scene.instance_count = 2;
    render_ref(&layers.scene, &desc, &pair);
    float expected = methods[_i] == METHOD_DUAL ? first : second;
    ck_assert_msg(fabsf(((const float *)pair.final.pixels)[3] - expected) < 1e-6f, "got %g",
                  (double)((const float *)pair.final.pixels)[3]);
    frame_free(&pair);
}
END_TEST

/* ---- random scenes ---- */

static uint64_t environment(const char *name, uint64_t otherwise)
{
    const char *text = getenv(name);
    return text ? strtoull(text, NULL, 0) : otherwise;
}

/* Single peeling finds the same layers where it tells depths apart as well. */
static void check_counts(const Scene *scene, const RenderDesc *desc, uint64_t seed)
{
    RenderDesc single = *desc;
    Frame dual, peel;
    single.method = METHOD_PEEL;
    render_ref(scene, desc, &dual);
    render_ref(scene, &single, &peel);
    ck_assert_msg(
        dual.layers.max == peel.layers.max && dual.layers.fragments == peel.layers.fragments &&
            dual.layers.lost_to_ties == peel.layers.lost_to_ties,
        "seed %llu: most %u, %u; fragments %llu, %llu; ties %llu, %llu", (unsigned long long)seed,
        dual.layers.max, peel.layers.max, (unsigned long long)dual.layers.fragments,
        (unsigned long long)peel.layers.fragments, (unsigned long long)dual.layers.lost_to_ties,
        (unsigned long long)peel.layers.lost_to_ties);
    ck_assert_msg(dual.peels == (peel.peels + 1) / 2 && dual.geometry_passes == 1 + dual.peels,
                  "seed %llu: %d peels, %d geometry passes for %d layers", (unsigned long long)seed,
                  dual.peels, dual.geometry_passes, peel.peels);
    frame_free(&dual);
    frame_free(&peel);
}

static void run_case(uint64_t seed, Bits *sum)
{
    static Soup soup;
    SoupKind kind = (SoupKind)(seed % SOUP_KINDS);
    Random random = random_seed(seed);
    RenderDesc desc = random_desc(&random, kind);
    desc.method = methods[seed / SOUP_KINDS % METHODS];
    Bits bits;
    soup_make_kind(&random, kind, desc.width, desc.height, &soup);
    bits_compare(&soup.scene, &desc, &bits);
    ck_assert_msg(bits.differing == 0, "PEEL_TEST_SEED=%llu (%s): %s", (unsigned long long)seed,
                  soup_kind_name(kind), bits.difference);
    sum->values += bits.values;
    sum->layers.fragments += bits.layers.fragments;
    sum->layers.lost_to_ties += bits.layers.lost_to_ties;
    sum->layers.lost_to_pass_limit += bits.layers.lost_to_pass_limit;
    if (desc.passes == 0 && render_desc_depth(&desc) == FORMAT_D32F &&
        desc.peel_test == PEEL_TEST_STORED && desc.bias == 0.0f)
        check_counts(&soup.scene, &desc, seed);
}

START_TEST(test_random_scenes)
{
    Bits sum = {0};
    uint64_t only = environment("PEEL_TEST_SEED", 0), first = only ? only : 1;
    uint64_t count = environment("PEEL_TEST_COUNT", only ? 1 : 42);
    for (uint64_t i = 0; i < count; i++)
        run_case(first + i, &sum);
    printf("random scenes: %llu, values compared: %llu, fragments: %llu, ties: %llu, past the "
           "limit: %llu\n",
           (unsigned long long)count, (unsigned long long)sum.values,
           (unsigned long long)sum.layers.fragments, (unsigned long long)sum.layers.lost_to_ties,
           (unsigned long long)sum.layers.lost_to_pass_limit);
    fflush(stdout);
    if (count < 42)
        return;
    ck_assert_uint_gt(sum.layers.lost_to_ties, 0);
    ck_assert_uint_gt(sum.layers.lost_to_pass_limit, 0);
}
END_TEST

/* ---- truth ---- */

/* ref alone, gl has its bits. The 99th percentile is that of `peel` with --position reconstruct
 * for the deferred method, and that of `peel` for the other. */
START_TEST(test_truth)
{
    static const Renderer renderers[] = {pipeline_render, pipeline_render, truth_render};
    size_t count;
    const BuiltinScene *scenes = generate_table(&count);
    for (size_t i = 0; i < count; i++) {
        Scene scene;
        Threeway report;
        RenderDesc desc = {.width = 80, .height = 45, .lights = 3, .method = methods[_i]};
        methods_ok(scenes[i].generate(&scene));
        methods_ok(threeway_run(&scene, "", &desc, renderers, 2e-5, false, &report));
        printf("%-20s p99 %.3g, max %.3g\n", scenes[i].name, report.pairs[1].unaffected.p99_rel,
               report.pairs[1].unaffected.max_rel);
        fflush(stdout);
        ck_assert_msg(report.agree, "%s", scenes[i].name);
        threeway_free(&report);
        scene_free(&scene);
    }
}
END_TEST

/* ---- memory ---- */

static uint64_t buffer_bytes(Renderer renderer, const Scene *scene, RenderDesc desc,
                             MethodId method)
{
    Frame frame;
    desc.method = method;
    desc.ref_path = REF_PATH_DEFINITION;
    methods_ok(renderer(scene, &desc, NULL, &frame));
    uint64_t bytes = frame.buffer_bytes;
    frame_free(&frame);
    return bytes;
}

/* Every buffer of the method is in the sum: of `peel` the bytes a pixel are known. */
START_TEST(test_buffer_bytes)
{
    static Layers layers;
    static const struct {
        Renderer renderer;
        uint64_t peel, own[METHODS];
    } rows[] = {
        /* G-buffer and a depth more; with primitive ids in ref. Min-max depths, accumulation; six
         * colours, or three. */
        {pipeline_render, 72 + 4, {16 + 16 + 8 + 96, 16 + 16 + 8 + 48}},
        {gl_render, 68 + 4, {16 + 16 + 96, 16 + 16 + 48}},
    };
    RenderDesc desc = layers_desc(_i);
    desc.model_all = true;
    layers_ladder(6, &layers);
    for (int i = 0; i < 2; i++) {
        uint64_t peel = buffer_bytes(rows[i].renderer, &layers.scene, desc, METHOD_PEEL);
        ck_assert_uint_eq(buffer_bytes(rows[i].renderer, &layers.scene, desc, methods[_i]) +
                              PIXELS * rows[i].peel,
                          peel + PIXELS * rows[i].own[_i]);
    }
}
END_TEST

START_TEST(test_memory)
{
    static Layers layers;
    RenderDesc desc = layers_desc(_i);
    Frame frame;
    layers_ladder(6, &layers);
    desc.max_memory = (size_t)buffer_bytes(pipeline_render, &layers.scene, desc, methods[_i]);
    render_ref(&layers.scene, &desc, &frame);
    frame_free(&frame);
    desc.max_memory--;
    ck_assert_int_eq(pipeline_render(&layers.scene, &desc, NULL, &frame), RESULT_NO_MEMORY);
    desc.max_memory = 0;
    /* Textures, and a little that is not limited; the last of them is one of the method's own. */
    size_t bytes = (size_t)buffer_bytes(gl_render, &layers.scene, desc, methods[_i]);
    desc.max_memory = bytes;
    methods_ok(gl_render(&layers.scene, &desc, NULL, &frame));
    frame_free(&frame);
    desc.max_memory = bytes - 4 * PIXELS;
    ck_assert_int_eq(gl_render(&layers.scene, &desc, NULL, &frame), RESULT_NO_MEMORY);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("dual peeling");
    TCase *tcase = tcase_create("methods");
    tcase_set_timeout(tcase, 0); /* CTest's */
    tcase_add_loop_test(tcase, test_pass_limit, 0, METHODS);
    tcase_add_loop_test(tcase, test_ties, 0, METHODS);
    tcase_add_loop_test(tcase, test_both_fronts, 0, METHODS);
    tcase_add_loop_test(tcase, test_truth, 0, METHODS);
    tcase_add_loop_test(tcase, test_buffer_bytes, 0, METHODS);
    tcase_add_loop_test(tcase, test_memory, 0, METHODS);
    tcase_add_test(tcase, test_random_scenes);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

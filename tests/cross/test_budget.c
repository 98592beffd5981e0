/* The error budget and the classes of pixels, on scenes where one cause is known to act. */
#include "layers.h"
#include "testing.h"

#include "ref/pipeline/pipeline.h"
#include "ref/truth/truth.h"
#include "scene/generate.h"
#include "study/budget.h"

#include <stdio.h>

enum {
    WIDTH = 32,
    HEIGHT = 20,
    PIXELS = WIDTH * HEIGHT
};

static void ok(Result result)
{
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

static RenderDesc layers_desc(void)
{
    return (RenderDesc){.width = WIDTH, .height = HEIGHT};
}

/* What holds of every budget. */
static void run(const Scene *scene, const RenderDesc *desc, Budget *out)
{
    uint64_t all = (uint64_t)desc->width * (uint64_t)desc->height, sum = 0, seen = 0;
    ok(budget_run(scene, desc, pipeline_render, truth_render, out));
    for (int i = 0; i < CLASS_COUNT; i++)
        sum += out->counts[i];
    for (uint64_t i = 0; i < all; i++)
        seen += out->classes[i] == CLASS_EQUAL;
    ck_assert_uint_eq(sum, all);
    ck_assert_uint_eq(seen, out->counts[CLASS_EQUAL]);
    ck_assert_uint_eq(out->counts[CLASS_EQUAL] + out->total.pixels + out->nonfinite, all);
    ck_assert(out->terms[BUDGET_ROUNDING].measured && out->terms[BUDGET_ORDER].measured);
    ck_assert_double_le(out->total.max_abs, out->sum.max_abs + out->unexplained.max_abs + 1e-12);
}

/* Only `term` is more than rounding, and all pixels are of the class. */
static void only(const Budget *budget, BudgetTerm term, PixelClass class)
{
    for (int i = 0; i < BUDGET_TERMS; i++)
        if (budget->terms[i].measured && i != (int)term)
            ck_assert_msg(budget->terms[i].max_abs <= 1e-5, "%s: %g",
                          budget_term_key((BudgetTerm)i), budget->terms[i].max_abs);
    ck_assert(budget->terms[term].measured);
    ck_assert_double_gt(budget->terms[term].rmse, 1e-5);
    ck_assert_double_ge(budget->explained, 0.9999);
    ck_assert_msg(budget->counts[class] == PIXELS, "%llu of class %s",
                  (unsigned long long)budget->counts[class], class_key(class));
}

START_TEST(test_rounding)
{
    static Layers layers;
    RenderDesc desc = layers_desc();
    Budget budget;
    layers_ladder(5, &layers);
    run(&layers.scene, &desc, &budget);
    ck_assert_double_eq(budget.terms[BUDGET_ROUNDING].max_abs, budget.total.max_abs);
    ck_assert_double_lt(budget.total.max_abs, 1e-5);
    ck_assert_double_gt(budget.total.max_abs, 0.0);
    ck_assert_uint_eq(budget.terms[BUDGET_ORDER].pixels, 0);
    ck_assert_uint_eq(budget.counts[CLASS_ROUNDING] + budget.counts[CLASS_EQUAL], PIXELS);
    for (int i = BUDGET_METHOD; i < BUDGET_TERMS; i++)
        ck_assert(!budget.terms[i].measured);
    budget_free(&budget);
}
END_TEST

START_TEST(test_one_cause)
{
    static const struct {
        BudgetTerm term;
        PixelClass class;
        RenderDesc desc;
    } rows[] = {
        {BUDGET_PASSES, CLASS_LOST_LIMIT, {.passes = 2}},
        {BUDGET_PASSES, CLASS_LOST_LIMIT, {.passes = 1, .method = METHOD_FORWARD_DUAL}},
        {BUDGET_BIAS, CLASS_LOST_BIAS, {.bias = 0.5f}},
        {BUDGET_GBUFFER, CLASS_GBUFFER, {.gbuffer = GBUFFER_COMPACT}},
        {BUDGET_ACCUM, CLASS_ACCUM, {.accum = FORMAT_RGBA16F}},
        {BUDGET_METHOD, CLASS_METHOD, {.method = METHOD_WEIGHTED_AVERAGE}},
        {BUDGET_METHOD, CLASS_METHOD, {.method = METHOD_LINKED_LIST}},
    };
    static Layers layers;
    RenderDesc desc = rows[_i].desc;
    Budget budget;
    desc.width = WIDTH;
    desc.height = HEIGHT;
    layers_ladder(5, &layers);
    run(&layers.scene, &desc, &budget);
    only(&budget, rows[_i].term, rows[_i].class);
    budget_free(&budget);
}
END_TEST

/* Three of four layers coincide: peel keeps one of them, peel-id all. */
START_TEST(test_ties)
{
    static const double depths[] = {2.0, 3.0, 3.0, 3.0};
    static Layers layers;
    RenderDesc desc = layers_desc();
    Budget budget;
    layers_make(4, depths, &layers);
    run(&layers.scene, &desc, &budget);
    only(&budget, BUDGET_TIES, CLASS_LOST_TIE);
    budget_free(&budget);
    desc.method = METHOD_PEEL_ID;
    run(&layers.scene, &desc, &budget);
    ck_assert(!budget.terms[BUDGET_TIES].measured);
    ck_assert_double_lt(budget.total.max_abs, 1e-5);
    budget_free(&budget);
}
END_TEST

/* Layers that 16 bits cannot tell apart. */
START_TEST(test_depth)
{
    static const double depths[] = {20.0, 20.001, 20.002};
    static Layers layers;
    RenderDesc desc = layers_desc();
    Budget budget;
    layers_make(3, depths, &layers);
    desc.depth = FORMAT_D16;
    run(&layers.scene, &desc, &budget);
    ck_assert_double_gt(budget.terms[BUDGET_DEPTH].rmse, 1e-3);
    ck_assert_double_ge(budget.explained, 0.9999);
    ck_assert_uint_eq(budget.counts[CLASS_LOST_TIE], PIXELS);
    budget_free(&budget);
}
END_TEST

/* The raw test compares a depth with what was stored of it, which rounding made nearer: the first
 * of two layers is peeled again and again, the second never. */
START_TEST(test_repeated)
{
    static Layers layers;
    RenderDesc desc = layers_desc();
    Budget budget;
    desc.depth = FORMAT_D16;
    desc.peel_test = PEEL_TEST_RAW;
    uint64_t repeated = 0;
    for (int i = 0; i < 8; i++) {
        const double depths[] = {2.0 + 1e-4 * i, 6.0};
        layers_make(2, depths, &layers);
        run(&layers.scene, &desc, &budget);
        uint64_t lost = budget.counts[CLASS_REPEATED];
        ck_assert(lost == 0 || lost == PIXELS);
        ck_assert_uint_eq(budget.counts[CLASS_LOST_TIE], 0);
        repeated += lost > 0;
        budget_free(&budget);
    }
    ck_assert_uint_gt(repeated, 0);
    ck_assert_uint_lt(repeated, 8);
}
END_TEST

/* A triangle next to the least numbers there are: clipped, its pieces are folded over each other,
 * so that pixels have it twice. That is no layer peeled twice. */
START_TEST(test_folded)
{
    static const float corners[9] = {-0x1.9e7e4ep-116f, 0x1.51cb2p-119f,  -0x1.78db0cp-119f,
                                     0x1.0e8a26p-118f,  0x1.6a5cecp-120f, -0x1.d10234p-119f,
                                     0x1.4f4734p-116f,  0x1.afaca8p-120f, -0x1.2b6662p-119f};
    static const double depths[] = {1.0}, turned[3] = {0.9995714426040649, -0.02927379682660103};
    static Layers layers;
    RenderDesc desc = {.width = 255, .height = 31};
    Budget budget;
    layers_make(1, depths, &layers);
    memcpy(layers.position, corners, sizeof corners);
    layers.mesh.vertex_count = 3;
    layers.mesh.triangle_count = 1;
    layers.scene.instance_count = 1;
    layers.instances[0].world = matrix_scale(-1.0, 1.0, 1.0);
    layers.camera.world.m[0] = layers.camera.world.m[10] = turned[0];
    layers.camera.world.m[2] = turned[1];
    layers.camera.world.m[8] = -turned[1];
    layers.camera.yfov = 1.4;
    layers.camera.near = 0x1p-124;
    layers.camera.far = 0x1.2p-118;
    run(&layers.scene, &desc, &budget);
    ck_assert_uint_eq(budget.counts[CLASS_REPEATED], 0);
    ck_assert_uint_eq(budget.counts[CLASS_COVERAGE], 17); /* in 3 of these it is twice */
    ck_assert_uint_eq(budget.counts[CLASS_UNEXPLAINED], 0);
    budget_free(&budget);
}
END_TEST

/* Such a triangle (1) whose second piece is behind the last pass, with a layer between both. */
START_TEST(test_folded_behind_limit)
{
    uint32_t seen[] = {0, 1}, exact[] = {0, 1, 2}, single[] = {0, 1, 2, 1};
    uint32_t depths[] = {100, 200, 300, 400};
    const RenderDesc desc = {.method = METHOD_PEEL_ID, .passes = 2};
    StructurePixel ref = {.ids = seen, .count = 2};
    const StructurePixel truth = {.ids = exact, .count = 3},
                         best = {.ids = single, .depths = depths, .count = 4};
    ck_assert_int_eq(class_of_fragments(&desc, &ref, &truth, &best, &best), CLASS_LOST_LIMIT);
    /* What is in front of a layer that it has is not behind its last pass. */
    seen[1] = 2;
    ref.count = 2;
    ck_assert_int_eq(class_of_fragments(&desc, &ref, &truth, &best, &best), CLASS_UNEXPLAINED);
}
END_TEST

/* A layer whose depth becomes that of the opaque surface: no method has it. */
START_TEST(test_depth_of_opaque)
{
    static const double depths[] = {20.0, 39.9999};
    static const MethodId methods[] = {METHOD_PEEL, METHOD_PEEL_ID, METHOD_LINKED_LIST};
    static Layers layers;
    RenderDesc desc = layers_desc();
    Budget budget;
    layers_make(2, depths, &layers);
    desc.method = methods[_i];
    desc.depth = FORMAT_D16;
    run(&layers.scene, &desc, &budget);
    ck_assert_double_ge(budget.explained, 0.9999);
    ck_assert_uint_eq(budget.counts[CLASS_DEPTH], PIXELS);
    budget_free(&budget);
}
END_TEST

/* A light so red that 8-bit colours end at 1: clamping is nearly all of it, the rest is the
 * format's. */
START_TEST(test_clamp)
{
    static Layers layers;
    RenderDesc desc = layers_desc();
    Budget budget;
    layers_ladder(4, &layers);
    layers.light.color[0] = 400.0f;
    desc.accum = FORMAT_RGBA8;
    run(&layers.scene, &desc, &budget);
    ck_assert_double_gt(budget.terms[BUDGET_CLAMP].max_abs, 1.0);
    ck_assert_double_lt(budget.terms[BUDGET_ACCUM].max_abs, 6.0 / 255.0);
    ck_assert_double_gt(budget.terms[BUDGET_ACCUM].max_abs, 0.1 / 255.0);
    ck_assert_double_ge(budget.explained, 0.9999);
    ck_assert_uint_eq(budget.counts[CLASS_ACCUM], PIXELS);
    budget_free(&budget);
}
END_TEST

/* The built-in scenes in the seed's formats. */
START_TEST(test_seed)
{
    size_t count;
    const BuiltinScene *scenes = generate_table(&count);
    for (size_t i = 0; i < count; i++) {
        Scene scene;
        Budget budget;
        RenderDesc desc = {.width = 80, .height = 45, .lights = 3};
        render_desc_seed_profile(&desc);
        ok(scenes[i].generate(&scene));
        run(&scene, &desc, &budget);
        printf("%-20s %.4f %% explained, %llu pixels of no class\n", scenes[i].name,
               100.0 * budget.explained, (unsigned long long)budget.counts[CLASS_UNEXPLAINED]);
        fflush(stdout);
        ck_assert_double_ge(budget.explained, 0.99);
        ck_assert_uint_le(budget.counts[CLASS_UNEXPLAINED], 80 * 45 / 100);
        budget_free(&budget);
        scene_free(&scene);
    }
}
END_TEST

/* A renderer that fails in the middle leaves nothing. */
static int calls;

static Result fails_late(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    if (++calls == 3)
        return result_fail(RESULT_INTERNAL, "on purpose");
    return pipeline_render(scene, desc, trace, out);
}

START_TEST(test_failure)
{
    static Layers layers;
    RenderDesc desc = layers_desc();
    Budget budget;
    desc.passes = 1;
    layers_ladder(2, &layers);
    ck_assert_int_eq(budget_run(&layers.scene, &desc, fails_late, truth_render, &budget),
                     RESULT_INTERNAL);
    ck_assert_ptr_null(budget.classes);
}
END_TEST

/* One pixel of the picture in question has what no change of settings gives. */
static Result errs_once(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    Result result = pipeline_render(scene, desc, trace, out);
    if (result == RESULT_OK && calls++ == 0)
        ((float *)image_pixel(&out->final, 5, 7))[1] += 0.5f;
    return result;
}

START_TEST(test_unexplained)
{
    static Layers layers;
    RenderDesc desc = layers_desc();
    Budget budget;
    layers_ladder(3, &layers);
    ok(budget_run(&layers.scene, &desc, errs_once, truth_render, &budget));
    ck_assert_uint_eq(budget.counts[CLASS_UNEXPLAINED], 1);
    ck_assert_int_eq(budget.classes[7 * WIDTH + 5], CLASS_UNEXPLAINED);
    ck_assert_double_lt(budget.explained, 0.01);
    ck_assert_double_ge(budget.unexplained.max_abs, 0.499);
    budget_free(&budget);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("budget");
    TCase *tcase = tcase_create("budget");
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_rounding);
    tcase_add_loop_test(tcase, test_one_cause, 0, 7);
    tcase_add_test(tcase, test_ties);
    tcase_add_test(tcase, test_depth);
    tcase_add_test(tcase, test_repeated);
    tcase_add_test(tcase, test_folded);
    tcase_add_test(tcase, test_folded_behind_limit);
    tcase_add_loop_test(tcase, test_depth_of_opaque, 0, 3);
    tcase_add_test(tcase, test_clamp);
    tcase_add_test(tcase, test_seed);
    tcase_add_test(tcase, test_failure);
    tcase_add_test(tcase, test_unexplained);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

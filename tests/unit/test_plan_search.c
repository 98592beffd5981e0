/* The search for the cheapest settings, with renderers that only pretend: times and errors are what
 * the test says. */
#include "testing.h"

#include "study/plan.h"

#include <math.h>

/* Half the error with each doubling of passes; with enough, what the format adds. */
static double error_of(const RenderDesc *desc)
{
    double floor = desc->accum == FORMAT_RGBA32F ? 0.001
                   : desc->accum == FORMAT_RGBA8 ? 0.02
                                                 : 0.01;
    if (desc->method == METHOD_WEIGHTED_SUM)
        return 0.3;
    return desc->passes > 0 && desc->passes < 8 ? 0.5 / desc->passes : floor;
}

static double cost_of(const RenderDesc *desc)
{
    double passes = desc->passes > 0 && desc->passes < 8 ? desc->passes : 9;
    double accum = desc->accum == FORMAT_RGBA32F ? 4 : desc->accum == FORMAT_RGBA8 ? 1 : 2;
    double method = desc->method == METHOD_PEEL ? 1 : desc->method == METHOD_WEIGHTED_SUM ? 0.1 : 2;
    return (passes + accum) * method + (desc->gbuffer == GBUFFER_COMPACT ? 1 : 0);
}

static Result make_frame(float value, double cost, Frame *out)
{
    *out = (Frame){.cpu_ms = cost, .time_ms = 2 * cost};
    Result result = image_create(1, 1, FORMAT_RGBA32F, &out->final);
    if (result == RESULT_OK)
        ((float *)out->final.pixels)[1] = value;
    return result;
}

static Result pretend_ref(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    (void)scene;
    ck_assert_ptr_null(trace);
    if (desc->method == METHOD_LINKED_LIST)
        return result_fail(RESULT_NO_MEMORY, "no room");
    return make_frame((float)error_of(desc), cost_of(desc), out);
}

static Result pretend_truth(const Scene *scene, const RenderDesc *desc, TraceSink *trace,
                            Frame *out)
{
    (void)scene;
    (void)desc;
    (void)trace;
    return make_frame(0.0f, 1e6, out);
}

static Plan plan;
static PlanRequest request;
static PlanSearch found;

static void search(double max_error)
{
    static const Scene scene;
    request.max_error = max_error;
    ck_assert_int_eq(plan_search(&scene, &plan, &request, pretend_ref, pretend_truth, &found),
                     RESULT_OK);
}

static void make(void)
{
    plan = (Plan){.desc = {.width = 1, .height = 1},
                  .layers.most = {.fragments = 9, .peels = 8, .ids = 9, .depths = 8}};
    plan.needs.items[NEED_OPAQUE].needed = true;
    request = (PlanRequest){.space.passes = -1};
    for (int i = 0; i < METHOD_COUNT; i++)
        request.space.methods[i] = true;
    for (int i = 0; i < PLAN_ACCUMS; i++)
        request.space.accums[i] = true;
    for (int i = 0; i < PLAN_GBUFFERS; i++)
        request.space.gbuffers[i] = true;
}

static void check_chosen(MethodId method, int passes, PixelFormat accum)
{
    ck_assert_int_ge(found.chosen, 0);
    const PlanChoice *choice = &found.choices[found.chosen];
    ck_assert(choice->chosen);
    ck_assert(choice->pareto);
    ck_assert_int_eq(choice->method, method);
    ck_assert_int_eq(choice->passes, passes);
    ck_assert_int_eq(choice->accum, accum);
    ck_assert_int_eq(choice->gbuffer, GBUFFER_FULL);
    ck_assert_int_eq(choice->runs, 3);
    ck_assert_double_le(choice->error, found.max_error);
}

START_TEST(test_cheapest)
{
    make();
    search(0.0011);
    check_chosen(METHOD_PEEL, 0, FORMAT_RGBA32F);
    plan_search_free(&found);
    search(0.015);
    check_chosen(METHOD_PEEL, 0, FORMAT_RGBA16F);
    plan_search_free(&found);
    search(0.13);
    check_chosen(METHOD_PEEL, 4, FORMAT_RGBA8);
    plan_search_free(&found);
    search(0.31);
    check_chosen(METHOD_WEIGHTED_SUM, 0, FORMAT_RGBA8);
    plan_search_free(&found);
}
END_TEST

START_TEST(test_nothing_reaches)
{
    make();
    search(0.0005);
    ck_assert_int_eq(found.chosen, -1);
    ck_assert_double_eq_tol(found.choices[found.best].error, 0.001, 1e-8);
    for (size_t i = 0; i < found.count; i++) /* one of each method, and none without room */
        for (size_t k = 0; k < i; k++)
            ck_assert_int_ne(found.choices[i].method, found.choices[k].method);
    ck_assert_uint_eq(found.count, METHOD_COUNT - 1);
    plan_search_free(&found);
}
END_TEST

START_TEST(test_pruning)
{
    make();
    search(0.13);
    for (size_t i = 0; i < found.count; i++) {
        const PlanChoice *choice = &found.choices[i];
        ck_assert_msg(choice->method != METHOD_WEIGHTED_SUM ||
                          (choice->accum == FORMAT_RGBA32F && choice->gbuffer == GBUFFER_FULL),
                      "weighted-sum was tried again behind its floor");
        ck_assert_msg(choice->passes == 0 || choice->passes == 1 || choice->passes == 2 ||
                          choice->passes == 4,
                      "%d passes were tried", choice->passes);
        ck_assert(choice->method != METHOD_FORWARD || choice->gbuffer != GBUFFER_COMPACT);
        ck_assert(choice->runs == 1 || choice->runs == 3);
        ck_assert(choice->passes == 0 || choice->method != METHOD_PAINTER);
    }
    plan_search_free(&found);
    search(0.6); /* one pass reaches it */
    for (size_t i = 0; i < found.count; i++)
        ck_assert_int_le(found.choices[i].passes, 1);
    plan_search_free(&found);
}
END_TEST

START_TEST(test_space)
{
    make();
    for (int i = 0; i < METHOD_COUNT; i++)
        request.space.methods[i] = i == METHOD_DUAL;
    request.space.passes = 2;
    request.space.accums[0] = request.space.accums[1] = request.space.accums[2] = false;
    request.space.gbuffers[GBUFFER_SEED] = request.space.gbuffers[GBUFFER_COMPACT] = false;
    search(1.0);
    ck_assert_uint_eq(found.count, 1);
    check_chosen(METHOD_DUAL, 2, FORMAT_RGBA8);
    plan_search_free(&found);
    request.metric = PLAN_RMSE;
    search(1.0);
    ck_assert_double_eq_tol(found.choices[0].error, 0.25 / 2, 1e-6); /* one channel of four */
    plan_search_free(&found);
    request.metric = PLAN_P99;
    search(1.0);
    ck_assert_double_eq_tol(found.choices[0].error, 0.25, 1e-6);
    plan_search_free(&found);
}
END_TEST

START_TEST(test_no_room)
{
    static const Scene scene;
    make();
    for (int i = 0; i < METHOD_COUNT; i++)
        request.space.methods[i] = i == METHOD_LINKED_LIST;
    ck_assert_int_eq(plan_search(&scene, &plan, &request, pretend_ref, pretend_truth, &found),
                     RESULT_NO_MEMORY);
    ck_assert_ptr_null(found.choices);
}
END_TEST

START_TEST(test_passes_of_layers)
{
    const LayerCount none = {0}, some = {.fragments = 7, .peels = 4, .ids = 7, .depths = 5};
    for (int i = 0; i < METHOD_COUNT; i++)
        ck_assert_int_eq(layers_passes(&none, (MethodId)i), 1);
    ck_assert_int_eq(layers_passes(&some, METHOD_PEEL), 5);
    ck_assert_int_eq(layers_passes(&some, METHOD_PEEL_ID), 22);
    ck_assert_int_eq(layers_passes(&some, METHOD_FORWARD_DUAL), 4);
    ck_assert_int_eq(layers_passes(&some, METHOD_LINKED_LIST), 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("plan");
    TCase *tcase = tcase_create("search");
    tcase_add_test(tcase, test_cheapest);
    tcase_add_test(tcase, test_nothing_reaches);
    tcase_add_test(tcase, test_pruning);
    tcase_add_test(tcase, test_space);
    tcase_add_test(tcase, test_no_room);
    tcase_add_test(tcase, test_passes_of_layers);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

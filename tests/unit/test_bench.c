/* Statistics, the Pareto front, ratios, formats and the run of a benchmark, with renderers made up
 * here. */
#include "testing.h"

#include "report/bench.h"
#include "study/bench_stats.h"

#include <jansson.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <unistd.h>

/* ---- statistics ------------------------------------------------------------------------------ */

START_TEST(test_median_and_spread)
{
    double spread;
    ck_assert_double_eq(bench_median((double[]){7.0}, 1, &spread), 7.0);
    ck_assert_double_eq(spread, 0.0);
    ck_assert_double_eq(bench_median((double[]){9.0, 1.0, 4.0}, 3, &spread), 4.0);
    ck_assert_double_eq(spread, 2.0);
    ck_assert_double_eq(bench_median((double[]){8.0, 2.0, 4.0, 4.0}, 4, &spread), 4.0);
    ck_assert_double_eq(bench_median((double[]){8.0, 2.0, 6.0, 4.0}, 4, &spread), 5.0);
    ck_assert_double_eq(spread, 1.2);
    ck_assert_double_eq(bench_median((double[]){0.0, 0.0}, 2, &spread), 0.0);
    ck_assert_double_eq(spread, 0.0);
}
END_TEST

START_TEST(test_pareto)
{
    static const struct {
        double cpu_ms, rmse;
        bool front;
    } cases[] = {{1.0, 0.5, true},  {2.0, 0.5, false}, {2.0, 0.25, true}, {3.0, 0.3, false},
                 {1.5, NAN, false}, {9.0, 0.0, true},  {9.0, 0.0, true},  {9.5, 0.0, false}};
    enum {
        COUNT = sizeof cases / sizeof *cases
    };
    BenchRow rows[COUNT] = {{0}};
    for (int i = 0; i < COUNT; i++)
        rows[i] = (BenchRow){.cpu_ms = cases[i].cpu_ms, .rmse = cases[i].rmse, .pareto = true};
    ck_assert(bench_mark_pareto(rows, COUNT) == RESULT_OK);
    for (int i = 0; i < COUNT; i++)
        ck_assert_msg(rows[i].pareto == cases[i].front, "row %d", i);
}
END_TEST

START_TEST(test_ratios)
{
    BenchRow rows[] = {
        {.renderer = BENCH_REF, .lights = 1, .cpu_ms = 1.0},
        {.renderer = BENCH_GL, .lights = 1, .cpu_ms = 2.0},
        {.renderer = BENCH_REF, .lights = 2, .cpu_ms = 2.0},
        {.renderer = BENCH_GL, .lights = 2, .cpu_ms = 16.0},
        {.renderer = BENCH_REF, .lights = 2, .format = 1, .cpu_ms = 5.0},
        {.renderer = BENCH_GL, .lights = 2, .format = 1, .cpu_ms = 5.0},
        {.renderer = BENCH_REF, .lights = 3, .cpu_ms = 2.0}, /* alone */
    };
    const BenchReport report = {.rows = rows, .count = sizeof rows / sizeof *rows};
    BenchRatios test = bench_ratios(&report, &rows[0], BENCH_GL);
    ck_assert_uint_eq(test.cells, 2);
    ck_assert_double_eq_tol(test.mean, 4.0, 1e-12);
    ck_assert_double_eq(test.least, 2.0);
    BenchRatios all = bench_ratios(&report, NULL, BENCH_GL);
    ck_assert_uint_eq(all.cells, 3);
    ck_assert_double_eq(all.least, 1.0);
    BenchRatios none = bench_ratios(&report, NULL, BENCH_GL_EARLY);
    ck_assert_uint_eq(none.cells, 0);
    ck_assert(isnan(none.mean) && isnan(none.least));
}
END_TEST

START_TEST(test_formats)
{
    BenchFormat format;
    RenderDesc desc = {0};
    ck_assert(bench_format_parse("default", &format));
    bench_format_apply(&format, &desc);
    ck_assert_mem_eq(&desc, &(RenderDesc){0}, sizeof desc);
    ck_assert(bench_format_parse("compact+rgba16f+d16", &format));
    ck_assert_str_eq(format.name, "compact+rgba16f+d16");
    bench_format_apply(&format, &desc);
    ck_assert_int_eq(desc.gbuffer, GBUFFER_COMPACT);
    ck_assert_int_eq(desc.accum, FORMAT_RGBA16F);
    ck_assert_int_eq(desc.depth, FORMAT_D16);
    ck_assert(bench_format_parse("seed", &format));
    desc = (RenderDesc){0};
    bench_format_apply(&format, &desc);
    ck_assert(render_desc_is_seed(&desc));
    ck_assert(!bench_format_parse("", &format));
    ck_assert(!bench_format_parse("rgba8+", &format));
    ck_assert(!bench_format_parse("rgb8", &format));
    ck_assert(
        !bench_format_parse("rgba8+rgba8+rgba8+rgba8+rgba8+rgba8+rgba8+rgba8+rgba8", &format));
}
END_TEST

/* ---- a run ----------------------------------------------------------------------------------- */

/* Frames of one pixel: its value is 1 + 2^-passes, gl's with a bit more on request. */
typedef struct Fake {
    const RenderDesc *desc;
    int frames;
    bool is_ref;
} Fake;

static bool gl_differs;

static Result draw_pixel(const RenderDesc *desc, float value, Frame *out)
{
    *out = (Frame){.buffer_bytes = 1000, .peels = desc->passes, .fused = true};
    Result result = image_create(1, 1, FORMAT_RGBA32F, &out->final);
    if (result == RESULT_OK)
        result = image_create(1, 1, FORMAT_RGBA8, &out->display);
    if (result == RESULT_OK)
        *(float *)out->final.pixels = value;
    return result;
}

static Result open_fake(const RenderDesc *desc, bool is_ref, void **state)
{
    Fake *fake = calloc(1, sizeof *fake);
    ck_assert_ptr_nonnull(fake);
    *fake = (Fake){.desc = desc, .is_ref = is_ref};
    *state = fake;
    return desc->passes == 13 ? result_fail(RESULT_UNSUPPORTED, "not 13") : RESULT_OK;
}

static Result open_fake_ref(const Scene *scene, const RenderDesc *desc, void **state)
{
    (void)scene;
    return open_fake(desc, true, state);
}

static Result open_fake_gl(const Scene *scene, const RenderDesc *desc, void **state)
{
    (void)scene;
    return open_fake(desc, false, state);
}

/* The first takes 1000 ms: a warm-up. Then 1, 3, 2 ms, and for gl ten times as much. */
static Result frame_fake(void *state, bool images, Frame *out)
{
    static const double times[] = {1000.0, 1.0, 3.0, 2.0};
    Fake *fake = state;
    ck_assert_int_eq(images, fake->frames == 0);
    float value = 1.0f + ldexpf(1.0f, -fake->desc->passes);
    Result result =
        draw_pixel(fake->desc, gl_differs && !fake->is_ref ? nextafterf(value, 2.0f) : value, out);
    out->cpu_ms = times[fake->frames++] * (fake->is_ref ? 1.0 : 10.0);
    out->time_ms = 0.5 * out->cpu_ms;
    return result;
}

static Result fake_truth(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    (void)scene, (void)trace;
    return draw_pixel(desc, 1.0f, out);
}

static const BenchRenderer fakes[BENCH_RENDERERS] = {
    [BENCH_REF] = {open_fake_ref, frame_fake, free},
    [BENCH_GL] = {open_fake_gl, frame_fake, free},
};

static char scene_name[] = "it's <one>";
static const Scene scene = {.name = scene_name, .light_count = 4};

static BenchPlan make_plan(void)
{
    BenchPlan plan = {.sizes = {{1, 1}},
                      .lights = {2, 4},
                      .threads = {1, 2},
                      .methods = {METHOD_PEEL},
                      .passes = {1, 3, 10},
                      .scene_count = 1,
                      .size_count = 1,
                      .light_count = 2,
                      .thread_count = 2,
                      .method_count = 1,
                      .format_count = 1,
                      .pass_count = 3,
                      .renderers = {[BENCH_REF] = true, [BENCH_GL] = true},
                      .runs = 3,
                      .errors = true,
                      .bound = fakes,
                      .truth = fake_truth};
    plan.scenes[0].scene = &scene;
    bench_format_parse("default", &plan.formats[0]);
    return plan;
}

static void count_group(void *context, const BenchReport *report, size_t first)
{
    ck_assert_uint_eq(report->count - first, 6);
    ++*(int *)context;
}

START_TEST(test_run)
{
    BenchPlan plan = make_plan();
    BenchReport report;
    int groups = 0;
    ck_assert_uint_eq(bench_row_count(&plan), 24);
    ck_assert_int_eq(bench_run(&plan, count_group, &groups, &report), RESULT_OK);
    ck_assert_int_eq(groups, 4);
    ck_assert_uint_eq(report.count, 24);
    ck_assert_uint_eq(report.differing, 0);
    for (size_t i = 0; i < report.count; i++) {
        const BenchRow *row = &report.rows[i];
        bool is_ref = row->renderer == BENCH_REF;
        double error = ldexp(1.0, -row->passes);
        ck_assert_int_eq(row->renderer, i % 2 ? BENCH_GL : BENCH_REF);
        ck_assert_int_eq(row->passes, plan.passes[i / 2 % 3]);
        ck_assert_int_eq(row->threads, i / 6 % 2 ? 2 : 1);
        ck_assert_int_eq(row->lights, i / 12 ? 4 : 2);
        ck_assert_double_eq(row->cpu_ms, is_ref ? 2.0 : 20.0);
        ck_assert_double_eq(row->wall_ms, is_ref ? 1.0 : 10.0);
        ck_assert_double_eq(row->spread, 1.0);
        ck_assert_double_eq(row->max_abs, error);
        ck_assert_double_eq_tol(row->rmse, error / 2.0, 1e-15); /* one of four channels */
        ck_assert_uint_eq(row->peak_bytes, 1000);
        ck_assert(row->pareto == (is_ref && row->passes == 10));
    }
    bench_free(&report);
}
END_TEST

START_TEST(test_run_reports_other_bits)
{
    BenchPlan plan = make_plan();
    BenchReport report;
    gl_differs = true;
    ck_assert_int_eq(bench_run(&plan, NULL, NULL, &report), RESULT_OK);
    ck_assert_uint_eq(report.differing, 12);
    bench_free(&report);
}
END_TEST

START_TEST(test_run_fails_as_its_parts_do)
{
    BenchPlan plan = make_plan();
    BenchReport report;
    plan.passes[1] = 13;
    ck_assert_int_eq(bench_run(&plan, NULL, NULL, &report), RESULT_UNSUPPORTED);
    ck_assert_str_eq(result_message(), "not 13");
    ck_assert_ptr_null(report.rows);
    plan = make_plan();
    plan.lights[1] = 5;
    ck_assert_int_eq(bench_run(&plan, NULL, NULL, &report), RESULT_BAD_INPUT);
    plan = make_plan();
    plan.fma_fixed = true;
    plan.scenes[0].desc.unfused = true;
    ck_assert_int_eq(bench_run(&plan, NULL, NULL, &report), RESULT_NO_GL);
}
END_TEST

/* ---- what is written ------------------------------------------------------------------------- */

START_TEST(test_json)
{
    static const char *const keys[] = {"scene",  "size",    "renderer", "method",    "passes",
                                       "lights", "formats", "threads",  "cpu_ms",    "wall_ms",
                                       "spread", "max_abs", "rmse",     "peak_bytes"};
    BenchPlan plan = make_plan();
    BenchReport report;
    char path[] = "/tmp/test_bench.XXXXXX";
    close(mkstemp(path));
    plan.errors = false;
    ck_assert_int_eq(bench_run(&plan, NULL, NULL, &report), RESULT_OK);
    ck_assert_int_eq(report_bench_json(&report, path), RESULT_OK);
    json_t *root = json_load_file(path, 0, NULL), *rows = json_object_get(root, "rows");
    unlink(path);
    ck_assert_uint_eq(json_array_size(rows), 24);
    const json_t *row = json_array_get(rows, 5);
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        ck_assert_msg(json_object_get(row, keys[i]), "no %s", keys[i]);
    ck_assert_str_eq(json_string_value(json_object_get(row, "size")), "1x1");
    ck_assert_int_eq(json_integer_value(json_object_get(row, "passes")), 10);
    ck_assert(json_is_null(json_object_get(row, "rmse")));
    const json_t *ratios = json_object_get(json_object_get(root, "summary"), "gl_to_ref");
    ck_assert_double_eq_tol(json_real_value(json_object_get(ratios, "geometric_mean")), 10.0, 1e-9);
    ck_assert_int_eq(json_integer_value(json_object_get(ratios, "cells")), 12);
    ck_assert_uint_eq(json_array_size(json_object_get(ratios, "tests")), 2);
    json_decref(root);
    bench_free(&report);
}
END_TEST

START_TEST(test_table)
{
    BenchPlan plan = make_plan();
    BenchReport report;
    char *text = NULL;
    size_t size;
    ck_assert_int_eq(bench_run(&plan, NULL, NULL, &report), RESULT_OK);
    FILE *out = open_memstream(&text, &size);
    report_bench_print(&report, 18, out);
    report_bench_print_ratios(&report, out);
    fclose(out);
    ck_assert_ptr_nonnull(strstr(text, "it's <one>, 1x1, 4 lights, 2 threads"));
    ck_assert_ptr_nonnull(strstr(text, "gl / ref: geometric mean 10.00, least 10.00 of 6"));
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n"))
        ck_assert_msg(strlen(line) <= 100, "%s", line);
    free(text);
    bench_free(&report);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("bench");
    TCase *tcase = tcase_create("bench");
    tcase_add_test(tcase, test_median_and_spread);
    tcase_add_test(tcase, test_pareto);
    tcase_add_test(tcase, test_ratios);
    tcase_add_test(tcase, test_formats);
    tcase_add_test(tcase, test_run);
    tcase_add_test(tcase, test_run_reports_other_bits);
    tcase_add_test(tcase, test_run_fails_as_its_parts_do);
    tcase_add_test(tcase, test_json);
    tcase_add_test(tcase, test_table);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

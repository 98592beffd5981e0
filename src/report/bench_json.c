/* The document of `peel bench --json`: its keys are a contract, as those of json.c. What is not a
 * finite number is null. */
#include "frame/method.h"
#include "report/bench.h"
#include "report/document.h"
#include "study/bench_stats.h"

/* What names a test. */
static json_t *test_object(Document *json, const BenchReport *report, const BenchRow *row)
{
    json_t *object = json_object();
    char size[32];
    snprintf(size, sizeof size, "%dx%d", row->width, row->height);
    document_put(json, object, "scene",
                 document_string(report->plan->scenes[row->scene].scene->name));
    document_put(json, object, "size", json_string(size));
    document_put(json, object, "method", json_string(method_info(row->method)->name));
    document_put(json, object, "formats", json_string(report->plan->formats[row->format].name));
    document_put(json, object, "threads", json_integer(row->threads));
    return object;
}

static json_t *row_object(Document *json, const BenchReport *report, const BenchRow *row)
{
    json_t *object = test_object(json, report, row);
    document_put(json, object, "renderer", json_string(bench_renderer_name(row->renderer)));
    document_put(json, object, "passes",
                 row->passes ? json_integer(row->passes) : json_string("auto"));
    document_put(json, object, "lights", json_integer(row->lights));
    document_put(json, object, "cpu_ms", document_real(row->cpu_ms));
    document_put(json, object, "wall_ms", document_real(row->wall_ms));
    document_put(json, object, "spread", document_real(row->spread));
    document_put(json, object, "wall_spread", document_real(row->wall_spread));
    document_put(json, object, "max_abs", document_real(row->max_abs));
    document_put(json, object, "rmse", document_real(row->rmse));
    document_put(json, object, "peak_bytes", json_integer((json_int_t)row->peak_bytes));
    document_put(json, object, "peels", json_integer(row->peels));
    document_put(json, object, "differing", json_integer((json_int_t)row->differing));
    document_put(json, object, "pareto", json_boolean(row->pareto));
    return object;
}

static void put_ratios(Document *json, json_t *object, BenchRatios ratios)
{
    document_put(json, object, "geometric_mean", document_real(ratios.mean));
    document_put(json, object, "least", document_real(ratios.least));
    document_put(json, object, "cells", json_integer((json_int_t)ratios.cells));
}

/* The tests in which renderer has a time beside ref's, each once. */
static json_t *tests_of(Document *json, const BenchReport *report, int renderer)
{
    json_t *tests = json_array();
    for (size_t i = 0; i < report->count; i++) {
        const BenchRow *row = &report->rows[i];
        bool first = row->renderer == renderer;
        for (size_t k = 0; k < i && first; k++)
            first = report->rows[k].renderer != renderer || !bench_same_test(&report->rows[k], row);
        BenchRatios ratios = bench_ratios(report, row, renderer);
        if (!first || !ratios.cells)
            continue;
        json_t *test = test_object(json, report, row);
        put_ratios(json, test, ratios);
        document_append(json, tests, test);
    }
    return tests;
}

static json_t *summary(Document *json, const BenchReport *report)
{
    static const struct {
        const char *key;
        int renderer;
    } pairs[] = {{"gl_to_ref", BENCH_GL}, {"gl_early_to_ref", BENCH_GL_EARLY}};
    json_t *object = json_object();
    document_put(json, object, "runs", json_integer(report->plan->runs));
    document_put(json, object, "differing_rows", json_integer((json_int_t)report->differing));
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        BenchRatios all = bench_ratios(report, NULL, pairs[i].renderer);
        if (!all.cells)
            continue;
        json_t *pair = json_object();
        put_ratios(json, pair, all);
        document_put(json, pair, "tests", tests_of(json, report, pairs[i].renderer));
        document_put(json, object, pairs[i].key, pair);
    }
    return object;
}

Result report_bench_json(const BenchReport *report, const char *path)
{
    Document json = {0};
    json_t *root = json_object(), *rows = json_array();
    for (size_t i = 0; i < report->count; i++)
        document_append(&json, rows, row_object(&json, report, &report->rows[i]));
    document_put(&json, root, "rows", rows);
    document_put(&json, root, "summary", summary(&json, report));
    return document_write(&json, root, path);
}

/* peel driver's rules without a driver: the rules against themselves are exact, every rule reports
 * a driver that is wrong, and what is printed. */
#include "testing.h"

#include "ref/pipeline/experiment.h"
#include "ref/pipeline/pipeline.h"
#include "report/driver.h"
#include "scratch.h"

#include <jansson.h>
#include <stdio.h>

static PipelineLab model;

/* ---- a driver that is wrong ------------------------------------------------------------------ */

/* A lab that changes bits of some of what the rules' lab gives. */
typedef struct FaultyLab {
    Lab lab;
    uint32_t bits;
    bool coverage; /* of triangles: the coverage, else all other fields */
    int skip;      /* experiments of each pair that are left as they are: 0 or 1 */
    int runs;
} FaultyLab;

static Result run_faulty(Lab *lab, const Experiment *experiment, uint32_t *out)
{
    FaultyLab *self = (FaultyLab *)lab;
    Result result = model.lab.run(&model.lab, experiment, out);
    if (self->skip && self->runs++ % 2 == 0)
        return result;
    bool raster = experiment->kind == EXPERIMENT_RASTER;
    size_t step = experiment->kind == EXPERIMENT_DEPTH_FETCH ? 2 : 1; /* of those the second */
    for (size_t i = step - 1; i < experiment_values(experiment); i += step)
        if (!raster || (i % RASTER_FIELDS == RASTER_TRIANGLE) == self->coverage)
            out[i] ^= self->bits;
    return result;
}

typedef struct FaultySink {
    TraceSink sink;
    TraceSink *next;
} FaultySink;

/* Moves the depths of the third peel. */
static Result put_faulty(TraceSink *sink, const TraceBuffer *buffer)
{
    FaultySink *self = (FaultySink *)sink;
    if (strcmp(buffer->name, "peel.2.depth") == 0) {
        uint32_t *codes = (uint32_t *)buffer->pixels;
        for (int i = 0; i < buffer->width * buffer->height; i++)
            codes[i] ^= 8;
    }
    return self->next->put(self->next, buffer);
}

static Result render_faulty(const Scene *scene, const RenderDesc *desc, TraceSink *trace,
                            Frame *out)
{
    FaultySink sink = {{.put = put_faulty}, trace};
    return pipeline_render(scene, desc, &sink.sink, out);
}

/* A driver that is right (fault −1), or wrong in one of four ways. */
static void run_rule(size_t index, int fault, uint32_t bits, DriverRule *out)
{
    FaultyLab faulty = {
        .lab = {run_faulty}, .bits = bits, .coverage = fault & 1, .skip = fault >> 1 & 1};
    Result result = fault < 0 ? driver_run_rule(index, &model.lab, &model.lab, pipeline_render, out)
                              : driver_run_rule(index, &model.lab, &faulty.lab, render_faulty, out);
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

START_TEST(test_rule_can_fail)
{
    DriverRule right, wrong;
    model = pipeline_lab(true);
    run_rule((size_t)_i, -1, 0, &right);
    if (right.verdict == DRIVER_UNTESTED) {
        ck_assert_ptr_nonnull(right.reason);
        return;
    }
    ck_assert_msg(right.verdict == DRIVER_EXACT && right.samples > 0 && !right.has_example,
                  "%s differs from itself", right.id);
    for (int fault = 0; fault < 4; fault++) {
        run_rule((size_t)_i, fault, 8, &wrong);
        if (wrong.verdict != DRIVER_EXACT)
            break;
    }
    ck_assert_msg(wrong.verdict == (wrong.relied_on ? DRIVER_BROKEN : DRIVER_DIFFERS), "%s: %s",
                  wrong.id, driver_verdict_name(wrong.verdict));
    ck_assert(wrong.has_example);
    ck_assert_uint_gt(wrong.differing, 0);
    ck_assert_uint_gt(wrong.max_distance, 0);
    ck_assert_uint_ne(wrong.example.expected, wrong.example.got);
    if (strncmp(right.id, "under-", 6) == 0) { /* a blend may round otherwise */
        run_rule((size_t)_i, 0, 1, &wrong);
        ck_assert_int_eq(wrong.verdict, DRIVER_DIFFERS);
    }
}
END_TEST

/* ---- what is printed --------------------------------------------------------------------------
 */

static const DriverName name = {"nobody", "by hand \"1\"", "4.6", "4.60", "neither"};
static const char *const inputs[] = {"a", "b"};
static DriverRule rules[4];
static DriverReport report;

static void make_report(void)
{
    rules[0] = (DriverRule){.id = "sum", .what = "a + b", .section = "First", .samples = 1234567};
    rules[1] = (DriverRule){.id = "half",
                            .what = "truncated",
                            .section = "First",
                            .verdict = DRIVER_DIFFERS,
                            .samples = 10,
                            .differing = 3,
                            .max_distance = 2,
                            .value = DRIVER_HALF,
                            .has_example = true,
                            .example = {.place = "channel 2",
                                        .input_count = 2,
                                        .inputs = {0.5f, -INFINITY},
                                        .input_names = inputs,
                                        .value = DRIVER_HALF,
                                        .expected = 0x3c00,
                                        .got = 0x3c02}};
    rules[2] = (DriverRule){
        .id = "edges",
        .what = "once",
        .section = "Second",
        .relied_on = true,
        .verdict = DRIVER_BROKEN,
        .samples = 10,
        .differing = 1,
        .max_distance = 1,
        .value = DRIVER_CODE,
        .has_example = true,
        .example = {.place = "pixel 1, 2", .value = DRIVER_CODE, .expected = 1, .got = 2}};
    rules[3] = (DriverRule){.id = "samples",
                            .what = "several",
                            .section = "Not tested",
                            .verdict = DRIVER_UNTESTED,
                            .reason = "one is enough"};
    report = (DriverReport){rules, 4, 1, 1, 1, 1};
}

static void assert_contains(const char *text, const char *part)
{
    ck_assert_msg(strstr(text, part) != NULL, "no \"%s\" in:\n%s", part, text);
}

static void print_report(char *text, size_t size)
{
    FILE *file = fopen(scratch_path("table.txt"), "w");
    ck_assert_ptr_nonnull(file);
    report_driver_print(&name, &report, file);
    fclose(file);
    scratch_read(scratch_path("table.txt"), text, size);
}

START_TEST(test_table)
{
    static char text[16384];
    make_report();
    print_report(text, sizeof text);
    assert_contains(text, "renderer: by hand \"1\"\n");
    assert_contains(text, "multiply-adds: neither (");
    assert_contains(text, "1,234,567");
    assert_contains(text, "2 ULP differs\n");
    assert_contains(text, "\n* edges ");
    assert_contains(text, "1 code broken\n");
    assert_contains(text, "half: channel 2\n  a = 0.5 (0x1p-1)  b = -inf (-inf)\n"
                          "  expected 1 (0x1p+0), got 1.00195312 (0x1.008p+0)\n");
    assert_contains(text, "edges: pixel 1, 2\n  expected 1, got 2\n");
    assert_contains(text, "several: one is enough\n");
    assert_contains(text, "1 rules exact, 1 differ, 1 broken, 1 not tested\n"
                          "BROKEN: peeling relies on edges\n");
    report.broken = 0;
    print_report(text, sizeof text);
    assert_contains(text, "\nDIFFERS, ");
    report.differ = 0;
    print_report(text, sizeof text);
    assert_contains(text, "\nEXACT\n");
}
END_TEST

START_TEST(test_json)
{
    const char *path = scratch_path("driver.json");
    make_report();
    ck_assert_int_eq(report_driver_json(&name, &report, path), RESULT_OK);
    json_error_t error;
    json_t *root = json_load_file(path, 0, &error);
    ck_assert_msg(root != NULL, "%s", error.text);
    char *text = json_dumps(root, JSON_COMPACT);
    assert_contains(text, "\"gl\":{\"vendor\":\"nobody\",\"renderer\":\"by hand \\\"1\\\"\"");
    assert_contains(text, "\"arithmetic\":\"neither\"");
    assert_contains(text, "{\"id\":\"sum\",\"what\":\"a + b\",\"section\":\"First\","
                          "\"relied_on\":false,\"verdict\":\"exact\",\"samples\":1234567,"
                          "\"differing\":0,\"max_ulp\":0,\"example\":null,\"reason\":null}");
    assert_contains(text, "{\"value\":null,\"hex\":\"-inf\",\"name\":\"b\"}");
    assert_contains(text, "\"expected\":{\"value\":1.0,\"hex\":\"0x1p+0\",\"bits\":\"0x3c00\"}");
    assert_contains(text, "\"got\":{\"value\":2,\"bits\":\"0x00000002\"}");
    assert_contains(text, "\"verdict\":\"not tested\"");
    assert_contains(text, "\"exact\":1,\"differ\":1,\"broken\":1,\"untested\":1}");
    free(text);
    json_decref(root);
    ck_assert_int_eq(report_driver_json(&name, &report, scratch_path("none/x.json")), RESULT_IO);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("driver rules");
    TCase *tcase = tcase_create("rules");
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(tcase, test_rule_can_fail, 0, (int)driver_rule_count());
    suite_add_tcase(suite, tcase);
    TCase *printed = tcase_create("printed");
    tcase_add_checked_fixture(printed, scratch_make, scratch_remove);
    tcase_add_test(printed, test_table);
    tcase_add_test(printed, test_json);
    suite_add_tcase(suite, printed);
    return testing_run(suite);
}

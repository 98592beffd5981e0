/* report: the text table, the JSON document and the page of a comparison made by hand. */
#include "base/file.h"
#include "report/html.h"
#include "report/summary.h"
#include "report/table.h"

#include "page_checks.h"
#include "sample_report.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>

static void print_table(char *text, size_t size)
{
    FILE *file = fopen(scratch_path("table.txt"), "w");
    ck_assert_ptr_nonnull(file);
    report_table_print(&report, file);
    fclose(file);
    scratch_read(scratch_path("table.txt"), text, size);
}

START_TEST(test_rows_fold)
{
    size_t cursor = 0, buffers_seen = 0, rows = 0;
    SummaryRow row;
    make_differ();
    while (summary_row(&report.pairs[0], 96, &cursor, &row)) {
        buffers_seen += row.buffers;
        ck_assert_msg((rows == 1) == (row.differing != 0), "row %zu is %s", rows, row.label);
        rows++;
    }
    ck_assert_uint_eq(rows, 3);
    ck_assert_uint_eq(buffers_seen, BUFFERS);
    cursor = 0;
    summary_row(&report.pairs[0], 96, &cursor, &row);
    ck_assert_str_eq(row.label, "opaque.depth to peel.3.depth");
    ck_assert_uint_eq(row.values, (uint64_t)(5 + 3 * PER_PEEL + 1) * WIDTH * HEIGHT * 4);
    /* Few buffers have a row each. */
    report.pairs[0].buffer_count = 96;
    cursor = rows = 0;
    while (summary_row(&report.pairs[0], 96, &cursor, &row))
        rows++;
    ck_assert_uint_eq(rows, 96);
}
END_TEST

START_TEST(test_table)
{
    static char text[65536];
    print_table(text, sizeof text);
    assert_contains(text, "opaque.depth to display");
    assert_contains(text, "103 equal buffers are folded");
    assert_contains(text, "\nAGREE\n");
    assert_lacks(text, "  0, 0, 0\n");
    assert_contains(text, "ref and gl agree bit for bit: 23,731,200 values in 103 buffers.");
    assert_contains(text, "99th percentile of the relative difference 3.5e-07");
    assert_contains(text, "gl took 2.00 times the wall time of ref.");
    assert_contains(text, "equal");
    assert_contains(text, "(gl's time includes compiling its shaders");
    make_differ();
    report.frames[RENDERER_REF].residual_pixels = 1234;
    report.frames[RENDERER_REF].residual_max = 0.25;
    print_table(text, sizeof text);
    assert_contains(text, "\nDIFFER\n");
    assert_contains(text, "  12, 34, 2\n");
    assert_contains(text, "first in peel.3.normal at x 12, y 34, channel 2.");
    assert_contains(text, "fragments in 1,234 pixels; up to 0.25 of their light");
}
END_TEST

START_TEST(test_numbers)
{
    char out[SUMMARY_NUMBER];
    ck_assert_str_eq(summary_count(0, out), "0");
    ck_assert_str_eq(summary_count(999, out), "999");
    ck_assert_str_eq(summary_count(1000, out), "1,000");
    ck_assert_str_eq(summary_count(UINT64_MAX, out), "18,446,744,073,709,551,615");
    ck_assert_str_eq(summary_ulp(UINT32_MAX, out), "NaN");
    ck_assert_str_eq(summary_psnr(INFINITY, out), "equal");
    ck_assert_str_eq(summary_real(1e-300, out), "1e-300");
}
END_TEST

/* What only some methods have. */
START_TEST(test_lines_of_methods)
{
    static char text[65536];
    Frame *ref = &report.frames[RENDERER_REF];
    LayerStats *layers = &report.structure.layers;
    print_table(text, sizeof text);
    assert_lacks(text, "nodes x");
    assert_lacks(text, "Sums left");
    ref->nodes = 2097152;
    ref->node_bytes = 24;
    layers->overflowed = 1234;
    report.desc.accum = FORMAT_RGBA16F;
    print_table(text, sizeof text);
    assert_contains(text, "\nThe lists need 2,097,152 nodes x 24 bytes = 48.0 MiB.\n");
    assert_contains(text, "\nSums left the range of their format (rgba16f) in 1,234 pixels.\n");
    layers->lost_to_overflow = 5678;
    print_table(text, sizeof text);
    assert_contains(text, "= 48.0 MiB; there was no room for 5,678 of them.\n");
    report.desc.method = METHOD_LINKED_LIST;
    report.pairs[1].unaffected.p99_rel = 2e-4;
    print_table(text, sizeof text);
    assert_contains(text, "Peels: 16 layers, one pass");
    assert_contains(text, "G-buffer: compact");
    assert_contains(text, " The compact G-buffer stores in 8 and 16 bits,");
    report.desc.method = METHOD_WEIGHTED_BLENDED;
    print_table(text, sizeof text);
    assert_contains(text, "Peels: none, one pass");
    assert_contains(text, "Weight: equation 9");
    assert_contains(text, "weighted-blended approximates, so it is not judged");
    assert_contains(text, " Not finite, which is a fault: 1 pixels.");
    report.pairs[1].final.nonfinite = 0;
    print_table(text, sizeof text);
    assert_lacks(text, "a fault");
}
END_TEST

START_TEST(test_settings_that_few_set)
{
    static const char *const expected[][2] = {{"Depth", "d32f, less, reversed"},
                                              {"Shading", "Phong, one directional light"},
                                              {"Bias", "0.125"},
                                              {"Draw order", "shuffled, seed 7"},
                                              {"Painter sorts", "triangles"},
                                              {"Weight", "equation 10"},
                                              {"Nodes per pixel", "4"},
                                              {"Post-process", "edges, of linked-list"}};
    SummarySetting settings[SUMMARY_SETTINGS];
    int plain = summary_settings(&report, settings);
    report.desc.depth_range = DEPTH_RANGE_REVERSED;
    report.desc.shading = SHADING_PHONG;
    report.desc.bias = 0.125f;
    report.desc.draw_order = DRAW_ORDER_SHUFFLE;
    report.desc.draw_seed = 7;
    report.desc.sort = SORT_TRIANGLES;
    report.desc.weight = WEIGHT_10;
    report.desc.nodes_per_pixel = 4;
    report.desc.post = POST_EDGES;
    int count = summary_settings(&report, settings), found = 0;
    ck_assert_int_eq(count, plain + 6);
    ck_assert_int_le(count, SUMMARY_SETTINGS);
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++)
        for (int k = 0; k < count; k++)
            if (strcmp(settings[k].name, expected[i][0]) == 0) {
                ck_assert_str_eq(settings[k].value, expected[i][1]);
                found++;
            }
    ck_assert_int_eq(found, 8);
}
END_TEST

static json_t *load(const char *path)
{
    json_error_t error;
    json_t *root = json_load_file(path, 0, &error);
    ck_assert_msg(root != NULL, "%s:%d: %s", path, error.line, error.text);
    return root;
}

/* The document's value at a path such as "pairs/0/final/psnr", as compact text. */
static void assert_json(const json_t *root, const char *place, const char *expected)
{
    char keys[128], *rest = NULL;
    snprintf(keys, sizeof keys, "%s", place);
    const json_t *value = root;
    for (char *key = strtok_r(keys, "/", &rest); key; key = strtok_r(NULL, "/", &rest)) {
        value = json_is_array(value) ? json_array_get(value, (size_t)atoi(key))
                                     : json_object_get(value, key);
        ck_assert_msg(value != NULL, "no %s in %s", key, place);
    }
    char *text = json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(9));
    ck_assert_ptr_nonnull(text);
    ck_assert_msg(strcmp(text, expected) == 0, "%s: got %s, expected %s", place, text, expected);
    free(text);
}

static void assert_json_values(const json_t *root, const char *const (*cases)[2], size_t count)
{
    for (size_t i = 0; i < count; i++)
        assert_json(root, cases[i][0], cases[i][1]);
}

START_TEST(test_json)
{
    static const char *const cases[][2] = {
        {"scene", "\"data/scenes/<gradients>'s.gltf\""},
        {"size", "[320,180]"},
        {"method", "\"peel\""},
        {"exact", "true"},
        {"passes", "16"},
        {"profile", "\"default\""},
        {"fma", "true"},
        {"agree", "false"},
        {"renderers/ref/time_ms", "100.0"},
        {"renderers/ref/cpu_ms", "190.0"},
        {"renderers/ref/threads", "2"},
        {"renderers/gl/time_ms", "200.0"},
        {"renderers/gl/version", "\"1.0 <&> \\\"quoted\\\"\""},
        {"renderers/gl/renderer", "\"\""},
        {"renderers/truth/cpu_ms", "570.0"},
        {"pairs/0/a", "\"ref\""},
        {"pairs/0/b", "\"gl\""},
        {"pairs/0/buffers/0/first", "null"},
        {"pairs/0/buffers/24",
         "{\"name\":\"peel.3.normal\",\"values\":230400,\"differing\":17,\"max_ulp\":3,"
         "\"max_abs\":2.4e-7,\"first\":[12,34,2]}"},
        {"pairs/0/final/psnr", "null"},
        {"pairs/1/b", "\"truth\""},
        {"pairs/1/final",
         "{\"pixels\":57600,\"differing\":51200,\"max_abs\":0.97,\"mean_abs\":0.01,"
         "\"rmse\":null,\"psnr\":31.4,\"max_ulp\":4294967295,\"nonfinite\":1}"},
        {"pairs/2/a", "\"gl\""},
        {"pairs/2/unaffected",
         "{\"pixels\":57000,\"occupied\":41000,\"max_abs\":1.25e-6,\"max_rel\":1.25e-6,"
         "\"p99_rel\":3.5e-7,\"p999_rel\":7.5e-7}"},
        {"layers", "{\"max\":16,\"fragments\":345678,\"lost_to_ties\":9,"
                   "\"lost_to_pass_limit\":0,\"lost_to_overflow\":0,\"order_inversions\":3,"
                   "\"coverage_differs\":77,\"opaque_flips\":0,\"repeated\":0,\"overflowed\":0,"
                   "\"set_differs\":0,\"exact_comparisons\":21,\"ties\":7,\"undecided\":0}"},
        {"residual", "{\"max\":0.0,\"pixels\":0}"},
    };
    const char *path = scratch_path("report.json");
    make_differ();
    ck_assert_int_eq(report_json_write(&report, path), RESULT_OK);
    json_t *root = load(path);
    assert_json_values(root, cases, sizeof cases / sizeof cases[0]);
    ck_assert_uint_eq(json_array_size(json_object_get(root, "pairs")), 3);
    const json_t *pair = json_array_get(json_object_get(root, "pairs"), 0);
    ck_assert_uint_eq(json_array_size(json_object_get(pair, "buffers")), BUFFERS);
    ck_assert_ptr_null(json_object_get(pair, "unaffected"));
    json_decref(root);
}
END_TEST

START_TEST(test_json_of_methods)
{
    static const char *const cases[][2] = {
        {"agree", "false"},
        {"methods/0/method", "\"peel\""},
        {"methods/0/exact", "true"},
        {"methods/1/method", "\"linked-list\""},
        {"methods/1/exact", "true"},
        {"methods/1/renderers/ref/nodes", "123456"},
        {"methods/1/renderers/ref/node_bytes", "20"},
        {"methods/1/renderers/gl/nodes", "123456"},
        {"methods/1/layers/lost_to_overflow", "77"},
        {"methods/2/method", "\"weighted-sum\""},
        {"methods/2/exact", "false"},
        {"methods/2/layers/overflowed", "88"},
    };
    const char *path = scratch_path("all.json");
    Threeway reports[] = {report, report, report};
    reports[1].desc.method = METHOD_LINKED_LIST;
    for (int i = RENDERER_REF; i <= RENDERER_GL; i++) {
        reports[1].frames[i].nodes = 123456;
        reports[1].frames[i].node_bytes = 20;
    }
    reports[1].structure.layers.lost_to_overflow = 77;
    reports[1].agree = false;
    reports[2].desc.method = METHOD_WEIGHTED_SUM;
    reports[2].structure.layers.overflowed = 88;
    ck_assert_int_eq(report_json_write_all(reports, 3, path), RESULT_OK);
    json_t *root = load(path);
    assert_json_values(root, cases, sizeof cases / sizeof cases[0]);
    const json_t *peel = json_array_get(json_object_get(root, "methods"), 0);
    const json_t *ref = json_object_get(json_object_get(peel, "renderers"), "ref");
    ck_assert_ptr_nonnull(ref);
    ck_assert_ptr_null(json_object_get(ref, "nodes"));
    json_decref(root);
}
END_TEST

START_TEST(test_json_of_an_odd_path)
{
    const char *path = scratch_path("report.json");
    report.scene_path = "a\xff\"b.gltf";
    ck_assert_int_eq(report_json_write(&report, path), RESULT_OK);
    json_t *root = load(path);
    assert_json(root, "scene", "\"a?\\\"b.gltf\"");
    json_decref(root);
    ck_assert_int_eq(report_json_write(&report, scratch_path("none/report.json")), RESULT_IO);
    scratch_limit(5000);
    Result full = report_json_write(&report, scratch_path("other.json"));
    scratch_limit(RLIM_INFINITY);
    ck_assert_int_eq(full, RESULT_IO);
    ck_assert_int_eq(scratch_entries(), 1);
}
END_TEST

/* While counting, the allocation at fail_at gives nothing. */
static size_t allocations, fail_at;
static bool counting;

void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);

void *__wrap_malloc(size_t size)
{
    if (!counting || ++allocations != fail_at)
        return __real_malloc(size);
    errno = ENOMEM;
    return NULL;
}

/* Whichever allocation fails, there is the whole document or none. */
START_TEST(test_json_without_memory)
{
    static char expected[65536], text[65536];
    const char *path = scratch_path("report.json");
    report.scene_path = "\xff";
    report.pairs[0].buffer_count = 25;
    make_differ(); /* the last of them */
    ck_assert_int_eq(report_json_write(&report, path), RESULT_OK);
    scratch_read(path, expected, sizeof expected);
    size_t refused = 0;
    bool reached = true;
    for (fail_at = 1; reached; fail_at++) {
        ck_assert_int_eq(unlink(path), 0);
        allocations = 0;
        counting = true;
        Result result = report_json_write(&report, path);
        counting = false;
        reached = allocations >= fail_at;
        if (result == RESULT_OK) { /* a string is tried twice */
            scratch_read(path, text, sizeof text);
            ck_assert_msg(strcmp(text, expected) == 0, "allocation %zu: another document", fail_at);
            continue;
        }
        ck_assert_msg(reached && result == RESULT_NO_MEMORY, "allocation %zu of %zu: %s", fail_at,
                      allocations, result_text(result));
        ck_assert_int_eq(scratch_entries(), 0);
        ck_assert_int_eq(file_write(path, "", 0), RESULT_OK);
        refused++;
    }
    ck_assert_uint_gt(refused, 500);
}
END_TEST

START_TEST(test_html)
{
    static char text[1 << 20];
    const char *dir = scratch_path("deep/out");
    make_differ();
    const char *command = "peel compare 'a & b.gltf' --size 320x180 > \"log\"";
    ck_assert_msg(report_html_write(&report, command, dir) == RESULT_OK, "%s", result_message());
    scratch_read(scratch_path("deep/out/style.css"), text, sizeof text);
    assert_contains(text, "prefers-color-scheme");
    scratch_read(scratch_path("deep/out/index.html"), text, sizeof text);
    assert_contains(text, "<h1>gradients &lt;1&gt; &amp; &quot;2&quot;</h1>");
    assert_contains(text, "data/scenes/&lt;gradients&gt;&#39;s.gltf");
    assert_contains(text, "peel compare &#39;a &amp; b.gltf&#39; --size 320x180 &gt; "
                          "&quot;log&quot;</code>");
    assert_contains(text, "1.0 &lt;&amp;&gt; &quot;quoted&quot;");
    assert_contains(text, "The renderers differ");
    assert_contains(text, "peel.3.normal");
    assert_contains(text, "Peel 12 ");
    assert_contains(text, "<p>gl's time includes compiling its shaders");
    assert_lacks(text, "<script");
    assert_lacks(text, "http");
    assert_lacks(text, "<1>");
}
END_TEST

START_TEST(test_html_is_whole)
{
    ck_assert_int_eq(report_html_write(&report, "peel", scratch_directory), RESULT_OK);
    ck_assert_int_eq(check_page("."), 3 + 3 + 1 + 2 * PEELS);
}
END_TEST

/* A shorter report in the same folder takes the longer one's peels away, and nothing else. */
START_TEST(test_stale_pictures)
{
    static const char *const foreign[] = {"peel-5-added.png",       "peel-007-added.png.txt",
                                          "peel-0008-added.png",    "my-peel-009-added.png",
                                          "peel-010-something.png", "peel--01-added.png"};
    const int foreign_count = sizeof foreign / sizeof foreign[0];
    ck_assert_int_eq(report_html_write(&report, "peel", scratch_directory), RESULT_OK);
    int before = scratch_entries();
    for (int i = 0; i < foreign_count; i++)
        ck_assert_int_eq(file_write(scratch_path(foreign[i]), "x", 1), RESULT_OK);
    ck_assert_int_eq(file_make_directories(scratch_path("peel-099-added.png")), RESULT_OK);
    report.peel_count = 4;
    ck_assert_int_eq(report_html_write(&report, "peel", scratch_directory), RESULT_OK);
    ck_assert_int_eq(scratch_entries(), before + foreign_count + 1 - 2 * (PEELS - 4));
    assert_file_exists("peel-003-added.png");
    assert_file_exists("peel-099-added.png");
    ck_assert_int_ne(access(scratch_path("peel-004-added.png"), F_OK), 0);
    ck_assert_int_ne(access(scratch_path("peel-015-accumulated.png"), F_OK), 0);
}
END_TEST

START_TEST(test_lights_of_the_scene)
{
    static const struct {
        int limit;
        const char *expected;
    } rows[] = {{0, "all 12 of the scene"},
                {-1, "none"},
                {11, "first 11 of 12"},
                {12, "all 12 of the scene"},
                {99, "all 12 of the scene"}};
    report.light_count = 12;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        SummarySetting settings[SUMMARY_SETTINGS];
        report.desc.lights = rows[i].limit;
        int count = summary_settings(&report, settings), found = 0;
        for (int k = 0; k < count; k++)
            if (strcmp(settings[k].name, "Lights") == 0) {
                ck_assert_str_eq(settings[k].value, rows[i].expected);
                found++;
            }
        ck_assert_int_eq(found, 1);
    }
}
END_TEST

START_TEST(test_html_failures)
{
    const char *path = scratch_path("file");
    ck_assert_int_eq(file_write(path, "x", 1), RESULT_OK);
    ck_assert_int_eq(report_html_write(&report, "peel", path), RESULT_IO);
    ck_assert_ptr_nonnull(strstr(result_message(), path));
    ck_assert_int_eq(report_html_write(&report, "peel", scratch_path("file/below")), RESULT_IO);
    scratch_limit(2000);
    Result full = report_html_write(&report, "peel", scratch_path("full"));
    scratch_limit(RLIM_INFINITY);
    ck_assert_int_eq(full, RESULT_IO);
    ck_assert_int_ne(access(scratch_path("full/index.html"), F_OK), 0);
    ck_assert_int_eq(scratch_entries(), 2);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("report");
    TCase *tests = tcase_create("report");
    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, make_report, free_report);
    tcase_add_test(tests, test_rows_fold);
    tcase_add_test(tests, test_table);
    tcase_add_test(tests, test_lines_of_methods);
    tcase_add_test(tests, test_settings_that_few_set);
    tcase_add_test(tests, test_numbers);
    tcase_add_test(tests, test_json);
    tcase_add_test(tests, test_json_of_methods);
    tcase_add_test(tests, test_json_of_an_odd_path);
    tcase_add_test(tests, test_json_without_memory);
    tcase_add_test(tests, test_html);
    tcase_add_test(tests, test_html_is_whole);
    tcase_add_test(tests, test_stale_pictures);
    tcase_add_test(tests, test_lights_of_the_scene);
    tcase_add_test(tests, test_html_failures);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

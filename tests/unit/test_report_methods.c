/* report: the page about all methods, of comparisons made by hand. */
#include "base/file.h"
#include "frame/method.h"
#include "report/html.h"

#include "page_checks.h"
#include "sample_report.h"

static Threeway reports[METHOD_COUNT];
static char text[1 << 20];

/* Of every method: each slower than the one before, and the approximate ones farther off. */
static void make_reports(void)
{
    make_report();
    report.peel_count = 1;
    for (int i = 0; i < METHOD_COUNT; i++) {
        reports[i] = report;
        reports[i].desc.method = (MethodId)i;
        reports[i].frames[RENDERER_REF].time_ms = 10.0 + 3.0 * i;
        reports[i].frames[RENDERER_GL].time_ms = 900.0 - 20.0 * i;
        for (int pair = 1; pair < 3; pair++)
            reports[i].pairs[pair].final.rmse =
                method_info((MethodId)i)->exact ? 3e-7 : 0.02 + 0.001 * i;
    }
    reports[METHOD_LINKED_LIST].frames[RENDERER_REF].nodes = 123456;
    reports[METHOD_LINKED_LIST].frames[RENDERER_REF].node_bytes = 20;
}

static void write_all(void)
{
    const char *command = "peel compare 'a & b.gltf' --method all";
    for (int i = 0; i < METHOD_COUNT; i++)
        ck_assert_msg(report_html_write_method(&reports[i], command, scratch_directory) ==
                          RESULT_OK,
                      "%s", result_message());
    ck_assert_msg(report_html_write_all(reports, METHOD_COUNT, command, scratch_directory) ==
                      RESULT_OK,
                  "%s", result_message());
    scratch_read(scratch_path("index.html"), text, sizeof text);
}

static void write_page(void)
{
    ck_assert_int_eq(report_html_write_all(reports, METHOD_COUNT, "peel", scratch_directory),
                     RESULT_OK);
    scratch_read(scratch_path("index.html"), text, sizeof text);
}

START_TEST(test_whole)
{
    write_all();
    ck_assert_int_eq(check_page("."), 1 + 1 + 2 * METHOD_COUNT);
    for (int i = 0; i < METHOD_COUNT; i++) {
        const char *name = method_info((MethodId)i)->name;
        ck_assert_int_eq(check_page(name), 3 + 3 + 1 + 2);
    }
    ck_assert_int_eq(scratch_entries(), METHOD_COUNT + 3);
    scratch_read(scratch_path("painter/index.html"), text, sizeof text);
    assert_contains(text, "<a href=\"../index.html\">All methods on this scene</a>");
    assert_contains(text, "Newell, Newell, Sancha");
    assert_contains(text, " ref and gl agree</h2>");
}
END_TEST

START_TEST(test_content)
{
    char expected[256];
    write_all();
    assert_contains(text, "<h1>gradients &lt;1&gt; &amp; &quot;2&quot;</h1>");
    assert_contains(text, "peel compare &#39;a &amp; b.gltf&#39; --method all</code>");
    assert_lacks(text, "<1>");
    assert_contains(text, "All 10 methods agree");
    assert_contains(text, "ref and gl agree bit for bit in 10 of 10 methods; 237,312,000 values");
    assert_contains(text, "4 approximate: ");
    assert_contains(text, "<td>123,456<br>&times; 20</td>");
    assert_contains(text, "The lists need 123,456 nodes x 20 bytes = 2.4 MiB.");
    for (int i = 0; i < METHOD_COUNT; i++) {
        const MethodInfo *method = method_info((MethodId)i);
        snprintf(expected, sizeof expected,
                 "<th scope=\"row\"><a href=\"%s/index.html\">%s</a></th><td>%s</td>", method->name,
                 method->name, method->exact ? "yes" : "no");
        assert_contains(text, expected);
        snprintf(expected, sizeof expected, "<title>%s: %.1f ms, error ", method->name,
                 reports[i].frames[RENDERER_REF].time_ms);
        assert_contains(text, expected);
        snprintf(expected, sizeof expected, "<title>%s: %.1f ms, error ", method->name,
                 reports[i].frames[RENDERER_GL].time_ms);
        assert_contains(text, expected);
    }
    ck_assert(strstr(text, "peel/truth.png") < strstr(text, "peel/ref.png"));
}
END_TEST

static int occurrences(const char *part)
{
    int count = 0;
    for (const char *c = text; (c = strstr(c, part)); c++)
        count++;
    return count;
}

START_TEST(test_worst_of_a_column)
{
    write_page();
    /* Times and errors differ; what is the same everywhere is not marked. */
    assert_contains(text, "<td class=\"first worst\">37.0</td>");
    assert_contains(text, "<td class=\"worst\">900.0</td>");
    assert_contains(text, "<td class=\"worst\">0.029</td>");
    ck_assert_int_eq(occurrences("worst\">"), 3);
    reports[METHOD_DUAL].pairs[1].final.rmse = NAN; /* worse than any number */
    reports[METHOD_DUAL].pairs[1].final.psnr = 12.0;
    reports[METHOD_PEEL_ID].structure.layers.lost_to_ties = 10;
    reports[METHOD_FORWARD].structure.layers.lost_to_ties = 10;
    write_page();
    assert_contains(text, "<td class=\"worst\">nan</td>");
    assert_contains(text, "<td class=\"worst\">12.0</td>");
    ck_assert_int_eq(occurrences("<td class=\"worst\">10</td>"), 2);
    ck_assert_int_eq(occurrences("worst\">"), 6);
}
END_TEST

START_TEST(test_verdict)
{
    make_differ();
    reports[METHOD_DUAL].agree = false;
    reports[METHOD_LINKED_LIST].agree = false;
    reports[METHOD_LINKED_LIST].pairs[0].buffer_count = 5;
    reports[METHOD_LINKED_LIST].pairs[1].unaffected.p99_rel = 0.5;
    reports[METHOD_LINKED_LIST].structure.layers.lost_to_overflow = 9;
    write_page();
    assert_contains(text, "2 of 10 methods differ<");
    assert_contains(text, "<li>dual: ref and gl differ in 17 of ");
    assert_contains(text, "<li>linked-list: ref and truth differ: 99th percentile ");
    assert_contains(text,
                    "<li>linked-list: The lists need 123,456 nodes x 20 bytes = 2.4 MiB; there "
                    "was no room for 9 of them.</li>");
    ck_assert_int_eq(occurrences("<tr class=\"off\">"), 2);
    ck_assert_int_eq(occurrences(">differs</td>"), 2);
}
END_TEST

/* ---- the plots ---- */

typedef struct Label {
    double x0, x1, y;
} Label;

/* The labels of the points in one drawing, letters taken as 7 wide; *drawing goes on behind it. */
static int read_labels(const char **drawing, Label labels[METHOD_COUNT])
{
    int count = 0;
    const char *begin = strstr(*drawing, "<svg viewBox");
    ck_assert_ptr_nonnull(begin);
    const char *end = strstr(begin, "</svg>");
    for (const char *g = begin; (g = strstr(g, "<g>")) && g < end; g++) {
        char anchor[8], name[32];
        double x, y;
        const char *label = strstr(g, "<text");
        ck_assert_int_eq(sscanf(label,
                                "<text text-anchor=\"%7[a-z]\" x=\"%lf\" y=\"%lf\">%31[a-z-]<",
                                anchor, &x, &y, name),
                         4);
        double width = 7.0 * (double)strlen(name);
        double left = strcmp(anchor, "start") == 0 ? x
                      : strcmp(anchor, "end") == 0 ? x - width
                                                   : x - width / 2;
        ck_assert_int_lt(count, METHOD_COUNT);
        labels[count++] = (Label){left, left + width, y};
    }
    *drawing = end;
    return count;
}

static void check_labels(void)
{
    Label labels[METHOD_COUNT];
    const char *drawing = text;
    for (int plot = 0; plot < 2; plot++) {
        int count = read_labels(&drawing, labels);
        ck_assert_int_eq(count, METHOD_COUNT);
        for (int i = 0; i < count; i++) {
            ck_assert_msg(labels[i].x0 > 60 && labels[i].x1 < 640, "plot %d, label %d: %g to %g",
                          plot, i, labels[i].x0, labels[i].x1);
            for (int k = 0; k < i; k++)
                ck_assert_msg(labels[i].x1 <= labels[k].x0 || labels[k].x1 <= labels[i].x0 ||
                                  fabs(labels[i].y - labels[k].y) >= 15,
                              "plot %d: labels %d and %d overlap", plot, k, i);
        }
    }
}

START_TEST(test_labels_do_not_overlap)
{
    write_page();
    check_labels();
    for (int i = 0; i < METHOD_COUNT; i++) { /* all at one point */
        reports[i].frames[RENDERER_REF].time_ms = reports[i].frames[RENDERER_GL].time_ms = 50.0;
        for (int pair = 1; pair < 3; pair++)
            reports[i].pairs[pair].final.rmse = 1e-3;
    }
    write_page();
    check_labels();
    for (int i = 0; i < METHOD_COUNT; i++) /* two points, one in a corner */
        reports[i].frames[RENDERER_REF].time_ms = i < 8 ? 1e-3 : 1e5;
    write_page();
    check_labels();
}
END_TEST

START_TEST(test_errors_that_have_no_logarithm)
{
    write_page();
    assert_lacks(text, ">0</text>");
    assert_lacks(text, "left out");
    reports[METHOD_PEEL].pairs[1].final.rmse = 0.0;
    write_page();
    ck_assert_int_eq(occurrences(">0</text>"), 2);
    check_labels();
    reports[METHOD_DUAL].pairs[1].final.rmse = NAN;
    reports[METHOD_PAINTER].frames[RENDERER_REF].time_ms = 0.0;
    write_page();
    ck_assert_int_eq(occurrences("; 2 without a finite error or a time left out"), 1);
    ck_assert_int_eq(occurrences("left out"), 1);
    for (int i = 0; i < METHOD_COUNT; i++)
        reports[i].pairs[1].final.rmse = reports[i].pairs[2].final.rmse = NAN;
    write_page();
    ck_assert_int_eq(occurrences("; 10 without a finite error or a time left out"), 2);
    assert_lacks(text, "inf");
}
END_TEST

/* ---- files ---- */

START_TEST(test_preview_of_large_images)
{
    for (int i = 0; i < METHOD_COUNT; i++)
        reports[i].desc.width = 1280;
    write_page();
    assert_contains(text, "2 &times; 2 pixels");
    assert_contains(text, "<a href=\"dual/difference-ref-truth.png\">"
                          "<img src=\"dual/difference-ref-truth-small.png\"");
}
END_TEST

START_TEST(test_failures)
{
    const char *path = scratch_path("file");
    ck_assert_int_eq(file_write(path, "x", 1), RESULT_OK);
    ck_assert_int_eq(report_html_write_all(reports, METHOD_COUNT, "peel", path), RESULT_IO);
    ck_assert_ptr_nonnull(strstr(result_message(), path));
    ck_assert_int_eq(report_html_write_method(&reports[0], "peel", path), RESULT_IO);
    scratch_limit(20000); /* the page is longer, the style is not */
    Result full = report_html_write_all(reports, METHOD_COUNT, "peel", scratch_path("full"));
    scratch_limit(RLIM_INFINITY);
    ck_assert_int_eq(full, RESULT_IO);
    ck_assert_int_ne(access(scratch_path("full/index.html"), F_OK), 0);
    ck_assert_int_eq(scratch_entries(), 2);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("report_methods");
    TCase *tests = tcase_create("report_methods");
    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, make_reports, free_report);
    tcase_add_test(tests, test_whole);
    tcase_add_test(tests, test_content);
    tcase_add_test(tests, test_worst_of_a_column);
    tcase_add_test(tests, test_verdict);
    tcase_add_test(tests, test_labels_do_not_overlap);
    tcase_add_test(tests, test_errors_that_have_no_logarithm);
    tcase_add_test(tests, test_preview_of_large_images);
    tcase_add_test(tests, test_failures);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

/* report: the text table, the JSON document and the page of a comparison made by hand. */
#include "base/file.h"
#include "report/html.h"
#include "report/summary.h"
#include "report/table.h"

#include "scratch.h"
#include "testing.h"

#include <math.h>

enum {
    WIDTH = 320,
    HEIGHT = 180,
    PEELS = 12,
    PER_PEEL = 6,
    BUFFERS = 5 + PEELS * PER_PEEL + 2
};

static Threeway report;
static BufferMetrics buffers[BUFFERS];
static PeelPicture peels[PEELS];

static void fill(Image *image, int peel, bool layer)
{
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++) {
            float *pixel = image_pixel(image, x, y);
            float u = (float)x / (float)image->width, v = (float)y / (float)image->height;
            float du = u - 0.2f - 0.05f * (float)peel, dv = v - 0.5f;
            bool inside = du * du + dv * dv < 0.03f;
            pixel[0] = layer && !inside ? 0.0f : 0.8f * u;
            pixel[1] = layer && !inside ? 0.0f : 0.5f * v;
            pixel[2] = layer && !inside ? 0.0f : 0.1f * (float)(peel + 1);
            pixel[3] = layer ? (inside ? 1.0f : 0.0f) : 0.5f;
        }
}

static Image make_image(int width, int height, PixelFormat format)
{
    Image image;
    ck_assert_int_eq(image_create(width, height, format, &image), RESULT_OK);
    return image;
}

static void make_frames(void)
{
    for (int i = 0; i < RENDERER_COUNT; i++) {
        Frame *frame = &report.frames[i];
        frame->final = make_image(WIDTH, HEIGHT, FORMAT_RGBA32F);
        frame->display = make_image(WIDTH, HEIGHT, FORMAT_RGBA8);
        fill(&frame->final, 3, false);
        for (int p = 0; p < WIDTH * HEIGHT * 4; p++)
            ((uint8_t *)frame->display.pixels)[p] =
                (uint8_t)(255 * ((float *)frame->final.pixels)[p]);
        *frame = (Frame){.final = frame->final,
                         .display = frame->display,
                         .peels = PEELS,
                         .time_ms = 100.0 * (i + 1),
                         .cpu_ms = 190.0 * (i + 1),
                         .threads = 2,
                         .fused = true,
                         .buffer_bytes = 12345678};
        strcpy(frame->version, "1.0 <&> \"quoted\"");
    }
    /* Eight decades of difference from left to right, one NaN. */
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            *(float *)image_pixel(&report.frames[RENDERER_TRUTH].final, x, y) +=
                y < 20 ? 0.0f : powf(10.0f, -8.0f + 8.0f * (float)x / WIDTH);
    *(float *)image_pixel(&report.frames[RENDERER_TRUTH].final, 100, 100) = NAN;
}

static void name_buffers(void)
{
    static const char *const parts[PER_PEEL] = {"depth",   "normal",   "position",
                                                "diffuse", "material", "accum"};
    for (int i = 0; i < BUFFERS; i++) {
        BufferMetrics *buffer = &buffers[i];
        *buffer = (BufferMetrics){.values = WIDTH * HEIGHT * 4};
        int peel = (i - 5) / PER_PEEL;
        if (i < 5)
            snprintf(buffer->name, sizeof buffer->name, "opaque.%s", parts[i]);
        else if (i < BUFFERS - 2)
            snprintf(buffer->name, sizeof buffer->name, "peel.%d.%s", peel, parts[(i - 5) % 6]);
        else
            strcpy(buffer->name, i == BUFFERS - 2 ? "accum" : "display");
    }
}

static void make_pairs(void)
{
    static const int sides[3][2] = {
        {RENDERER_REF, RENDERER_GL}, {RENDERER_REF, RENDERER_TRUTH}, {RENDERER_GL, RENDERER_TRUTH}};
    for (int i = 0; i < 3; i++) {
        PairReport *pair = &report.pairs[i];
        *pair = (PairReport){.a = sides[i][0], .b = sides[i][1], .has_unaffected = i > 0};
        pair->final = (FinalMetrics){.pixels = WIDTH * HEIGHT, .psnr = INFINITY};
        if (i == 0)
            continue;
        pair->final = (FinalMetrics){.pixels = WIDTH * HEIGHT,
                                     .differing = 51200,
                                     .nonfinite = 1,
                                     .max_abs = 0.97,
                                     .mean_abs = 0.01,
                                     .rmse = NAN,
                                     .psnr = 31.4,
                                     .max_ulp = UINT32_MAX};
        pair->unaffected = (UnaffectedMetrics){57000, 1.25e-6, 1.25e-6, 3.5e-7};
    }
    report.pairs[0].buffers = buffers;
    report.pairs[0].buffer_count = BUFFERS;
}

static void make_report(void)
{
    scratch_make();
    report = (Threeway){.scene_name = "gradients <1> & \"2\"",
                        .scene_path = "data/scenes/<gradients>'s.gltf",
                        .desc = {.width = WIDTH, .height = HEIGHT, .lights = 16},
                        .tolerance = 1e-4,
                        .peels = peels,
                        .peel_count = PEELS,
                        .agree = true};
    make_frames();
    name_buffers();
    make_pairs();
    report.structure.layers = (LayerStats){12, 345678, 9, 0, 0, 77};
    report.structure.order_inversions = 3;
    for (int i = 0; i < PEELS; i++) {
        peels[i] = (PeelPicture){.peel = i, .pixels = 5000 - 100 * (uint64_t)i};
        peels[i].accum = make_image(160, 90, FORMAT_RGBA32F);
        peels[i].added = make_image(160, 90, FORMAT_RGBA32F);
        fill(&peels[i].accum, i, false);
        fill(&peels[i].added, i, true);
    }
}

static void free_report(void)
{
    for (int i = 0; i < RENDERER_COUNT; i++)
        frame_free(&report.frames[i]);
    for (int i = 0; i < PEELS; i++) {
        image_free(&peels[i].accum);
        image_free(&peels[i].added);
    }
    scratch_remove();
}

/* peel.3.normal differs. */
static void make_differ(void)
{
    BufferMetrics *buffer = &buffers[5 + 3 * PER_PEEL + 1];
    *buffer = (BufferMetrics){"peel.3.normal", 230400, 17, 3, 2.4e-7, true, {12, 34, 2}};
    report.agree = false;
}

static void assert_contains(const char *text, const char *part)
{
    ck_assert_msg(strstr(text, part) != NULL, "no \"%s\" in:\n%s", part, text);
}

static void assert_lacks(const char *text, const char *part)
{
    ck_assert_msg(strstr(text, part) == NULL, "unexpected \"%s\" in:\n%s", part, text);
}

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
    while (summary_row(&report.pairs[0], &cursor, &row)) {
        buffers_seen += row.buffers;
        ck_assert_msg((rows == 1) == (row.differing != 0), "row %zu is %s", rows, row.label);
        rows++;
    }
    ck_assert_uint_eq(rows, 3);
    ck_assert_uint_eq(buffers_seen, BUFFERS);
    cursor = 0;
    summary_row(&report.pairs[0], &cursor, &row);
    ck_assert_str_eq(row.label, "opaque.depth to peel.3.depth");
    ck_assert_uint_eq(row.values, (uint64_t)(5 + 3 * PER_PEEL + 1) * WIDTH * HEIGHT * 4);
    /* Few buffers have a row each. */
    report.pairs[0].buffer_count = SUMMARY_UNFOLDED;
    cursor = rows = 0;
    while (summary_row(&report.pairs[0], &cursor, &row))
        rows++;
    ck_assert_uint_eq(rows, SUMMARY_UNFOLDED);
}
END_TEST

START_TEST(test_table)
{
    static char text[65536];
    print_table(text, sizeof text);
    assert_contains(text, "opaque.depth to display");
    assert_contains(text, "79 equal buffers are folded");
    assert_contains(text, "\nAGREE\n");
    assert_contains(text, "ref and gl agree bit for bit: 18,201,600 values in 79 buffers.");
    assert_contains(text, "99th percentile of the relative difference 3.5e-07");
    assert_contains(text, "gl took 2.00 times the wall time of ref.");
    assert_contains(text, "equal");
    make_differ();
    report.frames[RENDERER_REF].residual_pixels = 1234;
    report.frames[RENDERER_REF].residual_max = 0.25;
    print_table(text, sizeof text);
    assert_contains(text, "\nDIFFER\n");
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

/* Asks jq-like questions of the file with Python's own parser. */
static void assert_json(const char *path, const char *expression)
{
    char command[1024], text[1024];
    snprintf(command, sizeof command,
             "python3 -c \"import json; d = json.load(open('%s'), parse_constant=exit); "
             "p = d['pairs']; assert %s\" 2>&1",
             path, expression);
    ck_assert_msg(scratch_run(command, text, sizeof text) == 0, "%s: %s", expression, text);
}

START_TEST(test_json)
{
    const char *path = scratch_path("report.json");
    make_differ();
    ck_assert_int_eq(report_json_write(&report, path), RESULT_OK);
    assert_json(path, "{'scene', 'size', 'method', 'passes', 'profile', 'fma', 'renderers', "
                      "'pairs', 'layers'} <= d.keys()");
    assert_json(path, "d['size'] == [320, 180] and d['method'] == 'peel' and d['passes'] == 12");
    assert_json(path, "d['profile'] == 'default' and d['fma'] is True and not d['agree']");
    assert_json(path, "{'time_ms', 'cpu_ms', 'threads'} <= d['renderers']['ref'].keys()");
    assert_json(path,
                "{'time_ms', 'cpu_ms', 'version', 'renderer'} <= d['renderers']['gl'].keys()");
    assert_json(path, "[(x['a'], x['b']) for x in p] == "
                      "[('ref', 'gl'), ('ref', 'truth'), ('gl', 'truth')]");
    assert_json(path, "[len(x.get('buffers', [])) for x in p] == [79, 0, 0]");
    assert_json(path, "p[0]['buffers'][24] == {'name': 'peel.3.normal', 'values': 230400, "
                      "'differing': 17, 'max_ulp': 3, 'max_abs': 2.4e-7, 'first': [12, 34, 2]}");
    assert_json(path, "p[0]['buffers'][0]['first'] is None and p[0]['final']['psnr'] is None");
    assert_json(path, "p[1]['final'].keys() == {'pixels', 'differing', 'max_abs', 'mean_abs', "
                      "'rmse', 'psnr', 'max_ulp', 'nonfinite'} and p[1]['final']['rmse'] is None");
    assert_json(path, "p[2]['unaffected'] == {'pixels': 57000, 'max_abs': 1.25e-6, "
                      "'max_rel': 1.25e-6, 'p99_rel': 3.5e-7} and 'unaffected' not in p[0]");
    assert_json(path, "{'max', 'fragments', 'lost_to_ties', 'lost_to_pass_limit', "
                      "'order_inversions', 'coverage_differs', 'opaque_flips', 'repeated'} <= "
                      "d['layers'].keys() and d['layers']['coverage_differs'] == 77");
}
END_TEST

START_TEST(test_json_of_an_odd_path)
{
    const char *path = scratch_path("report.json");
    report.scene_path = "a\xff\"b.gltf";
    ck_assert_int_eq(report_json_write(&report, path), RESULT_OK);
    assert_json(path, "d['scene'] == 'a?' + chr(34) + 'b.gltf'");
    ck_assert_int_eq(report_json_write(&report, scratch_path("none/report.json")), RESULT_IO);
    ck_assert_int_eq(report_json_write(&report, "/dev/full"), RESULT_IO);
    ck_assert_int_eq(scratch_entries(), 1);
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
    assert_lacks(text, "<script");
    assert_lacks(text, "http");
    assert_lacks(text, "<1>");
}
END_TEST

/* Every file that the page names exists, every picture has a text, every element is closed. */
START_TEST(test_html_is_whole)
{
    char command[1024], text[4096];
    ck_assert_int_eq(report_html_write(&report, "peel", scratch_directory), RESULT_OK);
    snprintf(command, sizeof command,
             "cd %s && python3 - 2>&1 <<'END'\n"
             "import html.parser, os\n"
             "class Page(html.parser.HTMLParser):\n"
             "    open, count = [], 0\n"
             "    def handle_starttag(self, tag, attributes):\n"
             "        a = dict(attributes)\n"
             "        for key in 'src', 'href':\n"
             "            if key in a: assert os.path.exists(a[key]), a\n"
             "        assert tag != 'img' or a['alt'], a\n"
             "        self.count += tag == 'img'\n"
             "        if tag not in ('meta', 'link', 'img', 'br'): self.open.append(tag)\n"
             "    def handle_endtag(self, tag):\n"
             "        assert self.open.pop() == tag, tag\n"
             "page = Page()\n"
             "page.feed(open('index.html').read())\n"
             "assert page.open == [] and page.count == %d, page.count\n"
             "END",
             scratch_directory, 3 + 3 + 1 + 2 * PEELS);
    ck_assert_msg(scratch_run(command, text, sizeof text) == 0, "%s", text);
}
END_TEST

START_TEST(test_html_failures)
{
    const char *path = scratch_path("file");
    ck_assert_int_eq(file_write(path, "x", 1), RESULT_OK);
    ck_assert_int_eq(report_html_write(&report, "peel", path), RESULT_IO);
    ck_assert_ptr_nonnull(strstr(result_message(), path));
    ck_assert_int_eq(report_html_write(&report, "peel", scratch_path("file/below")), RESULT_IO);
    ck_assert_int_eq(scratch_entries(), 1);
}
END_TEST

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--keep") == 0) { /* a page to look at */
        make_report();
        Result result = report_html_write(&report, "build/peel compare gradients.gltf", argv[2]);
        report_table_print(&report, stdout);
        free_report();
        return result != RESULT_OK;
    }
    Suite *suite = suite_create("report");
    TCase *tests = tcase_create("report");
    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, make_report, free_report);
    tcase_add_test(tests, test_rows_fold);
    tcase_add_test(tests, test_table);
    tcase_add_test(tests, test_numbers);
    tcase_add_test(tests, test_json);
    tcase_add_test(tests, test_json_of_an_odd_path);
    tcase_add_test(tests, test_html);
    tcase_add_test(tests, test_html_is_whole);
    tcase_add_test(tests, test_html_failures);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

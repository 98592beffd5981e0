/* report/explain: a page that would be too large, and a frame that no page can keep. */
#include "report/explain.h"

#include "ref/pipeline/pipeline.h"
#include "scene/generate.h"
#include "scratch.h"
#include "testing.h"

#include <sys/stat.h>

static Scene scene;
static Frame frame;
static TraceStore *store;

static ExplainDesc small_page(void)
{
    RenderDesc desc = {.width = 16, .height = 9};
    ck_assert_int_eq(generate_find("chain")->generate(&scene), RESULT_OK);
    ck_assert_int_eq(store_create(0, &store), RESULT_OK);
    ExplainSink sink = report_explain_sink(store_sink(store), "chain");
    ck_assert_int_eq(pipeline_render(&scene, &desc, &sink.sink, &frame), RESULT_OK);
    ck_assert(!sink.full && sink.bytes > 0);
    return (ExplainDesc){.name = "chain",
                         .command = "peel explain chain",
                         .scene = &scene,
                         .desc = desc,
                         .ref = {.frame = &frame, .trace = store},
                         .gl = {.missing = "no GL here"},
                         .truth = {.missing = "no truth here"}};
}

static void free_page(void)
{
    frame_free(&frame);
    store_destroy(store);
    scene_free(&scene);
}

START_TEST(test_page_size)
{
    ExplainDesc explain = small_page();
    size_t bytes = 0, again = 0;
    ck_assert_int_eq(report_explain_write(&explain, scratch_directory, "page.html", &bytes),
                     RESULT_OK);
    struct stat file;
    ck_assert_int_eq(stat(scratch_path("page.html"), &file), 0);
    ck_assert_uint_le((size_t)file.st_size, bytes);
    ck_assert_uint_le(bytes, (size_t)file.st_size + 8192);
    explain.max_bytes = bytes;
    ck_assert_int_eq(report_explain_write(&explain, scratch_directory, "page.html", &again),
                     RESULT_OK);
    ck_assert_uint_eq(again, bytes);
    explain.max_bytes = bytes - 1;
    ck_assert_int_eq(report_explain_write(&explain, scratch_directory, "other.html", NULL),
                     RESULT_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(result_message(), "chain: the page would take"));
    ck_assert_ptr_nonnull(strstr(result_message(), "the scene"));
    ck_assert_ptr_null(strchr(result_message(), '\n'));
    ck_assert_int_eq(scratch_entries(), 1);
    free_page();
}
END_TEST

static Result take(TraceSink *sink, const TraceBuffer *buffer)
{
    (void)sink, (void)buffer;
    return RESULT_OK;
}

START_TEST(test_frame_size)
{
    TraceSink next = {.put = take};
    ExplainSink sink = report_explain_sink(&next, "chain");
    TraceBuffer buffer = {
        .name = "peel.3.accum", .format = FORMAT_RGBA32F, .width = 5000, .height = 5000};
    ck_assert(sink.sink.details);
    for (int i = 0; i < 2; i++) /* 400 MB each */
        ck_assert_int_eq(sink.sink.put(&sink.sink, &buffer), RESULT_OK);
    buffer.height = 2500; /* 1 GB: the most that it may be */
    ck_assert_int_eq(sink.sink.put(&sink.sink, &buffer), RESULT_OK);
    ck_assert(!sink.full);
    buffer.width = buffer.height = 1;
    ck_assert_int_eq(sink.sink.put(&sink.sink, &buffer), RESULT_UNSUPPORTED);
    ck_assert(sink.full);
    ck_assert_ptr_nonnull(strstr(result_message(), "peel.3.accum"));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("explain");
    TCase *tests = tcase_create("size");
    tcase_add_checked_fixture(tests, scratch_make, scratch_remove);
    tcase_add_test(tests, test_page_size);
    tcase_add_test(tests, test_frame_size);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

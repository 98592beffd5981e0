/* Traces in files: what dump/peel_dump.h writes comes back bit for bit, as does a trace in EXR, and
 * broken dumps are refused. */
#include "compare/trace_file.h"

#include "base/file.h"
#include "base/random.h"
#include "compare/store.h"
#include "dump/peel_dump.h"
#include "image/exr.h"
#include "scratch.h"
#include "testing.h"

#include <limits.h>

enum {
    WIDTH = 70,
    HEIGHT = 66
};

/* As PeelDumpFormat counts them. */
static const PixelFormat formats[] = {FORMAT_RGBA32F, FORMAT_RGBA16F, FORMAT_RGBA16, FORMAT_RGBA8,
                                      FORMAT_RG32F,   FORMAT_RG16,    FORMAT_R32F,   FORMAT_D32F,
                                      FORMAT_D24,     FORMAT_D16};
enum {
    FORMATS = sizeof formats / sizeof formats[0]
};

static Image noise(PixelFormat format, uint64_t seed)
{
    Image image;
    ck_assert_int_eq(image_create(WIDTH, HEIGHT, format, &image), RESULT_OK);
    Random random = random_seed(seed);
    size_t bytes = (size_t)WIDTH * HEIGHT * format_pixel_bytes(format);
    for (size_t i = 0; i < bytes; i++)
        ((uint8_t *)image.pixels)[i] = (uint8_t)random_bits(&random);
    for (size_t i = 0; (format == FORMAT_D24 || format == FORMAT_D16) && i < bytes / 4; i++)
        ((uint32_t *)image.pixels)[i] &= format_info(format)->unorm_max;
    return image;
}

static void flip(const Image *image, Image *out)
{
    ck_assert_int_eq(image_create(image->width, image->height, image->format, out), RESULT_OK);
    size_t row = (size_t)image->width * format_pixel_bytes(image->format);
    for (int y = 0; y < image->height; y++)
        memcpy(image_pixel(out, 0, y), image_pixel(image, 0, image->height - 1 - y), row);
}

static void assert_stored(const TraceStore *store, const char *name, const Image *expected)
{
    Image got;
    int index = store_find(store, name);
    ck_assert_int_ge(index, 0);
    ck_assert_int_eq(store_image(store, index, &got), RESULT_OK);
    ck_assert_int_eq(got.format, expected->format);
    ck_assert_int_eq(got.width, expected->width);
    ck_assert_int_eq(got.height, expected->height);
    ck_assert_mem_eq(got.pixels, expected->pixels,
                     (size_t)got.width * (size_t)got.height * format_pixel_bytes(got.format));
    image_free(&got);
}

static TraceStore *read_trace(const char *path, int count)
{
    TraceStore *store;
    bool is = false;
    ck_assert_int_eq(store_create(0, &store), RESULT_OK);
    ck_assert_int_eq(trace_file_is(path, &is), RESULT_OK);
    ck_assert(is);
    ck_assert_msg(trace_file_read(path, store) == RESULT_OK, "%s", result_message());
    ck_assert_int_eq(store_count(store), count);
    return store;
}

START_TEST(test_dump)
{
    const char *path = scratch_path("a.peel");
    PeelDump dump;
    Image images[FORMATS];
    ck_assert_int_eq(peel_dump_open(&dump, path, NULL), 0);
    for (int i = 0; i < FORMATS; i++) {
        char name[32];
        Image flipped;
        images[i] = noise(formats[i], (uint64_t)i);
        flip(&images[i], &flipped);
        snprintf(name, sizeof name, "peel.%d.depth", i);
        ck_assert_int_eq(peel_dump_pixels(&dump, name, (PeelDumpFormat)i, WIDTH, HEIGHT, i % 2,
                                          i % 2 ? flipped.pixels : images[i].pixels),
                         0);
        image_free(&flipped);
    }
    ck_assert_int_eq(peel_dump_close(&dump), 0);
    ck_assert_ptr_null(dump.error);
    TraceStore *store = read_trace(path, FORMATS);
    for (int i = 0; i < FORMATS; i++) {
        char name[32];
        snprintf(name, sizeof name, "peel.%d.depth", i);
        assert_stored(store, name, &images[i]);
        image_free(&images[i]);
    }
    store_destroy(store);
}
END_TEST

START_TEST(test_dump_failures)
{
    PeelDump dump;
    float pixel[4] = {0};
    ck_assert_int_ne(peel_dump_open(&dump, scratch_path("none/a"), NULL), 0);
    ck_assert_ptr_nonnull(dump.error);
    ck_assert_int_ne(peel_dump_pixels(&dump, "accum", PEEL_DUMP_RGBA32F, 1, 1, 0, pixel), 0);
    ck_assert_int_ne(peel_dump_close(&dump), 0);
    ck_assert_int_eq(peel_dump_open(&dump, scratch_path("a"), NULL), 0);
    ck_assert_int_ne(peel_dump_depth(&dump, "opaque.depth", 0, PEEL_DUMP_D32F, 1, 1), 0);
    ck_assert_int_ne(peel_dump_close(&dump), 0);
}
END_TEST

/* Parts of other names are left out. */
START_TEST(test_exr)
{
    const char *path = scratch_path("a.exr");
    const ExrPart parts[] = {{"beauty", FORMAT_RGBA32F, WIDTH, HEIGHT},
                             {"peel.0.accum", FORMAT_RGBA16F, WIDTH, HEIGHT},
                             {"accum", FORMAT_RGBA8, WIDTH, HEIGHT}};
    Image images[3];
    ExrWriter *writer;
    ck_assert_int_eq(exr_writer_open(path, parts, 3, &writer), RESULT_OK);
    for (int i = 0; i < 3; i++) {
        images[i] = noise(parts[i].format, (uint64_t)i);
        ck_assert_int_eq(exr_writer_part(writer, &images[i]), RESULT_OK);
    }
    ck_assert_int_eq(exr_writer_close(writer, true), RESULT_OK);
    TraceStore *store = read_trace(path, 2);
    assert_stored(store, "peel.0.accum", &images[1]);
    assert_stored(store, "accum", &images[2]);
    store_destroy(store);
    bool is = true;
    ck_assert_int_eq(exr_write(&images[0], path), RESULT_OK);
    ck_assert_int_eq(trace_file_is(path, &is), RESULT_OK);
    ck_assert(!is);
    ck_assert_int_eq(file_write(path, "peel", 4), RESULT_OK);
    ck_assert_int_eq(trace_file_is(path, &is), RESULT_OK);
    ck_assert(!is);
    ck_assert_int_eq(trace_file_is(scratch_path("none"), &is), RESULT_IO);
    for (int i = 0; i < 3; i++)
        image_free(&images[i]);
}
END_TEST

START_TEST(test_broken_dumps)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"peel-dump 1\n", "expected a line"},
        {"peel-dump 2 accum rgba8 1x1 top little\nabcd", "expected a line"},
        {"peel-dump 1 accum rgba8 1x1 top little more\nabcd", "expected a line"},
        {"peel-dump 1 accum rgba9 1x1 top little\nabcd", "its format is none"},
        {"peel-dump 1 accum rgba8 0x1 top little\n", "its size"},
        {"peel-dump 1 accum rgba8 99999x1 top little\n", "its size"},
        {"peel-dump 1 accum rgba8 1x1 left little\nabcd", "first row"},
        {"peel-dump 1 accum rgba8 1x1 top big\nabcd", "byte order"},
        {"peel-dump 1 accum rgba8 1x1 top little\nabc", "ends within"},
        {"peel-dump 1 accum rgba32f 16384x16384 top little\nabc", "ends within"},
        {"peel-dump 1 accum rgba8 1x1 top little\nabcdpeel", "buffer 1: expected a line"},
        {"peel-dump 1 accum rgba8 1x1 top little\nabcdpeel-dump 1 accum rgba8 1x1 top "
         "little\nabcd",
         "buffer accum comes twice"},
        {"peel-dump 1 peel.0.depth d24 1x1 top little\nabcd", "beyond its format's range"},
    };
    const char *path = scratch_path("a.peel");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        TraceStore *store;
        ck_assert_int_eq(store_create(0, &store), RESULT_OK);
        ck_assert_int_eq(file_write(path, cases[i].text, strlen(cases[i].text)), RESULT_OK);
        Result result = trace_file_read(path, store);
        ck_assert_msg(result == RESULT_BAD_INPUT || result == RESULT_UNSUPPORTED, "case %zu: %s", i,
                      result_text(result));
        ck_assert_msg(strstr(result_message(), path) && strstr(result_message(), cases[i].message),
                      "case %zu: %s", i, result_message());
        store_destroy(store);
    }
}
END_TEST

START_TEST(test_names)
{
    ck_assert_int_eq(trace_name_peel("peel.12.accum"), 12);
    ck_assert_int_eq(trace_name_peel("peel.x.accum"), -1);
    ck_assert_int_eq(trace_name_peel("peel.-1.accum"), -1);
    ck_assert_int_eq(trace_name_peel("peel.99999999999.accum"), -1);
    ck_assert_int_eq(trace_name_peel("accum"), -1);
    ck_assert_int_eq(trace_name_step("opaque.depth"), 0);
    ck_assert_int_eq(trace_name_step("peel.3.depth"), 4);
    ck_assert_int_eq(trace_name_step("display"), INT_MAX);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("trace_file");
    TCase *tests = tcase_create("trace_file");
    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, scratch_make, scratch_remove);
    tcase_add_test(tests, test_dump);
    tcase_add_test(tests, test_dump_failures);
    tcase_add_test(tests, test_exr);
    tcase_add_test(tests, test_broken_dumps);
    tcase_add_test(tests, test_names);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

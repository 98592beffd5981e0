/* image/exr: bits survive a round trip, oiiotool reads the same values, bad files are refused. */
#include "image/exr.h"

#include "base/file.h"
#include "base/random.h"
#include "image/exr_planes.h"
#include "scratch.h"
#include "testing.h"

#include <stdio.h>

/* Random bits, so every NaN payload, infinity, denormal and negative zero occurs; the first
 * pixels hold the named cases for certain. */
static Image noise(int width, int height, PixelFormat format, uint64_t seed)
{
    Image image;
    ck_assert_int_eq(image_create(width, height, format, &image), RESULT_OK);
    size_t bytes = (size_t)width * (size_t)height * format_pixel_bytes(format);
    Random random = random_seed(seed);
    for (size_t i = 0; i < bytes; i++)
        ((uint8_t *)image.pixels)[i] = (uint8_t)random_bits(&random);
    if (format == FORMAT_D24 || format == FORMAT_D16)
        for (size_t i = 0; i < bytes / 4; i++)
            ((uint32_t *)image.pixels)[i] &= format_info(format)->unorm_max;
    static const uint32_t floats[] = {0x80000000u, 1u,          0x807fffffu, 0x7f800000u,
                                      0xff800000u, 0x7fc00001u, 0x7f800001u, 0xffffffffu};
    static const uint16_t halves[] = {0x8000, 1, 0x83ff, 0x7c00, 0xfc00, 0x7e01, 0x7c01, 0xffff};
    if (format == FORMAT_RGBA16F)
        memcpy(image.pixels, halves, sizeof halves);
    else if (format_info(format)->kind == KIND_FLOAT)
        memcpy(image.pixels, floats, sizeof floats);
    return image;
}

static void assert_same(const Image *got, const Image *expected)
{
    ck_assert_int_eq(got->format, expected->format);
    ck_assert_int_eq(got->width, expected->width);
    ck_assert_int_eq(got->height, expected->height);
    size_t row = (size_t)expected->width * format_pixel_bytes(expected->format);
    for (int y = 0; y < expected->height; y++)
        ck_assert_msg(memcmp(image_pixel(got, 0, y), image_pixel(expected, 0, y), row) == 0,
                      "row %d of format %s differs", y, format_info(expected->format)->name);
}

START_TEST(test_round_trip)
{
    PixelFormat format = (PixelFormat)_i;
    static const int sizes[][2] = {{37, 53}, {1, 1}, {1, 17}, {300, 2}};
    for (int s = 0; s < 4; s++) {
        int width = sizes[s][0], height = sizes[s][1];
        if (width * height < 8)
            width = 8;
        Image image = noise(width, height, format, 7 + (uint64_t)s), back;
        char name[64];
        int count;
        const char *path = scratch_path("a.exr");
        ck_assert_int_eq(exr_write(&image, path), RESULT_OK);
        ck_assert_int_eq(scratch_entries(), 1);
        ck_assert_msg(exr_read(path, 0, &back, name) == RESULT_OK, "%s", result_message());
        ck_assert_str_eq(name, "");
        assert_same(&back, &image);
        ck_assert_int_eq(exr_part_count(path, &count), RESULT_OK);
        ck_assert_int_eq(count, 1);
        image_free(&back);
        image_free(&image);
    }
}
END_TEST

enum {
    PARTS = 456
};

START_TEST(test_many_parts)
{
    static char names[PARTS][32];
    static ExrPart parts[PARTS];
    const char *path = scratch_path("trace.exr");
    ExrWriter *writer;
    for (int i = 0; i < PARTS; i++) {
        snprintf(names[i], sizeof names[i], "peel.%d.b%d", i / 6, i % 6);
        parts[i] = (ExrPart){names[i], (PixelFormat)(i % FORMAT_COUNT), 25 - i % 3, 18};
    }
    ck_assert_int_eq(exr_writer_open(path, parts, PARTS, &writer), RESULT_OK);
    for (int i = 0; i < PARTS; i++) {
        Image image = noise(parts[i].width, parts[i].height, parts[i].format, (uint64_t)i);
        ck_assert_msg(exr_writer_part(writer, &image) == RESULT_OK, "%s", result_message());
        image_free(&image);
    }
    ck_assert_msg(exr_writer_close(writer, true) == RESULT_OK, "%s", result_message());
    int count;
    ck_assert_int_eq(exr_part_count(path, &count), RESULT_OK);
    ck_assert_int_eq(count, PARTS);
    for (int i = 0; i < PARTS; i += 13) {
        Image expected = noise(parts[i].width, parts[i].height, parts[i].format, (uint64_t)i);
        Image got;
        char name[64];
        ck_assert_msg(exr_read(path, i, &got, name) == RESULT_OK, "%s", result_message());
        ck_assert_str_eq(name, names[i]);
        assert_same(&got, &expected);
        image_free(&got);
        image_free(&expected);
    }
    char command[256], text[256];
    snprintf(command, sizeof command, "oiiotool --info -v -a %s 2>&1 | grep -c peel:format", path);
    scratch_run(command, text, sizeof text);
    ck_assert_int_eq(atoi(text), PARTS);
    /* One display window for parts of three sizes: their union. */
    snprintf(command, sizeof command,
             "oiiotool --info -v -a %s 2>&1 | grep -c 'full/display size: 25 x 18'", path);
    scratch_run(command, text, sizeof text);
    ck_assert_int_eq(atoi(text), PARTS / 3 * 2); /* not said where it is the part's own size */
}
END_TEST

START_TEST(test_other_reader)
{
    const char *path = scratch_path("a.exr");
    Image image;
    ck_assert_int_eq(image_create(9, 5, FORMAT_RGBA32F, &image), RESULT_OK);
    for (int i = 0; i < 9 * 5 * 4; i++)
        ((float *)image.pixels)[i] = (float)i / 64.0f; /* exact in decimal */
    ck_assert_int_eq(exr_write(&image, path), RESULT_OK);
    image_free(&image);
    char command[256], text[16384];
    snprintf(command, sizeof command, "oiiotool --info -v --stats --dumpdata %s 2>&1", path);
    ck_assert_int_eq(scratch_run(command, text, sizeof text), 0);
    ck_assert_msg(strstr(text, "9 x    5, 4 channel, float openexr") != NULL, "%s", text);
    ck_assert_msg(strstr(text, "channel list: R, G, B, A") != NULL, "%s", text);
    ck_assert_msg(strstr(text, "compression: \"zip\"") != NULL, "%s", text);
    ck_assert_msg(strstr(text, "peel:format: \"rgba32f\"") != NULL, "%s", text);
    ck_assert_msg(strstr(text, "Pixel (0, 0): 0.000000000 0.015625000 0.031250000 0.046875000"),
                  "%s", text);
    /* Row 4 from the top, column 8: value (4·9 + 8)·4 = 176. */
    ck_assert_msg(strstr(text, "Pixel (8, 4): 2.750000000 2.765625000 2.781250000 2.796875000"),
                  "%s", text);
}
END_TEST

START_TEST(test_files_of_others)
{
    char command[256], text[1024], name[64];
    const char *path = scratch_path("b.exr");
    Image image;
    snprintf(command, sizeof command,
             "oiiotool --pattern constant:color=0.25,0.5,1 20x40 3 -d half --compression piz "
             "-o %s 2>&1",
             path);
    ck_assert_int_eq(scratch_run(command, text, sizeof text), 0);
    ck_assert_msg(exr_read(path, 0, &image, name) == RESULT_OK, "%s", result_message());
    ck_assert_int_eq(image.format, FORMAT_RGBA16F);
    const uint16_t expected[] = {0x3400, 0x3800, 0x3c00, 0x3c00};
    ck_assert_mem_eq(image_pixel(&image, 19, 39), expected, sizeof expected);
    image_free(&image);
    snprintf(command, sizeof command,
             "oiiotool --pattern constant:color=0.25 20x40 1 --chnames depth -d half -o %s 2>&1",
             path);
    ck_assert_int_eq(scratch_run(command, text, sizeof text), 0);
    ck_assert_msg(exr_read(path, 0, &image, name) == RESULT_OK, "%s", result_message());
    ck_assert_int_eq(image.format, FORMAT_D32F);
    ck_assert_float_bits(*(float *)image_pixel(&image, 3, 5), 0.25f);
    image_free(&image);
    snprintf(command, sizeof command,
             "oiiotool --pattern constant:color=0.25 64x64 3 --tile 32 32 -o %s 2>&1", path);
    ck_assert_int_eq(scratch_run(command, text, sizeof text), 0);
    ck_assert_int_eq(exr_read(path, 0, &image, name), RESULT_UNSUPPORTED);
    ck_assert_ptr_null(image.pixels);
}
END_TEST

/* B44 packs halves alone: floats lie in its chunks as they are. */
START_TEST(test_compressions_of_others)
{
    static const char *const compressions[] = {"none", "rle", "zip", "zips", "piz", "b44", "b44a"};
    const char *path = scratch_path("a.exr"), *other = scratch_path("b.exr");
    Image image = noise(48, 36, FORMAT_RGBA32F, 1);
    ck_assert_int_eq(exr_write(&image, path), RESULT_OK);
    for (size_t i = 0; i < sizeof compressions / sizeof *compressions; i++) {
        char command[256], text[1024], name[64];
        Image back;
        Planes planes;
        ExrFile *file;
        snprintf(command, sizeof command, "oiiotool %s --compression %s -o %s 2>&1", path,
                 compressions[i], other);
        ck_assert_int_eq(scratch_run(command, text, sizeof text), 0);
        ck_assert_msg(exr_read(other, 0, &back, name) == RESULT_OK, "%s", result_message());
        ck_assert_msg(memcmp(back.pixels, image.pixels, (size_t)48 * 36 * 16) == 0, "%s",
                      compressions[i]);
        image_free(&back);
        ck_assert_int_eq(exr_file_open(other, &file), RESULT_OK);
        ck_assert_int_eq(exr_file_planes(file, 0, SIZE_MAX, &planes), RESULT_OK);
        const Plane *red = &planes.planes[planes_find(&planes, "R")];
        for (size_t k = 0; k < (size_t)48 * 36; k++)
            ck_assert_msg(memcmp(&red->bits[k], (float *)image.pixels + 4 * k, 4) == 0, "%s",
                          compressions[i]);
        planes_free(&planes);
        exr_file_close(file);
    }
    image_free(&image);
}
END_TEST

static void assert_refused(const char *path)
{
    Image image;
    char name[64];
    int count;
    Result result = exr_part_count(path, &count);
    if (result == RESULT_OK)
        result = exr_read(path, 0, &image, name);
    ck_assert_msg(result == RESULT_BAD_INPUT || result == RESULT_IO, "%s: %s", path,
                  result_text(result));
    ck_assert_ptr_nonnull(strstr(result_message(), path));
    ck_assert_ptr_null(strchr(result_message(), '\n'));
}

START_TEST(test_bad_files)
{
    const char *path = scratch_path("a.exr"), *bad = scratch_path("bad.exr");
    static char bytes[1 << 20];
    ck_assert_ptr_nonnull(freopen(scratch_path("stderr"), "w", stderr));
    Image image = noise(40, 50, FORMAT_RGBA32F, 1);
    ck_assert_int_eq(exr_write(&image, path), RESULT_OK);
    image_free(&image);
    size_t size = scratch_read(path, bytes, sizeof bytes);
    for (size_t keep = 0; keep < size; keep += 1 + size / 50) {
        ck_assert_int_eq(file_write(bad, bytes, keep), RESULT_OK);
        assert_refused(bad);
    }
    ck_assert_int_eq(file_write(bad, "not an image at all, but long enough", 36), RESULT_OK);
    assert_refused(bad);
    assert_refused(scratch_directory);
    assert_refused(scratch_path("none.exr"));
    image = noise(5, 5, FORMAT_D24, 1);
    *(uint32_t *)image_pixel(&image, 4, 4) = 0x1000000u;
    ck_assert_int_eq(exr_write(&image, bad), RESULT_OK);
    image_free(&image);
    assert_refused(bad);
    char name[64];
    ck_assert_int_eq(exr_read(path, 1, &image, name), RESULT_BAD_INPUT);
    ck_assert_int_eq(exr_read(path, -1, &image, name), RESULT_BAD_INPUT);
    fflush(stderr);
    ck_assert_uint_eq(scratch_read(scratch_path("stderr"), bytes, sizeof bytes), 0);
}
END_TEST

/* Flipped bits must never do more than fail. The seed is the loop index. */
START_TEST(test_flipped_bits)
{
    enum {
        CASES = 400
    };
    const char *path = scratch_path("a.exr"), *bad = scratch_path("bad.exr");
    static char bytes[1 << 18], broken[1 << 18];
    ExrPart parts[] = {{"a", FORMAT_RGBA16, 20, 33}, {"b", FORMAT_D24, 9, 4}};
    ExrWriter *writer;
    ck_assert_int_eq(exr_writer_open(path, parts, 2, &writer), RESULT_OK);
    for (int i = 0; i < 2; i++) {
        Image image = noise(parts[i].width, parts[i].height, parts[i].format, 5);
        ck_assert_int_eq(exr_writer_part(writer, &image), RESULT_OK);
        image_free(&image);
    }
    ck_assert_int_eq(exr_writer_close(writer, true), RESULT_OK);
    size_t size = scratch_read(path, bytes, sizeof bytes);
    int refused = 0;
    for (uint64_t seed = 0; seed < CASES; seed++) {
        Random random = random_seed(seed);
        memcpy(broken, bytes, size);
        uint64_t range = seed % 2 ? size : 700; /* the header's bytes matter most */
        for (uint64_t flips = 1 + random_bits(&random) % 4; flips; flips--)
            broken[random_bits(&random) % range] ^= (char)(1 << random_bits(&random) % 8);
        ck_assert_int_eq(file_write(bad, broken, size), RESULT_OK);
        for (int part = 0; part < 2; part++) {
            Image image;
            char name[64];
            refused += exr_read(bad, part, &image, name) != RESULT_OK;
            image_free(&image);
        }
    }
    ck_assert_int_gt(refused, CASES / 4);
}
END_TEST

START_TEST(test_writer_failures)
{
    Image image = noise(8, 8, FORMAT_D32F, 1);
    ExrPart parts[] = {{"a", FORMAT_D32F, 8, 8}, {"b", FORMAT_D32F, 8, 9}};
    ExrWriter *writer;
    ck_assert_int_eq(exr_write(&image, scratch_path("missing/a.exr")), RESULT_IO);
    ck_assert_int_eq(exr_write(&image, scratch_directory), RESULT_IO);
    for (rlim_t limit = 0; limit < 600; limit += 50) {
        scratch_limit(limit);
        Result full = exr_write(&image, scratch_path("a.exr"));
        scratch_limit(RLIM_INFINITY);
        ck_assert_msg(full == RESULT_IO && strstr(result_message(), "File too large"),
                      "limit %d: %s, %s", (int)limit, result_text(full), result_message());
    }
    /* A part missing, a part of the wrong size, an abort: nothing stays. */
    ck_assert_int_eq(exr_writer_open(scratch_path("a.exr"), parts, 2, &writer), RESULT_OK);
    ck_assert_int_eq(exr_writer_part(writer, &image), RESULT_OK);
    ck_assert_int_eq(exr_writer_part(writer, &image), RESULT_INTERNAL);
    ck_assert_int_eq(exr_writer_close(writer, true), RESULT_INTERNAL);
    ck_assert_int_eq(exr_writer_open(scratch_path("a.exr"), parts, 1, &writer), RESULT_OK);
    ck_assert_int_eq(exr_writer_close(writer, false), RESULT_OK);
    ck_assert_int_eq(scratch_entries(), 0);
    ExrPart twins[] = {{"a", FORMAT_D32F, 8, 8}, {"a", FORMAT_D32F, 8, 8}};
    ck_assert_int_eq(exr_writer_open(scratch_path("a.exr"), twins, 2, &writer), RESULT_INTERNAL);
    twins[1].name = NULL;
    ck_assert_int_eq(exr_writer_open(scratch_path("a.exr"), twins, 2, &writer), RESULT_INTERNAL);
    ck_assert_int_eq(scratch_entries(), 0);
    image_free(&image);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("exr");
    TCase *tests = tcase_create("exr");
    tcase_set_timeout(tests, 120);
    tcase_add_checked_fixture(tests, scratch_make, scratch_remove);
    tcase_add_loop_test(tests, test_round_trip, 0, FORMAT_COUNT);
    tcase_add_test(tests, test_many_parts);
    tcase_add_test(tests, test_other_reader);
    tcase_add_test(tests, test_files_of_others);
    tcase_add_test(tests, test_compressions_of_others);
    tcase_add_test(tests, test_bad_files);
    tcase_add_test(tests, test_flipped_bits);
    tcase_add_test(tests, test_writer_failures);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

/* image/planes.h and image/exr_planes.h: names, limits, and what comes back from files. */
#include "testing.h"

#include "image/exr.h"
#include "image/exr_planes.h"
#include "scratch.h"

static void check_names(const Planes *planes, const char *expected)
{
    char names[300] = "";
    for (int i = 0; i < planes->count; i++) {
        strcat(names, i ? "," : "");
        strcat(names, planes->planes[i].name);
    }
    ck_assert_str_eq(names, expected);
}

START_TEST(test_planes)
{
    static const char *const names[] = {"A", "B", "G", "N.R", "R", "Z"};
    Planes planes;
    ck_assert_int_eq(planes_create(2, 2, 6, 0, "planes", &planes), RESULT_OK);
    for (int i = 0; i < 6; i++)
        ck_assert_int_eq(planes_name(&planes.planes[i], names[i]), RESULT_OK);
    planes_sort(&planes);
    check_names(&planes, "R,G,B,A,N.R,Z");
    ck_assert_int_eq(planes_find(&planes, "N.R"), 4);
    ck_assert_int_eq(planes_find(&planes, "N"), -1);
    ck_assert(!planes_keep(&planes, "R,G,N"));
    ck_assert(!planes_keep(&planes, "R,,G"));
    check_names(&planes, "R,G,B,A,N.R,Z");
    ck_assert(planes_keep(&planes, "Z,R,Z,N.R"));
    check_names(&planes, "Z,R,N.R");
    planes_free(&planes);
    ck_assert_int_eq(planes_create(1024, 1024, 4, (size_t)16 << 20, "p", &planes), RESULT_OK);
    planes_free(&planes);
    ck_assert_int_eq(planes_create(1024, 1025, 4, (size_t)16 << 20, "p", &planes),
                     RESULT_NO_MEMORY);
    ck_assert_str_eq(result_message(),
                     "p: 4 channels of 1024x1025 pixels need more than 16777216 bytes");
    planes_free(&planes);
}
END_TEST

START_TEST(test_planes_of_grey)
{
    uint8_t pixels[2][4] = {{7, 7, 7, 9}, {8, 8, 8, 10}};
    const Image image = {2, 1, FORMAT_RGBA8, pixels};
    static const char *const names[] = {"Y", "Y,A", "R,G,B", "R,G,B,A"};
    for (int channels = 1; channels <= 4; channels++) {
        Planes planes;
        ck_assert_int_eq(planes_from_image(&image, channels, &planes), RESULT_OK);
        check_names(&planes, names[channels - 1]);
        ck_assert_uint_eq(planes.planes[0].bits[1], 8);
        if (channels % 2 == 0)
            ck_assert_uint_eq(planes.planes[channels - 1].bits[1], 10);
        ck_assert_str_eq(planes_kind_name(planes.planes[0].kind, planes.planes[0].unorm_max),
                         "unorm8");
        planes_free(&planes);
    }
}
END_TEST

static Planes read_part(const char *path, int part)
{
    ExrFile *file;
    Planes planes;
    ck_assert_msg(exr_file_open(path, &file) == RESULT_OK, "%s", result_message());
    ck_assert_msg(exr_file_planes(file, part, 0, &planes) == RESULT_OK, "%s", result_message());
    exr_file_close(file);
    return planes;
}

/* Every stored value of every format comes back, as what it is. */
START_TEST(test_formats)
{
    for (int f = 0; f < FORMAT_COUNT; f++) {
        PixelFormat format = (PixelFormat)f;
        const FormatInfo *info = format_info(format);
        Image image;
        ck_assert_int_eq(image_create(7, 40, format, &image), RESULT_OK);
        size_t bytes = 7 * 40 * format_pixel_bytes(format);
        for (size_t i = 0; i < bytes; i++)
            ((unsigned char *)image.pixels)[i] = (unsigned char)(i * 37);
        for (size_t i = 0; i < 7 * 40 && (format == FORMAT_D24 || format == FORMAT_D16); i++)
            ((uint32_t *)image.pixels)[i] &= info->unorm_max;
        ck_assert_int_eq(exr_write(&image, scratch_path("image.exr")), RESULT_OK);
        Planes planes = read_part(scratch_path("image.exr"), 0);
        ck_assert_int_eq(planes.count, info->channels);
        for (int c = 0; c < info->channels; c++) {
            ck_assert_int_eq(planes.planes[c].kind, info->kind);
            ck_assert_uint_eq(planes.planes[c].unorm_max, info->unorm_max);
            for (int i = 0; i < 7 * 40; i++)
                ck_assert_uint_eq(planes.planes[c].bits[i],
                                  format_bits(format, image_pixel(&image, i % 7, i / 7), c));
        }
        planes_free(&planes);
        image_free(&image);
    }
}
END_TEST

static const int name_lengths[] = {1, 31, 32, 255};

/* Any names, written and read; the order is R, G, B, A, then as files have it. */
START_TEST(test_write)
{
    char names[3][256] = {"Z", "left.R", "G"}, order[300];
    memset(names[0], 'Z', (size_t)name_lengths[_i]);
    snprintf(order, sizeof order, "G,%s,left.R", names[0]);
    const char *path = scratch_path("planes.exr");
    Planes planes;
    ck_assert_int_eq(planes_create(5, 33, 3, 0, "planes", &planes), RESULT_OK);
    for (int c = 0; c < 3; c++) {
        ck_assert_int_eq(planes_name(&planes.planes[c], names[c]), RESULT_OK);
        for (int i = 0; i < 5 * 33; i++)
            planes.planes[c].bits[i] = (uint32_t)(i * 3 + c) << 16;
    }
    ck_assert_msg(exr_planes_write(&planes, path) == RESULT_OK, "%s", result_message());
    Planes back = read_part(path, 0);
    check_names(&back, order);
    for (int i = 0; i < 5 * 33; i++)
        for (int c = 0; c < 3; c++)
            ck_assert_uint_eq(back.planes[planes_find(&back, names[c])].bits[i],
                              planes.planes[c].bits[i]);
    ck_assert_int_eq(exr_planes_write(&planes, scratch_path("none/planes.exr")), RESULT_IO);
    ck_assert_int_eq(scratch_entries(), 1);
    planes_free(&planes);
    planes_free(&back);
}
END_TEST

/* A trace has names and formats in every part. */
START_TEST(test_parts)
{
    const ExrPart parts[] = {{"one", FORMAT_RGBA8, 2, 2}, {"two", FORMAT_D24, 3, 1}};
    const char *path = scratch_path("parts.exr");
    ExrWriter *writer;
    ExrFile *file;
    ck_assert_int_eq(exr_writer_open(path, parts, 2, &writer), RESULT_OK);
    for (int i = 0; i < 2; i++) {
        Image image;
        ck_assert_int_eq(image_create(parts[i].width, parts[i].height, parts[i].format, &image),
                         RESULT_OK);
        ck_assert_int_eq(exr_writer_part(writer, &image), RESULT_OK);
        image_free(&image);
    }
    ck_assert_int_eq(exr_writer_close(writer, true), RESULT_OK);
    ck_assert_int_eq(exr_file_open(path, &file), RESULT_OK);
    ck_assert_int_eq(exr_file_count(file), 2);
    ck_assert_str_eq(exr_file_name(file, 1), "two");
    ck_assert(exr_file_is_trace(file));
    ck_assert(!exr_file_is_deep(file, 0));
    Planes planes;
    ck_assert_int_eq(exr_file_planes(file, 1, 11, &planes), RESULT_NO_MEMORY);
    ck_assert_int_eq(exr_file_planes(file, 1, 12, &planes), RESULT_OK);
    ck_assert_int_eq(planes.width, 3);
    planes_free(&planes);
    exr_file_close(file);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("planes");
    TCase *tcase = tcase_create("planes");
    tcase_add_checked_fixture(tcase, scratch_make, scratch_remove);
    tcase_add_test(tcase, test_planes);
    tcase_add_test(tcase, test_planes_of_grey);
    tcase_add_test(tcase, test_formats);
    tcase_add_loop_test(tcase, test_write, 0, sizeof name_lengths / sizeof *name_lengths);
    tcase_add_test(tcase, test_parts);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

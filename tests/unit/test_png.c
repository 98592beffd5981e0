/* image/png, judged by oiiotool, another reader. */
#include "image/png.h"

#include "scratch.h"
#include "testing.h"

#include <stdio.h>

static Image gradient(int width, int height)
{
    Image image;
    ck_assert_int_eq(image_create(width, height, FORMAT_RGBA8, &image), RESULT_OK);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            uint8_t *pixel = image_pixel(&image, x, y);
            pixel[0] = (uint8_t)(x * 7);
            pixel[1] = (uint8_t)(y * 11);
            pixel[2] = (uint8_t)(x * y);
            pixel[3] = 3; /* must not reach the file */
        }
    return image;
}

START_TEST(test_pixels_survive)
{
    Image image = gradient(19, 13);
    ck_assert_int_eq(png_write(&image, scratch_path("a.png")), RESULT_OK);
    ck_assert_int_eq(scratch_entries(), 1);
    char command[256], text[65536];
    snprintf(command, sizeof command, "oiiotool --info --dumpdata %s 2>&1", scratch_path("a.png"));
    ck_assert_int_eq(scratch_run(command, text, sizeof text), 0);
    ck_assert_msg(strstr(text, "19 x   13, 3 channel, uint8") != NULL, "%s", text);
    for (int y = 0; y < 13; y++)
        for (int x = 0; x < 19; x++) {
            const uint8_t *pixel = image_pixel(&image, x, y);
            char label[48];
            snprintf(label, sizeof label, "Pixel (%d, %d): ", x, y);
            const char *at = strstr(text, label);
            ck_assert_msg(at != NULL, "no pixel %d, %d in %s", x, y, text);
            int got[3];
            ck_assert_int_eq(sscanf(at + strlen(label), "%d %d %d", &got[0], &got[1], &got[2]), 3);
            for (int c = 0; c < 3; c++)
                ck_assert_int_eq(got[c], pixel[c]);
        }
    image_free(&image);
}
END_TEST

START_TEST(test_failures)
{
    Image image = gradient(4, 4);
    ck_assert_int_eq(png_write(&image, scratch_path("missing/a.png")), RESULT_IO);
    ck_assert_ptr_nonnull(strstr(result_message(), "missing/a.png"));
    ck_assert_int_eq(png_write(&image, scratch_directory), RESULT_IO);
    scratch_limit(20);
    Result full = png_write(&image, scratch_path("a.png"));
    scratch_limit(RLIM_INFINITY);
    ck_assert_int_eq(full, RESULT_IO);
    image.format = FORMAT_D32F;
    ck_assert_int_eq(png_write(&image, scratch_path("a.png")), RESULT_INTERNAL);
    ck_assert_int_eq(scratch_entries(), 0);
    image_free(&image);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("png");
    TCase *tests = tcase_create("png");
    tcase_add_checked_fixture(tests, scratch_make, scratch_remove);
    tcase_add_test(tests, test_pixels_survive);
    tcase_add_test(tests, test_failures);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

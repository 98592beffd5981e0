/* report/heatmap: the scale's order, and the colours that are not on it. */
#include "report/heatmap.h"

#include "testing.h"

#include <math.h>

static double linear(uint8_t value)
{
    double s = value / 255.0;
    return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

static double luminance(const uint8_t *rgba)
{
    return 0.2126 * linear(rgba[0]) + 0.7152 * linear(rgba[1]) + 0.0722 * linear(rgba[2]);
}

/* The colour of one pixel whose channel `channel` differs by `difference`. */
static void color(float difference, int channel, uint8_t out[4])
{
    Image a, b, map;
    ck_assert_int_eq(image_create(1, 1, FORMAT_RGBA32F, &a), RESULT_OK);
    ck_assert_int_eq(image_create(1, 1, FORMAT_RGBA32F, &b), RESULT_OK);
    ((float *)b.pixels)[channel] = difference;
    ck_assert_int_eq(heatmap_image(&a, &b, &map), RESULT_OK);
    ck_assert_int_eq(map.format, FORMAT_RGBA8);
    memcpy(out, map.pixels, 4);
    image_free(&a);
    image_free(&b);
    image_free(&map);
}

START_TEST(test_scale_brightens)
{
    Image scale;
    ck_assert_int_eq(heatmap_scale(64, 2, &scale), RESULT_OK);
    for (int x = 1; x < 64; x++)
        ck_assert_msg(luminance(image_pixel(&scale, x, 1)) >
                          luminance(image_pixel(&scale, x - 1, 0)),
                      "luminance does not rise at %d", x);
    image_free(&scale);
}
END_TEST

START_TEST(test_colors)
{
    uint8_t low[4], high[4], got[4], middle[4];
    const uint8_t black[] = {0, 0, 0, 255}, magenta[] = {255, 0, 255, 255};
    Image scale;
    ck_assert_int_eq(heatmap_scale(257, 1, &scale), RESULT_OK);
    memcpy(low, image_pixel(&scale, 0, 0), 4);
    memcpy(middle, image_pixel(&scale, 128, 0), 4);
    memcpy(high, image_pixel(&scale, 256, 0), 4);
    for (int x = 0; x < 257; x++) {
        ck_assert_mem_ne(image_pixel(&scale, x, 0), black, 4);
        ck_assert_mem_ne(image_pixel(&scale, x, 0), magenta, 4);
    }
    image_free(&scale);
    for (int channel = 0; channel < 4; channel++) {
        color(0.0f, channel, got);
        ck_assert_mem_eq(got, black, 4);
        color(-0.0f, channel, got);
        ck_assert_mem_eq(got, black, 4);
        color(1e-30f, channel, got);
        ck_assert_mem_eq(got, low, 4);
        color(-1e-4f, channel, got); /* the middle of eight decades */
        for (int c = 0; c < 4; c++)
            ck_assert_int_le(abs(got[c] - middle[c]), 1);
        color(1.0f, channel, got);
        ck_assert_mem_eq(got, high, 4);
        color(-1e30f, channel, got);
        ck_assert_mem_eq(got, high, 4);
        color(NAN, channel, got);
        ck_assert_mem_eq(got, magenta, 4);
        color(-INFINITY, channel, got);
        ck_assert_mem_eq(got, magenta, 4);
    }
}
END_TEST

START_TEST(test_sizes_must_agree)
{
    Image a, b, out;
    ck_assert_int_eq(image_create(2, 2, FORMAT_RGBA32F, &a), RESULT_OK);
    ck_assert_int_eq(image_create(2, 3, FORMAT_RGBA32F, &b), RESULT_OK);
    ck_assert_int_eq(heatmap_image(&a, &b, &out), RESULT_INTERNAL);
    ck_assert_ptr_null(out.pixels);
    image_free(&a);
    image_free(&b);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("heatmap");
    TCase *tests = tcase_create("heatmap");
    tcase_add_test(tests, test_scale_brightens);
    tcase_add_test(tests, test_colors);
    tcase_add_test(tests, test_sizes_must_agree);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

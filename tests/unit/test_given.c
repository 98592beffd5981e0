/* compare/given: files of others are read or refused in one line, and what their values mean is
 * found out. */
#include "compare/given.h"

#include "base/file.h"
#include "base/random.h"
#include "image/exr.h"
#include "image/png.h"
#include "scratch.h"
#include "testing.h"

#include <math.h>
#include <stdio.h>

enum {
    WIDTH = 40,
    HEIGHT = 30
};

/* Linear light: background below, a gradient above, some of it beyond 1. */
static Image make_reference(void)
{
    Image image;
    ck_assert_int_eq(image_create(WIDTH, HEIGHT, FORMAT_RGBA32F, &image), RESULT_OK);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            float *pixel = image_pixel(&image, x, y);
            bool covered = y < 20;
            pixel[0] = covered ? 0.05f * (float)x : 0.1f;
            pixel[1] = covered ? 0.03f * (float)y : 0.1f;
            pixel[2] = covered ? 0.4f : 0.1f;
            pixel[3] = covered ? (float)x / 80.0f : 0.0f;
        }
    return image;
}

/* The reference as somebody may store it. */
static Image make_stored(const Image *reference, PixelFormat format, const GivenMeaning *meaning)
{
    Image image;
    ck_assert_int_eq(image_create(WIDTH, HEIGHT, format, &image), RESULT_OK);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const float *pixel = image_pixel(reference, x, y);
            float value[4];
            for (int c = 0; c < 3; c++)
                value[c] = (float)given_stored_value(format, meaning->encoding, (double)pixel[c]);
            value[3] = meaning->alpha == GIVEN_COVERAGE        ? pixel[3]
                       : meaning->alpha == GIVEN_TRANSMITTANCE ? 1.0f - pixel[3]
                                                               : 1.0f;
            int row = meaning->rows == GIVEN_BOTTOM_UP ? HEIGHT - 1 - y : y;
            format_store(format, value, image_pixel(&image, x, row));
        }
    return image;
}

static void write_png(const Image *image, const char *path)
{
    unsigned char *bytes;
    size_t count;
    ck_assert_int_eq(png_encode(image, path, &bytes, &count), RESULT_OK);
    ck_assert_int_eq(file_write(path, bytes, count), RESULT_OK);
    free(bytes);
}

/* Writes and reads reference as `meaning` in `format` (PNG for integers, else EXR). */
static GivenImage through_file(const Image *reference, PixelFormat format,
                               const GivenMeaning *meaning)
{
    Image stored = make_stored(reference, format, meaning);
    const char *path = scratch_path("given");
    if (format == FORMAT_RGBA8)
        write_png(&stored, path);
    else
        ck_assert_int_eq(exr_write(&stored, path), RESULT_OK);
    image_free(&stored);
    GivenImage given;
    const int size[] = {reference->width, reference->height};
    const int others[][2] = {{size[0] + 1, size[1]}, {size[0], size[1] - 1}};
    for (int i = 0; i < 2; i++) {
        ck_assert_int_eq(given_load(path, others[i], &given), RESULT_OK);
        ck_assert(given.stored.width == size[0] && given.stored.height == size[1]);
        ck_assert_ptr_null(given.stored.pixels);
        given_free(&given);
    }
    ck_assert_msg(given_load(path, size, &given) == RESULT_OK, "%s", result_message());
    ck_assert_int_eq(given.stored.format, format);
    ck_assert_str_eq(given.kind, format == FORMAT_RGBA8 ? "PNG" : "EXR");
    ck_assert(given.has_alpha);
    ck_assert_uint_eq(given.nonfinite, 0);
    return given;
}

static void assert_reading(const Image *reference, const GivenImage *given,
                           const GivenReading *reading)
{
    PixelFormat format = given->stored.format;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const float *expected = image_pixel(reference, x, y);
            const float *encoded = image_pixel(&reading->encoded, x, y);
            for (int c = 0; c < 3; c++) {
                double value =
                    given_stored_value(format, reading->meaning.encoding, (double)expected[c]);
                ck_assert_double_le(fabs((double)encoded[c] - value),
                                    given_quantum(format, value) + 1e-6);
            }
            float alpha = reading->meaning.alpha == GIVEN_ALPHA_NONE ? 1.0f : expected[3];
            ck_assert_double_le(fabs((double)(encoded[3] - alpha)),
                                given_quantum(format, 1.0) + 1e-6);
        }
}

/* Every meaning in every format is found, and undone. */
START_TEST(test_every_meaning)
{
    static const PixelFormat formats[] = {FORMAT_RGBA8, FORMAT_RGBA16F, FORMAT_RGBA32F};
    PixelFormat format = formats[_i / 18];
    GivenMeaning meaning = {(GivenEncoding)(1 + _i % 3), (GivenRows)(1 + _i / 3 % 2),
                            (GivenAlpha)(1 + _i / 6 % 3)};
    Image reference = make_reference();
    GivenImage given = through_file(&reference, format, &meaning);
    GivenReading reading;
    ck_assert_int_eq(given_interpret(&given, &reference, &(GivenMeaning){0}, &reading), RESULT_OK);
    ck_assert_int_eq(reading.meaning.encoding, meaning.encoding);
    ck_assert_int_eq(reading.meaning.rows, meaning.rows);
    ck_assert_int_eq(reading.meaning.alpha, meaning.alpha);
    ck_assert(reading.sure);
    assert_reading(&reference, &given, &reading);
    given_reading_free(&reading);
    /* What is asked for is taken, however badly it fits. */
    GivenMeaning asked = {GIVEN_SRGB, GIVEN_BOTTOM_UP, GIVEN_TRANSMITTANCE};
    ck_assert_int_eq(given_interpret(&given, &reference, &asked, &reading), RESULT_OK);
    ck_assert_mem_eq(&reading.meaning, &asked, sizeof asked);
    given_reading_free(&reading);
    given_free(&given);
    image_free(&reference);
}
END_TEST

/* Wrong images are not explained away by an unusual meaning, and nothing is known of black ones. */
START_TEST(test_doubtful)
{
    Image reference = make_reference();
    GivenMeaning meaning = {GIVEN_SEED, GIVEN_TOP_DOWN, GIVEN_ALPHA_NONE};
    GivenReading reading;
    Image brighter = make_reference();
    for (size_t i = 0; i < WIDTH * HEIGHT * 4; i++)
        ((float *)brighter.pixels)[i] *= 1.3f;
    GivenImage given = through_file(&brighter, FORMAT_RGBA8, &meaning);
    ck_assert_int_eq(given_interpret(&given, &reference, &(GivenMeaning){0}, &reading), RESULT_OK);
    ck_assert_int_eq(reading.meaning.encoding, GIVEN_SEED);
    ck_assert_int_eq(reading.meaning.rows, GIVEN_TOP_DOWN);
    given_reading_free(&reading);
    given_free(&given);
    memset(brighter.pixels, 0, sizeof(float[4]) * WIDTH * HEIGHT);
    given = through_file(&brighter, FORMAT_RGBA32F, &meaning);
    ck_assert_int_eq(given_interpret(&given, &reference, &(GivenMeaning){0}, &reading), RESULT_OK);
    ck_assert_int_eq(reading.meaning.encoding, GIVEN_LINEAR);
    ck_assert_int_eq(reading.meaning.rows, GIVEN_TOP_DOWN);
    ck_assert_int_eq(reading.meaning.alpha, GIVEN_ALPHA_NONE);
    ck_assert(!reading.sure);
    char text[128];
    given_describe(&given, &reading, text, sizeof text);
    ck_assert_str_eq(text, "32-bit float EXR, linear, rows from the top, alpha means nothing");
    given_reading_free(&reading);
    memset(reference.pixels, 0, sizeof(float[4]) * WIDTH * HEIGHT);
    ck_assert_int_eq(given_interpret(&given, &reference, &(GivenMeaning){0}, &reading), RESULT_OK);
    ck_assert(!reading.sure); /* all meanings fit */
    given_reading_free(&reading);
    given_free(&given);
    image_free(&brighter);
    image_free(&reference);
}
END_TEST

START_TEST(test_nonfinite)
{
    Image image = make_reference();
    GivenImage given;
    *(float *)image_pixel(&image, 3, 4) = NAN;
    ((float *)image_pixel(&image, 5, 6))[3] = INFINITY;
    ck_assert_int_eq(exr_write(&image, scratch_path("a.exr")), RESULT_OK);
    ck_assert_int_eq(given_load(scratch_path("a.exr"), NULL, &given), RESULT_OK);
    ck_assert_uint_eq(given.nonfinite, 2);
    GivenReading reading;
    ck_assert_int_eq(given_interpret(&given, &image, &(GivenMeaning){0}, &reading), RESULT_OK);
    ck_assert_int_eq(reading.meaning.encoding, GIVEN_LINEAR);
    ck_assert(isnan(*(float *)image_pixel(&reading.linear, 3, 4)));
    given_reading_free(&reading);
    given_free(&given);
    image_free(&image);
}
END_TEST

/* Encodings are each other's inverse, and half a step of rounding is half a step. */
START_TEST(test_encodings)
{
    Random random = random_seed(7);
    for (int i = 0; i < 20000; i++) {
        double linear = ldexp(random_unit(&random), (int)(random_bits(&random) % 24) - 12);
        for (int e = GIVEN_LINEAR; e <= GIVEN_SEED; e++) {
            double value = given_encode((GivenEncoding)e, linear);
            double back = given_decode((GivenEncoding)e, value);
            ck_assert_msg(fabs(back - linear) <= 1e-6 * linear + 1e-9, "%s: %a becomes %a",
                          given_encoding_name((GivenEncoding)e), linear, back);
        }
        uint16_t half = half_from_float((float)linear); /* truncated */
        ck_assert_double_le(fabs((double)half_to_float(half) - (double)(float)linear),
                            given_quantum(FORMAT_RGBA16F, linear));
    }
    ck_assert_double_eq(given_quantum(FORMAT_RGBA16F, 1.0), 0x1p-10);
    ck_assert_double_eq(given_quantum(FORMAT_RGBA16F, 1e-9), 0x1p-24);
    ck_assert_double_eq(given_quantum(FORMAT_RGBA16F, 0.0), 0x1p-24);
    ck_assert_double_eq(given_stored_value(FORMAT_RGBA8, GIVEN_LINEAR, 3.0), 1.0);
    ck_assert_double_eq(given_stored_value(FORMAT_RGBA8, GIVEN_LINEAR, -3.0), 0.0);
    ck_assert_double_eq(given_stored_value(FORMAT_RGBA16F, GIVEN_LINEAR, -3.0), -3.0);
    ck_assert_double_eq(given_encode(GIVEN_SEED, (double)INFINITY), 1.0);
    ck_assert(isinf(given_decode(GIVEN_SEED, 1.0)));
    ck_assert(isnan(given_encode(GIVEN_SEED, (double)NAN)));
}
END_TEST

static void assert_refused(const char *path, Result expected, const char *message)
{
    GivenImage given;
    ck_assert_int_eq(given_load(path, NULL, &given), expected);
    ck_assert_ptr_null(given.stored.pixels);
    ck_assert_msg(strstr(result_message(), path) && strstr(result_message(), message), "%s",
                  result_message());
    ck_assert_ptr_null(strchr(result_message(), '\n'));
}

START_TEST(test_bad_files)
{
    const char *path = scratch_path("a"), *exr = scratch_path("b.exr");
    Image reference = make_reference();
    GivenMeaning meaning = {GIVEN_SEED, GIVEN_TOP_DOWN, GIVEN_COVERAGE};
    Image stored = make_stored(&reference, FORMAT_RGBA8, &meaning), depth;
    unsigned char *bytes;
    size_t count;
    ck_assert_int_eq(png_encode(&stored, path, &bytes, &count), RESULT_OK);
    ck_assert_int_eq(file_write(path, bytes, count / 2), RESULT_OK);
    free(bytes);
    assert_refused(path, RESULT_BAD_INPUT, "cannot decode the PNG");
    ck_assert_int_eq(file_write(path, "P6 1 1 255\n...", 14), RESULT_OK);
    assert_refused(path, RESULT_BAD_INPUT, "neither PNG nor EXR");
    ck_assert_int_eq(file_write(path, "", 0), RESULT_OK);
    assert_refused(path, RESULT_BAD_INPUT, "neither PNG nor EXR");
    assert_refused(scratch_path("none"), RESULT_IO, "cannot read");
    assert_refused(scratch_directory, RESULT_BAD_INPUT, "not a regular file");
    ck_assert_int_eq(image_create(4, 4, FORMAT_D32F, &depth), RESULT_OK);
    ck_assert_int_eq(exr_write(&depth, exr), RESULT_OK);
    assert_refused(exr, RESULT_UNSUPPORTED, "no channels R, G and B");
    image_free(&depth);
    image_free(&stored);
    image_free(&reference);
}
END_TEST

START_TEST(test_sizes)
{
    Image reference = make_reference(), other;
    GivenMeaning meaning = {GIVEN_LINEAR, GIVEN_TOP_DOWN, GIVEN_COVERAGE};
    GivenImage given = through_file(&reference, FORMAT_RGBA32F, &meaning);
    GivenReading reading;
    ck_assert_int_eq(image_create(HEIGHT, WIDTH, FORMAT_RGBA32F, &other), RESULT_OK);
    ck_assert_int_eq(given_interpret(&given, &other, &meaning, &reading), RESULT_INTERNAL);
    image_free(&other);
    given_free(&given);
    image_free(&reference);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("given");
    TCase *tests = tcase_create("given");
    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, scratch_make, scratch_remove);
    tcase_add_loop_test(tests, test_every_meaning, 0, 3 * 18);
    tcase_add_test(tests, test_doubtful);
    tcase_add_test(tests, test_nonfinite);
    tcase_add_test(tests, test_encodings);
    tcase_add_test(tests, test_bad_files);
    tcase_add_test(tests, test_sizes);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

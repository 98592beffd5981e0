/* compare/judge: which pixel is equal, stored, within, at an edge or beyond, and the verdict. */
#include "compare/judge.h"

#include "testing.h"

#include <float.h>
#include <math.h>

enum {
    SIDE = 40
};

static float *pixel_of(const Image *image, int x, int y)
{
    return image_pixel(image, x, y);
}

/* A bright square on black. */
static Image make_image(void)
{
    Image image;
    ck_assert_int_eq(image_create(SIDE, SIDE, FORMAT_RGBA32F, &image), RESULT_OK);
    for (int y = 5; y < 35; y++)
        for (int x = 5; x < 35; x++)
            for (int c = 0; c < 4; c++)
                pixel_of(&image, x, y)[c] = 0.25f + 0.01f * (float)x + 0.1f * (float)c;
    return image;
}

typedef struct Pair {
    Image theirs, reference;
    JudgeDesc desc;
    JudgeFigures figures;
} Pair;

static void make_pair(Pair *pair)
{
    pair->theirs = make_image();
    pair->reference = make_image();
    pair->desc = (JudgeDesc){.theirs = &pair->theirs,
                             .reference = &pair->reference,
                             .encoding = GIVEN_LINEAR,
                             .format = FORMAT_RGBA32F,
                             .reference_format = FORMAT_RGBA32F,
                             .channels = 4,
                             .tolerance = 1e-4};
}

static void judge_pair(Pair *pair)
{
    ck_assert_int_eq(judge(&pair->desc, &pair->figures), RESULT_OK);
    const JudgeFigures *f = &pair->figures;
    ck_assert_uint_eq(f->pixels, SIDE * SIDE);
    ck_assert_uint_eq(f->equal + f->stored + f->within + f->edge + f->beyond, f->pixels);
}

static void free_pair(Pair *pair)
{
    image_free(&pair->theirs);
    image_free(&pair->reference);
}

START_TEST(test_classes)
{
    Pair pair;
    make_pair(&pair);
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.equal, SIDE * SIDE);
    ck_assert_uint_eq(pair.figures.occupied, 900);
    ck_assert(pair.figures.agree && !pair.figures.worst.is);
    ck_assert_double_eq(pair.figures.correlation, 1.0);

    float *one = pixel_of(&pair.theirs, 7, 8), *two = pixel_of(&pair.theirs, 20, 20);
    one[2] = nextafterf(one[2], 1.0f);
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.within, 1);
    ck_assert_int_eq(pair.figures.worst.x, 7);
    ck_assert_int_eq(pair.figures.worst.y, 8);
    ck_assert_int_eq(pair.figures.worst.channel, 2);
    ck_assert_double_eq(pair.figures.worst.ulp, 1.0);
    ck_assert(pair.figures.agree);

    /* The worst pixel is of the worst class. */
    two[0] += 0.5f;
    pixel_of(&pair.theirs, 4, 4)[1] = 0.3f; /* beside the square's corner */
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.within, 1);
    ck_assert_uint_eq(pair.figures.edge, 1);
    ck_assert_uint_eq(pair.figures.beyond, 1);
    ck_assert_int_eq(pair.figures.worst.x, 20);
    ck_assert_double_eq_tol(pair.figures.max_abs, 0.5, 1e-6);
    ck_assert(pair.figures.agree); /* of 900 occupied pixels 4 may be beyond */

    for (int i = 0; i < 4; i++)
        pixel_of(&pair.theirs, 10 + i, 10)[0] += 0.5f;
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.beyond, 5);
    ck_assert(!pair.figures.agree);
    /* Channels that are not compared do not count. */
    for (int i = 0; i < SIDE * SIDE; i++)
        ((float *)pair.theirs.pixels)[4 * i + 3] = 7.0f;
    pair.desc.channels = 3;
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.beyond, 5);
    free_pair(&pair);
}
END_TEST

/* One in a hundred pixels may be at an edge: here 9. */
START_TEST(test_edges)
{
    Pair pair;
    make_pair(&pair);
    for (int i = 0; i < 9; i++)
        memset(pixel_of(&pair.theirs, 5, 6 + i), 0, sizeof(float[4]));
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.edge, 9);
    ck_assert(pair.figures.agree);
    memset(pixel_of(&pair.theirs, 5, 6 + 9), 0, sizeof(float[4]));
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.edge, 10);
    ck_assert(!pair.figures.agree);
    free_pair(&pair);
}
END_TEST

/* In a small image nothing may be beyond. */
START_TEST(test_small)
{
    float theirs[4] = {0.5f, 0.5f, 0.5f, 1.0f}, reference[4] = {0.6f, 0.5f, 0.5f, 1.0f};
    Image a = {1, 1, FORMAT_RGBA32F, theirs}, b = {1, 1, FORMAT_RGBA32F, reference};
    JudgeDesc desc = {.theirs = &a,
                      .reference = &b,
                      .encoding = GIVEN_LINEAR,
                      .format = FORMAT_RGBA32F,
                      .reference_format = FORMAT_RGBA32F,
                      .channels = 4,
                      .tolerance = 1e-4};
    JudgeFigures figures;
    ck_assert_int_eq(judge(&desc, &figures), RESULT_OK);
    ck_assert_uint_eq(figures.beyond, 1);
    ck_assert(!figures.agree);
}
END_TEST

/* 8 bits of the display: half a step, and what the tolerance moves; the reference's own codes are
 * equal, whatever the exact value is. */
START_TEST(test_quantisation)
{
    Pair pair;
    Image display;
    make_pair(&pair);
    ck_assert_int_eq(image_create(SIDE, SIDE, FORMAT_RGBA8, &display), RESULT_OK);
    pair.desc.encoding = GIVEN_SEED;
    pair.desc.format = FORMAT_RGBA8;
    pair.desc.channels = 3;
    for (size_t i = 0; i < SIDE * SIDE; i++)
        for (size_t c = 0; c < 3; c++) {
            double value =
                given_encode(GIVEN_SEED, (double)((float *)pair.reference.pixels)[4 * i + c]);
            uint8_t code = (uint8_t)lrint(255.0 * value);
            ((uint8_t *)display.pixels)[4 * i + c] = code;
            ((float *)pair.theirs.pixels)[4 * i + c] = (float)code / 255.0f;
        }
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.stored + pair.figures.equal, SIDE * SIDE);
    ck_assert_uint_ge(pair.figures.stored, 900);
    pair.desc.display = &display;
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.equal, SIDE * SIDE);
    /* One code more is not explained. */
    for (int i = 0; i < 20; i++)
        pixel_of(&pair.theirs, 10 + i, 20)[1] += 1.0f / 255.0f;
    pair.desc.tolerance = 1e-7;
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.equal, SIDE * SIDE - 20);
    ck_assert_uint_eq(pair.figures.stored + pair.figures.within, 0);
    image_free(&display);
    free_pair(&pair);
}
END_TEST

/* With bounds the values are to be near the centre, not the reference; where there is none, near
 * the reference. */
START_TEST(test_bounds)
{
    Pair pair;
    make_pair(&pair);
    Image center = make_image(), slack = make_image();
    for (size_t i = 0; i < SIDE * SIDE * 4; i++) {
        ((float *)center.pixels)[i] += 0.01f;
        ((float *)slack.pixels)[i] = 0.002f;
        ((float *)pair.theirs.pixels)[i] += 0.011f;
    }
    pair.desc.center = &center;
    pair.desc.slack = &slack;
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.within, SIDE * SIDE);
    for (size_t i = 0; i < SIDE * SIDE * 4; i++)
        ((float *)slack.pixels)[i] = INFINITY;
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.within, 0);
    image_free(&center);
    image_free(&slack);
    free_pair(&pair);
}
END_TEST

/* What is no number is counted, differs, and spoils no average. */
START_TEST(test_nonfinite)
{
    Pair pair;
    make_pair(&pair);
    pixel_of(&pair.theirs, 20, 20)[0] = NAN;
    pixel_of(&pair.theirs, 21, 20)[1] = INFINITY;
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.nonfinite, 2);
    ck_assert_uint_eq(pair.figures.beyond, 2);
    ck_assert(!pair.figures.agree);
    ck_assert_double_eq(pair.figures.max_abs, 0.0);
    ck_assert_double_eq(pair.figures.rmse, 0.0);
    ck_assert(pair.figures.worst.is && pair.figures.worst.ulp < 0.0);
    /* The same on both sides is the same. */
    pixel_of(&pair.reference, 20, 20)[0] = NAN;
    pixel_of(&pair.reference, 21, 20)[1] = INFINITY;
    judge_pair(&pair);
    ck_assert_uint_eq(pair.figures.nonfinite, 0);
    ck_assert_uint_eq(pair.figures.equal, SIDE * SIDE);
    free_pair(&pair);
}
END_TEST

/* Another picture is told from a wrong one. */
START_TEST(test_correlation)
{
    Pair pair;
    make_pair(&pair);
    for (size_t i = 0; i < SIDE * SIDE * 4; i++)
        ((float *)pair.theirs.pixels)[i] *= 0.5f;
    judge_pair(&pair);
    ck_assert_double_gt(pair.figures.correlation, 0.99);
    for (size_t i = 0; i < SIDE * SIDE * 4; i++)
        ((float *)pair.theirs.pixels)[i] = 1.0f - ((float *)pair.reference.pixels)[i];
    judge_pair(&pair);
    ck_assert_double_lt(pair.figures.correlation, -0.99);
    ck_assert(!pair.figures.agree);
    free_pair(&pair);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("judge");
    TCase *tests = tcase_create("judge");
    tcase_add_test(tests, test_classes);
    tcase_add_test(tests, test_edges);
    tcase_add_test(tests, test_small);
    tcase_add_test(tests, test_quantisation);
    tcase_add_test(tests, test_bounds);
    tcase_add_test(tests, test_nonfinite);
    tcase_add_test(tests, test_correlation);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

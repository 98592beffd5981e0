/* compare/metrics.h: figures computed by hand. */
#include "testing.h"

#include "compare/metrics.h"

#include <math.h>

START_TEST(test_buffer_float)
{
    float a[2][3][4] = {0}, b[2][3][4] = {0};
    BufferMetrics metrics = {0};
    metrics_buffer(&metrics, FORMAT_RGBA32F, 0, 0, 3, 2, a, sizeof a[0], b, sizeof b[0]);
    ck_assert_uint_eq(metrics.values, 24);
    ck_assert_uint_eq(metrics.differing, 0);
    ck_assert(!metrics.has_first);

    b[1][2][1] = -0.0f;                  /* 1 ULP, no difference in value */
    b[1][2][3] = 0.25f;                  /* far in ULP */
    a[1][1][0] = NAN, b[1][1][0] = -NAN; /* equal, whatever the NaN */
    a[0][0][2] = NAN;                    /* and a NaN against a number */
    metrics = (BufferMetrics){0};
    metrics_buffer(&metrics, FORMAT_RGBA32F, 10, 20, 3, 2, a, sizeof a[0], b, sizeof b[0]);
    ck_assert_uint_eq(metrics.differing, 3);
    ck_assert_uint_eq(metrics.max_ulp, UINT32_MAX);
    ck_assert_double_eq(metrics.max_abs, 0.25);
    ck_assert_int_eq(metrics.first[0], 10);
    ck_assert_int_eq(metrics.first[1], 20);
    ck_assert_int_eq(metrics.first[2], 2);
}
END_TEST

/* Rectangles of a larger buffer add up; the first difference stays. */
START_TEST(test_buffer_rectangles)
{
    uint8_t a[4][4][4] = {0}, b[4][4][4] = {0};
    b[1][3][2] = 51;
    b[3][0][0] = 255;
    BufferMetrics metrics = {0};
    for (int y = 0; y < 4; y += 2)
        for (int x = 0; x < 4; x += 2)
            metrics_buffer(&metrics, FORMAT_RGBA8, x, y, 2, 2, a[y][x], sizeof a[0], b[y][x],
                           sizeof b[0]);
    ck_assert_uint_eq(metrics.values, 64);
    ck_assert_uint_eq(metrics.differing, 2);
    ck_assert_uint_eq(metrics.max_ulp, 255);
    ck_assert_double_eq(metrics.max_abs, 1.0); /* unorm in [0, 1] */
    ck_assert_int_eq(metrics.first[0], 3);
    ck_assert_int_eq(metrics.first[1], 1);
    ck_assert_int_eq(metrics.first[2], 2);
}
END_TEST

START_TEST(test_buffer_formats)
{
    static const struct {
        PixelFormat format;
        uint32_t a, b, ulp;
        double abs;
    } rows[] = {
        {FORMAT_D24, 0, 0xffffff, 0xffffff, 1.0},
        {FORMAT_D32F, 0x3f800000, 0x3f7fffff, 1, 0x1p-24},
        {FORMAT_R32UI, 3, 10, 7, 7.0},
        {FORMAT_RGBA16, 0xffff, 0, 65535, 1.0},      /* the first of two words */
        {FORMAT_RGBA16F, 0x3c00, 0x4000, 1024, 1.0}, /* 1 and 2 */
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        uint32_t a[2] = {rows[i].a, 0}, b[2] = {rows[i].b, 0};
        BufferMetrics metrics = {0};
        metrics_buffer(&metrics, rows[i].format, 0, 0, 1, 1, a, sizeof a, b, sizeof b);
        ck_assert_uint_eq(metrics.differing, 1);
        ck_assert_uint_eq(metrics.max_ulp, rows[i].ulp);
        ck_assert_double_eq(metrics.max_abs, rows[i].abs);
    }
}
END_TEST

static Image image_of(int width, int height, float *pixels)
{
    return (Image){width, height, FORMAT_RGBA32F, pixels};
}

START_TEST(test_final)
{
    float a[4][4] = {{0}}, b[4][4] = {{0}};
    Image image_a = image_of(2, 2, a[0]), image_b = image_of(2, 2, b[0]);
    FinalMetrics metrics;
    metrics_final(&image_a, &image_b, &metrics);
    ck_assert_uint_eq(metrics.pixels, 4);
    ck_assert_uint_eq(metrics.differing, 0);
    ck_assert(isinf(metrics.psnr));

    a[0][0] = 0.5f;
    b[1][3] = 0.25f;
    metrics_final(&image_a, &image_b, &metrics);
    ck_assert_uint_eq(metrics.differing, 2);
    ck_assert_double_eq(metrics.max_abs, 0.5);
    ck_assert_double_eq(metrics.mean_abs, 0.75 / 16);
    ck_assert_double_eq(metrics.rmse, sqrt(0.3125 / 16));
    ck_assert_double_eq_tol(metrics.psnr, 10 * log10(16 / 0.3125), 1e-9);

    /* A pixel that is not finite is counted and left out of the averages. */
    a[2][1] = INFINITY;
    b[3][0] = NAN;
    metrics_final(&image_a, &image_b, &metrics);
    ck_assert_uint_eq(metrics.differing, 4);
    ck_assert_uint_eq(metrics.nonfinite, 2);
    ck_assert_double_eq(metrics.max_abs, 0.5);
    ck_assert_double_eq(metrics.mean_abs, 0.75 / 8);
    ck_assert_uint_eq(metrics.max_ulp, UINT32_MAX);
    /* Equal infinities do not differ, and have no difference. */
    b[2][1] = INFINITY;
    metrics_final(&image_a, &image_b, &metrics);
    ck_assert_uint_eq(metrics.differing, 3);
    ck_assert_uint_eq(metrics.nonfinite, 2);
}
END_TEST

/* Where nothing is finite there is no average, and no "equal" either. */
START_TEST(test_final_nothing_finite)
{
    float a[4] = {NAN, 0, 0, 0}, b[4] = {0};
    Image image_a = image_of(1, 1, a), image_b = image_of(1, 1, b);
    FinalMetrics metrics;
    metrics_final(&image_a, &image_b, &metrics);
    ck_assert_uint_eq(metrics.differing, 1);
    ck_assert_uint_eq(metrics.nonfinite, 1);
    ck_assert_double_eq(metrics.mean_abs, 0.0);
    ck_assert(isnan(metrics.psnr));
}
END_TEST

/* The 99th percentile by nearest rank: of n values the ⌈0.99 n⌉-th. */
START_TEST(test_percentile)
{
    static const struct {
        int pixels, rank;
    } rows[] = {{1, 1}, {2, 2}, {99, 99}, {100, 99}, {101, 100}, {200, 198}, {201, 199}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        static float a[201][4], b[201][4];
        uint8_t mask[201];
        for (int p = 0; p < rows[i].pixels; p++) {
            mask[p] = 1;
            a[p][p % 4] = (float)(rows[i].pixels - p) * 0x1p-10f; /* n … 1, in descending order */
        }
        Image image_a = image_of(rows[i].pixels, 1, a[0]);
        Image image_b = image_of(rows[i].pixels, 1, b[0]);
        UnaffectedMetrics metrics;
        ck_assert_int_eq(metrics_unaffected(&image_a, &image_b, mask, &metrics), RESULT_OK);
        ck_assert_uint_eq(metrics.pixels, (uint64_t)rows[i].pixels);
        ck_assert_double_eq(metrics.p99_rel, rows[i].rank * 0x1p-10);
        ck_assert_double_eq(metrics.p999_rel, rows[i].pixels * 0x1p-10);
        ck_assert_double_eq(metrics.max_rel, rows[i].pixels * 0x1p-10);
        memset(a, 0, sizeof a);
    }
}
END_TEST

START_TEST(test_unaffected)
{
    float a[4][4] = {{3, 0, 0, 1}, {9, 0, 0, 1}, {NAN, 0, 0, 1}, {0.5f, 0, 0, 1}};
    float b[4][4] = {{4, 0, 0, 1}, {0, 0, 0, 1}, {0, 0, 0, 1}, {0, 0, 0, 1}};
    const uint8_t mask[4] = {1, 0, 1, 1}, none[4] = {0};
    Image image_a = image_of(4, 1, a[0]), image_b = image_of(4, 1, b[0]);
    UnaffectedMetrics metrics;
    ck_assert_int_eq(metrics_unaffected(&image_a, &image_b, mask, &metrics), RESULT_OK);
    ck_assert_uint_eq(metrics.pixels, 2);
    ck_assert_double_eq(metrics.max_abs, 1.0);
    ck_assert_double_eq(metrics.max_rel, 0.5); /* 1/4 relative to b = 4; 0.5 relative to 1 */
    ck_assert_int_eq(metrics_unaffected(&image_a, &image_b, none, &metrics), RESULT_OK);
    ck_assert_uint_eq(metrics.pixels, 0);
    ck_assert_double_eq(metrics.p99_rel, 0.0);
}
END_TEST

/* Of 200 pixels that differ by 1/1024, 2/1024, … the 198th; what is not finite counts as most. */
START_TEST(test_p99)
{
    enum {
        PIXELS = 200
    };
    static float a[PIXELS][4], b[PIXELS][4];
    double p99;
    for (int p = 0; p < PIXELS; p++)
        a[p][p % 4] = (float)((p * 77) % PIXELS + 1) * (p % 2 ? 0x1p-10f : -0x1p-10f);
    Image image_a = image_of(PIXELS, 1, a[0]), image_b = image_of(PIXELS, 1, b[0]);
    ck_assert_int_eq(metrics_p99(&image_a, &image_b, &p99), RESULT_OK);
    ck_assert_double_eq(p99, 198 * 0x1p-10);
    b[0][1] = NAN;
    b[1][2] = INFINITY;
    ck_assert_int_eq(metrics_p99(&image_a, &image_b, &p99), RESULT_OK);
    ck_assert_double_eq(p99, 200 * 0x1p-10);
    b[2][2] = NAN;
    ck_assert_int_eq(metrics_p99(&image_a, &image_b, &p99), RESULT_OK);
    ck_assert(isinf(p99));
}
END_TEST

/* Neither many background pixels hide a few wrong fragments, nor the other way round. */
START_TEST(test_background)
{
    enum {
        PIXELS = 1000,
        FEW = 5
    };
    for (int wrong_background = 0; wrong_background < 2; wrong_background++) {
        static float a[PIXELS][4], b[PIXELS][4];
        uint8_t same[PIXELS];
        memset(a, 0, sizeof a);
        for (int p = 0; p < PIXELS; p++)
            same[p] = p < FEW ? STRUCTURE_SAME : STRUCTURE_EMPTY;
        if (wrong_background)
            for (int p = FEW; p < PIXELS; p += 50)
                a[p][1] = 0.25f;
        else
            a[FEW - 1][0] = 0.25f;
        Image image_a = image_of(PIXELS, 1, a[0]), image_b = image_of(PIXELS, 1, b[0]);
        UnaffectedMetrics metrics;
        ck_assert_int_eq(metrics_unaffected(&image_a, &image_b, same, &metrics), RESULT_OK);
        ck_assert_uint_eq(metrics.pixels, PIXELS);
        ck_assert_uint_eq(metrics.occupied, FEW);
        ck_assert_double_eq(metrics.p99_rel, 0.25);
    }
}
END_TEST

/* Errors within, at and beyond their bounds; pixels without bound or in another order. */
START_TEST(test_bound)
{
    float a[6][4] = {{1, 0, 0, 1}, {2, 0, 0, 1}, {0, 4, 0, 1},
                     {9, 0, 0, 1}, {9, 0, 0, 1}, {NAN, 0, 0, 1}};
    float b[6][4] = {{1, 0, 0, 1}, {1, 0, 0, 1}, {0, 2, 0, 1},
                     {0, 0, 0, 1}, {0, 0, 0, 1}, {0, 0, 0, 1}};
    float most[6][4] = {{0, 0, 0, 0}, {4, 0, 0, 0},        {0, 2, 0, 0},
                        {8, 0, 0, 0}, {INFINITY, 0, 0, 0}, {1, 0, 0, 0}};
    float own[6][4] = {{1, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}, {1, 2, 0, 0}, {0}, {0, 0, 0, 1}};
    const uint8_t same[6] = {STRUCTURE_SAME,    STRUCTURE_SAME, STRUCTURE_SAME,
                             STRUCTURE_DIFFERS, STRUCTURE_SAME, STRUCTURE_EMPTY};
    Image ref = image_of(6, 1, a[0]);
    Frame truth = {.final = image_of(6, 1, b[0]),
                   .bound = image_of(6, 1, most[0]),
                   .rounding = image_of(6, 1, own[0])};
    BoundMetrics metrics;
    ck_assert_int_eq(metrics_bound(&ref, &truth, same, &metrics), RESULT_OK);
    ck_assert_uint_eq(metrics.pixels, 4);
    ck_assert_uint_eq(metrics.exceeded, 0);
    ck_assert_uint_eq(metrics.unbounded, 1);
    ck_assert_double_eq(metrics.max_ratio, 1.0);
    ck_assert_double_eq(metrics.median_ratio, 0.0);
    ck_assert_double_eq(metrics.p99_ratio, 1.0);
    ck_assert_double_eq(metrics.median, 2.0);
    ck_assert_double_eq(metrics.rounding_median, 1.0);
    most[2][1] = nextafterf(2, 0);
    a[0][2] = 1e-30f; /* any error is beyond a bound of 0 */
    a[4][1] = NAN;
    ck_assert_int_eq(metrics_bound(&ref, &truth, same, &metrics), RESULT_OK);
    ck_assert_uint_eq(metrics.exceeded, 3);
    ck_assert_int_eq(metrics.first[0], 0);
    ck_assert_int_eq(metrics.first[1], 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("metrics");
    TCase *tcase = tcase_create("metrics");
    tcase_add_test(tcase, test_buffer_float);
    tcase_add_test(tcase, test_buffer_rectangles);
    tcase_add_test(tcase, test_buffer_formats);
    tcase_add_test(tcase, test_final);
    tcase_add_test(tcase, test_final_nothing_finite);
    tcase_add_test(tcase, test_percentile);
    tcase_add_test(tcase, test_unaffected);
    tcase_add_test(tcase, test_p99);
    tcase_add_test(tcase, test_background);
    tcase_add_test(tcase, test_bound);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

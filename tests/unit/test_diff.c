/* compare/diff.h: figures computed by hand. */
#include "testing.h"

#include "compare/diff.h"

#include <float.h>
#include <math.h>

/* An image of one row: channels of stored values, in the caller's arrays. */
typedef struct Row {
    Planes planes;
    Plane channels[6];
    char names[6][16];
} Row;

static void add_bits(Row *row, const char *name, FormatKind kind, uint32_t unorm_max,
                     uint32_t *bits)
{
    int at = row->planes.count++;
    strcpy(row->names[at], name);
    row->channels[at] = (Plane){row->names[at], kind, unorm_max, bits};
    row->planes.planes = row->channels;
    row->planes.height = 1;
}

static uint32_t *float_bits(const float *values, int count)
{
    uint32_t *bits = calloc((size_t)count, sizeof *bits);
    for (int i = 0; i < count; i++)
        bits[i] = testing_bits(values[i]);
    return bits;
}

/* One channel of floats on both sides. */
static DiffPart diff_floats(const float *a, const float *b, int count, const DiffOptions *options)
{
    Row row_a = {.planes = {.width = count}}, row_b = row_a;
    DiffPart part;
    add_bits(&row_a, "R", KIND_FLOAT, 0, float_bits(a, count));
    add_bits(&row_b, "R", KIND_FLOAT, 0, float_bits(b, count));
    ck_assert_int_eq(diff_planes(&row_a.planes, &row_b.planes, options, &part), RESULT_OK);
    free(row_a.channels[0].bits);
    free(row_b.channels[0].bits);
    return part;
}

/* One channel of any kind on each side, without tolerance. */
static DiffPart diff_bits(FormatKind kind_a, uint32_t max_a, uint32_t a, FormatKind kind_b,
                          uint32_t max_b, uint32_t b)
{
    Row row_a = {.planes = {.width = 1}}, row_b = row_a;
    DiffOptions options = diff_options_default();
    DiffPart part;
    add_bits(&row_a, "R", kind_a, max_a, &a);
    add_bits(&row_b, "R", kind_b, max_b, &b);
    ck_assert_int_eq(diff_planes(&row_a.planes, &row_b.planes, &options, &part), RESULT_OK);
    return part;
}

START_TEST(test_figures)
{
    const float a[4] = {0.0f, 1.0f, 2.0f, 3.0f}, b[4] = {0.0f, 1.5f, 2.0f, 2.0f};
    DiffOptions options = diff_options_default();
    options.worst = 5;
    DiffPart part = diff_floats(a, b, 4, &options);
    ck_assert_int_eq(part.verdict, DIFF_FAILURE);
    ck_assert_uint_eq(part.pixels, 4);
    ck_assert_uint_eq(part.differing, 2);
    ck_assert_uint_eq(part.over_fail, 2);
    ck_assert_uint_eq(part.over_warn, 2);
    ck_assert_double_eq(part.mean, 1.5 / 4);
    ck_assert_double_eq(part.rms, sqrt(1.25 / 4));
    ck_assert_double_eq_tol(part.psnr, 20 * log10(3 / sqrt(1.25 / 4)), 1e-12);
    ck_assert_double_eq(part.max, 1.0);
    ck_assert_int_eq(part.max_at.x, 3);
    ck_assert_int_eq(part.first[0], 1);
    ck_assert_double_eq(part.max_at.values[0][0], 3.0);
    ck_assert_double_eq(part.max_at.values[1][0], 2.0);
    ck_assert_int_eq(part.worst_count, 2);
    ck_assert_int_eq(part.worst[0].x, 3);
    ck_assert_int_eq(part.worst[1].x, 1);
    ck_assert_double_eq(part.worst[1].values[1][0], 1.5);
    ck_assert_float_eq(part.errors[1], 0.5f);
    ck_assert_uint_eq(part.flags[1], DIFF_DIFFERS | DIFF_OVER_WARN | DIFF_OVER_FAIL);
    ck_assert_uint_eq(part.flags[0], 0);
    ck_assert_uint_eq(part.channels[0].max_ulp, 0x400000); /* 1 to 1.5, and 2 to 3 */
    ck_assert_uint_eq(part.channels[0].bins[0], 2);
    ck_assert_uint_eq(part.channels[0].bins[DIFF_BINS - 1], 2);
    diff_part_free(&part);
}
END_TEST

/* What is below 1 has the peak 1. */
START_TEST(test_equal)
{
    const float a[2] = {0.25f, 0.5f}, b[2] = {0.25f, 0.25f};
    DiffOptions options = diff_options_default();
    DiffPart part = diff_floats(a, a, 2, &options);
    ck_assert_int_eq(part.verdict, DIFF_PASS);
    ck_assert(isinf(part.psnr));
    ck_assert_uint_eq(part.differing, 0);
    ck_assert(!part.channels[0].has_max);
    diff_part_free(&part);
    part = diff_floats(a, b, 2, &options);
    ck_assert_double_eq_tol(part.psnr, -20 * log10(sqrt(0.0625 / 2)), 1e-12);
    diff_part_free(&part);
}
END_TEST

/* Counted, out of the averages, equal to itself, and a failure against anything else. */
START_TEST(test_not_finite)
{
    const float inf = INFINITY;
    const float a[] = {NAN, NAN, inf, -inf, inf, inf, 1.0f, 0.5f};
    const float b[] = {-NAN, 1.0f, inf, -inf, -inf, NAN, 1.0f, 0.25f};
    DiffOptions options = diff_options_default();
    options.fail = (DiffThreshold){.absolute = 10, .percent = 100, .allowed = 100, .hard = 1e30};
    options.warn = options.fail;
    options.worst = 8;
    DiffPart part = diff_floats(a, b, 8, &options);
    const DiffChannel *channel = &part.channels[0];
    ck_assert_uint_eq(channel->nan[0], 2);
    ck_assert_uint_eq(channel->nan[1], 2);
    ck_assert_uint_eq(channel->infinite[0], 4);
    ck_assert_uint_eq(channel->infinite[1], 3);
    ck_assert_uint_eq(part.nonfinite[0], 6);
    ck_assert_uint_eq(part.broken, 3); /* NaN and 1, inf and -inf, inf and NaN */
    ck_assert_uint_eq(channel->finite, 2);
    ck_assert_double_eq(part.mean, 0.125);
    ck_assert_double_eq(part.max, 0.25);
    ck_assert_uint_eq(channel->differing, 4);
    ck_assert_uint_eq(part.over_fail, 3);
    ck_assert_int_eq(part.verdict, DIFF_FAILURE);
    ck_assert_int_eq(part.worst_count, 4);
    ck_assert_int_eq(part.worst[0].x, 1);
    ck_assert(isinf(part.worst[2].error));
    ck_assert_int_eq(part.worst[3].x, 7);
    ck_assert(!part.worst[0].has_ulp && part.worst[1].has_ulp && !part.worst[1].counts);
    ck_assert(isnan(part.errors[1]));
    ck_assert_float_eq(part.errors[2], 0.0f);
    uint64_t binned = 0;
    for (int bin = 0; bin < DIFF_BINS; bin++)
        binned += channel->bins[bin];
    ck_assert_uint_eq(binned, 6); /* not NaN against a number, nor against infinity */
    diff_part_free(&part);

    part = diff_floats(a, b, 1, &options);
    ck_assert_int_eq(part.verdict, DIFF_PASS);
    ck_assert_double_eq(part.mean, 0.0);
    diff_part_free(&part);
    part = diff_floats(a + 1, b + 1, 1, &options);
    ck_assert(isnan(part.mean)); /* nothing to average is not "equal" */
    ck_assert(isnan(part.psnr));
    diff_part_free(&part);
}
END_TEST

/* No error, or none to speak of, is no difference in value; the stored values still differ. */
START_TEST(test_zeros_and_denormals)
{
    const float least = 0x1p-149f;
    const float a[] = {0.0f, least, least, -least, 0x1p-126f};
    const float b[] = {-0.0f, 0.0f, least, least, 0x1p-126f - 0x1p-149f};
    DiffOptions options = diff_options_default();
    DiffPart part = diff_floats(a, b, 5, &options);
    ck_assert_int_eq(part.verdict, DIFF_PASS);
    ck_assert_uint_eq(part.differing, 4);
    ck_assert_uint_eq(part.over_fail, 0);
    ck_assert_double_eq(part.max, 0x1p-148);
    ck_assert_uint_eq(part.channels[0].max_ulp, 3); /* -least, -0, 0, least */
    ck_assert_uint_eq(part.channels[0].bins[0], 1);
    ck_assert_uint_eq(part.channels[0].bins[1], 3);
    ck_assert_uint_eq(part.channels[0].bins[2], 1);
    diff_part_free(&part);

    options.fail.absolute = options.warn.absolute = 0.0;
    part = diff_floats(a, b, 5, &options);
    ck_assert_uint_eq(part.over_fail, 3); /* 0 and -0 are one number */
    diff_part_free(&part);
    ck_assert_int_eq(part.channel_count, 0);
}
END_TEST

START_TEST(test_stored)
{
    static const struct {
        FormatKind kind_a;
        uint32_t max_a, a;
        FormatKind kind_b;
        uint32_t max_b, b;
        uint32_t ulp;
        double error;
    } rows[] = {
        {KIND_HALF, 0, 0x3c00, KIND_HALF, 0, 0x3c01, 1, 0x1p-10},
        {KIND_HALF, 0, 0x8000, KIND_HALF, 0, 0x0000, 1, 0.0},
        {KIND_HALF, 0, 0x0001, KIND_HALF, 0, 0x8001, 3, 0x1p-23},
        {KIND_UNORM, 255, 51, KIND_UNORM, 255, 0, 51, 0.2f},
        {KIND_UNORM, 65535, 65535, KIND_UNORM, 65535, 65533, 2, 1.0 - (double)(65533 / 65535.0f)},
        {KIND_UNORM, 0xffffff, 0xffffff, KIND_UNORM, 0xffffff, 0, 0xffffff, 1.0},
        {KIND_UINT, 0, UINT32_MAX, KIND_UINT, 0, 1, UINT32_MAX - 1, UINT32_MAX - 1.0},
        /* Of two kinds: as floats. */
        {KIND_UNORM, 255, 255, KIND_UNORM, 65535, 65535, 0, 0.0},
        {KIND_UNORM, 255, 255, KIND_FLOAT, 0, 0x3f7fffff, 1, 0x1p-24},
        {KIND_HALF, 0, 0x3c00, KIND_FLOAT, 0, 0x3f800000, 0, 0.0},
        {KIND_HALF, 0, 0x0001, KIND_FLOAT, 0, 0x33800001, 1, 0x1p-47},
        /* The same float, and another value. */
        {KIND_UINT, 0, 16777217, KIND_FLOAT, 0, 0x4b800000, 0, 1.0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        DiffPart part = diff_bits(rows[i].kind_a, rows[i].max_a, rows[i].a, rows[i].kind_b,
                                  rows[i].max_b, rows[i].b);
        ck_assert_uint_eq(part.channels[0].max_ulp, rows[i].ulp);
        ck_assert_double_eq(part.max, rows[i].error);
        ck_assert_uint_eq(part.differing, rows[i].ulp != 0 || rows[i].error > 0.0);
        ck_assert_uint_eq(part.channels[0].differing, part.differing);
        diff_part_free(&part);
    }
}
END_TEST

START_TEST(test_bins)
{
    static const struct {
        uint32_t ulp;
        int bin;
    } rows[] = {{0, 0},  {1, 1},   {2, 2},   {3, 2},     {4, 3},     {15, 3},
                {16, 4}, {255, 4}, {256, 5}, {65535, 5}, {65536, 6}, {1 << 30, 6}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        DiffPart part = diff_bits(KIND_FLOAT, 0, 0, KIND_FLOAT, 0, rows[i].ulp);
        ck_assert_uint_eq(part.channels[0].bins[rows[i].bin], 1);
        diff_part_free(&part);
    }
}
END_TEST

static DiffVerdict verdict(const DiffOptions *options)
{
    static const float a[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    static const float b[8] = {1, 1, 1, 1, 1, 1.25f, 1.25f, 1.5f};
    DiffPart part = diff_floats(a, b, 8, options);
    DiffVerdict is = part.verdict;
    diff_part_free(&part);
    return is;
}

START_TEST(test_thresholds)
{
    DiffOptions options = diff_options_default();
    ck_assert_int_eq(verdict(&options), DIFF_FAILURE);
    options.fail.absolute = 0.5; /* not exceeded */
    ck_assert_int_eq(verdict(&options), DIFF_PASS);
    options.warn_always = true;
    ck_assert_int_eq(verdict(&options), DIFF_WARNING);
    options.warn_always = false;
    options.fail.absolute = 0.4; /* exceeded by one */
    options.fail.allowed = 1;
    ck_assert_int_eq(verdict(&options), DIFF_WARNING);
    options.fail.absolute = 0.5;
    options.warn_always = true;
    options.warn.absolute = 0.25;
    options.warn.percent = 12.5; /* one of eight is over: not exceeded */
    ck_assert_int_eq(verdict(&options), DIFF_PASS);
    options.warn.percent = 12.4;
    ck_assert_int_eq(verdict(&options), DIFF_WARNING);
    options.warn.allowed = 1;
    ck_assert_int_eq(verdict(&options), DIFF_PASS);
    options.warn.hard = 0.4;
    ck_assert_int_eq(verdict(&options), DIFF_WARNING);
    options.fail.hard = 0.5;
    ck_assert_int_eq(verdict(&options), DIFF_WARNING);
    options.fail.hard = 0.49;
    ck_assert_int_eq(verdict(&options), DIFF_FAILURE);

    options = diff_options_default();
    options.fail.relative = 0.2; /* 0.25 of 1.125 is more; both must be exceeded */
    ck_assert_int_eq(verdict(&options), DIFF_FAILURE);
    options.fail.relative = options.warn.relative = 0.41; /* 0.5 of 1.25 is 0.4 */
    ck_assert_int_eq(verdict(&options), DIFF_PASS);
    options.fail.relative = 0.39;
    ck_assert_int_eq(verdict(&options), DIFF_FAILURE);
    options.fail.absolute = 0.5;
    ck_assert_int_eq(verdict(&options), DIFF_PASS);
}
END_TEST

/* By name, whatever the order; what one side lacks is 0 there and has no distance. */
START_TEST(test_channels)
{
    const float one[] = {1.0f}, two[] = {2.0f};
    uint32_t *a = float_bits(one, 1), *b = float_bits(two, 1);
    Row row_a = {.planes = {.width = 1}}, row_b = row_a;
    DiffOptions options = diff_options_default();
    DiffPart part;
    add_bits(&row_a, "R", KIND_FLOAT, 0, a);
    add_bits(&row_a, "G", KIND_FLOAT, 0, b);
    add_bits(&row_b, "G", KIND_FLOAT, 0, b);
    add_bits(&row_b, "Z", KIND_FLOAT, 0, b);
    ck_assert_int_eq(diff_planes(&row_a.planes, &row_b.planes, &options, &part), RESULT_OK);
    ck_assert_int_eq(part.channel_count, 3);
    ck_assert_str_eq(part.channels[0].name, "R");
    ck_assert_ptr_null(part.channels[0].kinds[1]);
    ck_assert(!part.channels[0].has_ulp);
    ck_assert_double_eq(part.channels[0].max, 1.0);
    ck_assert_double_eq(part.channels[1].max, 0.0);
    ck_assert_str_eq(part.channels[2].name, "Z");
    ck_assert_ptr_null(part.channels[2].kinds[0]);
    ck_assert_double_eq(part.mean, 1.0);
    diff_part_free(&part);

    /* Ids beside colours: other ids are over, but their numbers are no error. */
    uint32_t ids[2] = {7, 1000007};
    row_a.planes.count = row_b.planes.count = 0;
    add_bits(&row_a, "R", KIND_FLOAT, 0, a);
    add_bits(&row_b, "R", KIND_FLOAT, 0, a);
    add_bits(&row_a, "ID", KIND_UINT, 0, &ids[0]);
    add_bits(&row_b, "ID", KIND_UINT, 0, &ids[1]);
    ck_assert_int_eq(diff_planes(&row_a.planes, &row_b.planes, &options, &part), RESULT_OK);
    ck_assert_double_eq(part.max, 0.0);
    ck_assert_double_eq(part.mean, 0.0);
    ck_assert_double_eq(part.channels[1].max, 1e6);
    ck_assert_int_eq(part.verdict, DIFF_FAILURE);
    diff_part_free(&part);
    /* Where so many may fail, they are held against the hard limit all the same. */
    options.fail.percent = 100;
    for (int i = 0; i < 2; i++) {
        options.fail.hard = i ? 1e6 : 1e6 - 1;
        ck_assert_int_eq(diff_planes(&row_a.planes, &row_b.planes, &options, &part), RESULT_OK);
        ck_assert(i == (part.verdict != DIFF_FAILURE));
        diff_part_free(&part);
    }
    free(a);
    free(b);
}
END_TEST

/* More pixels than are kept, and than are kept before sorting: the greatest, ties as they lie. */
START_TEST(test_worst)
{
    enum {
        COUNT = 100
    };
    float a[COUNT] = {0}, b[COUNT];
    DiffOptions options = diff_options_default();
    for (int i = 0; i < COUNT; i++)
        b[i] = (float)(i * 37 % COUNT / 2);
    for (int keep = 0; keep <= 3; keep++) {
        options.worst = keep;
        DiffPart part = diff_floats(a, b, COUNT, &options);
        ck_assert_int_eq(part.worst_count, keep);
        for (int i = 0; i < keep; i++)
            ck_assert_double_eq(part.worst[i].error, (COUNT - 1 - i) / 2);
        if (keep > 1)
            ck_assert_int_lt(part.worst[0].x, part.worst[1].x);
        diff_part_free(&part);
    }
}
END_TEST

static DeepImage deep_row(const uint32_t *counts, DeepSample *samples, int width)
{
    DeepImage image;
    DeepSample *room;
    uint32_t total = 0;
    for (int x = 0; x < width; x++)
        total += counts[x];
    ck_assert_int_eq(deep_create(width, 1, 1 << 20, &image), RESULT_OK);
    ck_assert_int_eq(deep_block(&image, total, &room), RESULT_OK);
    memcpy(room, samples, total * sizeof *room);
    for (int x = 0; x < width; x++) {
        deep_set(&image, x, 0, room, counts[x]);
        room += counts[x];
    }
    return image;
}

START_TEST(test_deep)
{
    DeepSample a[4] = {{.z = 1, .primitive = 5}, {.z = 2}, {.z = 3}, {.z = 4}}, b[4];
    const uint32_t counts_a[3] = {1, 2, 1}, counts_b[3] = {1, 1, 2};
    DiffOptions options = diff_options_default();
    DiffPart part;
    options.worst = 3;
    for (int i = 0; i < 4; i++)
        a[i].material = DEEP_NO_ID;
    memcpy(b, a, sizeof b);
    b[2].rgba[1] = 0.5f;
    DeepImage image_a = deep_row(counts_a, a, 3), image_b = deep_row(counts_a, b, 3);
    image_a.missing[DEEP_DEPTH] = image_b.missing[DEEP_MATERIAL] = true;
    image_b.left_out = strdup("ZBack");
    ck_assert_int_eq(diff_deep(&image_a, &image_b, NULL, &options, &part), RESULT_OK);
    ck_assert_int_eq(part.channel_count, 6); /* there is no window depth and no material */
    ck_assert_str_eq(part.channels[5].name, "primitiveid");
    ck_assert_uint_eq(part.channels[0].values, 4);
    ck_assert_double_eq(part.max, 0.5);
    ck_assert_int_eq(part.max_at.x, 1);
    ck_assert_uint_eq(part.max_at.sample, 1);
    ck_assert_double_eq(part.max_at.values[0][0], 3.0);
    ck_assert_uint_eq(part.counts_differ, 0);
    ck_assert_str_eq(part.not_compared[0], "materialid");
    ck_assert_str_eq(part.not_compared[1], "depth.window, ZBack");
    diff_part_free(&part);
    ck_assert_int_eq(diff_deep(&image_a, &image_b, "A,R,A", &options, &part), RESULT_OK);
    ck_assert_int_eq(part.channel_count, 2);
    ck_assert_str_eq(part.channels[0].name, "A");
    ck_assert_ptr_null(part.not_compared[1]);
    ck_assert_int_eq(part.verdict, DIFF_PASS); /* what differs is G */
    diff_part_free(&part);
    static const char *const refused[] = {"materialid", "ZBack", "R,,G", "Z,q", "depth"};
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        ck_assert_int_eq(diff_deep(&image_a, &image_b, refused[i], &options, &part),
                         RESULT_BAD_INPUT);
        diff_part_free(&part);
    }
    image_a.half[DEEP_G] = image_b.half[DEEP_G] = true;
    ck_assert_int_eq(diff_deep(&image_a, &image_b, "G", &options, &part), RESULT_OK);
    ck_assert_str_eq(part.channels[0].kinds[0], "half");
    ck_assert_uint_eq(part.channels[0].max_ulp, 0x3800); /* the half 0.5 */
    diff_part_free(&part);
    deep_free(&image_b);

    /* Where counts differ nothing is compared, and no allowance helps. */
    image_b = deep_row(counts_b, a, 3);
    options.fail.absolute = options.warn.absolute = 1e9;
    options.fail.allowed = 3;
    ck_assert_int_eq(diff_deep(&image_a, &image_b, NULL, &options, &part), RESULT_OK);
    ck_assert_uint_eq(part.channels[0].values, 1);
    ck_assert_uint_eq(part.counts_differ, 2);
    ck_assert_int_eq(part.count_at[0], 1);
    ck_assert_uint_eq(part.counts_there[0], 2);
    ck_assert_uint_eq(part.counts_there[1], 1);
    ck_assert_uint_eq(part.differing, 2);
    ck_assert_int_eq(part.verdict, DIFF_FAILURE);
    ck_assert_int_eq(part.worst_count, 2);
    ck_assert(part.worst[0].counts && !part.worst[0].has_ulp);
    diff_part_free(&part);
    deep_free(&image_a);
    deep_free(&image_b);
}
END_TEST

START_TEST(test_image)
{
    const float one[] = {1.0f}, two[] = {3.0f};
    uint32_t *a = float_bits(one, 1), *b = float_bits(two, 1);
    Row row_a = {.planes = {.width = 1}}, row_b = row_a;
    Planes image;
    float value;
    add_bits(&row_a, "R", KIND_FLOAT, 0, a);
    add_bits(&row_b, "R", KIND_FLOAT, 0, b);
    for (int magnitude = 0; magnitude < 2; magnitude++) {
        ck_assert_int_eq(diff_image(&row_a.planes, &row_b.planes, 2.0, magnitude, &image),
                         RESULT_OK);
        memcpy(&value, image.planes[0].bits, sizeof value);
        ck_assert_float_eq(value, magnitude ? 4.0f : -4.0f);
        planes_free(&image);
    }
    free(a);
    free(b);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("diff");
    TCase *tcase = tcase_create("diff");
    tcase_add_test(tcase, test_figures);
    tcase_add_test(tcase, test_equal);
    tcase_add_test(tcase, test_not_finite);
    tcase_add_test(tcase, test_zeros_and_denormals);
    tcase_add_test(tcase, test_stored);
    tcase_add_test(tcase, test_bins);
    tcase_add_test(tcase, test_thresholds);
    tcase_add_test(tcase, test_channels);
    tcase_add_test(tcase, test_worst);
    tcase_add_test(tcase, test_deep);
    tcase_add_test(tcase, test_image);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

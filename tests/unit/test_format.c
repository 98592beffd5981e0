/* number/format.h: conversions of every stored format, and distances between stored values. */
#include "testing.h"

#include "base/random.h"
#include "number/format.h"
#include "number/op.h"

#include <float.h>
#include <math.h>

static uint32_t saved_mode;

static void enter_mode(void)
{
    saved_mode = op_enter();
}

static void leave_mode(void)
{
    op_leave(saved_mode);
}

/* The nearest integer to clamp(x)·max by exact arithmetic: the product is exact in double, its
 * rounding to float is the driver's, ties go to even. */
static uint32_t nearest(float x, double max)
{
    double clamped = x > 0.0f ? (x < 1.0f ? (double)x : 1.0) : 0.0;
    return (uint32_t)lrint((double)(float)(clamped * max));
}

/* Every code fetches as its number, within half a unit, and comes back as itself. */
START_TEST(test_unorm_round_trip)
{
    for (uint32_t i = 0; i < 256; i++) {
        ck_assert_uint_eq(unorm8_from_float(unorm8_to_float((uint8_t)i)), i);
        ck_assert_uint_eq(unorm8_from_float((float)(i / 255.0)), i);
        ck_assert_uint_le(ulp_distance(unorm8_to_float((uint8_t)i), (float)(i / 255.0)), 1);
    }
    for (uint32_t i = 0; i < 65536; i++) {
        float fetched = unorm16_to_float((uint16_t)i);
        if (unorm16_from_float(fetched) != i || ulp_distance(fetched, (float)(i / 65535.0)) > 1)
            ck_abort_msg("unorm16 %u: fetched %a, stored again %u", i, (double)fetched,
                         unorm16_from_float(fetched));
    }
    ck_assert_float_bits(unorm8_to_float(255), 1.0f);
    ck_assert_float_bits(unorm16_to_float(65535), 1.0f);
}
END_TEST

/* A fetch multiplies by the rounded 1/max; a division gives other bits for this many codes. */
START_TEST(test_unorm_fetch_is_no_division)
{
    int differing8 = 0, differing16 = 0;
    for (uint32_t i = 0; i < 65536; i++) {
        float product = op_mul((float)i, 0x1.0001p-16f), fetched = unorm16_to_float((uint16_t)i);
        if (op_bits(fetched) != op_bits(product))
            ck_abort_msg("unorm16 %u: fetched %a, expected %a", i, (double)fetched,
                         (double)product);
        differing16 += fetched != op_div((float)i, 65535.0f);
        differing8 += i < 256 && unorm8_to_float((uint8_t)i) != op_div((float)i, 255.0f);
    }
    ck_assert_int_eq(differing8, 126);
    ck_assert_int_eq(differing16, 512);
}
END_TEST

/* Every 16-bit depth fetches to a number of its own and comes back from it. */
START_TEST(test_depth16_codes)
{
    for (uint32_t i = 0; i < 1u << 16; i++) {
        if (depth16_from_float(depth16_to_float(i)) != i)
            ck_abort_msg("depth16: %u does not come back from its fetch", i);
        if (i && !(depth16_to_float(i) > depth16_to_float(i - 1)))
            ck_abort_msg("depth16: %u fetches no further than its predecessor", i);
    }
    ck_assert_uint_eq(depth16_from_float(1.5f), 0xffffu);
    ck_assert_uint_eq(depth16_from_float(-1.0f), 0);
    ck_assert_uint_eq(depth16_from_float(NAN), 0xffffu);
}
END_TEST

START_TEST(test_depth24_codes)
{
    uint32_t changed = 0;
    float last = -1.0f;
    for (uint32_t i = 0; i < 1u << 24; i++) {
        float fetched = depth24_to_float(i);
        if (depth24_from_float((float)(i / 16777215.0)) != i && i < 1u << 23)
            ck_abort_msg("depth24: %u does not come from i/(2^24 − 1)", i);
        if (fetched < last)
            ck_abort_msg("depth24: %u fetches below its predecessor", i);
        changed += depth24_from_float(fetched) != i;
        last = fetched;
    }
    /* The two greatest codes both fetch as 1; no other pair meets (measured on the driver too). */
    ck_assert_float_bits(depth24_to_float(0xfffffeu), 1.0f);
    ck_assert_float_bits(depth24_to_float(0xffffffu), 1.0f);
    ck_assert_float_lt(depth24_to_float(0xfffffdu), 1.0f);
    ck_assert_uint_eq(depth24_from_float(1.0f), 0xffffffu);
    ck_assert_uint_eq(depth24_from_float(nextafterf(1.0f, 0.0f)), 0xfffffeu);
    /* A fetch is not exact: this many of the 2^24 codes change when fetched and stored again. */
    ck_assert_uint_eq(changed, 5242879);
}
END_TEST

START_TEST(test_unorm_rounding)
{
    const float special[] = {0.0f,     -0.0f,     1.0f,      -1.0f,   2.0f, NAN,
                             INFINITY, -INFINITY, 0x1p-149f, FLT_MAX, 0.5f};
    const uint8_t expected[] = {0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 128}; /* 127.5 to even */
    for (size_t i = 0; i < sizeof special / sizeof special[0]; i++)
        ck_assert_uint_eq(unorm8_from_float(special[i]), expected[i]);
    Random random = random_seed(1);
    for (int i = 0; i < 2000000; i++) {
        uint64_t bits = random_bits(&random);
        float x = (float)random_range(&random, -0.1, 1.1);
        if (i & 1) { /* near a boundary between two codes */
            uint32_t max = i & 2 ? 255 : 65535;
            float edge = (float)(((double)(bits % max) + 0.5) / max);
            x = op_from_bits(op_bits(edge) + (uint32_t)(bits >> 32) % 9 - 4);
        }
        if (unorm8_from_float(x) != nearest(x, 255.0) ||
            unorm16_from_float(x) != nearest(x, 65535.0) ||
            depth24_from_float(x) != nearest(x, 16777215.0))
            ck_abort_msg("%a: unorm8 %u, unorm16 %u, depth24 %u", (double)x, unorm8_from_float(x),
                         unorm16_from_float(x), depth24_from_float(x));
    }
}
END_TEST

/* The sum is exact, or far from a tie: below 2^23 half a unit is in a float's mantissa. */
START_TEST(test_clear_rounds_ties_up)
{
    ck_assert_uint_eq(unorm16_from_clear(0x1.b736b8p-1f), 56219); /* product 56218.5 */
    ck_assert_uint_eq(unorm16_from_float(0x1.b736b8p-1f), 56218);
    ck_assert_uint_eq(unorm16_from_clear(NAN), 0);
    ck_assert_uint_eq(unorm16_from_clear(-1.0f), 0);
    ck_assert_uint_eq(unorm16_from_clear(2.0f), 65535);
    Random random = random_seed(2);
    size_t ties = 0;
    for (int i = 0; i < 2000000; i++) {
        float x = (float)random_unit(&random);
        double product = (double)(float)((double)x * 65535.0);
        uint32_t expected = (uint32_t)floor(product + 0.5);
        ties += unorm16_from_float(x) != expected;
        if (unorm16_from_clear(x) != expected)
            ck_abort_msg("%a: %u, expected %u", (double)x, unorm16_from_clear(x), expected);
    }
    ck_assert_uint_gt(ties, 100);
}
END_TEST

START_TEST(test_half_round_trip)
{
    for (uint32_t i = 0; i < 65536; i++) {
        uint16_t half = (uint16_t)i;
        float x = half_to_float(half);
        bool is_nan = (half & 0x7fffu) > 0x7c00u;
        uint16_t quiet = is_nan ? half | 0x200u : half;
        if (half_from_float(x) != quiet || is_nan != (x != x))
            ck_abort_msg("half 0x%04x: %a, back 0x%04x", half, (double)x, half_from_float(x));
        if (is_nan || (half & 0x7c00u) == 0x7c00u)
            continue;
        int exponent = half >> 10 & 31, mantissa = half & 1023;
        double value = exponent ? ldexp(1024 + mantissa, exponent - 25) : ldexp(mantissa, -24);
        if ((double)x != (half & 0x8000u ? -value : value))
            ck_abort_msg("half 0x%04x: %a, expected %a", half, (double)x, value);
    }
}
END_TEST

/* Between two neighbouring halves everything becomes the one nearer to zero. */
START_TEST(test_half_truncates)
{
    for (uint32_t i = 0; i < 0x7bffu; i++) {
        float low = half_to_float((uint16_t)i), high = half_to_float((uint16_t)(i + 1));
        float below = op_from_bits(op_bits(high) - 1), middle = low + (high - low) * 0.75f;
        if (half_from_float(below) != i || half_from_float(middle) != i ||
            half_from_float(-below) != (i | 0x8000u))
            ck_abort_msg("half 0x%04x: %a gives 0x%04x, %a gives 0x%04x", i, (double)below,
                         half_from_float(below), (double)middle, half_from_float(middle));
    }
    ck_assert_uint_eq(half_from_float(65504.0f), 0x7bff);
    ck_assert_uint_eq(half_from_float(65535.99f), 0x7bff);
    ck_assert_uint_eq(half_from_float(FLT_MAX), 0x7bff);
    ck_assert_uint_eq(half_from_float(-FLT_MAX), 0xfbff);
    ck_assert_uint_eq(half_from_float(INFINITY), 0x7c00);
    ck_assert_uint_eq(half_from_float(-INFINITY), 0xfc00);
    ck_assert_uint_eq(half_from_float(0x1.fffffep-25f), 0);
    ck_assert_uint_eq(half_from_float(-0x1p-149f), 0x8000);
}
END_TEST

START_TEST(test_depth_clamp)
{
    ck_assert_float_bits(depth32f_from_float(NAN), 1.0f);
    ck_assert_float_bits(depth32f_from_float(INFINITY), 1.0f);
    ck_assert_float_bits(depth32f_from_float(-INFINITY), 0.0f);
    ck_assert_float_bits(depth32f_from_float(-0.0f), 0.0f);
    ck_assert_float_bits(depth32f_from_float(0x1p-149f), 0.0f);
    ck_assert_float_bits(depth32f_from_float(0x1p-126f), 0x1p-126f);
    ck_assert_float_bits(depth32f_from_float(nextafterf(1.0f, 2.0f)), 1.0f);
    ck_assert_float_bits(depth32f_from_float(0.3f), 0.3f);
    ck_assert_uint_eq(depth24_from_float(NAN), 0xffffffu);
    ck_assert_uint_eq(depth24_from_float(-1.0f), 0);
}
END_TEST

START_TEST(test_ulp_distance)
{
    ck_assert_uint_eq(ulp_distance(0.0f, -0.0f), 1);
    ck_assert_uint_eq(ulp_distance(NAN, -NAN), 0);
    ck_assert_uint_eq(ulp_distance(NAN, 1.0f), UINT32_MAX);
    ck_assert_uint_eq(ulp_distance(1.0f, NAN), UINT32_MAX);
    ck_assert_uint_eq(ulp_distance(FLT_MAX, INFINITY), 1);
    ck_assert_uint_eq(ulp_distance(0x1p-149f, -0x1p-149f), 3);
    ck_assert_uint_eq(ulp_distance(INFINITY, -INFINITY), 2 * 0x7f800000u + 1);
    ck_assert_uint_eq(ulp_distance_half(0x0000, 0x8000), 1);
    ck_assert_uint_eq(ulp_distance_half(0x7c01, 0xfe00), 0);
    ck_assert_uint_eq(ulp_distance_half(0x7c00, 0x7c01), UINT32_MAX);
    ck_assert_uint_eq(ulp_distance_half(0x3c00, 0x3bff), 1);
    Random random = random_seed(2);
    for (int i = 0; i < 1000000; i++) {
        uint32_t bits = (uint32_t)random_bits(&random);
        float x = op_from_bits(bits), y = op_from_bits((uint32_t)random_bits(&random));
        if (i % 2)
            y = op_from_bits(bits ^ (uint32_t)random_bits(&random) % 8);
        uint32_t distance = ulp_distance(x, y);
        bool equal = op_bits(x) == op_bits(y) || (x != x && y != y);
        if ((distance == 0) != equal || distance != ulp_distance(y, x))
            ck_abort_msg("%a, %a: %u and %u apart", (double)x, (double)y, distance,
                         ulp_distance(y, x));
        if ((bits & 0x7fffffffu) < 0x7f800000u && ulp_distance(x, op_from_bits(bits + 1)) != 1)
            ck_abort_msg("%a: not 1 from its neighbour", (double)x);
    }
}
END_TEST

/* store then fetch, and what a channel reads as, for every colour format. */
START_TEST(test_store_fetch)
{
    static const PixelFormat formats[] = {FORMAT_RGBA32F, FORMAT_RGBA16F, FORMAT_RGBA16,
                                          FORMAT_RGBA8};
    static const float expected[4][4] = {
        {0.1f, -2.0f, 1.0f, 70000.0f},
        {0x1.998p-4f, -2.0f, 1.0f, 65504.0f},
        {6554 * (float)(1.0 / 65535.0), 0.0f, 1.0f, 1.0f}, /* 6553.5 to even */
        {26 * (float)(1.0 / 255.0), 0.0f, 1.0f, 1.0f},     /* 25.5 to even */
    };
    const float value[4] = {0.1f, -2.0f, 1.0f, 70000.0f};
    for (size_t i = 0; i < 4; i++) {
        unsigned char pixel[16];
        float fetched[4];
        format_store(formats[i], value, pixel);
        format_fetch(formats[i], pixel, fetched);
        for (int c = 0; c < 4; c++) {
            ck_assert_float_bits(fetched[c], expected[i][c]);
            ck_assert_uint_le(ulp_distance(format_channel(formats[i], pixel, c), fetched[c]), 1);
        }
        ck_assert_uint_eq(format_pixel_bytes(formats[i]),
                          (size_t)(4 * format_info(formats[i])->channel_bytes));
    }
    uint32_t depth = 0xffffffu, id = 7;
    ck_assert_float_bits(format_channel(FORMAT_D24, &depth, 0), 1.0f);
    ck_assert_float_bits(format_channel(FORMAT_R32UI, &id, 0), 7.0f);
    ck_assert_str_eq(format_info(FORMAT_RGBA16)->name, "rgba16");
}
END_TEST

START_TEST(test_overflowed)
{
    const uint16_t fine[4] = {0x7bfe, 0xfbfe, 0x0000, 0x8001};
    ck_assert(!format_overflowed(FORMAT_RGBA16F, fine));
    static const uint16_t ends[] = {0x7bff, 0xfbff, 0x7c00, 0xfc00, 0x7e00, 0xfe00};
    for (int i = 0; i < 6; i++)
        for (int c = 0; c < 4; c++) {
            uint16_t pixel[4] = {0x3c00, 0x3c00, 0x3c00, 0x3c00};
            pixel[c] = ends[i];
            ck_assert(format_overflowed(FORMAT_RGBA16F, pixel));
        }
    float pixel[4] = {FLT_MAX, -FLT_MAX, 0x1p-149f, 65504.0f};
    ck_assert(!format_overflowed(FORMAT_RGBA32F, pixel));
    pixel[3] = -INFINITY;
    ck_assert(format_overflowed(FORMAT_RGBA32F, pixel));
    pixel[3] = NAN;
    ck_assert(format_overflowed(FORMAT_RGBA32F, pixel));
    ck_assert(!format_overflowed(FORMAT_R32F, pixel));
    const uint8_t white[4] = {255, 255, 255, 255};
    ck_assert(!format_overflowed(FORMAT_RGBA8, white));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("format");
    TCase *tcase = tcase_create("format");
    tcase_add_checked_fixture(tcase, enter_mode, leave_mode);
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_unorm_round_trip);
    tcase_add_test(tcase, test_unorm_fetch_is_no_division);
    tcase_add_test(tcase, test_depth16_codes);
    tcase_add_test(tcase, test_depth24_codes);
    tcase_add_test(tcase, test_unorm_rounding);
    tcase_add_test(tcase, test_clear_rounds_ties_up);
    tcase_add_test(tcase, test_half_round_trip);
    tcase_add_test(tcase, test_half_truncates);
    tcase_add_test(tcase, test_depth_clamp);
    tcase_add_test(tcase, test_ulp_distance);
    tcase_add_test(tcase, test_store_fetch);
    tcase_add_test(tcase, test_overflowed);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

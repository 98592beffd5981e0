/* number/blend.h: under-blending by hand, and the 16-bit product against the exact one. */
#include "testing.h"

#include "base/random.h"
#include "number/blend.h"
#define LANES 1
#include "number/blend_lanes.h"

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

START_TEST(test_clear)
{
    float pixel[4];
    uint16_t pixel16[4];
    blend_clear(FORMAT_RGBA32F, pixel);
    blend_clear(FORMAT_RGBA16, pixel16);
    for (int c = 0; c < 4; c++) {
        ck_assert_float_bits(pixel[c], c == 3 ? 1.0f : 0.0f);
        ck_assert_uint_eq(pixel16[c], c == 3 ? 65535 : 0);
    }
}
END_TEST

/* Two layers: 1/2 red in front, then 1/4 green, then opaque white; exact in binary. */
START_TEST(test_under_by_hand)
{
    static const float layers[3][4] = {{0.5f, 0, 0, 0.5f}, {0, 0.25f, 0, 0.25f}, {1, 1, 1, 1}};
    static const float expected[3][4] = {
        {0.5f, 0, 0, 0.5f}, {0.5f, 0.125f, 0, 0.375f}, {0.875f, 0.5f, 0.375f, 0}};
    float pixel[4];
    blend_clear(FORMAT_RGBA32F, pixel);
    for (int i = 0; i < 3; i++) {
        blend_under(FORMAT_RGBA32F, layers[i], pixel);
        for (int c = 0; c < 4; c++)
            ck_assert_float_bits(pixel[c], expected[i][c]);
    }
}
END_TEST

START_TEST(test_opaque_seed_by_hand)
{
    float pixel[4] = {0.5f, 0.125f, 0, 0.375f};
    blend_opaque_seed(FORMAT_RGBA32F, (float[4]){1, 1, 1, 1}, pixel);
    const float expected[4] = {0.875f, 0.5f, 0.375f, 0.75f}; /* alpha 2T */
    for (int c = 0; c < 4; c++)
        ck_assert_float_bits(pixel[c], expected[c]);
    uint16_t pixel16[4] = {60000, 1, 0, 65535};
    blend_opaque_seed(FORMAT_RGBA16, (float[4]){1, 0, 0.5f, 1}, pixel16);
    ck_assert_uint_eq(pixel16[0], 65535); /* saturates */
    ck_assert_uint_eq(pixel16[1], 1);
    ck_assert_uint_eq(pixel16[2], 32768); /* 32767.5 to even */
    ck_assert_uint_eq(pixel16[3], 65535);
}
END_TEST

/* Every operation rounds once and nothing is fused; the colour's product is not either. */
START_TEST(test_under_rounds)
{
    float pixel[4] = {-0x1.002p+0f, 0, 0, 0x1.001p+0f};
    blend_under(FORMAT_RGBA32F, (float[4]){0x1.001p+0f, 0x1p-100f, 0, 0.1f}, pixel);
    ck_assert_float_bits(pixel[0], 0.0f); /* fused: 2^-24 */
    ck_assert_float_bits(pixel[1], op_mul(0x1p-100f, 0x1.001p+0f));
    ck_assert_float_bits(pixel[3], op_mul(0x1.001p+0f, op_sub(1.0f, 0.1f)));
}
END_TEST

/* The vector path's blends are those of rgba32f. */
START_TEST(test_lanes)
{
    Random random = random_seed(3);
    for (int i = 0; i < 400000; i++) {
        float source[4], pixel[2][4], lanes[2][4];
        for (int c = 0; c < 4; c++) {
            uint32_t any = (uint32_t)random_bits(&random), odd = (uint32_t)random_bits(&random) % 8;
            source[c] = odd == 0  ? INFINITY
                        : odd < 4 ? (float)random_unit(&random)
                                  : op_from_bits(any);
            pixel[0][c] = pixel[1][c] = lanes[0][c] = lanes[1][c] = (float)random_unit(&random);
        }
        blend_under(FORMAT_RGBA32F, source, pixel[0]);
        blend_opaque_seed(FORMAT_RGBA32F, source, pixel[1]);
        blend_lanes_under(source, lanes[0]);
        blend_lanes_seed(source, lanes[1]);
        if (memcmp(pixel, lanes, sizeof pixel) != 0)
            ck_abort_msg("source (%a, %a, %a, %a): vectors blend otherwise", (double)source[0],
                         (double)source[1], (double)source[2], (double)source[3]);
    }
}
END_TEST

START_TEST(test_under_special)
{
    float pixel[4] = {0, 0, 0x1p-126f, 0x1p-100f};
    blend_under(FORMAT_RGBA32F, (float[4]){NAN, 0x1p-60f, -0x1p-126f, INFINITY}, pixel);
    ck_assert_uint_eq(op_bits(pixel[0]), 0x7fc00000u);
    ck_assert_float_bits(pixel[1], 0.0f);              /* the product is tiny */
    ck_assert_float_bits(pixel[2], 0x1p-126f);         /* and so is this one */
    ck_assert_uint_eq(op_bits(pixel[3]), 0x7fc00000u); /* inf·0 */
}
END_TEST

static uint32_t exact16(uint32_t a, uint32_t b)
{
    uint64_t product = (uint64_t)a * b;
    return (uint32_t)((2 * product + 65535) / (2 * 65535)); /* no ties: 65535 is odd */
}

START_TEST(test_under16_by_hand)
{
    uint16_t pixel[4];
    blend_clear(FORMAT_RGBA16, pixel);
    blend_under(FORMAT_RGBA16, (float[4]){0.5f, 0.25f, 2.0f, 0.5f}, pixel);
    const uint16_t first[4] = {32768, 16384, 65535, 32767}; /* 65535 − 32768 */
    for (int c = 0; c < 4; c++)
        ck_assert_uint_eq(pixel[c], first[c]);
    blend_under(FORMAT_RGBA16, (float[4]){1.0f, 1.0f, 1.0f, 0.25f}, pixel);
    const uint16_t second[4] = {65535, 49151, 65535, 24575}; /* 32767·49151/65535 = 24575.1 */
    for (int c = 0; c < 4; c++)
        ck_assert_uint_eq(pixel[c], second[c]);
}
END_TEST

/* The driver's product is never more than one from the correctly rounded one, and is that one
 * nearly always; 0 and 65535 behave as 0 and 1. */
START_TEST(test_product16)
{
    Random random = random_seed(1);
    uint32_t off = 0;
    for (int i = 0; i < 4000000; i++) {
        uint64_t bits = random_bits(&random);
        uint32_t a = bits & 65535, b = bits >> 16 & 65535;
        if (i % 8 == 0)
            b = (uint32_t)(65535 * (bits >> 32 & 1));
        uint16_t pixel[4] = {0, 0, 0, (uint16_t)b};
        float source = unorm16_to_float((uint16_t)a);
        blend_under(FORMAT_RGBA16, (float[4]){source, 0, 0, source}, pixel);
        uint32_t expected = exact16(a, b), transmitted = exact16(b, 65535 - a);
        uint32_t error = pixel[0] > expected ? pixel[0] - expected : expected - pixel[0];
        off += error != 0;
        if (error > 1 || (i % 8 == 0 && error) || pixel[3] + 1u < transmitted ||
            pixel[3] > transmitted + 1u)
            ck_abort_msg("%u · %u: got %u, exact %u; transmittance %u, exact %u", a, b, pixel[0],
                         expected, pixel[3], transmitted);
    }
    ck_assert_uint_gt(off, 0);
    ck_assert_uint_lt(off, 100);
}
END_TEST

/* Found by searching all pairs with a = b: the driver's rounding, not the correct one. */
START_TEST(test_product16_differs)
{
    uint32_t found = 0;
    for (uint32_t a = 0; a < 65536; a++) {
        for (uint32_t b = a; b < 65536 && b < a + 64; b++) {
            uint32_t product = a * b;
            product += product >> 16;
            uint32_t got = (product + 32768u) >> 16;
            if (got == exact16(a, b))
                continue;
            found++;
            uint16_t pixel[4] = {0, 0, 0, (uint16_t)b};
            blend_under(FORMAT_RGBA16, (float[4]){unorm16_to_float((uint16_t)a), 0, 0, 0}, pixel);
            ck_assert_uint_eq(pixel[0], got);
        }
    }
    ck_assert_uint_gt(found, 0);
}
END_TEST

/* ---- masks: dual depth peeling ---- */

static const PixelFormat mask_formats[] = {FORMAT_RGBA32F, FORMAT_RGBA16F, FORMAT_RGBA16,
                                           FORMAT_RGBA8};

/* Stores source without blending. */
static void ck_assert_stored(PixelFormat format, const void *pixel, const float source[4])
{
    unsigned char stored[16];
    format_store(format, source, stored);
    ck_assert_mem_eq(pixel, stored, format_pixel_bytes(format));
}

/* Of sources whose mask is 1 the last or the first is there to the bit; those with 0 are not. */
START_TEST(test_masks)
{
    Random random = random_seed(5);
    for (int i = 0; i < 100000; i++) {
        PixelFormat format = mask_formats[i % 4];
        unsigned char last[16] = {0}, first[16] = {0};
        const float none[4] = {0, 0, 0, 0};
        float source[2][4];
        for (int k = 0; k < 2; k++) {
            for (int c = 0; c < 3; c++)
                source[k][c] = (float)random_unit(&random);
            source[k][3] = 1.0f;
            blend_replace(format, source[k], last);
            blend_replace(format, none, last);
            blend_keep(format, source[k], first);
            blend_keep(format, none, first);
        }
        ck_assert_stored(format, last, source[1]);
        ck_assert_stored(format, first, source[0]);
    }
}
END_TEST

/* Over: half-transparent red over half-transparent green. Max: channel by channel. */
START_TEST(test_over_and_max_by_hand)
{
    float pixel[4] = {0, 0.5f, 0, 0.5f};
    blend_over(FORMAT_RGBA32F, (float[4]){0.5f, 0, 0, 0.5f}, pixel);
    ck_assert_float_bits(pixel[0], 0.5f);
    ck_assert_float_bits(pixel[1], 0.25f);
    ck_assert_float_bits(pixel[3], 0.25f);
    uint8_t codes[4] = {0, 128, 0, 127};
    blend_over(FORMAT_RGBA8, (float[4]){128 / 255.0f, 0, 0, 128 / 255.0f}, codes);
    ck_assert_uint_eq(codes[0], 128);
    ck_assert_uint_eq(codes[1], 64);
    ck_assert_uint_eq(codes[3], 63);
    float limits[2] = {-2.0f, -2.0f};
    blend_max(FORMAT_RG32F, (float[4]){-0.25f, 0.25f, 9, 9}, limits);
    blend_max(FORMAT_RG32F, (float[4]){-0.5f, 0.5f, 9, 9}, limits);
    ck_assert_float_bits(limits[0], -0.25f);
    ck_assert_float_bits(limits[1], 0.5f);
    blend_max(FORMAT_RG32F, (float[4]){NAN, INFINITY, 0, 0}, limits);
    ck_assert_float_bits(limits[0], -0.25f);
    ck_assert_float_bits(limits[1], INFINITY);
}
END_TEST

/* ---- over, add, product -----------------------------------------------------------------------
 */

typedef void (*Blend)(PixelFormat format, const float source[4], void *pixel);

/* A pixel of the format, from and to numbers. */
static void check_blend(Blend blend, PixelFormat format, const float source[4],
                        const float before[4], const float expected[4])
{
    unsigned char pixel[16];
    float got[4];
    format_store(format, before, pixel);
    blend(format, source, pixel);
    format_fetch(format, pixel, got);
    for (int c = 0; c < format_info(format)->channels; c++)
        ck_assert_msg(op_bits(got[c]) == op_bits(expected[c]), "%s, channel %d: %a, expected %a",
                      format_info(format)->name, c, (double)got[c], (double)expected[c]);
}

/* Exact in floats and halves. */
START_TEST(test_others_by_hand)
{
    static const PixelFormat formats[] = {FORMAT_RGBA32F, FORMAT_RGBA16F};
    const float source[4] = {0.5f, 2.0f, -1.0f, 0.25f}, before[4] = {1.0f, 0.5f, 4.0f, 0.5f};
    for (int i = 0; i < 2; i++) {
        check_blend(blend_over, formats[i], source, before,
                    (float[4]){1.25f, 2.375f, 2.0f, 0.375f});
        check_blend(blend_add, formats[i], source, before, (float[4]){1.5f, 2.5f, 3.0f, 0.75f});
        check_blend(blend_product, formats[i], source, before,
                    (float[4]){0.5f, -0.5f, 8.0f, 0.375f});
    }
    check_blend(blend_add, FORMAT_R32F, source, before, (float[4]){1.5f});
    check_blend(blend_product, FORMAT_R32F, source, before, (float[4]){0.5f});
    check_blend(blend_add, FORMAT_RG32F, source, before, (float[4]){1.5f, 2.5f});
}
END_TEST

START_TEST(test_others_in_codes)
{
    /* 51/255 = 0.2 and so on; 153·(255 − 102)/255 = 91.8 */
    const float source[4] = {51 / 255.0f, 1.0f, 0.0f, 102 / 255.0f};
    const uint8_t before[4] = {153, 204, 255, 153};
    const struct {
        Blend blend;
        uint8_t expected[4];
    } rows[] = {
        {blend_over, {51 + 92, 255, 153, 92}},
        {blend_add, {204, 255, 255, 255}},
        {blend_product, {122, 0, 255, 92}}, /* 153·204/255 = 122.4 */
    };
    for (int i = 0; i < 3; i++) {
        uint8_t pixel[4];
        memcpy(pixel, before, sizeof pixel);
        rows[i].blend(FORMAT_RGBA8, source, pixel);
        for (int c = 0; c < 4; c++)
            ck_assert_msg(pixel[c] == rows[i].expected[c], "blend %d, channel %d: %d", i, c,
                          pixel[c]);
    }
    uint16_t wide[4] = {65535, 32768, 1, 65535};
    blend_product(FORMAT_RGBA16, (float[4]){0.5f, 1.0f, 0.0f, 0.25f}, wide);
    ck_assert_uint_eq(wide[0], 32767); /* 65535 − 32768 */
    ck_assert_uint_eq(wide[1], 0);
    ck_assert_uint_eq(wide[2], 1);
    ck_assert_uint_eq(wide[3], 49151);
}
END_TEST

/* A product adds nothing, so it keeps −0; over makes the product of alpha with 0. Sums of halves
 * are truncated and end at the greatest; one NaN is stored. */
START_TEST(test_others_special)
{
    float pixel[4] = {-0.0f, INFINITY, 1.0f, 1.0f};
    blend_product(FORMAT_RGBA32F, (float[4]){0.5f, 1.0f, NAN, INFINITY}, pixel);
    ck_assert_float_bits(pixel[0], -0.0f);
    ck_assert_uint_eq(op_bits(pixel[1]), 0x7fc00000u);
    ck_assert_uint_eq(op_bits(pixel[2]), 0x7fc00000u);
    ck_assert_float_bits(pixel[3], -INFINITY);
    float over[4] = {0, 0, 0, 1.0f};
    blend_over(FORMAT_RGBA32F, (float[4]){1.0f, 0, 0, INFINITY}, over);
    ck_assert_uint_eq(op_bits(over[3]), 0x7fc00000u);
    const float large[4] = {60000.0f, 1.0f, 0x1p-24f, INFINITY};
    check_blend(blend_add, FORMAT_RGBA16F, large, (float[4]){60000.0f, 2048.0f, 0x1p-24f, 1.0f},
                (float[4]){65504.0f, 2048.0f, 0x1p-23f, INFINITY});
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("blend");
    TCase *tcase = tcase_create("blend");
    tcase_add_checked_fixture(tcase, enter_mode, leave_mode);
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_clear);
    tcase_add_test(tcase, test_under_by_hand);
    tcase_add_test(tcase, test_opaque_seed_by_hand);
    tcase_add_test(tcase, test_under_rounds);
    tcase_add_test(tcase, test_lanes);
    tcase_add_test(tcase, test_under_special);
    tcase_add_test(tcase, test_under16_by_hand);
    tcase_add_test(tcase, test_product16);
    tcase_add_test(tcase, test_product16_differs);
    tcase_add_test(tcase, test_masks);
    tcase_add_test(tcase, test_over_and_max_by_hand);
    tcase_add_test(tcase, test_others_by_hand);
    tcase_add_test(tcase, test_others_in_codes);
    tcase_add_test(tcase, test_others_special);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

/* peel.h, formats, blending and comparing: what good arguments give and, entry point by entry
 * point, what is said of bad ones. Linked with the library's objects, so that the sanitizers see
 * into it. */
#include "library_calls.h"

#include "blend/arithmetic.h"
#include "blend/equation.h"

#include <fenv.h>
#include <math.h>
#include <stdio.h>

/* ---- formats ---- */

START_TEST(test_version)
{
    char expected[32];
    snprintf(expected, sizeof expected, "%d.%d.%d", PEEL_VERSION_MAJOR, PEEL_VERSION_MINOR,
             PEEL_VERSION_PATCH);
    ck_assert_str_eq(peel_version(), expected);
    for (int i = PEEL_OK; i <= PEEL_INTERNAL; i++)
        ck_assert_str_ne(peel_result_text((PeelResult)i), "unknown result");
    ck_assert_str_eq(peel_result_text((PeelResult)NONE), "unknown result");
}
END_TEST

START_TEST(test_formats)
{
    static const struct {
        const char *name;
        int channels;
        size_t bytes;
    } expected[PEEL_FORMAT_COUNT] = {
        [PEEL_RGBA32F] = {"rgba32f", 4, 16}, [PEEL_RGBA16F] = {"rgba16f", 4, 8},
        [PEEL_RGBA16] = {"rgba16", 4, 8},    [PEEL_RGBA8] = {"rgba8", 4, 4},
        [PEEL_RG32F] = {"rg32f", 2, 8},      [PEEL_R32F] = {"r32f", 1, 4},
        [PEEL_RG16] = {"rg16", 2, 4},        [PEEL_D32F] = {"d32f", 1, 4},
        [PEEL_D24] = {"d24", 1, 4},          [PEEL_D16] = {"d16", 1, 4},
        [PEEL_R32UI] = {"r32ui", 1, 4},
    };
    for (int i = 0; i < PEEL_FORMAT_COUNT; i++) {
        ck_assert_str_eq(peel_format_name((PeelFormat)i), expected[i].name);
        ck_assert_int_eq(peel_format_channels((PeelFormat)i), expected[i].channels);
        ck_assert_uint_eq(peel_format_pixel_bytes((PeelFormat)i), expected[i].bytes);
    }
    ck_assert_ptr_null(peel_format_name((PeelFormat)NONE));
    ck_assert_int_eq(peel_format_channels((PeelFormat)-1), 0);
    ck_assert_uint_eq(peel_format_pixel_bytes(PEEL_FORMAT_COUNT), 0);
}
END_TEST

START_TEST(test_store_and_fetch)
{
    /* 0.5 * 255 ties to even 128; 0.7 as a half is truncated to 0x3999. */
    const float values[8] = {0.5f, 0.7f, -1.0f, 2.0f, NAN, 1.0f, 0.0f, 0.25f};
    uint8_t codes[8];
    uint16_t halves[8];
    float fetched[8];
    GOOD(peel_store(PEEL_RGBA8, 2, values, codes));
    const uint8_t expected[8] = {128, 178, 0, 255, 0, 255, 0, 64};
    ck_assert_mem_eq(codes, expected, sizeof codes);
    GOOD(peel_fetch(PEEL_RGBA8, 2, codes, fetched));
    ck_assert_float_bits(fetched[3], 1.0f);
    ck_assert_float_bits(fetched[0], 128 * (float)(1.0 / 255.0));
    GOOD(peel_store(PEEL_RGBA16F, 2, values, halves));
    ck_assert_uint_eq(halves[1], 0x3999);
    float number;
    GOOD(peel_value(PEEL_RGBA16F, halves, 1, &number));
    ck_assert_float_bits(number, 0x1.664p-1f);
    GOOD(peel_fetch(PEEL_R32F, 1, values, fetched));
    ck_assert_float_bits(fetched[0], 0.5f);
    ck_assert_float_bits(fetched[3], 1.0f);

    BAD("format 77", peel_store((PeelFormat)NONE, 1, values, codes));
    BAD("format 7", peel_store(PEEL_D32F, 1, values, codes));
    BAD("values is NULL", peel_store(PEEL_RGBA8, 1, NULL, codes));
    BAD("pixels is NULL", peel_store(PEEL_RGBA8, 1, values, NULL));
    BAD("pixels is NULL", peel_fetch(PEEL_RGBA8, (size_t)1 << 31, NULL, fetched));
    BAD("values is NULL", peel_fetch(PEEL_RGBA8, 1, codes, NULL));
    BAD("format -1", peel_fetch((PeelFormat)-1, 1, codes, fetched));
    GOOD(peel_store(PEEL_RGBA8, 0, NULL, NULL));
    GOOD(peel_fetch(PEEL_RGBA8, 0, NULL, NULL));

    BAD("pixel is NULL", peel_value(PEEL_RGBA8, NULL, 0, &number));
    BAD("out is NULL", peel_value(PEEL_RGBA8, codes, 0, NULL));
    BAD("channel 2", peel_value(PEEL_RG32F, values, 2, &number));
    BAD("channel -1", peel_value(PEEL_RG32F, values, -1, &number));
    BAD("channel 0 of format 77", peel_value((PeelFormat)NONE, values, 0, &number));
}
END_TEST

START_TEST(test_ulp_and_clear)
{
    const float a[4] = {1.0f, 0.0f, NAN, NAN}, b[4] = {0x1.000004p0f, -0.0f, -NAN, 1.0f};
    const uint32_t expected[4] = {2, 1, 0, UINT32_MAX};
    uint32_t ulp[4];
    GOOD(peel_ulp(PEEL_RGBA32F, a, b, ulp));
    ck_assert_mem_eq(ulp, expected, sizeof ulp);
    BAD("a is NULL", peel_ulp(PEEL_RGBA32F, NULL, b, ulp));
    BAD("b is NULL", peel_ulp(PEEL_RGBA32F, a, NULL, ulp));
    BAD("out is NULL", peel_ulp(PEEL_RGBA32F, a, b, NULL));
    BAD("77 is no format", peel_ulp((PeelFormat)NONE, a, b, ulp));

    uint16_t pixels[8];
    const uint16_t cleared[8] = {0, 0, 0, 0xffff, 0, 0, 0, 0xffff};
    GOOD(peel_clear(PEEL_RGBA16, 2, pixels));
    ck_assert_mem_eq(pixels, cleared, sizeof pixels);
    GOOD(peel_clear(PEEL_RGBA16, 0, NULL));
    BAD("pixels is NULL", peel_clear(PEEL_RGBA16, 1, NULL));
    BAD("format 9", peel_clear(PEEL_D16, 1, pixels));
}
END_TEST

/* ---- blending ---- */

START_TEST(test_names)
{
    size_t equations = 0, wrong = 0;
    const char *what = NULL;
    PeelEquation equation;
    while (peel_equation_name(equations, &what)) {
        GOOD(peel_equation_parse(peel_equation_name(equations++, NULL), &equation));
        ck_assert_ptr_null(strchr(what, '\n'));
    }
    ck_assert_str_eq(peel_equation_name(0, NULL), "under");
    ck_assert_uint_ge(equations, 6);
    GOOD(peel_equation_parse("dst-alpha,one-minus-src-color:max,reverse-subtract", &equation));
    ck_assert_int_eq(equation.source, PEEL_DST_ALPHA);
    ck_assert_int_eq(equation.destination_alpha, PEEL_ONE_MINUS_SRC_COLOR);
    ck_assert_int_eq(equation.func, PEEL_MAX);
    ck_assert_int_eq(equation.func_alpha, PEEL_REVERSE_SUBTRACT);
    BAD("out is NULL", peel_equation_parse("under", NULL));
    BAD("text is NULL", peel_equation_parse(NULL, &equation));
    BAD("nowhere", peel_equation_parse("nowhere", &equation));

    PeelArithmeticInfo info;
    PeelArithmetic arithmetic;
    for (size_t i = 0; i < peel_arithmetic_count(); i++) {
        GOOD(peel_arithmetic_info(i, &info));
        GOOD(peel_arithmetic_parse(info.name, &arithmetic));
        ck_assert_int_eq(arithmetic.kind, info.arithmetic.kind);
        ck_assert_uint_eq(arithmetic.mistakes, info.arithmetic.mistakes);
        wrong += info.wrong;
    }
    ck_assert_uint_ge(peel_arithmetic_count(), 3);
    ck_assert_uint_lt(wrong, peel_arithmetic_count());
    GOOD(peel_arithmetic_parse("precision=codes,product=shift-round,source-stored=yes",
                               &arithmetic));
    ck_assert_int_eq(arithmetic.kind, PEEL_STEPS);
    ck_assert_int_eq(arithmetic.precision, PEEL_PRECISION_CODES);
    ck_assert_int_eq(arithmetic.product, PEEL_CODES_SHIFT_ROUND);
    ck_assert(arithmetic.source_stored);
    BAD("expected below", peel_arithmetic_info(peel_arithmetic_count(), &info));
    BAD("out is NULL", peel_arithmetic_info(0, NULL));
    BAD("text is NULL", peel_arithmetic_parse(NULL, &arithmetic));
    BAD("out is NULL", peel_arithmetic_parse("exact", NULL));
    BAD("sloppy", peel_arithmetic_parse("sloppy", &arithmetic));
}
END_TEST

static const PeelArithmetic exact = {.kind = PEEL_EXACT}, driver = {.kind = PEEL_DRIVER};
static const PeelEquation under = {.source = PEEL_DST_ALPHA,
                                   .destination = PEEL_ONE,
                                   .source_alpha = PEEL_ZERO,
                                   .destination_alpha = PEEL_ONE_MINUS_SRC_ALPHA};

START_TEST(test_blend)
{
    const float sources[8] = {0.25f, 0.5f, 0.75f, 0.5f, 1.0f, 0.0f, 0.5f, 0.25f};
    uint8_t codes[8] = {0, 0, 0, 255, 10, 20, 30, 128};
    /* 255*128 and 128*128 over 255, to nearest: 128, 64; 128 * (255 - 64) / 255 is 95.9. */
    const uint8_t expected[8] = {64, 128, 191, 127, 138, 20, 94, 96};
    GOOD(peel_blend(&exact, &under, PEEL_RGBA8, 2, sources, codes));
    ck_assert_mem_eq(codes, expected, sizeof codes);

    float pixel[4] = {0, 0, 0, 1};
    PeelBlendSteps steps[4];
    GOOD(peel_blend_steps(&driver, &under, PEEL_RGBA32F, sources, pixel, steps));
    GOOD(peel_blend(&driver, &under, PEEL_RGBA32F, 1, sources, pixel));
    for (int c = 0; c < 4; c++)
        ck_assert_uint_eq(steps[c].stored, testing_bits(pixel[c]));
    ck_assert_float_bits(pixel[3], 0.5f);
    ck_assert(!steps[0].codes);
    ck_assert_double_eq(steps[0].source_factor, 1.0);

    GOOD(peel_blend(&exact, &under, PEEL_RGBA8, 0, NULL, NULL));
    BAD("arithmetic is NULL", peel_blend(NULL, &under, PEEL_RGBA8, 1, sources, codes));
    BAD("equation is NULL", peel_blend(&exact, NULL, PEEL_RGBA8, 1, sources, codes));
    BAD("sources is NULL", peel_blend(&exact, &under, PEEL_RGBA8, (size_t)1 << 31, NULL, codes));
    BAD("pixels is NULL", peel_blend(&exact, &under, PEEL_RGBA8, (size_t)1 << 31, sources, NULL));
    BAD("format 77", peel_blend(&exact, &under, (PeelFormat)NONE, 1, sources, codes));
    BAD("format 10", peel_blend(&exact, &under, PEEL_R32UI, 1, sources, codes));
    BAD("no multiple of 4",
        peel_blend(&exact, &under, PEEL_RGBA32F, 1, sources, (char *)pixel + 1));
    BAD("no multiple of 4", peel_blend(&exact, &under, PEEL_RGBA8, 1,
                                       (const float *)((const char *)sources + 2), codes));
    BAD("source is NULL", peel_blend_steps(&exact, &under, PEEL_RGBA8, NULL, codes, steps));
    BAD("pixel is NULL", peel_blend_steps(&exact, &under, PEEL_RGBA8, sources, NULL, steps));
    BAD("out is NULL", peel_blend_steps(&exact, &under, PEEL_RGBA8, sources, codes, NULL));
    const PeelArithmetic integers = {.kind = PEEL_STEPS, .precision = PEEL_PRECISION_CODES};
    FAILS(PEEL_UNSUPPORTED, "peel_blend",
          peel_blend(&integers, &under, PEEL_RGBA16F, 1, sources, codes));
}
END_TEST

START_TEST(test_blend_fields)
{
    const float source[4] = {0};
    float pixel[4] = {0};
    PeelArithmetic arithmetics[6] = {
        {.kind = (PeelArithmeticKind)NONE}, {.precision = (PeelPrecision)-1},
        {.rounding = (PeelRounding)NONE},   {.store = (PeelRounding)NONE},
        {.product = (PeelCodeProduct)NONE}, {.mistakes = UINT32_MAX}};
    for (int i = 0; i < 6; i++)
        BAD("of the arithmetic",
            peel_blend(&arithmetics[i], &under, PEEL_RGBA32F, 1, source, pixel));
    PeelEquation equations[6];
    for (int i = 0; i < 6; i++)
        equations[i] = under;
    equations[0].source = (PeelFactor)NONE;
    equations[1].destination = (PeelFactor)-1;
    equations[2].source_alpha = PEEL_FACTOR_COUNT;
    equations[3].destination_alpha = (PeelFactor)NONE;
    equations[4].func = PEEL_FUNC_COUNT;
    equations[5].func_alpha = (PeelFunc)-1;
    for (int i = 0; i < 6; i++)
        BAD("of the equation", peel_blend(&exact, &equations[i], PEEL_RGBA32F, 1, source, pixel));
}
END_TEST

/* Every named arithmetic and equation, in every format: refused or blended as behind the header. */
START_TEST(test_blend_is_the_arithmetic)
{
    static const PixelFormat formats[] = {FORMAT_RGBA32F, FORMAT_RGBA16F, FORMAT_RGBA16,
                                          FORMAT_RGBA8,   FORMAT_RG32F,   FORMAT_R32F};
    const float sources[2][4] = {{0.1f, 0.7f, 0.31f, 0.43f}, {1.5f, -0.25f, 0x1p-130f, 1.0f}};
    int blended = 0, refused = 0;
    for (size_t a = 0; a < arithmetic_count(); a++)
        for (int e = 0; e < EQUATION_COUNT; e++)
            for (int f = 0; f < 6; f++) {
                const Arithmetic *arithmetic = &arithmetic_info(a)->arithmetic;
                const BlendEquation *equation = &equation_info((EquationId)e)->equation;
                uint32_t expected[8] = {0x3e99999a, 0x3f19999a, 0x3f333333, 0x3e4ccccd,
                                        0x3f000001, 0x3f7fffff, 0x3dcccccd, 0x3f666666},
                         pixels[8];
                PeelArithmeticInfo info;
                PeelEquation named;
                memcpy(pixels, expected, sizeof pixels);
                GOOD(peel_arithmetic_info(a, &info));
                GOOD(peel_equation_parse(peel_equation_name((size_t)e, NULL), &named));
                PeelResult result =
                    peel_blend(&info.arithmetic, &named, (PeelFormat)f, 2, sources[0], pixels);
                bool refuses = arithmetic_refuses(arithmetic, equation, formats[f]) != NULL;
                if (!refuses)
                    arithmetic_blend(arithmetic, equation, formats[f], 2, sources, expected);
                ck_assert_int_eq(result, refuses ? PEEL_UNSUPPORTED : PEEL_OK);
                ck_assert_mem_eq(pixels, expected, sizeof pixels);
                blended += !refuses;
                refused += refuses;
            }
    ck_assert_int_gt(blended, 1000);
    ck_assert_int_gt(refused, 100);
}
END_TEST

/* What every function that computes makes of some numbers. */
typedef struct Computed {
    float values[256], fetched[4], pixel[4], exact_pixel[4];
    uint8_t stored[4];
    uint16_t halves[4];
    PeelDifference difference;
} Computed;

static void compute(Computed *out)
{
    static const float source[4] = {0.1f, 0.2f, 0.3f, 0.4f}, pixel[4] = {0.7f, 0.6f, 0.5f, 0.3f};
    const PeelArithmetic separate = {.kind = PEEL_STEPS};
    memset(out, 0, sizeof *out);
    memcpy(out->pixel, pixel, sizeof pixel);
    memcpy(out->exact_pixel, pixel, sizeof pixel);
    for (int i = 0; i < 256; i++) {
        uint8_t code[4] = {(uint8_t)i, 0, 0, 0};
        GOOD(peel_value(PEEL_RGBA8, code, 0, &out->values[i]));
    }
    GOOD(peel_store(PEEL_RGBA8, 1, pixel, out->stored));
    GOOD(peel_fetch(PEEL_RGBA8, 1, out->stored, out->fetched));
    GOOD(peel_blend(&separate, &under, PEEL_RGBA32F, 1, source, out->pixel));
    GOOD(peel_blend(&exact, &under, PEEL_RGBA32F, 1, source, out->exact_pixel));
    GOOD(peel_store(PEEL_RGBA16F, 1, pixel, out->halves));
    GOOD(peel_blend(&driver, &under, PEEL_RGBA16F, 1, source, out->halves));
    GOOD(peel_compare(PEEL_RGBA32F, 1, 1, source, pixel, &out->difference));
}

/* Rounding upward in the caller does not reach the library, and stays. */
START_TEST(test_environment)
{
    static Computed plain, upward;
    compute(&plain);
    ck_assert_int_eq(fesetround(FE_UPWARD), 0);
    compute(&upward);
    int left = fegetround();
    fesetround(FE_TONEAREST);
    ck_assert_int_eq(left, FE_UPWARD);
    ck_assert_mem_eq(&plain, &upward, sizeof plain);
}
END_TEST

/* ---- comparing ---- */

START_TEST(test_compare)
{
    const float a[8] = {0, 1, 2, 1, 0, NAN, INFINITY, 1};
    const float b[8] = {0, 1, 2.5f, 1, 0x1p-149f, -NAN, INFINITY, 0.5f};
    PeelDifference found;
    GOOD(peel_compare(PEEL_RGBA32F, 2, 1, a, b, &found));
    ck_assert_uint_eq(found.pixels, 2);
    ck_assert_uint_eq(found.differing, 2);
    ck_assert_uint_eq(found.values, 8);
    ck_assert_uint_eq(found.differing_values, 3);
    ck_assert_uint_eq(found.nonfinite_a, 2);
    ck_assert_uint_eq(found.broken, 0);
    ck_assert_double_eq(found.max, 0.5);
    ck_assert_double_eq(found.rms, sqrt(0.5 / 6.0));
    ck_assert_int_eq(found.max_at[0], 0);
    ck_assert_int_eq(found.max_at[2], 2);
    ck_assert_int_eq(found.first[2], 2);
    ck_assert_uint_eq(found.channel_max_ulp[0], 1);
    ck_assert_uint_eq(found.max_ulp, 1u << 23);

    GOOD(peel_compare(PEEL_RG32F, 4, 1, a, a, &found));
    ck_assert_uint_eq(found.differing, 0);
    ck_assert_double_eq(found.max, 0.0);
    ck_assert(isinf(found.psnr));
    ck_assert_int_eq(found.max_at[0], -1);
    ck_assert_int_eq(found.first[0], -1);

    const uint8_t dark[4] = {0, 0, 0, 0}, bright[4] = {0, 51, 0, 0};
    GOOD(peel_compare(PEEL_RGBA8, 1, 1, dark, bright, &found));
    ck_assert_double_eq_tol(found.max, 0.2, 1e-7);
    ck_assert_uint_eq(found.max_ulp, 51);

    BAD("a is NULL", peel_compare(PEEL_RGBA32F, 2, 1, NULL, b, &found));
    BAD("b is NULL", peel_compare(PEEL_RGBA32F, 2, 1, a, NULL, &found));
    BAD("out is NULL", peel_compare(PEEL_RGBA32F, 2, 1, a, b, NULL));
    BAD("77 is no format", peel_compare((PeelFormat)NONE, 2, 1, a, b, &found));
    BAD("size 0×1", peel_compare(PEEL_RGBA32F, 0, 1, a, b, &found));
    BAD("size 1×-1", peel_compare(PEEL_RGBA32F, 1, -1, a, b, &found));
    BAD("size 65536×32768", peel_compare(PEEL_RGBA32F, 65536, 32768, a, b, &found));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("library");
    TCase *tcase = tcase_create("library");
    tcase_set_timeout(tcase, 120);
    tcase_add_test(tcase, test_version);
    tcase_add_test(tcase, test_formats);
    tcase_add_test(tcase, test_store_and_fetch);
    tcase_add_test(tcase, test_ulp_and_clear);
    tcase_add_test(tcase, test_names);
    tcase_add_test(tcase, test_blend);
    tcase_add_test(tcase, test_blend_fields);
    tcase_add_test(tcase, test_blend_is_the_arithmetic);
    tcase_add_test(tcase, test_environment);
    tcase_add_test(tcase, test_compare);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

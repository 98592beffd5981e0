/* number/hexfloat.h against the C library's "%a" and strtof. */
#include "testing.h"

#include "base/random.h"
#include "number/hexfloat.h"

#include <math.h>
#include <stdio.h>

static float from_bits(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static void check(uint32_t bits)
{
    float x = from_bits(bits), back;
    char got[HEXFLOAT_TEXT], expected[64];
    snprintf(expected, sizeof expected, "%a", isnan(x) ? fabs((double)NAN) : (double)x);
    const char *end = hexfloat_print(x, got);
    if (strcmp(got, expected) != 0 || end != got + strlen(got))
        ck_abort_msg("%08x: got %s, expected %s", bits, got, expected);
    if (!hexfloat_parse(got, &back) || (isnan(x) ? !isnan(back) : testing_bits(back) != bits))
        ck_abort_msg("%s does not read back", got);
}

START_TEST(test_as_the_library)
{
    static const uint32_t ends[] = {0,          1,          2,          3,
                                    0x7ffffe,   0x7fffff,   0x800000,   0x3f800000,
                                    0x7f7fffff, 0x7f800000, 0x7f800001, 0x7fc00000};
    Random random = random_seed(1);
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        check(ends[i]);
        check(ends[i] | 0x80000000u);
    }
    for (int bit = 0; bit < 32; bit++)
        check(1u << bit);
    for (int i = 0; i < 1000000; i++)
        check((uint32_t)(random_bits(&random) >> (i % 33)));
}
END_TEST

START_TEST(test_other_spellings)
{
    static const struct {
        const char *text;
        float value;
    } rows[] = {
        {"0X1P4", 16.0f},
        {"+0x.8", 0.5f},
        {"0x10", 16.0f},
        {"0x10.", 16.0f},
        {"-0x0.0000000000000000000000p99999999999999999999", -0.0f},
        {"0x1.8000000000000p-1", 0.75f},
        {"0x0000000000000000000000001p0", 1.0f},
        {"0x100000000000000000000000p-92", 1.0f},
        {"0x0.00000000000000000000001p+92", 1.0f},
        {"0x8p-152", 0x1p-149f},
        {"0x0.fffffep-126", 0x1.fffffcp-127f},
        {"0xffffffp104", 0x1.fffffep127f},
        {"INF", INFINITY},
        {"-Infinity", -INFINITY},
        {"+inf", INFINITY},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        float got = 9.0f;
        ck_assert_msg(hexfloat_parse(rows[i].text, &got), "%s", rows[i].text);
        ck_assert_float_bits(got, rows[i].value);
    }
    static const char *const nans[] = {"nan", "-nan", "NaN", "nan(0x1)", "-nan(ind)"};
    for (size_t i = 0; i < sizeof nans / sizeof *nans; i++) {
        float got = 9.0f;
        ck_assert(hexfloat_parse(nans[i], &got) && isnan(got));
    }
}
END_TEST

START_TEST(test_refused)
{
    static const char *const texts[] = {
        "",
        "-",
        "0",
        "1",
        "0.5",
        "1p0",
        "0x",
        "0x.",
        "0xg",
        "0x1.8q1",
        "0x1p",
        "0x1p+",
        "0x1p1x",
        "0x1.2.3",
        "0x1 ",
        " 0x1",
        "--0x1",
        "0x1.000001p0",
        "0x1.0000000000000000000001p0",
        "0x1p-150",
        "0x1p128",
        "0x1.ffffffp127",
        "0x1p99999999999999999999",
        "in",
        "infin",
        "nanx",
        "nan(",
        "0x1p-99999999999999999999",
        "0x3p-150",
        "0x1000000000000000000000001p-96",
    };
    float got;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        ck_assert_msg(!hexfloat_parse(texts[i], &got), "'%s' is read as %a", texts[i], (double)got);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hexfloat");
    TCase *tcase = tcase_create("hexfloat");
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_as_the_library);
    tcase_add_test(tcase, test_other_spellings);
    tcase_add_test(tcase, test_refused);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

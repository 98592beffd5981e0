/* Exact numbers, and numbers as people write them. */
#include "testing.h"

#include "base/random.h"
#include "number/numeral.h"

#include <math.h>

static void read_number(const char *text, Rational *out)
{
    ck_assert_msg(numeral_read(text, strlen(text), out) == RESULT_OK, "%s: %s", text,
                  result_message());
}

static void check_fraction(const Rational *number, const char *expected)
{
    char *text = numeral_fraction(number);
    ck_assert_str_eq(text, expected);
    free(text);
}

START_TEST(numbers_are_read_exactly)
{
    static const struct {
        const char *text, *fraction;
    } cases[] = {
        {"0.5", "1/2"},         {"  -1/3\r\n", "-1/3"},
        {"128/255", "128/255"}, {"0x1.8p-1", "3/4"},
        {"0X.8P+1", "1"},       {"1e-3", "1/1000"},
        {"+2.5E2", "250"},      {"0.1", "1/10"},
        {"1/2^12", "1/2^12"},   {"3*2^20", "3*2^20"},
        {"-2^20", "-2^20"},     {"0x1p-149", "1/2^149"},
        {"0.5/0.25", "2"},      {"-Inf", "-inf"},
        {"nan", "nan"},         {"-0", "-0"},
        {"0/5", "0"},           {"340282346638528859811704183484516925440", "16777215*2^104"},
        {"infinity", "inf"},    {"1/1024", "1/1024"},
        {"1/2048", "1/2^11"},
    };
    Rational number, again;
    rational_init(&number);
    rational_init(&again);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        read_number(cases[i].text, &number);
        check_fraction(&number, cases[i].fraction);
        read_number(cases[i].fraction, &again);
        ck_assert(rational_equal(&number, &again));
        ck_assert_int_eq(number.negative, again.negative);
    }
    rational_clear(&number);
    rational_clear(&again);
}
END_TEST

START_TEST(bad_numbers_are_refused)
{
    static const struct {
        const char *text, *problem;
    } cases[] = {
        {"", "no number"},     {"x", "no number"},       {"1/0", "division by 0"},
        {"1//2", "no number"}, {"0x", "without digits"}, {"1e", "without digits"},
        {"1e99999", "9999"},   {"3^2", "power"},         {"1 2", "behind"},
        {"1/2/3", "behind"},   {"--1", "no number"},     {"0.5f", "behind"},
        {"nano", "no number"}, {"1/nan", "no number"},   {"0x1g", "behind"},
    };
    char digits[1100];
    Rational number;
    rational_init(&number);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ck_assert_int_eq(numeral_read(cases[i].text, strlen(cases[i].text), &number),
                         RESULT_BAD_INPUT);
        ck_assert_msg(strstr(result_message(), cases[i].problem) != NULL, "%s: %s", cases[i].text,
                      result_message());
        ck_assert_ptr_nonnull(strstr(result_message(), "expected a number"));
    }
    memset(digits, '1', sizeof digits);
    ck_assert_int_eq(numeral_read(digits, sizeof digits, &number), RESULT_BAD_INPUT);
    ck_assert_int_eq(numeral_read("1\0"
                                  "2",
                                  3, &number),
                     RESULT_BAD_INPUT);
    rational_clear(&number);
}
END_TEST

START_TEST(numbers_are_rounded_to_nearest_even)
{
    static const struct {
        const char *text;
        uint32_t single, half;
    } cases[] = {
        {"1/3", 0x3eaaaaab, 0x3555},
        {"-1/3", 0xbeaaaaab, 0xb555},
        {"0x1.000001p0", 0x3f800000, 0x3c00}, /* a tie, to even */
        {"0x1.000003p0", 0x3f800002, 0x3c00}, /* a tie, to even */
        {"0x1.0000010000000000001p0", 0x3f800001, 0x3c00},
        {"0x1.002p0", 0x3f801000, 0x3c00}, /* a half's tie */
        {"0x1.006p0", 0x3f803000, 0x3c02},
        {"0x1p-149", 1, 0},
        {"0x1p-150", 0, 0},
        {"0x1.8p-150", 1, 0},
        {"0x1.fffffep-127", 0x00800000, 0}, /* halfway to the least normal */
        {"0x1p-25", 0x33000000, 0},
        {"0x1.8p-25", 0x33400000, 1},
        {"65519.99", 0x477feffd, 0x7bff},
        {"65520", 0x477ff000, 0x7c00},
        {"0x1.fffffefp127", 0x7f7fffff, 0x7c00},
        {"0x1.ffffffp127", 0x7f800000, 0x7c00},
        {"-1e999", 0xff800000, 0xfc00},
        {"-0", 0x80000000, 0x8000},
        {"nan", 0x7fc00000, 0x7e00},
    };
    Rational number;
    rational_init(&number);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        read_number(cases[i].text, &number);
        ck_assert_msg(rational_store(&number, FORMAT_RGBA32F) == cases[i].single,
                      "%s as a float: %08x, expected %08x", cases[i].text,
                      rational_store(&number, FORMAT_RGBA32F), cases[i].single);
        ck_assert_msg(rational_store(&number, FORMAT_RGBA16F) == cases[i].half,
                      "%s as a half: %04x, expected %04x", cases[i].text,
                      rational_store(&number, FORMAT_RGBA16F), cases[i].half);
    }
    rational_clear(&number);
}
END_TEST

START_TEST(stored_numbers_come_back)
{
    Rational number;
    rational_init(&number);
    for (uint32_t half = 0; half < 0x7c00; half++) {
        rational_fetch(half, FORMAT_RGBA16F, &number);
        ck_assert_uint_eq(rational_store(&number, FORMAT_RGBA16F), half);
    }
    for (uint32_t code = 0; code < 65536; code++) {
        rational_fetch(code, FORMAT_RGBA16, &number);
        ck_assert_uint_eq(rational_store(&number, FORMAT_RGBA16), code);
    }
    read_number("-3", &number);
    ck_assert_uint_eq(rational_store(&number, FORMAT_RGBA8), 0);
    read_number("inf", &number);
    ck_assert_uint_eq(rational_store(&number, FORMAT_RGBA8), 255);
    read_number("127.5/255", &number);
    ck_assert_uint_eq(rational_store(&number, FORMAT_RGBA8), 128);
    read_number("126.5/255", &number);
    ck_assert_uint_eq(rational_store(&number, FORMAT_RGBA8), 126);
    rational_clear(&number);
}
END_TEST

START_TEST(decimals_are_the_shortest_that_read_back)
{
    char text[NUMERAL_MAX], both[NUMERAL_BOTH];
    ck_assert_str_eq(numeral_float((double)0.1f, text), "0.1");
    ck_assert_str_eq(numeral_float((double)(1.0f / 3.0f), text), "0.33333334");
    ck_assert_str_eq(numeral_double(1.0 / 3.0, text), "0.3333333333333333");
    ck_assert_str_eq(numeral_float(1234567.0, text), "1234567");
    ck_assert_str_eq(numeral_float(-0.0, text), "-0");
    ck_assert_str_eq(numeral_float((double)0x1p-149f, text), "1e-45");
    ck_assert_str_eq(numeral_float(-NAN, text), "nan");
    ck_assert_str_eq(numeral_float(-INFINITY, text), "-inf");
    ck_assert_str_eq(numeral_hex(0.75, text), "0x1.8p-1");
    ck_assert_str_eq(numeral_hex(-NAN, text), "nan");
    ck_assert_str_eq(numeral_both(0.75, both), "0.75 (0x1.8p-1)");
    Random random = random_seed(7);
    for (int i = 0; i < 20000; i++) {
        uint32_t bits = (uint32_t)random_bits(&random);
        float x;
        memcpy(&x, &bits, sizeof x);
        if (x == x)
            ck_assert_float_bits(strtof(numeral_float((double)x, text), NULL), x);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("numeral");
    TCase *tcase = tcase_create("numeral");
    tcase_add_test(tcase, numbers_are_read_exactly);
    tcase_add_test(tcase, bad_numbers_are_refused);
    tcase_add_test(tcase, numbers_are_rounded_to_nearest_even);
    tcase_add_test(tcase, stored_numbers_come_back);
    tcase_add_test(tcase, decimals_are_the_shortest_that_read_back);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

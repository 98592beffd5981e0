/* What the build asks of the compiler: operations as written, each rounded once. */
#include "testing.h"

/* gcc 12.2 at -O2 compiles these two lines to a move of 16 bytes, unless its SLP vectorizer is
 * off: the rounding to float is lost. */
static __attribute__((noinline)) void round_pair(double a, double b, double out[2])
{
    out[0] = (double)(float)a;
    out[1] = (double)(float)b;
}

static __attribute__((noinline)) float multiply_add(float a, float b, float c)
{
    return a * b + c;
}

START_TEST(test_pairs_are_rounded)
{
    double out[2];
    round_pair(0.1, 0.3, out);
    ck_assert(out[0] == 0x1.99999ap-4);
    ck_assert(out[1] == 0x1.333334p-2);
}
END_TEST

START_TEST(test_no_contraction)
{
    float a = 1.0f + 0x1p-12f;
    /* a² = 1 + 2^-11 + 2^-24: the last term is lost in the product, and kept by a fused one. */
    ck_assert_float_bits(multiply_add(a, a, -1.0f), 0x1p-11f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("compiler");
    TCase *tcase = tcase_create("rounding");
    tcase_add_test(tcase, test_pairs_are_rounded);
    tcase_add_test(tcase, test_no_contraction);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

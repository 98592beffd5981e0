/* number/op.h: against MPFR and libm, software flushing against the processor's, edge values.
 * tests/cross/test_arithmetic.c holds the same operations against the driver. */
#include "testing.h"

#define OP_TABLE op_hardware
#include "op_table.h"

#include "base/random.h"

#include <fenv.h>
#include <float.h>
#include <math.h>
#include <mpfr.h>
#include <stdio.h>

static const float special[] = {
    0.0f,
    -0.0f,
    1.0f,
    -1.0f,
    0x1p-126f,
    -0x1p-126f,
    0x1p-149f,
    -0x1p-149f,
    0x1.fffffcp-127f,
    FLT_MAX,
    -FLT_MAX,
    INFINITY,
    -INFINITY,
    NAN,
    0x1p-63f,
    -0x1p-63f,
    0x1.fffffep-64f,
    0x1.000002p-63f,
    0.5f,
    255.0f,
    16777216.0f,
    2147483520.0f,
    2147483648.0f,
    -2147483648.0f,
    128.0f,
    -126.99999f,
    3.0f,
    0x1.fffffep-1f,
};
enum {
    SPECIAL_COUNT = sizeof special / sizeof special[0],
    RANDOM_COUNT = 1000000
};

/* The bounds stated in op.h. */
#define OP_EXP2_ERROR        2.7e-7
#define OP_LOG2_ERROR        2.2e-7
#define OP_POW_DISPLAY_ERROR 4.6e-7

static uint32_t saved_mode;

static void enter_mode(void)
{
    saved_mode = op_enter();
}

static void leave_mode(void)
{
    op_leave(saved_mode);
}

/* Any bits, with many denormals, special values, and values whose products lie around 2^-126. */
static float draw(Random *random)
{
    uint32_t bits = (uint32_t)random_bits(random);
    switch (random_bits(random) % 8) {
    case 0:
        return op_from_bits(bits & 0x807fffffu);
    case 1:
        return special[bits % SPECIAL_COUNT];
    case 2:
        return op_from_bits((bits & 0x807fffffu) | (60u + (bits >> 24) % 8) << 23);
    case 3:
        return op_from_bits((bits & 0x80ffffffu) + 0x00400000u);
    case 4:
        return op_from_bits((bits & 0x807fffffu) | 127u << 23);
    default:
        return op_from_bits(bits);
    }
}

/* Two NaNs agree whatever their bits: they are made canonical where stored. */
static bool same(float a, float b)
{
    return op_bits(a) == op_bits(b) || (a != a && b != b);
}

/* ck_assert writes to a pipe each time; these loops run millions of times. */
static void check_same(const char *name, float got, float expected, float a, float b, float c)
{
    if (!same(got, expected))
        ck_abort_msg("%s(%a, %a, %a): got %a, expected %a", name, (double)a, (double)b, (double)c,
                     (double)got, (double)expected);
}

/* ---- software flushing ------------------------------------------------------------------------
 */

static void compare_all(float a, float b, float c)
{
    static const char *const binary[] = {"add", "sub", "mul", "div", "min", "max"};
    static const char *const unary[] = {"sqrt", "saturate", "inversesqrt"};
    const OpTable *hard = &op_hardware, *soft = &op_software;
    for (int i = 0; i < 6; i++)
        check_same(binary[i], soft->binary[i](a, b), hard->binary[i](a, b), a, b, 0.0f);
    for (int i = 0; i < 3; i++)
        check_same(unary[i], soft->unary[i](a), hard->unary[i](a), a, 0.0f, 0.0f);
    check_same("fma", soft->fma(a, b, c), hard->fma(a, b, c), a, b, c);
    check_same("mix", soft->mix(a, b, c), hard->mix(a, b, c), a, b, c);
    for (int fused = 0; fused < 2; fused++) {
        check_same("muladd", soft->muladd[fused](a, b, c), hard->muladd[fused](a, b, c), a, b, c);
        check_same("exp2", soft->exp2[fused](a), hard->exp2[fused](a), a, 0.0f, 0.0f);
        check_same("log2", soft->log2[fused](a), hard->log2[fused](a), a, 0.0f, 0.0f);
        check_same("pow", soft->pow[fused](a, b), hard->pow[fused](a, b), a, b, 0.0f);
    }
    if (soft->round_to_int(a) != hard->round_to_int(a))
        ck_abort_msg("round_to_int(%a): %d, %d", (double)a, soft->round_to_int(a),
                     hard->round_to_int(a));
}

START_TEST(test_software_flush_random)
{
    Random random = random_seed(1);
    for (int i = 0; i < RANDOM_COUNT; i++) {
        float a = draw(&random), b = draw(&random), c = draw(&random);
        if (i % 4 == 0) /* what the sum nearly cancels */
            c = -op_hardware.binary[2](a, b);
        compare_all(a, b, c);
    }
}
END_TEST

START_TEST(test_software_flush_special)
{
    for (int i = 0; i < SPECIAL_COUNT; i++)
        for (int j = 0; j < SPECIAL_COUNT; j++)
            for (int k = 0; k < SPECIAL_COUNT; k++)
                compare_all(special[i], special[j], special[k]);
}
END_TEST

START_TEST(test_flush_edge)
{
    /* Tiny after rounding to 24 bits is flushed; what rounds up to 2^-126 is not: 2^-151 below it
     * is the tie. */
    const struct {
        float a, b, expected;
    } products[] = {
        {0x1.fffffep-64f, 0x1p-63f, 0.0f},             /* 2^-126 − 2^-150 */
        {0x1.fffffep-64f, 0x1.000002p-63f, 0x1p-126f}, /* 2^-126 + 2^-150 − 2^-173 */
        {0x1.555556p-64f, 0x1.8p-63f, 0x1p-126f},
        {0x1p-63f, 0x1p-63f, 0x1p-126f},
        {-0x1p-64f, 0x1p-63f, -0.0f},
        {0x1p-149f, 0x1p+127f, 0.0f}, /* a denormal operand is zero */
        {-0x1p-149f, FLT_MAX, -0.0f},
    };
    for (size_t i = 0; i < sizeof products / sizeof products[0]; i++) {
        volatile float a = products[i].a, b = products[i].b; /* not folded by the compiler */
        ck_assert_float_bits(op_hardware.binary[2](a, b), products[i].expected);
        ck_assert_float_bits(op_software.binary[2](a, b), products[i].expected);
        ck_assert_float_bits(op_hardware.fma(a, b, -0.0f), products[i].expected);
        ck_assert_float_bits(op_software.fma(a, b, -0.0f), products[i].expected);
    }
    volatile double tie = 0x1p-126 * (1.0 - 0x1p-25), below = nextafter(tie, 0.0);
    ck_assert_float_bits(op_hardware.narrow(tie), 0x1p-126f);
    ck_assert_float_bits(op_software.narrow(tie), 0x1p-126f);
    ck_assert_float_bits(op_hardware.narrow(below), 0.0f);
    ck_assert_float_bits(op_software.narrow(-below), -0.0f);
    ck_assert_float_bits(op_flush(op_from_bits(0x807fffffu)), -0.0f);
    ck_assert_float_bits(op_flush(0x1p-126f), 0x1p-126f);
}
END_TEST

/* ---- against exact arithmetic -----------------------------------------------------------------
 */

typedef enum Exact {
    EXACT_ADD,
    EXACT_SUB,
    EXACT_MUL,
    EXACT_DIV,
    EXACT_SQRT,
    EXACT_FMA
} Exact;

/* One operation rounded once to 24 bits with any exponent, then flushed: MPFR in the place of the
 * processor. */
static float exact(Exact operation, float a, float b, float c)
{
    mpfr_t x, y, z, r;
    mpfr_inits2(24, x, y, z, r, (mpfr_ptr)0);
    mpfr_set_flt(x, op_flush(a), MPFR_RNDN);
    mpfr_set_flt(y, op_flush(b), MPFR_RNDN);
    mpfr_set_flt(z, op_flush(c), MPFR_RNDN);
    switch (operation) {
    case EXACT_ADD:
        mpfr_add(r, x, y, MPFR_RNDN);
        break;
    case EXACT_SUB:
        mpfr_sub(r, x, y, MPFR_RNDN);
        break;
    case EXACT_MUL:
        mpfr_mul(r, x, y, MPFR_RNDN);
        break;
    case EXACT_DIV:
        mpfr_div(r, x, y, MPFR_RNDN);
        break;
    case EXACT_SQRT:
        mpfr_sqrt(r, x, MPFR_RNDN);
        break;
    case EXACT_FMA:
        mpfr_fma(r, x, y, z, MPFR_RNDN);
        break;
    }
    bool tiny = mpfr_regular_p(r) && mpfr_get_exp(r) <= -126; /* significand in [1/2, 1) */
    float rounded = mpfr_get_flt(r, MPFR_RNDN);
    float result = tiny ? copysignf(0.0f, mpfr_signbit(r) ? -1.0f : 1.0f) : rounded;
    mpfr_clears(x, y, z, r, (mpfr_ptr)0);
    return result;
}

START_TEST(test_exact)
{
    const OpTable *table = _i ? &op_software : &op_hardware;
    Random random = random_seed(2);
    for (int i = 0; i < 100000; i++) {
        float a = draw(&random), b = draw(&random), c = draw(&random);
        if (i % 3 == 0)
            c = -(op_mul(a, b));
        for (int k = EXACT_ADD; k <= EXACT_DIV; k++)
            check_same("binary", table->binary[k](a, b), exact((Exact)k, a, b, 0.0f), a, b, 0.0f);
        check_same("sqrt", table->unary[0](a), exact(EXACT_SQRT, a, 0.0f, 0.0f), a, 0.0f, 0.0f);
        check_same("fma", table->fma(a, b, c), exact(EXACT_FMA, a, b, c), a, b, c);
    }
}
END_TEST

/* Also what the C library says, on more values; where it cannot flush the result it is not asked.
 */
START_TEST(test_fma_libm)
{
    Random random = random_seed(3);
    for (int i = 0; i < RANDOM_COUNT; i++) {
        float a = op_flush(draw(&random)), b = op_flush(draw(&random));
        float c = op_flush(i & 1 ? draw(&random) : -op_mul(a, b));
        float expected = fmaf(a, b, c);
        if (expected == 0.0f || !(fabsf(expected) <= 0x1p-126f)) {
            check_same("fma", op_hardware.fma(a, b, c), expected, a, b, c);
            check_same("fma", op_software.fma(a, b, c), expected, a, b, c);
        }
    }
}
END_TEST

/* The caller's rounding is put aside, and comes back; in either way of flushing. */
START_TEST(test_rounding_mode)
{
    static const int modes[] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    const OpTable *table = _i ? &op_software : &op_hardware;
    for (size_t k = 0; k < sizeof modes / sizeof *modes; k++) {
        ck_assert_int_eq(fesetround(modes[k]), 0);
        float before = table->binary[3](-1.0f, 3.0f);
        uint32_t saved = table->enter();
        float third = table->binary[3](1.0f, 3.0f), minus = table->binary[3](-1.0f, 3.0f);
        table->leave(saved);
        float after = table->binary[3](-1.0f, 3.0f);
        fesetround(FE_TONEAREST);
        ck_assert_float_bits(before, k % 2 ? -0x1.555554p-2f : -0x1.555556p-2f);
        ck_assert_float_bits(after, before);
        ck_assert_float_bits(third, 0x1.555556p-2f);
        ck_assert_float_bits(minus, -0x1.555556p-2f);
    }
}
END_TEST

START_TEST(test_muladd)
{
    /* (1 + 2^-12)² − (1 + 2^-11): the product's last bit, 2^-24, survives only when fused. */
    float a = 0x1.001p+0f, c = -0x1.002p+0f;
    ck_assert_float_bits(op_muladd(true, a, a, c), 0x1p-24f);
    ck_assert_float_bits(op_muladd(false, a, a, c), 0.0f);
    ck_assert_float_bits(op_fma(a, a, c), 0x1p-24f);
}
END_TEST

START_TEST(test_order)
{
    /* The last two terms cancel first, so the small one survives; from the front it is lost. */
    const float x[3] = {1.0f, 33554432.0f, -33554432.0f}, one[3] = {1.0f, 1.0f, 1.0f};
    ck_assert_float_bits(op_dot3(x, one), 1.0f);
    const float y[3] = {33554432.0f, -33554432.0f, 1.0f};
    ck_assert_float_bits(op_dot3(y, one), 0.0f);
    /* Products are rounded before they are added. */
    const float z[3] = {0x1.001p+0f, 1.0f, 0.0f}, w[3] = {0x1.001p+0f, -0x1.002p+0f, 0.0f};
    ck_assert_float_bits(op_dot3(z, w), 0.0f);
    /* a·(1 − t) + b·t, not a + t·(b − a): that gives 2 here, as b − a is rounded. */
    float a = 16777218.0f, b = 1.0f, t = 1.0f;
    ck_assert_float_bits(op_mix(a, b, t), 1.0f);
    ck_assert_float_bits(op_mix(0.04f, 0.7f, 0.3f),
                         op_add(op_mul(0.04f, op_sub(1.0f, 0.3f)), op_mul(0.7f, 0.3f)));
    ck_assert_float_bits(op_inversesqrt(2.0f), 1.0f / sqrtf(2.0f));
}
END_TEST

START_TEST(test_min_max_saturate)
{
    float denormal = op_from_bits(0x80000001u);
    ck_assert_float_bits(op_min(1.0f, NAN), 1.0f);
    ck_assert_float_bits(op_max(1.0f, NAN), 1.0f);
    ck_assert_float_bits(op_min(NAN, 1.0f), 1.0f);
    ck_assert_float_bits(op_max(NAN, 1.0f), 1.0f);
    ck_assert_float_bits(op_min(denormal, NAN), denormal); /* as it is */
    ck_assert_float_bits(op_min(0.0f, -0.0f), -0.0f);      /* equal: b */
    ck_assert_float_bits(op_min(-0.0f, 0.0f), 0.0f);
    ck_assert_float_bits(op_max(0.0f, -0.0f), -0.0f);
    ck_assert_float_bits(op_max(denormal, -1.0f), -0.0f);
    ck_assert_float_bits(op_min(2.0f, -3.0f), -3.0f);
    ck_assert_float_bits(op_max(2.0f, -3.0f), 2.0f);
    ck_assert_float_bits(op_saturate(NAN), 0.0f);
    ck_assert_float_bits(op_saturate(-NAN), 0.0f);
    ck_assert_float_bits(op_saturate(INFINITY), 1.0f);
    ck_assert_float_bits(op_saturate(-0.0f), 0.0f);
    ck_assert_float_bits(op_saturate(0x1p-149f), 0.0f);
    ck_assert_float_bits(op_saturate(0.75f), 0.75f);
    ck_assert_float_bits(op_neg(0.0f), -0.0f);
    ck_assert_float_bits(op_abs(-2.5f), 2.5f);
    ck_assert_uint_eq(op_bits(op_canonical(op_from_bits(0xffc12345u))), 0x7fc00000u);
    ck_assert_float_bits(op_canonical(-INFINITY), -INFINITY);
}
END_TEST

START_TEST(test_round_to_int)
{
    const struct {
        float x;
        int32_t expected;
    } rows[] = {
        {0.5f, 0},
        {1.5f, 2},
        {2.5f, 2},
        {-0.5f, 0},
        {-1.5f, -2},
        {8388607.5f, 8388608},
        {NAN, INT32_MIN},
        {INFINITY, INT32_MIN},
        {2147483648.0f, INT32_MIN},
        {-2147483648.0f, INT32_MIN},
        {2147483520.0f, 2147483520},
        {-3e9f, INT32_MIN},
        {0x1.fffffep-2f, 0},
        {0x1.000002p-1f, 1},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        ck_assert_int_eq(op_hardware.round_to_int(rows[i].x), rows[i].expected);
        ck_assert_int_eq(op_software.round_to_int(rows[i].x), rows[i].expected);
    }
}
END_TEST

/* ---- polynomials ------------------------------------------------------------------------------
 */

/* The greatest error over a sweep and where it is, for the bounds that op.h states. */
typedef struct Worst {
    double error;
    float at;
} Worst;

static void worst_add(Worst *worst, double error, float at)
{
    if (error > worst->error)
        *worst = (Worst){error, at};
}

/* Within the bound, and the bound is not loose. */
#define CHECK_WORST(name, fused, worst, bound)                                                     \
    do {                                                                                           \
        if (getenv("PEEL_PRINT_ERRORS"))                                                           \
            fprintf(stderr, "%s fused %d: %.4g at %a\n", name, fused, (worst).error,               \
                    (double)(worst).at);                                                           \
        ck_assert_msg((worst).error <= (bound), "%s(%a), fused %d: error %.4g, stated %.4g", name, \
                      (double)(worst).at, fused, (worst).error, bound);                            \
        ck_assert_msg((worst).error > 0.5 * (bound), "%s, fused %d: error %.4g, stated %.4g",      \
                      name, fused, (worst).error, bound);                                          \
    } while (0)

START_TEST(test_exp2)
{
    Worst worst = {0};
    for (uint32_t i = 0; i < 1u << 21; i++) { /* f at 2^-21 */
        float x = (float)i * 0x1p-21f;
        double truth = exp2((double)x);
        worst_add(&worst, fabs((double)op_exp2(_i, x) - truth) / truth, x);
    }
    CHECK_WORST("exp2", _i, worst, OP_EXP2_ERROR);
    for (int whole = -126; whole < 128; whole++) {
        ck_assert_float_bits(op_exp2(_i, (float)whole), ldexpf(1.0f, whole));
        ck_assert_float_bits(op_exp2(_i, (float)whole + 0.25f), ldexpf(op_exp2(_i, 0.25f), whole));
    }
    ck_assert_float_bits(op_exp2(_i, 128.0f), INFINITY);
    ck_assert_float_bits(op_exp2(_i, INFINITY), INFINITY);
    ck_assert_float_bits(op_exp2(_i, -INFINITY), op_exp2(_i, -126.99999f));
    ck_assert(isnan(op_exp2(_i, NAN)));
}
END_TEST

START_TEST(test_log2)
{
    Worst absolute = {0};
    for (uint32_t mantissa = 0; mantissa < 1u << 23; mantissa += 3) {
        float x = op_from_bits(0x3f800000u | mantissa);
        worst_add(&absolute, fabs((double)op_log2(_i, x) - log2((double)x)), x);
    }
    CHECK_WORST("log2", _i, absolute, OP_LOG2_ERROR);
    for (int power = -126; power < 128; power++)
        ck_assert_float_bits(op_log2(_i, ldexpf(1.0f, power)), (float)power);
    ck_assert_float_bits(op_log2(_i, 0.0f), -INFINITY);
    ck_assert_float_bits(op_log2(_i, -0x1p-149f), -INFINITY);
    ck_assert_float_bits(op_log2(_i, INFINITY), INFINITY);
    ck_assert(isnan(op_log2(_i, -1.0f)));
    ck_assert(isnan(op_log2(_i, NAN)));
}
END_TEST

START_TEST(test_pow)
{
    Worst worst = {0};
    for (uint32_t i = 1; i <= 1u << 20; i++) { /* the display transform's arguments */
        float x = (float)i * 0x1p-20f;
        double truth = pow((double)x, (double)0.45454547f);
        worst_add(&worst, fabs((double)op_pow(_i, x, 0.45454547f) - truth) / truth, x);
    }
    CHECK_WORST("pow", _i, worst, OP_POW_DISPLAY_ERROR);
    ck_assert_float_bits(op_pow(_i, 0.0f, 0.0f), 0.0f);
    ck_assert_float_bits(op_pow(_i, 0x1p-149f, -1.0f), 0.0f);
    ck_assert_float_bits(op_pow(_i, NAN, 2.0f), 0.0f);
    ck_assert_float_bits(op_pow(_i, 4.0f, 0.5f), 2.0f);
}
END_TEST

/* Bits that tests/cross/test_arithmetic.c has seen the driver give: a change of the polynomials is
 * noticed where there is no driver too. */
START_TEST(test_golden)
{
    uint64_t digest = 0;
    Random random = random_seed(4);
    for (int i = 0; i < 100000; i++) {
        float x = (float)random_range(&random, 0.0, 8.0), y = (float)random_unit(&random);
        const float values[] = {op_exp2(_i, x), op_log2(_i, x), op_pow(_i, x, y),
                                op_muladd(_i, x, y, x)};
        for (size_t k = 0; k < 4; k++)
            digest = (digest ^ op_bits(values[k])) * 0x100000001b3u;
    }
    static const uint64_t expected[2] = {0x98c1192b4dc30521u, 0x52eefee32327192fu};
    ck_assert_msg(digest == expected[_i], "digest, fused %d: got 0x%016llx, expected 0x%016llx", _i,
                  (unsigned long long)digest, (unsigned long long)expected[_i]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("op");
    TCase *tcase = tcase_create("op");
    tcase_add_checked_fixture(tcase, enter_mode, leave_mode);
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_software_flush_random);
    tcase_add_test(tcase, test_software_flush_special);
    tcase_add_test(tcase, test_flush_edge);
    tcase_add_loop_test(tcase, test_exact, 0, 2);
    tcase_add_test(tcase, test_fma_libm);
    tcase_add_loop_test(tcase, test_rounding_mode, 0, 2);
    tcase_add_test(tcase, test_muladd);
    tcase_add_test(tcase, test_order);
    tcase_add_test(tcase, test_min_max_saturate);
    tcase_add_test(tcase, test_round_to_int);
    tcase_add_loop_test(tcase, test_exp2, 0, 2);
    tcase_add_loop_test(tcase, test_log2, 0, 2);
    tcase_add_loop_test(tcase, test_pow, 0, 2);
    tcase_add_loop_test(tcase, test_golden, 0, 2);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

/* ref/truth/bounded.h: chains of random operations in single precision, flushing or not, and at 200
 * bits stay within the bounds; and the bounds are not vacuous. */
#include "mpfr_real.h"
#include "testing.h"

#include "base/random.h"
#include "number/op.h"
#include "ref/truth/bounded.h"

#include <stdio.h>

enum {
    NUMBERS = 12,
    STEPS = 40,
    CHAINS = 4000
};

/* The same number four times. */
typedef struct Number {
    Bounded bounded;
    float flushed, plain; /* op.h's, where the mode is its own, and C's */
    Real exact;
} Number;

typedef enum Operation {
    ADD,
    SUB,
    MUL,
    DIV,
    SQRT, /* of a square */
    INVERSESQRT,
    MAX,
    MIN,
    NEG,
    MIX,
    DOT,
    CLAMP,
    UNLESS_NEGATIVE,
    OPERATIONS
} Operation;

static const char *const operation_names[OPERATIONS] = {
    "add", "sub", "mul", "div", "sqrt",  "inversesqrt",    "max",
    "min", "neg", "mix", "dot", "clamp", "unless negative"};

static Number number_of(float x)
{
    return (Number){bounded_of(x), op_flush(x), x, real_of(x)};
}

static Number random_number(Random *random)
{
    static const float odd[] = {0.0f, 1.0f, -1.0f, 0.5f, 1e-20f, 1e-4f, 1e-39f, 3e-38f, 1e10f};
    float x = random_bits(random) % 4 ? (float)random_range(random, -2, 2)
                                      : odd[random_bits(random) % (sizeof odd / sizeof *odd)];
    return number_of(x);
}

static float plain_dot(const Number *a, const Number *b)
{
    return (a[2].plain * b[2].plain + a[1].plain * b[1].plain) + a[0].plain * b[0].plain;
}

static Number dot(const Number *a, const Number *b)
{
    Bounded ba[3], bb[3];
    float fa[3], fb[3];
    Real ra[3], rb[3];
    for (int i = 0; i < 3; i++) {
        ba[i] = a[i].bounded, bb[i] = b[i].bounded;
        fa[i] = a[i].flushed, fb[i] = b[i].flushed;
        ra[i] = a[i].exact, rb[i] = b[i].exact;
    }
    return (Number){bounded_dot(ba, bb), op_dot3(fa, fb), plain_dot(a, b), real_dot(ra, rb)};
}

static Number root(Number a, bool inverse)
{
    a = (Number){bounded_mul(a.bounded, a.bounded), op_mul(a.flushed, a.flushed), a.plain * a.plain,
                 real_mul(a.exact, a.exact)};
    if (inverse)
        return (Number){bounded_inversesqrt(a.bounded), op_inversesqrt(a.flushed),
                        1.0f / sqrtf(a.plain), real_inversesqrt(a.exact)};
    return (Number){bounded_sqrt(a.bounded), op_sqrt(a.flushed), sqrtf(a.plain),
                    real_sqrt(a.exact)};
}

static Number clamp(Number a)
{
    Number one = number_of(1.0f), zero = number_of(0.0f);
    return (Number){bounded_min(bounded_max(a.bounded, zero.bounded), one.bounded),
                    op_min(op_max(a.flushed, 0.0f), 1.0f), fminf(fmaxf(a.plain, 0.0f), 1.0f),
                    real_min(real_max(a.exact, zero.exact), one.exact)};
}

/* a, b: at least three numbers from there. */
static Number apply(Operation operation, const Number *a, const Number *b, Number t)
{
    switch (operation) {
    case ADD:
        return (Number){bounded_add(a->bounded, b->bounded), op_add(a->flushed, b->flushed),
                        a->plain + b->plain, real_add(a->exact, b->exact)};
    case SUB:
        return (Number){bounded_sub(a->bounded, b->bounded), op_sub(a->flushed, b->flushed),
                        a->plain - b->plain, real_sub(a->exact, b->exact)};
    case MUL:
        return (Number){bounded_mul(a->bounded, b->bounded), op_mul(a->flushed, b->flushed),
                        a->plain * b->plain, real_mul(a->exact, b->exact)};
    case DIV:
        return (Number){bounded_div(a->bounded, b->bounded), op_div(a->flushed, b->flushed),
                        a->plain / b->plain, real_div(a->exact, b->exact)};
    case MAX:
        return (Number){bounded_max(a->bounded, b->bounded), op_max(a->flushed, b->flushed),
                        fmaxf(a->plain, b->plain), real_max(a->exact, b->exact)};
    case MIN:
        return (Number){bounded_min(a->bounded, b->bounded), op_min(a->flushed, b->flushed),
                        fminf(a->plain, b->plain), real_min(a->exact, b->exact)};
    case NEG:
        return (Number){bounded_neg(a->bounded), op_neg(a->flushed), -a->plain, real_neg(a->exact)};
    case MIX:
        return (Number){bounded_mix(a->bounded, b->bounded, t.bounded),
                        op_mix(a->flushed, b->flushed, t.flushed),
                        a->plain * (1.0f - t.plain) + b->plain * t.plain,
                        real_mix(a->exact, b->exact, t.exact)};
    case UNLESS_NEGATIVE:
        return (Number){bounded_unless_negative(a->bounded, b->bounded),
                        a->flushed < 0.0f ? 0.0f : b->flushed, a->plain < 0.0f ? 0.0f : b->plain,
                        real_unless_negative(a->exact, b->exact)};
    case SQRT:
    case INVERSESQRT:
        return root(*a, operation == INVERSESQRT);
    case DOT:
        return dot(a, b);
    default:
        return clamp(*a);
    }
}

typedef struct Tally {
    uint64_t numbers, infinite;
    double ratios[CHAINS * STEPS]; /* of single's error over its bound */
} Tally;

/* Whether the number can be worked on. */
static bool check(const Number *n, Operation operation, Tally *tally)
{
    const Bounded *b = &n->bounded;
    const char *name = operation_names[operation];
    ck_assert_msg(b->exact >= 0.0 && b->single >= 0.0, "%s: a bound is NaN", name);
    if (!isfinite(b->value))
        return false;
    if (isfinite(b->exact)) {
        double off = real_distance(n->exact, b->value);
        ck_assert_msg(off <= b->exact, "%s: exact off by %g, bound %g", name, off, b->exact);
    }
    if (!isfinite(b->single)) {
        tally->infinite++;
        return false;
    }
    double flushed = fabs((double)n->flushed - b->value), plain = fabs((double)n->plain - b->value);
    ck_assert_msg(flushed <= b->single, "%s: %a instead of %a: off by %g, bound %g", name,
                  (double)n->flushed, b->value, flushed, b->single);
    ck_assert_msg(plain <= b->single, "%s: %a instead of %a: off by %g, bound %g", name,
                  (double)n->plain, b->value, plain, b->single);
    if (b->single > 0.0 && b->single < 0.1 * fabs(b->value))
        tally->ratios[tally->numbers++] = flushed / b->single;
    return isfinite(b->exact) && fabs(b->value) < 1e12;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static __attribute__((noinline)) void run_chains(Random *random, int steps, Tally *tally)
{
    for (int chain = 0; chain < CHAINS; chain++) {
        Number numbers[NUMBERS];
        real_empty();
        for (int i = 0; i < NUMBERS; i++)
            numbers[i] = random_number(random);
        for (int step = 0; step < steps; step++) {
            Operation operation = (Operation)(random_bits(random) % OPERATIONS);
            const Number *a = &numbers[random_bits(random) % (NUMBERS - 2)];
            const Number *b = &numbers[random_bits(random) % (NUMBERS - 2)];
            Number result = apply(operation, a, b, numbers[random_bits(random) % NUMBERS]);
            bool usable = check(&result, operation, tally);
            numbers[random_bits(random) % NUMBERS] = usable ? result : random_number(random);
        }
    }
}

/* Odd runs flush denormals, even ones do not: the bound is for both. */
START_TEST(test_chains)
{
    static Tally tally;
    Random random = random_seed(20 + (uint64_t)_i);
    uint32_t saved = _i % 2 ? op_enter() : 0;
    run_chains(&random, _i < 2 ? 4 : STEPS, &tally);
    if (_i % 2)
        op_leave(saved);
    qsort(tally.ratios, tally.numbers, sizeof *tally.ratios, ascending);
    double median = tally.ratios[tally.numbers / 2];
    printf("%d steps: %llu numbers, %llu without bound, error over bound: median %.3g, "
           "greatest %.3g\n",
           _i < 2 ? 4 : STEPS, (unsigned long long)tally.numbers,
           (unsigned long long)tally.infinite, median, tally.ratios[tally.numbers - 1]);
    fflush(stdout);
    ck_assert_double_gt(median, _i < 2 ? 0.02 : 1e-3);
    ck_assert_double_gt(tally.ratios[tally.numbers - 1], 0.9);
}
END_TEST

/* The sharpest cases by hand: one rounding, and what is known without any. */
START_TEST(test_by_hand)
{
    Bounded third = bounded_div(bounded_of(1.0), bounded_of(3.0));
    double off = fabs((double)(1.0f / 3.0f) - 1.0 / 3.0);
    ck_assert_double_le(off, third.single);
    ck_assert_double_ge(off, 0.25 * third.single);
    ck_assert_double_le(third.single, 2.01e-8);
    Bounded none = bounded_sub(bounded_of(1.0), bounded_of(1.0));
    ck_assert_double_eq(none.single, 0.0);
    ck_assert_double_eq(none.exact, 0.0);
    /* A divisor that may be 0, a root that may be 0. */
    Bounded near = bounded_sub(third, bounded_of(1.0f / 3.0f));
    ck_assert(isinf(bounded_div(bounded_of(1.0), near).single));
    ck_assert(isinf(bounded_div(none, none).single));
    ck_assert(isinf(bounded_inversesqrt(none).single));
    ck_assert(isinf(bounded_mul(bounded_div(none, none), none).single));
    /* Beyond the range of floats. */
    ck_assert(isinf(bounded_mul(bounded_of(3e38), bounded_of(3e38)).single));
    /* A comparison that is certain keeps the one bound; one that is not takes the greater. */
    ck_assert_double_eq(bounded_max(third, bounded_of(2.0)).single, 0.0);
    ck_assert_double_eq(bounded_max(near, bounded_of(0.0)).single, near.single);
    ck_assert(!bounded_may_exceed(bounded_of(0.0), 0.0));
    ck_assert(bounded_may_exceed(near, 0.0));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("truth_bounded");
    TCase *tcase = tcase_create("bounded");
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(tcase, test_chains, 0, 4);
    tcase_add_test(tcase, test_by_hand);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

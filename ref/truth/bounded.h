/* Running error analysis: a number computed in double, and how far two other computations of the
 * same expression may be from it.
 *
 * For a Bounded b made of inputs whose bounds hold,
 *   |E − b.value| ≤ b.exact    E: what exact arithmetic gives;
 *   |S − b.value| ≤ b.single   S: what single precision gives, one operation after the other as
 *                              written, each to nearest (relative error at most 2^-24), denormal
 *                              operands and results being zero or not (absolute 2^-126).
 * A bound of INFINITY says nothing and is never NaN. Every bound is rigorous, not of first order:
 * products of errors are kept, and BOUNDED_SLACK covers the rounding of the bounds themselves.
 *
 * llvmpipe's inversesqrt(x) is 1 / sqrt(x), its mix(a, b, t) a·(1 − t) + b·t, and its dot of three
 * sums from the last component to the first: measured (ref/pipeline/NUMBERS.md); the functions here
 * state it again, because the truth shares no arithmetic with the pipeline.
 *
 * Source: Higham, "Accuracy and Stability of Numerical Algorithms", 2nd edition, 2002, 3.3 (running
 * error analysis) and 2.2 (the model of rounding). */
#ifndef PEEL_REF_TRUTH_BOUNDED_H
#define PEEL_REF_TRUTH_BOUNDED_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

#define BOUNDED_SINGLE 0x1p-24   /* unit roundoff of float */
#define BOUNDED_TINY   0x1p-126  /* what flushing a denormal may lose */
#define BOUNDED_DOUBLE 0x1p-53   /* unit roundoff of value */
#define BOUNDED_LEAST  0x1p-1074 /* what underflow of value may lose */
/* A bound is computed by fewer than 32 operations in double from its operands'. */
#define BOUNDED_SLACK (1.0 + 0x1p-47)

typedef struct Bounded {
    double value, exact, single;
} Bounded;

/* NaN, of ∞·0 and ∞ − ∞, says as little as ∞. */
static inline double bounded_limit(double error)
{
    return error < (double)INFINITY ? error : (double)INFINITY;
}

/* A value, what its operands' errors make of it in exact and in single precision, and its own
 * rounding. */
static inline Bounded bounded_round(double value, double exact, double single)
{
    double size = fabs(value), own = size * BOUNDED_DOUBLE;
    double largest = (size + single) * BOUNDED_SLACK;
    if (largest > 0.0)
        single += own + largest * BOUNDED_SINGLE + BOUNDED_TINY;
    if (size + exact > 0.0)
        exact += own + BOUNDED_LEAST;
    if (!(largest <= (double)FLT_MAX)) /* may be infinite in single precision */
        single = (double)INFINITY;
    return (Bounded){value, bounded_limit(exact * BOUNDED_SLACK),
                     bounded_limit(single * BOUNDED_SLACK)};
}

/* A float, or another number that all computations begin with. */
static inline Bounded bounded_of(double value)
{
    double size = fabs(value);
    return (Bounded){value, 0.0, size < BOUNDED_TINY ? size : 0.0};
}

static inline Bounded bounded_neg(Bounded a)
{
    a.value = -a.value;
    return a;
}

static inline Bounded bounded_add(Bounded a, Bounded b)
{
    return bounded_round(a.value + b.value, a.exact + b.exact, a.single + b.single);
}

static inline Bounded bounded_sub(Bounded a, Bounded b)
{
    return bounded_round(a.value - b.value, a.exact + b.exact, a.single + b.single);
}

/* |â·b̂ − a·b| for |â − a| ≤ da and |b̂ − b| ≤ db. */
static inline double bounded_product_error(double a, double da, double b, double db)
{
    return fabs(a) * db + fabs(b) * da + da * db;
}

static inline Bounded bounded_mul(Bounded a, Bounded b)
{
    return bounded_round(a.value * b.value,
                         bounded_product_error(a.value, a.exact, b.value, b.exact),
                         bounded_product_error(a.value, a.single, b.value, b.single));
}

/* |â/b̂ − q| for q = a/b: ∞ where b̂ may be 0. */
static inline double bounded_quotient_error(double q, double da, double b, double db)
{
    double least = fabs(b) - db;
    return least > 0.0 ? (da + fabs(q) * db) / least : (double)INFINITY;
}

static inline Bounded bounded_div(Bounded a, Bounded b)
{
    double q = b.value != 0.0 ? a.value / b.value : 0.0;
    return bounded_round(q, bounded_quotient_error(q, a.exact, b.value, b.exact),
                         bounded_quotient_error(q, a.single, b.value, b.single));
}

/* |√â − r| for r = √a, a and â from 0. */
static inline double bounded_root_error(double a, double r, double da)
{
    double least = a - da;
    return da > 0.0 ? da / (r + (least > 0.0 ? sqrt(least) : 0.0)) : 0.0;
}

/* a: not negative in any of the computations. */
static inline Bounded bounded_sqrt(Bounded a)
{
    double r = sqrt(a.value > 0.0 ? a.value : 0.0);
    if (r == 0.0)
        return bounded_round(0.0, sqrt(a.exact), sqrt(a.single));
    return bounded_round(r, bounded_root_error(a.value, r, a.exact),
                         bounded_root_error(a.value, r, a.single));
}

static inline Bounded bounded_inversesqrt(Bounded a)
{
    return bounded_div(bounded_of(1.0), bounded_sqrt(a));
}

/* Of the greater of two numbers: the one's own where it is surely the greater. */
static inline double bounded_choice_error(double a, double da, double b, double db)
{
    if (a - da > b + db)
        return da;
    if (b - db > a + da)
        return db;
    return da > db ? da : db;
}

static inline Bounded bounded_max(Bounded a, Bounded b)
{
    return (Bounded){a.value > b.value ? a.value : b.value,
                     bounded_choice_error(a.value, a.exact, b.value, b.exact),
                     bounded_choice_error(a.value, a.single, b.value, b.single)};
}

static inline Bounded bounded_min(Bounded a, Bounded b)
{
    return bounded_neg(bounded_max(bounded_neg(a), bounded_neg(b)));
}

static inline Bounded bounded_mix(Bounded a, Bounded b, Bounded t)
{
    return bounded_add(bounded_mul(a, bounded_sub(bounded_of(1.0), t)), bounded_mul(b, t));
}

static inline Bounded bounded_dot(const Bounded a[3], const Bounded b[3])
{
    return bounded_add(bounded_add(bounded_mul(a[2], b[2]), bounded_mul(a[1], b[1])),
                       bounded_mul(a[0], b[0]));
}

/* Whether a may be greater than limit in any of the computations. */
static inline bool bounded_may_exceed(Bounded a, double limit)
{
    return a.value + a.exact > limit || a.value + a.single > limit;
}

/* a where u ≥ 0, else 0: either where u's sign is not certain. */
static inline Bounded bounded_unless_negative(Bounded u, Bounded a)
{
    bool negative = u.value < 0.0;
    double kept = negative ? 0.0 : a.value, other = fabs(a.value);
    double exact = negative ? 0.0 : a.exact, single = negative ? 0.0 : a.single;
    if (fabs(u.value) <= u.exact)
        exact = other + a.exact;
    if (fabs(u.value) <= u.single)
        single = other + a.single;
    return (Bounded){kept, exact, single};
}

/* The same number about another value: what single precision computes from elsewhere. */
static inline Bounded bounded_about(Bounded about, Bounded single)
{
    double apart = fabs(single.value - about.value);
    about.single = bounded_limit((single.single + apart) * BOUNDED_SLACK);
    return about;
}

#endif

/* Numbers of 200 bits that are passed and returned like values: pointers into an arena that the
 * caller empties. The names are those that ref/truth/radiance_body.h wants. */
#ifndef PEEL_TESTS_MPFR_REAL_H
#define PEEL_TESTS_MPFR_REAL_H

#include <check.h>
#include <mpfr.h>
#include <stdbool.h>

enum {
    REAL_BITS = 200,
    REAL_SLOTS = 1 << 18
};

typedef mpfr_ptr Real;

static mpfr_t real_slots[REAL_SLOTS];
static int real_made, real_used;

/* Forgets all numbers. */
static inline void real_empty(void)
{
    real_used = 0;
}

static inline Real real_new(void)
{
    ck_assert_int_lt(real_used, REAL_SLOTS);
    if (real_used == real_made)
        mpfr_init2(real_slots[real_made++], REAL_BITS);
    return real_slots[real_used++];
}

static inline Real real_of(double x)
{
    Real r = real_new();
    mpfr_set_d(r, x, MPFR_RNDN);
    return r;
}

#define REAL_BINARY(name, function)                                                                \
    static inline Real name(Real a, Real b)                                                        \
    {                                                                                              \
        Real r = real_new();                                                                       \
        function(r, a, b, MPFR_RNDN);                                                              \
        return r;                                                                                  \
    }
REAL_BINARY(real_add, mpfr_add)
REAL_BINARY(real_sub, mpfr_sub)
REAL_BINARY(real_mul, mpfr_mul)
REAL_BINARY(real_div, mpfr_div)
REAL_BINARY(real_max, mpfr_max)
REAL_BINARY(real_min, mpfr_min)

#define REAL_UNARY(name, function)                                                                 \
    static inline Real name(Real a)                                                                \
    {                                                                                              \
        Real r = real_new();                                                                       \
        function(r, a, MPFR_RNDN);                                                                 \
        return r;                                                                                  \
    }
REAL_UNARY(real_neg, mpfr_neg)
REAL_UNARY(real_sqrt, mpfr_sqrt)
REAL_UNARY(real_inversesqrt, mpfr_rec_sqrt)

static inline Real real_floor(Real a)
{
    Real r = real_new();
    mpfr_floor(r, a);
    return r;
}

static inline Real real_mix(Real a, Real b, Real t)
{
    return real_add(real_mul(a, real_sub(real_of(1.0), t)), real_mul(b, t));
}

static inline Real real_dot(const Real a[3], const Real b[3])
{
    return real_add(real_add(real_mul(a[2], b[2]), real_mul(a[1], b[1])), real_mul(a[0], b[0]));
}

static inline bool real_may_exceed(Real a, double limit)
{
    return mpfr_cmp_d(a, limit) > 0;
}

static inline Real real_unless_negative(Real u, Real a)
{
    return mpfr_sgn(u) < 0 ? real_of(0.0) : a;
}

/* |a − b|, rounded up. */
static inline double real_distance(Real a, double b)
{
    Real r = real_new();
    mpfr_sub_d(r, a, b, MPFR_RNDA);
    mpfr_abs(r, r, MPFR_RNDU);
    return mpfr_get_d(r, MPFR_RNDU);
}

#endif

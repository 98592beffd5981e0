/* The operations of op.h on LANES floats at once: 1, 4 (SSE2), 8 (AVX2) or 16 (AVX-512).
 *
 * Define LANES before including; a file that includes this is compiled once per width from one
 * body. Every lane has the bits of the scalar operation, so a width changes speed and nothing
 * else (tests/cross/test_paths.c). The flushing mode is the processor's: see op_enter. */
#ifndef PEEL_NUMBER_LANES_H
#define PEEL_NUMBER_LANES_H

#include "number/op.h"

#ifndef LANES
#error "define LANES as 1, 4, 8 or 16 before including number/lanes.h"
#endif

#if LANES == 1

typedef float Lanes;
#define LANES_LOAD(p)     (*(p))
#define LANES_STORE(p, v) (*(p) = (v))
#define LANES_ALL(x)      (x)
#define LANES_ADD         op_add
#define LANES_SUB         op_sub
#define LANES_MUL         op_mul
#define LANES_DIV         op_div
#define LANES_SQRT        op_sqrt
#define LANES_NEG         op_neg
#define LANES_MAX         op_max
#define LANES_MIN         op_min

#else

#if LANES == 4
typedef __m128 Lanes;
#define LANES_CALL(name) _mm_##name
#elif LANES == 8
typedef __m256 Lanes;
#define LANES_CALL(name) _mm256_##name
#elif LANES == 16
typedef __m512 Lanes;
#define LANES_CALL(name) _mm512_##name
#else
#error "LANES: expected 1, 4, 8 or 16"
#endif

#define LANES_LOAD  LANES_CALL(loadu_ps)
#define LANES_STORE LANES_CALL(storeu_ps)
#define LANES_ALL   LANES_CALL(set1_ps)
#define LANES_ADD   LANES_CALL(add_ps)
#define LANES_SUB   LANES_CALL(sub_ps)
#define LANES_MUL   LANES_CALL(mul_ps)
#define LANES_DIV   LANES_CALL(div_ps)
#define LANES_SQRT  LANES_CALL(sqrt_ps)
/* x86's maximum and minimum give the second operand when either is NaN, so b must not be. */
#define LANES_MAX   LANES_CALL(max_ps)
#define LANES_MIN   LANES_CALL(min_ps)

static inline Lanes lanes_neg(Lanes a)
{
    /* Flips the sign bit, of zeros and NaN too, as −x does. */
    return -a;
}
#define LANES_NEG   lanes_neg
/* One rounding; only where the instruction set has it. Shading never fuses. */
#if LANES >= 8
#define LANES_FMA LANES_CALL(fmadd_ps)
#endif

#endif

static inline Lanes lanes_load(const float *p)
{
    return LANES_LOAD(p);
}
static inline void lanes_store(float *p, Lanes a)
{
    LANES_STORE(p, a);
}
static inline Lanes lanes_all(float x)
{
    return LANES_ALL(x);
}
static inline Lanes lanes_add(Lanes a, Lanes b)
{
    return LANES_ADD(a, b);
}
static inline Lanes lanes_sub(Lanes a, Lanes b)
{
    return LANES_SUB(a, b);
}
static inline Lanes lanes_mul(Lanes a, Lanes b)
{
    return LANES_MUL(a, b);
}
static inline Lanes lanes_div(Lanes a, Lanes b)
{
    return LANES_DIV(a, b);
}
static inline Lanes lanes_sqrt(Lanes a)
{
    return LANES_SQRT(a);
}
/* op_max and op_min for a b that is not NaN. */
static inline Lanes lanes_max(Lanes a, Lanes b)
{
    return LANES_MAX(a, b);
}
static inline Lanes lanes_min(Lanes a, Lanes b)
{
    return LANES_MIN(a, b);
}
static inline Lanes lanes_inversesqrt(Lanes a)
{
    return lanes_div(lanes_all(1.0f), lanes_sqrt(a));
}
static inline Lanes lanes_dot3(const Lanes a[3], const Lanes b[3])
{
    return lanes_add(lanes_add(lanes_mul(a[2], b[2]), lanes_mul(a[1], b[1])),
                     lanes_mul(a[0], b[0]));
}
/* GLSL's cross. */
static inline void lanes_cross(const Lanes a[3], const Lanes b[3], Lanes out[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = lanes_sub(lanes_mul(a[j], b[k]), lanes_mul(a[k], b[j]));
    }
}
/* Per lane a < b ? x : y, false where either is NaN. a and b are results of operations above, and
 * so not denormal. */
static inline Lanes lanes_where_less(Lanes a, Lanes b, Lanes x, Lanes y)
{
#if LANES == 1
    return a < b ? x : y;
#elif LANES == 4
    Lanes less = _mm_cmplt_ps(a, b);
    return _mm_or_ps(_mm_and_ps(less, x), _mm_andnot_ps(less, y));
#elif LANES == 8
    return _mm256_blendv_ps(y, x, _mm256_cmp_ps(a, b, _CMP_LT_OQ));
#else
    return _mm512_mask_blend_ps(_mm512_cmp_ps_mask(a, b, _CMP_LT_OQ), y, x);
#endif
}
static inline Lanes lanes_mix(Lanes a, Lanes b, Lanes t)
{
    return lanes_add(lanes_mul(a, lanes_sub(lanes_all(1.0f), t)), lanes_mul(b, t));
}

#endif

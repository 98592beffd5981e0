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

/* a·b + c with one rounding, or two: op_muladd. */
static inline Lanes lanes_fma(Lanes a, Lanes b, Lanes c)
{
#if LANES == 1
    return op_fma(a, b, c);
#elif LANES == 4
    __m128d low = op_fma_odd_pair(_mm_cvtps_pd(a), _mm_cvtps_pd(b), _mm_cvtps_pd(c));
    __m128d high =
        op_fma_odd_pair(_mm_cvtps_pd(_mm_movehl_ps(a, a)), _mm_cvtps_pd(_mm_movehl_ps(b, b)),
                        _mm_cvtps_pd(_mm_movehl_ps(c, c)));
    return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high));
#else
    return LANES_CALL(fmadd_ps)(a, b, c);
#endif
}
static inline Lanes lanes_muladd(bool fused, Lanes a, Lanes b, Lanes c)
{
    return fused ? lanes_fma(a, b, c) : lanes_add(lanes_mul(a, b), c);
}

/* ---- 32-bit integers and masks --------------------------------------------------------------- */

#if LANES == 1
typedef int32_t LanesInt;
typedef uint32_t LanesMask; /* bit 0 */
#elif LANES == 4
typedef __m128i LanesInt;
typedef __m128i LanesMask; /* all ones or zeros per lane */
#elif LANES == 8
typedef __m256i LanesInt;
typedef __m256i LanesMask;
#else
typedef __m512i LanesInt;
typedef __mmask16 LanesMask; /* a bit per lane */
#endif

enum {
    LANES_FULL = (1 << LANES) - 1 /* lanes_mask_bits of every lane */
};

static inline LanesInt lanes_int_load(const int32_t *p)
{
#if LANES == 1
    return *p;
#elif LANES == 4
    return _mm_loadu_si128((const __m128i *)p);
#elif LANES == 8
    return _mm256_loadu_si256((const __m256i *)p);
#else
    return _mm512_loadu_si512(p);
#endif
}
static inline void lanes_int_store(int32_t *p, LanesInt a)
{
#if LANES == 1
    *p = a;
#elif LANES == 4
    _mm_storeu_si128((__m128i *)p, a);
#elif LANES == 8
    _mm256_storeu_si256((__m256i *)p, a);
#else
    _mm512_storeu_si512(p, a);
#endif
}
static inline LanesInt lanes_int_all(int32_t x)
{
#if LANES == 1
    return x;
#else
    return LANES_CALL(set1_epi32)(x);
#endif
}
/* Sums and differences wrap. */
static inline LanesInt lanes_int_add(LanesInt a, LanesInt b)
{
#if LANES == 1
    return (int32_t)((uint32_t)a + (uint32_t)b);
#else
    return LANES_CALL(add_epi32)(a, b);
#endif
}
static inline LanesInt lanes_int_sub(LanesInt a, LanesInt b)
{
#if LANES == 1
    return (int32_t)((uint32_t)a - (uint32_t)b);
#else
    return LANES_CALL(sub_epi32)(a, b);
#endif
}
/* The low 32 bits of the product. */
static inline LanesInt lanes_int_mul(LanesInt a, LanesInt b)
{
#if LANES == 1
    return (int32_t)((uint32_t)a * (uint32_t)b);
#elif LANES == 4
    __m128i even = _mm_mul_epu32(a, b);
    __m128i odd = _mm_mul_epu32(_mm_srli_epi64(a, 32), _mm_srli_epi64(b, 32));
    return _mm_unpacklo_epi32(_mm_shuffle_epi32(even, 8), _mm_shuffle_epi32(odd, 8));
#else
    return LANES_CALL(mullo_epi32)(a, b);
#endif
}
static inline LanesInt lanes_int_or(LanesInt a, LanesInt b)
{
#if LANES == 1
    return a | b;
#elif LANES == 4
    return _mm_or_si128(a, b);
#elif LANES == 8
    return _mm256_or_si256(a, b);
#else
    return _mm512_or_si512(a, b);
#endif
}
static inline LanesInt lanes_int_and(LanesInt a, LanesInt b)
{
#if LANES == 1
    return a & b;
#elif LANES == 4
    return _mm_and_si128(a, b);
#elif LANES == 8
    return _mm256_and_si256(a, b);
#else
    return _mm512_and_si512(a, b);
#endif
}

/* The bits of a float, and back. */
static inline LanesInt lanes_bits(Lanes a)
{
#if LANES == 1
    return (int32_t)op_bits(a);
#elif LANES == 4
    return _mm_castps_si128(a);
#elif LANES == 8
    return _mm256_castps_si256(a);
#else
    return _mm512_castps_si512(a);
#endif
}
static inline Lanes lanes_from_bits(LanesInt a)
{
#if LANES == 1
    return op_from_bits((uint32_t)a);
#elif LANES == 4
    return _mm_castsi128_ps(a);
#elif LANES == 8
    return _mm256_castsi256_ps(a);
#else
    return _mm512_castsi512_ps(a);
#endif
}
/* Nearest integer, as op_round_to_int; to zero; and the float of an integer. */
static inline LanesInt lanes_round_to_int(Lanes a)
{
#if LANES == 1
    return op_round_to_int(a);
#else
    return LANES_CALL(cvtps_epi32)(a);
#endif
}
static inline LanesInt lanes_truncate_to_int(Lanes a)
{
#if LANES == 1
    return (int32_t)a;
#else
    return LANES_CALL(cvttps_epi32)(a);
#endif
}
static inline Lanes lanes_from_int(LanesInt a)
{
#if LANES == 1
    return (float)a;
#else
    return LANES_CALL(cvtepi32_ps)(a);
#endif
}

/* Signed comparisons. */
static inline LanesMask lanes_int_less(LanesInt a, LanesInt b)
{
#if LANES == 1
    return a < b;
#elif LANES == 4
    return _mm_cmplt_epi32(a, b);
#elif LANES == 8
#if defined(__AVX512BW__) && !defined(__clang__)
    /* gcc 12.2 takes a < INT32_MAX ? a : x for its opposite, unless the constant is hidden. */
    __asm__("" : "+x"(b));
#endif
    return _mm256_cmpgt_epi32(b, a);
#else
    return _mm512_cmplt_epi32_mask(a, b);
#endif
}
static inline LanesMask lanes_int_equal(LanesInt a, LanesInt b)
{
#if LANES == 1
    return a == b;
#elif LANES == 16
    return _mm512_cmpeq_epi32_mask(a, b);
#else
    return LANES_CALL(cmpeq_epi32)(a, b);
#endif
}
/* a < b of floats, false where either is NaN. */
static inline LanesMask lanes_less(Lanes a, Lanes b)
{
#if LANES == 1
    return a < b;
#elif LANES == 4
    return _mm_castps_si128(_mm_cmplt_ps(a, b));
#elif LANES == 8
    return _mm256_castps_si256(_mm256_cmp_ps(a, b, _CMP_LT_OQ));
#else
    return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
#endif
}

static inline LanesMask lanes_mask_and(LanesMask a, LanesMask b)
{
#if LANES == 4 || LANES == 8
    return lanes_int_and(a, b);
#else
    return (LanesMask)(a & b);
#endif
}
/* a and not b. */
static inline LanesMask lanes_mask_without(LanesMask a, LanesMask b)
{
#if LANES == 4
    return _mm_andnot_si128(b, a);
#elif LANES == 8
    return _mm256_andnot_si256(b, a);
#else
    return (LanesMask)(a & ~b);
#endif
}
/* Bit i is lane i. */
static inline uint32_t lanes_mask_bits(LanesMask a)
{
#if LANES == 4
    return (uint32_t)_mm_movemask_ps(_mm_castsi128_ps(a));
#elif LANES == 8
    return (uint32_t)_mm256_movemask_ps(_mm256_castsi256_ps(a));
#else
    return a;
#endif
}
static inline LanesMask lanes_mask_from_bits(uint32_t bits)
{
#if LANES == 4
    __m128i lane = _mm_set_epi32(8, 4, 2, 1);
    return _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32((int32_t)bits), lane), lane);
#elif LANES == 8
    __m256i lane = _mm256_set_epi32(128, 64, 32, 16, 8, 4, 2, 1);
    return _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int32_t)bits), lane), lane);
#else
    return (LanesMask)bits;
#endif
}

/* Per lane mask ? yes : no. */
static inline LanesInt lanes_int_select(LanesMask mask, LanesInt yes, LanesInt no)
{
#if LANES == 1
    return mask ? yes : no;
#elif LANES == 4
    return _mm_or_si128(_mm_and_si128(mask, yes), _mm_andnot_si128(mask, no));
#elif LANES == 8
    return _mm256_blendv_epi8(no, yes, mask);
#else
    return _mm512_mask_blend_epi32(mask, no, yes);
#endif
}
static inline Lanes lanes_select(LanesMask mask, Lanes yes, Lanes no)
{
#if LANES == 1
    return mask ? yes : no;
#elif LANES == 16
    return _mm512_mask_blend_ps(mask, no, yes);
#else
    return lanes_from_bits(lanes_int_select(mask, lanes_bits(yes), lanes_bits(no)));
#endif
}

static inline LanesMask lanes_is_nan(Lanes a)
{
#if LANES == 1
    return a != a;
#elif LANES == 4
    return _mm_castps_si128(_mm_cmpunord_ps(a, a));
#elif LANES == 8
    return _mm256_castps_si256(_mm256_cmp_ps(a, a, _CMP_UNORD_Q));
#else
    return _mm512_cmp_ps_mask(a, a, _CMP_UNORD_Q);
#endif
}
/* op_canonical. */
static inline Lanes lanes_canonical(Lanes a)
{
    return lanes_select(lanes_is_nan(a), lanes_from_bits(lanes_int_all(0x7fc00000)), a);
}

/* 0, 1, 2, … */
static inline LanesInt lanes_int_counting(void)
{
    int32_t i[LANES];
    for (int lane = 0; lane < LANES; lane++)
        i[lane] = lane;
    return lanes_int_load(i);
}

/* Stores the lanes whose bit is set one after the other at p, which has room for LANES values;
 * those after them are any. */
static inline void lanes_int_pack(int32_t *p, uint32_t bits, LanesInt a)
{
#if LANES == 16
    lanes_int_store(p, _mm512_maskz_compress_epi32((__mmask16)bits, a));
#else
    if (bits == LANES_FULL) {
        lanes_int_store(p, a);
        return;
    }
    int32_t lane[LANES];
    lanes_int_store(lane, a);
    for (; bits; bits &= bits - 1)
        *p++ = lane[__builtin_ctz(bits)];
#endif
}
static inline void lanes_pack(float *p, uint32_t bits, Lanes a)
{
#if LANES == 16
    lanes_store(p, _mm512_maskz_compress_ps((__mmask16)bits, a));
#else
    if (bits == LANES_FULL) {
        lanes_store(p, a);
        return;
    }
    float lane[LANES];
    lanes_store(lane, a);
    for (; bits; bits &= bits - 1)
        *p++ = lane[__builtin_ctz(bits)];
#endif
}

#endif

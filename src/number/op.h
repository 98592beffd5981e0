/* Every bit-exact operation: single-precision arithmetic exactly as llvmpipe's shaders do it.
 *
 * Each function is one IEEE 754 operation rounded to nearest even, with denormal inputs read as
 * zero and tiny results flushed to zero (DAZ, FTZ), signs kept. Results are the same on every
 * processor: on x86-64 the flushing is the processor's own mode, entered with op_enter; elsewhere,
 * or with PEEL_SOFTWARE_FLUSH defined, it is computed here. No libm but sqrtf. Translation units
 * that include this are compiled with -ffp-contract=off.
 *
 * Facts: measured on Mesa 22.3.6 llvmpipe with LLVM 15; every one is pinned by
 * tests/unit/test_op.c or tests/cross/test_arithmetic.c and listed in ref/pipeline/NUMBERS.md. */
#ifndef PEEL_NUMBER_OP_H
#define PEEL_NUMBER_OP_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#if defined(__SSE2__) && !defined(PEEL_SOFTWARE_FLUSH)
#include <immintrin.h>
#define OP_HARDWARE_FLUSH 1
#else
#include <fenv.h>
#define OP_HARDWARE_FLUSH 0
#endif

static inline uint32_t op_bits(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline float op_from_bits(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* ---- environment ---------------------------------------------------------------------------- */

/* Puts the calling thread into flushing mode, rounding to nearest, and returns what op_leave needs
 * to restore. Call it around a whole stage, in a function that itself does no floating-point
 * arithmetic: compilers may move arithmetic across a change of mode. */
static inline uint32_t op_enter(void)
{
#if OP_HARDWARE_FLUSH
    uint32_t saved = _mm_getcsr();
    _mm_setcsr(0x1f80 | 0x8040); /* all exceptions masked, round to nearest, FTZ | DAZ */
    return saved;
#else
    int saved = fegetround();
    fesetround(FE_TONEAREST);
    return (uint32_t)saved;
#endif
}

static inline void op_leave(uint32_t saved)
{
#if OP_HARDWARE_FLUSH
    _mm_setcsr(saved);
#else
    fesetround((int)saved);
#endif
}

/* Leaves flushing mode for what the driver computes with denormals; op_leave(op_suspend()) comes
 * back. The arithmetic between is plain C, in a function that is not inlined. */
static inline uint32_t op_suspend(void)
{
#if OP_HARDWARE_FLUSH
    uint32_t saved = _mm_getcsr();
    _mm_setcsr(0x1f80);
    return saved;
#else
    return op_enter();
#endif
}

/* x with a denormal replaced by the zero of its sign. Moves bits only, in any mode. */
static inline float op_flush(float x)
{
    uint32_t bits = op_bits(x);
    return bits & 0x7f800000u ? x : op_from_bits(bits & 0x80000000u);
}

/* ---- one operation each ---------------------------------------------------------------------- */

#if OP_HARDWARE_FLUSH

static inline float op_add(float a, float b)
{
    return a + b;
}
static inline float op_sub(float a, float b)
{
    return a - b;
}
static inline float op_mul(float a, float b)
{
    return a * b;
}
static inline float op_div(float a, float b)
{
    return a / b;
}
static inline float op_sqrt(float a)
{
    return sqrtf(a);
}
static inline float op_narrow(double x)
{
    return (float)x;
}

#else

/* x86 detects tininess after rounding: what rounds up to 2^-126 in 24 bits is not tiny. */
#define OP_TINY (0x1p-126 * (1.0 - 0x1p-25))

static inline float op_narrow(double x)
{
    return fabs(x) < OP_TINY ? copysignf(0.0f, (float)copysign(1.0, x)) : (float)x;
}
static inline float op_add(float a, float b)
{
    return op_flush(op_flush(a) + op_flush(b)); /* a tiny sum is exact */
}
static inline float op_sub(float a, float b)
{
    return op_flush(op_flush(a) - op_flush(b));
}
static inline float op_mul(float a, float b)
{
    return op_narrow((double)op_flush(a) * (double)op_flush(b)); /* the product is exact */
}
static inline float op_div(float a, float b)
{
    a = op_flush(a);
    b = op_flush(b);
    if (fabs((double)a) < fabs((double)b) * OP_TINY) /* exact: 24 + 25 bits */
        return copysignf(0.0f, a) * copysignf(1.0f, b);
    return a / b;
}
static inline float op_sqrt(float a)
{
    return sqrtf(op_flush(a));
}

#endif

/* a·b + c with one rounding: exact whether or not the processor has the instruction.
 * The product of two floats is exact in double; the sum is rounded to odd, so that the final
 * rounding to float is the only one. Source: Boldo, Melquiond, "Emulation of a FMA and correctly
 * rounded sums: proved algorithms using rounding to odd", IEEE Trans. Computers 57(4), 2008. */
static inline float op_fma(float a, float b, float c)
{
#if OP_HARDWARE_FLUSH && defined(__FMA__)
    return __builtin_fmaf(a, b, c);
#else
#if !OP_HARDWARE_FLUSH
    a = op_flush(a);
    b = op_flush(b);
    c = op_flush(c);
#endif
    double product = (double)a * (double)b;
    double addend = (double)c;
    double sum = product + addend;
    double recovered = sum - product;
    double error = (product - (sum - recovered)) + (addend - recovered);
    if (error != 0.0 && error == error) {
        uint64_t bits;
        memcpy(&bits, &sum, sizeof bits);
        if (!(bits & 1)) {
            bits = (error > 0.0) == (sum > 0.0) ? bits + 1 : bits - 1;
            memcpy(&sum, &bits, sizeof sum);
        }
    }
    return op_narrow(sum);
#endif
}

#if OP_HARDWARE_FLUSH
/* What op_fma emulates, of two triples of floats as doubles: the sum rounded to odd. */
static inline __m128d op_fma_odd_pair(__m128d a, __m128d b, __m128d c)
{
    const __m128d zero = _mm_setzero_pd();
    const __m128i one = _mm_set_epi32(0, 1, 0, 1);
    __m128d product = _mm_mul_pd(a, b), sum = _mm_add_pd(product, c);
    __m128d recovered = _mm_sub_pd(sum, product);
    __m128d error =
        _mm_add_pd(_mm_sub_pd(product, _mm_sub_pd(sum, recovered)), _mm_sub_pd(c, recovered));
    __m128i inexact =
        _mm_castpd_si128(_mm_and_pd(_mm_cmpneq_pd(error, zero), _mm_cmpord_pd(error, error)));
    __m128i bits = _mm_castpd_si128(sum);
    __m128i even = _mm_sub_epi64(_mm_and_si128(bits, one), one); /* all ones, or 0 */
    __m128i opposite =
        _mm_castpd_si128(_mm_xor_pd(_mm_cmpgt_pd(error, zero), _mm_cmpgt_pd(sum, zero)));
    __m128i step = _mm_or_si128(opposite, one); /* 1, or −1 */
    step = _mm_and_si128(step, _mm_and_si128(even, inexact));
    return _mm_castsi128_pd(_mm_add_epi64(bits, step));
}
#endif

/* What Mesa's fixed-function code computes where it asks LLVM for a fused or separate a·b + c:
 * one rounding where the driver's processor has FMA, two where it has not. */
static inline float op_muladd(bool fused, float a, float b, float c)
{
    return fused ? op_fma(a, b, c) : op_add(op_mul(a, b), c);
}

static inline float op_neg(float a)
{
    return -a;
}
static inline float op_abs(float a)
{
    return op_from_bits(op_bits(a) & 0x7fffffffu);
}

/* ---- GLSL functions, as llvmpipe computes them ------------------------------------------------
 */

/* b NaN gives a as it is; equal operands give b; a denormal result is flushed. */
static inline float op_min(float a, float b)
{
    if (b != b)
        return a;
#if !OP_HARDWARE_FLUSH
    a = op_flush(a);
    b = op_flush(b);
#endif
    return op_flush(a < b ? a : b);
}
static inline float op_max(float a, float b)
{
    if (b != b)
        return a;
#if !OP_HARDWARE_FLUSH
    a = op_flush(a);
    b = op_flush(b);
#endif
    return op_flush(a > b ? a : b);
}

/* clamp(x, 0, 1); NaN gives 0. */
static inline float op_saturate(float x)
{
    x = op_flush(x);
    return x > 0.0f ? (x < 1.0f ? x : 1.0f) : 0.0f;
}

/* From 2^23 on a float is whole; NaN is kept. */
static inline float op_floor(float x)
{
    x = op_flush(x);
    if (!(op_abs(x) < 0x1p23f))
        return x;
    float truncated = (float)(int32_t)x;
    float low = truncated > x ? truncated - 1.0f : truncated;
    return op_from_bits(op_bits(low) | (op_bits(x) & 0x80000000u)); /* −0 stays −0 */
}

static inline float op_inversesqrt(float x)
{
    return op_div(1.0f, op_sqrt(x));
}

/* dot of three components: llvmpipe sums from the last to the first. */
static inline float op_dot3(const float a[3], const float b[3])
{
    return op_add(op_add(op_mul(a[2], b[2]), op_mul(a[1], b[1])), op_mul(a[0], b[0]));
}

/* mix(a, b, t) under `precise`: a·(1 − t) + b·t. */
static inline float op_mix(float a, float b, float t)
{
    return op_add(op_mul(a, op_sub(1.0f, t)), op_mul(b, t));
}

/* Nearest integer, ties to even; NaN and what does not fit in 32 bits give INT32_MIN, as the x86
 * conversion does. */
static inline int32_t op_round_to_int(float x)
{
#if OP_HARDWARE_FLUSH
    return _mm_cvtss_si32(_mm_set_ss(x));
#else
    if (!(x >= -2147483648.0f && x < 2147483648.0f))
        return INT32_MIN;
    double shifted = (double)x + 6755399441055744.0; /* 1.5 · 2^52: the sum's unit is 1 */
    return (int32_t)(shifted - 6755399441055744.0);
#endif
}

/* exp2, log2 and pow: llvmpipe's polynomials (its lp_bld_arit.c), coefficients as measured.
 * Maximum error, fused or not: exp2 2.7e-7 relative (2.62e-7 at 0x1.15a38p-4, unfused); log2
 * 2.2e-7 absolute for x in [1, 2) (2.11e-7 at 0x1.fcb1aep+0); pow(x, 1/2.2) 4.6e-7 relative for x
 * in [2^-20, 1] (4.56e-7 at 0x1.0b8p-11). None is correctly rounded and none must be "improved".
 * NaN is kept. */
static inline float op_exp2(bool fused, float x)
{
    if (x != x)
        return x;
    x = op_min(x, 128.0f);
    x = op_max(x, -126.99999f);
    int32_t whole = (int32_t)x;
    if ((float)whole > x)
        whole--;
    float f = op_sub(x, (float)whole);
    float f2 = op_mul(f, f);
    float even =
        op_muladd(fused, f2,
                  op_muladd(fused, f2, 0.00898934009049466391101f, 0.240153617044375388211f), 1.0f);
    float odd = op_muladd(
        fused, f2, op_muladd(fused, f2, 0.00187757667519147912699f, 0.0558263180532956664775f),
        0.693153073200168932794f);
    float power = op_from_bits((uint32_t)(whole + 127) << 23);
    return op_mul(power, op_muladd(fused, odd, f, even));
}

static inline float op_log2(bool fused, float x)
{
    x = op_flush(x);
    uint32_t bits = op_bits(x);
    if (x != x || (bits & 0x7fffffffu) == 0 || bits & 0x80000000u)
        return x != x ? x : x < 0.0f ? op_from_bits(0x7fc00000u) : -INFINITY;
    if (bits == 0x7f800000u)
        return x;
    float exponent = (float)((int32_t)(bits >> 23) - 127);
    float mantissa = op_from_bits((bits & 0x007fffffu) | 0x3f800000u);
    float y = op_div(op_sub(mantissa, 1.0f), op_add(mantissa, 1.0f));
    float z = op_mul(y, y);
    float w = op_mul(z, z);
    float even =
        op_muladd(fused, w, op_muladd(fused, w, 0.406718052498846252698f, 0.577440339438736392009f),
                  2.88539009343309178325f);
    float odd = op_muladd(fused, w, 0.403343858251329912514f, 0.961791550404184197881f);
    return op_muladd(fused, y, op_muladd(fused, odd, z, even), exponent);
}

/* pow(x, y); 0 where x is 0 or NaN, whatever y is. */
static inline float op_pow(bool fused, float x, float y)
{
    return x != x || op_flush(x) == 0.0f ? 0.0f : op_exp2(fused, op_mul(op_log2(fused, x), y));
}

/* x, untouched by any operation. clang makes `which ? x : x·y` into x·(which ? 1 : y), and sums
 * likewise with −0, which is right only where denormals are not flushed: an x that must be kept is
 * passed through here. */
static inline float op_kept(float x)
{
#if OP_HARDWARE_FLUSH && defined(__clang__)
    __asm__("" : "+x"(x));
#endif
    return x;
}

/* The one NaN that we store, whatever bits the processor made. */
static inline float op_canonical(float x)
{
    return x != x ? op_from_bits(0x7fc00000u) : x;
}

#endif

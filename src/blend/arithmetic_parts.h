/* What the arithmetics of arithmetic.h are made of: one channel of one blend. */
#ifndef PEEL_BLEND_ARITHMETIC_PARTS_H
#define PEEL_BLEND_ARITHMETIC_PARTS_H

#include "blend/arithmetic.h"

/* One channel's factors and function. */
typedef struct ChannelEquation {
    BlendFactor source, destination;
    BlendFunc func;
    bool alpha;
} ChannelEquation;

static inline ChannelEquation channel_equation(const BlendEquation *equation, int channel)
{
    if (channel == 3)
        return (ChannelEquation){equation->source_alpha, equation->destination_alpha,
                                 equation->func_alpha, true};
    return (ChannelEquation){equation->source, equation->destination, equation->func, false};
}

/* The numbers that a channel is blended from: floats, halves or codes, exactly. */
typedef struct ChannelOperands {
    double source, destination, source_alpha, destination_alpha;
    double one; /* 1, or the greatest code */
} ChannelOperands;

/* A factor is base, or one − base; base is 0, one or an operand. */
typedef struct FactorBase {
    double base;
    bool complement;
} FactorBase;

/* FACTOR_SRC_ALPHA_SATURATE is one of its two operands, by an exact comparison; where one of them
 * is NaN, 1 − the destination's alpha. */
FactorBase arithmetic_factor(BlendFactor factor, bool alpha, const ChannelOperands *operands);

/* The stored bits of a channel from a value that is in the format, or a code. */
uint32_t arithmetic_bits(FormatKind kind, double value);
/* The number that stored bits are; of unorm formats the code. */
double arithmetic_value(FormatKind kind, uint32_t bits);
void arithmetic_put(PixelFormat format, void *pixel, int channel, uint32_t bits);

/* One channel as ARITHMETIC_EXACT. source and pixel as for arithmetic_blend; the pixel is that
 * before the blend. steps may be NULL. */
uint32_t arithmetic_exact(const BlendEquation *equation, PixelFormat format, const float source[4],
                          const void *pixel, int channel, BlendSteps *steps);

/* One channel as ARITHMETIC_STEPS; returns the stored bits. steps may be NULL. */
uint32_t arithmetic_stepwise(const Arithmetic *arithmetic, const BlendEquation *equation,
                             PixelFormat format, const float source[4], const void *pixel,
                             int channel, BlendSteps *steps);

/* x·y / (2^bits − 1) as the formula says; of integers of that many bits, at most 16. */
static inline int64_t arithmetic_code_product(CodeProduct product, int bits, int64_t x, int64_t y)
{
    int64_t t = x * y, half = (int64_t)1 << (bits - 1), most = 2 * half - 1;
    switch (product) {
    case CODES_NEAREST:
        t += half;
        return (t + (t >> bits)) >> bits;
    case CODES_DRIVER:
        t += t >> bits;
        return (t + half) >> bits;
    case CODES_FLOOR:
        return t / most;
    case CODES_SHIFT:
        return t >> bits;
    case CODES_SHIFT_ROUND:
        return (t + half) >> bits;
    case CODES_SHIFT_MOST:
        return (t + most) >> bits;
    case CODES_SHIFT_STRETCH:
        return x * (y + (y >> (bits - 1))) >> bits;
    case CODES_SHIFT_PLUS:
        return x * (y + 1) >> bits;
    case CODES_RECIPROCAL:
        return t * (most + 2) >> (2 * bits);
    }
    return 0;
}

/* arithmetic_blend of unorm formats in integers; false, and nothing done, where the arithmetic is
 * not one of integers without mistakes, or exact. */
bool arithmetic_codes_blend(const Arithmetic *arithmetic, const BlendEquation *equation,
                            PixelFormat format, size_t count, const float (*source)[4],
                            void *pixels);

/* The same of float operations to nearest without mistakes, and of sources not stored first. */
bool arithmetic_floats_blend(const Arithmetic *arithmetic, const BlendEquation *equation,
                             PixelFormat format, size_t count, const float (*source)[4],
                             void *pixels);

/* A sum of floating-point steps as stored bits. */
uint32_t arithmetic_store(const Arithmetic *arithmetic, const FormatInfo *info, double sum);

/* ---- mistakes; without any, what they are given comes back ---- */

typedef enum EarlyOut {
    EARLY_OUT_NO = 0,
    EARLY_OUT_SOURCE, /* the source's product is stored */
    EARLY_OUT_KEEP    /* the pixel is left */
} EarlyOut;

BlendEquation mistake_equation(const Arithmetic *arithmetic, const BlendEquation *equation);
/* A source before it is made an operand. */
double mistake_source(const Arithmetic *arithmetic, double x, double alpha, bool color);
void mistake_operands(const Arithmetic *arithmetic, bool color, ChannelOperands *operands);
EarlyOut mistake_early_out(const Arithmetic *arithmetic, const BlendEquation *equation,
                           const ChannelOperands *operands);
/* one − x where that is done wrong, else NaN. */
double mistake_complement(const Arithmetic *arithmetic, double one, double x);
double mistake_sum(const Arithmetic *arithmetic, bool color, double sum);
/* A sum of codes to a code. */
double mistake_code(const Arithmetic *arithmetic, double one, double code);
/* NULL, or why its mistakes are not of the format (static). */
const char *mistake_refuses(const Arithmetic *arithmetic, PixelFormat format);

#endif

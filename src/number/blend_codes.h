/* Blending of integers: factors and sums, for the driver's blending and any other. */
#ifndef PEEL_NUMBER_BLEND_CODES_H
#define PEEL_NUMBER_BLEND_CODES_H

#include "number/blend_equation.h"

#include <stdbool.h>
#include <stdint.h>

/* The factor of a channel; most is 1. alpha: the channel is alpha. */
static inline int64_t blend_codes_factor(int64_t most, BlendFactor factor, bool alpha, int64_t s,
                                         int64_t d, int64_t source_alpha, int64_t destination_alpha)
{
    int64_t room = most - destination_alpha;
    switch (factor) {
    case FACTOR_ZERO:
        return 0;
    case FACTOR_SRC_COLOR:
        return s;
    case FACTOR_ONE_MINUS_SRC_COLOR:
        return most - s;
    case FACTOR_DST_COLOR:
        return d;
    case FACTOR_ONE_MINUS_DST_COLOR:
        return most - d;
    case FACTOR_SRC_ALPHA:
        return source_alpha;
    case FACTOR_ONE_MINUS_SRC_ALPHA:
        return most - source_alpha;
    case FACTOR_DST_ALPHA:
        return destination_alpha;
    case FACTOR_ONE_MINUS_DST_ALPHA:
        return room;
    case FACTOR_SRC_ALPHA_SATURATE:
        return alpha ? most : source_alpha < room ? source_alpha : room;
    default:
        return most;
    }
}

/* Of products, or of operands for the greater and the less; not clamped. */
static inline int64_t blend_codes_combine(BlendFunc func, int64_t a, int64_t b)
{
    switch (func) {
    case BLEND_FUNC_SUBTRACT:
        return a - b;
    case BLEND_FUNC_REVERSE_SUBTRACT:
        return b - a;
    case BLEND_FUNC_MIN:
        return a < b ? a : b;
    case BLEND_FUNC_MAX:
        return a > b ? a : b;
    default:
        return a + b;
    }
}

static inline bool blend_func_extreme(BlendFunc func)
{
    return func == BLEND_FUNC_MIN || func == BLEND_FUNC_MAX;
}

#endif

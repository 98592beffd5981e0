/* Operations and factors of blending in single precision. With flush in flushing mode (op_enter),
 * without it outside: denormals are then kept. Inlined, so that constant arguments leave nothing of
 * the choices. */
#ifndef PEEL_NUMBER_BLEND_FLOAT_H
#define PEEL_NUMBER_BLEND_FLOAT_H

#include "number/blend_equation.h"
#include "number/op.h"

#define BLEND_FLOAT static inline __attribute__((always_inline))

BLEND_FLOAT float blend_float_add(bool flush, float a, float b)
{
    return flush ? op_add(a, b) : a + b;
}
BLEND_FLOAT float blend_float_sub(bool flush, float a, float b)
{
    return flush ? op_sub(a, b) : a - b;
}
BLEND_FLOAT float blend_float_mul(bool flush, float a, float b)
{
    return flush ? op_mul(a, b) : a * b;
}

/* A factor's value for a channel, alpha or not, from its source and destination. */
BLEND_FLOAT float blend_float_factor(bool flush, bool alpha, BlendFactor factor, float s, float d,
                                     float source_alpha, float destination_alpha)
{
    float room;
    switch (factor) {
    case FACTOR_ZERO:
        return 0.0f;
    case FACTOR_SRC_COLOR:
        return s;
    case FACTOR_ONE_MINUS_SRC_COLOR:
        return blend_float_sub(flush, 1.0f, s);
    case FACTOR_DST_COLOR:
        return d;
    case FACTOR_ONE_MINUS_DST_COLOR:
        return blend_float_sub(flush, 1.0f, d);
    case FACTOR_SRC_ALPHA:
        return source_alpha;
    case FACTOR_ONE_MINUS_SRC_ALPHA:
        return blend_float_sub(flush, 1.0f, source_alpha);
    case FACTOR_DST_ALPHA:
        return destination_alpha;
    case FACTOR_ONE_MINUS_DST_ALPHA:
        return blend_float_sub(flush, 1.0f, destination_alpha);
    case FACTOR_SRC_ALPHA_SATURATE:
        if (alpha)
            return 1.0f;
        /* Rounding keeps the order, so the rounded difference tells what the exact one does. */
        room = blend_float_sub(flush, 1.0f, destination_alpha);
        return source_alpha < room ? source_alpha : room;
    default:
        return 1.0f;
    }
}

#endif

/* One stored channel of one blend: which operands it has, and what it is in real numbers. */
#ifndef PEEL_STUDY_BLEND_CASE_H
#define PEEL_STUDY_BLEND_CASE_H

#include "blend/arithmetic.h"
#include "blend/equation.h"
#include "number/format.h"

#include <stdbool.h>
#include <stdint.h>

/* A vector and one channel of it. */
typedef struct BlendCase {
    const BlendEquation *equation;
    PixelFormat format;
    int channel;         /* a stored one */
    const float *source; /* 4 */
    const void *pixel;   /* the destination */
    bool whole;          /* other arithmetics than the equation's may read both alphas */
} BlendCase;

/* The factors and the function of the case's channel. */
typedef struct BlendTerms {
    BlendFactor source, destination;
    BlendFunc func;
} BlendTerms;

BlendTerms blend_case_terms(const BlendCase *one);

/* Which operands the channel's result depends on, by its factors; or both alphas, where whole. The
 * channel's own source and destination always count: their infinities and NaN come through a factor
 * of 0. */
typedef struct BlendOperands {
    bool source_alpha, destination_alpha; /* beside the channel's own values */
} BlendOperands;

BlendOperands blend_case_operands(const BlendCase *one);

/* How simple the channel's operands are: the sum of inputs_complexity over those that it depends
 * on, where a code of a unorm format counts 0 for 0, 1 for the greatest code, and else 1 + its set
 * bits; -0 counts 8, infinities and NaN 33 and more. The smallest vector of a set is the one
 * with the least sum, then the first. */
int blend_case_complexity(const BlendCase *one);

/* Destination as a number: codes divided by the greatest one. Missing alpha is 1. */
double blend_case_destination(const BlendCase *one, int channel);
/* A stored value of the case's channel as a number. */
double blend_case_value(PixelFormat format, uint32_t bits);

#endif

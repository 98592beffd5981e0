/* number/op.h as a table of functions, so that a test can hold its two ways of flushing side by
 * side: compiled once as it is and once with PEEL_SOFTWARE_FLUSH. Define OP_TABLE, the table's
 * name, before including this in a file that includes number/op.h. */
#ifndef PEEL_TESTS_OP_TABLE_H
#define PEEL_TESTS_OP_TABLE_H

#include "number/op.h"

typedef struct OpTable {
    float (*binary[6])(float, float); /* add, sub, mul, div, min, max */
    float (*unary[3])(float);         /* sqrt, saturate, inversesqrt */
    float (*fma)(float, float, float);
    float (*muladd[2])(float, float, float);
    float (*narrow)(double);
    int32_t (*round_to_int)(float);
    float (*exp2[2])(float); /* unfused, fused */
    float (*log2[2])(float);
    float (*pow[2])(float, float);
    float (*dot3)(const float[3], const float[3]);
    float (*mix)(float, float, float);
    uint32_t (*enter)(void);
    void (*leave)(uint32_t);
} OpTable;

extern const OpTable op_hardware, op_software;

#endif

#ifdef OP_TABLE

static float unfused_muladd(float a, float b, float c)
{
    return op_muladd(false, a, b, c);
}
static float fused_muladd(float a, float b, float c)
{
    return op_muladd(true, a, b, c);
}
static float unfused_exp2(float x)
{
    return op_exp2(false, x);
}
static float fused_exp2(float x)
{
    return op_exp2(true, x);
}
static float unfused_log2(float x)
{
    return op_log2(false, x);
}
static float fused_log2(float x)
{
    return op_log2(true, x);
}
static float unfused_pow(float x, float y)
{
    return op_pow(false, x, y);
}
static float fused_pow(float x, float y)
{
    return op_pow(true, x, y);
}

const OpTable OP_TABLE = {
    .binary = {op_add, op_sub, op_mul, op_div, op_min, op_max},
    .unary = {op_sqrt, op_saturate, op_inversesqrt},
    .fma = op_fma,
    .muladd = {unfused_muladd, fused_muladd},
    .narrow = op_narrow,
    .round_to_int = op_round_to_int,
    .exp2 = {unfused_exp2, fused_exp2},
    .log2 = {unfused_log2, fused_log2},
    .pow = {unfused_pow, fused_pow},
    .dot3 = op_dot3,
    .mix = op_mix,
    .enter = op_enter,
    .leave = op_leave,
};

#endif

/* Operands for the tests of blending. */
#ifndef PEEL_TESTS_BLEND_OPERANDS_H
#define PEEL_TESTS_BLEND_OPERANDS_H

#include "base/random.h"
#include "blend/equation.h"
#include "number/op.h"

static inline float operands_signed(Random *random, double x)
{
    return (float)(random_bits(random) & 1 ? -x : x);
}

/* Finite. Numbers of few digits make products and sums that are exactly half-way. */
static inline float operands_number(Random *random)
{
    static const float specials[] = {
        0.0f,       -0.0f,       1.0f,       -1.0f,           0x1p-149f,
        -0x1p-149f, 0x1p-126f,   0x1p-127f,  0x1.fffffep127f, 65504.0f,
        65520.0f,   0x1p-24f,    0x1p-25f,   0x1.8p-25f,      65519.996f,
        0x1p-14f,   0.99999994f, 1.0000001f, 0.99951172f,     0x1.fffffep-26f};
    uint64_t bits = random_bits(random);
    int digits = 1 + (int)(bits >> 8 & 15) % 14;
    switch (bits & 7) {
    case 0:
        return (float)random_unit(random);
    case 1:
        return operands_signed(random, random_range(random, 0.0, 8.0));
    case 2:
        return specials[(bits >> 8) % (sizeof specials / sizeof *specials)];
    case 3: /* any exponent below 2 */
        return op_from_bits((uint32_t)(bits >> 32) & 0xbfffffffu);
    case 4:
        return (float)((double)(bits >> 32 & 255) / 255.0);
    case 5:
        return operands_signed(random,
                               ldexp(1.0 + random_unit(random), (int)(bits >> 32 & 63) - 40));
    default:
        return operands_signed(random, ldexp((double)(bits >> 32 & ((1u << digits) - 1)),
                                             (int)(bits >> 56 & 15) - 14));
    }
}

/* A quarter of them with a name. */
static inline BlendEquation operands_equation(Random *random)
{
    if (random_bits(random) % 4 == 0)
        return equation_info((EquationId)(random_bits(random) % EQUATION_COUNT))->equation;
    BlendEquation e;
    e.source = (BlendFactor)(random_bits(random) % FACTOR_COUNT);
    e.destination = (BlendFactor)(random_bits(random) % FACTOR_COUNT);
    e.source_alpha = (BlendFactor)(random_bits(random) % FACTOR_COUNT);
    e.destination_alpha = (BlendFactor)(random_bits(random) % FACTOR_COUNT);
    e.func = (BlendFunc)(random_bits(random) % BLEND_FUNC_COUNT);
    e.func_alpha = (BlendFunc)(random_bits(random) % BLEND_FUNC_COUNT);
    return e;
}

#endif

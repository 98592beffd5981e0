/* peel.h: blending. */
#include "blend/arithmetic.h"
#include "blend/equation.h"
#include "library/convert.h"
#include "number/op.h"

_Static_assert((int)PEEL_ONE == FACTOR_ONE && (int)PEEL_SRC_COLOR == FACTOR_SRC_COLOR &&
                   (int)PEEL_DST_COLOR == FACTOR_DST_COLOR &&
                   (int)PEEL_SRC_ALPHA == FACTOR_SRC_ALPHA &&
                   (int)PEEL_DST_ALPHA == FACTOR_DST_ALPHA &&
                   (int)PEEL_SRC_ALPHA_SATURATE == FACTOR_SRC_ALPHA_SATURATE &&
                   (int)PEEL_FACTOR_COUNT == FACTOR_COUNT,
               "one numbering");
_Static_assert((int)PEEL_SUBTRACT == BLEND_FUNC_SUBTRACT &&
                   (int)PEEL_REVERSE_SUBTRACT == BLEND_FUNC_REVERSE_SUBTRACT &&
                   (int)PEEL_MIN == BLEND_FUNC_MIN && (int)PEEL_FUNC_COUNT == BLEND_FUNC_COUNT,
               "one numbering");
_Static_assert((int)PEEL_DRIVER == ARITHMETIC_DRIVER && (int)PEEL_STEPS == ARITHMETIC_STEPS &&
                   (int)PEEL_PRECISION_HALF == PRECISION_HALF &&
                   (int)PEEL_PRECISION_DOUBLE == PRECISION_DOUBLE &&
                   (int)PEEL_PRECISION_CODES == PRECISION_CODES &&
                   (int)PEEL_TOWARD_ZERO == BLEND_TOWARD_ZERO &&
                   (int)PEEL_NEAREST_AWAY == BLEND_NEAREST_AWAY && (int)PEEL_UPWARD == BLEND_UPWARD,
               "one numbering");
_Static_assert((int)PEEL_CODES_DRIVER == CODES_DRIVER && (int)PEEL_CODES_FLOOR == CODES_FLOOR &&
                   (int)PEEL_CODES_SHIFT == CODES_SHIFT &&
                   (int)PEEL_CODES_SHIFT_ROUND == CODES_SHIFT_ROUND &&
                   (int)PEEL_CODES_SHIFT_MOST == CODES_SHIFT_MOST &&
                   (int)PEEL_CODES_SHIFT_STRETCH == CODES_SHIFT_STRETCH &&
                   (int)PEEL_CODES_RECIPROCAL == CODES_RECIPROCAL,
               "one numbering");

/* ---- equations ---- */

const char *peel_equation_name(size_t i, const char **what)
{
    if (i >= EQUATION_COUNT)
        return NULL;
    const EquationInfo *info = equation_info((EquationId)i);
    if (what)
        *what = info->what;
    return info->name;
}

PeelResult peel_equation_parse(const char *text, PeelEquation *out)
{
    if (!text || !out)
        return convert_missing("peel_equation_parse", text ? "out" : "text");
    BlendEquation equation;
    Result result = equation_parse(text, &equation);
    if (result == RESULT_OK)
        *out = (PeelEquation){.source = (PeelFactor)equation.source,
                              .destination = (PeelFactor)equation.destination,
                              .source_alpha = (PeelFactor)equation.source_alpha,
                              .destination_alpha = (PeelFactor)equation.destination_alpha,
                              .func = (PeelFunc)equation.func,
                              .func_alpha = (PeelFunc)equation.func_alpha};
    return convert_result(result);
}

static PeelResult read_equation(const char *function, const PeelEquation *from, BlendEquation *out)
{
    const unsigned factors[4] = {from->source, from->destination, from->source_alpha,
                                 from->destination_alpha};
    for (int i = 0; i < 4; i++)
        if (factors[i] >= FACTOR_COUNT)
            return convert_result(result_fail(RESULT_BAD_INPUT,
                                              "%s: factor %d of the equation: expected 0 to %d",
                                              function, (int)factors[i], FACTOR_COUNT - 1));
    if ((unsigned)from->func >= BLEND_FUNC_COUNT || (unsigned)from->func_alpha >= BLEND_FUNC_COUNT)
        return convert_result(result_fail(RESULT_BAD_INPUT,
                                          "%s: functions %d and %d of the equation: expected 0 to "
                                          "%d",
                                          function, (int)from->func, (int)from->func_alpha,
                                          BLEND_FUNC_COUNT - 1));
    *out = (BlendEquation){.source = (BlendFactor)from->source,
                           .destination = (BlendFactor)from->destination,
                           .source_alpha = (BlendFactor)from->source_alpha,
                           .destination_alpha = (BlendFactor)from->destination_alpha,
                           .func = (BlendFunc)from->func,
                           .func_alpha = (BlendFunc)from->func_alpha};
    return PEEL_OK;
}

/* ---- arithmetics ---- */

static PeelArithmetic show_arithmetic(const Arithmetic *from)
{
    return (PeelArithmetic){.kind = (PeelArithmeticKind)from->kind,
                            .precision = (PeelPrecision)from->precision,
                            .rounding = (PeelRounding)from->rounding,
                            .store = (PeelRounding)from->store,
                            .product = (PeelCodeProduct)from->product,
                            .fused = from->fused,
                            .flush = from->flush,
                            .source_stored = from->source_stored,
                            .mistakes = from->mistakes};
}

static PeelResult read_arithmetic(const char *function, const PeelArithmetic *from, Arithmetic *out)
{
    const struct {
        const char *what;
        unsigned value, most;
    } fields[] = {
        {"kind", from->kind, ARITHMETIC_STEPS},
        {"precision", from->precision, PRECISION_CODES},
        {"rounding", from->rounding, BLEND_UPWARD},
        {"store", from->store, BLEND_UPWARD},
        {"product", from->product, CODES_RECIPROCAL},
    };
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (fields[i].value > fields[i].most)
            return convert_result(
                result_fail(RESULT_BAD_INPUT, "%s: %s %d of the arithmetic: expected 0 to %u",
                            function, fields[i].what, (int)fields[i].value, fields[i].most));
    if ((uint64_t)from->mistakes >> MISTAKE_COUNT)
        return convert_result(result_fail(RESULT_BAD_INPUT,
                                          "%s: mistakes %#x of the arithmetic: expected bits below "
                                          "%d",
                                          function, from->mistakes, MISTAKE_COUNT));
    *out = (Arithmetic){.kind = (ArithmeticKind)from->kind,
                        .precision = (BlendPrecision)from->precision,
                        .rounding = (BlendRounding)from->rounding,
                        .store = (BlendRounding)from->store,
                        .product = (CodeProduct)from->product,
                        .fused = from->fused,
                        .flush = from->flush,
                        .source_stored = from->source_stored,
                        .mistakes = from->mistakes};
    return PEEL_OK;
}

size_t peel_arithmetic_count(void)
{
    return arithmetic_count();
}

PeelResult peel_arithmetic_info(size_t i, PeelArithmeticInfo *out)
{
    if (!out)
        return convert_missing("peel_arithmetic_info", "out");
    if (i >= arithmetic_count())
        return convert_result(result_fail(RESULT_BAD_INPUT,
                                          "peel_arithmetic_info: %zu: expected below %zu", i,
                                          arithmetic_count()));
    const ArithmeticInfo *info = arithmetic_info(i);
    *out = (PeelArithmeticInfo){.name = info->name,
                                .what = info->what,
                                .arithmetic = show_arithmetic(&info->arithmetic),
                                .wrong = info->wrong};
    return PEEL_OK;
}

PeelResult peel_arithmetic_parse(const char *text, PeelArithmetic *out)
{
    if (!text || !out)
        return convert_missing("peel_arithmetic_parse", text ? "out" : "text");
    Arithmetic arithmetic;
    Result result = arithmetic_parse(text, &arithmetic);
    if (result == RESULT_OK)
        *out = show_arithmetic(&arithmetic);
    return convert_result(result);
}

/* ---- blending ---- */

/* What is blended how, checked. */
typedef struct Blend {
    Arithmetic arithmetic;
    BlendEquation equation;
    PixelFormat format;
} Blend;

static PeelResult read_blend(const char *function, const PeelArithmetic *arithmetic,
                             const PeelEquation *equation, PeelFormat format, Blend *out)
{
    if (!arithmetic || !equation)
        return convert_missing(function, arithmetic ? "equation" : "arithmetic");
    PeelResult result = convert_color_format(function, format, &out->format);
    if (!result)
        result = read_arithmetic(function, arithmetic, &out->arithmetic);
    if (!result)
        result = read_equation(function, equation, &out->equation);
    if (result)
        return result;
    const char *why = arithmetic_refuses(&out->arithmetic, &out->equation, out->format);
    return why ? convert_result(result_fail(RESULT_UNSUPPORTED, "%s: %s", function, why)) : PEEL_OK;
}

static PeelResult check_aligned(const char *function, const char *what, const void *at,
                                size_t bytes)
{
    if ((uintptr_t)at % bytes == 0)
        return PEEL_OK;
    return convert_result(result_fail(RESULT_BAD_INPUT,
                                      "%s: %s at an address that is no multiple of %zu", function,
                                      what, bytes));
}

static PeelResult check_operands(const char *function, const Blend *blend, const void *source,
                                 const char *source_name, const void *pixel, const char *pixel_name)
{
    if (!source || !pixel)
        return convert_missing(function, source ? pixel_name : source_name);
    size_t channel_bytes = (size_t)format_info(blend->format)->channel_bytes;
    PeelResult result = check_aligned(function, source_name, source, sizeof(float));
    return result ? result : check_aligned(function, pixel_name, pixel, channel_bytes);
}

PeelResult peel_blend(const PeelArithmetic *arithmetic, const PeelEquation *equation,
                      PeelFormat format, size_t count, const float *sources, void *pixels)
{
    Blend blend;
    PeelResult result = read_blend("peel_blend", arithmetic, equation, format, &blend);
    if (!result && count)
        result = check_operands("peel_blend", &blend, sources, "sources", pixels, "pixels");
    if (result || !count)
        return result;
    uint32_t environment = op_suspend();
    arithmetic_blend(&blend.arithmetic, &blend.equation, blend.format, count,
                     (const float(*)[4])sources, pixels);
    op_leave(environment);
    return PEEL_OK;
}

PeelResult peel_blend_steps(const PeelArithmetic *arithmetic, const PeelEquation *equation,
                            PeelFormat format, const float *source, const void *pixel,
                            PeelBlendSteps *out)
{
    Blend blend;
    PeelResult result = read_blend("peel_blend_steps", arithmetic, equation, format, &blend);
    if (!result)
        result = check_operands("peel_blend_steps", &blend, source, "source", pixel, "pixel");
    if (!result && !out)
        result = convert_missing("peel_blend_steps", "out");
    if (result)
        return result;
    BlendSteps steps[4];
    uint32_t environment = op_suspend();
    arithmetic_steps(&blend.arithmetic, &blend.equation, blend.format, source, pixel, steps);
    op_leave(environment);
    for (int c = 0; c < format_info(blend.format)->channels; c++)
        out[c] = (PeelBlendSteps){.source = steps[c].source,
                                  .destination = steps[c].destination,
                                  .source_factor = steps[c].source_factor,
                                  .destination_factor = steps[c].destination_factor,
                                  .source_product = steps[c].source_product,
                                  .destination_product = steps[c].destination_product,
                                  .sum = steps[c].sum,
                                  .stored = steps[c].stored,
                                  .codes = steps[c].codes};
    return PEEL_OK;
}

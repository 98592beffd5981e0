#include "study/blend_case.h"

#include "number/op.h"
#include "study/driver_inputs.h"

#include <math.h>

BlendTerms blend_case_terms(const BlendCase *one)
{
    const BlendEquation *equation = one->equation;
    if (one->channel == 3)
        return (BlendTerms){equation->source_alpha, equation->destination_alpha,
                            equation->func_alpha};
    return (BlendTerms){equation->source, equation->destination, equation->func};
}

static void add_factor(BlendFactor factor, BlendOperands *out)
{
    switch (factor) {
    case FACTOR_SRC_ALPHA:
    case FACTOR_ONE_MINUS_SRC_ALPHA:
        out->source_alpha = true;
        break;
    case FACTOR_DST_ALPHA:
    case FACTOR_ONE_MINUS_DST_ALPHA:
        out->destination_alpha = true;
        break;
    case FACTOR_SRC_ALPHA_SATURATE:
        out->source_alpha = out->destination_alpha = true;
        break;
    default:
        break;
    }
}

BlendOperands blend_case_operands(const BlendCase *one)
{
    BlendOperands used = {false, false};
    BlendTerms terms = blend_case_terms(one);
    if (one->whole && one->channel != 3)
        return (BlendOperands){true, format_info(one->format)->channels == 4};
    if (terms.func == BLEND_FUNC_MIN || terms.func == BLEND_FUNC_MAX || one->channel == 3)
        return used;
    add_factor(terms.source, &used);
    add_factor(terms.destination, &used);
    used.destination_alpha &= format_info(one->format)->channels == 4;
    return used;
}

static int code_complexity(uint32_t code, uint32_t most)
{
    return code == 0 ? 0 : code == most ? 1 : 1 + __builtin_popcount(code);
}

static int number_complexity(float x)
{
    return inputs_complexity(x) + (op_bits(x) == 0x80000000u ? 8 : 0);
}

static int source_complexity(const FormatInfo *info, float x)
{
    if (info->unorm_max && x >= 0.0f && x <= 1.0f) {
        double code = (double)x * info->unorm_max, whole = nearbyint(code);
        if (fabs(code - whole) < 1e-6 * whole + 1e-9) /* code / greatest as a float */
            return code_complexity((uint32_t)whole, info->unorm_max);
    }
    return number_complexity(x);
}

static int destination_complexity(const BlendCase *one, int channel)
{
    const FormatInfo *info = format_info(one->format);
    uint32_t bits = format_bits(one->format, one->pixel, channel);
    if (info->unorm_max)
        return code_complexity(bits, info->unorm_max);
    return number_complexity(info->kind == KIND_HALF ? half_to_float((uint16_t)bits)
                                                     : op_from_bits(bits));
}

int blend_case_complexity(const BlendCase *one)
{
    const FormatInfo *info = format_info(one->format);
    BlendOperands used = blend_case_operands(one);
    int sum = source_complexity(info, one->source[one->channel]) +
              destination_complexity(one, one->channel);
    if (used.source_alpha)
        sum += source_complexity(info, one->source[3]);
    if (used.destination_alpha)
        sum += destination_complexity(one, 3);
    return sum;
}

double blend_case_value(PixelFormat format, uint32_t bits)
{
    const FormatInfo *info = format_info(format);
    if (info->unorm_max)
        return (double)bits / info->unorm_max;
    return info->kind == KIND_HALF ? half_to_float((uint16_t)bits) : op_from_bits(bits);
}

double blend_case_destination(const BlendCase *one, int channel)
{
    if (channel >= format_info(one->format)->channels)
        return 1.0;
    return blend_case_value(one->format, format_bits(one->format, one->pixel, channel));
}

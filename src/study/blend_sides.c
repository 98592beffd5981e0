/* The same layers front to back and back to front. */
#include "study/blend_eval.h"

#include "blend/arithmetic_parts.h"

#include <math.h>

static const char *refusal_of(const EvalDesc *desc)
{
    if (equation_id(&desc->equation) != EQUATION_UNDER && !blend_eval_is_over(&desc->equation))
        return "only under and over put layers in order";
    if (format_info(desc->format)->channels < 4)
        return "the format stores no alpha";
    return NULL;
}

/* Whether alpha is transmittance on this side. */
static bool transmits(const BlendEquation *equation)
{
    return blend_eval_alpha(equation) == EVAL_TRANSMITTANCE;
}

/* The start as the source of a layer, premultiplied. */
static void start_source(const EvalDesc *desc, float out[4])
{
    BlendColour colour;
    blend_colour_init(&colour);
    for (int c = 0; c < 4; c++)
        rational_copy(&desc->start->channels[c], &colour.channels[c]);
    if (transmits(&desc->equation))
        rational_one_minus(&colour.channels[3], &colour.channels[3]);
    blend_eval_source(&colour, false, out);
    blend_colour_clear(&colour);
}

void blend_eval_all(const EvalDesc *desc, const Arithmetic *arithmetic, unsigned char pixel[16])
{
    bool over = blend_eval_is_over(&desc->equation);
    size_t layers = desc->layers->count;
    float source[4];
    Rational number;
    rational_init(&number);
    blend_eval_cleared(&desc->equation, source);
    for (int c = 0; c < format_info(desc->format)->channels; c++) {
        rational_set((double)source[c], &number);
        arithmetic_put(
            desc->format, pixel, c,
            rational_store(desc->start ? &desc->start->channels[c] : &number, desc->format));
    }
    rational_clear(&number);
    for (size_t i = 0; i < layers; i++) {
        blend_eval_source(&desc->layers->colours[over ? layers - 1 - i : i], desc->multiply,
                          source);
        arithmetic_blend(arithmetic, &desc->equation, desc->format, 1, (const float(*)[4])source,
                         pixel);
    }
}

static void blend_side(const BlendEval *eval, const BlendEquation *equation,
                       unsigned char pixel[16])
{
    EvalDesc side = eval->desc;
    bool own = equation_id(equation) == equation_id(&side.equation);
    if (!own) {
        side.multiply |= blend_eval_takes_straight(&side.equation);
        side.equation = *equation;
        side.start = NULL;
    }
    blend_eval_all(&side, &eval->arithmetic, pixel);
    /* In front of the over-blend's layers, or behind the under-blend's: the start comes last. */
    if (!own && eval->desc.start) {
        float source[4];
        start_source(&eval->desc, source);
        arithmetic_blend(&eval->arithmetic, equation, side.format, 1, (const float(*)[4])source,
                         pixel);
    }
}

/* alpha as the evaluated equation has it. */
static void fetch_side(const EvalDesc *desc, const BlendEquation *equation,
                       const unsigned char *pixel, Rational out[4])
{
    for (int c = 0; c < 4; c++)
        rational_fetch(format_bits(desc->format, pixel, c), desc->format, &out[c]);
    if (transmits(equation) != transmits(&desc->equation))
        rational_one_minus(&out[3], &out[3]);
}

double blend_eval_distance(const Rational *a, const Rational *b, const Rational *at,
                           PixelFormat format)
{
    Rational difference;
    rational_init(&difference);
    if (!rational_equal(a, b))
        rational_sub(a, b, &difference);
    double ulps = rational_ulps(&difference, at, format);
    rational_clear(&difference);
    return ulps;
}

void blend_eval_sides(const BlendEval *eval, EvalSides *out)
{
    const EvalDesc *desc = &eval->desc;
    BlendEquation under = equation_info(EQUATION_UNDER)->equation;
    BlendEquation over = blend_eval_is_over(&desc->equation)
                             ? desc->equation
                             : equation_info(EQUATION_OVER_TRANSMITTANCE)->equation;
    unsigned char pixel[16];
    *out = (EvalSides){.refusal = refusal_of(desc)};
    for (int c = 0; c < 4; c++) {
        rational_init(&out->under[c]);
        rational_init(&out->over[c]);
        rational_init(&out->exact[c]);
    }
    if (!out->refusal)
        out->refusal = arithmetic_refuses(&eval->arithmetic, &under, desc->format);
    if (!out->refusal)
        out->refusal = arithmetic_refuses(&eval->arithmetic, &over, desc->format);
    if (out->refusal)
        return;
    blend_side(eval, &under, pixel);
    fetch_side(desc, &under, pixel, out->under);
    blend_side(eval, &over, pixel);
    fetch_side(desc, &over, pixel, out->over);
    for (int c = 0; c < 4; c++)
        rational_copy(&eval->exact[c], &out->exact[c]);
    for (int c = 0; c < 4; c++) {
        const Rational *exact = &out->exact[c];
        out->under_ulp[c] = blend_eval_distance(&out->under[c], exact, exact, desc->format);
        out->over_ulp[c] = blend_eval_distance(&out->over[c], exact, exact, desc->format);
        out->between_ulp[c] =
            blend_eval_distance(&out->under[c], &out->over[c], exact, desc->format);
    }
}

void blend_eval_sides_free(EvalSides *sides)
{
    for (int c = 0; c < 4; c++) {
        rational_clear(&sides->under[c]);
        rational_clear(&sides->over[c]);
        rational_clear(&sides->exact[c]);
    }
}

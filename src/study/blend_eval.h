/* Blends a few layers and keeps every intermediate number, with what its rounding added.
 *
 * Layers are front to back. The over-equations take them from the last to the first, all others
 * from the first to the last. Beside the arithmetic goes an exact blend of the colours as written;
 * unorm formats clamp there too, and nothing else is lost. */
#ifndef PEEL_STUDY_BLEND_EVAL_H
#define PEEL_STUDY_BLEND_EVAL_H

#include "blend/arithmetic.h"
#include "study/blend_layers.h"

#include <stdbool.h>

typedef struct EvalDesc {
    BlendEquation equation;
    PixelFormat format;
    bool multiply;             /* colours are straight, the equation's sources are not: the shader
                                * multiplies them by their alpha */
    const BlendLayers *layers; /* at least one */
    const BlendColour *start;  /* NULL: cleared */
} EvalDesc;

/* What an equation makes of a pixel's alpha. */
typedef enum EvalAlpha {
    EVAL_OTHER = 0,
    EVAL_COVERAGE,
    EVAL_TRANSMITTANCE
} EvalAlpha;

EvalAlpha blend_eval_alpha(const BlendEquation *equation);

/* Whether the equation's source colours are straight. */
bool blend_eval_takes_straight(const BlendEquation *equation);

/* Whether layers are blended from the last to the first. */
bool blend_eval_is_over(const BlendEquation *equation);

/* A pixel as the equation begins: zeros, an alpha of 1 where it is transmittance, and ones where
 * the equation only multiplies. */
void blend_eval_cleared(const BlendEquation *equation, float out[4]);

/* The numbers of a blend of one channel, in the order in which they are computed. */
typedef enum EvalStep {
    EVAL_PUT_OUT = 0, /* the source as a shader puts it out: rounded to float */
    EVAL_SOURCE,      /* as the arithmetic uses it: maybe stored in the format, or flushed */
    EVAL_SOURCE_FACTOR,
    EVAL_SOURCE_PRODUCT,
    EVAL_DESTINATION,
    EVAL_DESTINATION_FACTOR,
    EVAL_DESTINATION_PRODUCT,
    EVAL_SUM, /* or difference, minimum, maximum */
    EVAL_STORED,
    EVAL_STEPS
} EvalStep;

typedef struct EvalValue {
    Rational number;
    Rational error; /* number less what is exact of the operands that it was computed from */
    double ulp;     /* error in units in the last place of the format; codes of a unorm format */
} EvalValue;

typedef struct EvalChannel {
    EvalValue steps[EVAL_STEPS];
    uint32_t before, stored; /* bits of the format */
    Rational exact;          /* of the colours as written, after this layer */
    Rational off;            /* the stored number less that */
    double off_ulp;
} EvalChannel;

/* Of one layer; channels that the format does not have hold nothing. */
typedef struct EvalLayer {
    size_t index; /* in the given order */
    const BlendColour *given;
    float source[4];
    EvalChannel channels[4];
} EvalLayer;

typedef struct EvalTotals {
    uint64_t operations, rounded; /* steps, and those whose error is not 0 */
    double largest_ulp;           /* of a step, without its sign; infinite for an overflow */
    size_t layer;                 /* where that was: index, channel and step */
    int channel;
    EvalStep step;
} EvalTotals;

typedef struct BlendEval {
    EvalDesc desc;
    Arithmetic arithmetic;
    size_t done; /* layers blended */
    EvalLayer layer;
    unsigned char pixel[16]; /* in the format's layout */
    Rational exact[4];       /* the pixel of the exact blend */
    Rational see_through;    /* the product of 1 − alpha of the layers done, as written */
    EvalTotals totals;
} BlendEval;

/* desc's layers and start are borrowed. UNSUPPORTED where the arithmetic is refused; out then needs
 * no close. */
Result blend_eval_open(const EvalDesc *desc, const Arithmetic *arithmetic, BlendEval *out);

/* Blends the next layer, which eval->layer then describes; false when all are done. */
bool blend_eval_next(BlendEval *eval);

void blend_eval_close(BlendEval *eval);

/* A source as the shader puts it out. multiply: of straight colours, each rounded to float, then
 * the product too. */
void blend_eval_source(const BlendColour *given, bool multiply, float out[4]);

/* All layers with nothing kept but the stored pixel at the end. The arithmetic is not refused. */
void blend_eval_all(const EvalDesc *desc, const Arithmetic *arithmetic, unsigned char pixel[16]);

/* a less b in units in the last place that the format has at the number `at`. */
double blend_eval_distance(const Rational *a, const Rational *b, const Rational *at,
                           PixelFormat format);

/* All layers under each other, front to back, and over each other, back to front. */
typedef struct EvalSides {
    const char *refusal;                  /* NULL, or why there is nothing to compare; static */
    Rational under[4], over[4], exact[4]; /* alpha as the equation has it */
    double under_ulp[4], over_ulp[4], between_ulp[4]; /* from exact; under less over */
} EvalSides;

/* Of the under-equation, beside which goes over-transmittance, and the over-equations; a start that
 * is given counts as one layer more, in front for the under-blend, at the back for the others.
 * eval: done. out: freed by blend_eval_sides_free, whatever is returned in it. */
void blend_eval_sides(const BlendEval *eval, EvalSides *out);
void blend_eval_sides_free(EvalSides *sides);

#endif

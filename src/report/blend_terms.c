#include "report/blend_terms.h"

#include "blend/arithmetic_parts.h"

#include <stdio.h>
#include <string.h>

typedef struct Letters {
    const char *source, *destination, *source_alpha, *destination_alpha;
} Letters;

static const char *factor_text(BlendFactor factor, bool alpha, const Letters *letters,
                               char out[TERMS_PART])
{
    const char *const bases[FACTOR_COUNT] = {
        [FACTOR_SRC_COLOR] = letters->source,
        [FACTOR_ONE_MINUS_SRC_COLOR] = letters->source,
        [FACTOR_DST_COLOR] = letters->destination,
        [FACTOR_ONE_MINUS_DST_COLOR] = letters->destination,
        [FACTOR_SRC_ALPHA] = letters->source_alpha,
        [FACTOR_ONE_MINUS_SRC_ALPHA] = letters->source_alpha,
        [FACTOR_DST_ALPHA] = letters->destination_alpha,
        [FACTOR_ONE_MINUS_DST_ALPHA] = letters->destination_alpha,
    };
    if (factor == FACTOR_ZERO || factor == FACTOR_ONE)
        return strcpy(out, factor == FACTOR_ZERO ? "0" : "1");
    if (factor == FACTOR_SRC_ALPHA_SATURATE && alpha)
        return strcpy(out, "1");
    if (factor == FACTOR_SRC_ALPHA_SATURATE)
        snprintf(out, TERMS_PART, "min(%s, 1 - %s)", letters->source_alpha,
                 letters->destination_alpha);
    else if (factor == FACTOR_SRC_COLOR || factor == FACTOR_DST_COLOR ||
             factor == FACTOR_SRC_ALPHA || factor == FACTOR_DST_ALPHA)
        snprintf(out, TERMS_PART, "%s", bases[factor]);
    else
        snprintf(out, TERMS_PART, "1 - %s", bases[factor]);
    return out;
}

static void product_text(const char *operand, const char *factor, char out[TERMS_PART])
{
    if (strcmp(factor, "1") == 0)
        snprintf(out, TERMS_PART, "%s", operand);
    else if (strcmp(factor, "0") == 0)
        snprintf(out, TERMS_PART, "0*%s", operand);
    else if (strchr(factor, ' ') && factor[0] != 'm')
        snprintf(out, TERMS_PART, "%s*(%s)", operand, factor);
    else
        snprintf(out, TERMS_PART, "%s*%s", factor, operand);
}

/* The right side. Zero terms of a sum are left out; a destination as it is comes first. */
static void sum_text(const ChannelEquation *part, const char *s, const char *d,
                     char out[TERMS_STEP])
{
    bool no_source = part->source == FACTOR_ZERO, no_destination = part->destination == FACTOR_ZERO;
    bool reverse = part->func == BLEND_FUNC_REVERSE_SUBTRACT;
    if (part->func == BLEND_FUNC_MIN || part->func == BLEND_FUNC_MAX)
        snprintf(out, TERMS_STEP, "%s(%s, %s)", equation_func_name(part->func), s, d);
    else if (part->func != BLEND_FUNC_ADD)
        snprintf(out, TERMS_STEP, "%s - %s", reverse ? d : s, reverse ? s : d);
    else if (no_source && no_destination)
        snprintf(out, TERMS_STEP, "0");
    else if (no_source || no_destination)
        snprintf(out, TERMS_STEP, "%s", no_source ? d : s);
    else if (part->destination == FACTOR_ONE)
        snprintf(out, TERMS_STEP, "%s + %s", d, s);
    else
        snprintf(out, TERMS_STEP, "%s + %s", s, d);
}

/* A channel's factors; a format without alpha reads 1 for it. */
static ChannelEquation part_of(const EvalDesc *desc, int channel)
{
    ChannelEquation part = channel_equation(&desc->equation, channel);
    BlendFactor *factors[2] = {&part.source, &part.destination};
    for (int i = 0; i < 2 && format_info(desc->format)->channels < 4; i++) {
        if (*factors[i] == FACTOR_DST_ALPHA)
            *factors[i] = FACTOR_ONE;
        if (*factors[i] == FACTOR_ONE_MINUS_DST_ALPHA)
            *factors[i] = FACTOR_ZERO;
    }
    return part;
}

static void channel_terms(const EvalDesc *desc, int channel, const Letters *letters, TermsOf *out)
{
    ChannelEquation part = part_of(desc, channel);
    bool unorm = format_info(desc->format)->kind == KIND_UNORM;
    bool factors = part.func != BLEND_FUNC_MIN && part.func != BLEND_FUNC_MAX;
    char source_factor[TERMS_PART] = "1", destination_factor[TERMS_PART] = "1";
    char source_product[TERMS_PART], destination_product[TERMS_PART];
    if (factors) {
        factor_text(part.source, part.alpha, letters, source_factor);
        factor_text(part.destination, part.alpha, letters, destination_factor);
    }
    snprintf(out->target, sizeof out->target, "%s", letters->destination);
    snprintf(out->steps[EVAL_PUT_OUT], TERMS_STEP, "%s", letters->source);
    snprintf(out->steps[EVAL_SOURCE], TERMS_STEP, "%s %s", letters->source,
             unorm ? "stored" : "used");
    snprintf(out->steps[EVAL_SOURCE_FACTOR], TERMS_STEP, "%s", source_factor);
    snprintf(out->steps[EVAL_DESTINATION], TERMS_STEP, "%s", letters->destination);
    snprintf(out->steps[EVAL_DESTINATION_FACTOR], TERMS_STEP, "%s", destination_factor);
    product_text(letters->source, source_factor, source_product);
    product_text(letters->destination, destination_factor, destination_product);
    snprintf(out->steps[EVAL_SOURCE_PRODUCT], TERMS_STEP, "%s", source_product);
    snprintf(out->steps[EVAL_DESTINATION_PRODUCT], TERMS_STEP, "%s", destination_product);
    sum_text(&part, source_product, destination_product, out->steps[EVAL_SUM]);
    snprintf(out->steps[EVAL_STORED], TERMS_STEP, "%s stored", letters->destination);
    snprintf(out->formula, TERMS_FORMULA, "%s = %s", out->target, out->steps[EVAL_SUM]);
}

/* What the two lines of a well-known equation mean. */
static void meanings(const EvalDesc *desc, BlendTerms *out)
{
    EquationId id = equation_id(&desc->equation);
    out->colour_means = out->alpha_means = "";
    if (format_info(desc->format)->channels < 4)
        out->colour_means = "the format stores no alpha: where it is read, it is 1";
    else if (id == EQUATION_UNDER) {
        out->colour_means = "the layer's light, dimmed by the layers in front";
        out->alpha_means = "transmittance: what the layers let through";
    } else if (blend_eval_is_over(&desc->equation)) {
        out->colour_means = "the layer's light, and what it lets through";
        out->alpha_means = id == EQUATION_OVER_TRANSMITTANCE
                               ? "transmittance: what the layers let through"
                               : "coverage: what the layers hold back";
    } else if (id == EQUATION_WEIGHTED_SUM) {
        out->colour_means = "colours, each weighted by its alpha";
        out->alpha_means = "the sum of the weights";
    } else if (id == EQUATION_PRODUCT) {
        out->colour_means = out->alpha_means = "what is there, times 1 less the source";
    }
}

void blend_terms(const EvalDesc *desc, BlendTerms *out)
{
    bool transmits = blend_eval_alpha(&desc->equation) == EVAL_TRANSMITTANCE;
    bool straight = blend_eval_takes_straight(&desc->equation);
    Letters colour = {.source = desc->multiply ? "a*c"
                                : straight     ? "c"
                                               : "s",
                      .destination = "C",
                      .source_alpha = "a",
                      .destination_alpha = transmits ? "T" : "A"};
    if (format_info(desc->format)->channels < 4)
        colour.destination_alpha = "1";
    Letters alpha = colour;
    alpha.source = colour.source_alpha;
    alpha.destination = transmits ? "T" : "A";
    channel_terms(desc, 0, &colour, &out->colour);
    channel_terms(desc, 3, &alpha, &out->alpha);
    out->sources = desc->multiply ? "c, a: a layer's straight colour and alpha; the shader "
                                    "puts out a*c and a"
                   : straight     ? "c, a: a layer's colour (straight) and alpha, floats"
                                  : "s, a: a layer's colour (premultiplied) and alpha, floats";
    meanings(desc, out);
}

const TermsOf *blend_terms_of(const BlendTerms *terms, int channel)
{
    return channel == 3 ? &terms->alpha : &terms->colour;
}

/* Whether the number is the same as that of an earlier step. */
static bool repeats(const EvalChannel *channel, EvalStep step, EvalStep earlier)
{
    return rational_is_zero(&channel->steps[step].error) &&
           rational_equal(&channel->steps[step].number, &channel->steps[earlier].number);
}

/* An own operand as a factor, which the step before has shown. */
static bool is_own(BlendFactor factor, bool alpha, EvalStep step)
{
    bool source = step == EVAL_SOURCE_FACTOR;
    return factor == (source ? FACTOR_SRC_COLOR : FACTOR_DST_COLOR) ||
           (alpha && factor == (source ? FACTOR_SRC_ALPHA : FACTOR_DST_ALPHA));
}

bool blend_terms_says(const EvalDesc *desc, const EvalLayer *layer, int channel, EvalStep step)
{
    ChannelEquation part = part_of(desc, channel);
    const EvalChannel *values = &layer->channels[channel];
    const EvalValue *value = &values->steps[step];
    bool factors = part.func != BLEND_FUNC_MIN && part.func != BLEND_FUNC_MAX;
    bool source = step < EVAL_DESTINATION;
    BlendFactor factor = source ? part.source : part.destination;
    switch (step) {
    case EVAL_SOURCE:
        return !repeats(values, EVAL_SOURCE, EVAL_PUT_OUT);
    case EVAL_SOURCE_FACTOR:
    case EVAL_DESTINATION_FACTOR:
        if (!rational_is_zero(&value->error))
            return true;
        return factors && factor != FACTOR_ONE && factor != FACTOR_ZERO &&
               !is_own(factor, part.alpha, step);
    case EVAL_SOURCE_PRODUCT:
    case EVAL_DESTINATION_PRODUCT:
        if (!factors || factor == FACTOR_ONE)
            return !repeats(values, step, source ? EVAL_SOURCE : EVAL_DESTINATION);
        return factor != FACTOR_ZERO || !rational_is_zero(&value->number);
    case EVAL_DESTINATION:
        return part.destination != FACTOR_ZERO || !factors || !rational_is_zero(&value->error);
    case EVAL_SUM:
        if (!factors || part.func != BLEND_FUNC_ADD)
            return true;
        return !(part.source == FACTOR_ZERO && repeats(values, step, EVAL_DESTINATION_PRODUCT)) &&
               !(part.destination == FACTOR_ZERO && repeats(values, step, EVAL_SOURCE_PRODUCT));
    default:
        return true;
    }
}

#include "study/blend_eval.h"

#include "blend/arithmetic_parts.h"

#include <math.h>
#include <string.h>

/* ---- equations ---- */

EvalAlpha blend_eval_alpha(const BlendEquation *equation)
{
    switch (equation_id(equation)) {
    case EQUATION_UNDER:
    case EQUATION_OVER_TRANSMITTANCE:
    case EQUATION_SEED:
        return EVAL_TRANSMITTANCE;
    case EQUATION_OVER:
    case EQUATION_OVER_PREMULTIPLIED:
        return EVAL_COVERAGE;
    default:
        return EVAL_OTHER;
    }
}

bool blend_eval_takes_straight(const BlendEquation *equation)
{
    EquationId id = equation_id(equation);
    return id == EQUATION_OVER || id == EQUATION_WEIGHTED_SUM || id == EQUATION_REPLACE;
}

bool blend_eval_is_over(const BlendEquation *equation)
{
    EquationId id = equation_id(equation);
    return id == EQUATION_OVER || id == EQUATION_OVER_PREMULTIPLIED ||
           id == EQUATION_OVER_TRANSMITTANCE;
}

void blend_eval_cleared(const BlendEquation *equation, float out[4])
{
    float color = equation_id(equation) == EQUATION_PRODUCT ? 1.0f : 0.0f;
    for (int i = 0; i < 3; i++)
        out[i] = color;
    out[3] = blend_eval_alpha(equation) == EVAL_TRANSMITTANCE ? 1.0f : color;
}

/* ---- exact operations ---- */

/* The operands of a channel, exactly. */
typedef struct Operands {
    const Rational *source, *destination, *source_alpha, *destination_alpha;
} Operands;

static void exact_factor(BlendFactor factor, bool alpha, const Operands *o, Rational *out)
{
    const Rational *const bases[FACTOR_COUNT] = {
        [FACTOR_SRC_COLOR] = o->source,
        [FACTOR_ONE_MINUS_SRC_COLOR] = o->source,
        [FACTOR_DST_COLOR] = o->destination,
        [FACTOR_ONE_MINUS_DST_COLOR] = o->destination,
        [FACTOR_SRC_ALPHA] = o->source_alpha,
        [FACTOR_ONE_MINUS_SRC_ALPHA] = o->source_alpha,
        [FACTOR_DST_ALPHA] = o->destination_alpha,
        [FACTOR_ONE_MINUS_DST_ALPHA] = o->destination_alpha,
    };
    switch (factor) {
    case FACTOR_ZERO:
        rational_set(0.0, out);
        return;
    case FACTOR_ONE:
        rational_set(1.0, out);
        return;
    case FACTOR_SRC_ALPHA_SATURATE:
        if (alpha) {
            rational_set(1.0, out);
            return;
        }
        rational_one_minus(o->destination_alpha, out);
        if (o->source_alpha->kind != RATIONAL_NAN && out->kind != RATIONAL_NAN)
            rational_min(o->source_alpha, out, out); /* as arithmetic_factor */
        return;
    case FACTOR_SRC_COLOR:
    case FACTOR_DST_COLOR:
    case FACTOR_SRC_ALPHA:
    case FACTOR_DST_ALPHA:
        rational_copy(bases[factor], out);
        return;
    default:
        rational_one_minus(bases[factor], out);
    }
}

static bool has_factors(BlendFunc func)
{
    return func != BLEND_FUNC_MIN && func != BLEND_FUNC_MAX;
}

static void exact_function(BlendFunc func, const Rational *s, const Rational *d, Rational *out)
{
    switch (func) {
    case BLEND_FUNC_SUBTRACT:
        rational_sub(s, d, out);
        return;
    case BLEND_FUNC_REVERSE_SUBTRACT:
        rational_sub(d, s, out);
        return;
    case BLEND_FUNC_MIN:
        rational_min(s, d, out);
        return;
    case BLEND_FUNC_MAX:
        rational_max(s, d, out);
        return;
    default:
        rational_add(s, d, out);
    }
}

/* out: apart from the operands. */
static void exact_blend(const ChannelEquation *part, const Operands *o, Rational *out)
{
    Rational product;
    rational_init(&product);
    if (has_factors(part->func)) {
        exact_factor(part->source, part->alpha, o, &product);
        rational_mul(o->source, &product, &product);
        exact_factor(part->destination, part->alpha, o, out);
        rational_mul(o->destination, out, out);
        exact_function(part->func, &product, out, out);
    } else {
        exact_function(part->func, o->source, o->destination, out);
    }
    rational_clear(&product);
}

/* What fixed-point formats do to every number that enters or leaves them. */
static void clamp_as(PixelFormat format, Rational *number)
{
    if (format_info(format)->kind == KIND_UNORM)
        rational_clamp(number, number);
}

/* ---- sources ---- */

/* The source that the equation is given, exactly. */
static void exact_source(const BlendColour *given, bool multiply, int channel, Rational *out)
{
    if (multiply && channel < 3)
        rational_mul(&given->channels[channel], &given->channels[3], out);
    else
        rational_copy(&given->channels[channel], out);
}

void blend_eval_source(const BlendColour *given, bool multiply, float out[4])
{
    Rational colour, alpha;
    rational_init(&colour);
    rational_init(&alpha);
    out[3] = rational_to_float(&given->channels[3]);
    rational_set((double)out[3], &alpha);
    for (int i = 0; i < 3; i++) {
        out[i] = rational_to_float(&given->channels[i]);
        if (!multiply)
            continue;
        rational_set((double)out[i], &colour);
        rational_mul(&colour, &alpha, &colour);
        out[i] = rational_to_float(&colour);
    }
    rational_clear(&colour);
    rational_clear(&alpha);
}

/* ---- opening and closing ---- */

static void all_numbers(BlendEval *eval, void (*each)(Rational *))
{
    for (int c = 0; c < 4; c++) {
        EvalChannel *channel = &eval->layer.channels[c];
        for (int step = 0; step < EVAL_STEPS; step++) {
            each(&channel->steps[step].number);
            each(&channel->steps[step].error);
        }
        each(&channel->exact);
        each(&channel->off);
        each(&eval->exact[c]);
    }
    each(&eval->see_through);
}

static void put_start(BlendEval *eval)
{
    float cleared[4];
    blend_eval_cleared(&eval->desc.equation, cleared);
    for (int c = 0; c < 4; c++) {
        if (eval->desc.start)
            rational_copy(&eval->desc.start->channels[c], &eval->exact[c]);
        else
            rational_set((double)cleared[c], &eval->exact[c]);
        if (c < format_info(eval->desc.format)->channels)
            arithmetic_put(eval->desc.format, eval->pixel, c,
                           rational_store(&eval->exact[c], eval->desc.format));
        clamp_as(eval->desc.format, &eval->exact[c]);
    }
    if (format_info(eval->desc.format)->channels < 4)
        rational_set(1.0, &eval->exact[3]);
    rational_set(1.0, &eval->see_through);
}

Result blend_eval_open(const EvalDesc *desc, const Arithmetic *arithmetic, BlendEval *out)
{
    const char *refusal = arithmetic_refuses(arithmetic, &desc->equation, desc->format);
    if (refusal)
        return result_fail(RESULT_UNSUPPORTED, "%s: %s", format_info(desc->format)->name, refusal);
    *out = (BlendEval){.desc = *desc, .arithmetic = *arithmetic};
    all_numbers(out, rational_init);
    put_start(out);
    return RESULT_OK;
}

void blend_eval_close(BlendEval *eval)
{
    all_numbers(eval, rational_clear);
}

/* ---- a layer ---- */

/* value.number is set: its error from what is exact. */
static void set_error(PixelFormat format, const Rational *exact, EvalValue *value)
{
    if (rational_equal(&value->number, exact)) /* infinities and NaN, too */
        rational_set(0.0, &value->error);
    else
        rational_sub(&value->number, exact, &value->error);
    value->ulp = rational_ulps(&value->error, exact, format);
}

/* A number as arithmetic_steps has it: a quotient of codes or a double. */
static void from_step(double value, const BlendSteps *steps, PixelFormat format, Rational *out)
{
    rational_set(value, out);
    if (steps->codes && out->kind == RATIONAL_FINITE) {
        Rational unit;
        rational_init(&unit);
        rational_set_ratio(1, format_info(format)->unorm_max, &unit);
        rational_mul(out, &unit, out);
        rational_clear(&unit);
    }
}

/* The operands that steps were computed from. A format without alpha reads 1; its source's alpha
 * is as it was put out. */
static Operands operands_of(const EvalLayer *layer, int channel, int channels, const Rational *one)
{
    const EvalValue *steps = layer->channels[channel].steps;
    bool has_alpha = channels == 4;
    return (Operands){&steps[EVAL_SOURCE].number, &steps[EVAL_DESTINATION].number,
                      &layer->channels[3].steps[has_alpha ? EVAL_SOURCE : EVAL_PUT_OUT].number,
                      has_alpha ? &layer->channels[3].steps[EVAL_DESTINATION].number : one};
}

/* The product that a fused operation adds without rounding it, as arithmetic_steps does. */
static bool is_unrounded(const Arithmetic *arithmetic, const ChannelEquation *part, EvalStep step)
{
    return arithmetic->kind == ARITHMETIC_EXACT ||
           (arithmetic->kind == ARITHMETIC_STEPS && arithmetic->fused &&
            arithmetic->precision != PRECISION_CODES &&
            step ==
                (part->destination == FACTOR_ONE ? EVAL_SOURCE_PRODUCT : EVAL_DESTINATION_PRODUCT));
}

/* Factors, products and the sum: numbers from steps, or exact ones where nothing is rounded. */
static void compute(const BlendEval *eval, const BlendSteps *steps, int c, EvalLayer *layer)
{
    PixelFormat format = eval->desc.format;
    bool exact = eval->arithmetic.kind == ARITHMETIC_EXACT;
    ChannelEquation part = channel_equation(&eval->desc.equation, c);
    EvalValue *values = layer->channels[c].steps;
    Rational one, result;
    rational_init(&one);
    rational_init(&result);
    rational_set(1.0, &one);
    Operands o = operands_of(layer, c, format_info(format)->channels, &one);
    const double got[EVAL_STEPS] = {
        [EVAL_SOURCE_FACTOR] = steps->source_factor,
        [EVAL_SOURCE_PRODUCT] = steps->source_product,
        [EVAL_DESTINATION_FACTOR] = steps->destination_factor,
        [EVAL_DESTINATION_PRODUCT] = steps->destination_product,
        [EVAL_SUM] = steps->sum,
    };
    for (EvalStep step = EVAL_SOURCE_FACTOR; step <= EVAL_SUM; step++) {
        bool source = step < EVAL_DESTINATION;
        if (step == EVAL_DESTINATION)
            continue;
        if (step == EVAL_SUM)
            exact_function(part.func, &values[EVAL_SOURCE_PRODUCT].number,
                           &values[EVAL_DESTINATION_PRODUCT].number, &result);
        else if (step == EVAL_SOURCE_PRODUCT || step == EVAL_DESTINATION_PRODUCT)
            rational_mul(&values[step - 1].number, source ? o.source : o.destination, &result);
        else if (has_factors(part.func))
            exact_factor(source ? part.source : part.destination, part.alpha, &o, &result);
        else
            rational_set(1.0, &result);
        if (exact || is_unrounded(&eval->arithmetic, &part, step))
            rational_copy(&result, &values[step].number);
        else
            from_step(got[step], steps, format, &values[step].number);
        set_error(format, &result, &values[step]);
    }
    rational_clear(&one);
    rational_clear(&result);
}

/* What is put out, and both operands as they are used. */
static void take_operands(const BlendEval *eval, const BlendSteps *steps, int c, EvalLayer *layer)
{
    PixelFormat format = eval->desc.format;
    EvalChannel *channel = &layer->channels[c];
    EvalValue *values = channel->steps;
    Rational exact;
    rational_init(&exact);
    exact_source(layer->given, eval->desc.multiply, c, &exact);
    rational_set((double)layer->source[c], &values[EVAL_PUT_OUT].number);
    set_error(format, &exact, &values[EVAL_PUT_OUT]);
    if (c < format_info(format)->channels) {
        from_step(steps->source, steps, format, &values[EVAL_SOURCE].number);
        rational_copy(&values[EVAL_PUT_OUT].number, &exact);
        clamp_as(format, &exact);
        set_error(format, &exact, &values[EVAL_SOURCE]);
        channel->before = format_bits(format, eval->pixel, c);
        from_step(steps->destination, steps, format, &values[EVAL_DESTINATION].number);
        rational_fetch(channel->before, format, &exact);
        set_error(format, &exact, &values[EVAL_DESTINATION]);
    }
    rational_clear(&exact);
}

static void take_stored(const BlendEval *eval, uint32_t bits, EvalChannel *channel)
{
    PixelFormat format = eval->desc.format;
    EvalValue *stored = &channel->steps[EVAL_STORED];
    Rational exact;
    rational_init(&exact);
    rational_copy(&channel->steps[EVAL_SUM].number, &exact);
    clamp_as(format, &exact);
    channel->stored = bits;
    rational_fetch(bits, format, &stored->number);
    set_error(format, &exact, stored);
    if (rational_equal(&stored->number, &channel->exact))
        rational_set(0.0, &channel->off);
    else
        rational_sub(&stored->number, &channel->exact, &channel->off);
    channel->off_ulp = rational_ulps(&channel->off, &channel->exact, format);
    rational_clear(&exact);
}

/* The exact pixel behind the layer, of the colours as written. */
static void follow_exactly(BlendEval *eval, EvalLayer *layer)
{
    PixelFormat format = eval->desc.format;
    int channels = format_info(format)->channels;
    Rational source[4];
    for (int c = 0; c < 4; c++) {
        rational_init(&source[c]);
        exact_source(layer->given, eval->desc.multiply, c, &source[c]);
        clamp_as(format, &source[c]);
    }
    for (int c = 0; c < channels; c++) {
        ChannelEquation part = channel_equation(&eval->desc.equation, c);
        Operands o = {&source[c], &eval->exact[c], &source[3], &eval->exact[3]};
        exact_blend(&part, &o, &layer->channels[c].exact);
        clamp_as(format, &layer->channels[c].exact);
    }
    for (int c = 0; c < channels; c++)
        rational_copy(&layer->channels[c].exact, &eval->exact[c]);
    rational_one_minus(&source[3], &source[0]);
    rational_mul(&eval->see_through, &source[0], &eval->see_through);
    for (int c = 0; c < 4; c++)
        rational_clear(&source[c]);
}

static void count(EvalTotals *totals, const EvalLayer *layer, int channels)
{
    for (int c = 0; c < channels; c++)
        for (EvalStep step = 0; step < EVAL_STEPS; step++) {
            const EvalValue *value = &layer->channels[c].steps[step];
            totals->operations++;
            if (rational_is_zero(&value->error))
                continue;
            totals->rounded++;
            double size = isnan(value->ulp) ? INFINITY : fabs(value->ulp);
            if (size > totals->largest_ulp) {
                totals->largest_ulp = size;
                totals->layer = layer->index;
                totals->channel = c;
                totals->step = step;
            }
        }
}

bool blend_eval_next(BlendEval *eval)
{
    const EvalDesc *desc = &eval->desc;
    if (eval->done == desc->layers->count)
        return false;
    EvalLayer *layer = &eval->layer;
    int channels = format_info(desc->format)->channels;
    layer->index =
        blend_eval_is_over(&desc->equation) ? desc->layers->count - 1 - eval->done : eval->done;
    layer->given = &desc->layers->colours[layer->index];
    blend_eval_source(layer->given, desc->multiply, layer->source);
    BlendSteps steps[4];
    arithmetic_steps(&eval->arithmetic, &desc->equation, desc->format, layer->source, eval->pixel,
                     steps);
    follow_exactly(eval, layer);
    for (int c = 0; c < 4; c++)
        take_operands(eval, &steps[c], c, layer);
    for (int c = 0; c < channels; c++)
        compute(eval, &steps[c], c, layer);
    arithmetic_blend(&eval->arithmetic, &desc->equation, desc->format, 1,
                     (const float(*)[4])layer->source, eval->pixel);
    for (int c = 0; c < channels; c++)
        take_stored(eval, format_bits(desc->format, eval->pixel, c), &layer->channels[c]);
    count(&eval->totals, layer, channels);
    eval->done++;
    return true;
}

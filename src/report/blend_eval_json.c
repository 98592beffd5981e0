/* The document of `peel blend eval --json`: its keys are a contract, as those of json.c. */
#include "number/numeral.h"
#include "report/blend_cells.h"
#include "report/blend_eval.h"
#include "report/blend_terms.h"
#include "report/document.h"

#include <stdlib.h>
#include <string.h>

static const char *const step_keys[EVAL_STEPS] = {
    [EVAL_PUT_OUT] = "put_out",
    [EVAL_SOURCE] = "source",
    [EVAL_SOURCE_FACTOR] = "source_factor",
    [EVAL_SOURCE_PRODUCT] = "source_product",
    [EVAL_DESTINATION] = "destination",
    [EVAL_DESTINATION_FACTOR] = "destination_factor",
    [EVAL_DESTINATION_PRODUCT] = "destination_product",
    [EVAL_SUM] = "sum",
    [EVAL_STORED] = "stored",
};

static const char *const channel_keys[4] = {"red", "green", "blue", "alpha"};

enum {
    FRACTION_MOST = 1000 /* characters, of what there is one of for every layer */
};

static void put_fraction(Document *json, json_t *object, const char *key, const Rational *number,
                         size_t most)
{
    char *text = numeral_fraction(number);
    document_put(json, object, key, strlen(text) <= most ? json_string(text) : json_null());
    free(text);
}

/* "value" (null unless finite), "hex" (as a float or double, else null) and "fraction". */
static json_t *number_object(Document *json, const Rational *number, size_t most)
{
    json_t *object = json_object();
    char hex[NUMERAL_MAX];
    blend_cells_hex(number, hex);
    document_put(json, object, "value", document_real(rational_to_double(number)));
    document_put(json, object, "hex", hex[0] == '~' ? json_null() : json_string(hex));
    put_fraction(json, object, "fraction", number, most);
    return object;
}

static void put_error(Document *json, json_t *object, const char *prefix, const Rational *error,
                      double ulp, size_t most)
{
    char key[32];
    snprintf(key, sizeof key, "%s", prefix);
    document_put(json, object, key, document_real(rational_to_double(error)));
    snprintf(key, sizeof key, "%s_ulp", prefix);
    document_put(json, object, key, document_real(ulp));
    snprintf(key, sizeof key, "%s_fraction", prefix);
    put_fraction(json, object, key, error, most);
}

static json_t *channel_object(Document *json, const EvalDesc *desc, const TermsOf *terms,
                              const EvalChannel *channel, bool last)
{
    json_t *object = json_object(), *steps = json_object();
    size_t most = last ? SIZE_MAX : FRACTION_MOST;
    for (EvalStep step = 0; step < EVAL_STEPS; step++) {
        const EvalValue *value = &channel->steps[step];
        json_t *one = number_object(json, &value->number, FRACTION_MOST);
        document_put(json, one, "term", json_string(terms->steps[step]));
        put_error(json, one, "error", &value->error, value->ulp, FRACTION_MOST);
        document_put(json, steps, step_keys[step], one);
    }
    bool unorm = format_info(desc->format)->kind == KIND_UNORM;
    char bits[16];
    snprintf(bits, sizeof bits, "0x%0*x", 2 * format_info(desc->format)->channel_bytes,
             channel->stored);
    document_put(json, object, "bits", json_string(bits));
    document_put(json, object, "code", unorm ? json_integer(channel->stored) : json_null());
    document_put(json, object, "steps", steps);
    document_put(json, object, "exact", number_object(json, &channel->exact, most));
    put_error(json, object, "off", &channel->off, channel->off_ulp, most);
    return object;
}

static json_t *layer_object(Document *json, const BlendEval *eval, const BlendTerms *terms)
{
    const EvalDesc *desc = &eval->desc;
    const EvalLayer *layer = &eval->layer;
    json_t *object = json_object(), *given = json_array(), *source = json_array();
    json_t *channels = json_object();
    bool last = eval->done == desc->layers->count;
    for (int c = 0; c < 4; c++) {
        document_append(json, given, number_object(json, &layer->given->channels[c], SIZE_MAX));
        document_append(json, source, document_hex((double)layer->source[c]));
    }
    for (int c = 0; c < format_info(desc->format)->channels; c++)
        document_put(
            json, channels, channel_keys[c],
            channel_object(json, desc, blend_terms_of(terms, c), &layer->channels[c], last));
    document_put(json, object, "layer", document_count(layer->index + 1));
    document_put(json, object, "given", given);
    document_put(json, object, "source", source);
    document_put(json, object, "let_through",
                 number_object(json, &eval->see_through, last ? SIZE_MAX : FRACTION_MOST));
    document_put(json, object, "channels", channels);
    return object;
}

static json_t *sides_object(Document *json, const BlendEval *eval)
{
    EvalSides sides;
    blend_eval_sides(eval, &sides);
    json_t *object = sides.refusal ? json_null() : json_object();
    for (int c = 0; c < 4 && !sides.refusal; c++) {
        json_t *channel = json_object();
        document_put(json, channel, "under", number_object(json, &sides.under[c], SIZE_MAX));
        document_put(json, channel, "over", number_object(json, &sides.over[c], SIZE_MAX));
        document_put(json, channel, "exact", number_object(json, &sides.exact[c], SIZE_MAX));
        document_put(json, channel, "under_less_over_ulp", document_real(sides.between_ulp[c]));
        document_put(json, channel, "under_less_exact_ulp", document_real(sides.under_ulp[c]));
        document_put(json, channel, "over_less_exact_ulp", document_real(sides.over_ulp[c]));
        document_put(json, object, channel_keys[c], channel);
    }
    blend_eval_sides_free(&sides);
    return object;
}

static json_t *totals_object(Document *json, const EvalTotals *totals)
{
    json_t *object = json_object();
    bool rounded = totals->rounded > 0;
    document_put(json, object, "steps", document_count(totals->operations));
    document_put(json, object, "rounded", document_count(totals->rounded));
    document_put(json, object, "largest_ulp", document_real(totals->largest_ulp));
    document_put(json, object, "layer", rounded ? document_count(totals->layer + 1) : json_null());
    document_put(json, object, "channel",
                 rounded ? json_string(channel_keys[totals->channel]) : json_null());
    document_put(json, object, "step",
                 rounded ? json_string(step_keys[totals->step]) : json_null());
    return object;
}

static Result add_arithmetic(Document *json, const EvalDesc *desc, const EvalNamed *named,
                             const BlendTerms *terms, json_t *array)
{
    BlendEval eval;
    Result result = blend_eval_open(desc, &named->arithmetic, &eval);
    if (result != RESULT_OK)
        return result;
    json_t *object = json_object(), *layers = json_array();
    while (blend_eval_next(&eval))
        document_append(json, layers, layer_object(json, &eval, terms));
    document_put(json, object, "name", document_string(named->name));
    document_put(json, object, "wrong", json_boolean(named->wrong));
    document_put(json, object, "layers", layers);
    document_put(json, object, "under_over", sides_object(json, &eval));
    document_put(json, object, "totals", totals_object(json, &eval.totals));
    document_append(json, array, object);
    blend_eval_close(&eval);
    return RESULT_OK;
}

Result report_blend_eval_json(const EvalDesc *desc, const EvalNamed *arithmetics, size_t count,
                              const char *path)
{
    Document json = {0};
    BlendTerms terms;
    char equation[EQUATION_TEXT];
    json_t *root = json_object(), *array = json_array(), *start = json_array();
    Result result = RESULT_OK;
    float cleared[4];
    blend_terms(desc, &terms);
    equation_print(&desc->equation, equation);
    blend_eval_cleared(&desc->equation, cleared);
    for (int c = 0; c < format_info(desc->format)->channels; c++) {
        Rational number;
        rational_init(&number);
        rational_set((double)cleared[c], &number);
        document_append(
            &json, start,
            number_object(&json, desc->start ? &desc->start->channels[c] : &number, SIZE_MAX));
        rational_clear(&number);
    }
    document_put(&json, root, "equation", json_string(equation));
    document_put(&json, root, "colour_formula", json_string(terms.colour.formula));
    document_put(&json, root, "alpha_formula", json_string(terms.alpha.formula));
    document_put(&json, root, "format", json_string(format_info(desc->format)->name));
    document_put(&json, root, "straight", json_boolean(desc->multiply));
    document_put(&json, root, "start", start);
    for (size_t i = 0; i < count && result == RESULT_OK; i++)
        result = add_arithmetic(&json, desc, &arithmetics[i], &terms, array);
    document_put(&json, root, "arithmetics", array);
    if (result != RESULT_OK) {
        json_decref(root);
        return result;
    }
    return document_write(&json, root, path);
}

#include "blend/equation.h"

#include <stdio.h>
#include <string.h>

static const EquationInfo infos[EQUATION_COUNT] = {
    [EQUATION_UNDER] = {"under",
                        "behind what is there: s*T + d, T*(1 - sA); premultiplied, T is alpha",
                        BLEND_EQUATION_UNDER},
    [EQUATION_OVER] = {"over",
                       "in front, straight colours: s*sA + d*(1 - sA), sA + dA*(1 - sA)",
                       {FACTOR_SRC_ALPHA, FACTOR_ONE_MINUS_SRC_ALPHA, FACTOR_ONE,
                        FACTOR_ONE_MINUS_SRC_ALPHA, BLEND_FUNC_ADD, BLEND_FUNC_ADD}},
    [EQUATION_OVER_PREMULTIPLIED] = {"over-premultiplied",
                                     "in front, premultiplied colours: s + d*(1 - sA)",
                                     {FACTOR_ONE, FACTOR_ONE_MINUS_SRC_ALPHA, FACTOR_ONE,
                                      FACTOR_ONE_MINUS_SRC_ALPHA, BLEND_FUNC_ADD, BLEND_FUNC_ADD}},
    [EQUATION_ADD] = {"add", "s + d", BLEND_EQUATION_ADD},
    [EQUATION_MAX] = {"max", "the greater of s and d", BLEND_EQUATION_MAX},
    [EQUATION_WEIGHTED_SUM] = {"weighted-sum",
                               "s*sA + d, sA + dA: colours weighted by alpha, and the weights",
                               {FACTOR_SRC_ALPHA, FACTOR_ONE, FACTOR_ONE, FACTOR_ONE,
                                BLEND_FUNC_ADD, BLEND_FUNC_ADD}},
    [EQUATION_PRODUCT] = {"product", "d*(1 - s)", BLEND_EQUATION_PRODUCT},
    [EQUATION_SEED] = {"seed", "s*dA + d in all channels", BLEND_EQUATION_SEED},
    [EQUATION_OVER_TRANSMITTANCE] = {"over-transmittance",
                                     "in front, premultiplied: s + d*(1 - sA), T*(1 - sA)",
                                     BLEND_EQUATION_OVER_TRANSMITTANCE},
    [EQUATION_REPLACE] = {"replace", "s*sA + d*(1 - sA) in all channels", BLEND_EQUATION_REPLACE},
    [EQUATION_KEEP] = {"keep", "s*(1 - dA) + d in all channels", BLEND_EQUATION_KEEP},
};

static const char *const factor_names[FACTOR_COUNT] = {
    [FACTOR_ZERO] = "zero",
    [FACTOR_ONE] = "one",
    [FACTOR_SRC_COLOR] = "src-color",
    [FACTOR_ONE_MINUS_SRC_COLOR] = "one-minus-src-color",
    [FACTOR_DST_COLOR] = "dst-color",
    [FACTOR_ONE_MINUS_DST_COLOR] = "one-minus-dst-color",
    [FACTOR_SRC_ALPHA] = "src-alpha",
    [FACTOR_ONE_MINUS_SRC_ALPHA] = "one-minus-src-alpha",
    [FACTOR_DST_ALPHA] = "dst-alpha",
    [FACTOR_ONE_MINUS_DST_ALPHA] = "one-minus-dst-alpha",
    [FACTOR_SRC_ALPHA_SATURATE] = "src-alpha-saturate",
};

static const char *const func_names[BLEND_FUNC_COUNT] = {
    [BLEND_FUNC_ADD] = "add",
    [BLEND_FUNC_SUBTRACT] = "subtract",
    [BLEND_FUNC_REVERSE_SUBTRACT] = "reverse-subtract",
    [BLEND_FUNC_MIN] = "min",
    [BLEND_FUNC_MAX] = "max",
};

const EquationInfo *equation_info(EquationId id)
{
    return &infos[id];
}

const char *equation_factor_name(BlendFactor factor)
{
    return factor_names[factor];
}

const char *equation_func_name(BlendFunc func)
{
    return func_names[func];
}

static bool same(const BlendEquation *a, const BlendEquation *b)
{
    return a->source == b->source && a->destination == b->destination &&
           a->source_alpha == b->source_alpha && a->destination_alpha == b->destination_alpha &&
           a->func == b->func && a->func_alpha == b->func_alpha;
}

EquationId equation_id(const BlendEquation *equation)
{
    EquationId id = 0;
    while (id < EQUATION_COUNT && !same(equation, &infos[id].equation))
        id++;
    return id;
}

/* The first of `count` names that text[0..length) is; -1 if none. */
static int find(const char *const *names, int count, const char *text, size_t length)
{
    for (int i = 0; i < count; i++)
        if (strlen(names[i]) == length && memcmp(names[i], text, length) == 0)
            return i;
    return -1;
}

/* What a list is of. */
typedef struct Words {
    const char *const *names;
    int count, most;
    const char *kind;
} Words;

static const Words factor_words = {factor_names, FACTOR_COUNT, 4, "factor"};
static const Words func_words = {func_names, BLEND_FUNC_COUNT, 2, "function"};

enum {
    NAMES_TEXT = 512
};

/* "zero, one or src-alpha". */
static const char *list_names(const char *const *names, int count, char out[NAMES_TEXT])
{
    int at = 0;
    for (int i = 0; i < count; i++)
        at += snprintf(out + at, (size_t)(NAMES_TEXT - at), "%s%s",
                       i == 0          ? ""
                       : i < count - 1 ? ", "
                                       : " or ",
                       names[i]);
    return out;
}

/* A text without commas that is neither a name nor a factor. */
static Result fail_name(const char *text)
{
    const char *names[EQUATION_COUNT];
    char list[NAMES_TEXT];
    for (int i = 0; i < EQUATION_COUNT; i++)
        names[i] = infos[i].name;
    return result_fail(RESULT_BAD_INPUT,
                       "equation: '%s': expected %s, or factors, such as one,one-minus-src-alpha",
                       text, list_names(names, EQUATION_COUNT, list));
}

/* Comma-separated names of text[0..length) to their places in the table; *count: how many. */
static Result parse_list(const char *text, size_t length, const Words *words, int out[4],
                         int *count)
{
    const char *at = text, *end = text + length;
    for (*count = 0;;) {
        const char *comma = memchr(at, ',', (size_t)(end - at));
        size_t part = (size_t)((comma ? comma : end) - at);
        if (*count == words->most)
            return result_fail(RESULT_BAD_INPUT,
                               "equation: '%.*s': expected at most %d %ss, separated by commas",
                               (int)length, text, words->most, words->kind);
        out[*count] = find(words->names, words->count, at, part);
        if (out[*count] < 0) {
            char list[NAMES_TEXT];
            return result_fail(RESULT_BAD_INPUT, "equation: '%.*s': expected a %s: %s", (int)part,
                               at, words->kind, list_names(words->names, words->count, list));
        }
        ++*count;
        if (!comma)
            return RESULT_OK;
        at = comma + 1;
    }
}

Result equation_parse(const char *text, BlendEquation *out)
{
    for (int i = 0; i < EQUATION_COUNT; i++)
        if (strcmp(infos[i].name, text) == 0) {
            *out = infos[i].equation;
            return RESULT_OK;
        }
    const char *colon = strchr(text, ':');
    size_t length = colon ? (size_t)(colon - text) : strlen(text);
    if (!colon && !strchr(text, ',') && find(factor_names, FACTOR_COUNT, text, length) < 0)
        return fail_name(text);
    int factors[4], funcs[4] = {BLEND_FUNC_ADD}, count, func_count = 1;
    Result result = parse_list(text, length, &factor_words, factors, &count);
    if (result == RESULT_OK && colon)
        result = parse_list(colon + 1, strlen(colon + 1), &func_words, funcs, &func_count);
    if (result != RESULT_OK)
        return result;
    if (count != 2 && count != 4)
        return result_fail(RESULT_BAD_INPUT,
                           "equation: '%s': expected 2 factors (source, destination) or 4 (also of "
                           "alpha), found %d",
                           text, count);
    *out = (BlendEquation){.source = factors[0],
                           .destination = factors[1],
                           .source_alpha = factors[count - 2],
                           .destination_alpha = factors[count - 1],
                           .func = funcs[0],
                           .func_alpha = funcs[func_count - 1]};
    return RESULT_OK;
}

void equation_print(const BlendEquation *equation, char out[EQUATION_TEXT])
{
    EquationId id = equation_id(equation);
    if (id < EQUATION_COUNT) {
        snprintf(out, EQUATION_TEXT, "%s", infos[id].name);
        return;
    }
    int at = snprintf(out, EQUATION_TEXT, "%s,%s", factor_names[equation->source],
                      factor_names[equation->destination]);
    if (equation->source_alpha != equation->source ||
        equation->destination_alpha != equation->destination)
        at += snprintf(out + at, (size_t)(EQUATION_TEXT - at), ",%s,%s",
                       factor_names[equation->source_alpha],
                       factor_names[equation->destination_alpha]);
    if (equation->func == BLEND_FUNC_ADD && equation->func_alpha == BLEND_FUNC_ADD)
        return;
    at += snprintf(out + at, (size_t)(EQUATION_TEXT - at), ":%s", func_names[equation->func]);
    if (equation->func_alpha != equation->func)
        snprintf(out + at, (size_t)(EQUATION_TEXT - at), ",%s", func_names[equation->func_alpha]);
}

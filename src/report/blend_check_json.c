/* The documents of `peel blend check --json`: their keys are a contract; more may be added. */
#include "report/blend_check.h"
#include "report/blend_example.h"

#include <math.h>

static json_t *ulp_of(uint32_t ulp)
{
    return ulp == UINT32_MAX ? json_null() : document_count(ulp);
}

static json_t *tally_of(Document *json, const BlendTally *tally)
{
    json_t *object = json_object();
    document_put(json, object, "values", document_count(tally->values));
    document_put(json, object, "differing", document_count(tally->differing));
    document_put(json, object, "max_ulp", ulp_of(tally->max_ulp));
    return object;
}

static json_t *candidate_of(Document *json, const BlendReport *report, const BlendCandidate *one)
{
    json_t *object = json_object(), *worst = json_array();
    uint64_t differing = one->groups[GROUP_COLOR].differing + one->groups[GROUP_ALPHA].differing;
    for (int i = 0; i < one->worst_count; i++)
        document_append(json, worst,
                        blend_json_example(json, &report->equation, report->format,
                                           &one->arithmetic, &one->worst[i]));
    document_put(json, object, "name", document_string(one->name));
    document_put(json, object, "named", json_boolean(one->info != NULL));
    document_put(json, object, "wrong",
                 json_boolean(one->info && arithmetic_is_wrong(one->info, report->format)));
    document_put(json, object, "refused",
                 one->refused ? document_string(one->refused) : json_null());
    document_put(json, object, "vectors", document_count(one->vectors));
    document_put(json, object, "color", tally_of(json, &one->groups[GROUP_COLOR]));
    document_put(json, object, "alpha", tally_of(json, &one->groups[GROUP_ALPHA]));
    document_put(json, object, "simplest",
                 differing ? blend_json_example(json, &report->equation, report->format,
                                                &one->arithmetic, &one->simplest)
                           : json_null());
    document_put(json, object, "worst", worst);
    return object;
}

/* The value farthest outside, or else with the largest error. */
static json_t *largest_of(Document *json, PixelFormat format, const BlendRuleTally *rule)
{
    json_t *object = blend_json_operands(json, format, rule->set, rule->index, rule->channel,
                                         rule->source, rule->pixel);
    document_put(json, object, "exact", document_real(rule->exact));
    document_put(json, object, "got", blend_json_bits(format, rule->got));
    return object;
}

static json_t *rule_of(Document *json, PixelFormat format, const BlendRuleTally *rule)
{
    json_t *object = json_object();
    document_put(json, object, "rule", document_string(rule->info->name));
    document_put(json, object, "source", document_string(rule->info->source));
    document_put(json, object, "allowed", document_string(rule->info->allowed));
    document_put(json, object, "api", document_string(blend_api_name(rule->info->api)));
    document_put(json, object, "judged", document_count(rule->judged));
    document_put(json, object, "unstated", document_count(rule->unstated));
    document_put(json, object, "outside", document_count(rule->outside));
    document_put(json, object, "largest_units", document_real(rule->largest));
    document_put(json, object, "largest", document_real(rule->largest_real));
    document_put(json, object, "example",
                 rule->has_example ? largest_of(json, format, rule) : json_null());
    return object;
}

static json_t *best_of(const BlendReport *report, BlendGroup group)
{
    size_t best = blend_best(report, group);
    return best == SIZE_MAX ? json_null() : document_string(report->candidates[best].name);
}

static json_t *report_of(Document *json, const ReportBlend *blend)
{
    const BlendReport *report = blend->report;
    json_t *object = json_object(), *candidates = json_array(), *rules = json_array();
    char equation[EQUATION_TEXT], name[REPORT_BLEND_NAME];
    equation_print(&report->equation, equation);
    report_blend_name(report, name);
    for (size_t i = 0; i < report->count; i++)
        document_append(json, candidates, candidate_of(json, report, &report->candidates[i]));
    for (int i = 0; i < BLEND_RULES; i++)
        if (report->rules[i].applies)
            document_append(json, rules, rule_of(json, report->format, &report->rules[i]));
    document_put(json, object, "format", document_string(format_info(report->format)->name));
    document_put(json, object, "equation", document_string(equation));
    document_put(json, object, "vectors", document_count(report->vectors));
    document_put(json, object, "values", document_count(blend_values(report)));
    document_put(json, object, "arithmetic", document_string(name));
    document_put(json, object, "color", best_of(report, GROUP_COLOR));
    document_put(json, object, "alpha", best_of(report, GROUP_ALPHA));
    document_put(json, object, "unexplained", document_count(blend_unexplained(report)));
    document_put(json, object, "verdict",
                 document_string(blend_verdict_name(blend_verdict(report, blend->api))));
    document_put(json, object, "against",
                 report->has_against ? document_string(report->candidates[0].name) : json_null());
    document_put(json, object, "api",
                 document_string(blend->api < API_COUNT ? blend_api_name(blend->api) : "any"));
    document_put(json, object, "arithmetics", candidates);
    document_put(json, object, "rules", rules);
    return object;
}

Result report_blend_json(const ReportBlend *blends, size_t count, const char *path)
{
    Document json = {0};
    json_t *root = json_object(), *reports = json_array();
    for (size_t i = 0; i < count; i++)
        document_append(&json, reports, report_of(&json, &blends[i]));
    document_put(&json, root, "subject", document_string(count ? blends[0].subject : ""));
    document_put(&json, root, "exit_code", json_integer(count ? blends[0].code : 0));
    document_put(&json, root, "reports", reports);
    return document_write(&json, root, path);
}

static json_t *sequence_example(Document *json, const SequenceReport *report)
{
    const SequenceExample *worst = &report->worst;
    json_t *object = json_object();
    document_put(json, object, "index", document_count(worst->index));
    document_put(json, object, "layers", json_integer(worst->layers));
    document_put(json, object, "channel", json_string(blend_channel_name(worst->channel)));
    document_put(json, object, "low", document_real(worst->low));
    document_put(json, object, "high", document_real(worst->high));
    document_put(json, object, "rounded_bits", document_count(worst->rounded));
    document_put(json, object, "got_bits", document_count(worst->got));
    document_put(json, object, "ulp", ulp_of(worst->ulp));
    return object;
}

Result report_blend_sequences_json(const SequenceReport *report, const char *subject, int code,
                                   const char *path)
{
    Document json = {0};
    json_t *root = json_object(), *candidates = json_array();
    for (size_t i = 0; i < report->count; i++) {
        const SequenceCandidate *one = &report->candidates[i];
        json_t *object = json_object();
        document_put(&json, object, "name", document_string(one->info->name));
        document_put(&json, object, "wrong",
                     json_boolean(arithmetic_is_wrong(one->info, report->format)));
        document_put(&json, object, "values", document_count(one->values));
        document_put(&json, object, "differing", document_count(one->differing));
        document_put(&json, object, "max_ulp", ulp_of(one->max_ulp));
        document_append(&json, candidates, object);
    }
    document_put(&json, root, "subject", document_string(subject));
    document_put(&json, root, "exit_code", json_integer(code));
    document_put(&json, root, "format", document_string(format_info(report->format)->name));
    document_put(&json, root, "sequences", document_count(report->sequences));
    document_put(&json, root, "values", document_count(report->values));
    document_put(&json, root, "outside", document_count(report->outside));
    document_put(&json, root, "correctly_rounded", document_count(report->rounded));
    document_put(&json, root, "worst",
                 report->has_worst ? sequence_example(&json, report) : json_null());
    document_put(&json, root, "arithmetics", candidates);
    return document_write(&json, root, path);
}

Result report_blend_list_json(const BlendWrongList *list, const char *path)
{
    Document json = {0};
    json_t *root = json_object(), *all = json_array(), *rows = json_array();
    for (size_t i = 0; i < arithmetic_count(); i++) {
        const ArithmeticInfo *info = arithmetic_info(i);
        json_t *object = json_object(), *wrong_in = json_array();
        for (int k = 0; k < ARITHMETIC_FORMATS; k++)
            if (arithmetic_is_wrong(info, arithmetic_formats[k]))
                document_append(&json, wrong_in,
                                document_string(format_info(arithmetic_formats[k])->name));
        document_put(&json, object, "name", document_string(info->name));
        document_put(&json, object, "what", document_string(info->what));
        document_put(&json, object, "wrong", json_boolean(info->wrong));
        document_put(&json, object, "wrong_in", wrong_in);
        document_append(&json, all, object);
    }
    for (size_t i = 0; i < list->count; i++) {
        const BlendWrong *row = &list->rows[i];
        const EquationInfo *equation = equation_info(row->equation);
        json_t *object = json_object();
        document_put(&json, object, "arithmetic", document_string(row->info->name));
        document_put(&json, object, "format", document_string(format_info(row->format)->name));
        document_put(&json, object, "equation", document_string(equation->name));
        document_put(&json, object, "no_right_arithmetic_gives_it", json_boolean(row->alone));
        document_put(&json, object, "vector",
                     row->shown ? blend_json_example(&json, &equation->equation, row->format,
                                                     &row->info->arithmetic, &row->example)
                                : json_null());
        document_append(&json, rows, object);
    }
    document_put(&json, root, "arithmetics", all);
    document_put(&json, root, "shown_by", rows);
    return document_write(&json, root, path);
}

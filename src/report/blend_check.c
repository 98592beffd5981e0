#include "report/blend_check.h"

#include "base/memory.h"
#include "report/blend_example.h"
#include "report/summary.h"
#include "study/blend_twins.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    ROWS =
        12 /* arithmetics that are shown without --verbose: those that explain, then the nearest */
};

void report_blend_name(const BlendReport *report, char out[REPORT_BLEND_NAME])
{
    size_t whole = blend_best_whole(report);
    size_t color = blend_best(report, GROUP_COLOR), alpha = blend_best(report, GROUP_ALPHA);
    bool split =
        color != SIZE_MAX && alpha != SIZE_MAX && blend_explains(report, color, GROUP_COLOR) &&
        blend_explains(report, alpha, GROUP_ALPHA) &&
        !(blend_explains(report, whole, GROUP_COLOR) && blend_explains(report, whole, GROUP_ALPHA));
    if (split)
        snprintf(out, REPORT_BLEND_NAME, "colour %s, alpha %s", report->candidates[color].name,
                 report->candidates[alpha].name);
    else
        snprintf(out, REPORT_BLEND_NAME, "%s", report->candidates[whole].name);
}

/* ---- rows ------------------------------------------------------------------------------------ */

typedef struct Order {
    const BlendReport *report;
    size_t candidate;
    double share; /* of values that differ; 2 of one that is refused */
} Order;

static int by_share(const void *a, const void *b)
{
    const Order *x = a, *y = b;
    if (x->share != y->share)
        return x->share < y->share ? -1 : 1;
    return x->candidate < y->candidate ? -1 : x->candidate > y->candidate;
}

static uint64_t all_differing(const BlendCandidate *one)
{
    return one->groups[GROUP_COLOR].differing + one->groups[GROUP_ALPHA].differing;
}

static Order *sorted(const BlendReport *report)
{
    Order *order = memory_array(report->count, sizeof *order);
    for (size_t i = 0; i < report->count && order; i++) {
        const BlendCandidate *one = &report->candidates[i];
        uint64_t values = one->groups[GROUP_COLOR].values + one->groups[GROUP_ALPHA].values;
        double share = values ? (double)all_differing(one) / (double)values : 2.0;
        order[i] = (Order){report, i, one->refused ? 2.0 : share};
    }
    if (order)
        qsort(order, report->count, sizeof *order, by_share);
    return order;
}

static void print_tally(PixelFormat format, const BlendTally *tally, FILE *out)
{
    char count[SUMMARY_NUMBER], most[BLEND_TEXT] = "";
    if (tally->differing)
        blend_text_ulp(format, tally->max_ulp, most);
    if (tally->values)
        fprintf(out, " %13s %12s", summary_count(tally->differing, count), most);
    else
        fprintf(out, " %13s %12s", "-", "");
}

static void print_row(const BlendReport *report, const BlendCandidate *one, FILE *out)
{
    char count[SUMMARY_NUMBER];
    fprintf(out, "%c %-26s", all_differing(one) == 0 && one->vectors == report->vectors ? '=' : ' ',
            one->name);
    if (strlen(one->name) > 26)
        fprintf(out, "\n%28s", "");
    print_tally(report->format, &one->groups[GROUP_COLOR], out);
    print_tally(report->format, &one->groups[GROUP_ALPHA], out);
    if (one->info && arithmetic_is_wrong(one->info, report->format))
        fputs("  wrong", out);
    if (one->vectors < report->vectors)
        fprintf(out, "  in %s", summary_count(one->vectors, count));
    fputc('\n', out);
}

static Result print_rows(const ReportBlend *blend, FILE *out)
{
    const BlendReport *report = blend->report;
    Order *order = sorted(report);
    size_t hidden = 0, shown = 0;
    if (!order)
        return RESULT_NO_MEMORY;
    fprintf(out, "\n  %-26s %13s %12s %13s %12s\n", "arithmetic (= gives all)", "colour differs",
            "at most", "alpha differs", "at most");
    for (size_t i = 0; i < report->count; i++) {
        const BlendCandidate *one = &report->candidates[order[i].candidate];
        if (one->refused)
            continue;
        if (!blend->verbose && shown >= ROWS && all_differing(one) > 0)
            hidden++;
        else
            print_row(report, one, out);
        shown++;
    }
    if (hidden)
        fprintf(out, "  and %zu that are farther off (--verbose)\n", hidden);
    free(order);
    return RESULT_OK;
}

/* ---- rules ----------------------------------------------------------------------------------- */

static const char *largest(const BlendReport *report, const BlendRuleTally *rule,
                           char out[BLEND_TEXT])
{
    char number[SUMMARY_NUMBER];
    bool real = rule->info->api == API_SUITE && !format_info(report->format)->unorm_max;
    bool count = rule->info->allowed[0] == 'n';
    if (!rule->judged || count)
        snprintf(out, BLEND_TEXT, "-");
    else if (!(rule->largest_real < (double)INFINITY))
        snprintf(out, BLEND_TEXT, "not finite");
    else if (real)
        snprintf(out, BLEND_TEXT, "%s", summary_real(rule->largest_real, number));
    else
        snprintf(out, BLEND_TEXT, "%s %s", summary_real(rule->largest, number),
                 format_info(report->format)->unorm_max ? "codes" : "ULP");
    return out;
}

/* The value that is farthest outside the rule. */
static void print_outside(const BlendReport *report, const BlendRuleTally *rule, FILE *out)
{
    char text[BLEND_TEXT];
    uint32_t most = format_info(report->format)->unorm_max;
    BlendExample example = {.set = rule->set, .index = rule->index, .channel = rule->channel};
    memcpy(example.source, rule->source, sizeof example.source);
    memcpy(example.pixel, rule->pixel, sizeof example.pixel);
    fprintf(out, "outside %s, %s: %s vector %llu, %s\n  ", rule->info->name, rule->info->source,
            vectors_set_name(rule->set), (unsigned long long)rule->index,
            blend_channel_name(rule->channel));
    blend_print_operands(&report->equation, report->format, &example, false, out);
    fprintf(out, "\n  got %s, exactly %.9g\n", blend_text_bits(report->format, rule->got, text),
            most ? rule->exact * most : rule->exact);
}

static void print_rules(const BlendReport *report, FILE *out)
{
    char count[SUMMARY_NUMBER], text[BLEND_TEXT];
    fprintf(out, "\n%-12s %-28s %-33s %-13s %s\n", "rule", "source", "allowed", "largest seen",
            "outside");
    for (int i = 0; i < BLEND_RULES; i++) {
        const BlendRuleTally *rule = &report->rules[i];
        if (!rule->applies)
            continue;
        fprintf(out, "%-12s %-28s %-33s %-13s ", rule->info->name, rule->info->source,
                rule->info->allowed, largest(report, rule, text));
        if (!rule->judged)
            fputs("no value", out);
        else
            fputs(rule->outside ? summary_count(rule->outside, count) : "none", out);
        fputc('\n', out);
    }
    for (int i = 0; i < BLEND_RULES; i++)
        if (report->rules[i].applies && report->rules[i].outside)
            print_outside(report, &report->rules[i], out);
    fputs(
        "Largest: off the real result of the operands, in units of the format at the greatest of\n"
        "operands, products and result. Not judged: what a rule says nothing of (infinities, NaN,\n"
        "what may be flushed or overflow; of the test suites, operands outside 0 to 1).\n",
        out);
}

/* ---- what follows ---------------------------------------------------------------------------- */

static Result print_twins(const BlendReport *report, size_t best, FILE *out)
{
    BlendTwin *twins;
    size_t count;
    char text[BLEND_TEXT];
    Result result = blend_twins(report, best, &twins, &count);
    for (size_t i = 0; i < count && result == RESULT_OK; i++) {
        const BlendExample *example = &twins[i].example;
        fprintf(out, "%s  %s", i ? "" : "The same on these vectors:\n",
                report->candidates[twins[i].candidate].name);
        if (!twins[i].apart) {
            fputs(": and on all that were looked at\n", out);
            continue;
        }
        fprintf(out, ": not on %s vector %llu, %s:\n      ", vectors_set_name(example->set),
                (unsigned long long)example->index, blend_channel_name(example->channel));
        blend_print_operands(&report->equation, report->format, example, true, out);
        fprintf(out, "; gives %s", blend_text_bits(report->format, example->got, text));
        fprintf(out, ", not %s\n", blend_text_bits(report->format, example->expected, text));
    }
    free(twins);
    return result;
}

static void print_examples(const ReportBlend *blend, size_t candidate, FILE *out)
{
    const BlendReport *report = blend->report;
    const BlendCandidate *one = &report->candidates[candidate];
    if (all_differing(one) == 0)
        return;
    fprintf(out, "\nSimplest value that %s does not give:\n", one->name);
    blend_print_example(report, one->name, &one->arithmetic, &one->simplest, out);
    if (one->worst_count > 0)
        fprintf(out, "\nFarthest from %s:\n", one->name);
    for (int i = 0; i < one->worst_count; i++)
        blend_print_example(report, one->name, &one->arithmetic, &one->worst[i], out);
}

static const char *sentence(const ReportBlend *blend)
{
    const BlendReport *report = blend->report;
    switch (blend_verdict(report, blend->api)) {
    case BLEND_NAMED:
        return "a right arithmetic, all values";
    case BLEND_WRONG:
        return "a WRONG arithmetic";
    case BLEND_UNNAMED:
        return "no named arithmetic, but within the rules";
    default:
        return "no named arithmetic, and OUTSIDE the rules";
    }
}

static void print_against(const ReportBlend *blend, FILE *out)
{
    const BlendReport *report = blend->report;
    const BlendCandidate *one = &report->candidates[0];
    char count[SUMMARY_NUMBER], values[SUMMARY_NUMBER], most[BLEND_TEXT];
    uint32_t ulp = one->groups[GROUP_COLOR].max_ulp > one->groups[GROUP_ALPHA].max_ulp
                       ? one->groups[GROUP_COLOR].max_ulp
                       : one->groups[GROUP_ALPHA].max_ulp;
    fprintf(out, "\nagainst %s: %s of %s values differ, by %s at most\n", one->name,
            summary_count(all_differing(one), count), summary_count(blend_values(report), values),
            blend_text_ulp(report->format, ulp, most));
}

static void print_verdict(const ReportBlend *blend, FILE *out)
{
    const BlendReport *report = blend->report;
    char name[REPORT_BLEND_NAME], count[SUMMARY_NUMBER], values[SUMMARY_NUMBER];
    uint64_t unexplained = blend_unexplained(report);
    report_blend_name(report, name);
    fprintf(out, "\n%s: %s\n", unexplained ? "nearest" : "arithmetic", name);
    size_t best = blend_best_whole(report);
    const ArithmeticInfo *info = report->candidates[best].info;
    if (info && strcmp(info->name, name) == 0)
        fprintf(out, "  %s\n", info->what);
    if (unexplained)
        fprintf(out, "%s of %s values unexplained\n", summary_count(unexplained, count),
                summary_count(blend_values(report), values));
    fprintf(out, "verdict: %s\n", sentence(blend));
}

Result report_blend_print(const ReportBlend *blend, FILE *out)
{
    const BlendReport *report = blend->report;
    char equation[EQUATION_TEXT], vectors[SUMMARY_NUMBER], values[SUMMARY_NUMBER];
    equation_print(&report->equation, equation);
    fprintf(out, "%s: %s, %s, %s\n", blend->subject, format_info(report->format)->name, equation,
            blend->vectors);
    fprintf(out, "%s vectors, %s values", summary_count(report->vectors, vectors),
            summary_count(blend_values(report), values));
    fprintf(out, *blend->note ? ", called \"%s\"\n" : "\n", blend->note);
    Result result = print_rows(blend, out);
    if (result != RESULT_OK)
        return result;
    print_rules(report, out);
    size_t best = blend_best_whole(report);
    print_examples(blend, report->has_against ? 0 : best, out);
    if (report->has_against)
        print_against(blend, out);
    print_verdict(blend, out);
    return print_twins(report, best, out);
}

void report_blend_row_head(FILE *out)
{
    fprintf(out, "%-8s %-18s %12s %-24s %12s %s\n", "format", "equation", "vectors", "arithmetic",
            "unexplained", "rules");
}

void report_blend_row(const BlendReport *report, FILE *out)
{
    char name[REPORT_BLEND_NAME], equation[EQUATION_TEXT], count[SUMMARY_NUMBER];
    char unexplained[SUMMARY_NUMBER];
    report_blend_name(report, name);
    equation_print(&report->equation, equation);
    bool nearest = blend_unexplained(report) > 0;
    fprintf(out, "%-8s %-18s %12s %s%-*s %12s ", format_info(report->format)->name, equation,
            summary_count(report->vectors, count), nearest ? "nearest " : "", nearest ? 16 : 24,
            name, summary_count(blend_unexplained(report), unexplained));
    const char *separator = "";
    for (int api = 0; api < API_SUITE; api++)
        if (blend_rules_broken(report->rules, (BlendApi)api)) {
            fprintf(out, "%s%s", *separator ? separator : "not ", blend_api_name((BlendApi)api));
            separator = " ";
        }
    fputs(*separator ? "\n" : "within\n", out);
}

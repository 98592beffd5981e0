/* The texts of `peel blend check` for sequences and of --list. */
#include "report/blend_check.h"
#include "report/blend_example.h"
#include "report/summary.h"

static const char *bound(PixelFormat format, double x, char out[BLEND_TEXT])
{
    snprintf(out, BLEND_TEXT, format_info(format)->unorm_max ? "%.0f" : "%.9g", x);
    return out;
}

static void print_worst(const SequenceReport *report, FILE *out)
{
    const SequenceExample *worst = &report->worst;
    char a[BLEND_TEXT], b[BLEND_TEXT];
    fprintf(out, "%s: sequence %llu, %d layers, %s: got %s",
            report->outside ? "farthest outside" : "farthest from correct",
            (unsigned long long)worst->index, worst->layers, blend_channel_name(worst->channel),
            blend_text_bits(report->format, worst->got, a));
    fprintf(out, ",\n  correctly rounded %s (%s apart)",
            blend_text_bits(report->format, worst->rounded, a),
            blend_text_ulp(report->format, worst->ulp, b));
    fprintf(out, ", bound %s to %s\n", bound(report->format, worst->low, a),
            bound(report->format, worst->high, b));
}

void report_blend_sequences(const SequenceReport *report, const char *subject, FILE *out)
{
    char a[SUMMARY_NUMBER], b[SUMMARY_NUMBER], c[SUMMARY_NUMBER], most[BLEND_TEXT];
    fprintf(out, "%s: sequences, %s, under\n%s sequences, %s values\n", subject,
            format_info(report->format)->name, summary_count(report->sequences, a),
            summary_count(report->values, b));
    fprintf(out, "\n  %-26s %13s %13s %12s\n", "arithmetic (= gives all)", "values", "differing",
            "at most");
    for (size_t i = 0; i < report->count; i++) {
        const SequenceCandidate *one = &report->candidates[i];
        if (one->refused)
            continue;
        fprintf(out, "%c %-26s %13s %13s %12s%s\n", one->differing ? ' ' : '=', one->info->name,
                summary_count(one->values, a), summary_count(one->differing, b),
                one->differing ? blend_text_ulp(report->format, one->max_ulp, most) : "",
                arithmetic_is_wrong(one->info, report->format) ? "  wrong" : "");
    }
    fprintf(out,
            "\ninside the bound of any sane arithmetic: %s of %s values; correctly rounded: %s\n",
            summary_count(report->values - report->outside, a), summary_count(report->values, b),
            summary_count(report->rounded, c));
    if (report->has_worst)
        print_worst(report, out);
    size_t best = sequence_report_best(report);
    if (best == SIZE_MAX)
        fprintf(out, "verdict: no named arithmetic, %s the bound\n",
                report->outside ? "and OUTSIDE" : "but inside");
    else
        fprintf(out, "verdict: %s: %s\n", report->candidates[best].info->name,
                arithmetic_is_wrong(report->candidates[best].info, report->format)
                    ? "a WRONG arithmetic"
                    : "a right arithmetic");
}

static void print_vector(const BlendWrong *row, FILE *out)
{
    const EquationInfo *equation = equation_info(row->equation);
    const BlendExample *example = &row->example;
    char a[BLEND_TEXT], b[BLEND_TEXT];
    fprintf(out, "    %-8s %s, %s\n             ", format_info(row->format)->name, equation->name,
            blend_channel_name(example->channel));
    blend_print_operands(&equation->equation, row->format, example, true, out);
    fprintf(out, "\n             gives %s, not %s%s\n",
            blend_text_bits(row->format, example->got, a),
            blend_text_bits(row->format, example->expected, b),
            row->alone ? "" : " as exact, but as another right one");
}

/* One row for each format, of the equation with the simplest vector. */
static void print_simplest(const BlendWrongList *list, const ArithmeticInfo *info, FILE *out)
{
    for (int i = 0; i < ARITHMETIC_FORMATS; i++) {
        int shown, all;
        const BlendWrong *row =
            blend_wrong_simplest(list, info, arithmetic_formats[i], &shown, &all);
        if (row) {
            print_vector(row, out);
            fprintf(out, "             shown by %d of %d equations\n", shown, all);
        } else if (all) {
            fprintf(out, "    %-8s not shown by any of %d equations: right there\n",
                    format_info(arithmetic_formats[i])->name, all);
        }
    }
}

/* "; wrong in rgba16, rgba32f" where it is not wrong in all formats. */
static void print_info(const ArithmeticInfo *info, FILE *out)
{
    fprintf(out, "  %s\n      %s\n", info->name, info->what);
    int count = 0;
    for (int i = 0; i < ARITHMETIC_FORMATS && !info->wrong; i++)
        if (arithmetic_is_wrong(info, arithmetic_formats[i]))
            fprintf(out, "%s%s", count++ ? ", " : "      wrong in ",
                    format_info(arithmetic_formats[i])->name);
    if (count)
        fputc('\n', out);
}

static bool is_listed(const BlendWrongList *list, const ArithmeticInfo *info)
{
    for (size_t i = 0; i < list->count; i++)
        if (list->rows[i].info == info)
            return true;
    return info->wrong;
}

void report_blend_list(const BlendWrongList *list, bool every, FILE *out)
{
    for (int wrong = 0; wrong < 2; wrong++) {
        fputs(wrong ? "\nWrong, with the simplest vector that shows it (least set bits of codes, "
                      "significant\nbits of floats, summed over the operands; its result is none "
                      "of a right arithmetic):\n"
                    : "Right:\n",
              out);
        for (size_t i = 0; i < arithmetic_count(); i++) {
            const ArithmeticInfo *info = arithmetic_info(i);
            if (wrong ? !is_listed(list, info) : info->wrong)
                continue;
            print_info(info, out);
            if (wrong && !every)
                print_simplest(list, info, out);
            for (size_t k = 0; k < list->count && wrong && every; k++)
                if (list->rows[k].info == info && list->rows[k].shown)
                    print_vector(&list->rows[k], out);
        }
    }
}

#include "report/driver.h"

#include "number/numeral.h"
#include "number/op.h"
#include "report/summary.h"

#include <string.h>

/* How far off the worst sample is, with its unit. */
static void print_most(const DriverRule *rule, char out[SUMMARY_NUMBER])
{
    const char *unit =
        rule->value == DRIVER_CODE ? rule->max_distance == 1 ? "code" : "codes" : "ULP";
    if (!rule->differing)
        snprintf(out, SUMMARY_NUMBER, "0");
    else if (rule->value != DRIVER_CODE && rule->max_distance == UINT32_MAX)
        snprintf(out, SUMMARY_NUMBER, "NaN");
    else
        snprintf(out, SUMMARY_NUMBER, rule->max_distance < 10000000 ? "%.0f %s" : "%.1e %s",
                 (double)rule->max_distance, unit);
}

static void print_row(const DriverRule *rule, FILE *out)
{
    char samples[SUMMARY_NUMBER], differing[SUMMARY_NUMBER], most[SUMMARY_NUMBER];
    print_most(rule, most);
    fprintf(out, "%c %-19s %-34s %9s %9s %13s %s\n", rule->relied_on ? '*' : ' ', rule->id,
            rule->what, summary_count(rule->samples, samples),
            summary_count(rule->differing, differing), most, driver_verdict_name(rule->verdict));
}

/* The value as a number, then as its bits say it. */
static void print_value(DriverValue value, uint32_t bits, FILE *out)
{
    if (value == DRIVER_CODE) {
        fprintf(out, "%u", bits);
        return;
    }
    float x = value == DRIVER_HALF ? half_to_float((uint16_t)bits) : op_from_bits(bits);
    char text[NUMERAL_BOTH];
    fputs(numeral_both((double)x, text), out);
}

/* Long lists of inputs break before the right edge. */
static void print_example(const DriverRule *rule, FILE *out)
{
    const DriverExample *example = &rule->example;
    fprintf(out, "\n%s%s%s\n", rule->id, example->place[0] ? ": " : "", example->place);
    int column = 0;
    for (int i = 0; i < example->input_count; i++) {
        char text[128], number[NUMERAL_BOTH];
        int length = snprintf(text, sizeof text, "  %s = %s", example->input_names[i],
                              numeral_both((double)example->inputs[i], number));
        if (column && column + length > 99) {
            fputc('\n', out);
            column = 0;
        }
        fputs(text, out);
        column += length;
    }
    fputs(example->input_count ? "\n  expected " : "  expected ", out);
    print_value(example->value, example->expected, out);
    fputs(", got ", out);
    print_value(example->value, example->got, out);
    fputc('\n', out);
}

static void print_rows(const DriverReport *report, FILE *out)
{
    const char *section = "";
    fprintf(out, "\n  %-19s %-34s %9s %9s %13s\n", "rule (* relied on)", "what", "samples",
            "differing", "at most");
    for (size_t i = 0; i < report->count; i++) {
        const DriverRule *rule = &report->rules[i];
        if (strcmp(section, rule->section) != 0)
            fprintf(out, "%s\n", section = rule->section);
        if (rule->verdict == DRIVER_UNTESTED)
            fprintf(out, "  %-19s %s: %s\n", rule->id, rule->what, rule->reason);
        else
            print_row(rule, out);
    }
}

static void print_names(const DriverReport *report, DriverVerdict verdict, FILE *out)
{
    for (size_t i = 0; i < report->count; i++)
        if (report->rules[i].verdict == verdict)
            fprintf(out, " %s", report->rules[i].id);
    fputc('\n', out);
}

void report_driver_print(const DriverName *name, const DriverReport *report, FILE *out)
{
    fprintf(out, "vendor: %s\nrenderer: %s\nversion: %s, GLSL %s\n", name->vendor, name->renderer,
            name->version, name->glsl);
    fprintf(out, "fixed-function multiply-adds: %s%s\n", name->mode,
            strcmp(name->mode, "neither") == 0
                ? " (not llvmpipe's arithmetic; compared with the fused rules)"
                : "");
    print_rows(report, out);
    if (report->differ + report->broken > 0)
        fprintf(out, "\nSimplest example of each difference:\n");
    for (size_t i = 0; i < report->count; i++)
        if (report->rules[i].has_example)
            print_example(&report->rules[i], out);
    fprintf(out, "\n%d rules exact, %d differ, %d broken, %d not tested\n", report->exact,
            report->differ, report->broken, report->untested);
    if (report->broken) {
        fprintf(out, "BROKEN: peeling relies on");
        print_names(report, DRIVER_BROKEN, out);
    } else if (report->differ) {
        fprintf(out, "DIFFERS, but not where peeling would go wrong\n");
    } else {
        fprintf(out, "EXACT\n");
    }
}

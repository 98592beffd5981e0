#include "report/check.h"

#include "frame/method.h"

#include <string.h>

/* Images less alike than this are not of one scene. */
#define ALIKE 0.5

void report_check_hint(const CheckReport *report, char *text, size_t size)
{
    const CheckStep *last = report->step_count ? &report->steps[report->step_count - 1] : NULL;
    text[0] = 0;
    if (!last || !last->judged || last->agree)
        return;
    const JudgeFigures *figures = &last->figures;
    if (figures->nonfinite == figures->pixels)
        snprintf(text, size, "%s: every pixel is NaN or infinite", last->name);
    else if (figures->nonfinite > 0)
        snprintf(text, size, "%s: %llu pixels are NaN or infinite, the reference's are not",
                 last->name, (unsigned long long)figures->nonfinite);
    else if (figures->correlation < ALIKE)
        snprintf(text, size,
                 "%s hardly resembles the reference (correlation %.2f): another scene, camera, "
                 "time or number of lights?",
                 last->name, figures->correlation);
    else if (report->reading[0] && !report->sure)
        snprintf(text, size,
                 "the encoding or the rows of the image are not certain; --encoding "
                 "and --flip or --no-flip say what they are");
}

static void print_step(const CheckStep *step, FILE *out)
{
    const JudgeFigures *f = &step->figures;
    if (step->judged)
        fprintf(out, "%-16s %-8s %9llu %9llu %9llu %9llu %9llu %10.3g  %s\n", step->name,
                format_info(step->format)->name, (unsigned long long)f->equal,
                (unsigned long long)f->stored, (unsigned long long)f->within,
                (unsigned long long)f->edge, (unsigned long long)f->beyond, f->max_abs,
                step->agree ? f->equal == f->pixels ? "identical" : "agrees" : "DIFFERS");
    else
        fprintf(out, "%-16s %-8s %s\n", step->name, step->agree ? "" : "DIFFERS", step->note);
    if (step->judged && step->note[0])
        fprintf(out, "%-16s   %s\n", "", step->note);
}

static void print_first(const CheckReport *report, FILE *out)
{
    char text[512];
    for (size_t i = 0; i < report->step_count; i++) {
        const CheckStep *step = &report->steps[i];
        if (!step->judged || step->agree || !step->figures.worst.is)
            continue;
        check_describe_worst(step, text, sizeof text);
        fprintf(out, "%s: worst %s\n", step->name, text);
    }
    if (report->first >= 0 && report->step_count > 1)
        fprintf(out, "first step that differs: %s\n", report->steps[report->first].name);
}

void report_check_print(const CheckReport *report, FILE *out)
{
    char hint[256];
    const RenderDesc *desc = &report->desc;
    if (report->theirs)
        fprintf(out, "theirs:    %s%s%s\n", report->theirs, report->reading[0] ? ": " : "",
                report->reading);
    fprintf(out, "reference: ref, %s, %dx%d, %d peels, %s accumulation; tolerance %g%s\n\n",
            method_info(desc->method)->name, desc->width, desc->height, report->frame.peels,
            format_info(desc->accum)->name, report->tolerance, desc->bound ? ", or the bound" : "");
    fprintf(out, "%-16s %-8s %9s %9s %9s %9s %9s %10s\n", "pixels:", "theirs", "equal", "stored",
            "within", "edge", "beyond", "max abs");
    for (size_t i = 0; i < report->step_count; i++)
        print_step(&report->steps[i], out);
    fprintf(out, "\n");
    print_first(report, out);
    report_check_hint(report, hint, sizeof hint);
    if (hint[0])
        fprintf(out, "%s\n", hint);
    fprintf(out, "%s\n", report->agree ? "AGREE" : "DIFFER");
}

#include "frame/method.h"
#include "report/bench.h"
#include "study/bench_stats.h"

#include <math.h>

const char *report_bench_passes(int passes, char text[REPORT_BENCH_PASSES])
{
    if (passes == 0)
        return "auto";
    snprintf(text, REPORT_BENCH_PASSES, "%d", passes);
    return text;
}

static void print_error(double value, FILE *out)
{
    if (isnan(value))
        fprintf(out, " %8s", "-");
    else
        fprintf(out, " %8.2g", value);
}

void report_bench_print(const BenchReport *report, size_t first, FILE *out)
{
    if (first >= report->count)
        return;
    const BenchRow *head = &report->rows[first];
    fprintf(out, "\n%s, %dx%d, %d %s, %d %s\n", report->plan->scenes[head->scene].scene->name,
            head->width, head->height, head->lights, head->lights == 1 ? "light" : "lights",
            head->threads, head->threads == 1 ? "thread" : "threads");
    fprintf(out, "%-16s %-14s %6s %-8s %8s %8s %7s %8s %8s %6s\n", "method", "formats", "passes",
            "renderer", "cpu ms", "wall ms", "spread", "max abs", "rmse", "MiB");
    for (size_t i = first; i < report->count; i++) {
        const BenchRow *row = &report->rows[i];
        char passes[REPORT_BENCH_PASSES];
        fprintf(out, "%-16s %-14s %6s %-8s %8.1f %8.1f %6.0f%%", method_info(row->method)->name,
                report->plan->formats[row->format].name, report_bench_passes(row->passes, passes),
                bench_renderer_name(row->renderer), row->cpu_ms, row->wall_ms, 100.0 * row->spread);
        print_error(row->max_abs, out);
        print_error(row->rmse, out);
        fprintf(out, " %6.0f%s\n", (double)row->peak_bytes / 1048576.0, row->pareto ? " *" : "");
    }
    fflush(out);
}

/* ---- ratios ---------------------------------------------------------------------------------- */

static bool is_first_of_test(const BenchReport *report, size_t index)
{
    if (report->rows[index].renderer != BENCH_REF)
        return false;
    for (size_t i = 0; i < index; i++)
        if (report->rows[i].renderer == BENCH_REF &&
            bench_same_test(&report->rows[i], &report->rows[index]))
            return false;
    return true;
}

/* A row of ref's in this test with this number of passes and lights. */
static const BenchRow *cell_of(const BenchReport *report, const BenchRow *test, int passes,
                               int lights)
{
    BenchRow wanted = *test;
    wanted.passes = passes;
    wanted.lights = lights;
    return bench_partner(report, &wanted, BENCH_REF);
}

static int lit(const BenchReport *report, const BenchRow *test, int index)
{
    int lights = report->plan->lights[index];
    size_t have = report->plan->scenes[test->scene].scene->light_count;
    return lights == 0 ? (int)have : lights < 0 ? 0 : lights;
}

static void print_matrix(const BenchReport *report, const BenchRow *test, int renderer, FILE *out)
{
    const BenchPlan *plan = report->plan;
    BenchRatios ratios = bench_ratios(report, test, renderer);
    fprintf(out, "%s / ref: geometric mean %.2f, least %.2f of %zu\n%8s",
            bench_renderer_name(renderer), ratios.mean, ratios.least, ratios.cells, "passes");
    for (int l = 0; l < plan->light_count; l++)
        fprintf(out, " %7d", lit(report, test, l));
    fprintf(out, " lights\n");
    for (int p = 0; p < plan->pass_count; p++) {
        char passes[REPORT_BENCH_PASSES];
        fprintf(out, "%8s", report_bench_passes(plan->passes[p], passes));
        for (int l = 0; l < plan->light_count; l++) {
            const BenchRow *ref = cell_of(report, test, plan->passes[p], lit(report, test, l));
            const BenchRow *other = ref ? bench_partner(report, ref, renderer) : NULL;
            fprintf(out, " %7.2f", other ? other->cpu_ms / ref->cpu_ms : (double)NAN);
        }
        fprintf(out, "\n");
    }
}

void report_bench_print_ratios(const BenchReport *report, FILE *out)
{
    static const int renderers[] = {BENCH_GL, BENCH_GL_EARLY};
    for (size_t i = 0; i < report->count; i++) {
        const BenchRow *test = &report->rows[i];
        if (!is_first_of_test(report, i))
            continue;
        if (bench_ratios(report, test, BENCH_GL).cells +
                bench_ratios(report, test, BENCH_GL_EARLY).cells ==
            0)
            continue;
        fprintf(out, "\nCPU time, %s, %dx%d, %d %s, %s, %s\n",
                report->plan->scenes[test->scene].scene->name, test->width, test->height,
                test->threads, test->threads == 1 ? "thread" : "threads",
                method_info(test->method)->name, report->plan->formats[test->format].name);
        for (size_t k = 0; k < sizeof renderers / sizeof *renderers; k++)
            if (bench_ratios(report, test, renderers[k]).cells)
                print_matrix(report, test, renderers[k], out);
    }
}

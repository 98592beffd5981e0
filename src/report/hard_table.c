#include "report/hard.h"

#include "report/summary.h"

#include <inttypes.h>
#include <math.h>

void report_hard_add(const HardReport *report, HardTotals *totals)
{
    totals->cases++;
    totals->rows += report->row_count;
    totals->failed += report->failed;
    for (size_t i = 0; i < report->row_count; i++) {
        totals->nonfinite_rows += report->rows[i].nonfinite > 0;
        bool differs = report->rows[i].ref_gl > 0;
        bool apart = report->rows[i].config.expect.gl_apart;
        totals->differing_rows += differs && !apart;
        totals->apart_rows += differs && apart;
    }
}

static void print_row(const HardRow *row, FILE *out)
{
    char most[SUMMARY_NUMBER], rmse[SUMMARY_NUMBER], error[SUMMARY_NUMBER], bound[SUMMARY_NUMBER];
    const LayerStats *layers = &row->layers;
    fprintf(out, "  %-24s", row->config.name);
    if (row->structure)
        fprintf(out, " %6" PRIu64 " %6" PRIu64 " %6" PRIu64 " %6" PRIu64 " %6" PRIu64 " %5" PRIu64,
                layers->lost_to_ties, layers->lost_to_pass_limit, layers->lost_to_overflow,
                layers->repeated, row->inversions, row->sets);
    else
        fprintf(out, " %6s %6s %6s %6s %6s %5s", "-", "-", "-", "-", "-", "-");
    fprintf(out, " %9s %9s %9s %9s %6" PRIu32 " %11" PRIu32 " %4" PRIu64 "  %s\n",
            summary_real(row->max_abs, most), summary_real(row->rmse, rmse),
            summary_real(row->error, error),
            isinf(row->bound) ? "any" : summary_real(row->bound, bound), row->max_ulp_gl,
            row->max_ulp_truth, row->nonfinite, row->pass ? "pass" : row->failure);
}

void report_hard_print(const HardReport *report, FILE *out)
{
    fprintf(out, "%s: %s\n", report->hard->name, report->scene->why);
    fprintf(out, "  %-24s %6s %6s %6s %6s %6s %5s %9s %9s %9s %9s %6s %11s %4s\n", "configuration",
            "ties", "limit", "overfl", "repeat", "invert", "sets", "max abs", "RMSE", "error",
            "bound", "ULP gl", "ULP truth", "NaN");
    for (size_t i = 0; i < report->row_count; i++)
        print_row(&report->rows[i], out);
    fflush(out);
}

void report_hard_print_totals(const HardTotals *totals, FILE *out)
{
    fprintf(out,
            "%zu cases, %zu configurations: %zu missed an expectation, %zu with NaN or infinity, "
            "%zu with a difference between ref and gl (and %zu where it is expected)\n%s\n",
            totals->cases, totals->rows, totals->failed, totals->nonfinite_rows,
            totals->differing_rows, totals->apart_rows, totals->failed ? "MISSED" : "AS EXPECTED");
}

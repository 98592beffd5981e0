#include "report/table.h"

#include "report/summary.h"

#include <string.h>

/* Up to so many buffers have a row each. */
enum {
    UNFOLDED = 96
};

static const char *pair_name(const PairReport *pair, char out[SUMMARY_NUMBER])
{
    snprintf(out, SUMMARY_NUMBER, "%s - %s", threeway_renderer_name(pair->a),
             threeway_renderer_name(pair->b));
    return out;
}

static void print_settings(const Threeway *report, FILE *out)
{
    SummarySetting settings[SUMMARY_SETTINGS];
    int count = summary_settings(report, settings);
    fprintf(out, "%s (%s)\n", report->scene_name, report->scene_path);
    for (int i = 0; i < count; i++) {
        fprintf(out, "%s%s: ", i % 4 ? "; " : "  ", settings[i].name);
        /* The page's multiplication sign has no place in aligned text. */
        if (strcmp(settings[i].name, "Size") == 0)
            fprintf(out, "%dx%d", report->desc.width, report->desc.height);
        else
            fputs(settings[i].value, out);
        if (i % 4 == 3 || i == count - 1)
            fputc('\n', out);
    }
}

static void print_buffers(const PairReport *pair, FILE *out)
{
    char name[SUMMARY_NUMBER], values[SUMMARY_NUMBER], differing[SUMMARY_NUMBER];
    char ulp[SUMMARY_NUMBER], difference[SUMMARY_NUMBER];
    size_t cursor = 0, folded = 0;
    SummaryRow row;
    if (!pair->buffer_count)
        return;
    fprintf(out, "\n%-34s %7s %15s %13s %13s %9s  %s\n", pair_name(pair, name), "buffers", "values",
            "differing", "max ULP", "max abs", "first: x, y, channel");
    while (summary_row(pair, UNFOLDED, &cursor, &row)) {
        fprintf(out, "%-34s %7zu %15s %13s %13s %9s", row.label, row.buffers,
                summary_count(row.values, values), summary_count(row.differing, differing),
                summary_ulp(row.max_ulp, ulp), summary_real(row.max_abs, difference));
        if (row.has_first)
            fprintf(out, "  %d, %d, %d", row.first[0], row.first[1], row.first[2]);
        fputc('\n', out);
        folded += row.buffers > 1 ? row.buffers : 0;
    }
    SummaryTotals totals = summary_totals(pair);
    fprintf(out, "%-34s %7zu %15s %13s\n", "all", totals.buffers,
            summary_count(totals.values, values),
            summary_count(totals.values_differing, differing));
    if (folded)
        fprintf(out,
                "(%zu equal buffers are folded into runs; every buffer that differs is shown)\n",
                folded);
}

static void print_finals(const Threeway *report, FILE *out)
{
    char name[SUMMARY_NUMBER], pixels[SUMMARY_NUMBER], differing[SUMMARY_NUMBER];
    char a[SUMMARY_NUMBER], b[SUMMARY_NUMBER], c[SUMMARY_NUMBER], d[SUMMARY_NUMBER];
    char ulp[SUMMARY_NUMBER], nonfinite[SUMMARY_NUMBER];
    fprintf(out, "\n%-18s %11s %11s %9s %9s %9s %9s %13s %10s\n", "final image", "pixels",
            "differing", "max abs", "mean abs", "RMSE", "PSNR", "max ULP", "not finite");
    for (int i = 0; i < 3; i++) {
        const FinalMetrics *final = &report->pairs[i].final;
        fprintf(out, "%-18s %11s %11s %9s %9s %9s %9s %13s %10s\n",
                pair_name(&report->pairs[i], name), summary_count(final->pixels, pixels),
                summary_count(final->differing, differing), summary_real(final->max_abs, a),
                summary_real(final->mean_abs, b), summary_real(final->rmse, c),
                summary_psnr(final->psnr, d), summary_ulp(final->max_ulp, ulp),
                summary_count(final->nonfinite, nonfinite));
    }
    fprintf(out, "\n%-18s %11s %11s %9s %9s %9s\n", "same structure", "pixels", "max abs",
            "max rel", "p99 rel", "p99.9 rel");
    for (int i = 0; i < 3; i++) {
        const UnaffectedMetrics *unaffected = &report->pairs[i].unaffected;
        if (report->pairs[i].has_unaffected)
            fprintf(out, "%-18s %11s %11s %9s %9s %9s\n", pair_name(&report->pairs[i], name),
                    summary_count(unaffected->pixels, pixels), summary_real(unaffected->max_abs, a),
                    summary_real(unaffected->max_rel, b), summary_real(unaffected->p99_rel, c),
                    summary_real(unaffected->p999_rel, d));
    }
}

static void print_line(void (*summary)(const Threeway *, char *), const Threeway *report, FILE *out)
{
    char line[SUMMARY_LINE];
    summary(report, line);
    if (line[0])
        fprintf(out, "%s\n", line);
}

/* What single precision may do, and what it does. */
static void print_bounds(const Threeway *report, FILE *out)
{
    char name[SUMMARY_NUMBER], pixels[SUMMARY_NUMBER], exceeded[SUMMARY_NUMBER];
    char unbounded[SUMMARY_NUMBER], a[SUMMARY_NUMBER], b[SUMMARY_NUMBER], c[SUMMARY_NUMBER];
    char d[SUMMARY_NUMBER], e[SUMMARY_NUMBER];
    if (!report->pairs[1].has_bound)
        return;
    fprintf(out, "\n%-18s %11s %11s %9s %9s %9s %9s %13s %10s\n", "bound of single", "pixels",
            "exceeded", "max e/b", "median e/b", "p99 e/b", "median", "p99", "unbounded");
    for (int i = 1; i < 3; i++) {
        const BoundMetrics *bound = &report->pairs[i].bound;
        fprintf(out, "%-18s %11s %11s %9s %9s %9s %9s %13s %10s",
                pair_name(&report->pairs[i], name), summary_count(bound->pixels, pixels),
                summary_count(bound->exceeded, exceeded), summary_real(bound->max_ratio, a),
                summary_real(bound->median_ratio, b), summary_real(bound->p99_ratio, c),
                summary_real(bound->median, d), summary_real(bound->p99, e),
                summary_count(bound->unbounded, unbounded));
        if (bound->has_first)
            fprintf(out, "  first exceeded: %d, %d", bound->first[0], bound->first[1]);
        fputc('\n', out);
    }
    fprintf(out, "(truth's own rounding: at most %s in half of these pixels, %s in 99 of 100)\n",
            summary_real(report->pairs[1].bound.rounding_median, a),
            summary_real(report->pairs[1].bound.rounding_p99, b));
}

static void print_layers(const Threeway *report, FILE *out)
{
    SummaryLayer layers[SUMMARY_LAYERS];
    char value[SUMMARY_NUMBER];
    summary_layers(report, layers);
    fprintf(out, "\nlayers\n");
    for (int i = 0; i < SUMMARY_LAYERS; i++)
        fprintf(out, "%15s  %s\n", summary_count(layers[i].value, value), layers[i].text);
    print_line(summary_residual, report, out);
    print_line(summary_overflow, report, out);
}

static void print_times(const Threeway *report, FILE *out)
{
    fprintf(out, "\n%-18s %11s %11s %9s %7s %10s  %s\n", "time", "wall ms", "CPU ms", "threads",
            "peels", "buffer MiB", "made by");
    for (int i = 0; i < RENDERER_COUNT; i++) {
        const Frame *frame = &report->frames[i];
        fprintf(out, "%-18s %11.1f %11.1f %9d %7d %10.1f  %s%s%s\n", threeway_renderer_name(i),
                frame->time_ms, frame->cpu_ms, frame->threads, frame->peels,
                (double)frame->buffer_bytes / 1048576.0, frame->version,
                frame->version[0] && frame->renderer[0] ? ", " : "", frame->renderer);
    }
    fprintf(out, "(" SUMMARY_TIME_NOTE ")\n");
    print_line(summary_speed, report, out);
    print_line(summary_nodes, report, out);
}

void report_table_print(const Threeway *report, FILE *out)
{
    print_settings(report, out);
    for (int i = 0; i < 3; i++)
        print_buffers(&report->pairs[i], out);
    print_finals(report, out);
    print_bounds(report, out);
    print_layers(report, out);
    print_times(report, out);
    fprintf(out, "\n%s\n", report->agree ? "AGREE" : "DIFFER");
    print_line(summary_pair_exact, report, out);
    print_line(summary_pair_truth, report, out);
}

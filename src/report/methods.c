#include "report/table.h"

#include "frame/method.h"
#include "report/summary.h"

void report_methods_head(const Threeway *first, FILE *out)
{
    fprintf(out, "%s (%s), %dx%d\n", first->scene_name, first->scene_path, first->desc.width,
            first->desc.height);
    fprintf(out, "%-17s %-6s %6s %8s %11s %8s %8s %9s %9s %9s %9s %9s %8s\n", "method", "exact",
            "passes", "geometry", "shaded", "ref MiB", "gl MiB", "ref ms", "gl ms", "ref - gl",
            "max abs", "RMSE", "PSNR dB");
}

static double mebibytes(const Frame *frame)
{
    return (double)frame->buffer_bytes / 1048576.0;
}

void report_methods_row(const Threeway *report, FILE *out)
{
    const MethodInfo *method = method_info(report->desc.method);
    const Frame *ref = &report->frames[RENDERER_REF], *gl = &report->frames[RENDERER_GL];
    const FinalMetrics *truth = &report->pairs[1].final;
    SummaryTotals totals = summary_totals(&report->pairs[0]);
    char shaded[SUMMARY_NUMBER], differing[SUMMARY_NUMBER], most[SUMMARY_NUMBER];
    char rmse[SUMMARY_NUMBER];
    fprintf(out, "%-17s %-6s %6d %8d %11s %8.1f %8.1f %9.1f %9.1f %9s %9s %9s %8.1f%s\n",
            method->name, method->exact ? "yes" : "no", ref->peels, gl->geometry_passes,
            summary_count(ref->fragments_shaded, shaded), mebibytes(ref), mebibytes(gl),
            ref->time_ms, gl->time_ms, summary_count(totals.values_differing, differing),
            summary_real(truth->max_abs, most), summary_real(truth->rmse, rmse), truth->psnr,
            report->agree ? "" : "  DIFFER");
    fflush(out);
}

void report_methods_foot(FILE *out)
{
    fprintf(out, SUMMARY_METHODS_NOTE "\n");
}

/* The page of a benchmark. */
#include "base/file.h"
#include "frame/method.h"
#include "report/bench.h"
#include "report/bench_plot.h"
#include "report/html_parts.h"
#include "report/pictures.h"
#include "report/summary.h"
#include "study/bench_stats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

extern const char report_bench_css[];

typedef struct BenchPage {
    const BenchReport *report;
    const char *command;
} BenchPage;

/* Whether a new group of scene, size, lights and threads begins at this row. */
static bool begins_group(const BenchReport *report, size_t index)
{
    if (index == 0)
        return true;
    const BenchRow *a = &report->rows[index - 1], *b = &report->rows[index];
    return a->scene != b->scene || a->width != b->width || a->height != b->height ||
           a->lights != b->lights || a->threads != b->threads;
}

static size_t group_end(const BenchReport *report, size_t first)
{
    size_t end = first + 1;
    while (end < report->count && !begins_group(report, end))
        end++;
    return end;
}

/* Whether rows of a group have at least two errors to draw. */
static bool has_errors(const BenchReport *report, size_t first, size_t end)
{
    const BenchRow *one = NULL;
    for (size_t i = first; i < end; i++) {
        const BenchRow *row = &report->rows[i];
        if (!isfinite(row->rmse) || !(row->rmse > 0.0) || !(row->cpu_ms > 0.0))
            continue;
        if (one && one->rmse != row->rmse)
            return true;
        one = one ? one : row;
    }
    return false;
}

static void group_name(const BenchReport *report, size_t first, char *text, size_t size)
{
    const BenchRow *row = &report->rows[first];
    snprintf(text, size, "%s, %dx%d, %d %s, %d %s", report->plan->scenes[row->scene].scene->name,
             row->width, row->height, row->lights, row->lights == 1 ? "light" : "lights",
             row->threads, row->threads == 1 ? "thread" : "threads");
}

/* ---- plots ----------------------------------------------------------------------------------- */

typedef Result (*Draw)(const BenchReport *report, size_t which, const char *path);

static Result draw_axis(const BenchReport *report, size_t which, const char *path)
{
    return bench_plot_axis(report, (BenchAxis)which, path);
}

static Result draw_errors(const BenchReport *report, size_t first, const char *path)
{
    return bench_plot_errors(report, first, group_end(report, first) - first, path);
}

static Result draw(const BenchReport *report, Draw how, size_t which, const char *dir,
                   const char *name)
{
    char *path = pictures_path(dir, name);
    Result result = path ? how(report, which, path) : RESULT_NO_MEMORY;
    free(path);
    return result;
}

static Result draw_all(const BenchReport *report, const char *dir)
{
    char name[48];
    Result result = RESULT_OK;
    for (int axis = 0; axis < BENCH_AXES && result == RESULT_OK; axis++) {
        snprintf(name, sizeof name, "%s.svg", bench_axis_name((BenchAxis)axis));
        if (bench_axis_varies(report, (BenchAxis)axis))
            result = draw(report, draw_axis, (size_t)axis, dir, name);
    }
    for (size_t i = 0; i < report->count && result == RESULT_OK; i++) {
        snprintf(name, sizeof name, "error-%zu.svg", i);
        if (begins_group(report, i) && has_errors(report, i, group_end(report, i)))
            result = draw(report, draw_errors, i, dir, name);
    }
    return result;
}

static void put_plot(FileWriter *page, const char *file, const char *caption)
{
    file_writer_print(page,
                      "<figure><a href=\"%s\"><img src=\"%s\" width=\"720\" height=\"420\" "
                      "loading=\"lazy\" alt=\"",
                      file, file);
    html_text(page, caption);
    file_writer_print(page, "\"></a><figcaption>");
    html_text(page, caption);
    file_writer_print(page, "</figcaption></figure>\n");
}

static void put_plots(FileWriter *page, const BenchReport *report)
{
    char file[48], group[200], caption[256];
    file_writer_print(page, "<section aria-labelledby=\"plots\">\n<h2 id=\"plots\">Plots</h2>\n"
                            "<div class=\"drawings\">\n");
    for (int axis = 0; axis < BENCH_AXES; axis++) {
        if (!bench_axis_varies(report, (BenchAxis)axis))
            continue;
        snprintf(file, sizeof file, "%s.svg", bench_axis_name((BenchAxis)axis));
        snprintf(caption, sizeof caption,
                 "Time against %s, all else at its first value, and dashed at its last.",
                 bench_axis_name((BenchAxis)axis));
        put_plot(page, file, caption);
    }
    for (size_t i = 0; i < report->count; i++) {
        if (!begins_group(report, i) || !has_errors(report, i, group_end(report, i)))
            continue;
        snprintf(file, sizeof file, "error-%zu.svg", i);
        group_name(report, i, group, sizeof group);
        snprintf(caption, sizeof caption, "Time against error: %s.", group);
        put_plot(page, file, caption);
    }
    file_writer_print(page, "</div>\n</section>\n");
}

/* ---- tables ---------------------------------------------------------------------------------- */

static void put_row(FileWriter *page, const BenchReport *report, const BenchRow *row)
{
    char passes[REPORT_BENCH_PASSES], most[SUMMARY_NUMBER], rmse[SUMMARY_NUMBER];
    html_open_row(page, "", method_info(row->method)->name);
    file_writer_print(page,
                      "<td>%s</td><td>%s</td><td>%s</td><td>%.1f</td><td>%.1f</td>"
                      "<td>%.0f&nbsp;%%</td>",
                      report->plan->formats[row->format].name,
                      report_bench_passes(row->passes, passes), bench_renderer_name(row->renderer),
                      row->cpu_ms, row->wall_ms, 100.0 * row->spread);
    file_writer_print(page, "<td>%s</td><td>%s</td><td>%.0f</td><td class=\"front\">%s</td></tr>\n",
                      isnan(row->max_abs) ? "&ndash;" : summary_real(row->max_abs, most),
                      isnan(row->rmse) ? "&ndash;" : summary_real(row->rmse, rmse),
                      (double)row->peak_bytes / 1048576.0, row->pareto ? "&#10003;" : "");
}

static void put_tables(FileWriter *page, const BenchReport *report)
{
    static const char *const columns[] = {"Method", "Formats", "Passes", "Renderer",
                                          "CPU ms", "Wall ms", "Spread", "Max abs",
                                          "RMSE",   "MiB",     "Front"};
    char name[200];
    file_writer_print(page, "<section aria-labelledby=\"rows\">\n<h2 id=\"rows\">Rows</h2>\n");
    for (size_t i = 0; i < report->count; i++) {
        if (begins_group(report, i)) {
            if (i > 0)
                html_close_table(page);
            group_name(report, i, name, sizeof name);
            file_writer_print(page, "<h3>");
            html_text(page, name);
            file_writer_print(page, "</h3>\n");
            html_open_table(page, "Times and errors", columns, 11);
        }
        put_row(page, report, &report->rows[i]);
    }
    html_close_table(page);
    file_writer_print(page, "</section>\n");
}

static void put_verdict(FileWriter *page, const BenchReport *report)
{
    static const int renderers[] = {BENCH_GL, BENCH_GL_EARLY};
    char line[160];
    html_open_verdict(page, report->differing == 0,
                      report->differing == 0 ? "The renderers' images have the same bits"
                                             : "Images of the renderers differ");
    snprintf(line, sizeof line, "%zu rows, medians of %d frames each, renderers in turn.",
             report->count, report->plan->runs);
    html_item(page, line);
    for (size_t i = 0; i < sizeof renderers / sizeof *renderers; i++) {
        BenchRatios ratios = bench_ratios(report, NULL, renderers[i]);
        if (!ratios.cells)
            continue;
        snprintf(line, sizeof line,
                 "CPU time of %s / ref: geometric mean %.2f, least %.2f of %zu cells.",
                 bench_renderer_name(renderers[i]), ratios.mean, ratios.least, ratios.cells);
        html_item(page, line);
    }
    html_close_verdict(page);
}

static Result put_page(FileWriter *page, const void *what)
{
    const BenchPage *bench = what;
    file_writer_print(page,
                      "<!doctype html>\n<html lang=\"en\">\n<head>\n"
                      "<meta charset=\"utf-8\">\n"
                      "<meta name=\"viewport\" content=\"width=device-width, "
                      "initial-scale=1\">\n<title>Speed against error - Peel</title>\n"
                      "<link rel=\"stylesheet\" href=\"style.css\">\n"
                      "<link rel=\"stylesheet\" href=\"bench.css\">\n</head>\n<body>\n"
                      "<header>\n<p class=\"kicker\">Peel</p>\n<h1>Speed against error</h1>\n");
    html_open_main(page);
    put_verdict(page, bench->report);
    put_plots(page, bench->report);
    put_tables(page, bench->report);
    file_writer_print(
        page, "<section aria-labelledby=\"guide\">\n<h2 id=\"guide\">How to read this</h2>\n<dl>\n"
              "<dt>CPU ms, wall ms</dt><dd>Medians of a frame's time in all threads, and by the "
              "clock. Contexts, uploads, shader compilation and one frame come before.</dd>\n"
              "<dt>Spread</dt><dd>Of CPU time: greatest less least, by the median.</dd>\n"
              "<dt>Max abs, RMSE</dt><dd>The final image against truth's.</dd>\n"
              "<dt>MiB</dt><dd>The renderer's images, lists and uploads.</dd>\n"
              "<dt>Front</dt><dd>No other row of the table is as fast, in CPU time, and as exact, "
              "and better in one of the two.</dd>\n</dl>\n</section>\n");
    html_command(page, bench->command);
    return html_close(page);
}

/* The page comes last, so that it never shows plots that are not there. */
Result report_bench_html(const BenchReport *report, const char *command, const char *dir)
{
    const BenchPage page = {report, command};
    Result result = file_make_directories(dir);
    if (result == RESULT_OK)
        result = draw_all(report, dir);
    char *css = pictures_path(dir, "bench.css");
    if (result == RESULT_OK)
        result =
            css ? file_write(css, report_bench_css, strlen(report_bench_css)) : RESULT_NO_MEMORY;
    free(css);
    return result == RESULT_OK ? html_write(dir, put_page, &page) : result;
}

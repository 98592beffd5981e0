/* The page about all methods on one scene. */
#include "frame/method.h"
#include "report/heatmap.h"
#include "report/html.h"
#include "report/html_parts.h"
#include "report/html_plot.h"
#include "report/html_tables.h"
#include "report/pictures.h"
#include "report/summary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct Methods {
    const Threeway *reports; /* at least one */
    size_t count;
    const char *command;
} Methods;

static const char *name_of(const Threeway *report)
{
    return method_info(report->desc.method)->name;
}

/* ---- head and verdict ------------------------------------------------------------------------ */

static void put_head(FileWriter *page, const Methods *methods)
{
    static const char *const names[] = {"Size", "Lights", "Profile"};
    html_open(page, "All methods", &methods->reports[0]);
    html_setting_line(page, &methods->reports[0], names, sizeof names / sizeof names[0]);
    html_open_main(page);
}

/* Why a method's verdict is what it is. */
static void put_reason(FileWriter *page, const Threeway *report)
{
    SummaryTotals totals = summary_totals(&report->pairs[0]);
    char reason[SUMMARY_LINE], line[SUMMARY_LINE + 32];
    if (totals.values_differing || report->pairs[0].final.differing)
        summary_pair_exact(report, reason);
    else
        summary_pair_truth(report, reason);
    snprintf(line, sizeof line, "%s: %s", name_of(report), reason);
    html_item(page, line);
    if (report->structure.layers.lost_to_overflow) {
        summary_nodes(report, reason);
        snprintf(line, sizeof line, "%s: %s", name_of(report), reason);
        html_item(page, line);
    }
}

static void put_verdict(FileWriter *page, const Methods *methods)
{
    char text[96], line[SUMMARY_LINE], values[SUMMARY_NUMBER];
    size_t differ = 0, equal = 0, exact = 0;
    uint64_t compared = 0;
    for (size_t i = 0; i < methods->count; i++) {
        const PairReport *pair = &methods->reports[i].pairs[0];
        SummaryTotals totals = summary_totals(pair);
        differ += !methods->reports[i].agree;
        equal += !totals.values_differing && !pair->final.differing;
        exact += method_info(methods->reports[i].desc.method)->exact;
        compared += totals.values;
    }
    if (differ)
        snprintf(text, sizeof text, "%zu of %zu methods differ%s", differ, methods->count,
                 differ == 1 ? "s" : "");
    else
        snprintf(text, sizeof text, "All %zu methods agree", methods->count);
    html_open_verdict(page, !differ, text);
    snprintf(line, sizeof line,
             "ref and gl agree bit for bit in %zu of %zu methods; %s values compared.", equal,
             methods->count, summary_count(compared, values));
    html_item(page, line);
    if (exact < methods->count) {
        snprintf(line, sizeof line,
                 "%zu approximate: their distance from truth is shown, and not judged.",
                 methods->count - exact);
        html_item(page, line);
    }
    for (size_t i = 0; i < methods->count; i++)
        if (!methods->reports[i].agree)
            put_reason(page, &methods->reports[i]);
    html_close_verdict(page);
}

/* ---- table ----------------------------------------------------------------------------------- */

typedef enum ColumnKind {
    COLUMN_COUNT,
    COLUMN_MEBIBYTES,
    COLUMN_NODES,
    COLUMN_MILLISECONDS,
    COLUMN_REAL,
    COLUMN_DECIBELS /* the least is the worst; of all others, the greatest */
} ColumnKind;

typedef struct Column {
    const char *group, *head;
    ColumnKind kind;
} Column;

/* In the order of value_of. */
static const Column columns[] = {
    {"Work", "passes", COLUMN_COUNT},
    {"Work", "geometry passes", COLUMN_COUNT},
    {"Work", "fragments shaded", COLUMN_COUNT},
    {"Memory, MiB", "ref", COLUMN_MEBIBYTES},
    {"Memory, MiB", "gl", COLUMN_MEBIBYTES},
    {"Memory, MiB", "nodes,<br>&times; bytes", COLUMN_NODES},
    {"Time, ms", "ref", COLUMN_MILLISECONDS},
    {"Time, ms", "gl", COLUMN_MILLISECONDS},
    {"ref &minus; gl", "differing values", COLUMN_COUNT},
    {"ref &minus; truth", "max abs", COLUMN_REAL},
    {"ref &minus; truth", "RMSE", COLUMN_REAL},
    {"ref &minus; truth", "PSNR, dB", COLUMN_DECIBELS},
    {"ref &minus; truth", "p99", COLUMN_REAL},
    {"Lost or out of range", "sums", COLUMN_COUNT},
    {"Lost or out of range", "ties", COLUMN_COUNT},
    {"Lost or out of range", "pass limit", COLUMN_COUNT},
    {"Lost or out of range", "no room", COLUMN_COUNT},
};

enum {
    COLUMNS = sizeof columns / sizeof columns[0]
};

static double value_of(const Threeway *report, int column)
{
    const Frame *ref = &report->frames[RENDERER_REF], *gl = &report->frames[RENDERER_GL];
    const PairReport *truth = &report->pairs[1];
    const LayerStats *layers = &report->structure.layers;
    const double values[COLUMNS] = {
        (double)ref->peels,
        (double)gl->geometry_passes,
        (double)ref->fragments_shaded,
        (double)ref->buffer_bytes,
        (double)gl->buffer_bytes,
        (double)ref->nodes,
        ref->time_ms,
        gl->time_ms,
        (double)summary_totals(&report->pairs[0]).values_differing,
        truth->final.max_abs,
        truth->final.rmse,
        truth->final.psnr,
        truth->unaffected.p99_rel,
        (double)layers->overflowed,
        (double)layers->lost_to_ties,
        (double)layers->lost_to_pass_limit,
        (double)layers->lost_to_overflow,
    };
    return values[column];
}

/* How bad a value is, to be compared within its column: what is not a number is worst. */
static double badness(double value, ColumnKind kind)
{
    if (isnan(value))
        return INFINITY;
    return kind == COLUMN_DECIBELS ? -value : value;
}

/* Whether no method's value is worse and some method's is better. */
static bool is_worst(const Methods *methods, size_t index, int column)
{
    ColumnKind kind = columns[column].kind;
    double mine = badness(value_of(&methods->reports[index], column), kind);
    bool better = false;
    for (size_t i = 0; i < methods->count; i++) {
        double other = badness(value_of(&methods->reports[i], column), kind);
        if (other > mine)
            return false;
        better |= other < mine;
    }
    return better && kind != COLUMN_NODES;
}

static bool starts_group(int column)
{
    return column == 0 || strcmp(columns[column].group, columns[column - 1].group) != 0;
}

static void put_value(FileWriter *page, const Threeway *report, int column)
{
    double value = value_of(report, column);
    char number[SUMMARY_NUMBER];
    switch (columns[column].kind) {
    case COLUMN_COUNT:
        file_writer_print(page, "%s", summary_count((uint64_t)value, number));
        break;
    case COLUMN_MEBIBYTES:
        file_writer_print(page, "%.1f", value / 1048576.0);
        break;
    case COLUMN_NODES:
        if (report->frames[RENDERER_REF].node_bytes)
            file_writer_print(page, "%s<br>&times; %u", summary_count((uint64_t)value, number),
                              (unsigned)report->frames[RENDERER_REF].node_bytes);
        else
            file_writer_print(page, "&ndash;");
        break;
    case COLUMN_MILLISECONDS:
        file_writer_print(page, "%.1f", value);
        break;
    case COLUMN_REAL:
        file_writer_print(page, "%s", summary_real(value, number));
        break;
    case COLUMN_DECIBELS:
        if (isfinite(value))
            file_writer_print(page, "%.1f", value);
        else
            file_writer_print(page, "%s", summary_psnr(value, number));
        break;
    }
}

static void put_table_head(FileWriter *page)
{
    file_writer_print(page, "<thead>\n<tr><th scope=\"col\" rowspan=\"2\">Method</th>"
                            "<th scope=\"col\" rowspan=\"2\">Exact</th>");
    for (int column = 0, next; column < COLUMNS; column = next) {
        for (next = column + 1; next < COLUMNS && !starts_group(next);)
            next++;
        file_writer_print(page,
                          "<th class=\"group first\" scope=\"colgroup\" colspan=\"%d\">%s</th>",
                          next - column, columns[column].group);
    }
    file_writer_print(page,
                      "<th class=\"first\" scope=\"col\" rowspan=\"2\">Result</th></tr>\n<tr>");
    for (int column = 0; column < COLUMNS; column++)
        file_writer_print(page, "<th%s scope=\"col\">%s</th>",
                          starts_group(column) ? " class=\"first\"" : "", columns[column].head);
    file_writer_print(page, "</tr>\n</thead>\n<tbody>\n");
}

static void put_row(FileWriter *page, const Methods *methods, size_t index)
{
    const Threeway *report = &methods->reports[index];
    const MethodInfo *method = method_info(report->desc.method);
    file_writer_print(page,
                      "<tr%s><th scope=\"row\"><a href=\"%s/index.html\">%s</a></th><td>%s</td>",
                      report->agree ? "" : " class=\"off\"", method->name, method->name,
                      method->exact ? "yes" : "no");
    for (int column = 0; column < COLUMNS; column++) {
        bool first = starts_group(column), worst = is_worst(methods, index, column);
        file_writer_print(page, "<td%s>",
                          first && worst ? " class=\"first worst\""
                          : first        ? " class=\"first\""
                          : worst        ? " class=\"worst\""
                                         : "");
        put_value(page, report, column);
        file_writer_print(page, "</td>");
    }
    file_writer_print(page, "<td class=\"first result\">%s</td></tr>\n",
                      report->agree ? "agrees" : "differs");
}

static void put_table(FileWriter *page, const Methods *methods)
{
    file_writer_print(page, "<section aria-labelledby=\"table\">\n"
                            "<h2 id=\"table\">Cost and error</h2>\n");
    html_open_table(page, "Methods", NULL, 0);
    put_table_head(page);
    for (size_t i = 0; i < methods->count; i++)
        put_row(page, methods, i);
    html_close_table(page);
    file_writer_print(page, "<p class=\"note\">");
    html_text(page, SUMMARY_METHODS_NOTE);
    file_writer_print(
        page, " RMSE: root mean square error; p99: 99th percentile of the difference relative to "
              "max(1, value), where both see the same fragments in the same order. Sums: pixels "
              "with a sum that left its format's range; ties, pass limit, no room: fragments lost "
              "to equal depths, to --passes, to full lists. Bold: the worst of its column.</p>\n"
              "</section>\n");
}

/* ---- plots ----------------------------------------------------------------------------------- */

static void put_plots(FileWriter *page, const Methods *methods)
{
    file_writer_print(page, "<section aria-labelledby=\"speed\">\n"
                            "<h2 id=\"speed\">Speed against error</h2>\n<div class=\"plots\">\n");
    html_plot(page, methods->reports, methods->count, RENDERER_REF);
    html_plot(page, methods->reports, methods->count, RENDERER_GL);
    file_writer_print(page, "</div>\n<p class=\"note\">Left is faster, down is closer to truth. "
                            "Both axes are logarithmic; the two figures have the same errors and "
                            "times of their own.</p>\n</section>\n");
}

/* ---- the methods, one by one ----------------------------------------------------------------- */

static void put_truth(FileWriter *page, const Methods *methods)
{
    const Threeway *report = &methods->reports[0];
    char file[PICTURES_NAME], path[2 * PICTURES_NAME];
    snprintf(path, sizeof path, "%s/%s", name_of(report), pictures_final(RENDERER_TRUTH, file));
    file_writer_print(page, "<article class=\"method\">\n<div>\n<h3>truth</h3>\n"
                            "<p>every fragment, exactly sorted, in double precision</p>\n"
                            "<p class=\"paper\">What every method below is measured against. All "
                            "heat maps have the scale shown here.</p>\n</div>\n");
    html_open_picture(
        page,
        &(HtmlPicture){.shown = path, .width = report->desc.width, .height = report->desc.height});
    file_writer_print(page, "Image of truth: ");
    html_text(page, report->scene_name);
    file_writer_print(page, "\"></a>\n<figcaption>image of truth</figcaption>\n</figure>\n");
    html_scale(page);
    file_writer_print(page, "</article>\n");
}

static void put_figures(FileWriter *page, const Threeway *report)
{
    const FinalMetrics *final = &report->pairs[1].final;
    char rmse[SUMMARY_NUMBER], most[SUMMARY_NUMBER], differing[SUMMARY_NUMBER], line[SUMMARY_LINE];
    file_writer_print(page,
                      "<dl>\n<dt>RMSE</dt><dd>%s</dd>\n<dt>max abs</dt><dd>%s</dd>\n"
                      "<dt>differing</dt><dd>%s pixels</dd>\n<dt>ref</dt><dd>%.1f ms</dd>\n"
                      "<dt>gl</dt><dd>%.1f ms</dd>\n</dl>\n",
                      summary_real(final->rmse, rmse), summary_real(final->max_abs, most),
                      summary_count(final->differing, differing),
                      report->frames[RENDERER_REF].time_ms, report->frames[RENDERER_GL].time_ms);
    void (*const lines[])(const Threeway *, char *) = {summary_residual, summary_overflow,
                                                       summary_nodes};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        lines[i](report, line);
        if (!line[0])
            continue;
        file_writer_print(page, "<p class=\"paper\">");
        html_text(page, line);
        file_writer_print(page, "</p>\n");
    }
}

static void put_method_pictures(FileWriter *page, const Threeway *report)
{
    const char *name = name_of(report);
    const PairReport *pair = &report->pairs[1];
    int block = pictures_block(report);
    char file[PICTURES_NAME], shown[2 * PICTURES_NAME], linked[2 * PICTURES_NAME];
    char rmse[SUMMARY_NUMBER];
    snprintf(shown, sizeof shown, "%s/%s", name, pictures_final(RENDERER_REF, file));
    html_open_picture(page,
                      &(HtmlPicture){shown, NULL, report->desc.width, report->desc.height, true});
    file_writer_print(page,
                      "Image of %s by ref\"></a>\n<figcaption>image of ref</figcaption>\n"
                      "</figure>\n",
                      name);
    snprintf(shown, sizeof shown, "%s/%s", name, pictures_preview(pair, block, file));
    snprintf(linked, sizeof linked, "%s/%s", name, pictures_difference(pair, file));
    html_open_picture(page, &(HtmlPicture){shown, linked, (report->desc.width + block - 1) / block,
                                           (report->desc.height + block - 1) / block, true});
    file_writer_print(page,
                      "Difference of %s from truth, root mean square %s\"></a>\n"
                      "<figcaption>ref &minus; truth</figcaption>\n</figure>\n",
                      name, summary_real(pair->final.rmse, rmse));
}

static void put_method(FileWriter *page, const Threeway *report)
{
    const MethodInfo *method = method_info(report->desc.method);
    file_writer_print(page,
                      "<article class=\"method\" id=\"method-%s\">\n<div>\n<h3>"
                      "<a href=\"%s/index.html\">%s</a> <span>%s</span></h3>\n<p>",
                      method->name, method->name, method->name,
                      method->exact ? "exact" : "approximate");
    html_text(page, method->summary);
    file_writer_print(page, "</p>\n<p class=\"paper\">");
    html_text(page, method->paper);
    file_writer_print(page, "</p>\n");
    put_figures(page, report);
    file_writer_print(page, "</div>\n");
    put_method_pictures(page, report);
    file_writer_print(page, "</article>\n");
}

static void put_methods(FileWriter *page, const Methods *methods)
{
    file_writer_print(page, "<section aria-labelledby=\"methods\">\n"
                            "<h2 id=\"methods\">Method by method</h2>\n");
    html_block_note(page, pictures_block(&methods->reports[0]));
    put_truth(page, methods);
    for (size_t i = 0; i < methods->count; i++)
        put_method(page, &methods->reports[i]);
    file_writer_print(page, "</section>\n");
}

/* ---- the whole ------------------------------------------------------------------------------- */

static Result put_page(FileWriter *page, const void *what)
{
    const Methods *methods = what;
    put_head(page, methods);
    put_verdict(page, methods);
    put_table(page, methods);
    put_plots(page, methods);
    put_methods(page, methods);
    html_settings(page, &methods->reports[0], false);
    html_command(page, methods->command);
    return html_close(page);
}

Result report_html_write_all(const Threeway *reports, size_t count, const char *command,
                             const char *dir)
{
    Result result = file_make_directories(dir);
    if (result == RESULT_OK)
        result = pictures_write_scale(dir);
    if (result == RESULT_OK)
        result = html_write(dir, put_page, &(Methods){reports, count, command});
    return result;
}

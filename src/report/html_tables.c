#include "report/html_tables.h"

#include "report/html_parts.h"
#include "report/summary.h"

#include <string.h>

/* Up to so many buffers have a row each; the page has them all further down. */
enum {
    UNFOLDED = 24
};

static const char *pair_name(const PairReport *pair, char out[SUMMARY_NUMBER])
{
    snprintf(out, SUMMARY_NUMBER, "%s\u00a0\u2212\u00a0%s", threeway_renderer_name(pair->a),
             threeway_renderer_name(pair->b));
    return out;
}

void html_settings(FileWriter *page, const Threeway *report, bool of_method)
{
    SummarySetting settings[SUMMARY_SETTINGS];
    int count = summary_settings(report, settings);
    file_writer_print(page, "<section aria-labelledby=\"settings\">\n"
                            "<h2 id=\"settings\">Settings</h2>\n<dl class=\"settings\">\n");
    for (int i = 0; i < count; i++) {
        if (!of_method &&
            (strcmp(settings[i].name, "Method") == 0 || strcmp(settings[i].name, "Peels") == 0))
            continue;
        file_writer_print(page, "<div><dt>%s</dt><dd>", settings[i].name);
        html_text(page, settings[i].value);
        file_writer_print(page, "</dd></div>\n");
    }
    file_writer_print(page, "</dl>\n</section>\n");
}

static void put_buffer_row(FileWriter *page, const SummaryRow *row)
{
    char values[SUMMARY_NUMBER], differing[SUMMARY_NUMBER], ulp[SUMMARY_NUMBER];
    char difference[SUMMARY_NUMBER];
    html_open_row(page, row->differing ? " class=\"off\"" : "", row->label);
    file_writer_print(page, "<td>%zu</td><td>%s</td><td>%s</td><td>%s</td><td>%s</td><td>",
                      row->buffers, summary_count(row->values, values),
                      summary_count(row->differing, differing), summary_ulp(row->max_ulp, ulp),
                      summary_real(row->max_abs, difference));
    if (row->has_first)
        file_writer_print(page, "x&nbsp;%d, y&nbsp;%d, channel&nbsp;%d", row->first[0],
                          row->first[1], row->first[2]);
    file_writer_print(page, "</td><td>%s</td></tr>\n", row->differing ? "differs" : "equal");
}

static const char *const buffer_columns[] = {"Buffer",  "Buffers", "Values", "Differing",
                                             "Max ULP", "Max abs", "First",  "Result"};

/* What the table above folds, in full, behind a line to open. */
static void put_all_buffers(FileWriter *page, const PairReport *pair)
{
    file_writer_print(page, "<details>\n<summary>All %zu buffers, one row each</summary>\n",
                      pair->buffer_count);
    html_open_table(page, "ref against gl, every buffer", buffer_columns, 8);
    for (size_t i = 0; i < pair->buffer_count; i++) {
        SummaryRow row = summary_row_of(&pair->buffers[i]);
        put_buffer_row(page, &row);
    }
    html_close_table(page);
    file_writer_print(page, "</details>\n");
}

static void put_buffers(FileWriter *page, const Threeway *report)
{
    const PairReport *pair = &report->pairs[0];
    char values[SUMMARY_NUMBER], differing[SUMMARY_NUMBER];
    SummaryTotals totals = summary_totals(pair);
    size_t cursor = 0, rows = 0;
    SummaryRow row;
    file_writer_print(page, "<section aria-labelledby=\"buffers\">\n"
                            "<h2 id=\"buffers\">Buffer by buffer</h2>\n"
                            "<p>Every value that ref and gl store on the way to the image, "
                            "compared by its bits.</p>\n");
    html_open_table(page, "ref against gl", buffer_columns, 8);
    for (; summary_row(pair, UNFOLDED, &cursor, &row); rows++)
        put_buffer_row(page, &row);
    file_writer_print(page,
                      "</tbody>\n<tfoot><tr><th scope=\"row\">all</th><td>%zu</td><td>%s</td>"
                      "<td>%s</td><td></td><td></td><td></td><td>%s</td></tr></tfoot>\n</table>\n"
                      "</div>\n",
                      totals.buffers, summary_count(totals.values, values),
                      summary_count(totals.values_differing, differing),
                      totals.values_differing ? "differs" : "equal");
    if (rows < pair->buffer_count)
        put_all_buffers(page, pair);
    file_writer_print(page, "</section>\n");
}

static void put_final_table(FileWriter *page, const Threeway *report)
{
    static const char *const columns[] = {"Pair", "Pixels", "Differing", "Max abs",   "Mean abs",
                                          "RMSE", "PSNR",   "Max ULP",   "Not finite"};
    char name[SUMMARY_NUMBER], pixels[SUMMARY_NUMBER], differing[SUMMARY_NUMBER];
    char a[SUMMARY_NUMBER], b[SUMMARY_NUMBER], c[SUMMARY_NUMBER], d[SUMMARY_NUMBER];
    char ulp[SUMMARY_NUMBER], nonfinite[SUMMARY_NUMBER];
    html_open_table(page, "Final image, all pixels", columns, 9);
    for (int i = 0; i < 3; i++) {
        const FinalMetrics *final = &report->pairs[i].final;
        html_open_row(page, "", pair_name(&report->pairs[i], name));
        file_writer_print(
            page,
            "<td>%s</td><td>%s</td><td>%s</td><td>%s</td><td>%s</td><td>%s</td>"
            "<td>%s</td><td>%s</td></tr>\n",
            summary_count(final->pixels, pixels), summary_count(final->differing, differing),
            summary_real(final->max_abs, a), summary_real(final->mean_abs, b),
            summary_real(final->rmse, c), summary_psnr(final->psnr, d),
            summary_ulp(final->max_ulp, ulp), summary_count(final->nonfinite, nonfinite));
    }
    html_close_table(page);
}

static void put_unaffected_table(FileWriter *page, const Threeway *report)
{
    static const char *const columns[] = {"Pair", "Pixels", "Max abs", "Max relative",
                                          "99th percentile"};
    char name[SUMMARY_NUMBER], pixels[SUMMARY_NUMBER];
    char a[SUMMARY_NUMBER], b[SUMMARY_NUMBER], c[SUMMARY_NUMBER];
    html_open_table(page, "Final image, pixels with the same structure", columns, 5);
    for (int i = 0; i < 3; i++) {
        const UnaffectedMetrics *unaffected = &report->pairs[i].unaffected;
        if (!report->pairs[i].has_unaffected)
            continue;
        html_open_row(page, "", pair_name(&report->pairs[i], name));
        file_writer_print(
            page, "<td>%s</td><td>%s</td><td>%s</td><td>%s</td></tr>\n",
            summary_count(unaffected->pixels, pixels), summary_real(unaffected->max_abs, a),
            summary_real(unaffected->max_rel, b), summary_real(unaffected->p99_rel, c));
    }
    html_close_table(page);
}

static void put_layers(FileWriter *page, const Threeway *report)
{
    static const char *const columns[] = {"Layers", "Count"};
    SummaryLayer layers[SUMMARY_LAYERS];
    char value[SUMMARY_NUMBER];
    summary_layers(report, layers);
    html_open_table(page, "Layers: ref's fragments, judged by truth", columns, 2);
    for (int i = 0; i < SUMMARY_LAYERS; i++) {
        html_open_row(page, "", layers[i].text);
        file_writer_print(page, "<td>%s</td></tr>\n", summary_count(layers[i].value, value));
    }
    html_close_table(page);
}

static void put_times(FileWriter *page, const Threeway *report)
{
    static const char *const columns[] = {"Renderer", "Wall ms", "CPU ms", "Threads",
                                          "Peels",    "Buffers", "Made by"};
    html_open_table(page, "Times and memory", columns, 7);
    for (int i = 0; i < RENDERER_COUNT; i++) {
        const Frame *frame = &report->frames[i];
        html_open_row(page, "", threeway_renderer_name(i));
        file_writer_print(page,
                          "<td>%.1f</td><td>%.1f</td><td>%d</td><td>%d</td><td>%.1f MiB</td>"
                          "<td class=\"words\">",
                          frame->time_ms, frame->cpu_ms, frame->threads, frame->peels,
                          (double)frame->buffer_bytes / 1048576.0);
        html_text(page, frame->version);
        if (frame->version[0] && frame->renderer[0])
            file_writer_print(page, "<br>");
        html_text(page, frame->renderer);
        file_writer_print(page, "</td></tr>\n");
    }
    html_close_table(page);
    file_writer_print(page, "<p>" SUMMARY_TIME_NOTE "</p>\n");
}

void html_tables(FileWriter *page, const Threeway *report)
{
    put_buffers(page, report);
    file_writer_print(page, "<section aria-labelledby=\"figures\">\n"
                            "<h2 id=\"figures\">Figures</h2>\n");
    put_final_table(page, report);
    put_unaffected_table(page, report);
    put_layers(page, report);
    put_times(page, report);
    file_writer_print(page, "</section>\n");
    html_settings(page, report, true);
}

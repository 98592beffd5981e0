#include "report/html.h"

#include "base/file.h"
#include "frame/method.h"
#include "report/html_budget.h"
#include "report/html_parts.h"
#include "report/html_tables.h"
#include "report/pictures.h"
#include "report/summary.h"

#include <stdlib.h>

/* ---- head and verdict ------------------------------------------------------------------------ */

typedef struct Comparison {
    const Threeway *report;
    const char *command;
    bool one_of_several; /* the page of all methods is one folder above */
} Comparison;

static void put_head(FileWriter *page, const Comparison *comparison)
{
    static const char *const names[] = {"Size", "Method", "Peels", "Lights", "Profile"};
    const MethodInfo *method = method_info(comparison->report->desc.method);
    html_open(page, "Peel comparison", comparison->report);
    html_setting_line(page, comparison->report, names, sizeof names / sizeof names[0]);
    file_writer_print(page, "<p class=\"path\">%s: ", method->name);
    html_text(page, method->summary);
    file_writer_print(page, ". Source: ");
    html_text(page, method->paper);
    file_writer_print(page, "</p>\n");
    if (comparison->one_of_several)
        file_writer_print(page, "<p class=\"path\"><a href=\"../index.html\">All methods on this "
                                "scene</a></p>\n");
    html_open_main(page);
}

static void put_verdict(FileWriter *page, const Threeway *report)
{
    void (*const lines[])(const Threeway *, char *) = {summary_pair_exact, summary_pair_truth,
                                                       summary_residual,   summary_overflow,
                                                       summary_nodes,      summary_speed};
    char line[SUMMARY_LINE];
    html_open_verdict(page, report->agree,
                      !report->agree                    ? "The renderers differ"
                      : method_is_judged(&report->desc) ? "The three renderers agree"
                                                        : "ref and gl agree");
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        lines[i](report, line);
        html_item(page, line);
    }
    html_close_verdict(page);
}

/* ---- pictures -------------------------------------------------------------------------------- */

static void put_finals(FileWriter *page, const Threeway *report)
{
    static const char *const roles[RENDERER_COUNT] = {
        "the pipeline in C, bit for bit",
        "the same pipeline in OpenGL",
        "every fragment, exactly sorted, in double precision",
    };
    char name[PICTURES_NAME];
    file_writer_print(page, "<section aria-labelledby=\"images\">\n"
                            "<h2 id=\"images\">Final images</h2>\n<div class=\"three\">\n");
    for (int i = 0; i < RENDERER_COUNT; i++) {
        const Frame *frame = &report->frames[i];
        html_open_picture(page, &(HtmlPicture){.shown = pictures_final(i, name),
                                               .width = frame->display.width,
                                               .height = frame->display.height});
        file_writer_print(page, "Final image of %s: ", threeway_renderer_name(i));
        html_text(page, report->scene_name);
        file_writer_print(page,
                          "\"></a>\n<figcaption><strong>%s</strong> %s<br>%.0f ms wall, %.0f ms "
                          "CPU, %d thread%s</figcaption>\n</figure>\n",
                          threeway_renderer_name(i), roles[i], frame->time_ms, frame->cpu_ms,
                          frame->threads, frame->threads == 1 ? "" : "s");
    }
    file_writer_print(page, "</div>\n</section>\n");
}

static void put_differences(FileWriter *page, const Threeway *report)
{
    char name[PICTURES_NAME], small[PICTURES_NAME];
    char differing[SUMMARY_NUMBER], greatest[SUMMARY_NUMBER];
    const Image *image = &report->frames[RENDERER_REF].final;
    int block = pictures_block(report);
    char rmse[SUMMARY_NUMBER];
    file_writer_print(page, "<section aria-labelledby=\"differences\">\n"
                            "<h2 id=\"differences\">Where they differ</h2>\n");
    html_scale(page);
    html_block_note(page, block);
    file_writer_print(page, "<div class=\"three\">\n");
    for (int i = 0; i < 3; i++) {
        const PairReport *pair = &report->pairs[i];
        const char *a = threeway_renderer_name(pair->a), *b = threeway_renderer_name(pair->b);
        const FinalMetrics *metrics = &pair->final;
        summary_count(metrics->differing, differing);
        summary_real(metrics->max_abs, greatest);
        html_open_picture(page, &(HtmlPicture){.shown = pictures_preview(pair, block, small),
                                               .linked = pictures_difference(pair, name),
                                               .width = (image->width + block - 1) / block,
                                               .height = (image->height + block - 1) / block});
        file_writer_print(page, "Difference of %s and %s: %s pixels differ, at most by %s", a, b,
                          differing, greatest);
        file_writer_print(page, "\"></a>\n<figcaption><strong>%s &minus; %s</strong> ", a, b);
        if (metrics->differing)
            file_writer_print(page, "%s pixels differ (%.2f&nbsp;%%), at most by %s; RMSE %s",
                              differing,
                              100.0 * (double)metrics->differing / (double)metrics->pixels,
                              greatest, summary_real(metrics->rmse, rmse));
        else
            file_writer_print(page, "equal, bit for bit");
        file_writer_print(page, "</figcaption>\n</figure>\n");
    }
    file_writer_print(page, "</div>\n</section>\n");
}

static void put_peel(FileWriter *page, const PeelPicture *peel)
{
    char name[PICTURES_NAME], pixels[SUMMARY_NUMBER];
    file_writer_print(page,
                      "<li class=\"peel\">\n<h3>Peel %d <span>peel.%d, %s pixels</span></h3>\n",
                      peel->peel + 1, peel->peel, summary_count(peel->pixels, pixels));
    html_open_picture(page, &(HtmlPicture){pictures_added(peel, name), NULL, peel->added.width,
                                           peel->added.height, true});
    file_writer_print(page,
                      "Light that peel %d adds\"></a>\n<figcaption>adds</figcaption>\n</figure>\n",
                      peel->peel + 1);
    html_open_picture(page, &(HtmlPicture){pictures_accum(peel, name), NULL, peel->accum.width,
                                           peel->accum.height, true});
    file_writer_print(page,
                      "Image accumulated after peel %d\"></a>\n<figcaption>so far</figcaption>\n"
                      "</figure>\n</li>\n",
                      peel->peel + 1);
}

static void put_peels(FileWriter *page, const Threeway *report)
{
    int peels = report->frames[RENDERER_REF].peels;
    if (peels && !report->peel_count) /* the method has no image after each */
        return;
    file_writer_print(page, "<section aria-labelledby=\"peels\">\n<h2 id=\"peels\">Peel by "
                            "peel</h2>\n");
    if (!report->peel_count)
        file_writer_print(page, "<p>Nothing transparent is in view: no peel has a fragment.</p>\n");
    else
        file_writer_print(page,
                          "<p>Front to back, as ref draws them: what each layer adds (a "
                          "checkerboard where it has no fragment), and the image so far, before "
                          "the opaque surfaces behind. Shown: %zu of %d.</p>\n",
                          report->peel_count, peels);
    if (report->peel_count) {
        file_writer_print(page, "<ol class=\"peels\">\n");
        for (size_t i = 0; i < report->peel_count; i++)
            put_peel(page, &report->peels[i]);
        file_writer_print(page, "</ol>\n");
    }
    file_writer_print(page, "</section>\n");
}

/* ---- the rest -------------------------------------------------------------------------------- */

static void put_guide(FileWriter *page, const Threeway *report)
{
    file_writer_print(
        page,
        "<section aria-labelledby=\"guide\">\n<h2 id=\"guide\">How to read this</h2>\n<dl>\n"
        "<dt>ref</dt><dd>The method computed in plain C, meant to store exactly the bits that the "
        "OpenGL pipeline stores.</dd>\n"
        "<dt>gl</dt><dd>The same pipeline in OpenGL. Any differing bit between ref and gl is a "
        "fault of one of the two.</dd>\n"
        "<dt>truth</dt><dd>Every fragment, sorted by exact depth, shaded and composited in double "
        "precision, with code of its own. Small differences from it are the price of single "
        "precision; large ones point to fragments in another order.</dd>\n"
        "<dt>Same structure</dt><dd>Pixels in which ref and truth have the same fragments in the "
        "same order. Only these are judged against the tolerance; the difference is relative to "
        "max(1, value).</dd>\n"
        "<dt>ULP</dt><dd>Steps between neighbouring values of the stored format.</dd>\n"
        "<dt>Verdict</dt><dd>Agree: ref and gl have no differing bit in any buffer%s.</dd>\n</dl>\n"
        "</section>\n",
        method_is_judged(&report->desc)
            ? ", and ref and truth agree at the 99th percentile within the tolerance"
            : "; the method's image is not the truth's, so its distance from it is not judged");
}

static Result put_page(FileWriter *page, const void *what)
{
    const Comparison *comparison = what;
    const Threeway *report = comparison->report;
    put_head(page, comparison);
    put_verdict(page, report);
    put_finals(page, report);
    put_differences(page, report);
    html_budget(page, report->budget);
    put_peels(page, report);
    html_tables(page, report);
    html_command(page, comparison->command);
    put_guide(page, report);
    return html_close(page);
}

/* The page comes last, so that it never shows pictures that are not there. */
static Result write_comparison(const Comparison *comparison, const char *dir)
{
    Result result = file_make_directories(dir);
    if (result == RESULT_OK)
        result = pictures_write(comparison->report, dir);
    if (result == RESULT_OK)
        result = html_budget_picture(comparison->report->budget, dir);
    if (result == RESULT_OK)
        result = html_write(dir, put_page, comparison);
    if (result == RESULT_OK)
        result = pictures_remove_stale(comparison->report, dir);
    return result;
}

Result report_html_write(const Threeway *report, const char *command, const char *dir)
{
    return write_comparison(&(Comparison){report, command, false}, dir);
}

Result report_html_write_method(const Threeway *report, const char *command, const char *dir)
{
    char *below = pictures_path(dir, method_info(report->desc.method)->name);
    Result result =
        below ? write_comparison(&(Comparison){report, command, true}, below) : RESULT_NO_MEMORY;
    free(below);
    return result;
}

#include "report/html.h"

#include "base/file.h"
#include "report/heatmap.h"
#include "report/html_tables.h"
#include "report/pictures.h"
#include "report/summary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

extern const char report_style_css[];

/* ---- head and verdict ------------------------------------------------------------------------ */

/* The settings that one looks for first. */
static void put_summary(FileWriter *page, const Threeway *report)
{
    static const char *const names[] = {"Size", "Method", "Peels", "Lights", "Profile"};
    SummarySetting settings[SUMMARY_SETTINGS];
    int count = summary_settings(report, settings);
    const char *separator = "";
    for (size_t n = 0; n < sizeof names / sizeof names[0]; n++)
        for (int i = 0; i < count; i++) {
            if (strcmp(settings[i].name, names[n]) != 0)
                continue;
            file_writer_print(page, "%s%s&nbsp;", separator, settings[i].name);
            html_text(page, settings[i].value);
            separator = " &middot; ";
        }
}

static void put_head(FileWriter *page, const Threeway *report)
{
    file_writer_print(page, "<!doctype html>\n<html lang=\"en\">\n<head>\n"
                            "<meta charset=\"utf-8\">\n"
                            "<meta name=\"viewport\" content=\"width=device-width, "
                            "initial-scale=1\">\n<title>");
    html_text(page, report->scene_name);
    file_writer_print(page, " - Peel comparison</title>\n"
                            "<link rel=\"stylesheet\" href=\"style.css\">\n</head>\n<body>\n"
                            "<header>\n<p class=\"kicker\">Peel comparison</p>\n<h1>");
    html_text(page, report->scene_name);
    file_writer_print(page, "</h1>\n<p class=\"path\">");
    html_text(page, report->scene_path);
    file_writer_print(page, "</p>\n<p class=\"path\">");
    put_summary(page, report);
    file_writer_print(page, "</p>\n</header>\n<main>\n");
}

static void put_verdict(FileWriter *page, const Threeway *report)
{
    char line[SUMMARY_LINE];
    file_writer_print(page,
                      "<section class=\"verdict %s\" aria-labelledby=\"verdict\">\n"
                      "<h2 id=\"verdict\"><span class=\"sign\" aria-hidden=\"true\">%s</span>"
                      " %s</h2>\n<ul>\n",
                      report->agree ? "agree" : "differ", report->agree ? "&#10003;" : "&#10007;",
                      report->agree ? "The three renderers agree" : "The renderers differ");
    void (*const lines[])(const Threeway *, char *) = {summary_pair_exact, summary_pair_truth,
                                                       summary_residual, summary_speed};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        lines[i](report, line);
        if (!line[0])
            continue;
        file_writer_print(page, "<li>");
        html_text(page, line);
        file_writer_print(page, "</li>\n");
    }
    file_writer_print(page, "</ul>\n</section>\n");
}

/* ---- pictures -------------------------------------------------------------------------------- */

typedef struct Picture {
    const char *shown, *linked; /* file names; linked NULL: the same */
    int width, height;
    bool lazy;
} Picture;

/* Opens a figure with a linked picture; the caller goes on with the text for alt. */
static void put_picture(FileWriter *page, const Picture *picture)
{
    file_writer_print(page,
                      "<figure>\n<a href=\"%s\"><img src=\"%s\" width=\"%d\" height=\"%d\"%s "
                      "alt=\"",
                      picture->linked ? picture->linked : picture->shown, picture->shown,
                      picture->width, picture->height, picture->lazy ? " loading=\"lazy\"" : "");
}

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
        put_picture(page, &(Picture){.shown = pictures_final(i, name),
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

static void put_scale(FileWriter *page)
{
    int low = (int)lround(log10(HEATMAP_LOW)), high = (int)lround(log10(HEATMAP_HIGH));
    file_writer_print(page,
                      "<div class=\"scale\">\n<img src=\"" PICTURES_SCALE
                      "\" width=\"512\" height=\"16\" alt=\"Colour scale from dark blue at "
                      "1e%d to pale yellow at 1e%d, logarithmic\">\n<ol>\n",
                      low, high);
    for (int power = low; power <= high; power++)
        if (power == 0)
            file_writer_print(page, "<li><span>1</span></li>\n");
        else
            file_writer_print(page, "<li><span>10<sup>%s%d</sup></span></li>\n",
                              power < 0 ? "&minus;" : "", abs(power));
    file_writer_print(page,
                      "</ol>\n<p>Greatest absolute difference of a pixel's channels, linear "
                      "values, logarithmic scale. <span class=\"key equal\"></span> black: equal. "
                      "<span class=\"key nonfinite\"></span> magenta: not a finite number.</p>\n"
                      "</div>\n");
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
    put_scale(page);
    if (block > 1)
        file_writer_print(page,
                          "<p>Each point shown is the greatest difference of %d &times; %d pixels; "
                          "the pictures link to the full size.</p>\n",
                          block, block);
    file_writer_print(page, "<div class=\"three\">\n");
    for (int i = 0; i < 3; i++) {
        const PairReport *pair = &report->pairs[i];
        const char *a = threeway_renderer_name(pair->a), *b = threeway_renderer_name(pair->b);
        const FinalMetrics *metrics = &pair->final;
        summary_count(metrics->differing, differing);
        summary_real(metrics->max_abs, greatest);
        put_picture(page, &(Picture){.shown = pictures_preview(pair, block, small),
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
    put_picture(page, &(Picture){pictures_added(peel, name), NULL, peel->added.width,
                                 peel->added.height, true});
    file_writer_print(page,
                      "Light that peel %d adds\"></a>\n<figcaption>adds</figcaption>\n</figure>\n",
                      peel->peel + 1);
    put_picture(page, &(Picture){pictures_accum(peel, name), NULL, peel->accum.width,
                                 peel->accum.height, true});
    file_writer_print(page,
                      "Image accumulated after peel %d\"></a>\n<figcaption>so far</figcaption>\n"
                      "</figure>\n</li>\n",
                      peel->peel + 1);
}

static void put_peels(FileWriter *page, const Threeway *report)
{
    int peels = report->frames[RENDERER_REF].peels;
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

static void put_command(FileWriter *page, const char *command)
{
    file_writer_print(page, "<section aria-labelledby=\"again\">\n<h2 id=\"again\">Make this "
                            "report again</h2>\n<pre><code>");
    html_text(page, command);
    file_writer_print(page, "</code></pre>\n</section>\n");
}

static void put_guide(FileWriter *page)
{
    file_writer_print(
        page,
        "<section aria-labelledby=\"guide\">\n<h2 id=\"guide\">How to read this</h2>\n<dl>\n"
        "<dt>ref</dt><dd>Deferred depth peeling computed in plain C, meant to store exactly the "
        "bits that the OpenGL pipeline stores.</dd>\n"
        "<dt>gl</dt><dd>The same pipeline in OpenGL. Any differing bit between ref and gl is a "
        "fault of one of the two.</dd>\n"
        "<dt>truth</dt><dd>Every fragment, sorted by exact depth, shaded and composited in double "
        "precision, with code of its own. Small differences from it are the price of single "
        "precision; large ones point to fragments in another order.</dd>\n"
        "<dt>Same structure</dt><dd>Pixels in which ref and truth have the same fragments in the "
        "same order. Only these are judged against the tolerance; the difference is relative to "
        "max(1, value).</dd>\n"
        "<dt>ULP</dt><dd>Steps between neighbouring values of the stored format.</dd>\n"
        "<dt>Verdict</dt><dd>Agree: ref and gl have no differing bit in any buffer, and ref and "
        "truth agree at the 99th percentile within the tolerance.</dd>\n</dl>\n</section>\n");
}

static Result put_page(const Threeway *report, const char *command, FileWriter *page)
{
    put_head(page, report);
    put_verdict(page, report);
    put_finals(page, report);
    put_differences(page, report);
    put_peels(page, report);
    html_tables(page, report);
    put_command(page, command);
    put_guide(page);
    return file_writer_print(page, "</main>\n</body>\n</html>\n");
}

static Result write_page(const Threeway *report, const char *command, const char *path)
{
    FileWriter page;
    Result result = file_writer_open(path, &page);
    if (result != RESULT_OK)
        return result;
    result = put_page(report, command, &page);
    Result closed = file_writer_close(&page, result == RESULT_OK);
    return result == RESULT_OK ? closed : result;
}

/* The page comes last, so that it never shows pictures that are not there. */
Result report_html_write(const Threeway *report, const char *command, const char *dir)
{
    Result result = file_make_directories(dir);
    if (result == RESULT_OK)
        result = pictures_write(report, dir);
    if (result != RESULT_OK)
        return result;
    char *style = pictures_path(dir, "style.css"), *page = pictures_path(dir, "index.html");
    result = style && page ? file_write(style, report_style_css, strlen(report_style_css))
                           : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = write_page(report, command, page);
    if (result == RESULT_OK)
        result = pictures_remove_stale(report, dir);
    free(style);
    free(page);
    return result;
}

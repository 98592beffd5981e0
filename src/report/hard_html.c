/* The page of the hard cases. */
#include "base/file.h"
#include "image/png.h"
#include "report/hard.h"
#include "report/heatmap.h"
#include "report/html_parts.h"
#include "report/pictures.h"
#include "report/summary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

extern const char report_style_css[];
extern const char report_hard_css[];

enum {
    SHOWN = 288 /* pixels that a picture is wide on the page, at least */
};

/* ---- pictures -------------------------------------------------------------------------------- */

typedef enum HardPicture {
    HARD_REF,
    HARD_TRUTH,
    HARD_ERROR,
    HARD_PICTURES
} HardPicture;

static const char *const picture_names[HARD_PICTURES] = {"ref", "truth", "error"};

/* Each pixel as a square of whole pixels, so that browsers need not smooth. */
static Result enlarge(const Image *image, int factor, Image *out)
{
    Result result = image_create(image->width * factor, image->height * factor, FORMAT_RGBA8, out);
    for (int y = 0; result == RESULT_OK && y < out->height; y++)
        for (int x = 0; x < out->width; x++)
            memcpy(image_pixel(out, x, y), image_pixel(image, x / factor, y / factor), 4);
    return result;
}

static Result write_enlarged(const Image *image, const char *path)
{
    Image large = {0};
    Result result = enlarge(image, (SHOWN + image->width - 1) / image->width, &large);
    if (result == RESULT_OK)
        result = png_write(&large, path);
    image_free(&large);
    return result;
}

static Result write_picture(const HardReport *report, HardPicture picture, const char *dir)
{
    char name[96];
    Image error = {0};
    const Image *image = &report->displays[picture == HARD_TRUTH];
    snprintf(name, sizeof name, "%s-%s.png", report->hard->name, picture_names[picture]);
    char *path = pictures_path(dir, name);
    Result result = path ? RESULT_OK : RESULT_NO_MEMORY;
    if (result == RESULT_OK && picture == HARD_ERROR) {
        result = heatmap_image(&report->finals[0], &report->truth, &error);
        image = &error;
    }
    if (result == RESULT_OK)
        result = write_enlarged(image, path);
    image_free(&error);
    free(path);
    return result;
}

static Result write_pictures(const HardReport *report, const char *dir)
{
    Result result = RESULT_OK;
    for (int i = 0; i < HARD_PICTURES && result == RESULT_OK; i++)
        result = write_picture(report, (HardPicture)i, dir);
    return result;
}

/* ---- text ------------------------------------------------------------------------------------ */

static void put_head(FileWriter *page, const HardTotals *totals)
{
    file_writer_print(page, "<!doctype html>\n<html lang=\"en\">\n<head>\n"
                            "<meta charset=\"utf-8\">\n"
                            "<meta name=\"viewport\" content=\"width=device-width, "
                            "initial-scale=1\">\n<title>Hard cases - Peel</title>\n"
                            "<link rel=\"stylesheet\" href=\"style.css\">\n"
                            "<link rel=\"stylesheet\" href=\"hard.css\">\n</head>\n<body>\n"
                            "<header>\n<p class=\"kicker\">Peel</p>\n<h1>Hard cases</h1>\n"
                            "</header>\n<main>\n");
    file_writer_print(page,
                      "<section class=\"verdict %s\" aria-labelledby=\"verdict\">\n"
                      "<h2 id=\"verdict\"><span class=\"sign\" aria-hidden=\"true\">%s</span> %s"
                      "</h2>\n<ul>\n<li>%zu cases in %zu configurations; %zu missed an expectation."
                      "</li>\n<li>%zu stored or showed a NaN or an infinity.</li>\n"
                      "<li>In %zu ref and gl stored different bits, and in %zu where their notes "
                      "say why.</li>\n</ul>\n</section>\n",
                      totals->failed ? "differ" : "agree", totals->failed ? "&#10007;" : "&#10003;",
                      totals->failed ? "Expectations were missed" : "Every expectation holds",
                      totals->cases, totals->rows, totals->failed, totals->nonfinite_rows,
                      totals->differing_rows, totals->apart_rows);
}

static void put_contents(FileWriter *page, const HardReport *reports, size_t count)
{
    file_writer_print(page, "<nav aria-label=\"Cases\">\n<ul class=\"cases\">\n");
    for (size_t i = 0; i < count; i++)
        file_writer_print(page,
                          "<li><a href=\"#%s\"><img src=\"%s-ref.png\" width=\"96\" "
                          "height=\"96\" loading=\"lazy\" alt=\"\">%s</a>%s</li>\n",
                          reports[i].hard->name, reports[i].hard->name, reports[i].hard->name,
                          reports[i].failed ? " <strong>missed</strong>" : "");
    file_writer_print(page, "</ul>\n</nav>\n");
}

static void put_pictures(FileWriter *page, const HardReport *report)
{
    static const char *const captions[HARD_PICTURES] = {
        "the pipeline", "every fragment, exactly sorted",
        "difference; black where equal, brighter by powers of ten to 1"};
    file_writer_print(page, "<div class=\"three\">\n");
    for (int i = 0; i < HARD_PICTURES; i++) {
        file_writer_print(page,
                          "<figure><img src=\"%s-%s.png\" width=\"%d\" height=\"%d\" "
                          "loading=\"lazy\" alt=\"%s: %s\"><figcaption><strong>%s</strong> %s"
                          "</figcaption></figure>\n",
                          report->hard->name, picture_names[i], SHOWN, SHOWN, report->hard->name,
                          picture_names[i], picture_names[i], captions[i]);
    }
    file_writer_print(page, "</div>\n");
}

static void put_counts(FileWriter *page, const HardRow *row)
{
    const uint64_t counts[] = {row->layers.lost_to_ties,
                               row->layers.lost_to_pass_limit,
                               row->layers.lost_to_overflow,
                               row->layers.repeated,
                               row->inversions,
                               row->sets};
    char number[SUMMARY_NUMBER];
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        file_writer_print(page, "<td>%s</td>",
                          row->structure ? summary_count(counts[i], number) : "&ndash;");
}

static void put_row(FileWriter *page, const HardRow *row)
{
    char most[SUMMARY_NUMBER], rmse[SUMMARY_NUMBER], error[SUMMARY_NUMBER], bound[SUMMARY_NUMBER];
    char ulp_gl[SUMMARY_NUMBER], ulp[SUMMARY_NUMBER], nonfinite[SUMMARY_NUMBER];
    file_writer_print(page, "<tr%s><th scope=\"row\">", row->pass ? "" : " class=\"off\"");
    html_text(page, row->config.name);
    file_writer_print(page, "</th>");
    put_counts(page, row);
    file_writer_print(page,
                      "<td>%s</td><td>%s</td><td>%s</td><td>%s</td><td>%s</td><td>%s</td>"
                      "<td>%s</td><td class=\"words\">",
                      summary_real(row->max_abs, most), summary_real(row->rmse, rmse),
                      summary_real(row->error, error),
                      isinf(row->bound) ? "any" : summary_real(row->bound, bound),
                      summary_ulp(row->max_ulp_gl, ulp_gl), summary_ulp(row->max_ulp_truth, ulp),
                      summary_count(row->nonfinite, nonfinite));
    html_text(page, row->pass ? "pass" : row->failure);
    if (row->config.note) {
        file_writer_print(page, ". ");
        html_text(page, row->config.note);
    }
    file_writer_print(page, "</td></tr>\n");
}

static void put_table(FileWriter *page, const HardReport *report)
{
    static const char *const columns[] = {"Configuration", "Ties",     "Pass limit", "Overflow",
                                          "Repeated",      "Inverted", "One side",   "Max abs",
                                          "RMSE",          "Error",    "Allowed",    "ULP, gl",
                                          "ULP, truth",    "NaN",      "Verdict"};
    file_writer_print(page,
                      "<div class=\"table hard\" tabindex=\"0\" role=\"region\" "
                      "aria-label=\"%s\">\n<table>\n<thead><tr>",
                      report->hard->name);
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++)
        file_writer_print(page, "<th scope=\"col\">%s</th>", columns[i]);
    file_writer_print(page, "</tr></thead>\n<tbody>\n");
    for (size_t i = 0; i < report->row_count; i++)
        put_row(page, &report->rows[i]);
    file_writer_print(page, "</tbody>\n</table>\n</div>\n");
}

static void put_case(FileWriter *page, const HardReport *report)
{
    const struct {
        const char *term, *text;
    } texts[] = {{"Why it is hard", report->scene->why},
                 {"Source", report->scene->source},
                 {"What ought to happen", report->hard->ought}};
    file_writer_print(page,
                      "<section aria-labelledby=\"%s\">\n<h2 id=\"%s\">%s</h2>\n"
                      "<dl class=\"facts\">\n",
                      report->hard->name, report->hard->name, report->hard->name);
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        file_writer_print(page, "<dt>%s</dt><dd>", texts[i].term);
        html_text(page, texts[i].text);
        file_writer_print(page, "</dd>\n");
    }
    file_writer_print(page, "</dl>\n");
    put_pictures(page, report);
    put_table(page, report);
    file_writer_print(page, "</section>\n");
}

static void put_guide(FileWriter *page, const char *command)
{
    file_writer_print(
        page,
        "<section aria-labelledby=\"guide\">\n<h2 id=\"guide\">How to read this</h2>\n<dl>\n"
        "<dt>Ties, pass limit, overflow</dt><dd>Layers lost: of equal depth to one that was "
        "peeled; left when the passes ended; without room in a list.</dd>\n"
        "<dt>Repeated, inverted, one side</dt><dd>Layers peeled twice; neighbours in the other "
        "order than truth's; fragments that only ref or only truth has, for other reasons. A dash: "
        "the method has no layers to count.</dd>\n"
        "<dt>Max abs, RMSE</dt><dd>ref against truth, all pixels.</dd>\n"
        "<dt>Error, allowed</dt><dd>ref against truth, relative to max(1, value), in pixels where "
        "both have the same fragments in the same order; what method and formats may add.</dd>\n"
        "<dt>ULP</dt><dd>Greatest distance in representable values: of ref and gl in all buffers, "
        "of ref and truth in the image.</dd>\n"
        "<dt>NaN</dt><dd>Values in all buffers and images that are NaN or infinite.</dd>\n</dl>\n"
        "</section>\n<section aria-labelledby=\"again\">\n<h2 id=\"again\">Make this page again"
        "</h2>\n<pre><code>");
    html_text(page, command);
    file_writer_print(page, "</code></pre>\n</section>\n</main>\n</body>\n</html>\n");
}

static Result write_page(const HardReport *reports, size_t count, const char *command,
                         const char *path)
{
    FileWriter page;
    HardTotals totals = {0};
    Result result = file_writer_open(path, &page);
    if (result != RESULT_OK)
        return result;
    for (size_t i = 0; i < count; i++)
        report_hard_add(&reports[i], &totals);
    put_head(&page, &totals);
    put_contents(&page, reports, count);
    for (size_t i = 0; i < count; i++)
        put_case(&page, &reports[i]);
    put_guide(&page, command);
    return file_writer_close(&page, true);
}

static Result write_text(const char *dir, const char *name, const char *text)
{
    char *path = pictures_path(dir, name);
    Result result = path ? file_write(path, text, strlen(text)) : RESULT_NO_MEMORY;
    free(path);
    return result;
}

/* The page comes last, so that it never shows pictures that are not there. */
Result report_hard_html(const HardReport *reports, size_t count, const char *command,
                        const char *dir)
{
    Result result = file_make_directories(dir);
    for (size_t i = 0; i < count && result == RESULT_OK; i++)
        result = write_pictures(&reports[i], dir);
    if (result == RESULT_OK)
        result = write_text(dir, "style.css", report_style_css);
    if (result == RESULT_OK)
        result = write_text(dir, "hard.css", report_hard_css);
    char *page = pictures_path(dir, "index.html");
    if (result == RESULT_OK)
        result = page ? write_page(reports, count, command, page) : RESULT_NO_MEMORY;
    free(page);
    return result;
}

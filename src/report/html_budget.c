#include "report/html_budget.h"

#include "report/budget.h"
#include "report/html_parts.h"
#include "report/pictures.h"
#include "report/summary.h"

#include "image/png.h"

#include <stdlib.h>

static void put_figure(FileWriter *page, const char *key, const BudgetFigure *figure,
                       const char *text)
{
    char most[SUMMARY_NUMBER], rmse[SUMMARY_NUMBER], pixels[SUMMARY_NUMBER];
    html_open_row(page, "", key);
    file_writer_print(
        page, "<td>%s</td><td>%s</td><td>%s</td><td style=\"text-align:left\">%s</td></tr>\n",
        summary_real(figure->max_abs, most), summary_real(figure->rmse, rmse),
        summary_count(figure->pixels, pixels), text);
}

static void put_terms(FileWriter *page, const Budget *budget)
{
    static const char *const columns[] = {"what changes", "max abs", "RMSE", "pixels", ""};
    html_open_table(page, "Error budget, ref &minus; truth", columns, 5);
    for (int i = 0; i < BUDGET_TERMS; i++)
        if (budget->terms[i].measured)
            put_figure(page, budget_term_key((BudgetTerm)i), &budget->terms[i],
                       budget_term_text((BudgetTerm)i));
    put_figure(page, "sum", &budget->sum, "of all of these");
    put_figure(page, "total", &budget->total, "ref &minus; truth");
    put_figure(page, "unexplained", &budget->unexplained, "total &minus; sum");
    html_close_table(page);
    file_writer_print(page, "<p>Explained: %.4f %% of the squared error.</p>\n",
                      100.0 * budget->explained);
}

static void put_classes(FileWriter *page, const Budget *budget)
{
    static const char *const columns[] = {"class", "pixels", ""};
    char pixels[SUMMARY_NUMBER];
    html_open_table(page, "Why pixels differ", columns, 3);
    for (int i = 0; i < CLASS_COUNT; i++) {
        const uint8_t *color = report_class_color((PixelClass)i);
        if (!budget->counts[i])
            continue;
        html_open_row(page, "", class_key((PixelClass)i));
        file_writer_print(
            page,
            "<td>%s</td><td style=\"text-align:left\"><span style=\"display:inline-block;"
            "width:1em;height:1em;border:1px solid;background:#%02x%02x%02x\"></span> "
            "%s</td></tr>\n",
            summary_count(budget->counts[i], pixels), color[0], color[1], color[2],
            class_text((PixelClass)i));
    }
    html_close_table(page);
    html_open_picture(page, &(HtmlPicture){.shown = HTML_BUDGET_PICTURE,
                                           .width = budget->width,
                                           .height = budget->height,
                                           .lazy = true});
    file_writer_print(page, "Each pixel in the colour of its class\"></a>\n<figcaption>each pixel "
                            "in the colour of its class</figcaption>\n</figure>\n");
}

void html_budget(FileWriter *page, const Budget *budget)
{
    if (!budget)
        return;
    file_writer_print(page, "<section aria-labelledby=\"budget\">\n<h2 id=\"budget\">Where the "
                            "error comes from</h2>\n");
    put_terms(page, budget);
    put_classes(page, budget);
    file_writer_print(page, "</section>\n");
}

Result html_budget_picture(const Budget *budget, const char *dir)
{
    Image image = {0};
    if (!budget)
        return RESULT_OK;
    char *path = pictures_path(dir, HTML_BUDGET_PICTURE);
    Result result = path ? report_classes_image(budget, &image) : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = png_write(&image, path);
    image_free(&image);
    free(path);
    return result;
}

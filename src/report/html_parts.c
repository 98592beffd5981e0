#include "report/html_parts.h"

#include "report/heatmap.h"
#include "report/pictures.h"
#include "report/summary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

extern const char report_style_css[];

void html_text(FileWriter *page, const char *text)
{
    for (const char *c = text; *c; c++) {
        const char *entity = NULL;
        switch (*c) {
        case '&':
            entity = "&amp;";
            break;
        case '<':
            entity = "&lt;";
            break;
        case '>':
            entity = "&gt;";
            break;
        case '"':
            entity = "&quot;";
            break;
        case '\'':
            entity = "&#39;";
            break;
        default:
            if ((unsigned char)*c < 32 && *c != '\t' && *c != '\n')
                entity = "&#65533;";
        }
        if (entity)
            file_writer_put(page, entity, strlen(entity));
        else
            file_writer_put(page, c, 1);
    }
}

/* ---- head and verdict ------------------------------------------------------------------------ */

void html_open(FileWriter *page, const char *kicker, const Threeway *report)
{
    file_writer_print(page, "<!doctype html>\n<html lang=\"en\">\n<head>\n"
                            "<meta charset=\"utf-8\">\n"
                            "<meta name=\"viewport\" content=\"width=device-width, "
                            "initial-scale=1\">\n<title>");
    html_text(page, report->scene_name);
    file_writer_print(page,
                      " - %s</title>\n<link rel=\"stylesheet\" href=\"style.css\">\n</head>\n"
                      "<body>\n<header>\n<p class=\"kicker\">%s</p>\n<h1>",
                      kicker, kicker);
    html_text(page, report->scene_name);
    file_writer_print(page, "</h1>\n<p class=\"path\">");
    html_text(page, report->scene_path);
    file_writer_print(page, "</p>\n");
}

void html_setting_line(FileWriter *page, const Threeway *report, const char *const *names,
                       size_t count)
{
    SummarySetting settings[SUMMARY_SETTINGS];
    int setting_count = summary_settings(report, settings);
    const char *separator = "<p class=\"path\">";
    for (size_t n = 0; n < count; n++)
        for (int i = 0; i < setting_count; i++) {
            if (strcmp(settings[i].name, names[n]) != 0)
                continue;
            file_writer_print(page, "%s%s&nbsp;", separator, settings[i].name);
            html_text(page, settings[i].value);
            separator = " &middot; ";
        }
    file_writer_print(page, "</p>\n");
}

void html_open_main(FileWriter *page)
{
    file_writer_print(page, "</header>\n<main>\n");
}

Result html_close(FileWriter *page)
{
    return file_writer_print(page, "</main>\n</body>\n</html>\n");
}

void html_open_verdict(FileWriter *page, bool agree, const char *text)
{
    file_writer_print(page,
                      "<section class=\"verdict %s\" aria-labelledby=\"verdict\">\n"
                      "<h2 id=\"verdict\"><span class=\"sign\" aria-hidden=\"true\">%s</span>"
                      " %s</h2>\n<ul>\n",
                      agree ? "agree" : "differ", agree ? "&#10003;" : "&#10007;", text);
}

void html_item(FileWriter *page, const char *line)
{
    if (!line[0])
        return;
    file_writer_print(page, "<li>");
    html_text(page, line);
    file_writer_print(page, "</li>\n");
}

void html_close_verdict(FileWriter *page)
{
    file_writer_print(page, "</ul>\n</section>\n");
}

/* ---- pictures -------------------------------------------------------------------------------- */

void html_open_picture(FileWriter *page, const HtmlPicture *picture)
{
    file_writer_print(page,
                      "<figure>\n<a href=\"%s\"><img src=\"%s\" width=\"%d\" height=\"%d\"%s "
                      "alt=\"",
                      picture->linked ? picture->linked : picture->shown, picture->shown,
                      picture->width, picture->height, picture->lazy ? " loading=\"lazy\"" : "");
}

void html_scale(FileWriter *page)
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

void html_block_note(FileWriter *page, int block)
{
    if (block > 1)
        file_writer_print(page,
                          "<p>Each point shown is the greatest difference of %d &times; %d pixels; "
                          "the pictures link to the full size.</p>\n",
                          block, block);
}

/* ---- the rest -------------------------------------------------------------------------------- */

void html_command(FileWriter *page, const char *command)
{
    file_writer_print(page, "<section aria-labelledby=\"again\">\n<h2 id=\"again\">Make this "
                            "report again</h2>\n<pre><code>");
    html_text(page, command);
    file_writer_print(page, "</code></pre>\n</section>\n");
}

void html_open_table(FileWriter *page, const char *caption, const char *const *columns, int count)
{
    file_writer_print(page,
                      "<div class=\"table\" tabindex=\"0\" role=\"region\" aria-label=\"%s\">\n"
                      "<table>\n<caption>%s</caption>\n",
                      caption, caption);
    if (!columns)
        return;
    file_writer_print(page, "<thead><tr>");
    for (int i = 0; i < count; i++)
        file_writer_print(page, "<th scope=\"col\">%s</th>", columns[i]);
    file_writer_print(page, "</tr></thead>\n<tbody>\n");
}

void html_close_table(FileWriter *page)
{
    file_writer_print(page, "</tbody>\n</table>\n</div>\n");
}

void html_open_row(FileWriter *page, const char *class, const char *name)
{
    file_writer_print(page, "<tr%s><th scope=\"row\">", class);
    html_text(page, name);
    file_writer_print(page, "</th>");
}

static Result write_page(const char *path, HtmlBody body, const void *what)
{
    FileWriter page;
    Result result = file_writer_open(path, &page);
    if (result != RESULT_OK)
        return result;
    result = body(&page, what);
    Result closed = file_writer_close(&page, result == RESULT_OK);
    return result == RESULT_OK ? closed : result;
}

Result html_write(const char *dir, HtmlBody body, const void *what)
{
    char *style = pictures_path(dir, "style.css"), *page = pictures_path(dir, "index.html");
    Result result = style && page ? file_write(style, report_style_css, strlen(report_style_css))
                                  : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = write_page(page, body, what);
    free(style);
    free(page);
    return result;
}

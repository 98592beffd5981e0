/* What the report's pages are made of. Failures of the FileWriter stick, so nothing here returns
 * one but html_write. Private to src/report. */
#ifndef PEEL_REPORT_HTML_PARTS_H
#define PEEL_REPORT_HTML_PARTS_H

#include "base/file.h"
#include "study/threeway.h"

/* Appends text with &, <, >, " and ' escaped; control characters but tab and newline become
 * U+FFFD. Safe in elements and in quoted attributes. */
void html_text(FileWriter *page, const char *text);

/* Opens a page up to the scene's path: kicker, a few words (plain HTML), says what kind of page it
 * is. The caller may add lines to the header before html_open_main. */
void html_open(FileWriter *page, const char *kicker, const Threeway *report);
/* One line of the header: those settings of the report that names has, in its order; count of it.
 */
void html_setting_line(FileWriter *page, const Threeway *report, const char *const *names,
                       size_t count);
void html_open_main(FileWriter *page);
Result html_close(FileWriter *page);

/* Items stand between the two; an empty line is left out. */
void html_open_verdict(FileWriter *page, bool agree, const char *text);
void html_item(FileWriter *page, const char *line);
void html_close_verdict(FileWriter *page);

typedef struct HtmlPicture {
    const char *shown, *linked; /* paths from the page's folder; linked NULL: the same */
    int width, height;
    bool lazy;
} HtmlPicture;

/* Opens a figure with a linked picture; the caller goes on with the text for alt. */
void html_open_picture(FileWriter *page, const HtmlPicture *picture);

/* The legend of heat maps; its picture is PICTURES_SCALE in the page's folder. */
void html_scale(FileWriter *page);
/* Where the heat maps shown have a point for block·block pixels; nothing when block is 1. */
void html_block_note(FileWriter *page, int block);
void html_command(FileWriter *page, const char *command);

/* A table that scrolls when it is too wide. Its head, if columns is NULL, and its rows are the
 * caller's. caption: plain HTML without quotes. */
void html_open_table(FileWriter *page, const char *caption, const char *const *columns, int count);
void html_close_table(FileWriter *page);
/* class: "", or the attribute with a space before it; name: escaped here. */
void html_open_row(FileWriter *page, const char *class, const char *name);

/* Appends a whole page. */
typedef Result (*HtmlBody)(FileWriter *page, const void *what);

/* Writes dir/style.css, then dir/index.html; dir exists. */
Result html_write(const char *dir, HtmlBody body, const void *what);

#endif

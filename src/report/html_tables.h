/* The page's tables, and escaping. Private to src/report. */
#ifndef PEEL_REPORT_HTML_TABLES_H
#define PEEL_REPORT_HTML_TABLES_H

#include "base/file.h"
#include "study/threeway.h"

/* Appends text with &, <, >, " and ' escaped; control characters but tab and newline become
 * U+FFFD. Safe in elements and in quoted attributes. */
void html_text(FileWriter *page, const char *text);

/* Appends the sections with settings, buffers, final images, layers and times. */
void html_tables(FileWriter *page, const Threeway *report);

#endif

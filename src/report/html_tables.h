/* The tables of one comparison's page. Private to src/report. */
#ifndef PEEL_REPORT_HTML_TABLES_H
#define PEEL_REPORT_HTML_TABLES_H

#include "base/file.h"
#include "study/threeway.h"

/* Appends the sections with settings, buffers, final images, layers and times. */
void html_tables(FileWriter *page, const Threeway *report);

/* Appends the section with settings; without those of its method unless of_method. */
void html_settings(FileWriter *page, const Threeway *report, bool of_method);

#endif

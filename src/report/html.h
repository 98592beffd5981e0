/* The report: one folder with index.html, style.css and PNG files. Plain HTML and CSS that works
 * from disk and needs no network. */
#ifndef PEEL_REPORT_HTML_H
#define PEEL_REPORT_HTML_H

#include "study/threeway.h"

/* Makes dir (and its parents) if it is missing and writes the report of one comparison: the three
 * final images, the three difference heat maps with their scale, peels as thumbnails, the tables,
 * and `command`, the shell command that repeats it. IO with a message when dir cannot be written;
 * every file is written to a temporary name and renamed. Pictures of peels that an earlier report
 * left there, and this one does not have, are removed; nothing else is. */
Result report_html_write(const Threeway *report, const char *command, const char *dir);

#endif

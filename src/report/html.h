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

/* The same for one method of several: in dir/METHOD, METHOD the name of the report's, with a link
 * to dir/index.html. */
Result report_html_write_method(const Threeway *report, const char *command, const char *dir);

/* dir/index.html, about all methods on one scene: a table, error against time, and each method's
 * image and difference from truth. reports: count of them, at least one, of one scene and size,
 * each method at most once, written by report_html_write_method before; of their images nothing is
 * needed any more (threeway_release_images). command and failures as above. */
Result report_html_write_all(const Threeway *reports, size_t count, const char *command,
                             const char *dir);

#endif

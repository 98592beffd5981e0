/* What `peel check` prints and writes. */
#ifndef PEEL_REPORT_CHECK_H
#define PEEL_REPORT_CHECK_H

#include "study/check.h"

#include <stdio.h>

/* How theirs was understood, a row for each step, the first that differs, the verdict. */
void report_check_print(const CheckReport *report, FILE *out);

/* {"verdict": "agrees" or "differs", "image": {…}, "first": name or null, "steps": [{…}]}, to a
 * temporary name and renamed. Numbers that are not finite are null; "hex" says all. */
Result report_check_json(const CheckReport *report, const char *path);

/* dir/index.html with pictures of theirs, the reference and the difference; dir exists. command:
 * the line that makes the page again. */
Result report_check_html(const CheckReport *report, const char *command, const char *dir);

/* Of the report: what else is to be said of an image that differs everywhere; "" for others. */
void report_check_hint(const CheckReport *report, char *text, size_t size);

#endif

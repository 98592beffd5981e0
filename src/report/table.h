/* The comparison as aligned text and as JSON. */
#ifndef PEEL_REPORT_TABLE_H
#define PEEL_REPORT_TABLE_H

#include "study/threeway.h"

#include <stdio.h>

/* One row per pair and buffer, one per pair for the final image, layer statistics, times. */
void report_table_print(const Threeway *report, FILE *out);

/* The JSON document of `peel compare --json`, written to a temporary name and renamed. */
Result report_json_write(const Threeway *report, const char *path);

/* One scene by several methods: a table whose head is printed before the first row, a row each, and
 * what the columns mean. */
void report_methods_head(const Threeway *first, FILE *out);
void report_methods_row(const Threeway *report, FILE *out);
void report_methods_foot(FILE *out);

/* {"agree": all of them, "methods": [the document of each]}. */
Result report_json_write_all(const Threeway *reports, size_t count, const char *path);

#endif

/* The comparison as aligned text and as JSON. */
#ifndef PEEL_REPORT_TABLE_H
#define PEEL_REPORT_TABLE_H

#include "study/threeway.h"

#include <stdio.h>

/* One row per pair and buffer, one per pair for the final image, layer statistics, times. */
void report_table_print(const Threeway *report, FILE *out);

/* The JSON document of `peel compare --json`, written to a temporary name and renamed. */
Result report_json_write(const Threeway *report, const char *path);

#endif

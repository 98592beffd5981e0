/* The roofline as text and JSON. */
#ifndef PEEL_REPORT_ROOFLINE_H
#define PEEL_REPORT_ROOFLINE_H

#include "study/roofline.h"

#include <stdio.h>

void report_roofline_print(const RooflineReport *report, FILE *out);

/* The document of `peel bench --roofline --json`, written to a temporary name and renamed. */
Result report_roofline_json(const RooflineReport *report, const char *path);

#endif

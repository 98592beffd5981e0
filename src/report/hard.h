/* The catalogue of hard cases as text, JSON and a page. */
#ifndef PEEL_REPORT_HARD_H
#define PEEL_REPORT_HARD_H

#include "study/hard.h"

#include <stdio.h>

/* What came of all the cases that ran; rows differ where ref and gl must not. */
typedef struct HardTotals {
    size_t cases, rows, failed, nonfinite_rows, differing_rows;
    size_t apart_rows; /* where they do differ, for the reason that a note gives */
} HardTotals;

void report_hard_add(const HardReport *report, HardTotals *totals);

/* One table per case; then one line of totals. */
void report_hard_print(const HardReport *report, FILE *out);
void report_hard_print_totals(const HardTotals *totals, FILE *out);

/* The document of `peel hard --json`, written to a temporary name and renamed. */
Result report_hard_json(const HardReport *reports, size_t count, const char *path);

/* Makes dir if it is missing and writes index.html, style.css and pictures, each to a temporary
 * name and renamed. command: what repeats it. */
Result report_hard_html(const HardReport *reports, size_t count, const char *command,
                        const char *dir);

#endif

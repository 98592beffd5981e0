/* What `peel diff` prints and writes. */
#ifndef PEEL_REPORT_DIFF_H
#define PEEL_REPORT_DIFF_H

#include "compare/diff_files.h"
#include "study/budget.h"

#include <stdio.h>

typedef struct ReportDiff {
    const DiffReport *report;
    const DiffFilesOptions *options;
    /* The classes of the pictured part's pixels, as ref differs from truth; NULL where no scene was
     * given. Of its size. */
    const Budget *budget;
} ReportDiff;

/* In idiff's words, then what idiff does not say. verbose: also of parts that pass. */
void report_diff_print(const ReportDiff *diff, bool verbose, FILE *out);

/* The keys are a contract; see README.md. exit_code: what the command returns. */
Result report_diff_json(const ReportDiff *diff, int exit_code, const char *path);

/* Pixels of each class among those of the pictured part that differ. */
void report_diff_classes(const ReportDiff *diff, uint64_t counts[CLASS_COUNT]);

#endif

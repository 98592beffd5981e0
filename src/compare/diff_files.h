/* Two files, part by part: PNG, EXR of any channels and parts, deep EXR, traces. */
#ifndef PEEL_COMPARE_DIFF_FILES_H
#define PEEL_COMPARE_DIFF_FILES_H

#include "compare/diff.h"

typedef struct DiffFilesOptions {
    DiffOptions diff;
    bool all;             /* all parts, by name; else the first, but of two traces all */
    const char *channels; /* commas between: compare these alone; NULL: all */
} DiffFilesOptions;

typedef struct DiffSize {
    int x, y, width, height;
} DiffSize;

typedef struct DiffReport {
    const char *paths[DIFF_SIDES]; /* the caller's */
    int part_counts[DIFF_SIDES];
    bool trace; /* both are */
    bool all;
    int left_out; /* buffers of a trace that only one side can have: *.primitive */
    /* Sizes that differ end the comparison: of which part, and both. */
    bool sizes_differ;
    char size_part[64];
    DiffSize sizes[DIFF_SIDES];
    bool deep_differs; /* one is deep, the other is not; ends it too */
    DiffPart *parts;   /* in the order of the first file, then what only the second has */
    size_t count, capacity;
    int first;    /* the first part that differs in a stored value, or −1 */
    int pictured; /* of those in both files the first that differs, else the first: it has its
                     pixels; or −1 */
    Planes of[DIFF_SIDES]; /* the pictured part's, where it is flat */
    DiffVerdict verdict;
} DiffReport;

/* BAD_INPUT for files that cannot be read, are no images, or have no channel in common;
 * UNSUPPORTED, IO, NO_MEMORY. paths must outlive *out, which the caller frees, after a failure
 * too. */
Result diff_files(const char *a, const char *b, const DiffFilesOptions *options, DiffReport *out);
void diff_report_free(DiffReport *report);

#endif

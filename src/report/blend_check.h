/* Whose arithmetic somebody's blended values are, as text of at most 100 columns and as JSON. */
#ifndef PEEL_REPORT_BLEND_CHECK_H
#define PEEL_REPORT_BLEND_CHECK_H

#include "study/blend_check.h"
#include "study/blend_sequences.h"
#include "study/blend_wrong.h"

#include <stdio.h>

/* What the user asked for beside the figures. */
typedef struct ReportBlend {
    const BlendReport *report;
    BlendApi api;        /* whose rules count; API_COUNT: any */
    const char *note;    /* the file's own "arithmetic", "" where it has none */
    const char *subject; /* the file, or the driver */
    const char *vectors; /* "exhaustive, vectors 0 to 65535" */
    uint32_t fail, warn; /* ULP; UINT32_MAX: not given. Only with an arithmetic to compare with */
    bool verbose;        /* every arithmetic's row */
    int code;            /* the exit code */
} ReportBlend;

/* Rows of arithmetics and of rules, the verdict, and examples. */
Result report_blend_print(const ReportBlend *blend, FILE *out);
/* One line: format, equation, whose arithmetic, unexplained values. */
void report_blend_row_head(FILE *out);
void report_blend_row(const BlendReport *report, FILE *out);
/* The arithmetics of colour and alpha, in words: "driver", "colour driver, alpha exact". */
enum {
    REPORT_BLEND_NAME = 2 * ARITHMETIC_TEXT + 32
};
void report_blend_name(const BlendReport *report, char out[REPORT_BLEND_NAME]);

/* The document of `peel blend check --json`; count reports of one subject. */
Result report_blend_json(const ReportBlend *blends, size_t count, const char *path);

/* Sequences. */
void report_blend_sequences(const SequenceReport *report, const char *subject, FILE *out);
Result report_blend_sequences_json(const SequenceReport *report, const char *subject, int code,
                                   const char *path);

/* Of --list: every named arithmetic, and of the wrong ones what shows them. */
/* every: a row for each format and equation, not only the simplest of each format. */
void report_blend_list(const BlendWrongList *list, bool every, FILE *out);
Result report_blend_list_json(const BlendWrongList *list, const char *path);

#endif

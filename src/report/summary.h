/* What the text table, the JSON document and the HTML page say in the same words: rows, totals,
 * settings, the verdict. Private to src/report. No function here allocates or fails. */
#ifndef PEEL_REPORT_SUMMARY_H
#define PEEL_REPORT_SUMMARY_H

#include "study/threeway.h"

#include <stddef.h>

enum {
    SUMMARY_NUMBER = 40,
    SUMMARY_LINE = 320,
    SUMMARY_SETTINGS = 20
};

/* One row of a pair's buffer table: one buffer, or a run of buffers that are all equal. */
typedef struct SummaryRow {
    char label[112]; /* "peel.3.normal", or "opaque.depth to peel.2.accum" */
    size_t buffers;
    uint64_t values, differing;
    uint32_t max_ulp;
    double max_abs;
    bool has_first;
    int first[3];
} SummaryRow;

/* Steps through a pair's rows: *cursor starts at 0; false at the end. Every buffer that differs
 * has its own row. Where a pair has more than `unfolded` buffers, three or more equal ones in
 * succession share a row. */
bool summary_row(const PairReport *pair, size_t unfolded, size_t *cursor, SummaryRow *out);
SummaryRow summary_row_of(const BufferMetrics *buffer);

typedef struct SummaryTotals {
    size_t buffers, buffers_differing;
    uint64_t values, values_differing;
    const BufferMetrics *first; /* the first buffer that differs; NULL if none does */
} SummaryTotals;

SummaryTotals summary_totals(const PairReport *pair);

typedef struct SummarySetting {
    const char *name;
    char value[160];
} SummarySetting;

/* Returns how many there are, at most SUMMARY_SETTINGS. */
int summary_settings(const Threeway *report, SummarySetting out[SUMMARY_SETTINGS]);

/* Below every table of times. */
#define SUMMARY_TIME_NOTE "gl's time includes compiling its shaders."

/* One sentence each. */
void summary_pair_exact(const Threeway *report, char out[SUMMARY_LINE]); /* ref against gl */
void summary_pair_truth(const Threeway *report, char out[SUMMARY_LINE]); /* ref against truth */
/* "" unless the pass limit hid fragments. */
void summary_residual(const Threeway *report, char out[SUMMARY_LINE]);
/* The same for the times: gl's wall time over ref's. "" when it cannot be said. */
void summary_speed(const Threeway *report, char out[SUMMARY_LINE]);

/* Numbers for people: thousands separated; three significant digits; a NaN against a number has
 * no distance in ULP. */
const char *summary_count(uint64_t value, char out[SUMMARY_NUMBER]);
const char *summary_real(double value, char out[SUMMARY_NUMBER]);
const char *summary_ulp(uint32_t value, char out[SUMMARY_NUMBER]);
const char *summary_psnr(double value, char out[SUMMARY_NUMBER]);

/* One line of the layer statistics. */
typedef struct SummaryLayer {
    const char *key;  /* in JSON */
    const char *text; /* for people */
    uint64_t value;
} SummaryLayer;

enum {
    SUMMARY_LAYERS = 13
};
void summary_layers(const Threeway *report, SummaryLayer out[SUMMARY_LAYERS]);

#endif

/* Somebody's results for sequences of layers (blend/sequence.h): how many are inside the bound of
 * every sane arithmetic, how far they are from the exact result, and whose arithmetic they are. */
#ifndef PEEL_STUDY_BLEND_SEQUENCES_H
#define PEEL_STUDY_BLEND_SEQUENCES_H

#include "blend/arithmetic.h"
#include "blend/sequence.h"

/* One channel of one sequence's last pixel. */
typedef struct SequenceExample {
    uint64_t index;
    int layers, channel;
    double low, high; /* the bound; codes of unorm formats */
    uint32_t rounded, got;
    uint32_t ulp; /* between those two */
} SequenceExample;

typedef struct SequenceCandidate {
    const ArithmeticInfo *info;
    const char *refused;        /* static; or NULL */
    uint64_t values, differing; /* of all pixels that were given */
    uint32_t max_ulp;
} SequenceCandidate;

typedef struct SequenceReport {
    PixelFormat format;
    uint64_t sequences, values; /* values: channels of last pixels */
    uint64_t outside, rounded;  /* outside the bound; equal to the correctly rounded result */
    bool has_worst;
    SequenceExample worst;         /* of those outside, or else of all: the farthest from correct */
    SequenceCandidate *candidates; /* every named arithmetic, in its order */
    size_t count;
} SequenceReport;

/* The caller frees with sequence_report_free. */
Result sequence_report_start(PixelFormat format, SequenceReport *out);
void sequence_report_free(SequenceReport *report);

/* The next one. pixels: the pixel after each layer where given says so; the last always is. */
Result sequence_report_add(SequenceReport *report, uint64_t index, int layers,
                           const float (*source)[4], const void *pixels, const bool *given);

/* The candidate that gives all, a right one first; SIZE_MAX if none does. */
size_t sequence_report_best(const SequenceReport *report);

#endif

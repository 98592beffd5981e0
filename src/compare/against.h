/* A sink that compares what it is given with a stored trace, buffer by buffer, and keeps only the
 * figures. */
#ifndef PEEL_COMPARE_AGAINST_H
#define PEEL_COMPARE_AGAINST_H

#include "compare/metrics.h"
#include "compare/store.h"

typedef struct Against {
    TraceSink sink; /* hand &against->sink to a renderer */
    const TraceStore *reference;
    BufferMetrics *buffers; /* in order of arrival; then what only the reference has */
    size_t count, capacity;
    unsigned char *band;
    size_t band_capacity;
} Against;

/* reference must outlive it. The caller closes with against_finish and against_free. */
Against against_of(const TraceStore *reference);

/* Adds the buffers of the reference that never came (all their values differ) and counts the
 * values that a buffer's rectangles left out as differing; *.primitive buffers, which not every
 * renderer has, are left out. */
Result against_finish(Against *against);
void against_free(Against *against);

#endif

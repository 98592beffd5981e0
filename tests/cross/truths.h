/* ref/pipeline against truth on one scene: fragments, their order, and how far colours are apart
 * where these agree. Link truths.c. */
#ifndef PEEL_TESTS_TRUTHS_H
#define PEEL_TESTS_TRUTHS_H

#include "compare/metrics.h"
#include "compare/store.h"

typedef struct Truths {
    Frame ref, truth; /* truth's has its bounds */
    TraceStore *ref_trace, *truth_trace;
    uint8_t *same; /* width·height: a StructureSame each */
    StructureCounts counts;
    BoundMetrics bound;
} Truths;

/* desc has a bound (frame/method.h). Fails as the renderers do; the caller frees, after a failure
 * too. */
Result truths_compare(const Scene *scene, const RenderDesc *desc, Truths *out);
void truths_free(Truths *truths);

#endif

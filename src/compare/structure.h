/* Which fragments two renderers saw, and in which order: from their primitive buffers. */
#ifndef PEEL_COMPARE_STRUCTURE_H
#define PEEL_COMPARE_STRUCTURE_H

#include "compare/store.h"

typedef struct StructureCounts {
    uint64_t order_inversions; /* adjacent fragments of a that b has in the other order */
    uint64_t opaque_flips;     /* pixels whose opaque.primitive differs */
    uint64_t only_a, only_b; /* transparent fragments that one side has alone, repeated ones once */
} StructureCounts;

/* Whether two renderers see the same in a pixel. */
typedef enum StructureSame {
    STRUCTURE_DIFFERS = 0,
    STRUCTURE_SAME,  /* the opaque triangle, the transparent fragments and their order agree */
    STRUCTURE_EMPTY, /* both see only the background */
} StructureSame;

/* Compares opaque.primitive and peel.K.primitive, K = 0, 1, …, of two stores of one size.
 * same: width·height bytes, owned by the caller; a StructureSame each. */
Result structure_compare(const TraceStore *a, const TraceStore *b, int width, int height,
                         uint8_t *same, StructureCounts *out);

#endif

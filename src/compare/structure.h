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

/* What one store has in a pixel. */
typedef struct StructurePixel {
    uint32_t opaque; /* UINT32_MAX: none */
    uint32_t *ids;   /* of the transparent fragments, front to back */
    int count;
    uint32_t *depths; /* theirs, as stored; NULL where they are not asked for */
} StructurePixel;

/* pixel: row · width + column, row 0 at the top; sides: one for each store. */
typedef void (*StructureVisit)(void *context, size_t pixel, StructurePixel *sides);

enum {
    STRUCTURE_STORES_MAX = 4
};

/* Calls visit for every pixel, with what its opaque.primitive and peel.K.primitive, K = 0, 1, …,
 * are in each of up to STRUCTURE_STORES_MAX stores of one size, and peel.K.depth in store `deep`,
 * unless that is −1; visit may change the ids. */
Result structure_visit(const TraceStore *const stores[], int count, int deep, int width, int height,
                       StructureVisit visit, void *context);

/* The opaque triangle, the transparent fragments and their order. */
bool structure_same(const StructurePixel *a, const StructurePixel *b);

/* Where id is among count ids; -1: it is not. */
int structure_find(const uint32_t *ids, int count, uint32_t id);

/* A layer that the raw peel test took again is no fragment more, nor is a triangle's second piece,
 * which rounding folded over its first: each id keeps its first place. Returns how many are left.
 */
int structure_drop_repetitions(uint32_t *ids, int count);

/* Compares opaque.primitive and peel.K.primitive, K = 0, 1, …, of two stores of one size.
 * same: width·height bytes, owned by the caller; a StructureSame each. */
Result structure_compare(const TraceStore *a, const TraceStore *b, int width, int height,
                         uint8_t *same, StructureCounts *out);

#endif

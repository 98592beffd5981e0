/* Every fragment of one tile: the nearest opaque one of each pixel, and the transparent ones in
 * front of it, sorted: all by order.h. Nothing is shaded here. */
#ifndef PEEL_REF_TRUTH_FRAGMENTS_H
#define PEEL_REF_TRUTH_FRAGMENTS_H

#include "ref/truth/order.h"

enum {
    FRAGMENTS_TILE_PIXELS = TRACE_TILE * TRACE_TILE
};

/* One worker's scratch: reused from tile to tile. Zeroed is valid, but for limit_bytes. */
typedef struct TileFragments {
    Order order;                                  /* its counts: of all tiles so far */
    size_t limit_bytes;                           /* for the lists below */
    int x, y, width, height;                      /* the tile in the image, y from the top */
    Fragment opaque[FRAGMENTS_TILE_PIXELS];       /* the nearest opaque fragment, one per pixel */
    Fragment exact_opaque[FRAGMENTS_TILE_PIXELS]; /* the same under unsnapped coverage */
    Fragment *list;                               /* transparent ones as they came */
    size_t count, capacity;
    Fragment *sorted; /* by pixel, then front to back: pixel p's are first[p] … first[p + 1] − 1 */
    size_t sorted_capacity;
    uint32_t first[FRAGMENTS_TILE_PIXELS + 1];
    uint32_t deepest;          /* transparent fragments in the deepest pixel */
    uint64_t coverage_differs; /* see truth.h */
    uint64_t ties;             /* see truth.h */
} TileFragments;

/* Collects and sorts tile `tile` (row · soup->tile_columns + column). NO_MEMORY when the lists
 * would take more than limit_bytes. */
Result fragments_collect(const Soup *soup, const RenderDesc *desc, uint32_t tile,
                         TileFragments *fragments);
/* Frees the lists, not the struct. */
void fragments_free(TileFragments *fragments);

static inline size_t fragments_bytes(const TileFragments *fragments)
{
    return sizeof *fragments +
           (fragments->capacity + fragments->sorted_capacity) * sizeof(Fragment);
}

#endif

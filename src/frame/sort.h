/* The order in which a painter draws: far to near. */
#ifndef PEEL_FRAME_SORT_H
#define PEEL_FRAME_SORT_H

#include "frame/view.h"

/* Consecutive triangles of one draw. */
typedef struct SortRun {
    uint32_t draw;         /* index into View.draws */
    uint32_t first, count; /* triangles of its mesh */
} SortRun;

typedef struct Sort {
    SortRun *runs;
    size_t count;
} Sort;

/* Sorts the triangles of all transparent draws by the view-space depth of a centroid, the farthest
 * first; of equal depths the smaller primitive id is first, so the order does not depend on the
 * order of the draws. SORT_TRIANGLES: a triangle's centroid. SORT_OBJECTS: a draw's, the mean of
 * its triangles' corners, and the draw's triangles stay together, in their order. Depths are
 * computed in double from the view's float matrices and the meshes' floats, in flushing mode or not
 * the same. NO_MEMORY is possible.
 * The caller frees with sort_free. */
Result sort_far_to_near(const Scene *scene, const View *view, SortUnit unit, Sort *out);
void sort_free(Sort *sort); /* leaves an empty one */

/* What sorting allocates at most. */
uint64_t sort_bytes(const Scene *scene, const View *view, SortUnit unit);

#endif

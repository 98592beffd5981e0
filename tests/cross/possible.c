#include "possible.h"

#include "base/memory.h"
#include "ref/truth/bound.h"

#include <math.h>
#include <stdlib.h>

struct Possible {
    const RenderDesc *desc;
    View view;
    Soup soup;
    BoundTriangles *triangles;
};

Result possible_create(const Scene *scene, const RenderDesc *desc, Possible **out)
{
    size_t limit = desc->max_memory ? desc->max_memory : RENDER_MEMORY_DEFAULT;
    Possible *possible = *out = memory_array(1, sizeof *possible);
    Pool *pool = possible ? pool_create(desc->threads) : NULL;
    if (!pool)
        return RESULT_NO_MEMORY;
    possible->desc = desc;
    Result result = view_build(scene, desc, &possible->view);
    if (result == RESULT_OK)
        result = soup_build(scene, &possible->view, pool, limit, &possible->soup);
    pool_destroy(pool);
    if (result == RESULT_OK)
        possible->triangles = bound_triangles_create(&possible->soup, !desc->unfused);
    return result == RESULT_OK && !possible->triangles ? RESULT_NO_MEMORY : result;
}

void possible_destroy(Possible *possible)
{
    if (possible) {
        bound_triangles_destroy(possible->triangles);
        soup_free(&possible->soup);
        view_free(&possible->view);
    }
    free(possible);
}

typedef struct Place {
    bool possible, certain;
    double nearest, farthest; /* the depth; negated where the near plane is at 1 */
} Place;

static int column_of(const Possible *possible, size_t pixel)
{
    return (int)(pixel % (size_t)possible->view.width);
}

/* y up. */
static int row_of(const Possible *possible, size_t pixel)
{
    return possible->view.height - 1 - (int)(pixel / (size_t)possible->view.width);
}

static Place place(const Possible *possible, const RenderDesc *desc, size_t pixel, uint32_t id)
{
    BoundFragment found;
    bound_fragment(possible->triangles, desc ? desc : possible->desc,
                   soup_triangle_of(&possible->soup, id), column_of(possible, pixel),
                   row_of(possible, pixel), &found);
    const double *depth = desc ? found.stored : found.exact;
    if (possible->desc->depth_range == DEPTH_RANGE_REVERSED)
        return (Place){found.possible, found.certain, -depth[1], -depth[0]};
    return (Place){found.possible, found.certain, depth[0], depth[1]};
}

/* What lies behind all fragments: the opaque triangle, or what the depth buffer was cleared to. */
static Place background(const Possible *possible, const RenderDesc *desc, size_t pixel,
                        const StructurePixel *side)
{
    double far = possible->desc->depth_range == DEPTH_RANGE_REVERSED ? 0.0 : 1.0;
    if (side->opaque == UINT32_MAX)
        return (Place){true, true, far, far};
    return place(possible, desc, pixel, side->opaque);
}

const char *possible_repetitions(const Possible *possible, const RenderDesc *desc, size_t pixel,
                                 const StructurePixel *side)
{
    for (int i = 1; i < side->count; i++) {
        if (structure_find(side->ids, i, side->ids[i]) < 0)
            continue;
        uint32_t triangle = soup_triangle_of(&possible->soup, side->ids[i]);
        if (!desc || !bound_may_repeat(possible->triangles, triangle, column_of(possible, pixel),
                                       row_of(possible, pixel)))
            return "a layer twice, of a triangle whose pieces cannot overlap";
    }
    return NULL;
}

const char *possible_fragments(const Possible *possible, const RenderDesc *desc, size_t pixel,
                               const StructurePixel *side)
{
    Place behind = background(possible, desc, pixel, side);
    if (!behind.possible)
        return "an opaque triangle that cannot cover it";
    double front = -(double)INFINITY; /* the least depth that the one before can have */
    for (int i = 0; i < side->count; i++) {
        Place here = place(possible, desc, pixel, side->ids[i]);
        if (!here.possible)
            return "a triangle that cannot cover it";
        if (here.farthest < front)
            return "layers in an order that their depths cannot have";
        if (here.nearest > behind.farthest)
            return "a layer that must be behind the opaque triangle";
        front = here.nearest > front ? here.nearest : front;
    }
    return NULL;
}

const char *possible_all(const Possible *possible, const RenderDesc *desc, size_t pixel,
                         const StructurePixel *side, const StructurePixel *other)
{
    Place behind = background(possible, desc, pixel, side);
    if (other->opaque != UINT32_MAX && other->opaque != side->opaque) {
        Place opaque = place(possible, desc, pixel, other->opaque);
        if (opaque.certain && opaque.farthest < behind.nearest)
            return "not the opaque triangle that must be in front";
    }
    for (int i = 0; i < other->count; i++) {
        if (structure_find(side->ids, side->count, other->ids[i]) >= 0)
            continue;
        Place lost = place(possible, desc, pixel, other->ids[i]);
        if (lost.certain && lost.farthest < behind.nearest)
            return "without a layer that must be there";
    }
    const char *what = possible_fragments(possible, desc, pixel, side);
    return what ? what : possible_repetitions(possible, desc, pixel, side);
}

bool possible_tie(const Possible *possible, const RenderDesc *desc, size_t pixel,
                  const StructurePixel *side, uint32_t id)
{
    Place lost = place(possible, desc, pixel, id);
    for (int i = 0; i < side->count; i++) {
        Place rival = place(possible, desc, pixel, side->ids[i]);
        if (side->ids[i] != id && rival.nearest <= lost.farthest &&
            lost.nearest - (double)desc->bias <= rival.farthest)
            return true;
    }
    return false;
}

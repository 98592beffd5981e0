/* What ref makes of a scene's triangles before it draws them. */
#ifndef PEEL_TESTS_SCENE_GEOMETRY_H
#define PEEL_TESTS_SCENE_GEOMETRY_H

#include "base/pool.h"
#include "number/op.h"
#include "ref/pipeline/geometry.h"

/* *answer: what `ask` says of the geometry of scene as desc draws it. BAD_INPUT, NO_MEMORY. */
static inline Result scene_geometry_ask(const Scene *scene, const RenderDesc *desc,
                                        bool (*ask)(const Geometry *geometry), bool *answer)
{
    View view;
    Geometry geometry = {0};
    Pool *pool = pool_create(1);
    Result result = pool ? view_build(scene, desc, &view) : RESULT_NO_MEMORY;
    if (result == RESULT_OK) {
        uint32_t saved = op_enter();
        result = geometry_build(scene, &view, !desc->unfused, pool, &geometry);
        op_leave(saved);
        *answer = result == RESULT_OK && ask(&geometry);
        geometry_free(&geometry);
        view_free(&view);
    }
    pool_destroy(pool);
    return result;
}

#endif

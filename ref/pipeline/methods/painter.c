/* The painter: transparent objects or triangles sorted by their centroids and blended over each
 * other, far to near. No order of objects is right for the scene chain, none of triangles for
 * crossing_planes.
 *
 * This work is based on: M. Newell, R. Newell, T. Sancha, "A Solution to the Hidden Surface
 * Problem", ACM 1972, without its splitting; the baseline of the WebGPU tutorial "Order-Independent
 * Transparency" and of J. Breust, "Deep Deferred Rendering".
 *
 * The order is frame/sort.h's. Every fragment in front of the opaque depth whose alpha exceeds
 * SHADING_ALPHA_TEST is shaded and blended over the accumulation (number/blend.h), whose alpha is
 * the transmittance; the opaque surfaces and the background follow under it.
 * Trace: painter.layers, the accumulation before the opaque surfaces (step 1). */
#define _GNU_SOURCE /* qsort_r */
#include "ref/pipeline/methods/methods.h"

#include "base/memory.h"
#include "frame/sort.h"
#include "number/blend.h"
#include "ref/pipeline/shaded.h"

#include <stdlib.h>

typedef struct Painter {
    Pass *pass;
    uint32_t *rank; /* place of a primitive id in the order */
} Painter;

/* ---- order ---- */

static void rank_primitives(const Pass *pass, const Sort *sort, uint32_t *rank)
{
    uint32_t place = 0;
    for (size_t i = 0; i < sort->count; i++) {
        const SortRun *run = &sort->runs[i];
        for (uint32_t t = run->first; t < run->first + run->count; t++)
            rank[pass->view.draws[run->draw].first_primitive + t] = place++;
    }
}

static Result make_ranks(Painter *painter)
{
    Pass *pass = painter->pass;
    size_t triangles = (size_t)scene_triangle_count(pass->scene);
    Sort sort;
    Result result = sort_far_to_near(pass->scene, &pass->view, pass->desc->sort, &sort);
    if (result != RESULT_OK)
        return result;
    painter->rank = memory_array(triangles, sizeof *painter->rank);
    if (painter->rank)
        rank_primitives(pass, &sort, painter->rank);
    sort_free(&sort);
    return painter->rank ? RESULT_OK : RESULT_NO_MEMORY;
}

/* The pieces of a clipped triangle stay in their order. */
static int nearer(const void *left, const void *right, void *context)
{
    const Painter *painter = context;
    const Primitive *items = painter->pass->geometry.transparent.items;
    uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
    uint32_t a_rank = painter->rank[items[a].id], b_rank = painter->rank[items[b].id];
    if (a_rank != b_rank)
        return a_rank < b_rank ? -1 : 1;
    return a < b ? -1 : a > b;
}

/* ---- the pass ---- */

static void visit_fragment(void *context, const Setup *setup, int x, int y)
{
    const Stage *stage = ((const ShadedVisit *)context)->draw.stage;
    ShadedFragment fragment;
    if (shaded_fragment(context, setup, x, y, &fragment))
        stage_blend(stage, blend_over, "over", "accum", fragment.primitive, fragment.source,
                    &stage->accum, fragment.pixel);
}

static void geometry_tile(Stage *stage, uint32_t tile)
{
    Painter *painter = stage->method;
    Bins *bins = &painter->pass->transparent_bins;
    ShadedVisit visit = shaded_visit(stage, tile);
    qsort_r(bins->item + bins->first[tile], bins->first[tile + 1] - bins->first[tile],
            sizeof *bins->item, nearer, painter);
    stage_draw(bins, tile, visit_fragment, &visit.draw);
}

/* ---- the frame ---- */

static Result run(Stage *stage)
{
    const Image *accum = &stage->accum;
    Result result = make_ranks(stage->method);
    if (result == RESULT_OK)
        result = stage_opaque(stage);
    if (result == RESULT_OK)
        result = stage_run(stage, geometry_tile);
    if (result != RESULT_OK)
        return result;
    shaded_count(stage);
    result = trace_put(stage->trace, "painter.layers", 1, accum->format, accum->width,
                       accum->height, accum->pixels);
    return result == RESULT_OK ? stage_finish(stage) : result;
}

Result painter_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    Painter painter = {.pass = pass};
    Stage stage;
    uint64_t bytes = sort_bytes(pass->scene, &pass->view, pass->desc->sort) +
                     scene_triangle_count(pass->scene) * sizeof *painter.rank;
    Result result = stage_create(pass, trace, frame, &painter, bytes, &stage);
    if (result != RESULT_OK)
        return result;
    result = run(&stage);
    free(painter.rank);
    stage_free(&stage);
    return result;
}

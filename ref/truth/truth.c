#include "ref/truth/truth.h"

#include "base/clock.h"
#include "base/memory.h"
#include "frame/method.h"
#include "frame/shading.h"
#include "ref/truth/bound.h"
#include "ref/truth/fragments.h"
#include "ref/truth/lit.h"
#include "ref/truth/radiance.h"

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One worker's scratch and counts; counts are sums and maxima, so they do not depend on which
 * worker took which tile. */
typedef struct WorkerState {
    TileFragments fragments;
    BoundTriangles *triangles;             /* of desc->bound */
    uint32_t layer[FRAGMENTS_TILE_PIXELS]; /* one traced rectangle */
    uint32_t max;
    uint64_t fragment_count, coverage_differs, ties;
} WorkerState;

typedef struct Render {
    const RenderDesc *desc;
    const View *view;
    Soup soup;
    WorkerState **workers;
    TraceSink *trace;
    DeepImage *deep;       /* NULL: not asked for */
    pthread_mutex_t mutex; /* of trace and deep */
    Frame *frame;
} Render;

/* ---- shading and compositing ---------------------------------------------------------------- */

static void fill_sample(const Soup *soup, const Fragment *fragment, const Lit *lit,
                        const DeepSample *previous, DeepSample *out)
{
    for (int i = 0; i < 3; i++)
        out->rgba[i] = (float)fmin(lit->alpha * lit->rgb[i], FLT_MAX);
    out->rgba[3] = (float)lit->alpha;
    out->z = (float)fmin(lit->z, FLT_MAX);
    if (previous && previous->z > out->z)
        out->z = previous->z;
    out->depth = (float)fragment->depth;
    out->primitive = soup_primitive(soup, fragment->triangle);
    out->material = soup_draw(soup, fragment->triangle)->draw->material;
}

/* What one pixel shows: linear RGB over the background, and coverage. (x, y): y up. Unless samples
 * is NULL it receives every fragment; their number is returned. */
static uint32_t composite(const Render *render, const TileFragments *tile, int pixel, int x, int y,
                          double rgba[4], DeepSample *samples)
{
    const Fragment *opaque = &tile->opaque[pixel];
    uint32_t transparent = tile->first[pixel + 1] - tile->first[pixel];
    uint32_t count = transparent + (opaque->triangle != FRAGMENT_NO_TRIANGLE);
    rgba[0] = rgba[1] = rgba[2] = 0.0;
    rgba[3] = 1.0;
    for (uint32_t i = 0; i < count && (samples || rgba[3] > 0.0); i++) {
        const Fragment *fragment = i < transparent ? &tile->sorted[tile->first[pixel] + i] : opaque;
        Lit lit;
        lit_fragment(&render->soup, render->desc, fragment, x, y, &lit);
        if (samples)
            fill_sample(&render->soup, fragment, &lit, i ? &samples[i - 1] : NULL, &samples[i]);
        if (rgba[3] > 0.0)
            lit_blend(&lit, rgba);
    }
    for (int i = 0; i < 3; i++)
        rgba[i] += rgba[3] * render->view->background[i];
    rgba[3] = 1.0 - rgba[3];
    return count;
}

/* What the pipeline may differ by from the truth's rgba, the truth's own rounding to float
 * included. */
static void bound_pixel(const Render *render, WorkerState *worker, int pixel, int x, int y,
                        const double rgba[4], float out[4], float rounding[4])
{
    const TileFragments *tile = &worker->fragments;
    Bounded bound[4] = {bounded_of(0.0), bounded_of(0.0), bounded_of(0.0), bounded_of(1.0)};
    for (uint32_t i = tile->first[pixel]; i < tile->first[pixel + 1]; i++)
        bound_blend(worker->triangles, render->desc, &tile->sorted[i], x, y, bound);
    if (tile->opaque[pixel].triangle != FRAGMENT_NO_TRIANGLE)
        bound_blend(worker->triangles, render->desc, &tile->opaque[pixel], x, y, bound);
    bound_resolve(render->view, render->desc->accum, bound);
    for (int i = 0; i < 4; i++) {
        /* Both are within `exact` of what exact arithmetic gives. Were they farther apart, one of
         * them would be wrong: that is no part of the bounds, and so is seen beyond them. */
        double apart = fmin(fabs(bound[i].value - rgba[i]), 2.0 * bound[i].exact);
        double narrowed = apart + BOUNDED_SINGLE * fabs(rgba[i]);
        double most = bounded_limit((bound[i].single + narrowed) * BOUNDED_SLACK);
        double own = bounded_limit(bound[i].exact + apart);
        out[i] = most > 0.0 ? nextafterf((float)most, INFINITY) : 0.0f;
        rounding[i] = own > 0.0 ? nextafterf((float)own, INFINITY) : 0.0f;
    }
}

/* Room for the tile's samples; NULL when none are asked for. */
static Result reserve_samples(Render *render, const TileFragments *tile, DeepSample **out)
{
    *out = NULL;
    if (!render->deep)
        return RESULT_OK;
    size_t count = tile->count;
    for (int pixel = 0; pixel < FRAGMENTS_TILE_PIXELS; pixel++)
        count += tile->opaque[pixel].triangle != FRAGMENT_NO_TRIANGLE;
    pthread_mutex_lock(&render->mutex);
    Result result = deep_block(render->deep, count, out);
    pthread_mutex_unlock(&render->mutex);
    return result;
}

static Result draw_tile(Render *render, WorkerState *worker)
{
    const TileFragments *tile = &worker->fragments;
    DeepSample *samples;
    Result result = reserve_samples(render, tile, &samples);
    if (result != RESULT_OK)
        return result;
    for (int row = 0; row < tile->height; row++) {
        for (int column = 0; column < tile->width; column++) {
            int x = tile->x + column, image_y = tile->y + row;
            double rgba[4];
            uint32_t count = composite(render, tile, row * TRACE_TILE + column, x,
                                       render->view->height - 1 - image_y, rgba, samples);
            if (samples) {
                deep_set(render->deep, x, image_y, samples, count);
                samples += count;
            }
            if (render->desc->bound)
                bound_pixel(render, worker, row * TRACE_TILE + column, x,
                            render->view->height - 1 - image_y, rgba,
                            image_pixel(&render->frame->bound, x, image_y),
                            image_pixel(&render->frame->rounding, x, image_y));
            float *final = image_pixel(&render->frame->final, x, image_y);
            uint8_t *display = image_pixel(&render->frame->display, x, image_y);
            for (int i = 0; i < 4; i++)
                final[i] = (float)rgba[i];
            for (int i = 0; i < 3; i++)
                display[i] = radiance_display(rgba[i]);
            display[3] = 255;
        }
    }
    return RESULT_OK;
}

/* ---- trace ---------------------------------------------------------------------------------- */

static Result put_layer(Render *render, const TileFragments *tile, const char *name, int step,
                        const uint32_t *pixels)
{
    TraceBuffer buffer = {.name = name,
                          .step = step,
                          .format = FORMAT_R32UI,
                          .image_width = render->view->width,
                          .image_height = render->view->height,
                          .x = tile->x,
                          .y = tile->y,
                          .width = tile->width,
                          .height = tile->height,
                          .pixels = pixels,
                          .row_bytes = TRACE_TILE * sizeof *pixels};
    pthread_mutex_lock(&render->mutex);
    Result result = render->trace->put(render->trace, &buffer);
    pthread_mutex_unlock(&render->mutex);
    return result;
}

static uint32_t traced_id(const Soup *soup, uint32_t triangle)
{
    return triangle == FRAGMENT_NO_TRIANGLE ? UINT32_MAX : soup_primitive(soup, triangle);
}

static Result trace_tile(Render *render, WorkerState *worker)
{
    const TileFragments *tile = &worker->fragments;
    for (int pixel = 0; pixel < FRAGMENTS_TILE_PIXELS; pixel++)
        worker->layer[pixel] = traced_id(&render->soup, tile->opaque[pixel].triangle);
    Result result = put_layer(render, tile, "opaque.primitive", 0, worker->layer);
    for (uint32_t peel = 0; peel < tile->deepest && result == RESULT_OK; peel++) {
        for (int pixel = 0; pixel < FRAGMENTS_TILE_PIXELS; pixel++) {
            uint32_t at = tile->first[pixel] + peel;
            worker->layer[pixel] = at < tile->first[pixel + 1]
                                       ? soup_primitive(&render->soup, tile->sorted[at].triangle)
                                       : UINT32_MAX;
        }
        char name[48];
        snprintf(name, sizeof name, "peel.%u.primitive", peel);
        result = put_layer(render, tile, name, (int)peel + 1, worker->layer);
    }
    return result;
}

/* ---- the frame ------------------------------------------------------------------------------ */

static Result tile_task(void *context, uint32_t index, int worker_index)
{
    Render *render = context;
    WorkerState *worker = render->workers[worker_index];
    TileFragments *tile = &worker->fragments;
    Result result = fragments_collect(&render->soup, render->desc, index, tile);
    if (result == RESULT_OK)
        result = draw_tile(render, worker);
    if (result != RESULT_OK)
        return result;
    worker->max = tile->deepest > worker->max ? tile->deepest : worker->max;
    worker->fragment_count += tile->count;
    worker->coverage_differs += tile->coverage_differs;
    worker->ties += tile->ties;
    return render->trace ? trace_tile(render, worker) : RESULT_OK;
}

static void add_counts(const WorkerState *worker, LayerStats *layers)
{
    const OrderCounts *order = &worker->fragments.order.counts;
    layers->max = worker->max > layers->max ? worker->max : layers->max;
    layers->fragments += worker->fragment_count;
    layers->coverage_differs += worker->coverage_differs;
    layers->comparisons += order->comparisons;
    layers->exact_comparisons += order->exact_comparisons;
    layers->exact_coverage += order->exact_coverage;
    layers->ties += worker->ties;
    layers->undecided += order->undecided;
}

/* The deep image without samples, allowed three quarters of left bytes, which it is taken from. */
static Result begin_deep(Render *render, size_t *left)
{
    const View *view = render->view;
    size_t share = *left - *left / 4;
    *left -= share;
    Result result = deep_create(view->width, view->height, share, render->deep);
    if (result != RESULT_OK)
        return result;
    DeepImage *deep = render->deep;
    deep->has_camera = true;
    memcpy(deep->world_to_camera, view->world_to_camera, sizeof deep->world_to_camera);
    for (int column = 0; column < 4; column++)
        for (int row = 0; row < 4; row++) {
            double sum = 0.0;
            for (int i = 0; i < 4; i++)
                sum +=
                    (double)view->projection[4 * i + row] * view->world_to_camera[4 * column + i];
            deep->world_to_ndc[4 * column + row] = (float)sum;
        }
    return RESULT_OK;
}

/* With at most limit bytes for fragments; the caller frees what it is given, also after a failure.
 */
static Result create_worker(const Render *render, size_t limit, WorkerState **out)
{
    WorkerState *worker = *out = memory_array(1, sizeof *worker);
    if (!worker)
        return RESULT_NO_MEMORY;
    worker->fragments.limit_bytes = limit;
    if (!render->desc->bound)
        return RESULT_OK;
    worker->triangles = bound_triangles_create(&render->soup, !render->desc->unfused);
    return worker->triangles ? RESULT_OK : RESULT_NO_MEMORY;
}

/* Runs the tiles with one scratch per worker, within what is left of limit bytes. */
static Result render_tiles(Render *render, Pool *pool, size_t fixed_bytes, size_t limit)
{
    size_t threads = (size_t)pool_threads(pool);
    size_t worker_bytes = sizeof(WorkerState) + (render->desc->bound ? bound_triangles_bytes() : 0);
    size_t fixed = fixed_bytes + render->soup.bytes + threads * worker_bytes;
    Result result = soup_check_memory(fixed, limit);
    size_t left = limit - fixed;
    if (result == RESULT_OK && render->deep)
        result = begin_deep(render, &left);
    if (result != RESULT_OK)
        return result;
    render->workers = memory_array(threads, sizeof *render->workers);
    if (!render->workers)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < threads && result == RESULT_OK; i++)
        result = create_worker(render, left / threads, &render->workers[i]);
    uint32_t tiles = (uint32_t)(render->soup.tile_columns * render->soup.tile_rows);
    if (result == RESULT_OK)
        result = pool_run(pool, tiles, tile_task, render);
    Frame *frame = render->frame;
    frame->layers.exact_coverage = render->soup.exact_snaps;
    frame->buffer_bytes = fixed + (render->deep ? render->deep->bytes : 0);
    for (size_t i = 0; i < threads && render->workers[i]; i++) {
        WorkerState *worker = render->workers[i];
        add_counts(worker, &frame->layers);
        frame->buffer_bytes += fragments_bytes(&worker->fragments) - sizeof worker->fragments;
        fragments_free(&worker->fragments);
        bound_triangles_destroy(worker->triangles);
        free(worker);
    }
    free(render->workers);
    return result;
}

/* render: with desc, view and what is asked for. */
static Result render_view(const Scene *scene, Render *render)
{
    const RenderDesc *desc = render->desc;
    const View *view = render->view;
    Frame *frame = render->frame;
    size_t limit = desc->max_memory ? desc->max_memory : RENDER_MEMORY_DEFAULT;
    size_t pixels = (size_t)view->width * (size_t)view->height;
    size_t image_bytes = pixels * ((desc->bound ? 3 : 1) * format_pixel_bytes(FORMAT_RGBA32F) +
                                   format_pixel_bytes(FORMAT_RGBA8));
    Result result = soup_check_memory(image_bytes, limit);
    if (result == RESULT_OK)
        result = image_create(view->width, view->height, FORMAT_RGBA32F, &frame->final);
    if (result == RESULT_OK)
        result = image_create(view->width, view->height, FORMAT_RGBA8, &frame->display);
    if (result == RESULT_OK && desc->bound)
        result = image_create(view->width, view->height, FORMAT_RGBA32F, &frame->bound);
    if (result == RESULT_OK && desc->bound)
        result = image_create(view->width, view->height, FORMAT_RGBA32F, &frame->rounding);
    if (result != RESULT_OK)
        return result;
    Pool *pool = pool_create(desc->threads);
    if (!pool)
        return RESULT_NO_MEMORY;
    frame->threads = pool_threads(pool);
    pthread_mutex_init(&render->mutex, NULL);
    result = soup_build(scene, view, pool, limit - image_bytes, &render->soup);
    if (result == RESULT_OK)
        result = render_tiles(render, pool, image_bytes, limit);
    soup_free(&render->soup);
    pthread_mutex_destroy(&render->mutex);
    pool_destroy(pool);
    return result;
}

static Result render_frame(const Scene *scene, const RenderDesc *desc, TraceSink *trace,
                           DeepImage *deep, Frame *out)
{
    *out = (Frame){0};
    if (desc->bound && !method_has_bound(desc))
        return result_fail(RESULT_UNSUPPORTED,
                           "truth: no bound of single precision for method %s%s, expected peel, "
                           "peel-id, forward, or linked-list without edges",
                           method_info(desc->method)->name,
                           render_desc_edges(desc) ? " with edges" : "");
    Clock start = clock_now();
    View view;
    RenderDesc in_order = *desc; /* triangles are numbered as they come */
    in_order.draw_order = DRAW_ORDER_SCENE;
    Result result = view_build(scene, &in_order, &view);
    if (result != RESULT_OK)
        return result;
    Render render = {.desc = desc, .view = &view, .trace = trace, .deep = deep, .frame = out};
    result = render_view(scene, &render);
    view_free(&view);
    if (result != RESULT_OK) {
        frame_free(out);
        return result;
    }
    out->peels = (int)out->layers.max;
    clock_elapsed(&start, &out->time_ms, &out->cpu_ms);
    snprintf(out->version, sizeof out->version, "Peel %s", PEEL_VERSION);
    snprintf(out->renderer, sizeof out->renderer, "truth (double precision A-buffer)");
    return RESULT_OK;
}

Result truth_render(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    return render_frame(scene, desc, trace, NULL, out);
}

Result truth_render_deep(const Scene *scene, const RenderDesc *desc, DeepImage *deep, Frame *out)
{
    *deep = (DeepImage){0};
    Result result = render_frame(scene, desc, NULL, deep, out);
    if (result != RESULT_OK)
        deep_free(deep);
    return result;
}

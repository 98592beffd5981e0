#include "ref/truth/truth.h"

#include "base/clock.h"
#include "base/memory.h"
#include "frame/shading.h"
#include "ref/truth/fragments.h"
#include "ref/truth/radiance.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

/* One worker's scratch and counts; counts are sums and maxima, so they do not depend on which
 * worker took which tile. */
typedef struct WorkerState {
    TileFragments fragments;
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
    pthread_mutex_t trace_mutex;
    Frame *frame;
} Render;

/* ---- shading and compositing ---------------------------------------------------------------- */

static Surface find_surface(const Render *render, const Fragment *fragment, int x, int y)
{
    const SoupVertex *vertices[3];
    soup_vertices(&render->soup, fragment->triangle, vertices);
    const Corner *corners[3] = {&vertices[0]->corner, &vertices[1]->corner, &vertices[2]->corner};
    ExactPoint point;
    exact_at(corners, x, y, &point);
    bool turned = fragment->back && render->desc->normals == NORMALS_FACED;
    Surface surface = {0};
    for (int i = 0; i < 3; i++) {
        double position = 0.0, normal = 0.0;
        for (int corner = 0; corner < 3; corner++) {
            position += point.weight[corner] * vertices[corner]->position[i];
            normal += point.weight[corner] * vertices[corner]->normal[i];
        }
        surface.position[i] = position;
        surface.normal[i] = turned ? -normal : normal;
    }
    soup_material(&render->soup, fragment->triangle, point.weight, &surface.material);
    return surface;
}

/* Puts the fragment behind rgba: premultiplied colour so far, and transmittance. */
static void blend_fragment(const Render *render, const Fragment *fragment, int x, int y,
                           double rgba[4])
{
    bool transparent = soup_draw(&render->soup, fragment->triangle)->draw->transparent;
    Surface surface = find_surface(render, fragment, x, y);
    surface.back_light = render->desc->back_light && transparent;
    surface.phong = render->desc->shading == SHADING_PHONG;
    double alpha = transparent ? surface.material.base_color[3] : 1.0;
    if (alpha <= (double)SHADING_ALPHA_TEST)
        return;
    double rgb[3];
    radiance_shade(render->view, &surface, rgb);
    for (int i = 0; i < 3; i++)
        rgba[i] += rgba[3] * alpha * rgb[i];
    rgba[3] *= 1.0 - alpha;
}

/* What one pixel shows: linear RGB over the background, and coverage. (x, y): y up. */
static void composite(const Render *render, const TileFragments *tile, int pixel, int x, int y,
                      double rgba[4])
{
    rgba[0] = rgba[1] = rgba[2] = 0.0;
    rgba[3] = 1.0;
    for (uint32_t i = tile->first[pixel]; i < tile->first[pixel + 1] && rgba[3] > 0.0; i++)
        blend_fragment(render, &tile->sorted[i], x, y, rgba);
    const Fragment *opaque = &tile->opaque[pixel];
    if (opaque->triangle != FRAGMENT_NO_TRIANGLE && rgba[3] > 0.0)
        blend_fragment(render, opaque, x, y, rgba);
    for (int i = 0; i < 3; i++)
        rgba[i] += rgba[3] * render->view->background[i];
    rgba[3] = 1.0 - rgba[3];
}

static void draw_tile(const Render *render, const TileFragments *tile)
{
    for (int row = 0; row < tile->height; row++) {
        for (int column = 0; column < tile->width; column++) {
            int x = tile->x + column, image_y = tile->y + row;
            double rgba[4];
            composite(render, tile, row * TRACE_TILE + column, x,
                      render->view->height - 1 - image_y, rgba);
            float *final = image_pixel(&render->frame->final, x, image_y);
            uint8_t *display = image_pixel(&render->frame->display, x, image_y);
            for (int i = 0; i < 4; i++)
                final[i] = (float)rgba[i];
            for (int i = 0; i < 3; i++)
                display[i] = radiance_display(rgba[i]);
            display[3] = 255;
        }
    }
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
    pthread_mutex_lock(&render->trace_mutex);
    Result result = render->trace->put(render->trace, &buffer);
    pthread_mutex_unlock(&render->trace_mutex);
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
    if (result != RESULT_OK)
        return result;
    draw_tile(render, tile);
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

/* Runs the tiles with one scratch per worker, within what is left of limit bytes. */
static Result render_tiles(Render *render, Pool *pool, size_t fixed_bytes, size_t limit)
{
    size_t threads = (size_t)pool_threads(pool);
    size_t fixed = fixed_bytes + render->soup.bytes + threads * sizeof(WorkerState);
    Result result = soup_check_memory(fixed, limit);
    if (result != RESULT_OK)
        return result;
    render->workers = memory_array(threads, sizeof *render->workers);
    if (!render->workers)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < threads && result == RESULT_OK; i++) {
        render->workers[i] = memory_array(1, sizeof **render->workers);
        if (render->workers[i])
            render->workers[i]->fragments.limit_bytes = (limit - fixed) / threads;
        else
            result = RESULT_NO_MEMORY;
    }
    uint32_t tiles = (uint32_t)(render->soup.tile_columns * render->soup.tile_rows);
    if (result == RESULT_OK)
        result = pool_run(pool, tiles, tile_task, render);
    Frame *frame = render->frame;
    frame->buffer_bytes = fixed;
    for (size_t i = 0; i < threads && render->workers[i]; i++) {
        WorkerState *worker = render->workers[i];
        add_counts(worker, &frame->layers);
        frame->buffer_bytes += fragments_bytes(&worker->fragments) - sizeof worker->fragments;
        fragments_free(&worker->fragments);
        free(worker);
    }
    free(render->workers);
    return result;
}

static Result render_view(const Scene *scene, const RenderDesc *desc, const View *view,
                          TraceSink *trace, Frame *frame)
{
    size_t limit = desc->max_memory ? desc->max_memory : RENDER_MEMORY_DEFAULT;
    size_t pixels = (size_t)view->width * (size_t)view->height;
    size_t image_bytes =
        pixels * (format_pixel_bytes(FORMAT_RGBA32F) + format_pixel_bytes(FORMAT_RGBA8));
    Result result = soup_check_memory(image_bytes, limit);
    if (result == RESULT_OK)
        result = image_create(view->width, view->height, FORMAT_RGBA32F, &frame->final);
    if (result == RESULT_OK)
        result = image_create(view->width, view->height, FORMAT_RGBA8, &frame->display);
    if (result != RESULT_OK)
        return result;
    Pool *pool = pool_create(desc->threads);
    if (!pool)
        return RESULT_NO_MEMORY;
    frame->threads = pool_threads(pool);
    Render render = {.desc = desc, .view = view, .trace = trace, .frame = frame};
    pthread_mutex_init(&render.trace_mutex, NULL);
    result = soup_build(scene, view, pool, limit - image_bytes, &render.soup);
    if (result == RESULT_OK)
        result = render_tiles(&render, pool, image_bytes, limit);
    soup_free(&render.soup);
    pthread_mutex_destroy(&render.trace_mutex);
    pool_destroy(pool);
    return result;
}

Result truth_render(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    *out = (Frame){0};
    Clock start = clock_now();
    View view;
    RenderDesc in_order = *desc; /* triangles are numbered as they come */
    in_order.draw_order = DRAW_ORDER_SCENE;
    Result result = view_build(scene, &in_order, &view);
    if (result != RESULT_OK)
        return result;
    result = render_view(scene, desc, &view, trace, out);
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

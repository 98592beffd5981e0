#define _GNU_SOURCE /* qsort_r */

#include "ref/truth/fragments.h"

#include "base/memory.h"
#include "ref/truth/coverage.h"

#include <stdlib.h>

enum {
    LIST_START = 1024,
    INSERTION_MAX = 24
};

/* Corners known to within a sixteenth of a subpixel do not strain the slack of coverage.h; with
 * worse ones no verdict of it is certain. */
#define SNAPPING_ERROR_MAX (1.0 / (16 * 256))
#define SLACK_ALL          (INT64_MAX / 4)

/* One triangle on its way into a tile. */
typedef struct Raster {
    const Soup *soup;
    const RenderDesc *desc;
    TileFragments *fragments;
    const Draw *draw;
    const Material *material;
    uint32_t triangle;
    const Corner *corners[3];
    Coverage coverage;
    DepthBound bound; /* over what of the tile it may cover */
} Raster;

/* ---- order ---------------------------------------------------------------------------------- */

typedef struct Sorting {
    Order *order;
    DepthFunc func;
} Sorting;

static int compare_fragments(const void *a, const void *b, void *context)
{
    const Sorting *sorting = context;
    return order_compare_all(sorting->order, a, b, sorting->func);
}

static void sort_pixel(Order *order, Fragment *fragments, size_t count, DepthFunc func)
{
    if (count > INSERTION_MAX) {
        Sorting sorting = {order, func};
        qsort_r(fragments, count, sizeof *fragments, compare_fragments, &sorting);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        Fragment fragment = fragments[i];
        size_t at = i;
        for (; at > 0 && order_compare_all(order, &fragment, &fragments[at - 1], func) < 0; at--)
            fragments[at] = fragments[at - 1];
        fragments[at] = fragment;
    }
}

static uint64_t count_ties(Order *order, const Fragment *fragments, size_t count)
{
    uint64_t ties = 0;
    for (size_t i = 1; i < count; i++)
        ties += order_compare(order, &fragments[i - 1], &fragments[i]) == 0;
    return ties;
}

/* Puts the list in order: counts per pixel, distributes, sorts each pixel. */
static Result sort_list(TileFragments *fragments, DepthFunc func)
{
    void *sorted = fragments->sorted;
    Result result =
        memory_grow(&sorted, &fragments->sorted_capacity, fragments->count, sizeof(Fragment));
    fragments->sorted = sorted;
    if (result != RESULT_OK)
        return result;
    uint32_t *first = fragments->first;
    for (int pixel = 0; pixel <= FRAGMENTS_TILE_PIXELS; pixel++)
        first[pixel] = 0;
    for (size_t i = 0; i < fragments->count; i++)
        first[fragments->list[i].pixel]++;
    for (int pixel = 1; pixel <= FRAGMENTS_TILE_PIXELS; pixel++)
        first[pixel] += first[pixel - 1]; /* its end; filling backwards makes it its start */
    for (size_t i = fragments->count; i-- > 0;)
        fragments->sorted[--first[fragments->list[i].pixel]] = fragments->list[i];
    fragments->deepest = 0;
    for (int pixel = 0; pixel < FRAGMENTS_TILE_PIXELS; pixel++) {
        uint32_t count = first[pixel + 1] - first[pixel];
        if (count == 0)
            continue;
        Fragment *pixel_fragments = &fragments->sorted[first[pixel]];
        sort_pixel(&fragments->order, pixel_fragments, count, func);
        fragments->ties += count_ties(&fragments->order, pixel_fragments, count);
        fragments->deepest = count > fragments->deepest ? count : fragments->deepest;
    }
    return RESULT_OK;
}

/* ---- collecting ----------------------------------------------------------------------------- */

static Result append(TileFragments *fragments, Fragment fragment)
{
    if (fragments->count == fragments->capacity) {
        size_t grown = fragments->capacity ? 2 * fragments->capacity : LIST_START;
        Result result = soup_check_memory(2 * grown * sizeof(Fragment), fragments->limit_bytes);
        if (result == RESULT_OK && grown > UINT32_MAX)
            result = result_fail(RESULT_UNSUPPORTED,
                                 "truth: tile at %d,%d: expected fewer than 2^32 fragments",
                                 fragments->x, fragments->y);
        if (result != RESULT_OK)
            return result;
        void *list = fragments->list;
        result = memory_grow(&list, &fragments->capacity, grown, sizeof(Fragment));
        fragments->list = list;
        if (result != RESULT_OK)
            return result;
    }
    fragments->list[fragments->count++] = fragment;
    return RESULT_OK;
}

/* An opaque fragment against the nearest so far; the depth buffer was cleared to 1. */
static void depth_test(Order *order, Fragment *nearest, const Fragment *fragment, DepthFunc func)
{
    int depth = nearest->triangle == FRAGMENT_NO_TRIANGLE
                    ? order_compare(order, fragment, nearest) - (func == DEPTH_LEQUAL)
                    : order_compare_all(order, fragment, nearest, func);
    if (depth < 0)
        *nearest = *fragment;
}

/* A transparent fragment against the opaque ones of either coverage. */
static Result add_transparent(TileFragments *fragments, const Fragment *fragment, bool snapped,
                              bool exact)
{
    const Fragment *opaque = &fragments->opaque[fragment->pixel];
    const Fragment *exact_opaque = &fragments->exact_opaque[fragment->pixel];
    bool same = opaque->triangle == exact_opaque->triangle;
    if (snapped || same) {
        int depth = order_compare(&fragments->order, fragment, opaque);
        fragments->ties += snapped && depth == 0 && opaque->triangle != FRAGMENT_NO_TRIANGLE;
        snapped = snapped && depth < 0;
        exact = exact && (depth < 0 || !same);
    }
    if (exact && !same)
        exact = order_compare(&fragments->order, fragment, exact_opaque) < 0;
    fragments->coverage_differs += fragment->unsure && (snapped || exact);
    return snapped ? append(fragments, *fragment) : RESULT_OK;
}

/* snapped, exact: whether either coverage has the fragment. */
static Result add_fragment(const Raster *raster, Fragment *fragment, bool snapped, bool exact)
{
    TileFragments *fragments = raster->fragments;
    Fragment *opaque = &fragments->opaque[fragment->pixel];
    Fragment *exact_opaque = &fragments->exact_opaque[fragment->pixel];
    fragment->unsure = snapped != exact;
    if (raster->draw->transparent)
        return add_transparent(fragments, fragment, snapped, exact);
    DepthFunc func = raster->desc->depth_func;
    bool same = snapped && exact && opaque->triangle == exact_opaque->triangle;
    if (snapped)
        depth_test(&fragments->order, opaque, fragment, func);
    if (same)
        *exact_opaque = *opaque;
    else if (exact)
        depth_test(&fragments->order, exact_opaque, fragment, func);
    return RESULT_OK;
}

/* Whether a masked material's texture has a hole there. */
static bool is_cut_out(const Raster *raster, const double weight[3])
{
    if (!raster->draw->masked)
        return false;
    MaterialSample sample;
    soup_material(raster->soup, raster->triangle, weight, &sample);
    return sample.base_color[3] < (double)raster->material->alpha_cutoff;
}

/* (x, y): a pixel in the tile and in the coverage's bounds; y up. */
static Result raster_pixel(const Raster *raster, int x, int y)
{
    bool clockwise = false;
    CoverageAt at = coverage_at(&raster->coverage, x, y, &clockwise);
    if (at == COVERAGE_OUTSIDE)
        return RESULT_OK;
    ExactPoint point;
    exact_at(raster->corners, x, y, &point);
    const Draw *draw = raster->draw;
    Order *order = &raster->fragments->order;
    bool inside = true, exact_clockwise = clockwise;
    if (at != COVERAGE_INSIDE)
        inside =
            order_inside(order, &raster->bound, &point, raster->triangle, x, y, &exact_clockwise);
    bool snapped_back = clockwise != draw->flipped, exact_back = exact_clockwise != draw->flipped;
    bool snapped = at >= COVERAGE_INSIDE_CLOSE && !(draw->cull_back && snapped_back);
    bool exact = inside && !(draw->cull_back && exact_back);
    if ((!snapped && !exact) || is_cut_out(raster, point.weight))
        return RESULT_OK;
    const TileFragments *fragments = raster->fragments;
    int row = raster->soup->view->height - 1 - y - fragments->y;
    Fragment fragment = {.triangle = raster->triangle,
                         .pixel = (uint16_t)(row * TRACE_TILE + x - fragments->x),
                         .back = snapped ? snapped_back : exact_back};
    order_set_depth(order, &raster->bound, raster->corners, &point, &fragment);
    return add_fragment(raster, &fragment, snapped, exact);
}

static Result raster_triangle(Raster *raster)
{
    const SoupVertex *vertices[3];
    soup_vertices(raster->soup, raster->triangle, vertices);
    for (int i = 0; i < 3; i++)
        raster->corners[i] = &vertices[i]->corner;
    int height = raster->soup->view->height;
    Coverage *coverage = &raster->coverage;
    if (!soup_coverage(raster->soup, vertices, coverage))
        return RESULT_OK;
    const TileFragments *tile = raster->fragments;
    int x_low = tile->x, x_high = tile->x + tile->width - 1;
    int y_low = height - tile->y - tile->height, y_high = height - 1 - tile->y;
    x_low = coverage->x_low > x_low ? coverage->x_low : x_low;
    x_high = coverage->x_high < x_high ? coverage->x_high : x_high;
    y_low = coverage->y_low > y_low ? coverage->y_low : y_low;
    y_high = coverage->y_high < y_high ? coverage->y_high : y_high;
    if (x_low > x_high || y_low > y_high || coverage_misses(coverage, x_low, y_low, x_high, y_high))
        return RESULT_OK;
    depth_bound_setup(vertices, (BoundRect){x_low, x_high, y_low, y_high}, &raster->bound);
    if (!(raster->bound.snapping_error < SNAPPING_ERROR_MAX))
        coverage->slack = SLACK_ALL;
    Result result = RESULT_OK;
    for (int y = y_low; y <= y_high && result == RESULT_OK; y++)
        for (int x = x_low; x <= x_high && result == RESULT_OK; x++)
            result = raster_pixel(raster, x, y);
    return result;
}

static Result raster_list(Raster *raster, uint32_t tile, bool transparent)
{
    const Soup *soup = raster->soup;
    Result result = RESULT_OK;
    for (uint64_t i = soup->tile_first[tile]; i < soup->tile_first[tile + 1]; i++) {
        raster->triangle = soup->tile_triangles[i];
        const SoupDraw *draw = soup_draw(soup, raster->triangle);
        raster->draw = draw->draw;
        raster->material = draw->material;
        if (raster->draw->transparent == transparent)
            result = raster_triangle(raster);
        if (result != RESULT_OK)
            break;
    }
    return result;
}

static void begin_tile(const Soup *soup, uint32_t tile, TileFragments *fragments)
{
    fragments->x = (int)(tile % (uint32_t)soup->tile_columns) * TRACE_TILE;
    fragments->y = (int)(tile / (uint32_t)soup->tile_columns) * TRACE_TILE;
    int right = soup->view->width - fragments->x, below = soup->view->height - fragments->y;
    fragments->width = right < TRACE_TILE ? right : TRACE_TILE;
    fragments->height = below < TRACE_TILE ? below : TRACE_TILE;
    fragments->count = 0;
    fragments->coverage_differs = fragments->ties = 0;
    fragments->order.soup = soup;
    fragments->order.x = fragments->x;
    fragments->order.y = fragments->y;
    Fragment none = {.depth = 1.0, .triangle = FRAGMENT_NO_TRIANGLE, .is_fixed = true};
    for (int pixel = 0; pixel < FRAGMENTS_TILE_PIXELS; pixel++) {
        none.pixel = (uint16_t)pixel;
        fragments->opaque[pixel] = fragments->exact_opaque[pixel] = none;
    }
}

Result fragments_collect(const Soup *soup, const RenderDesc *desc, uint32_t tile,
                         TileFragments *fragments)
{
    begin_tile(soup, tile, fragments);
    Raster raster = {.soup = soup, .desc = desc, .fragments = fragments};
    Result result = raster_list(&raster, tile, false);
    for (int pixel = 0; pixel < FRAGMENTS_TILE_PIXELS; pixel++) {
        /* The two winners differ where either owes its coverage to snapping or to its lack. */
        fragments->coverage_differs += fragments->opaque[pixel].unsure;
        fragments->coverage_differs += fragments->exact_opaque[pixel].unsure;
    }
    if (result == RESULT_OK)
        result = raster_list(&raster, tile, true);
    return result == RESULT_OK ? sort_list(fragments, desc->depth_func) : result;
}

void fragments_free(TileFragments *fragments)
{
    order_free(&fragments->order);
    free(fragments->list);
    free(fragments->sorted);
    fragments->list = fragments->sorted = NULL;
    fragments->capacity = fragments->sorted_capacity = fragments->count = 0;
}

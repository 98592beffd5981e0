#include "ref/truth/fragments.h"

#include "base/memory.h"
#include "ref/truth/coverage.h"

#include <stdlib.h>

enum {
    LIST_START = 1024,
    INSERTION_MAX = 24
};

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
} Raster;

/* ---- order ---------------------------------------------------------------------------------- */

static bool in_front(const Fragment *a, const Fragment *b, DepthFunc func)
{
    if (a->depth != b->depth)
        return a->depth < b->depth;
    return func == DEPTH_LEQUAL ? a->triangle > b->triangle : a->triangle < b->triangle;
}

static int compare_less(const void *a, const void *b)
{
    return in_front(a, b, DEPTH_LESS) ? -1 : in_front(b, a, DEPTH_LESS);
}

static int compare_lequal(const void *a, const void *b)
{
    return in_front(a, b, DEPTH_LEQUAL) ? -1 : in_front(b, a, DEPTH_LEQUAL);
}

static void sort_pixel(Fragment *fragments, size_t count, DepthFunc func)
{
    if (count > INSERTION_MAX) {
        qsort(fragments, count, sizeof *fragments,
              func == DEPTH_LEQUAL ? compare_lequal : compare_less);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        Fragment fragment = fragments[i];
        size_t at = i;
        for (; at > 0 && in_front(&fragment, &fragments[at - 1], func); at--)
            fragments[at] = fragments[at - 1];
        fragments[at] = fragment;
    }
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
        if (count > 1)
            sort_pixel(&fragments->sorted[first[pixel]], count, func);
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
static void depth_test(Fragment *nearest, Fragment fragment, DepthFunc func)
{
    bool passes = nearest->triangle == FRAGMENTS_NO_TRIANGLE
                      ? func == DEPTH_LEQUAL || fragment.depth < 1.0
                      : in_front(&fragment, nearest, func);
    if (passes)
        *nearest = fragment;
}

/* snapped, exact: whether either coverage has the fragment. */
static Result add_fragment(const Raster *raster, Fragment fragment, bool snapped, bool exact)
{
    TileFragments *fragments = raster->fragments;
    Fragment *opaque = &fragments->opaque[fragment.pixel];
    Fragment *exact_opaque = &fragments->exact_opaque[fragment.pixel];
    fragment.unsure = snapped != exact;
    if (!raster->draw->transparent) {
        if (snapped)
            depth_test(opaque, fragment, raster->desc->depth_func);
        if (exact)
            depth_test(exact_opaque, fragment, raster->desc->depth_func);
        return RESULT_OK;
    }
    snapped = snapped && fragment.depth < opaque->depth;
    exact = exact && fragment.depth < exact_opaque->depth;
    fragments->coverage_differs += fragment.unsure && (snapped || exact);
    return snapped ? append(fragments, fragment) : RESULT_OK;
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
    bool snapped_back = clockwise != draw->flipped;
    bool exact_back = at == COVERAGE_INSIDE ? snapped_back : point.clockwise != draw->flipped;
    bool snapped = at >= COVERAGE_INSIDE_CLOSE && !(draw->cull_back && snapped_back);
    bool exact = (at == COVERAGE_INSIDE || point.inside) && !(draw->cull_back && exact_back);
    if ((!snapped && !exact) || is_cut_out(raster, point.weight))
        return RESULT_OK;
    const TileFragments *fragments = raster->fragments;
    int row = raster->soup->view->height - 1 - y - fragments->y;
    Fragment fragment = {.depth = point.depth,
                         .triangle = raster->triangle,
                         .pixel = (uint16_t)(row * TRACE_TILE + x - fragments->x),
                         .back = snapped ? snapped_back : exact_back};
    return add_fragment(raster, fragment, snapped, exact);
}

static Result raster_triangle(Raster *raster)
{
    const SoupVertex *vertices[3];
    soup_vertices(raster->soup, raster->triangle, vertices);
    for (int i = 0; i < 3; i++)
        raster->corners[i] = &vertices[i]->corner;
    int height = raster->soup->view->height;
    Coverage *coverage = &raster->coverage;
    if (!coverage_setup(raster->corners, raster->soup->view->width, height, coverage))
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
    fragments->coverage_differs = 0;
    for (int pixel = 0; pixel < FRAGMENTS_TILE_PIXELS; pixel++) {
        const Fragment none = {1.0, FRAGMENTS_NO_TRIANGLE, (uint16_t)pixel, false, false};
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
    free(fragments->list);
    free(fragments->sorted);
    fragments->list = fragments->sorted = NULL;
    fragments->capacity = fragments->sorted_capacity = fragments->count = 0;
}

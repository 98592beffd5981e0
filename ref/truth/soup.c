#include "ref/truth/soup.h"

#include "base/memory.h"
#include "ref/truth/snap.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

enum {
    CHUNK = 4096
}; /* vertices or triangles per task */

/* Columns and rows of tiles, inclusive; empty when column_low > column_high. */
typedef struct TileRange {
    uint16_t column_low, column_high, row_low, row_high;
} TileRange;

typedef struct Build {
    Soup *soup;
    TileRange *ranges; /* one per triangle */
    _Atomic uint64_t exact_snaps;
} Build;

Result soup_check_memory(size_t needed, size_t limit)
{
    if (needed <= limit)
        return RESULT_OK;
    return result_fail(RESULT_NO_MEMORY,
                       "truth: needs at least %zu KiB, the limit is %zu KiB (--max-memory)",
                       needed >> 10, limit >> 10);
}

/* ---- draws ---------------------------------------------------------------------------------- */

static Result collect_draws(const Scene *scene, const View *view, size_t max_bytes, Soup *soup)
{
    soup->draws = memory_array(view->draw_count, sizeof *soup->draws);
    if (!soup->draws)
        return RESULT_NO_MEMORY;
    uint64_t vertices = 0, triangles = 0;
    for (size_t i = 0; i < view->draw_count; i++) {
        const Draw *draw = &view->draws[i];
        const Mesh *mesh = &scene->meshes[draw->mesh];
        if (mesh->triangle_count == 0)
            continue;
        soup->draws[soup->draw_count++] = (SoupDraw){draw, mesh, &scene->materials[draw->material],
                                                     vertices, (uint32_t)triangles};
        vertices += mesh->vertex_count;
        triangles += mesh->triangle_count;
        if (triangles >= UINT32_MAX)
            return result_fail(RESULT_UNSUPPORTED,
                               "truth: %llu triangles, expected fewer than 2^32 - 1",
                               (unsigned long long)triangles);
    }
    soup->vertex_count = vertices;
    soup->triangle_count = (uint32_t)triangles;
    size_t tiles = (size_t)soup->tile_columns * (size_t)soup->tile_rows;
    soup->bytes = view->draw_count * sizeof *soup->draws + vertices * sizeof *soup->vertices +
                  (tiles + 1) * sizeof *soup->tile_first;
    return soup_check_memory(soup->bytes + triangles * sizeof(TileRange), max_bytes);
}

/* The last of the draws whose first vertex (or triangle) is not after index. */
static const SoupDraw *find_draw(const Soup *soup, uint64_t index, bool by_vertex)
{
    size_t low = 0, high = soup->draw_count;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        const SoupDraw *draw = &soup->draws[middle];
        uint64_t first = by_vertex ? (uint64_t)draw->first_vertex : draw->first_triangle;
        if (first <= index)
            low = middle;
        else
            high = middle;
    }
    return &soup->draws[low];
}

const SoupDraw *soup_draw(const Soup *soup, uint32_t triangle)
{
    return find_draw(soup, triangle, false);
}

uint32_t soup_primitive(const Soup *soup, uint32_t triangle)
{
    const SoupDraw *draw = soup_draw(soup, triangle);
    return draw->draw->first_primitive + (triangle - draw->first_triangle);
}

uint32_t soup_triangle_of(const Soup *soup, uint32_t primitive)
{
    const SoupDraw *draw = soup->draws;
    while (primitive - draw->draw->first_primitive >= draw->mesh->triangle_count)
        draw++;
    return draw->first_triangle + (primitive - draw->draw->first_primitive);
}

void soup_vertices(const Soup *soup, uint32_t triangle, const SoupVertex *out[3])
{
    const SoupDraw *draw = soup_draw(soup, triangle);
    const uint32_t *index = &draw->mesh->index[(size_t)(triangle - draw->first_triangle) * 3];
    for (int i = 0; i < 3; i++)
        out[i] = &soup->vertices[draw->first_vertex + index[i]];
}

bool soup_coverage(const Soup *soup, const SoupVertex *const vertices[3], Coverage *out)
{
    const Corner *corners[3] = {&vertices[0]->corner, &vertices[1]->corner, &vertices[2]->corner};
    const Snap snaps[3] = {vertices[0]->snap, vertices[1]->snap, vertices[2]->snap};
    return coverage_setup_snapped(corners, snaps, soup->view->width, soup->view->height, out);
}

void soup_material(const Soup *soup, uint32_t triangle, const double weight[3], MaterialSample *out)
{
    const SoupDraw *draw = soup_draw(soup, triangle);
    const Mesh *mesh = draw->mesh;
    double uv[2] = {0.0, 0.0};
    if (mesh->uv) {
        const uint32_t *index = &mesh->index[(size_t)(triangle - draw->first_triangle) * 3];
        for (int i = 0; i < 2; i++) {
            double p0 = mesh->uv[2 * (size_t)index[0] + i];
            double p1 = mesh->uv[2 * (size_t)index[1] + i];
            double p2 = mesh->uv[2 * (size_t)index[2] + i];
            uv[i] = p0 + (weight[1] * (p1 - p0) + weight[2] * (p2 - p0));
        }
    }
    texture_material(soup->textures, draw->material, uv, out);
}

/* ---- vertices ------------------------------------------------------------------------------- */

/* Clip coordinates of a point in view space. Each operation errs by at most EXACT_ROUNDING times
 * its result, and products of floats are exact; no product comes near the least normal number,
 * being a multiple of 2^-447. */
static void project(const View *view, const double position[3], const double position_error[3],
                    double clip[4], double error[4])
{
    for (int row = 0; row < 4; row++) {
        double rounded = 0.0;
        clip[row] = view->projection[12 + row];
        error[row] = 0.0;
        for (int column = 0; column < 3; column++) {
            double factor = view->projection[4 * column + row];
            double product = factor * position[column];
            clip[row] += product;
            rounded += fabs(product) + fabs(clip[row]);
            error[row] += fabs(factor) * position_error[column];
        }
        error[row] += EXACT_ROUNDING * rounded;
    }
    /* The other clip spaces are brought to −w … w, near to far. */
    if (view->depth_range == DEPTH_RANGE_GL)
        return;
    double sign = view->depth_range == DEPTH_RANGE_REVERSED ? -1.0 : 1.0;
    clip[2] = sign * (2.0 * clip[2] - clip[3]);
    error[2] = 2.0 * error[2] + error[3] + EXACT_ROUNDING * fabs(clip[2]);
}

/* A sum of two clip coordinates, times half of the viewport's size. */
static double to_window(double a, double b, double a_error, double b_error, int size, double *error)
{
    double half = 0.5 * size, sum = a + b, window = sum * half;
    *error =
        (a_error + b_error + EXACT_ROUNDING * fabs(sum)) * half + EXACT_ROUNDING * fabs(window);
    return window;
}

static SoupVertex transform(const View *view, const Draw *draw, const float *position,
                            const float *normal, bool *exact_snap)
{
    SoupVertex vertex;
    double view_error[3], clip[4], error[4];
    for (int row = 0; row < 3; row++) {
        double p = draw->model_view[12 + row], n = 0.0, rounded = 0.0;
        for (int column = 0; column < 3; column++) {
            p += (double)draw->model_view[4 * column + row] * position[column];
            rounded += fabs(p);
            n += (double)draw->normal_matrix[3 * column + row] * normal[column];
        }
        vertex.position[row] = p;
        vertex.normal[row] = n;
        view_error[row] = EXACT_ROUNDING * rounded;
    }
    project(view, vertex.position, view_error, clip, error);
    Corner *corner = &vertex.corner, *bound = &vertex.error;
    corner->x = to_window(clip[0], clip[3], error[0], error[3], view->width, &bound->x);
    corner->y = to_window(clip[1], clip[3], error[1], error[3], view->height, &bound->y);
    corner->z = clip[2];
    corner->w = clip[3];
    bound->x *= EXACT_SLACK;
    bound->y *= EXACT_SLACK;
    bound->z = error[2] * EXACT_SLACK;
    bound->w = error[3] * EXACT_SLACK;
    vertex.snap = snap_vertex(view, draw, position, corner, bound, exact_snap);
    return vertex;
}

static Result vertex_task(void *context, uint32_t index, int worker)
{
    (void)worker;
    Build *build = context;
    Soup *soup = build->soup;
    bool exact_snap;
    uint64_t exact_snaps = 0;
    size_t first = (size_t)index * CHUNK;
    size_t end = first + CHUNK < soup->vertex_count ? first + CHUNK : soup->vertex_count;
    const SoupDraw *draw = find_draw(soup, first, true);
    for (size_t i = first; i < end; i++) {
        while (i - draw->first_vertex >= draw->mesh->vertex_count)
            draw++;
        size_t local = 3 * (i - draw->first_vertex);
        soup->vertices[i] = transform(soup->view, draw->draw, &draw->mesh->position[local],
                                      &draw->mesh->normal[local], &exact_snap);
        exact_snaps += exact_snap;
    }
    atomic_fetch_add(&build->exact_snaps, exact_snaps);
    return RESULT_OK;
}

/* ---- tiles ---------------------------------------------------------------------------------- */

static TileRange tile_range(const Soup *soup, uint32_t triangle)
{
    const SoupVertex *vertices[3];
    soup_vertices(soup, triangle, vertices);
    int height = soup->view->height;
    Coverage coverage;
    if (!soup_coverage(soup, vertices, &coverage))
        return (TileRange){1, 0, 1, 0};
    return (TileRange){(uint16_t)(coverage.x_low / TRACE_TILE),
                       (uint16_t)(coverage.x_high / TRACE_TILE),
                       (uint16_t)((height - 1 - coverage.y_high) / TRACE_TILE),
                       (uint16_t)((height - 1 - coverage.y_low) / TRACE_TILE)};
}

static Result range_task(void *context, uint32_t index, int worker)
{
    (void)worker;
    Build *build = context;
    uint32_t count = build->soup->triangle_count, first = index * CHUNK;
    uint32_t end = count - first < CHUNK ? count : first + CHUNK;
    for (uint32_t i = first; i < end; i++)
        build->ranges[i] = tile_range(build->soup, i);
    return RESULT_OK;
}

/* Counts, then fills: tile_first[t] is tile t's start when done. */
static Result fill_tiles(Build *build, size_t max_bytes)
{
    Soup *soup = build->soup;
    size_t columns = (size_t)soup->tile_columns, tiles = columns * (size_t)soup->tile_rows;
    for (uint32_t i = 0; i < soup->triangle_count; i++) {
        TileRange range = build->ranges[i];
        for (size_t row = range.row_low; row <= range.row_high; row++)
            for (size_t column = range.column_low; column <= range.column_high; column++)
                soup->tile_first[row * columns + column]++;
    }
    uint64_t total = 0;
    for (size_t tile = 0; tile < tiles; tile++) {
        total += soup->tile_first[tile];
        soup->tile_first[tile] = total; /* its end; filling backwards makes it its start */
    }
    soup->tile_first[tiles] = total;
    soup->bytes += total * sizeof *soup->tile_triangles;
    Result result =
        soup_check_memory(soup->bytes + soup->triangle_count * sizeof(TileRange), max_bytes);
    if (result != RESULT_OK)
        return result;
    soup->tile_triangles = memory_array(total, sizeof *soup->tile_triangles);
    if (!soup->tile_triangles)
        return RESULT_NO_MEMORY;
    for (uint32_t i = soup->triangle_count; i-- > 0;) {
        TileRange range = build->ranges[i];
        for (size_t row = range.row_low; row <= range.row_high; row++)
            for (size_t column = range.column_low; column <= range.column_high; column++)
                soup->tile_triangles[--soup->tile_first[row * columns + column]] = i;
    }
    return RESULT_OK;
}

static uint32_t chunks(size_t count)
{
    return (uint32_t)((count + CHUNK - 1) / CHUNK);
}

Result soup_build(const Scene *scene, const View *view, Pool *pool, size_t max_bytes, Soup *out)
{
    *out = (Soup){.view = view,
                  .textures = scene->textures,
                  .tile_columns = (view->width + TRACE_TILE - 1) / TRACE_TILE,
                  .tile_rows = (view->height + TRACE_TILE - 1) / TRACE_TILE};
    Result result = collect_draws(scene, view, max_bytes, out);
    if (result != RESULT_OK)
        return result;
    size_t tiles = (size_t)out->tile_columns * (size_t)out->tile_rows;
    out->vertices = memory_array(out->vertex_count, sizeof *out->vertices);
    out->tile_first = memory_array(tiles + 1, sizeof *out->tile_first);
    Build build = {.soup = out, .ranges = memory_array(out->triangle_count, sizeof(TileRange))};
    if (!out->vertices || !out->tile_first || !build.ranges)
        result = RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = pool_run(pool, chunks(out->vertex_count), vertex_task, &build);
    out->exact_snaps = build.exact_snaps;
    if (result == RESULT_OK)
        result = pool_run(pool, chunks(out->triangle_count), range_task, &build);
    if (result == RESULT_OK)
        result = fill_tiles(&build, max_bytes);
    free(build.ranges);
    return result;
}

void soup_free(Soup *soup)
{
    free(soup->draws);
    free(soup->vertices);
    free(soup->tile_first);
    free(soup->tile_triangles);
    *soup = (Soup){0};
}

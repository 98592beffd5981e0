/* The scene as one list of triangles in window space, binned to screen tiles.
 *
 * Corners are computed in double from the mesh's floats and the view's float matrices, taken as
 * exact numbers, and carry a bound of their rounding (plane.h has them without). Triangles are
 * numbered from 0 through all draws in order; that order is the order of primitive ids. */
#ifndef PEEL_REF_TRUTH_SOUP_H
#define PEEL_REF_TRUTH_SOUP_H

#include "base/pool.h"
#include "frame/trace.h"
#include "frame/view.h"
#include "ref/truth/coverage.h"
#include "ref/truth/texture.h"

typedef struct SoupVertex {
    Corner corner;
    Corner error; /* proven: each number of corner errs by at most this */
    Snap snap;
    double position[3]; /* view space */
    double normal[3];   /* view space, not normalised */
} SoupVertex;

typedef struct SoupDraw {
    const Draw *draw;
    const Mesh *mesh;
    const Material *material;
    size_t first_vertex;     /* in Soup.vertices */
    uint32_t first_triangle; /* in the soup's numbering */
} SoupDraw;

typedef struct Soup {
    const View *view;
    const Texture *textures; /* the scene's */
    SoupDraw *draws;         /* draw_count of them, without those that have no triangle */
    size_t draw_count;
    SoupVertex *vertices;
    size_t vertex_count;
    uint32_t triangle_count;
    int tile_columns, tile_rows; /* tiles of TRACE_TILE pixels, row 0 at the top */
    uint64_t *tile_first;        /* tile count + 1: where each tile's list starts */
    uint32_t *tile_triangles;    /* ascending within a tile */
    uint64_t exact_snaps;        /* vertices snapped in exact arithmetic */
    size_t bytes;                /* of all the arrays */
} Soup;

/* scene and view must outlive the soup. Fails with NO_MEMORY when the arrays would take more than
 * max_bytes. The caller frees with soup_free, after a failure too. */
Result soup_build(const Scene *scene, const View *view, Pool *pool, size_t max_bytes, Soup *out);
void soup_free(Soup *soup);

/* triangle < triangle_count. */
const SoupDraw *soup_draw(const Soup *soup, uint32_t triangle);
void soup_vertices(const Soup *soup, uint32_t triangle, const SoupVertex *out[3]);
/* coverage_setup_snapped for its triangle's vertices. */
bool soup_coverage(const Soup *soup, const SoupVertex *const vertices[3], Coverage *out);
uint32_t soup_primitive(const Soup *soup, uint32_t triangle);    /* the frame's primitive id */
uint32_t soup_triangle_of(const Soup *soup, uint32_t primitive); /* of an id that a frame has */
/* The triangle's material where its corners have these weights (exact.h), textures included. */
void soup_material(const Soup *soup, uint32_t triangle, const double weight[3],
                   MaterialSample *out);

/* NO_MEMORY and a message naming the need when more than limit bytes are needed. */
Result soup_check_memory(size_t needed, size_t limit);

#endif

/* Vertex stage, clipping and primitive assembly: from the scene's triangles to window space.
 *
 * Window coordinates are GL's: y up, pixel centres at +0.5. There is no guard band: a triangle
 * that crosses any plane of the view volume is cut, and the pieces are primitives of their own.
 * It does not implement lines, points, user clip planes, other depth ranges or multisampling.
 * Source: OpenGL 4.6 core, 13.7 and 13.8; the order of operations measured on llvmpipe
 * (NUMBERS.md). */
#ifndef PEEL_REF_GEOMETRY_H
#define PEEL_REF_GEOMETRY_H

#include "base/pool.h"
#include "frame/view.h"

enum {
    VARYINGS = 8
};

typedef struct Vertex {
    float clip[4];
    float window[4];            /* x, y, z, 1/w */
    int32_t x_fixed8, y_fixed8; /* window x − 0.5 and y − 0.5, in 1/256 pixel */
    union {
        struct {
            float position[3], normal[3]; /* view space */
            float uv[2];                  /* 0 where the mesh has none */
        };
        float varying[VARYINGS]; /* all that is interpolated */
    };
    uint32_t outcode; /* clip_outcode; 0 of a vertex that the clipper made */
} Vertex;

/* Pixels x0 … x1 and y0 … y1, both ends included, window coordinates (y up). */
typedef struct PixelRect {
    int16_t x0, y0, x1, y1;
} PixelRect;

typedef struct Primitive {
    uint32_t vertex[3]; /* indices into Geometry.vertices, in the driver's order */
    uint32_t id;        /* the triangle it is, or is a piece of: see view.h */
    uint32_t draw : 31; /* index into View.draws */
    uint32_t swap : 1;  /* its snapped area is negative: the first two vertices change places */
    PixelRect box;      /* setup_bounds */
} Primitive;

/* Primitives of one list, in draw order: what has no area, faces away from a culled side or
 * covers no pixel centre's cell of the viewport is left out. */
typedef struct PrimitiveList {
    Primitive *items;
    size_t count;
} PrimitiveList;

typedef struct Geometry {
    Vertex *vertices;
    size_t vertex_count;
    PrimitiveList opaque, transparent;
    bool wide; /* one of them is too large for the tile path: setup_is_wide */
} Geometry;

/* fused: see op_muladd. The caller frees with geometry_free. NO_MEMORY on failure. */
Result geometry_build(const Scene *scene, const View *view, bool fused, Pool *pool, Geometry *out);
void geometry_free(Geometry *geometry);

/* ---- clip.c ---- */

typedef struct Viewport {
    float scale[3], translate[3];
    bool fused;
    bool half_depth; /* the view volume is 0 ≤ z ≤ w, not −w ≤ z ≤ w */
} Viewport;

/* OpenGL 4.6, 13.8.1, for a viewport at (0, 0) and depth range 0…1. */
Viewport viewport_make(int width, int height, DepthRange range, bool fused);

/* Fills window and fixed coordinates from clip coordinates. cut: the vertex was made by the
 * clipper, whose viewport transform the driver never fuses. */
void viewport_transform(const Viewport *viewport, bool cut, Vertex *vertex);

/* Bit i is set when the vertex is outside plane i: x ≤ w, x ≥ −w, y ≤ w, y ≥ −w, z ≥ −w (or
 * z ≥ 0), z ≤ w. */
unsigned clip_outcode(const Viewport *viewport, const Vertex *vertex);

enum {
    CLIP_VERTICES_MAX = 9,
    CLIP_PLANES = 6
};

/* A vertex of the clipped polygon: an input vertex (source 0…2) or a new one (source < 0, fresh).
 */
typedef struct ClipVertex {
    int source;
    Vertex fresh;
} ClipVertex;

/* Cuts one triangle by the planes in `planes` (the union of its outcodes), Sutherland–Hodgman in
 * the order of the planes. Returns the number of vertices, 0 when nothing is left; the polygon's
 * fan is (i − 1, i, 0) for i = 2 … n − 1. */
int clip_triangle(const Viewport *viewport, const Vertex *const triangle[3], unsigned planes,
                  ClipVertex out[CLIP_VERTICES_MAX]);

#endif

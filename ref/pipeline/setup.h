/* Triangle setup: edge functions in exact integers, plane equations in floats.
 *
 * A pixel is covered iff its centre is strictly inside all three edges, or on an edge that the
 * fill rule gives to this triangle; vertices are snapped to 1/256 pixel, so shared edges are hit
 * exactly once. Planes use the unsnapped window positions. It does not implement guard bands,
 * polygon offset or per-sample coverage. Rules: NUMBERS.md, measured on llvmpipe. */
#ifndef PEEL_REF_SETUP_H
#define PEEL_REF_SETUP_H

#include "number/op.h"
#include "ref/pipeline/geometry.h"
#include "ref/pipeline/wide.h"

typedef enum Facing {
    FACING_NONE = 0,
    FACING_FRONT,
    FACING_BACK
} Facing;

/* Value at pixel (x, y): fma(dy, y, fma(dx, x, origin)), integer x and y. */
typedef struct Plane {
    float origin, dx, dy;
} Plane;

typedef struct Edge {
    int64_t a, b, c; /* inside: c + 256·(b·y − a·x) > 0 */
} Edge;

typedef struct Setup {
    const Vertex *corner[3]; /* reordered so that the snapped area is positive */
    PixelRect box;
    Edge edge[3];
    bool front;
    float dx01, dy01, dx20, dy20; /* differences over the doubled area */
    float x_origin, y_origin;
    Plane depth;
} Setup;

/* Sign of the snapped area: counter-clockwise in window space is front; flipped changes sides. */
Facing setup_facing(const Vertex *const corners[3], bool flipped);

/* Pixels that can be covered, inside width×height, by a triangle that is not wide; empty when
 * x0 > x1 or y0 > y1. */
PixelRect setup_bounds(const Vertex *const corners[3], int width, int height);

enum {
    /* Of an edge, in 1/256 pixel: no viewport is larger. */
    SETUP_STEP_MAX = SIZE_MAX_PIXELS * 256
};

static inline bool setup_step_is_wide(int64_t step)
{
    return step > SETUP_STEP_MAX || step < -SETUP_STEP_MAX;
}

/* Whether an edge is longer than that, in x or y. What the clipper leaves lies within the viewport
 * but where w is next to 0, and rounding puts a corner anywhere. */
bool setup_is_wide(const Vertex *const corners[3]);

/* Of two snapped coordinates, wrapping as the driver does: a vertex with w = 0 snaps to INT32_MIN.
 * Those of clipped vertices lie within the viewport, and every product here fits. Where it does
 * not, values of edges wrap, too, and wide.h says what is covered. */
static inline int32_t setup_difference(int32_t a, int32_t b)
{
    return (int32_t)((uint32_t)a - (uint32_t)b);
}

static inline Edge setup_edge(const Vertex *from, const Vertex *to)
{
    int64_t a = setup_difference(from->y_fixed8, to->y_fixed8);
    int64_t b = setup_difference(from->x_fixed8, to->x_fixed8);
    int64_t c = (int64_t)((uint64_t)(a * from->x_fixed8) - (uint64_t)(b * from->y_fixed8));
    if (a < 0 || (a == 0 && b >= 0))
        c++;
    return (Edge){a, b, c};
}

/* Edge.c + 256·(b·y − a·x), as an int64_t: above 0 where pixel (x, y) is inside. */
static inline uint64_t setup_edge_at(const Edge *edge, int x, int y)
{
    uint64_t steps = (uint64_t)edge->b * (uint64_t)y - (uint64_t)edge->a * (uint64_t)x;
    return (uint64_t)edge->c + 256 * steps;
}

/* The plane through the values p[i] at setup->corner[i]. */
static inline Plane setup_plane(const Setup *setup, float p0, float p1, float p2)
{
    float d01 = op_sub(p0, p1), d20 = op_sub(p2, p0);
    Plane plane;
    plane.dx = op_sub(op_mul(d01, setup->dy20), op_mul(d20, setup->dy01));
    plane.dy = op_sub(op_mul(d20, setup->dx01), op_mul(d01, setup->dx20));
    plane.origin =
        op_sub(p0, op_add(op_mul(plane.dx, setup->x_origin), op_mul(plane.dy, setup->y_origin)));
    return plane;
}

/* For a triangle whose facing is not FACING_NONE. swap: its snapped area is negative. box:
 * setup_bounds, or wide_bounds of it. */
static inline void setup_make(const Vertex *const corners[3], bool swap, bool flipped,
                              PixelRect box, Setup *out)
{
    const Vertex *v0 = corners[swap ? 1 : 0], *v1 = corners[swap ? 0 : 1], *v2 = corners[2];
    out->corner[0] = v0;
    out->corner[1] = v1;
    out->corner[2] = v2;
    out->front = swap != flipped;
    out->box = box;
    for (int i = 0; i < 3; i++)
        out->edge[i] = setup_edge(out->corner[i], out->corner[(i + 1) % 3]);

    float dx01 = op_sub(v0->window[0], v1->window[0]), dy01 = op_sub(v0->window[1], v1->window[1]);
    float dx20 = op_sub(v2->window[0], v0->window[0]), dy20 = op_sub(v2->window[1], v0->window[1]);
    float inverse_area = op_div(1.0f, op_sub(op_mul(dx01, dy20), op_mul(dy01, dx20)));
    out->dx01 = op_mul(dx01, inverse_area);
    out->dy01 = op_mul(dy01, inverse_area);
    out->dx20 = op_mul(dx20, inverse_area);
    out->dy20 = op_mul(dy20, inverse_area);
    out->x_origin = op_sub(v0->window[0], 0.5f);
    out->y_origin = op_sub(v0->window[1], 0.5f);
    out->depth = setup_plane(out, v0->window[2], v1->window[2], v2->window[2]);
}

/* The same from the corners alone. */
void setup_triangle(const Vertex *const corners[3], bool flipped, int width, int height,
                    Setup *out);

static inline float plane_at(bool fused, const Plane *plane, int x, int y)
{
    return op_muladd(fused, plane->dy, (float)y,
                     op_muladd(fused, plane->dx, (float)x, plane->origin));
}

/* gl_FragCoord.z: the driver adds a polygon offset of +0, so that −0 becomes +0. */
static inline float setup_depth_at(bool fused, const Setup *setup, int x, int y)
{
    return op_add(plane_at(fused, &setup->depth, x, y), 0.0f);
}

/* setup_is_wide, of its corners. */
static inline bool setup_needs_wide(const Setup *setup)
{
    bool wide = false;
    for (int i = 0; i < 3; i++)
        wide |= setup_step_is_wide(setup->edge[i].a) || setup_step_is_wide(setup->edge[i].b);
    return wide;
}

typedef void (*SetupVisit)(void *context, const Setup *setup, int x, int y);

/* setup_visit of a wide triangle; rect is within its box. */
void setup_visit_wide(const Setup *setup, PixelRect rect, SetupVisit visit, void *context);

/* Calls visit for every covered pixel inside rect, row by row. Inlined into its caller, and visit
 * with it when it is a known function. */
static inline __attribute__((always_inline)) void setup_visit(const Setup *setup, PixelRect rect,
                                                              SetupVisit visit, void *context)
{
    int x0 = setup->box.x0 > rect.x0 ? setup->box.x0 : rect.x0;
    int y0 = setup->box.y0 > rect.y0 ? setup->box.y0 : rect.y0;
    int x1 = setup->box.x1 < rect.x1 ? setup->box.x1 : rect.x1;
    int y1 = setup->box.y1 < rect.y1 ? setup->box.y1 : rect.y1;
    if (setup_needs_wide(setup)) {
        PixelRect part = {(int16_t)x0, (int16_t)y0, (int16_t)x1, (int16_t)y1};
        setup_visit_wide(setup, part, visit, context);
        return;
    }
    const Edge *e = setup->edge;
    for (int y = y0; y <= y1; y++) {
        uint64_t value[3];
        for (int i = 0; i < 3; i++)
            value[i] = setup_edge_at(&e[i], x0, y);
        for (int x = x0; x <= x1; x++) {
            if ((int64_t)value[0] > 0 && (int64_t)value[1] > 0 && (int64_t)value[2] > 0)
                visit(context, setup, x, y);
            for (int i = 0; i < 3; i++)
                value[i] -= 256 * (uint64_t)e[i].a;
        }
    }
}

#endif

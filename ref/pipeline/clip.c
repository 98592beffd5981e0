#include "ref/pipeline/geometry.h"

#include "number/op.h"

Viewport viewport_make(int width, int height, DepthRange range, bool fused)
{
    bool half_depth = range != DEPTH_RANGE_GL;
    float half_width = 0.5f * (float)width, half_height = 0.5f * (float)height;
    return (Viewport){
        .scale = {half_width, half_height, half_depth ? 1.0f : 0.5f},
        .translate = {half_width, half_height, half_depth ? 0.0f : 0.5f},
        .fused = fused,
        .half_depth = half_depth,
    };
}

void viewport_transform(const Viewport *viewport, bool cut, Vertex *vertex)
{
    float inverse_w = op_div(1.0f, vertex->clip[3]);
    for (int i = 0; i < 3; i++)
        vertex->window[i] = op_muladd(viewport->fused && !cut, op_mul(vertex->clip[i], inverse_w),
                                      viewport->scale[i], viewport->translate[i]);
    vertex->window[3] = inverse_w;
    vertex->x_fixed8 = op_round_to_int(op_mul(op_sub(vertex->window[0], 0.5f), 256.0f));
    vertex->y_fixed8 = op_round_to_int(op_mul(op_sub(vertex->window[1], 0.5f), 256.0f));
}

unsigned clip_outcode(const Viewport *viewport, const Vertex *vertex)
{
    float x = vertex->clip[0], y = vertex->clip[1], z = vertex->clip[2], w = vertex->clip[3];
    unsigned outcode = 0;
    /* Negated, so that NaN is outside. */
    outcode |= !(x <= w) ? 1u : 0;
    outcode |= !(op_add(x, w) >= 0.0f) ? 2u : 0;
    outcode |= !(y <= w) ? 4u : 0;
    outcode |= !(op_add(y, w) >= 0.0f) ? 8u : 0;
    outcode |= !((viewport->half_depth ? z : op_add(z, w)) >= 0.0f) ? 16u : 0;
    outcode |= !(z <= w) ? 32u : 0;
    return outcode;
}

/* ((p0·x + p1·y) + p2·z) + p3·w with the plane's zeros and ones multiplied out. */
static float plane_distance(const Viewport *viewport, const Vertex *vertex, int plane)
{
    static const float planes[CLIP_PLANES][4] = {
        {-1, 0, 0, 1}, {1, 0, 0, 1}, {0, -1, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {0, 0, -1, 1},
    };
    static const float near_half[4] = {0, 0, 1, 0};
    const float *p = plane == 4 && viewport->half_depth ? near_half : planes[plane];
    const float *c = vertex->clip;
    return op_add(op_add(op_add(op_mul(c[0], p[0]), op_mul(c[1], p[1])), op_mul(c[2], p[2])),
                  op_mul(c[3], p[3]));
}

/* from + t·(to − from) for the clip position and every varying. */
static Vertex cut_edge(const Viewport *viewport, float t, const Vertex *from, const Vertex *to)
{
    Vertex cut = {.outcode = 0};
    for (int i = 0; i < 4; i++)
        cut.clip[i] = op_add(from->clip[i], op_mul(t, op_sub(to->clip[i], from->clip[i])));
    for (int i = 0; i < VARYINGS; i++)
        cut.varying[i] =
            op_add(from->varying[i], op_mul(t, op_sub(to->varying[i], from->varying[i])));
    viewport_transform(viewport, true, &cut);
    return cut;
}

/* The point where the edge from `previous` (distance dp) to `current` (distance d) crosses: the
 * parameter runs from the vertex whose distance is smaller, to lose fewer digits. */
static Vertex cross(const Viewport *viewport, const Vertex *previous, float dp,
                    const Vertex *current, float d)
{
    float difference = op_sub(d, dp);
    bool from_current = d < 0.0f ? -d < dp : !(-dp < d);
    if (from_current)
        return cut_edge(viewport, op_div(d, difference), current, previous);
    return cut_edge(viewport, op_div(-dp, difference), previous, current);
}

typedef struct Polygon {
    int count;
    ClipVertex vertices[CLIP_VERTICES_MAX];
} Polygon;

static const Vertex *resolve(const Vertex *const triangle[3], const ClipVertex *vertex)
{
    return vertex->source < 0 ? &vertex->fresh : triangle[vertex->source];
}

/* False when a distance is not finite: the driver drops the triangle. */
static bool clip_plane(const Viewport *viewport, const Vertex *const triangle[3], int plane,
                       const Polygon *in, Polygon *out)
{
    out->count = 0;
    const ClipVertex *previous = &in->vertices[0];
    float dp = plane_distance(viewport, resolve(triangle, previous), plane);
    if (!isfinite(dp))
        return false;
    for (int i = 1; i <= in->count; i++) {
        const ClipVertex *current = &in->vertices[i % in->count];
        float d = plane_distance(viewport, resolve(triangle, current), plane);
        if (!isfinite(d))
            return false;
        if (dp >= 0.0f)
            out->vertices[out->count++] = *previous;
        if ((dp >= 0.0f) != (d >= 0.0f)) {
            ClipVertex *fresh = &out->vertices[out->count++];
            fresh->source = -1;
            fresh->fresh =
                cross(viewport, resolve(triangle, previous), dp, resolve(triangle, current), d);
        }
        previous = current;
        dp = d;
    }
    return true;
}

int clip_triangle(const Viewport *viewport, const Vertex *const triangle[3], unsigned planes,
                  ClipVertex out[CLIP_VERTICES_MAX])
{
    Polygon a = {.count = 3}, b;
    for (int i = 0; i < 3; i++)
        a.vertices[i].source = i;
    Polygon *current = &a, *next = &b;
    for (int plane = 0; plane < CLIP_PLANES && current->count >= 3; plane++) {
        if (!(planes >> plane & 1))
            continue;
        if (!clip_plane(viewport, triangle, plane, current, next))
            return 0;
        Polygon *swapped = current;
        current = next;
        next = swapped;
    }
    if (current->count < 3)
        return 0;
    memcpy(out, current->vertices, (size_t)current->count * sizeof *out);
    return current->count;
}

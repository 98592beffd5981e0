#include "ref/truth/single.h"

#include <string.h>

enum {
    PLANES = 6
};
#define U BOUNDED_SINGLE

/* ---- vertices -------------------------------------------------------------------------------- */

SingleViewport single_viewport(const View *view, bool fused)
{
    bool half = view->depth_range != DEPTH_RANGE_GL;
    double width = 0.5 * view->width, height = 0.5 * view->height;
    return (SingleViewport){{width, height, half ? 1.0 : 0.5},
                            {width, height, half ? 0.0 : 0.5},
                            .half_depth = half,
                            .fused = fused};
}

/* mat·(v, 1) as the pipeline sums it: from the first column. rows of columns of `stride`. */
static void transform(const float *m, int stride, const Bounded v[3], bool point, int rows,
                      Bounded *out)
{
    for (int r = 0; r < rows; r++) {
        Bounded sum = bounded_mul(bounded_of(m[r]), v[0]);
        for (int column = 1; column < 3; column++)
            sum = bounded_add(sum, bounded_mul(bounded_of(m[stride * column + r]), v[column]));
        out[r] = point ? bounded_add(sum, bounded_of(m[stride * 3 + r])) : sum;
    }
}

void single_vertex(const View *view, const Draw *draw, const float position[3],
                   const float normal[3], const float *uv, SingleVertex *out)
{
    Bounded p[3], n[3], all[SINGLE_COMPONENTS];
    for (int i = 0; i < 3; i++) {
        p[i] = bounded_of(position[i]);
        n[i] = bounded_of(normal[i]);
    }
    transform(draw->model_view, 4, p, true, 3, &all[SINGLE_POSITION]);
    transform(view->projection, 4, &all[SINGLE_POSITION], true, 4, &all[SINGLE_CLIP]);
    transform(draw->normal_matrix, 3, n, false, 3, &all[SINGLE_NORMAL]);
    for (int i = 0; i < 2; i++)
        all[SINGLE_UV + i] = bounded_of(uv ? (double)uv[i] : 0.0);
    out->cut = false;
    for (int i = 0; i < SINGLE_COMPONENTS; i++) {
        out->value[i] = all[i].value;
        out->dev[i] = all[i].exact + all[i].single;
        out->spread[i] = all[i].exact;
    }
}

/* ---- clipping -------------------------------------------------------------------------------- */

typedef struct Distance {
    double value, error;
} Distance;

/* To plane x ≤ w, x ≥ −w, y ≤ w, y ≥ −w, z ≥ −w (or z ≥ 0), z ≤ w: one sum, rounded. */
static Distance plane_distance(const SingleViewport *viewport, const SingleVertex *v, int plane)
{
    int axis = plane / 2;
    double sign = plane == 5 || plane == 0 || plane == 2 ? -1.0 : 1.0;
    bool alone = plane == 4 && viewport->half_depth;
    Distance d = {sign * v->value[axis], v->dev[axis] + v->spread[axis]};
    if (!alone) {
        d.value += v->value[3];
        d.error += v->dev[3] + v->spread[3];
    }
    d.error = bounded_limit((d.error + 2.0 * U * (fabs(d.value) + d.error) + BOUNDED_TINY) *
                            BOUNDED_SLACK);
    return d;
}

/* How the decisions that rounding may take are taken, and how many there were. */
typedef struct Choices {
    unsigned bits;
    int count;
} Choices;

static bool is_inside(Distance d, Choices *choices)
{
    if (fabs(d.value) > d.error)
        return d.value > 0.0;
    bool chosen = choices->count < 32 && choices->bits >> choices->count & 1;
    choices->count++;
    return chosen;
}

/* Where the edge from previous (at distance dp) to current (at d) crosses the plane. The parameter
 * runs from the nearer of the two; it is not an error of the new vertex, only a place on the edge:
 * that all components are cut at the same one is what keeps the plane. */
static void cut_edge(const SingleVertex *previous, Distance dp, const SingleVertex *current,
                     Distance d, SingleVertex *out)
{
    bool from_current = fabs(d.value) < fabs(dp.value);
    const SingleVertex *from = from_current ? current : previous;
    const SingleVertex *to = from_current ? previous : current;
    Distance near = from_current ? d : dp;
    double whole = fabs(d.value - dp.value);
    /* Where rounding may take the other end for the nearer one, the place may be any. */
    bool sure = fabs(fabs(d.value) - fabs(dp.value)) > d.error + dp.error;
    double most = sure ? 0.5 + 0x1p-20 : 1.0;
    double t = whole > 0.0 ? fabs(near.value) / whole : 0.0;
    t = t < 0.5 ? t : 0.5;
    double t_error =
        bounded_quotient_error(t, near.error, whole,
                               d.error + dp.error + 2.0 * U * (whole + d.error + dp.error)) +
        4.0 * U;
    t_error = t_error < most ? t_error : most; /* NaN becomes most */
    double t_most = t + t_error < most ? t + t_error : most;
    out->cut = true;
    for (int i = 0; i < SINGLE_COMPONENTS; i++) {
        double a = from->value[i], b = to->value[i];
        double dev = from->dev[i] > to->dev[i] ? from->dev[i] : to->dev[i];
        double spread = from->spread[i] > to->spread[i] ? from->spread[i] : to->spread[i];
        double difference = fabs(b - a) + 2.0 * (dev + spread);
        double size = fabs(a) + dev + spread + t_most * difference;
        out->value[i] = a + t * (b - a);
        out->dev[i] = bounded_limit(
            (dev + U * (2.001 * t_most * difference + 1.001 * size) + 3.0 * BOUNDED_TINY) *
            BOUNDED_SLACK);
        out->spread[i] = bounded_limit(
            (spread + t_error * difference + 4.0 * BOUNDED_DOUBLE * size) * BOUNDED_SLACK);
    }
}

/* inside: of the polygon's corners. False where choices that no polygon has make too many. */
static bool clip_plane(const SingleViewport *viewport, int plane, const bool inside[],
                       const SinglePolygon *in, SinglePolygon *out)
{
    out->count = 0;
    for (int i = 0; i < in->count; i++) {
        int next = (i + 1) % in->count;
        const SingleVertex *previous = &in->corner[i], *current = &in->corner[next];
        if (out->count + 2 > SINGLE_CORNERS_MAX)
            return false;
        if (inside[i])
            out->corner[out->count++] = *previous;
        if (inside[i] != inside[next])
            cut_edge(previous, plane_distance(viewport, previous, plane), current,
                     plane_distance(viewport, current, plane), &out->corner[out->count++]);
    }
    return true;
}

int single_clip(const SingleViewport *viewport, const SingleVertex triangle[3], unsigned choices,
                SinglePolygon *out)
{
    Choices taken = {choices, 0};
    bool original[PLANES][3], used[PLANES] = {false};
    SinglePolygon other;
    out->count = 3;
    out->whole = true;
    memcpy(out->corner, triangle, 3 * sizeof *triangle);
    /* Only planes that a corner of the triangle fails are clipped against, and corners keep the
     * side that they had then. */
    for (int plane = 0; plane < PLANES; plane++)
        for (int i = 0; i < 3; i++) {
            original[plane][i] = is_inside(plane_distance(viewport, &triangle[i], plane), &taken);
            used[plane] |= !original[plane][i];
        }
    SinglePolygon *current = out, *next = &other;
    int source[SINGLE_CORNERS_MAX] = {0, 1, 2};
    for (int plane = 0; plane < PLANES && current->count >= 3; plane++) {
        bool inside[SINGLE_CORNERS_MAX];
        if (!used[plane])
            continue;
        out->whole = other.whole = false;
        for (int i = 0; i < current->count; i++)
            inside[i] =
                source[i] >= 0
                    ? original[plane][source[i]]
                    : is_inside(plane_distance(viewport, &current->corner[i], plane), &taken);
        if (!clip_plane(viewport, plane, inside, current, next))
            return SINGLE_DECISIONS_MAX + 1;
        int kept[SINGLE_CORNERS_MAX], count = 0;
        for (int i = 0; i < current->count; i++) {
            if (inside[i])
                kept[count++] = source[i];
            if (inside[i] != inside[(i + 1) % current->count])
                kept[count++] = -1;
        }
        memcpy(source, kept, (size_t)count * sizeof *kept);
        SinglePolygon *swapped = current;
        current = next;
        next = swapped;
    }
    if (current->count < 3)
        current->count = 0;
    if (current != out)
        *out = *current;
    return taken.count;
}

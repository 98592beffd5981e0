#include "ref/truth/bound.h"

#include <math.h>

#define ROUNDING EXACT_ROUNDING

/* Below it, underflow could matter. */
#define DETERMINANT_MIN 0x1p-900
#define UNDERFLOW       0x1p-100

/* A corner's coordinate relative to the pixel, over a range of pixels. */
typedef struct Relative {
    double first; /* at the range's start */
    double size;  /* greatest */
    double error;
} Relative;

static Relative relative(double x, double w, double x_error, double w_error, int low, int high)
{
    double end = (double)high + 0.5;
    double first = x - ((double)low + 0.5) * w, last = x - end * w;
    double size = fmax(fabs(first), fabs(last));
    return (Relative){first, size,
                      x_error + end * (w_error + ROUNDING * fabs(w)) + ROUNDING * size};
}

/* Of a·b, each factor known to within its error. */
static double product_error(const Relative *a, const Relative *b)
{
    return a->size * b->error + a->error * (b->size + b->error) + 2 * ROUNDING * a->size * b->size;
}

static void bound_determinant(const SoupVertex *const vertices[3], const double edge[3], Bound *out)
{
    double sum = 0.0, error = 0.0;
    for (int i = 0; i < 3; i++) {
        double w = vertices[i]->corner.w, size = fabs(edge[i]) + out->edge[i];
        sum += edge[i] * w;
        error +=
            out->edge[i] * fabs(w) + size * vertices[i]->error.w + 4 * ROUNDING * fabs(edge[i] * w);
    }
    double low = fabs(sum) / EXACT_SLACK - error * EXACT_SLACK;
    out->clockwise = sum < 0.0;
    out->determinant = low >= DETERMINANT_MIN && isfinite(low) ? low : -1.0;
}

/* Both coordinates' error after the division by w. */
static double window_error(const SoupVertex *vertex)
{
    const Corner *corner = &vertex->corner, *error = &vertex->error;
    double low = corner->w - error->w;
    if (!(low > 0.5 * corner->w))
        return INFINITY;
    double size = fmax(fabs(corner->x), fabs(corner->y)) / corner->w;
    return (fmax(error->x, error->y) + size * error->w) / low * EXACT_SLACK +
           4 * ROUNDING * (size + 1.0);
}

void bound_setup(const SoupVertex *const vertices[3], BoundRect rect, Bound *out)
{
    Relative x[3], y[3];
    out->snapping_error = 0.0;
    for (int i = 0; i < 3; i++) {
        const Corner *corner = &vertices[i]->corner, *error = &vertices[i]->error;
        x[i] = relative(corner->x, corner->w, error->x, error->w, rect.x_low, rect.x_high);
        y[i] = relative(corner->y, corner->w, error->y, error->w, rect.y_low, rect.y_high);
        out->w[i] = corner->w;
        out->q[i] = corner->z + corner->w;
        out->q_error[i] = error->z + error->w + ROUNDING * fabs(out->q[i]) + 0x1p-1074;
        out->d_error[i] = 2 * (error->w + ROUNDING * fabs(corner->w));
        out->snapping_error = fmax(out->snapping_error, window_error(vertices[i]));
    }
    double edge[3];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        edge[i] = x[j].first * y[k].first - x[k].first * y[j].first;
        out->edge[i] = (product_error(&x[j], &y[k]) + product_error(&x[k], &y[j])) * EXACT_SLACK;
    }
    bound_determinant(vertices, edge, out);
}

Verdict bound_has_depth(const Bound *bound, const ExactPoint *point)
{
    double sum = 0.0, error = 0.0;
    for (int i = 0; i < 3; i++) {
        sum += point->edge[i];
        error += bound->edge[i] + 2 * ROUNDING * fabs(point->edge[i]);
    }
    if (!(fabs(sum) > error * EXACT_SLACK) || bound->determinant < 0.0)
        return VERDICT_UNSURE;
    return (sum < 0.0) == bound->clockwise ? VERDICT_YES : VERDICT_NO;
}

/* Whether edges are certainly not all of one sign: outside, whatever the orientation. */
static bool edges_disagree(const Bound *bound, const ExactPoint *point)
{
    bool positive = false, negative = false;
    for (int i = 0; i < 3; i++) {
        positive |= point->edge[i] > bound->edge[i];
        negative |= point->edge[i] < -bound->edge[i];
    }
    return positive && negative;
}

Verdict bound_inside(const Bound *bound, const ExactPoint *point)
{
    if (edges_disagree(bound, point))
        return VERDICT_NO;
    Verdict verdict = bound_has_depth(bound, point);
    if (verdict != VERDICT_YES)
        return verdict;
    for (int i = 0; i < 3; i++) {
        double edge = bound->clockwise ? -point->edge[i] : point->edge[i];
        if (edge < -bound->edge[i])
            return VERDICT_NO;
        if (!(edge > bound->edge[i]))
            verdict = VERDICT_UNSURE;
    }
    double error = bound_depth(bound, point);
    if (point->plane < -error || point->plane - 1.0 > error)
        return VERDICT_NO;
    return point->plane > error && 1.0 - point->plane > error ? verdict : VERDICT_UNSURE;
}

double bound_depth(const Bound *bound, const ExactPoint *point)
{
    if (bound->determinant < 0.0)
        return INFINITY;
    double d = point->plane, sum = 0.0, error = 0.0;
    for (int i = 0; i < 3; i++) {
        double edge = point->edge[i], size = fabs(edge) + bound->edge[i];
        double r = bound->q[i] - 2 * d * bound->w[i];
        sum += edge * r;
        error += fabs(r) * (bound->edge[i] + 6 * ROUNDING * size) +
                 size * (bound->q_error[i] + fabs(d) * bound->d_error[i]);
    }
    return (fabs(sum) + error) / (2 * bound->determinant) * EXACT_SLACK + UNDERFLOW;
}

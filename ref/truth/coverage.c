#include "ref/truth/coverage.h"

#include <math.h>
#include <stddef.h>

enum {
    SUBPIXELS = 256,
    PLANES = 6,
    NEW = -1
};

/* Range of the integers below: clipping leaves window coordinates in 0 … 16384 = 2^14 (snap clamps
 * what rounding adds), snapped ones are below 2^22, products of two below 2^45, and an edge
 * function at a pixel of the viewport below 2^48: far inside int64. */

typedef struct Polygon {
    Corner corners[COVERAGE_CORNERS_MAX];
    int vertex[COVERAGE_CORNERS_MAX]; /* of the triangle; NEW where clipping made the corner */
    int count;
} Polygon;

static void push(Polygon *polygon, Corner corner, int vertex)
{
    if (polygon->count == COVERAGE_CORNERS_MAX)
        return;
    polygon->vertex[polygon->count] = vertex;
    polygon->corners[polygon->count++] = corner;
}

/* Not negative inside. Order as the pipeline's clipper: right, left, top, bottom, near, far. */
static double plane_distance(int plane, const Corner *corner, int width, int height)
{
    switch (plane) {
    case 0:
        return width * corner->w - corner->x;
    case 1:
        return corner->x;
    case 2:
        return height * corner->w - corner->y;
    case 3:
        return corner->y;
    case 4:
        return corner->w + corner->z;
    default:
        return corner->w - corner->z;
    }
}

/* Where the edge crosses the plane. Always computed from the inner corner to the outer one, so
 * that both triangles at an edge find the same point. */
static Corner crossing(const Corner *inner, const Corner *outer, double d_inner, double d_outer)
{
    double t = d_inner / (d_inner - d_outer);
    return (Corner){inner->x + t * (outer->x - inner->x), inner->y + t * (outer->y - inner->y),
                    inner->z + t * (outer->z - inner->z), inner->w + t * (outer->w - inner->w)};
}

/* Source: Sutherland, Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974. */
static void clip_by(int plane, int width, int height, Polygon *polygon)
{
    Polygon in = *polygon;
    polygon->count = 0;
    for (int i = 0; i < in.count; i++) {
        const Corner *previous = &in.corners[(i + in.count - 1) % in.count];
        const Corner *current = &in.corners[i];
        double d_previous = plane_distance(plane, previous, width, height);
        double d_current = plane_distance(plane, current, width, height);
        bool was_inside = d_previous >= 0.0, is_inside = d_current >= 0.0;
        if (was_inside && !is_inside)
            push(polygon, crossing(previous, current, d_previous, d_current), NEW);
        if (!was_inside && is_inside)
            push(polygon, crossing(current, previous, d_current, d_previous), NEW);
        if (is_inside)
            push(polygon, *current, in.vertex[i]);
    }
}

/* Fills polygon with what is inside the view volume; *whole when that is all. False: nothing. */
static bool clip(const Corner *const corners[3], int width, int height, Polygon *polygon,
                 bool *whole)
{
    unsigned any = 0, all = ~0u;
    polygon->count = 0;
    for (int i = 0; i < 3; i++) {
        const Corner *corner = corners[i];
        unsigned outside = 0;
        for (int plane = 0; plane < PLANES; plane++) {
            double d = plane_distance(plane, corner, width, height);
            if (!isfinite(d))
                return false;
            outside |= (d < 0.0 ? 1u : 0u) << plane;
        }
        any |= outside;
        all &= outside;
        push(polygon, *corner, i);
    }
    *whole = any == 0;
    if (all != 0)
        return false;
    for (int plane = 0; plane < PLANES && polygon->count >= 3; plane++)
        if (any >> plane & 1)
            clip_by(plane, width, height, polygon);
    return polygon->count >= 3;
}

/* Nearest integer, ties to even, for |x| < 2^51: the sum's unit is 1. */
static double round_even(double x)
{
    return (x + 0x1.8p52) - 0x1.8p52;
}

/* A coordinate in subpixels to an integer one in the viewport, whose side is size pixels. */
static int64_t snap(double subpixel, int size)
{
    double low = -SUBPIXELS / 2.0, high = (double)size * SUBPIXELS - SUBPIXELS / 2.0;
    subpixel = subpixel > low ? subpixel : low;
    subpixel = subpixel < high ? subpixel : high;
    return (int64_t)round_even(subpixel);
}

/* Edge functions of a snapped triangle. The fill rule is the pipeline's: an edge owns the pixels
 * on it when its function grows to the right, or straight up; integers then make that a + 1. */
static CoveragePiece piece_setup(const int64_t x[3], const int64_t y[3])
{
    int64_t area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    CoveragePiece piece = {.clockwise = area < 0, .empty = area == 0};
    int64_t sign = area < 0 ? -1 : 1;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        int64_t per_x = sign * (y[i] - y[j]);
        int64_t per_y = sign * (x[j] - x[i]);
        bool owns = per_x > 0 || (per_x == 0 && per_y >= 0);
        piece.a[i] = per_x * SUBPIXELS;
        piece.b[i] = per_y * SUBPIXELS;
        piece.c[i] = -(per_x * x[i] + per_y * y[i]) + (owns ? 1 : 0);
    }
    return piece;
}

static int64_t min64(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

static int64_t max64(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

/* First and last pixel whose centres lie in least … most (subpixels), one subpixel more at each
 * side, inside the viewport. */
static void pixel_range(int64_t least, int64_t most, int size, int *first, int *last)
{
    /* Shifted to be positive: division then rounds down. */
    int64_t from = (least - 1 + SUBPIXELS + SUBPIXELS - 1) / SUBPIXELS - 1;
    int64_t to = (most + 1 + SUBPIXELS) / SUBPIXELS - 1;
    *first = (int)max64(from, 0);
    *last = (int)min64(to, size - 1);
}

static void snap_corner(const Corner *corner, const Snap *known, int width, int height, int64_t *x,
                        int64_t *y)
{
    *x = snap(known ? known->x : (corner->x / corner->w - 0.5) * SUBPIXELS, width);
    *y = snap(known ? known->y : (corner->y / corner->w - 0.5) * SUBPIXELS, height);
}

bool coverage_setup(const Corner *const corners[3], int width, int height, Coverage *out)
{
    static const Snap unknown[3];
    return coverage_setup_snapped(corners, unknown, width, height, out);
}

bool coverage_setup_snapped(const Corner *const corners[3], const Snap snaps[3], int width,
                            int height, Coverage *out)
{
    Polygon polygon;
    if (!clip(corners, width, height, &polygon, &out->whole))
        return false;
    int64_t x[COVERAGE_CORNERS_MAX], y[COVERAGE_CORNERS_MAX];
    int64_t x_min = INT64_MAX, x_max = INT64_MIN, y_min = INT64_MAX, y_max = INT64_MIN;
    for (int i = 0; i < polygon.count; i++) {
        const Corner *corner = &polygon.corners[i];
        if (!(corner->w > 0.0)) /* the eye itself, under an unusual projection */
            return false;
        int vertex = polygon.vertex[i];
        const Snap *known = vertex != NEW && snaps[vertex].known ? &snaps[vertex] : NULL;
        snap_corner(corner, known, width, height, &x[i], &y[i]);
        x_min = min64(x_min, x[i]);
        x_max = max64(x_max, x[i]);
        y_min = min64(y_min, y[i]);
        y_max = max64(y_max, y[i]);
    }
    out->piece_count = 0;
    for (int i = 2; i < polygon.count; i++) {
        const int64_t piece_x[3] = {x[i - 1], x[i], x[0]}, piece_y[3] = {y[i - 1], y[i], y[0]};
        out->pieces[out->piece_count++] = piece_setup(piece_x, piece_y);
    }
    /* Corners move by at most half a subpixel along each axis; an edge function at a point of the
     * bounds is a cross product of two differences, which changes by at most 3/2 · (width +
     * height) + 3. */
    out->slack = 2 * ((x_max - x_min) + (y_max - y_min)) + 4;
    pixel_range(x_min, x_max, width, &out->x_low, &out->x_high);
    pixel_range(y_min, y_max, height, &out->y_low, &out->y_high);
    return out->x_low <= out->x_high && out->y_low <= out->y_high;
}

/* The least of a piece's edge functions, as they decide coverage. */
static int64_t piece_least(const CoveragePiece *piece, int x, int y)
{
    int64_t e0 = piece->a[0] * x + piece->b[0] * y + piece->c[0];
    int64_t e1 = piece->a[1] * x + piece->b[1] * y + piece->c[1];
    int64_t e2 = piece->a[2] * x + piece->b[2] * y + piece->c[2];
    return min64(e0, min64(e1, e2));
}

CoverageAt coverage_at(const Coverage *coverage, int x, int y, bool *clockwise)
{
    if (coverage->whole) {
        const CoveragePiece *piece = &coverage->pieces[0];
        int64_t least = piece_least(piece, x, y);
        /* Twice the slack: snapping may have turned a sliver over, and its edge functions, which
         * add up to its area, then lie between −2 · slack and slack. */
        if (least < -2 * coverage->slack)
            return COVERAGE_OUTSIDE;
        if (least <= 0 || piece->empty)
            return COVERAGE_OUTSIDE_CLOSE;
        *clockwise = piece->clockwise;
        return least > coverage->slack ? COVERAGE_INSIDE : COVERAGE_INSIDE_CLOSE;
    }
    for (int i = 0; i < coverage->piece_count; i++) {
        const CoveragePiece *piece = &coverage->pieces[i];
        if (!piece->empty && piece_least(piece, x, y) > 0) {
            *clockwise = piece->clockwise;
            return COVERAGE_INSIDE_CLOSE;
        }
    }
    return COVERAGE_OUTSIDE_CLOSE;
}

bool coverage_misses(const Coverage *coverage, int x_low, int y_low, int x_high, int y_high)
{
    if (!coverage->whole)
        return false;
    const CoveragePiece *piece = &coverage->pieces[0];
    for (int i = 0; i < 3; i++) {
        int64_t greatest = piece->a[i] * (piece->a[i] > 0 ? x_high : x_low) +
                           piece->b[i] * (piece->b[i] > 0 ? y_high : y_low) + piece->c[i];
        if (greatest < -2 * coverage->slack)
            return true;
    }
    return false;
}

/* A triangle's edges and depth as exact numbers, in integers of any size (GMP).
 *
 * The input numbers are the mesh's floats and the view's float matrices (model_view, projection),
 * taken as exact. A corner is their exact product: view = model_view · (position, 1), clip =
 * projection · view, x and y in window space by the viewport, z mapped to −w … w from near to far.
 * Pixel (x, y)'s centre is (x + ½, y + ½). The fragment's depth is that of the plane through the
 * three corners at that centre, (z/w + 1)/2, clamped to [0, 1].
 *
 * The plane has a depth there where the triangle has an area as seen from the eye and the point of
 * the plane lies in front of the eye, w > 0. Where it has none, the double that exact_nearby_depth
 * gives counts, taken as an exact number (order.h).
 *
 * All numbers are dyadic: each triangle's corners are scaled by one power of two to integers, which
 * changes neither signs nor depths. With homogeneous edge functions (exact.h) and m = 2x + 1,
 * n = 2y + 1, edge i is eᵢ = aᵢm + bᵢn + cᵢ; the depth is Σ eᵢ(Zᵢ + Wᵢ) / 2D with D = Σ eᵢWᵢ, which
 * does not depend on the pixel.
 *
 * GMP ends the program when memory is exhausted; a plane's numbers take some kilobytes at most. */
#ifndef PEEL_REF_TRUTH_PLANE_H
#define PEEL_REF_TRUTH_PLANE_H

#include "ref/truth/soup.h"

#include <gmp.h>

/* A linear function of the pixel: a·m + b·n + c. */
typedef struct PlaneFunction {
    mpz_t a, b, c;
} PlaneFunction;

/* What is used while a plane is made, by plane_setup. */
typedef struct PlaneWork {
    mpz_t model_view[12], projection[16]; /* column-major, model_view without its last row */
    mpz_t position[4], view[4], clip[4];
    mpz_t x[3], y[3], q[3], w[3]; /* corners: twice the window's x · w and y · w, z + w, w */
} PlaneWork;

/* Signs are turned so that D is not negative. */
typedef struct Plane {
    PlaneFunction edge[3]; /* positive inside */
    PlaneFunction sum;     /* of the edges: positive where the point is in front of the eye */
    PlaneFunction numerator;
    mpz_t denominator; /* 2D; 0: the triangle has no area as seen from the eye */
    bool clockwise;    /* D was negative */
} Plane;

/* Both allocate; the second call frees. */
void plane_work_init(PlaneWork *work);
void plane_work_free(PlaneWork *work);
void plane_init(Plane *plane);
void plane_free(Plane *plane);

/* False when a position or a matrix has an infinity or NaN. */
bool plane_setup(const Soup *soup, uint32_t triangle, PlaneWork *work, Plane *out);

/* Pixel (x, y), y up, within 16384 × 16384. */
bool plane_has_depth(const Plane *plane, int x, int y, mpz_t scratch);
/* ExactPoint.inside, exactly. */
bool plane_inside(const Plane *plane, int x, int y, mpz_t scratch);
/* The depth as a fraction, clamped to [0, 1]; denominator > 0. Where the plane has a depth. */
void plane_depth(const Plane *plane, int x, int y, mpz_t numerator, mpz_t denominator);

#endif

#include "ref/truth/snap.h"

#include "ref/truth/depth_bound.h"
#include "ref/truth/plane.h"

#include <math.h>

enum {
    SUBPIXELS = 256
};

#define SUBPIXEL_MAX 0x1p29 /* in size; an int32_t has room */

/* subpixel to the nearest integer, ties to even; false where an error of that size could change it.
 * The sum's unit is 1. */
static bool round_certain(double subpixel, double error, int32_t *out)
{
    double rounded = (subpixel + 0x1.8p52) - 0x1.8p52;
    *out = (int32_t)rounded;
    return 0.5 - fabs(subpixel - rounded) > error;
}

/* (x/w − 1/2) · 256 to the nearest integer, ties to even, for twice_x = 2x; w > 0. */
static int32_t round_exact(const mpz_t twice_x, const mpz_t w)
{
    mpz_t number, rest, divisor;
    mpz_inits(number, rest, divisor, NULL);
    /* With n = 128 · (2x − w) the nearest integer is floor(n/w + 1/2) = floor((2n + w) / 2w). */
    mpz_sub(number, twice_x, w);
    mpz_mul_ui(number, number, SUBPIXELS);
    mpz_add(number, number, w);
    mpz_mul_2exp(divisor, w, 1);
    mpz_fdiv_qr(number, rest, number, divisor);
    if (mpz_sgn(rest) == 0 && mpz_odd_p(number))
        mpz_sub_ui(number, number, 1);
    int32_t rounded = (int32_t)mpz_get_si(number);
    mpz_clears(number, rest, divisor, NULL);
    return rounded;
}

/* For a window coordinate that a double puts well within range. */
static Snap snap_exact(const View *view, const Draw *draw, const float *position)
{
    Snap snap = {0, 0, false};
    PlaneWork work;
    plane_work_init(&work);
    if (plane_corner(view, draw, position, &work) && mpz_sgn(work.w[0]) > 0) {
        snap.x = round_exact(work.x[0], work.w[0]);
        snap.y = round_exact(work.y[0], work.w[0]);
        snap.known = true;
    }
    plane_work_free(&work);
    return snap;
}

Snap snap_vertex(const View *view, const Draw *draw, const float *position, const Corner *corner,
                 const Corner *error, bool *exact)
{
    Snap snap = {0, 0, false};
    *exact = false;
    double x = (corner->x / corner->w - 0.5) * SUBPIXELS;
    double y = (corner->y / corner->w - 0.5) * SUBPIXELS;
    double off = depth_bound_window(corner, error) * SUBPIXELS;
    /* Not NaN, not infinite, and in front of the eye for certain. */
    if (!(fabs(x) < SUBPIXEL_MAX && fabs(y) < SUBPIXEL_MAX && off < SUBPIXEL_MAX))
        return snap;
    bool x_certain = round_certain(x, off, &snap.x), y_certain = round_certain(y, off, &snap.y);
    snap.known = true;
    if (x_certain && y_certain)
        return snap;
    *exact = true;
    return snap_exact(view, draw, position);
}

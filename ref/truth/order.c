#include "ref/truth/order.h"

#include <assert.h>
#include <math.h>

/* ---- planes --------------------------------------------------------------------------------- */

static void allocate(Order *order)
{
    if (order->allocated)
        return;
    plane_work_init(&order->work);
    for (int i = 0; i < 2; i++)
        mpz_inits(order->numerator[i], order->denominator[i], order->product[i], NULL);
    order->allocated = true;
}

void order_free(Order *order)
{
    if (order->allocated) {
        plane_work_free(&order->work);
        for (int i = 0; i < 2; i++)
            mpz_clears(order->numerator[i], order->denominator[i], order->product[i], NULL);
    }
    for (int i = 0; i < ORDER_CACHE; i++) {
        if (order->planes[i].allocated)
            plane_free(&order->planes[i].plane);
        order->planes[i] = (OrderPlane){0};
    }
    order->allocated = false;
}

/* The next call may overwrite it. NULL for corners that are not finite. */
static const Plane *find_plane(Order *order, uint32_t triangle)
{
    allocate(order);
    OrderPlane *place = &order->planes[triangle % ORDER_CACHE];
    if (place->allocated && place->triangle == triangle)
        return place->known ? &place->plane : NULL;
    if (!place->allocated)
        plane_init(&place->plane);
    place->allocated = true;
    place->triangle = triangle;
    place->known = plane_setup(order->soup, triangle, &order->work, &place->plane);
    return place->known ? &place->plane : NULL;
}

/* ---- comparing ------------------------------------------------------------------------------ */

/* y up. */
static void find_pixel(const Order *order, const Fragment *fragment, int *x, int *y)
{
    *x = order->x + fragment->pixel % TRACE_TILE;
    *y = order->soup->view->height - 1 - (order->y + fragment->pixel / TRACE_TILE);
}

/* depth = numerator / denominator; depth is in [0, 1], so a multiple of 2^-1074. */
static void fraction_of_double(double depth, mpz_t numerator, mpz_t denominator)
{
    int exponent;
    double fraction = frexp(depth, &exponent);
    mpz_set_d(numerator, ldexp(fraction, 53));
    mpz_set_ui(denominator, 1);
    if (exponent < 53)
        mpz_mul_2exp(denominator, denominator, (mp_bitcnt_t)(53 - exponent));
}

static bool find_fraction(Order *order, const Fragment *fragment, int which)
{
    mpz_t *numerator = &order->numerator[which], *denominator = &order->denominator[which];
    if (fragment->is_fixed) {
        fraction_of_double(fragment->depth, *numerator, *denominator);
        return true;
    }
    const Plane *plane = find_plane(order, fragment->triangle);
    if (!plane)
        return false;
    int x, y;
    find_pixel(order, fragment, &x, &y);
    plane_depth(plane, x, y, *numerator, *denominator);
    return true;
}

static int compare_exact(Order *order, const Fragment *a, const Fragment *b)
{
    order->counts.exact_comparisons++;
    allocate(order);
    if (!find_fraction(order, a, 0) || !find_fraction(order, b, 1)) {
        assert(!"a fragment of a triangle with corners that are not finite");
        order->counts.undecided++;
        return (a->depth > b->depth) - (a->depth < b->depth);
    }
    mpz_mul(order->product[0], order->numerator[0], order->denominator[1]);
    mpz_mul(order->product[1], order->numerator[1], order->denominator[0]);
    return mpz_cmp(order->product[0], order->product[1]);
}

int order_compare(Order *order, const Fragment *a, const Fragment *b)
{
    order->counts.comparisons++;
    /* Rounding here is covered by what order_set_depth adds to the errors. */
    double difference = a->depth - b->depth, error = (double)a->error + b->error;
    if (!order->always_exact) {
        if (difference > error)
            return 1;
        if (-difference > error)
            return -1;
        if (error == 0.0)
            return 0;
    }
    return compare_exact(order, a, b);
}

int order_compare_all(Order *order, const Fragment *a, const Fragment *b, DepthFunc func)
{
    int depth = order_compare(order, a, b);
    if (depth != 0)
        return depth;
    int id = (a->triangle > b->triangle) - (a->triangle < b->triangle);
    return func == DEPTH_LEQUAL ? -id : id;
}

/* ---- depth and coverage --------------------------------------------------------------------- */

/* Not less than error. Depths are in [0, 1], so 1 always holds. */
static float round_up(double error)
{
    return error < 1.0 ? (float)error * (1.0f + 0x1p-20f) + 0x1p-100f : 1.0f;
}

void order_set_depth(Order *order, const Bound *bound, const Corner *const corners[3],
                     const ExactPoint *point, Fragment *fragment)
{
    int x, y;
    find_pixel(order, fragment, &x, &y);
    Verdict verdict = bound_has_depth(bound, point);
    if (verdict == VERDICT_UNSURE) {
        const Plane *plane = find_plane(order, fragment->triangle);
        verdict =
            plane && plane_has_depth(plane, x, y, order->product[0]) ? VERDICT_YES : VERDICT_NO;
        order->counts.exact_coverage++;
    }
    fragment->is_fixed = verdict == VERDICT_NO;
    fragment->error = 0.0f;
    if (fragment->is_fixed) {
        fragment->depth = exact_nearby_depth(corners, x, y);
        return;
    }
    double error = bound_depth(bound, point);
    fragment->depth = point->depth;
    if (point->plane < -error || point->plane - 1.0 > error)
        return; /* certainly clamped: 0 or 1 exactly */
    fragment->error = round_up(error);
}

bool order_inside(Order *order, const Bound *bound, const ExactPoint *point, uint32_t triangle,
                  int x, int y, bool *clockwise)
{
    Verdict verdict = bound_inside(bound, point);
    if (verdict != VERDICT_UNSURE) {
        *clockwise = bound->clockwise;
        return verdict == VERDICT_YES;
    }
    order->counts.exact_coverage++;
    const Plane *plane = find_plane(order, triangle);
    *clockwise = plane && plane->clockwise;
    return plane && plane_inside(plane, x, y, order->product[0]);
}

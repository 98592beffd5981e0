#include "ref/truth/plane.h"

#include <limits.h>
#include <string.h>

/* ---- allocation ----------------------------------------------------------------------------- */

static void init_all(mpz_t *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        mpz_init(numbers[i]);
}

static void free_all(mpz_t *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        mpz_clear(numbers[i]);
}

/* Both structs as arrays: PlaneWork is nothing but numbers. */
enum {
    WORK_NUMBERS = sizeof(PlaneWork) / sizeof(mpz_t)
};

void plane_work_init(PlaneWork *work)
{
    init_all((mpz_t *)work, WORK_NUMBERS);
}

void plane_work_free(PlaneWork *work)
{
    free_all((mpz_t *)work, WORK_NUMBERS);
}

static void function_init(PlaneFunction *function)
{
    mpz_inits(function->a, function->b, function->c, NULL);
}

static void function_free(PlaneFunction *function)
{
    mpz_clears(function->a, function->b, function->c, NULL);
}

void plane_init(Plane *plane)
{
    for (int i = 0; i < 3; i++)
        function_init(&plane->edge[i]);
    function_init(&plane->sum);
    function_init(&plane->numerator);
    mpz_init(plane->denominator);
    plane->clockwise = false;
}

void plane_free(Plane *plane)
{
    for (int i = 0; i < 3; i++)
        function_free(&plane->edge[i]);
    function_free(&plane->sum);
    function_free(&plane->numerator);
    mpz_clear(plane->denominator);
}

/* ---- floats as integers --------------------------------------------------------------------- */

/* value = mantissa · 2^exponent. False for infinity and NaN. By bits: whatever the thread does to
 * denormals. */
static bool split(float value, int32_t *mantissa, int *exponent)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    int biased = (int)(bits >> 23 & 0xff);
    int32_t fraction = (int32_t)(bits & 0x7fffff);
    if (biased == 0xff)
        return false;
    *mantissa = biased ? fraction | 0x800000 : fraction;
    *mantissa = bits >> 31 ? -*mantissa : *mantissa;
    *exponent = (biased ? biased : 1) - 150;
    return true;
}

/* Lowers *exponent to the least of those of count numbers that are not zero. */
static bool least_exponent(const float *values, size_t count, int *exponent)
{
    for (size_t i = 0; i < count; i++) {
        int32_t mantissa;
        int e;
        if (!split(values[i], &mantissa, &e))
            return false;
        if (mantissa != 0 && e < *exponent)
            *exponent = e;
    }
    return true;
}

/* value · 2^-exponent, an integer; value is finite. */
static void to_integer(float value, int exponent, mpz_t out)
{
    int32_t mantissa = 0;
    int e = 0;
    split(value, &mantissa, &e);
    mpz_set_si(out, mantissa);
    if (mantissa != 0)
        mpz_mul_2exp(out, out, (mp_bitcnt_t)(e - exponent));
}

static void power(int exponent, mpz_t out)
{
    mpz_set_ui(out, 1);
    mpz_mul_2exp(out, out, (mp_bitcnt_t)exponent);
}

/* ---- corners -------------------------------------------------------------------------------- */

typedef struct Exponents {
    int model_view, projection, position;
} Exponents;

/* out = matrix · in for `rows` rows of a column-major matrix. */
static void multiply(mpz_t *matrix, mpz_t in[4], int rows, mpz_t out[4])
{
    for (int row = 0; row < rows; row++) {
        mpz_set_ui(out[row], 0);
        for (int column = 0; column < 4; column++)
            if (mpz_sgn(matrix[rows * column + row]) != 0)
                mpz_addmul(out[row], matrix[rows * column + row], in[column]);
    }
}

static void set_corner(const View *view, const float *position, Exponents exponents, int corner,
                       PlaneWork *work)
{
    for (int i = 0; i < 3; i++)
        to_integer(position[i], exponents.position, work->position[i]);
    power(-exponents.position, work->position[3]);
    multiply(work->model_view, work->position, 3, work->view);
    power(-exponents.position - exponents.model_view, work->view[3]);
    multiply(work->projection, work->view, 4, work->clip);
    mpz_t *clip = work->clip;
    mpz_add(work->x[corner], clip[0], clip[3]);
    mpz_mul_si(work->x[corner], work->x[corner], view->width);
    mpz_add(work->y[corner], clip[1], clip[3]);
    mpz_mul_si(work->y[corner], work->y[corner], view->height);
    mpz_set(work->w[corner], clip[3]);
    /* z + w, after the other clip spaces are brought to −w … w. */
    mpz_t *q = &work->q[corner];
    switch (view->depth_range) {
    case DEPTH_RANGE_GL:
        mpz_add(*q, clip[2], clip[3]);
        break;
    case DEPTH_RANGE_ZERO_ONE:
        mpz_mul_2exp(*q, clip[2], 1);
        break;
    case DEPTH_RANGE_REVERSED:
        mpz_sub(*q, clip[3], clip[2]);
        mpz_mul_2exp(*q, *q, 1);
        break;
    }
}

/* Divides all corners' numbers by the greatest power of two that divides them. */
static void shorten(PlaneWork *work)
{
    mpz_t *groups[4] = {work->x, work->y, work->q, work->w};
    mp_bitcnt_t zeros = ULONG_MAX;
    for (int i = 0; i < 12; i++) {
        mpz_t *number = &groups[i / 3][i % 3];
        mp_bitcnt_t lowest = mpz_sgn(*number) != 0 ? mpz_scan1(*number, 0) : ULONG_MAX;
        zeros = lowest < zeros ? lowest : zeros;
    }
    if (zeros == 0 || zeros == ULONG_MAX)
        return;
    for (int i = 0; i < 12; i++)
        mpz_tdiv_q_2exp(groups[i / 3][i % 3], groups[i / 3][i % 3], zeros);
}

static bool set_corners(const Soup *soup, uint32_t triangle, PlaneWork *work)
{
    const SoupDraw *draw = soup_draw(soup, triangle);
    const float *model_view = draw->draw->model_view, *projection = soup->view->projection;
    const uint32_t *index = &draw->mesh->index[(size_t)(triangle - draw->first_triangle) * 3];
    Exponents exponents = {0, 0, 0};
    bool finite = least_exponent(projection, 16, &exponents.projection);
    for (int column = 0; column < 4; column++)
        finite = finite && least_exponent(&model_view[4 * column], 3, &exponents.model_view);
    for (int i = 0; i < 3; i++)
        finite = finite && least_exponent(&draw->mesh->position[3 * (size_t)index[i]], 3,
                                          &exponents.position);
    if (!finite)
        return false;
    for (int i = 0; i < 12; i++)
        to_integer(model_view[4 * (i / 3) + i % 3], exponents.model_view, work->model_view[i]);
    for (int i = 0; i < 16; i++)
        to_integer(projection[i], exponents.projection, work->projection[i]);
    for (int i = 0; i < 3; i++)
        set_corner(soup->view, &draw->mesh->position[3 * (size_t)index[i]], exponents, i, work);
    shorten(work);
    return true;
}

/* ---- the plane ------------------------------------------------------------------------------ */

static void cross(mpz_t a, mpz_t b, mpz_t c, mpz_t d, mpz_t out)
{
    mpz_mul(out, a, b);
    mpz_submul(out, c, d);
}

static void add_function(PlaneFunction *sum, PlaneFunction *term)
{
    mpz_add(sum->a, sum->a, term->a);
    mpz_add(sum->b, sum->b, term->b);
    mpz_add(sum->c, sum->c, term->c);
}

static void add_scaled(PlaneFunction *sum, PlaneFunction *term, mpz_t factor)
{
    mpz_addmul(sum->a, term->a, factor);
    mpz_addmul(sum->b, term->b, factor);
    mpz_addmul(sum->c, term->c, factor);
}

static void set_zero(PlaneFunction *function)
{
    mpz_set_ui(function->a, 0);
    mpz_set_ui(function->b, 0);
    mpz_set_ui(function->c, 0);
}

static void negate(PlaneFunction *function)
{
    mpz_neg(function->a, function->a);
    mpz_neg(function->b, function->b);
    mpz_neg(function->c, function->c);
}

bool plane_setup(const Soup *soup, uint32_t triangle, PlaneWork *work, Plane *out)
{
    if (!set_corners(soup, triangle, work))
        return false;
    set_zero(&out->sum);
    set_zero(&out->numerator);
    mpz_set_ui(out->denominator, 0);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        PlaneFunction *edge = &out->edge[i];
        cross(work->y[j], work->w[k], work->y[k], work->w[j], edge->a);
        cross(work->x[k], work->w[j], work->x[j], work->w[k], edge->b);
        cross(work->x[j], work->y[k], work->x[k], work->y[j], edge->c);
        add_function(&out->sum, edge);
        add_scaled(&out->numerator, edge, work->q[i]);
        /* The multiples of m and n add up to 0 in D. */
        mpz_addmul(out->denominator, edge->c, work->w[i]);
    }
    mpz_mul_2exp(out->denominator, out->denominator, 1);
    out->clockwise = mpz_sgn(out->denominator) < 0;
    if (out->clockwise) {
        for (int i = 0; i < 3; i++)
            negate(&out->edge[i]);
        negate(&out->sum);
        negate(&out->numerator);
        mpz_neg(out->denominator, out->denominator);
    }
    return true;
}

static void evaluate(const PlaneFunction *function, int x, int y, mpz_t out)
{
    mpz_set(out, function->c);
    mpz_addmul_ui(out, function->a, 2 * (unsigned long)x + 1);
    mpz_addmul_ui(out, function->b, 2 * (unsigned long)y + 1);
}

bool plane_has_depth(const Plane *plane, int x, int y, mpz_t scratch)
{
    if (mpz_sgn(plane->denominator) == 0)
        return false;
    evaluate(&plane->sum, x, y, scratch);
    return mpz_sgn(scratch) > 0;
}

/* Ties by the rule of exact.h. */
static bool edge_contains(const PlaneFunction *edge, int x, int y, mpz_t scratch)
{
    evaluate(edge, x, y, scratch);
    int side = mpz_sgn(scratch), per_x = mpz_sgn(edge->a), per_y = mpz_sgn(edge->b);
    return side > 0 || (side == 0 && (per_x > 0 || (per_x == 0 && per_y >= 0)));
}

bool plane_inside(const Plane *plane, int x, int y, mpz_t scratch)
{
    if (!plane_has_depth(plane, x, y, scratch))
        return false;
    for (int i = 0; i < 3; i++)
        if (!edge_contains(&plane->edge[i], x, y, scratch))
            return false;
    evaluate(&plane->numerator, x, y, scratch);
    return mpz_sgn(scratch) >= 0 && mpz_cmp(scratch, plane->denominator) <= 0;
}

void plane_depth(const Plane *plane, int x, int y, mpz_t numerator, mpz_t denominator)
{
    evaluate(&plane->numerator, x, y, numerator);
    mpz_set(denominator, plane->denominator);
    if (mpz_sgn(numerator) < 0)
        mpz_set_ui(numerator, 0);
    else if (mpz_cmp(numerator, denominator) > 0)
        mpz_set(numerator, denominator);
}

/* A triangle in the window as rational numbers, for the tests of ref/truth's bounds: another way
 * than ref/truth/plane.h's. Corners are divided by their w, and depth is linear over the window. */
#ifndef PEEL_TESTS_TRUTH_RATIONAL_H
#define PEEL_TESTS_TRUTH_RATIONAL_H

#include "frame/view.h"

#include <gmp.h>

/* A triangle's corners in the window: x, y and window depth, divided by w; and w. */
typedef struct Window {
    mpq_t x[3], y[3], z[3], w[3];
    bool usable; /* no w is 0 */
} Window;

enum {
    WINDOW_NUMBERS = 12
};

static inline void row_times_point(const float *matrix, int stride, int row, mpq_t point[4],
                                   mpq_t out)
{
    mpq_t factor;
    mpq_init(factor);
    mpq_set_ui(out, 0, 1);
    for (int column = 0; column < 4; column++) {
        mpq_set_d(factor, matrix[stride * column + row]);
        mpq_mul(factor, factor, point[column]);
        mpq_add(out, out, factor);
    }
    mpq_clear(factor);
}

/* (a/w + 1) · scale / 2 */
static inline void to_window(mpq_t a, mpq_t w, int scale, mpq_t out)
{
    mpq_t half;
    mpq_init(half);
    mpq_set_ui(half, (unsigned long)scale, 2);
    mpq_canonicalize(half);
    mpq_div(out, a, w);
    mpq_mul(out, out, half);
    mpq_add(out, out, half);
    mpq_clear(half);
}

static inline void window_corner(const View *view, const float *position, int corner, Window *out)
{
    mpq_t point[4], moved[4], clip[4];
    for (int i = 0; i < 4; i++) {
        mpq_inits(point[i], moved[i], clip[i], NULL);
        mpq_set_d(point[i], i < 3 ? position[i] : 1.0);
    }
    for (int i = 0; i < 4; i++)
        row_times_point(view->draws[0].model_view, 4, i, point, moved[i]);
    for (int i = 0; i < 4; i++)
        row_times_point(view->projection, 4, i, moved, clip[i]);
    if (mpq_sgn(clip[3]) == 0) {
        out->usable = false;
    } else {
        to_window(clip[0], clip[3], view->width, out->x[corner]);
        to_window(clip[1], clip[3], view->height, out->y[corner]);
        mpq_set(out->w[corner], clip[3]);
        mpq_t *depth = &out->z[corner];
        if (view->depth_range == DEPTH_RANGE_GL)
            to_window(clip[2], clip[3], 1, *depth);
        else
            mpq_div(*depth, clip[2], clip[3]);
        if (view->depth_range == DEPTH_RANGE_REVERSED) {
            mpq_set_ui(point[0], 1, 1);
            mpq_sub(*depth, point[0], *depth);
        }
    }
    for (int i = 0; i < 4; i++)
        mpq_clears(point[i], moved[i], clip[i], NULL);
}

/* position: 9 floats, of the view's only draw. */
static inline void window_init(const View *view, const float *position, Window *out)
{
    mpq_t *numbers = out->x;
    for (int i = 0; i < WINDOW_NUMBERS; i++)
        mpq_init(numbers[i]);
    out->usable = true;
    for (int corner = 0; corner < 3; corner++)
        window_corner(view, &position[3 * corner], corner, out);
}

static inline void window_free(Window *window)
{
    mpq_t *numbers = window->x;
    for (int i = 0; i < WINDOW_NUMBERS; i++)
        mpq_clear(numbers[i]);
}

/* Twice the signed area of corners j, k and the point. */
static inline void area(mpq_t xj, mpq_t yj, mpq_t xk, mpq_t yk, mpq_t x, mpq_t y, mpq_t out)
{
    mpq_t a, b;
    mpq_inits(a, b, NULL);
    mpq_sub(a, xj, x);
    mpq_sub(b, yk, y);
    mpq_mul(out, a, b);
    mpq_sub(a, xk, x);
    mpq_sub(b, yj, y);
    mpq_mul(a, a, b);
    mpq_sub(out, out, a);
    mpq_clears(a, b, NULL);
}

typedef struct Answer {
    bool has_depth, inside, on_edge;
    mpq_t depth; /* clamped */
} Answer;

static inline void clamp(mpq_t depth)
{
    if (mpq_sgn(depth) < 0)
        mpq_set_ui(depth, 0, 1);
    if (mpq_cmp_ui(depth, 1, 1) > 0)
        mpq_set_ui(depth, 1, 1);
}

/* Window depth is linear over the window, and so is 1/w; corner i's share of a point of the window
 * is area i over the sum, and its perspective-correct weight that over w times a positive number.
 */
static inline void answer(Window *window, int px, int py, Answer *out)
{
    mpq_t x, y, part, sum, depth, inverse_w;
    mpq_inits(x, y, part, sum, depth, inverse_w, NULL);
    mpq_set_d(x, px + 0.5);
    mpq_set_d(y, py + 0.5);
    int share[3], w_sign[3];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        area(window->x[j], window->y[j], window->x[k], window->y[k], x, y, part);
        mpq_add(sum, sum, part);
        share[i] = mpq_sgn(part);
        w_sign[i] = mpq_sgn(window->w[i]);
        mpq_mul(out->depth, part, window->z[i]);
        mpq_add(depth, depth, out->depth);
        mpq_div(out->depth, part, window->w[i]);
        mpq_add(inverse_w, inverse_w, out->depth);
    }
    int orientation = mpq_sgn(sum);
    out->has_depth = orientation != 0 && mpq_sgn(inverse_w) == orientation;
    out->inside = out->has_depth;
    out->on_edge = false;
    for (int i = 0; i < 3; i++) {
        out->inside = out->inside && share[i] * w_sign[i] * orientation > 0;
        out->on_edge = out->on_edge || share[i] == 0;
    }
    if (out->has_depth) {
        mpq_div(out->depth, depth, sum);
        out->inside = out->inside && mpq_sgn(out->depth) >= 0 && mpq_cmp_ui(out->depth, 1, 1) <= 0;
        clamp(out->depth);
    }
    mpq_clears(x, y, part, sum, depth, inverse_w, NULL);
}

#endif

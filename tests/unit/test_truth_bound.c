/* ref/truth's bounds and exact planes on random triangles, against rational numbers computed here
 * in another way: corners divided by their w, and a plane through three points of the window. */
#include "base/random.h"
#include "ref/truth/coverage.h"
#include "ref/truth/order.h"
#include "truth_stage.h"

#include <math.h>

enum {
    TRIANGLES = 48, /* per scene; neighbours are compared */
    WIDTH = 61,
    HEIGHT = 47,
    POINTS = 8, /* pixels tried per pair of triangles */
    RATIOS = 1 << 16
};

/* What the triangles of a scene are like. */
typedef enum Kind {
    KIND_ANY,      /* around the camera, behind it too */
    KIND_SLIVER,   /* two corners close together, or three nearly on a line */
    KIND_COPLANAR, /* pairs in one plane, or nearly so */
    KIND_SPECK,    /* about a pixel */
    KIND_FAR,      /* far from the mesh's and the camera's origin, where sums cancel */
    KIND_THROUGH_EYE,
    KIND_TINY, /* down to denormal floats */
    KIND_COUNT
} Kind;

static const char *const kind_names[KIND_COUNT] = {"any", "sliver",          "coplanar", "speck",
                                                   "far", "through the eye", "tiny"};

typedef struct Case {
    Stage *stage;
    float position[9 * TRIANGLES];
    uint32_t index[3 * TRIANGLES];
    View view;
    Soup soup;
    Order filtered, always;
} Case;

/* ---- scenes --------------------------------------------------------------------------------- */

static void random_point(Random *random, Kind kind, float p[3])
{
    double spread = kind == KIND_SPECK ? 0.02 : 3.0;
    double offset = kind == KIND_FAR ? 1e5 : 0.0;
    p[0] = (float)(random_range(random, -spread, spread) + offset);
    p[1] = (float)random_range(random, -spread, spread);
    p[2] = (float)(kind == KIND_SPECK ? random_range(random, -1.6, -1.5)
                                      : random_range(random, -3.5, 0.5));
    if (kind == KIND_TINY)
        for (int i = 0; i < 3; i++)
            p[i] = ldexpf(p[i], -(int)(random_bits(random) % 145));
}

/* A triangle in the plane of another one: affine combinations, rounded to float, so exact where
 * both lie on a coarse grid and the factors are quarters. */
static void coplanar(Random *random, bool grid, const float *from, float *out)
{
    for (int corner = 0; corner < 3; corner++) {
        double s = random_range(random, -1, 2), t = random_range(random, -1, 2);
        s = grid ? rint(4 * s) / 4 : s;
        t = grid ? rint(4 * t) / 4 : t;
        for (int i = 0; i < 3; i++)
            out[3 * corner + i] = (float)(from[i] + s * ((double)from[3 + i] - from[i]) +
                                          t * ((double)from[6 + i] - from[i]));
    }
}

static void random_triangle(Random *random, Kind kind, int number, float *p)
{
    bool grid = number / 2 % 2;
    if (kind == KIND_COPLANAR && number % 2) {
        coplanar(random, grid, p - 9, p);
        return;
    }
    for (int corner = 0; corner < 3; corner++)
        random_point(random, kind, &p[3 * corner]);
    for (int i = 0; i < 9 && kind == KIND_COPLANAR && grid; i++)
        p[i] = rintf(p[i] * 64) / 64;
    double s = random_range(random, -1, 2), size = ldexp(1.0, -(int)(random_bits(random) % 40));
    for (int i = 0; i < 3; i++) {
        double q = kind == KIND_THROUGH_EYE ? 0.0 : p[3 + i];
        if (kind == KIND_SLIVER || kind == KIND_THROUGH_EYE) /* the last corner, near a line */
            p[6 + i] = (float)(p[i] + s * (q - p[i]) + size * random_range(random, -1, 1));
    }
}

static Matrix random_world(Random *random, Kind kind)
{
    Matrix turn = matrix_rotate_y(random_range(random, -0.3, 0.3));
    Matrix move = matrix_translate(kind == KIND_FAR ? -1e5 : random_range(random, -0.3, 0.3),
                                   random_range(random, -0.3, 0.3), 0);
    return kind == KIND_FAR ? move : matrix_multiply(&turn, &move);
}

static Case *case_new(uint64_t seed, Kind kind)
{
    Case *c = calloc(1, sizeof *c);
    Random random = random_seed(seed * KIND_COUNT + kind);
    for (int i = 0; i < TRIANGLES; i++)
        random_triangle(&random, kind, i, &c->position[9 * i]);
    for (uint32_t i = 0; i < 3 * TRIANGLES; i++)
        c->index[i] = i;
    c->stage = stage_new();
    add_quad(c->stage, 2, 4, red);
    c->stage->meshes[0] = (Mesh){.vertex_count = 3 * TRIANGLES,
                                 .triangle_count = TRIANGLES,
                                 .position = c->position,
                                 .normal = c->position,
                                 .index = c->index};
    c->stage->instances[0].world = random_world(&random, kind);
    if (seed % 2) {
        c->stage->camera.near = 1e-4;
        c->stage->camera.far = 1e4;
    }
    RenderDesc desc = {.width = WIDTH, .height = HEIGHT, .depth_range = (DepthRange)(seed % 3)};
    ck_assert_int_eq(view_build(&c->stage->scene, &desc, &c->view), RESULT_OK);
    Pool *pool = pool_create(1);
    ck_assert_int_eq(soup_build(&c->stage->scene, &c->view, pool, SIZE_MAX, &c->soup), RESULT_OK);
    pool_destroy(pool);
    c->filtered.soup = c->always.soup = &c->soup;
    c->always.always_exact = true;
    return c;
}

static void case_free(Case *c)
{
    order_free(&c->filtered);
    order_free(&c->always);
    soup_free(&c->soup);
    view_free(&c->view);
    free(c->stage);
    free(c);
}

/* ---- rational numbers ----------------------------------------------------------------------- */

/* A triangle's corners in the window: x, y and window depth, divided by w; and w. */
typedef struct Window {
    mpq_t x[3], y[3], z[3], w[3];
    bool usable; /* no w is 0 */
} Window;

enum {
    WINDOW_NUMBERS = 12
};

static void row_times_point(const float *matrix, int stride, int row, mpq_t point[4], mpq_t out)
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
static void to_window(mpq_t a, mpq_t w, int scale, mpq_t out)
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

static void window_corner(const View *view, const float *position, int corner, Window *out)
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

static void window_init(const Case *c, uint32_t triangle, Window *out)
{
    mpq_t *numbers = out->x;
    for (int i = 0; i < WINDOW_NUMBERS; i++)
        mpq_init(numbers[i]);
    out->usable = true;
    for (int corner = 0; corner < 3; corner++)
        window_corner(&c->view, &c->position[9 * triangle + 3 * (uint32_t)corner], corner, out);
}

static void window_free(Window *window)
{
    mpq_t *numbers = window->x;
    for (int i = 0; i < WINDOW_NUMBERS; i++)
        mpq_clear(numbers[i]);
}

/* Twice the signed area of corners j, k and the point. */
static void area(mpq_t xj, mpq_t yj, mpq_t xk, mpq_t yk, mpq_t x, mpq_t y, mpq_t out)
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

static void clamp(mpq_t depth)
{
    if (mpq_sgn(depth) < 0)
        mpq_set_ui(depth, 0, 1);
    if (mpq_cmp_ui(depth, 1, 1) > 0)
        mpq_set_ui(depth, 1, 1);
}

/* Window depth is linear over the window, and so is 1/w; corner i's share of a point of the window
 * is area i over the sum, and its perspective-correct weight that over w times a positive number.
 */
static void answer(Window *window, int px, int py, Answer *out)
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

/* ---- tests ---------------------------------------------------------------------------------- */

typedef struct Tally {
    uint64_t fragments, without_depth, exact, ties, compared, vacuous;
    double ratio[RATIOS]; /* of error to bound */
    size_t ratios;
} Tally;

/* |a − b| */
static double distance(double a, mpq_t b)
{
    mpq_t exact;
    mpq_init(exact);
    mpq_set_d(exact, a);
    mpq_sub(exact, exact, b);
    double d = fabs(mpq_get_d(exact));
    mpq_clear(exact);
    return d;
}

/* Makes the fragment of a triangle at a pixel, and asserts what can be said of it. */
static Fragment check_fragment(Case *c, uint32_t triangle, int x, int y, Answer *expected,
                               Tally *tally)
{
    const SoupVertex *vertices[3];
    soup_vertices(&c->soup, triangle, vertices);
    const Corner *corners[3] = {&vertices[0]->corner, &vertices[1]->corner, &vertices[2]->corner};
    int reach = (int)(triangle % 3) * 8; /* the rectangle need not be tight */
    BoundRect rect = {x > reach ? x - reach : 0, x, y, y + reach < HEIGHT ? y + reach : y};
    Bound bound;
    bound_setup(vertices, rect, &bound);
    ExactPoint point;
    exact_at(corners, x, y, &point);
    Fragment fragment = {.triangle = triangle,
                         .pixel = (uint16_t)((HEIGHT - 1 - y) * TRACE_TILE + x)};
    order_set_depth(&c->filtered, &bound, corners, &point, &fragment);
    bool clockwise;
    bool inside = order_inside(&c->filtered, &bound, &point, triangle, x, y, &clockwise);
    EXPECT(fragment.is_fixed == !expected->has_depth, "triangle %u at %d,%d: has a depth", triangle,
           x, y);
    EXPECT(expected->on_edge || inside == expected->inside, "triangle %u at %d,%d: inside %d",
           triangle, x, y, inside);
    tally->fragments++;
    if (fragment.is_fixed) {
        tally->without_depth++;
        mpq_set_d(expected->depth, fragment.depth);
        return fragment;
    }
    double error = distance(fragment.depth, expected->depth);
    EXPECT(error <= (double)fragment.error, "triangle %u at %d,%d: error %g, bound %g", triangle, x,
           y, error, (double)fragment.error);
    tally->vacuous += fragment.error == 1.0f;
    if (fragment.error > 0.0f && fragment.error < 1.0f && tally->ratios < RATIOS)
        tally->ratio[tally->ratios++] = error / (double)fragment.error;
    return fragment;
}

static void check_pair(Case *c, uint32_t first, Window windows[2], int x, int y, Tally *tally)
{
    Fragment fragments[2];
    Answer expected[2];
    for (int i = 0; i < 2; i++) {
        mpq_init(expected[i].depth);
        answer(&windows[i], x, y, &expected[i]);
        fragments[i] = check_fragment(c, first + (uint32_t)i, x, y, &expected[i], tally);
    }
    int order = mpq_cmp(expected[0].depth, expected[1].depth);
    order = (order > 0) - (order < 0);
    for (int swap = 0; swap < 2; swap++) {
        int filtered = order_compare(&c->filtered, &fragments[swap], &fragments[1 - swap]);
        int always = order_compare(&c->always, &fragments[swap], &fragments[1 - swap]);
        int sign = swap ? -order : order;
        EXPECT((filtered > 0) - (filtered < 0) == sign && (always > 0) - (always < 0) == sign,
               "triangles %u, %u at %d,%d: filtered %d, exact %d, expected %d", first, first + 1, x,
               y, filtered, always, sign);
    }
    tally->compared++;
    tally->ties += order == 0;
    for (int i = 0; i < 2; i++)
        mpq_clear(expected[i].depth);
}

/* The pixel between a corner and the opposite edge's middle, if it is in the viewport, else other.
 */
static int between(mpq_t corners[3], double share, int size, int other)
{
    double middle = (mpq_get_d(corners[1]) + mpq_get_d(corners[2])) / 2;
    double place = middle + share * (mpq_get_d(corners[0]) - middle);
    return place >= 0.0 && place < size ? (int)place : other;
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Bounds hold; the filtered order is the exact one, which is that of the rational numbers here. */
START_TEST(test_against_rationals)
{
    Kind kind = (Kind)_i;
    Tally *tally = calloc(1, sizeof *tally);
    for (uint64_t seed = 0; seed < 12; seed++) {
        Case *c = case_new(seed, kind);
        Random random = random_seed(seed);
        for (uint32_t first = 0; first < TRIANGLES; first += 2) {
            Window windows[2];
            window_init(c, first, &windows[0]);
            window_init(c, first + 1, &windows[1]);
            for (int i = 0; i < POINTS && windows[0].usable && windows[1].usable; i++) {
                int x = (int)(random_bits(&random) % WIDTH);
                int y = (int)(random_bits(&random) % HEIGHT);
                if (i % 2) {
                    double share = random_unit(&random);
                    x = between(windows[0].x, share, WIDTH, x);
                    y = between(windows[0].y, share, HEIGHT, y);
                }
                check_pair(c, first, windows, x, y, tally);
            }
            window_free(&windows[0]);
            window_free(&windows[1]);
        }
        ck_assert_uint_eq(c->filtered.counts.undecided + c->always.counts.undecided, 0);
        ck_assert_uint_eq(c->always.counts.exact_comparisons, c->always.counts.comparisons);
        tally->exact += c->filtered.counts.exact_comparisons;
        case_free(c);
    }
    ck_assert_uint_gt(tally->ratios, 300);
    qsort(tally->ratio, tally->ratios, sizeof tally->ratio[0], compare_doubles);
    printf("%s: %llu fragments, %llu without depth, %llu without bound; error over bound: median "
           "%.3g, greatest %.3g; %llu pairs, %llu ties, %llu of %llu comparisons exact\n",
           kind_names[kind], (unsigned long long)tally->fragments,
           (unsigned long long)tally->without_depth, (unsigned long long)tally->vacuous,
           tally->ratio[tally->ratios / 2], tally->ratio[tally->ratios - 1],
           (unsigned long long)tally->compared, (unsigned long long)tally->ties,
           (unsigned long long)tally->exact, 2 * (unsigned long long)tally->compared);
    free(tally);
}
END_TEST

/* Corners at pixels' centres: doubles are exact, and many centres lie on edges. A bound that knows
 * nothing leaves it to the integers. */
START_TEST(test_inside_on_edges)
{
    enum {
        SIZE = 32
    };
    Case *c = case_new(0, KIND_ANY);
    Random random = random_seed(9);
    for (int i = 0; i < 9 * TRIANGLES; i++) /* in the plane at distance 2: w is 2 */
        c->position[i] = i % 3 == 2 ? -2.0f : (float)(random_bits(&random) % 32) / 8 - 1.9375f;
    c->stage->instances[0].world = matrix_identity();
    soup_free(&c->soup);
    view_free(&c->view);
    RenderDesc desc = {.width = SIZE, .height = SIZE};
    ck_assert_int_eq(view_build(&c->stage->scene, &desc, &c->view), RESULT_OK);
    Pool *pool = pool_create(1);
    ck_assert_int_eq(soup_build(&c->stage->scene, &c->view, pool, SIZE_MAX, &c->soup), RESULT_OK);
    pool_destroy(pool);
    const Bound nothing = {.edge = {INFINITY, INFINITY, INFINITY}, .determinant = -1.0};
    int on_edge = 0;
    for (uint32_t triangle = 0; triangle < TRIANGLES; triangle++) {
        const SoupVertex *v[3];
        soup_vertices(&c->soup, triangle, v);
        const Corner *corners[3] = {&v[0]->corner, &v[1]->corner, &v[2]->corner};
        for (int pixel = 0; pixel < SIZE * SIZE; pixel++) {
            int x = pixel % SIZE, y = pixel / SIZE;
            ExactPoint point;
            exact_at(corners, x, y, &point);
            bool clockwise;
            bool inside = order_inside(&c->filtered, &nothing, &point, triangle, x, y, &clockwise);
            EXPECT(inside == point.inside && (!inside || clockwise == point.clockwise),
                   "triangle %u at %d,%d: inside %d", triangle, x, y, inside);
            on_edge += point.edge[0] * point.edge[1] * point.edge[2] == 0.0;
        }
    }
    ck_assert_int_gt(on_edge, 100);
    ck_assert_uint_eq(c->filtered.counts.exact_coverage, TRIANGLES * SIZE * SIZE);
    case_free(c);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("truth_bound");
    TCase *tests = tcase_create("bound");
    tcase_set_timeout(tests, 300);
    tcase_add_loop_test(tests, test_against_rationals, 0, KIND_COUNT);
    tcase_add_test(tests, test_inside_on_edges);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

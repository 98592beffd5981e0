/* ref/truth's bounds and exact planes on random triangles, against rational numbers computed here
 * in another way: corners divided by their w, and a plane through three points of the window. */
#include "base/random.h"
#include "ref/truth/coverage.h"
#include "ref/truth/order.h"
#include "truth_rational.h"
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
    return matrix_multiply(&turn, &move);
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

/* A corner's number against the rational one, given divided by w. */
static void check_number(double got, double error, mpq_t scaled, mpq_t w, const char *name)
{
    mpq_t exact;
    mpq_init(exact);
    mpq_mul(exact, scaled, w);
    double distant = distance(got, exact);
    EXPECT(distant <= error, "%s: %a is %g off, bound %g", name, got, distant, error);
    mpq_clear(exact);
}

START_TEST(test_corners)
{
    Case *c = case_new((uint64_t)_i / KIND_COUNT, (Kind)(_i % KIND_COUNT));
    mpq_t one, z;
    mpq_inits(one, z, NULL);
    mpq_set_ui(one, 1, 1);
    for (uint32_t triangle = 0; triangle < TRIANGLES; triangle++) {
        Window window;
        window_init(&c->view, &c->position[9 * triangle], &window);
        for (int i = 0; i < 3 && window.usable; i++) {
            const SoupVertex *vertex = &c->soup.vertices[3 * triangle + (uint32_t)i];
            const Corner *corner = &vertex->corner, *error = &vertex->error;
            check_number(corner->x, error->x, window.x[i], window.w[i], "x");
            check_number(corner->y, error->y, window.y[i], window.w[i], "y");
            mpq_add(z, window.z[i], window.z[i]);
            mpq_sub(z, z, one);
            check_number(corner->z, error->z, z, window.w[i], "z");
            check_number(corner->w, error->w, one, window.w[i], "w");
        }
        window_free(&window);
    }
    mpq_clears(one, z, NULL);
    case_free(c);
}
END_TEST

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
            window_init(&c->view, &c->position[9 * first], &windows[0]);
            window_init(&c->view, &c->position[9 * first + 9], &windows[1]);
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
    tcase_add_loop_test(tests, test_corners, 0, 12 * KIND_COUNT);
    tcase_add_test(tests, test_inside_on_edges);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

/* ref/pipeline/setup.h: coverage, facing, bounds and plane equations of one triangle. */
#include "testing.h"
#include "window.h"

#include "base/random.h"

#include <math.h>

static uint32_t saved_mode;

static void enter_mode(void)
{
    saved_mode = op_enter();
}

static void leave_mode(void)
{
    op_leave(saved_mode);
}

static Vertex random_vertex(Random *random, int kind)
{
    double low = kind == 0 ? 0 : -200, high = kind == 0 ? WINDOW_SIZE : 300;
    float x = (float)random_range(random, low, high), y = (float)random_range(random, low, high);
    if (kind == 1) { /* on a coarse grid: many shared coordinates and hits of pixel centres */
        x = 0.5f * (float)(int)(random_bits(random) % (2 * WINDOW_SIZE));
        y = 0.5f * (float)(int)(random_bits(random) % (2 * WINDOW_SIZE));
    }
    return window_vertex(x, y, (float)random_unit(random));
}

/* ---- the fill rule -----------------------------------------------------------------------------
 */

/* A unit square of two triangles with corners on pixel centres covers its left and one of its
 * horizontal sides: exactly size² pixels, wherever it stands. */
START_TEST(test_square_on_centres)
{
    static WindowCount counts;
    Vertex v[4] = {window_vertex(2.5f, 3.5f, 0), window_vertex(7.5f, 3.5f, 0),
                   window_vertex(7.5f, 8.5f, 0), window_vertex(2.5f, 8.5f, 0)};
    window_cover(&v[0], &v[1], &v[2], &counts);
    window_cover(&v[0], &v[2], &v[3], &counts);
    for (int y = 0; y < WINDOW_SIZE; y++)
        for (int x = 0; x < WINDOW_SIZE; x++) {
            bool inside = x >= 2 && x < 7 && y >= 3 && y < 8;
            ck_assert_msg(counts.count[y][x] == inside, "(%d, %d): covered %d times", x, y,
                          counts.count[y][x]);
        }
}
END_TEST

/* Coverage by brute force from the snapped corners: strictly inside, or on an edge whose direction
 * (counter-clockwise) is down, or horizontal towards the left with the pixel above. */
static bool inside_edge(const Vertex *from, const Vertex *to, int x, int y)
{
    int64_t dx = (int64_t)to->x_fixed8 - from->x_fixed8,
            dy = (int64_t)to->y_fixed8 - from->y_fixed8;
    int64_t side =
        dx * (256 * (int64_t)y - from->y_fixed8) - dy * (256 * (int64_t)x - from->x_fixed8);
    return side > 0 || (side == 0 && (dy < 0 || (dy == 0 && dx > 0)));
}

static bool covers(const Vertex *a, const Vertex *b, const Vertex *c, int x, int y)
{
    int64_t area = ((int64_t)b->x_fixed8 - a->x_fixed8) * ((int64_t)c->y_fixed8 - a->y_fixed8) -
                   ((int64_t)c->x_fixed8 - a->x_fixed8) * ((int64_t)b->y_fixed8 - a->y_fixed8);
    if (area == 0)
        return false;
    if (area < 0) {
        const Vertex *swapped = b;
        b = c;
        c = swapped;
    }
    return inside_edge(a, b, x, y) && inside_edge(b, c, x, y) && inside_edge(c, a, x, y);
}

START_TEST(test_brute_force)
{
    Random random = random_seed(1);
    for (int i = 0; i < 3000; i++) {
        static WindowCount counts;
        memset(&counts, 0, sizeof counts);
        Vertex v[3];
        for (int k = 0; k < 3; k++)
            v[k] = random_vertex(&random, i % 3);
        if (i % 7 == 0) /* sub-pixel */
            for (int k = 1; k < 3; k++)
                v[k] = window_vertex(v[0].window[0] + (float)random_range(&random, -1, 1),
                                     v[0].window[1] + (float)random_range(&random, -1, 1), 0);
        window_cover(&v[0], &v[1], &v[2], &counts);
        for (int y = 0; y < WINDOW_SIZE; y++)
            for (int x = 0; x < WINDOW_SIZE; x++)
                if (counts.count[y][x] != covers(&v[0], &v[1], &v[2], x, y))
                    ck_abort_msg("case %d: (%d, %d) covered %d times", i, x, y, counts.count[y][x]);
    }
}
END_TEST

/* Where nothing overflows, the driver's way by tiles and blocks is the plain rule: in all pixels of
 * the tiles that the box touches. */
START_TEST(test_wide_is_exact_where_it_fits)
{
    enum {
        SIDE = 200
    };
    Random random = random_seed(4);
    uint64_t covered = 0, alone = 0, cases = 3000;
    for (uint64_t i = 0; i < cases; i++) {
        Vertex v[3];
        double centre[2] = {random_range(&random, 0, SIDE), random_range(&random, 0, SIDE)};
        double size = (double[]){3, 40, 400, 8000}[i % 4];
        for (int k = 0; k < 3; k++)
            v[k] = window_vertex((float)(centre[0] + random_range(&random, -size, size)),
                                 (float)(centre[1] + random_range(&random, -size, size)), 0);
        const Vertex *const corners[3] = {&v[0], &v[1], &v[2]};
        Setup setup;
        Wide wide;
        setup_triangle(corners, false, SIDE, SIDE, &setup);
        if (setup_facing(corners, false) == FACING_NONE || setup.box.x0 > setup.box.x1 ||
            setup.box.y0 > setup.box.y1)
            continue;
        setup.box = wide_bounds(setup.box, SIDE, SIDE);
        wide_make(&setup, &wide);
        alone += wide.alone;
        for (int y = setup.box.y0; y <= setup.box.y1; y++)
            for (int x = setup.box.x0; x <= setup.box.x1; x++) {
                bool expected = covers(&v[0], &v[1], &v[2], x, y);
                covered += expected;
                if (wide_covers(&wide, x, y) != expected)
                    ck_abort_msg("case %llu: (%d, %d), expected %d", (unsigned long long)i, x, y,
                                 expected);
            }
    }
    ck_assert_uint_gt(covered, 100 * cases);
    ck_assert_uint_gt(alone, cases / 8);
    ck_assert_uint_lt(alone, cases / 2);
}
END_TEST

/* A fan around a point covers the polygon once: no pixel twice, none missed, whatever side an edge
 * is seen from. */
START_TEST(test_fan_covers_once)
{
    Random random = random_seed(2);
    for (int i = 0; i < 300; i++) {
        static WindowCount counts;
        memset(&counts, 0, sizeof counts);
        enum {
            SPOKES = 9
        };
        Vertex centre = random_vertex(&random, i % 2), rim[SPOKES];
        for (int k = 0; k < SPOKES; k++) {
            double angle = 6.283185307179586 * (k + 0.9 * random_unit(&random)) / SPOKES;
            rim[k] = window_vertex(centre.window[0] + 500 * (float)cos(angle),
                                   centre.window[1] + 500 * (float)sin(angle), 0);
        }
        for (int k = 0; k < SPOKES; k++) {
            const Vertex *a = &rim[k], *b = &rim[(k + 1) % SPOKES];
            window_cover(&centre, k & 1 ? a : b, k & 1 ? b : a, &counts);
        }
        for (int y = 0; y < WINDOW_SIZE; y++)
            for (int x = 0; x < WINDOW_SIZE; x++)
                if (counts.count[y][x] != 1)
                    ck_abort_msg("fan %d: (%d, %d) covered %d times", i, x, y, counts.count[y][x]);
    }
}
END_TEST

/* A jittered grid of triangles over the window, every pixel once. */
START_TEST(test_strip_covers_once)
{
    enum {
        CELLS = 12
    };
    Random random = random_seed(3);
    for (int i = 0; i < 50; i++) {
        static WindowCount counts;
        memset(&counts, 0, sizeof counts);
        Vertex grid[CELLS + 1][CELLS + 1];
        double cell = (double)(WINDOW_SIZE + 20) / CELLS;
        for (int row = 0; row <= CELLS; row++)
            for (int column = 0; column <= CELLS; column++)
                grid[row][column] =
                    window_vertex((float)(cell * (column + random_range(&random, -0.3, 0.3)) - 10),
                                  (float)(cell * (row + random_range(&random, -0.3, 0.3)) - 10), 0);
        for (int row = 0; row < CELLS; row++)
            for (int column = 0; column < CELLS; column++) {
                const Vertex *a = &grid[row][column], *b = &grid[row][column + 1];
                const Vertex *c = &grid[row + 1][column], *d = &grid[row + 1][column + 1];
                window_cover(a, b, c, &counts);
                window_cover(c, b, d, &counts);
            }
        for (int y = 0; y < WINDOW_SIZE; y++)
            for (int x = 0; x < WINDOW_SIZE; x++)
                if (counts.count[y][x] != 1)
                    ck_abort_msg("grid %d: (%d, %d) covered %d times", i, x, y, counts.count[y][x]);
    }
}
END_TEST

START_TEST(test_rect_limits_visit)
{
    static WindowCount counts;
    Vertex v[3] = {window_vertex(-100, -100, 0), window_vertex(300, -100, 0),
                   window_vertex(-100, 300, 0)};
    const Vertex *const corners[3] = {&v[0], &v[1], &v[2]};
    Setup setup;
    setup_triangle(corners, false, WINDOW_SIZE, WINDOW_SIZE, &setup);
    setup_visit(&setup, (PixelRect){5, 6, 9, 20}, window_count_pixel, &counts);
    int total = 0;
    for (int y = 0; y < WINDOW_SIZE; y++)
        for (int x = 0; x < WINDOW_SIZE; x++)
            total += counts.count[y][x];
    ck_assert_int_eq(total, 5 * 15);
    ck_assert_int_eq(counts.count[6][5], 1);
    ck_assert_int_eq(counts.count[20][9], 1);
}
END_TEST

/* ---- facing and bounds -------------------------------------------------------------------------
 */

START_TEST(test_facing)
{
    Vertex a = window_vertex(1, 1, 0), b = window_vertex(9, 1, 0), c = window_vertex(1, 9, 0);
    Vertex near_a = window_vertex(1.001f, 1.0f, 0); /* snaps to a */
    ck_assert_int_eq(setup_facing((const Vertex *const[3]){&a, &b, &c}, false), FACING_FRONT);
    ck_assert_int_eq(setup_facing((const Vertex *const[3]){&a, &c, &b}, false), FACING_BACK);
    ck_assert_int_eq(setup_facing((const Vertex *const[3]){&a, &b, &c}, true), FACING_BACK);
    ck_assert_int_eq(setup_facing((const Vertex *const[3]){&a, &c, &b}, true), FACING_FRONT);
    ck_assert_int_eq(setup_facing((const Vertex *const[3]){&a, &a, &b}, false), FACING_NONE);
    ck_assert_int_eq(setup_facing((const Vertex *const[3]){&a, &near_a, &b}, true), FACING_NONE);
    for (int flipped = 0; flipped < 2; flipped++) {
        Setup setup;
        setup_triangle((const Vertex *const[3]){&a, &b, &c}, flipped, 64, 64, &setup);
        ck_assert_int_eq(setup.front, !flipped);
        setup_triangle((const Vertex *const[3]){&a, &c, &b}, flipped, 64, 64, &setup);
        ck_assert_int_eq(setup.front, flipped);
    }
}
END_TEST

/* The box holds every covered pixel, and is empty where nothing of the window is touched. */
START_TEST(test_bounds)
{
    Random random = random_seed(4);
    for (int i = 0; i < 2000; i++) {
        Vertex v[3];
        for (int k = 0; k < 3; k++)
            v[k] = random_vertex(&random, i % 3);
        PixelRect box =
            setup_bounds((const Vertex *const[3]){&v[0], &v[1], &v[2]}, WINDOW_SIZE, WINDOW_SIZE);
        ck_assert_int_ge(box.x0, 0);
        ck_assert_int_lt(box.x1, WINDOW_SIZE);
        for (int y = 0; y < WINDOW_SIZE; y++)
            for (int x = 0; x < WINDOW_SIZE; x++)
                if (covers(&v[0], &v[1], &v[2], x, y) &&
                    (x < box.x0 || x > box.x1 || y < box.y0 || y > box.y1))
                    ck_abort_msg("case %d: (%d, %d) outside the box", i, x, y);
    }
    Vertex a = window_vertex(-9, 1, 0), b = window_vertex(-1, 1, 0), c = window_vertex(-5, 9, 0);
    PixelRect left = setup_bounds((const Vertex *const[3]){&a, &b, &c}, 64, 64);
    ck_assert_int_gt(left.x0, left.x1);
    a = window_vertex(2.6f, 2.6f, 0), b = window_vertex(3.4f, 2.6f, 0),
    c = window_vertex(3, 3.4f, 0);
    PixelRect between = setup_bounds((const Vertex *const[3]){&a, &b, &c}, 64, 64);
    ck_assert(between.x1 - between.x0 <= 0 && between.y1 - between.y0 <= 0);
}
END_TEST

/* A vertex at w = 0 snaps to INT32_MIN: no trap, no endless loop, the window's bounds. */
START_TEST(test_infinite_vertex)
{
    Vertex v[3] = {window_vertex(NAN, NAN, 0), window_vertex(1e9f, 5, 0),
                   window_vertex(5, 1e9f, 0)};
    ck_assert_int_eq(v[0].x_fixed8, INT32_MIN);
    const Vertex *const corners[3] = {&v[0], &v[1], &v[2]};
    setup_facing(corners, false);
    Setup setup;
    setup_triangle(corners, false, WINDOW_SIZE, WINDOW_SIZE, &setup);
    ck_assert_int_ge(setup.box.x0, 0);
    ck_assert_int_lt(setup.box.x1, WINDOW_SIZE);
}
END_TEST

/* ---- planes ------------------------------------------------------------------------------------
 */

START_TEST(test_plane_by_hand)
{
    /* z = 1/8 + x/64 + y/32 at pixel centres: every operation is exact. */
    Vertex a = window_vertex(0.5f, 0.5f, 0.125f), b = window_vertex(16.5f, 0.5f, 0.375f);
    Vertex c = window_vertex(0.5f, 8.5f, 0.375f);
    for (int order = 0; order < 2; order++) {
        Setup setup;
        const Vertex *const corners[3] = {&a, order ? &b : &c, order ? &c : &b};
        setup_triangle(corners, false, WINDOW_SIZE, WINDOW_SIZE, &setup);
        for (int fused = 0; fused < 2; fused++) {
            ck_assert_float_bits(setup_depth_at(fused, &setup, 0, 0), 0.125f);
            ck_assert_float_bits(setup_depth_at(fused, &setup, 3, 5),
                                 0.125f + 3 / 64.0f + 5 / 32.0f);
        }
    }
}
END_TEST

/* fma(dy, y, fma(dx, x, origin)): x first, then y, fused or not, and −0 becomes +0. */
START_TEST(test_plane_order)
{
    Plane plane = {.origin = -0x1.002p+0f, .dx = 0x1.001p+0f, .dy = 0x1p-30f};
    ck_assert_float_bits(plane_at(true, &plane, 1, 0), op_sub(0x1.001p+0f, 0x1.002p+0f));
    Plane cancel = {.origin = 1.5f, .dx = 33554432.0f, .dy = -33554432.0f};
    ck_assert_float_bits(plane_at(true, &cancel, 1, 1), 0.0f); /* y first gives 2 */
    Plane product = {.origin = -50332672.0f, .dx = 16777215.0f, .dy = 0.0f};
    ck_assert_float_bits(plane_at(true, &product, 3, 0), op_fma(16777215.0f, 3.0f, -50332672.0f));
    ck_assert_float_bits(plane_at(false, &product, 3, 0),
                         op_add(op_mul(16777215.0f, 3.0f), -50332672.0f));
    ck_assert_uint_ne(testing_bits(plane_at(true, &product, 3, 0)),
                      testing_bits(plane_at(false, &product, 3, 0)));
    Setup setup = {.depth = {-0.0f, -0.0f, -0.0f}};
    ck_assert_float_bits(setup_depth_at(true, &setup, 1, 1), 0.0f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("setup");
    TCase *tcase = tcase_create("setup");
    tcase_add_checked_fixture(tcase, enter_mode, leave_mode);
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_square_on_centres);
    tcase_add_test(tcase, test_brute_force);
    tcase_add_test(tcase, test_wide_is_exact_where_it_fits);
    tcase_add_test(tcase, test_fan_covers_once);
    tcase_add_test(tcase, test_strip_covers_once);
    tcase_add_test(tcase, test_rect_limits_visit);
    tcase_add_test(tcase, test_facing);
    tcase_add_test(tcase, test_bounds);
    tcase_add_test(tcase, test_infinite_vertex);
    tcase_add_test(tcase, test_plane_by_hand);
    tcase_add_test(tcase, test_plane_order);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

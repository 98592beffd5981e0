/* ref/truth/coverage.c and exact.c: hand-drawn pixels, shared edges, clipping, and the two kinds
 * of coverage against each other. */
#include "base/random.h"
#include "ref/truth/coverage.h"
#include "truth_stage.h"

#include <math.h>

enum {
    SIDE = 16
};

/* Adds to hits[y][x] (y up): 1 to the low half for snapped coverage, 1 << 16 for exact. Asserts on
 * the way that the certain verdicts are right. */
static void cover(const Corner triangle[3], int width, int height, uint32_t *hits)
{
    const Corner *corners[3] = {&triangle[0], &triangle[1], &triangle[2]};
    Coverage coverage;
    bool any = coverage_setup(corners, width, height, &coverage);
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            ExactPoint point;
            exact_at(corners, x, y, &point);
            CoverageAt at = COVERAGE_OUTSIDE;
            bool clockwise = false;
            if (any && x >= coverage.x_low && x <= coverage.x_high && y >= coverage.y_low &&
                y <= coverage.y_high)
                at = coverage_at(&coverage, x, y, &clockwise);
            EXPECT(at != COVERAGE_INSIDE || point.inside, "pixel %d,%d: snapped only", x, y);
            EXPECT(at != COVERAGE_OUTSIDE || !point.inside, "pixel %d,%d: exact only", x, y);
            EXPECT(at != COVERAGE_INSIDE || clockwise == point.clockwise,
                   "pixel %d,%d: turned over", x, y);
            EXPECT(at == COVERAGE_OUTSIDE || !coverage_misses(&coverage, x, y, x, y),
                   "pixel %d,%d: not missed", x, y);
            hits[y * width + x] += at >= COVERAGE_INSIDE_CLOSE ? 1u : 0u;
            hits[y * width + x] += point.inside ? 1u << 16 : 0u;
        }
    }
}

static Corner flat(double x, double y)
{
    return (Corner){x, y, 0.0, 1.0};
}

static Corner deep(double x, double y, double z, double w)
{
    return (Corner){x * w, y * w, z * w, w};
}

/* rows: top first, '#' where the pixel is covered by both kinds of coverage. */
static void check_pattern(const Corner triangle[3], const char *const rows[4])
{
    uint32_t hits[16] = {0};
    cover(triangle, 4, 4, hits);
    for (int y = 0; y < 4; y++)
        for (int x = 0; x < 4; x++)
            EXPECT(hits[y * 4 + x] == (rows[3 - y][x] == '#' ? 0x10001u : 0u),
                   "pixel %d,%d: got %x, expected %c", x, y, hits[y * 4 + x], rows[3 - y][x]);
}

START_TEST(test_hand_patterns)
{
    /* The diagonal runs through pixel centres; they belong to the triangle at its right. */
    const Corner lower[3] = {flat(0, 0), flat(4, 0), flat(0, 4)};
    const Corner upper[3] = {flat(4, 4), flat(0, 4), flat(4, 0)};
    check_pattern(lower, (const char *const[]){"....", "#...", "##..", "###."});
    check_pattern(upper, (const char *const[]){"####", ".###", "..##", "...#"});
    /* The same the other way round. */
    const Corner reversed[3] = {flat(0, 4), flat(4, 0), flat(0, 0)};
    check_pattern(reversed, (const char *const[]){"....", "#...", "##..", "###."});
    /* Edges through centres: left and bottom ones own them, right and top ones do not. */
    const Corner square_a[3] = {flat(0.5, 0.5), flat(2.5, 0.5), flat(2.5, 2.5)};
    const Corner square_b[3] = {flat(0.5, 0.5), flat(2.5, 2.5), flat(0.5, 2.5)};
    check_pattern(square_a, (const char *const[]){"....", "....", ".#..", "##.."});
    check_pattern(square_b, (const char *const[]){"....", "....", "#...", "...."});
    /* No area. */
    const Corner line[3] = {flat(0, 0), flat(2, 2), flat(4, 4)};
    check_pattern(line, (const char *const[]){"....", "....", "....", "...."});
    /* Half a subpixel below the centre snaps up to it (ties to even): the bottom edge owns it. */
    const double low = 0.5 - 0x1p-9;
    const Corner tie[3] = {flat(0, low), flat(4, low), flat(0, low + 8)};
    check_pattern(tie, (const char *const[]){"##..", "###.", "###.", "####"});
}
END_TEST

START_TEST(test_snapping_moves_coverage)
{
    /* The bottom edge is 0.4 subpixels above the centres: snapped onto them, exact it misses. */
    const double low = 0.5 + 0.4 / 256;
    const Corner triangle[3] = {flat(0, low), flat(4, low), flat(4, 4)};
    uint32_t hits[16] = {0};
    cover(triangle, 4, 4, hits);
    ck_assert_uint_eq(hits[3], 0x00001u);
    ck_assert_uint_eq(hits[4 + 3], 0x10001u);
}
END_TEST

/* A fan around a random point whose rim lies on or outside the viewport: every pixel once. */
START_TEST(test_fan_covers_once)
{
    Random random = random_seed((uint64_t)_i + 1);
    uint32_t hits[SIDE * SIDE] = {0};
    enum {
        SPOKES = 23
    };
    Corner rim[SPOKES];
    for (int i = 0; i < SPOKES; i++) {
        double angle = 6.283185307179586 * (i + random_unit(&random)) / SPOKES;
        double radius = _i % 2 ? 14.0 : 1e4; /* a convex rim: every hub sees all of it */
        rim[i] = deep(8 + radius * cos(angle), 8 + radius * sin(angle),
                      random_range(&random, -0.9, 0.9), random_range(&random, 0.5, 4.0));
    }
    Corner hub = deep(random_range(&random, 4, 12), random_range(&random, 4, 12), 0.0, 1.0);
    if (_i % 3 == 0)
        hub = flat(floor(hub.x / hub.w) + 0.5, floor(hub.y / hub.w) + 0.5);
    for (int i = 0; i < SPOKES; i++) {
        const Corner triangle[3] = {hub, rim[i], rim[(i + 1) % SPOKES]};
        cover(triangle, SIDE, SIDE, hits);
    }
    for (int i = 0; i < SIDE * SIDE; i++)
        EXPECT(hits[i] == 0x10001u, "seed %d, pixel %d,%d: %x", _i + 1, i % SIDE, i / SIDE,
               hits[i]);
}
END_TEST

/* Corners on the subpixel grid inside the viewport: snapping changes nothing. */
START_TEST(test_grid_triangles_agree)
{
    Random random = random_seed(7);
    for (int n = 0; n < 2000; n++) {
        Corner triangle[3];
        int grid = n % 2 ? 256 : 2; /* halves: many ties on edges and corners */
        for (int i = 0; i < 3; i++) {
            double w = (double)(1 << random_bits(&random) % 4);
            triangle[i] = deep((double)(random_bits(&random) % (SIDE * grid + 1)) / grid,
                               (double)(random_bits(&random) % (SIDE * grid + 1)) / grid, 0.0, w);
        }
        uint32_t hits[SIDE * SIDE] = {0};
        cover(triangle, SIDE, SIDE, hits);
        for (int i = 0; i < SIDE * SIDE; i++)
            EXPECT(hits[i] == 0 || hits[i] == 0x10001u, "triangle %d, pixel %d: %x", n, i, hits[i]);
    }
}
END_TEST

/* Edges at multiples of 45° cross the viewport's border on the grid: cut pieces cover exactly the
 * pixels of the whole triangle. */
START_TEST(test_clipping_keeps_coverage)
{
    Random random = random_seed(11);
    for (int n = 0; n < 1000; n++) {
        double x = (double)(int)(random_bits(&random) % 80) / 2 - 12;
        double y = (double)(int)(random_bits(&random) % 80) / 2 - 12;
        double leg = (double)(1 + random_bits(&random) % 60) / 2;
        leg = random_bits(&random) % 2 ? leg : -leg;
        const Corner triangle[3] = {flat(x, y), flat(x + leg, y), flat(x, y + leg)};
        uint32_t hits[SIDE * SIDE] = {0};
        cover(triangle, SIDE, SIDE, hits);
        for (int i = 0; i < SIDE * SIDE; i++)
            EXPECT(hits[i] == 0 || hits[i] == 0x10001u, "triangle %d, pixel %d: %x", n, i, hits[i]);
    }
}
END_TEST

/* A ground plane through below the eye, as two triangles with corners behind it: one fragment per
 * pixel below the horizon, none above. Window coordinates for a 16×16 viewport, 90° of view. */
START_TEST(test_plane_through_the_eye)
{
    Corner ground[4];
    const double place[4][2] = {{-50, 50}, {50, 50}, {50, -60}, {-50, -60}}; /* x, depth */
    for (int i = 0; i < 4; i++) {
        double x = place[i][0], y = -1.0, w = place[i][1];
        /* near 0.25, far infinite: z = w − 2 · near */
        ground[i] = (Corner){(x + w) * 8, (y + w) * 8, w - 0.5, w};
    }
    uint32_t hits[SIDE * SIDE] = {0};
    const Corner a[3] = {ground[0], ground[1], ground[2]};
    const Corner b[3] = {ground[0], ground[2], ground[3]};
    cover(a, SIDE, SIDE, hits);
    cover(b, SIDE, SIDE, hits);
    /* Far end: y/w = −1/50, window y = 7.84; the nearest row that is seen is the bottom one. */
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++)
            ck_assert_uint_eq(hits[y * SIDE + x], y < 8 ? 0x10001u : 0u);
}
END_TEST

START_TEST(test_near_and_far_cut)
{
    /* z runs from −3 at x = 0 to 3 at x = 12 with w = 1: visible where 4 ≤ x ≤ 8. */
    const Corner a[3] = {{0, 0, -3, 1}, {12, 0, 3, 1}, {12, 12, 3, 1}};
    const Corner b[3] = {{0, 0, -3, 1}, {12, 12, 3, 1}, {0, 12, -3, 1}};
    uint32_t hits[SIDE * SIDE] = {0};
    cover(a, SIDE, SIDE, hits);
    cover(b, SIDE, SIDE, hits);
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++)
            ck_assert_uint_eq(hits[y * SIDE + x], y < 12 && x >= 4 && x < 8 ? 0x10001u : 0u);
}
END_TEST

START_TEST(test_weights_and_depth)
{
    /* Flat: at the centre of pixel (1, 0), 1.5/4 along x and 0.5/4 along y. */
    const Corner plain[3] = {{0, 0, -1, 1}, {4, 0, 1, 1}, {0, 4, 0, 1}};
    const Corner *corners[3] = {&plain[0], &plain[1], &plain[2]};
    ExactPoint point;
    exact_at(corners, 1, 0, &point);
    ck_assert(point.inside && !point.clockwise);
    ck_assert_double_eq(point.weight[0], 0.5);
    ck_assert_double_eq(point.weight[1], 0.375);
    ck_assert_double_eq(point.weight[2], 0.125);
    ck_assert_double_eq(point.depth, (-0.5 + 0.375) * 0.5 + 0.5);
    /* Perspective: screen weights (1/2, 3/8, 1/8) over w = 1, 2, 4 give weights proportional to
     * screen weight / w: 16, 6, 1 of 23. z = 0, 2, 0 there: depth of (12/23)/((16+12+4)/23). */
    const Corner bent[3] = {{0, 0, 0, 1}, {8, 0, 2, 2}, {0, 16, 0, 4}};
    const Corner *bent_corners[3] = {&bent[0], &bent[1], &bent[2]};
    exact_at(bent_corners, 1, 0, &point);
    ck_assert_double_eq_tol(point.weight[0], 16.0 / 23, 1e-15);
    ck_assert_double_eq_tol(point.weight[1], 6.0 / 23, 1e-15);
    ck_assert_double_eq_tol(point.weight[2], 1.0 / 23, 1e-15);
    ck_assert_double_eq_tol(point.depth, 12.0 / 32 * 0.5 + 0.5, 1e-15);
    /* Parallel to the screen: the same depth to the bit at every pixel, however it is cut. */
    Random random = random_seed(5);
    for (int n = 0; n < 1000; n++) {
        Corner level[3];
        for (int i = 0; i < 3; i++)
            level[i] = (Corner){random_range(&random, 0, 48), random_range(&random, 0, 48), 0.3, 3};
        const Corner *level_corners[3] = {&level[0], &level[1], &level[2]};
        exact_at(level_corners, n % 16, n / 16 % 16, &point);
        EXPECT(point.depth == 0.3 / 3 * 0.5 + 0.5, "case %d: depth %a", n, point.depth);
    }
}
END_TEST

static const double hostile[] = {0.0,  -0.0, 1.0,   -1.0,  1e-30, -1e-30,  1e-310, 8.0,
                                 1e4,  -1e5, 1e30,  -1e30, 3e38,  -3e38,   1e150,  0.5,
                                 16.0, 1e-8, -1e-8, 128.0, -7.25, 1.0 / 3, NAN,    INFINITY};

/* Any corners at all: bounds inside the viewport, numbers in range, the certain verdicts right. */
START_TEST(test_hostile_corners)
{
    Random random = random_seed(99 + (uint64_t)_i);
    size_t kinds = sizeof hostile / sizeof *hostile - (_i % 2 ? 2 : 0);
    for (int n = 0; n < 20000; n++) {
        Corner triangle[3];
        for (int i = 0; i < 3; i++) {
            double *part[4] = {&triangle[i].x, &triangle[i].y, &triangle[i].z, &triangle[i].w};
            for (int k = 0; k < 4; k++)
                *part[k] = hostile[random_bits(&random) % kinds];
        }
        const Corner *corners[3] = {&triangle[0], &triangle[1], &triangle[2]};
        Coverage coverage;
        if (!coverage_setup(corners, 5, 3, &coverage))
            continue;
        EXPECT(coverage.x_low >= 0 && coverage.x_high < 5 && coverage.y_low >= 0 &&
                   coverage.y_high < 3,
               "case %d: bounds", n);
        for (int y = coverage.y_low; y <= coverage.y_high; y++) {
            for (int x = coverage.x_low; x <= coverage.x_high; x++) {
                bool clockwise;
                CoverageAt at = coverage_at(&coverage, x, y, &clockwise);
                ExactPoint point;
                exact_at(corners, x, y, &point);
                EXPECT(point.depth >= 0.0 && point.depth <= 1.0, "case %d: depth %a", n,
                       point.depth);
                EXPECT(at < COVERAGE_INSIDE_CLOSE ||
                           isfinite(point.weight[0] + point.weight[1] + point.weight[2]),
                       "case %d: weights %g %g %g", n, point.weight[0], point.weight[1],
                       point.weight[2]);
            }
        }
    }
}
END_TEST

/* Slivers and specks, where snapping turns triangles over: certain verdicts stay right (asserted
 * in cover). */
START_TEST(test_slivers)
{
    Random random = random_seed(3);
    for (int n = 0; n < 3000; n++) {
        double x = random_range(&random, 1, 15), y = random_range(&random, 1, 15);
        double size = n % 3 ? 0.004 : 1.5;
        double run = n % 2 ? 14.0 : size;
        double slope = random_range(&random, -1, 1);
        const Corner triangle[3] = {
            flat(x, y), flat(fmin(x + run, 15.9), y + size * slope),
            flat(x + size * random_unit(&random), y + 0.01 * random_unit(&random))};
        uint32_t hits[SIDE * SIDE] = {0};
        cover(triangle, SIDE, SIDE, hits);
    }
}
END_TEST

START_TEST(test_largest_viewport)
{
    enum {
        LARGE = 16384
    };
    const Corner triangle[3] = {{-1e9, -1e9, 0, 1}, {3e9, -1e9, 0, 1}, {-1e9, 3e9, 0, 1}};
    const Corner *corners[3] = {&triangle[0], &triangle[1], &triangle[2]};
    Coverage coverage;
    ck_assert(coverage_setup(corners, LARGE, LARGE, &coverage));
    ck_assert_int_eq(coverage.x_low, 0);
    ck_assert_int_eq(coverage.x_high, LARGE - 1);
    const int place[3] = {0, LARGE / 2, LARGE - 1};
    for (int i = 0; i < 9; i++) {
        bool clockwise = true;
        ck_assert_int_ge(coverage_at(&coverage, place[i % 3], place[i / 3], &clockwise),
                         COVERAGE_INSIDE_CLOSE);
        ck_assert(!clockwise);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("truth_coverage");
    TCase *tests = tcase_create("coverage");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, test_hand_patterns);
    tcase_add_test(tests, test_snapping_moves_coverage);
    tcase_add_loop_test(tests, test_fan_covers_once, 0, 60);
    tcase_add_test(tests, test_grid_triangles_agree);
    tcase_add_test(tests, test_clipping_keeps_coverage);
    tcase_add_test(tests, test_plane_through_the_eye);
    tcase_add_test(tests, test_near_and_far_cut);
    tcase_add_test(tests, test_weights_and_depth);
    tcase_add_loop_test(tests, test_hostile_corners, 0, 4);
    tcase_add_test(tests, test_slivers);
    tcase_add_test(tests, test_largest_viewport);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

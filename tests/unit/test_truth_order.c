/* ref/truth's order, end to end, on planes of small integers: which of two is nearer is worked out
 * here with fractions. */
#include "base/random.h"
#include "truth_stage.h"

#include <math.h>

enum {
    SIDE = 33, /* odd: the middle column and row look along the axes */
    SIXTEENTHS = 16
};

/* The plane at distance (c + a·x + b·y)/16 from the camera, as seen through the stage's camera. */
typedef struct HandPlane {
    int a, b, c;
} HandPlane;

/* Distances are num/den, den > 0. */
typedef struct Fraction {
    int64_t num, den;
} Fraction;

/* At pixel (x, y), y down, the ray's slopes are kx/SIDE and ky/SIDE. Where the ray has distance d,
 * x = d·kx/SIDE and y = d·ky/SIDE, so 16·SIDE·d = c·SIDE + d·(a·kx + b·ky). */
static Fraction hand_distance(HandPlane plane, int x, int y)
{
    int kx = 2 * x + 1 - SIDE, ky = SIDE - 1 - 2 * y;
    return (Fraction){(int64_t)plane.c * SIDE,
                      (int64_t)SIXTEENTHS * SIDE - plane.a * kx - plane.b * ky};
}

static int fraction_compare(Fraction a, Fraction b)
{
    int64_t left = a.num * b.den, right = b.num * a.den;
    return (left > right) - (left < right);
}

/* A triangle of the plane that covers the view volume, with corners on a grid of eighths: each
 * coordinate is a float. */
static void add_plane(Stage *stage, HandPlane plane, bool opaque, Random *random)
{
    static const int base[3][2] = {{-128, -64}, {128, -64}, {0, 192}};
    static uint32_t index[3] = {0, 1, 2};
    size_t i = stage->scene.mesh_count;
    add_quad(stage, 2, 1, opaque ? blue : red)->double_sided = true;
    stage->meshes[i].vertex_count = 3;
    stage->meshes[i].triangle_count = 1;
    stage->meshes[i].index = index;
    uint64_t first = random_bits(random) % 3;
    for (uint64_t corner = 0; corner < 3; corner++) {
        float *p = &stage->positions[i][3 * corner];
        int x = base[(corner + first) % 3][0] + (int)(random_bits(random) % 33) - 16;
        int y = base[(corner + first) % 3][1] + (int)(random_bits(random) % 33) - 16;
        p[0] = (float)x / 8;
        p[1] = (float)y / 8;
        p[2] = -(float)(8 * plane.c + plane.a * x + plane.b * y) / 128;
    }
}

/* The triangles at a pixel, nearest first, ties by the depth function. */
static void hand_sort(const HandPlane *planes, int count, DepthFunc func, int x, int y,
                      int sorted[ITEMS_MAX])
{
    for (int i = 0; i < count; i++) {
        Fraction distance = hand_distance(planes[i], x, y);
        int at = i;
        for (; at > 0; at--) {
            int order = fraction_compare(distance, hand_distance(planes[sorted[at - 1]], x, y));
            if (order > 0 || (order == 0 && func == DEPTH_LESS))
                break;
            sorted[at] = sorted[at - 1];
        }
        sorted[at] = i;
    }
}

/* Adds what is seen at a pixel to *ties, and asserts that truth has just that. opaque: a plane's
 * number, or −1. */
static void check_pixel(const Layers *layers, const HandPlane *planes, const int *sorted, int count,
                        int opaque, int x, int y, uint64_t *ties)
{
    int step = 1;
    for (int i = 0; i < count; i++) {
        bool hidden = opaque >= 0 && fraction_compare(hand_distance(planes[sorted[i]], x, y),
                                                      hand_distance(planes[opaque], x, y)) >= 0;
        if (i > 0 && sorted[i] != opaque && sorted[i - 1] != opaque && !hidden)
            *ties += fraction_compare(hand_distance(planes[sorted[i]], x, y),
                                      hand_distance(planes[sorted[i - 1]], x, y)) == 0;
        if (sorted[i] == opaque)
            continue;
        if (hidden) {
            *ties += fraction_compare(hand_distance(planes[sorted[i]], x, y),
                                      hand_distance(planes[opaque], x, y)) == 0;
            continue;
        }
        uint32_t id = layer_id(layers, step, x, y);
        EXPECT(id == (uint32_t)sorted[i], "pixel %d,%d layer %d: triangle %d, expected %d", x, y,
               step - 1, (int)id, sorted[i]);
        step++;
    }
    EXPECT(layer_id(layers, step, x, y) == UINT32_MAX, "pixel %d,%d: more than %d layers", x, y,
           step - 1);
    uint32_t nearest = layer_id(layers, 0, x, y);
    EXPECT((int)nearest == opaque, "pixel %d,%d: opaque %d, expected %d", x, y, (int)nearest,
           opaque);
}

/* Plane `opaque` is opaque, −1: none. Returns truth's counts. */
static LayerStats check_planes(const HandPlane *planes, int count, int opaque, RenderDesc desc,
                               uint64_t seed)
{
    Stage *stage = stage_new();
    Random random = random_seed(seed);
    for (int i = 0; i < count; i++)
        add_plane(stage, planes[i], i == opaque, &random);
    Layers layers = {.sink.put = layers_put};
    Frame frame;
    desc.width = desc.height = SIDE;
    desc.threads = 1;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, &layers.sink, &frame), RESULT_OK);
    uint64_t ties = 0;
    for (int pixel = 0; pixel < SIDE * SIDE; pixel++) {
        int sorted[ITEMS_MAX];
        hand_sort(planes, count, desc.depth_func, pixel % SIDE, pixel / SIDE, sorted);
        check_pixel(&layers, planes, sorted, count, opaque, pixel % SIDE, pixel / SIDE, &ties);
    }
    LayerStats stats = frame.layers;
    ck_assert_uint_eq(stats.ties, ties);
    ck_assert_uint_eq(stats.undecided, 0);
    ck_assert_uint_le(stats.exact_comparisons, stats.comparisons);
    frame_free(&frame);
    layers_free(&layers);
    free(stage);
    return stats;
}

START_TEST(test_planes_through_each_other)
{
    /* Distances 32/(16 − 2·kx/33) and 32/(16 − 2·ky/33): equal where kx = ky, on a diagonal. */
    static const HandPlane crossing[2] = {{2, 0, 32}, {0, 2, 32}};
    for (int func = 0; func < 2; func++) {
        RenderDesc desc = {.depth_func = (DepthFunc)func};
        LayerStats stats = check_planes(crossing, 2, -1, desc, 1);
        ck_assert_uint_eq(stats.ties, SIDE);
        ck_assert_uint_eq(stats.fragments, 2 * SIDE * SIDE);
        /* The same where one is opaque: hidden on the diagonal, whatever the depth function. */
        stats = check_planes(crossing, 2, 0, desc, 2);
        ck_assert_uint_eq(stats.ties, SIDE);
        ck_assert_uint_eq(stats.fragments, SIDE * (SIDE - 1) / 2);
    }
}
END_TEST

START_TEST(test_coincident_faces)
{
    /* The same plane from other corners: all are equal by proof, whatever doubles make of them. */
    HandPlane same[ITEMS_MAX];
    for (int i = 0; i < ITEMS_MAX; i++)
        same[i] = (HandPlane){1, -2, 31};
    for (int func = 0; func < 2; func++) {
        RenderDesc desc = {.depth_func = (DepthFunc)func};
        LayerStats stats = check_planes(same, ITEMS_MAX, -1, desc, 3);
        ck_assert_uint_eq(stats.ties, (ITEMS_MAX - 1) * SIDE * SIDE);
        ck_assert_uint_ge(stats.exact_comparisons, stats.ties);
        stats = check_planes(same, ITEMS_MAX, 5, desc, 4);
        ck_assert_uint_eq(stats.fragments, 0);
        ck_assert_uint_eq(stats.ties, (ITEMS_MAX - 1) * SIDE * SIDE);
    }
}
END_TEST

/* Many planes at a time, few enough of them for equal ones and for ties along lines. */
START_TEST(test_random_planes)
{
    Random random = random_seed((uint64_t)_i + 1);
    HandPlane planes[ITEMS_MAX];
    for (int i = 0; i < ITEMS_MAX; i++)
        planes[i] =
            (HandPlane){(int)(random_bits(&random) % 5) - 2, (int)(random_bits(&random) % 5) - 2,
                        31 + (int)(random_bits(&random) % 3)};
    RenderDesc desc = {.depth_func = (DepthFunc)(_i % 2), .depth_range = (DepthRange)(_i % 3)};
    int opaque = _i % 4 == 0 ? (int)(random_bits(&random) % ITEMS_MAX) : -1;
    LayerStats stats = check_planes(planes, ITEMS_MAX, opaque, desc, (uint64_t)_i + 100);
    ck_assert_uint_gt(stats.ties, 0);
}
END_TEST

/* Squares parallel to the screen at neighbouring floats, farthest first: distances come in order,
 * near the eye and far from it, where window depths are 2^-24 of that apart. */
START_TEST(test_layers_one_ulp_apart)
{
    static const float starts[3] = {1.001f, 1.5f, 2048.0f};
    Stage *stage = stage_new();
    stage->camera.far = 4096;
    float depth = starts[_i];
    for (int i = 0; i < ITEMS_MAX; i++)
        depth = nextafterf(depth, INFINITY);
    for (int i = 0; i < ITEMS_MAX; i++) {
        depth = nextafterf(depth, 0);
        add_quad(stage, depth, 4 * depth, red);
    }
    for (int range = 0; range < 3; range++) {
        Layers layers = {.sink.put = layers_put};
        Frame frame;
        RenderDesc desc = {.width = SIDE, .height = SIDE, .depth_range = (DepthRange)range};
        ck_assert_int_eq(truth_render(&stage->scene, &desc, &layers.sink, &frame), RESULT_OK);
        for (int i = 0; i < SIDE * SIDE; i++)
            for (int step = 0; step < ITEMS_MAX; step++) {
                uint32_t id = layer_id(&layers, step + 1, i % SIDE, i / SIDE);
                EXPECT(id / 2 == (uint32_t)(ITEMS_MAX - 1 - step), "pixel %d layer %d: square %u",
                       i, step, id / 2);
            }
        ck_assert_uint_eq(frame.layers.ties + frame.layers.undecided, 0);
        ck_assert_uint_eq(frame.layers.fragments, ITEMS_MAX * SIDE * SIDE);
        frame_free(&frame);
        layers_free(&layers);
    }
    free(stage);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("truth_order");
    TCase *tests = tcase_create("order");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, test_planes_through_each_other);
    tcase_add_test(tests, test_coincident_faces);
    tcase_add_loop_test(tests, test_random_planes, 0, 60);
    tcase_add_loop_test(tests, test_layers_one_ulp_apart, 0, 3);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

/* ref/pipeline/clip.c: outcodes, the clipped polygon, and the coverage of its pieces. */
#include "testing.h"
#include "window.h"

#include "base/random.h"

#include <math.h>

static uint32_t saved_mode;
static Viewport viewport;

static void enter_mode(void)
{
    saved_mode = op_enter();
    viewport = viewport_make(WINDOW_SIZE, WINDOW_SIZE, DEPTH_RANGE_GL, true);
}

static void leave_mode(void)
{
    op_leave(saved_mode);
}

static Vertex clip_vertex(float x, float y, float z, float w)
{
    Vertex vertex = {.clip = {x, y, z, w}, .position = {x, y, w}, .normal = {y, z, x}};
    viewport_transform(&viewport, false, &vertex);
    return vertex;
}

static int clip3(const Vertex v[3], ClipVertex out[CLIP_VERTICES_MAX])
{
    const Vertex *const corners[3] = {&v[0], &v[1], &v[2]};
    unsigned planes = clip_outcode(&viewport, &v[0]) | clip_outcode(&viewport, &v[1]) |
                      clip_outcode(&viewport, &v[2]);
    return clip_triangle(&viewport, corners, planes, out);
}

static const Vertex *vertex_of(const Vertex v[3], const ClipVertex *vertex)
{
    return vertex->source < 0 ? &vertex->fresh : &v[vertex->source];
}

START_TEST(test_outcode)
{
    static const struct {
        float clip[4];
        unsigned expected;
    } rows[] = {
        {{0, 0, 0, 1}, 0},    {{1, 1, 1, 1}, 0},        {{-1, -1, -1, 1}, 0},
        {{2, 0, 0, 1}, 1},    {{-2, 0, 0, 1}, 2},       {{0, 2, 0, 1}, 4},
        {{0, -2, 0, 1}, 8},   {{0, 0, -2, 1}, 16},      {{0, 0, 2, 1}, 32},
        {{0, 0, 0, -1}, 63},  {{0, 0, 0, 0}, 0},        {{NAN, 0, 0, 1}, 3},
        {{0, 0, 0, NAN}, 63}, {{INFINITY, 0, 0, 1}, 1}, {{3, -3, -3, 1}, 1 | 8 | 16},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        Vertex vertex;
        memcpy(vertex.clip, rows[i].clip, sizeof vertex.clip);
        ck_assert_msg(clip_outcode(&viewport, &vertex) == rows[i].expected,
                      "row %zu: got %u, expected %u", i, clip_outcode(&viewport, &vertex),
                      rows[i].expected);
    }
}
END_TEST

START_TEST(test_viewport)
{
    Vertex vertex = clip_vertex(-2, 2, 0, 4);
    ck_assert_float_bits(vertex.window[0], 16.0f);
    ck_assert_float_bits(vertex.window[1], 48.0f);
    ck_assert_float_bits(vertex.window[2], 0.5f);
    ck_assert_float_bits(vertex.window[3], 0.25f);
    ck_assert_int_eq(vertex.x_fixed8, 16 * 256 - 128);
    ck_assert_int_eq(vertex.y_fixed8, 48 * 256 - 128);
    /* Snapping ties go to even. */
    vertex = clip_vertex(0x1p-14f, 0x1.8p-13f, 0, 1); /* 32 + 1/512, 32 + 3/512 */
    ck_assert_int_eq(vertex.x_fixed8, 8064);
    ck_assert_int_eq(vertex.y_fixed8, 8066);
    vertex = clip_vertex(0x1.8p-13f, 0x1p-14f, 0, 1);
    ck_assert_int_eq(vertex.x_fixed8, 8066);
    ck_assert_int_eq(vertex.y_fixed8, 8064);
    /* A cut vertex is never fused; others are, where the driver fuses. */
    Vertex fused = clip_vertex(0.1f, 0.3f, 0.7f, 0.9f), cut = fused;
    viewport_transform(&viewport, true, &cut);
    float ratio = op_mul(0.1f, op_div(1.0f, 0.9f));
    ck_assert_float_bits(fused.window[0], op_fma(ratio, 32.0f, 32.0f));
    ratio = op_mul(0.7f, op_div(1.0f, 0.9f));
    ck_assert_float_bits(cut.window[2], op_add(op_mul(ratio, 0.5f), 0.5f));
    Viewport unfused = viewport_make(7, 5, DEPTH_RANGE_GL, false),
             odd = viewport_make(7, 5, DEPTH_RANGE_GL, true);
    bool differs = false;
    for (int i = 0; i < 1000; i++) {
        Vertex a = {.clip = {0.001f * (float)i, 0.3f, 0.2f, 1.7f}}, b = a, c = a;
        viewport_transform(&unfused, false, &a);
        viewport_transform(&odd, false, &b);
        viewport_transform(&odd, true, &c);
        ck_assert_float_bits(a.window[0], c.window[0]);
        differs |= testing_bits(a.window[0]) != testing_bits(b.window[0]);
    }
    ck_assert(differs);
}
END_TEST

/* Each plane alone cuts a corner off: four vertices, the new ones on the plane. */
START_TEST(test_each_plane)
{
    for (int plane = 0; plane < CLIP_PLANES; plane++) {
        int axis = plane / 2;
        /* The planes run x ≤ w, x ≥ −w, y ≤ w, y ≥ −w, z ≥ −w, z ≤ w. */
        float sign = (plane % 2 == 0) == (axis < 2) ? 1.0f : -1.0f;
        float clip[3][3] = {{0.0f, 0.1f, 0.2f}, {0.2f, 0.0f, 0.1f}, {0.1f, 0.2f, 0.0f}};
        clip[2][axis] = 3.0f * sign;
        Vertex v[3];
        for (int i = 0; i < 3; i++)
            v[i] = clip_vertex(clip[i][0], clip[i][1], clip[i][2], 1.0f);
        ck_assert_uint_eq(clip_outcode(&viewport, &v[2]), 1u << plane);
        ClipVertex out[CLIP_VERTICES_MAX];
        ck_assert_int_eq(clip3(v, out), 4);
        ck_assert_int_eq(out[0].source, 0);
        ck_assert_int_eq(out[1].source, 1);
        for (int i = 2; i < 4; i++) {
            ck_assert_int_lt(out[i].source, 0);
            const float *fresh = out[i].fresh.clip;
            ck_assert_float_eq_tol(fresh[axis], sign * fresh[3], 1e-6f);
            ck_assert_float_eq_tol(out[i].fresh.position[0], fresh[0],
                                   1e-6f); /* interpolated too */
        }
    }
}
END_TEST

/* from + t·(to − from), starting at the vertex nearer to the plane. */
START_TEST(test_cut_parameter)
{
    Vertex v[3] = {clip_vertex(0.3f, 0.1f, 0.0f, 1.0f), clip_vertex(3.7f, 0.7f, 0.3f, 1.3f),
                   clip_vertex(0.1f, 0.9f, 0.1f, 1.1f)};
    ClipVertex out[CLIP_VERTICES_MAX];
    ck_assert_int_eq(clip3(v, out), 4);
    /* Leaving on edge 0–1: |distance| of 0 is 0.7 and of 1 is 2.4, so it starts at 0. */
    float dp = op_add(op_add(op_add(-0.3f, 0.0f), 0.0f), 1.0f);
    float d = op_add(op_add(op_add(-3.7f, 0.0f), 0.0f), 1.3f);
    float t = op_div(-dp, op_sub(d, dp));
    ck_assert_int_eq(out[0].source, 0);
    for (int c = 0; c < 4; c++)
        ck_assert_float_bits(out[1].fresh.clip[c],
                             op_add(v[0].clip[c], op_mul(t, op_sub(v[1].clip[c], v[0].clip[c]))));
    /* Entering on edge 1–2: |distance| of 2 is 1.0, so it starts at 2. */
    float entering = op_add(op_add(op_add(-0.1f, 0.0f), 0.0f), 1.1f);
    t = op_div(entering, op_sub(entering, d));
    for (int c = 0; c < 3; c++)
        ck_assert_float_bits(
            out[2].fresh.normal[c],
            op_add(v[2].normal[c], op_mul(t, op_sub(v[1].normal[c], v[2].normal[c]))));
    ck_assert_int_eq(out[3].source, 2);
}
END_TEST

/* Far outside, behind the eye, not finite: nothing is left, and nothing traps. */
START_TEST(test_nothing_left)
{
    ClipVertex out[CLIP_VERTICES_MAX];
    Vertex behind[3] = {clip_vertex(0, 0, -2, -1), clip_vertex(1, 0, -2, -1),
                        clip_vertex(0, 1, -2, -1)};
    ck_assert_int_eq(clip3(behind, out), 0);
    /* Outside, but of different planes at each corner. */
    Vertex around[3] = {clip_vertex(-9, 0, 0, 1), clip_vertex(0, 9, 0, 1),
                        clip_vertex(-9, 9, 0, 1)};
    ck_assert_int_eq(clip3(around, out), 0);
    Vertex infinite[3] = {clip_vertex(0, 0, 0, 1), clip_vertex(INFINITY, 0, 0, 1),
                          clip_vertex(0, 1, 0, 1)};
    ck_assert_int_eq(clip3(infinite, out), 0);
    Vertex nan[3] = {clip_vertex(0, 0, 0, 1), clip_vertex(0, NAN, 0, 1), clip_vertex(0, 1, 0, 1)};
    ck_assert_int_eq(clip3(nan, out), 0);
}
END_TEST

/* Through every plane at once, through the eye, huge: never more than nine vertices, all inside to
 * rounding. */
START_TEST(test_random_triangles)
{
    Random random = random_seed(5);
    int most = 0;
    for (int i = 0; i < 100000; i++) {
        double scale = i % 3 == 0 ? 1.5 : i % 3 == 1 ? 10 : 1e5;
        Vertex v[3];
        for (int k = 0; k < 3; k++) {
            float c[4];
            for (int j = 0; j < 4; j++)
                c[j] = (float)random_range(&random, -scale, scale);
            v[k] = clip_vertex(c[0], c[1], c[2], i & 1 ? c[3] : fabsf(c[3]));
        }
        ClipVertex out[CLIP_VERTICES_MAX];
        int count = clip3(v, out);
        most = count > most ? count : most;
        if (count != 0 && (count < 3 || count > CLIP_VERTICES_MAX))
            ck_abort_msg("case %d: %d vertices", i, count);
        for (int k = 0; k < count; k++) {
            const float *c = vertex_of(v, &out[k])->clip;
            for (int j = 0; j < 3; j++)
                if (fabsf(c[j]) > c[3] + 1e-5f * (float)scale)
                    ck_abort_msg("case %d: vertex %d outside: %a against w %a", i, k, (double)c[j],
                                 (double)c[3]);
        }
    }
    ck_assert_int_ge(most, 8);
}
END_TEST

/* The pieces cover what the whole covers inside the window. Corners on a 1/16 pixel grid and a cut
 * by x = w at the window's edge: the new vertices may snap off the edge, so a pixel centre that
 * lies within a snapping of an edge is not judged. */
static bool near_edge(const Vertex v[3], int x, int y)
{
    for (int i = 0; i < 3; i++) {
        const Vertex *a = &v[i], *b = &v[(i + 1) % 3];
        double dx = (double)b->x_fixed8 - a->x_fixed8, dy = (double)b->y_fixed8 - a->y_fixed8;
        double side = dx * (256.0 * y - a->y_fixed8) - dy * (256.0 * x - a->x_fixed8);
        if (fabs(side) <= 2.0 * sqrt(dx * dx + dy * dy))
            return true;
    }
    return false;
}

START_TEST(test_pieces_cover_the_whole)
{
    Random random = random_seed(6);
    for (int i = 0; i < 500; i++) {
        static WindowCount whole, pieces;
        memset(&whole, 0, sizeof whole);
        memset(&pieces, 0, sizeof pieces);
        Vertex v[3];
        for (int k = 0; k < 3; k++) {
            float x = (float)((int)(random_bits(&random) % 3000) - 1000) / 512.0f;
            float y = (float)((int)(random_bits(&random) % 3000) - 1000) / 512.0f;
            v[k] = clip_vertex(x, y, 0, 1);
        }
        window_cover(&v[0], &v[1], &v[2], &whole);
        ClipVertex out[CLIP_VERTICES_MAX];
        int count = clip3(v, out);
        for (int k = 2; k < count; k++)
            window_cover(vertex_of(v, &out[k - 1]), vertex_of(v, &out[k]), vertex_of(v, &out[0]),
                         &pieces);
        for (int y = 0; y < WINDOW_SIZE; y++)
            for (int x = 0; x < WINDOW_SIZE; x++)
                if (pieces.count[y][x] > 1 ||
                    (pieces.count[y][x] != whole.count[y][x] && !near_edge(v, x, y)))
                    ck_abort_msg("case %d: (%d, %d) covered %d times, whole %d", i, x, y,
                                 pieces.count[y][x], whole.count[y][x]);
    }
}
END_TEST

/* With clip control the near plane is z = 0, and window depth is z/w. */
START_TEST(test_zero_to_one)
{
    Viewport half = viewport_make(WINDOW_SIZE, WINDOW_SIZE, DEPTH_RANGE_ZERO_ONE, true);
    Vertex v[3] = {{.clip = {0, 0, -1, 2}}, {.clip = {0.5f, 0, 1, 2}}, {.clip = {0, 0.5f, 1, 2}}};
    ck_assert_uint_eq(clip_outcode(&viewport, &v[0]), 0);
    ck_assert_uint_eq(clip_outcode(&half, &v[0]), 1u << 4);
    ck_assert_uint_eq(clip_outcode(&half, &v[1]), 0);
    for (int i = 0; i < 3; i++)
        viewport_transform(&half, false, &v[i]);
    ck_assert_float_bits(v[1].window[2], 0.5f);
    const Vertex *const corners[3] = {&v[0], &v[1], &v[2]};
    ClipVertex out[CLIP_VERTICES_MAX];
    ck_assert_int_eq(clip_triangle(&half, corners, 1u << 4, out), 4);
    for (int i = 0; i < 4; i++)
        if (out[i].source < 0) {
            ck_assert_float_bits(out[i].fresh.clip[2], 0.0f);
            ck_assert_float_bits(out[i].fresh.window[2], 0.0f);
        }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("clip");
    TCase *tcase = tcase_create("clip");
    tcase_add_checked_fixture(tcase, enter_mode, leave_mode);
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_outcode);
    tcase_add_test(tcase, test_zero_to_one);
    tcase_add_test(tcase, test_viewport);
    tcase_add_test(tcase, test_each_plane);
    tcase_add_test(tcase, test_cut_parameter);
    tcase_add_test(tcase, test_nothing_left);
    tcase_add_test(tcase, test_random_triangles);
    tcase_add_test(tcase, test_pieces_cover_the_whole);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

/* ref/truth on random triangles: against a ray caster, over threads and drawing orders, and with
 * hostile numbers. */
#include "base/random.h"
#include "truth_stage.h"

#include <math.h>

enum {
    SOUP_TRIANGLES = 60,
    WIDTH = 150,
    HEIGHT = 100
};

typedef struct RandomSoup {
    Stage *stage;
    float position[9 * SOUP_TRIANGLES], normal[9 * SOUP_TRIANGLES];
    uint32_t index[3 * SOUP_TRIANGLES];
} RandomSoup;

/* Two draws of one mesh each: the first half of the triangles, and the second (opaque if asked).
 * Corners anywhere around the camera, behind it too. */
static RandomSoup *soup_new(uint64_t seed, bool opaque)
{
    RandomSoup *soup = calloc(1, sizeof *soup);
    Random random = random_seed(seed);
    for (int i = 0; i < 9 * SOUP_TRIANGLES; i++) {
        bool is_z = i % 3 == 2;
        soup->position[i] = (float)random_range(&random, is_z ? -3.5 : -4, is_z ? 0.5 : 4);
        soup->normal[i] = (float)random_range(&random, -1, 1);
    }
    for (uint32_t i = 0; i < 3 * SOUP_TRIANGLES; i++)
        soup->index[i] = i;
    soup->stage = stage_new();
    Stage *stage = soup->stage;
    add_quad(stage, 2, 4, red);
    add_quad(stage, 2, 4, opaque ? blue : green);
    for (int i = 0; i < 2; i++) {
        stage->meshes[i] = (Mesh){.vertex_count = 3 * SOUP_TRIANGLES,
                                  .triangle_count = SOUP_TRIANGLES / 2,
                                  .position = soup->position,
                                  .normal = soup->normal,
                                  .index = soup->index + i * 3 * (SOUP_TRIANGLES / 2)};
        stage->materials[i].double_sided = true;
    }
    stage->scene.light_count = 2;
    stage->lights[0] = (Light){.position = {1, 2, 0}, .color = {3, 2, 1}, .attenuation = {1, 0, 1}};
    stage->lights[1] =
        (Light){.position = {-2, 0, -4}, .color = {1, 2, 3}, .attenuation = {0, 1, 0}};
    return soup;
}

static void soup_drop(RandomSoup *soup)
{
    free(soup->stage);
    free(soup);
}

typedef struct Hit {
    double depth; /* along −z, in view space */
    uint32_t triangle;
} Hit;

/* Source: Möller, Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997.
 * The ray runs from 0 through (x, y, −1). */
static bool cast_ray(const float *p, double x, double y, double *depth)
{
    double e1[3], e2[3];
    for (int i = 0; i < 3; i++) {
        e1[i] = (double)p[3 + i] - p[i];
        e2[i] = (double)p[6 + i] - p[i];
    }
    const double d[3] = {x, y, -1}, t[3] = {-(double)p[0], -(double)p[1], -(double)p[2]};
    const double h[3] = {d[1] * e2[2] - d[2] * e2[1], d[2] * e2[0] - d[0] * e2[2],
                         d[0] * e2[1] - d[1] * e2[0]};
    const double q[3] = {t[1] * e1[2] - t[2] * e1[1], t[2] * e1[0] - t[0] * e1[2],
                         t[0] * e1[1] - t[1] * e1[0]};
    double determinant = e1[0] * h[0] + e1[1] * h[1] + e1[2] * h[2];
    double u = (t[0] * h[0] + t[1] * h[1] + t[2] * h[2]) / determinant;
    double v = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / determinant;
    *depth = (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / determinant;
    return u >= 0 && v >= 0 && u + v <= 1 && *depth >= 1 && *depth < 3;
}

/* All hits at a pixel, front to back. */
static int cast_pixel(const RandomSoup *soup, int x, int y, Hit hits[SOUP_TRIANGLES])
{
    double ray_x = ((x + 0.5) / WIDTH * 2 - 1) * ((double)(float)((double)WIDTH / HEIGHT));
    double ray_y = 1 - (y + 0.5) / HEIGHT * 2;
    int count = 0;
    for (uint32_t i = 0; i < SOUP_TRIANGLES; i++) {
        Hit hit = {0, i};
        if (!cast_ray(&soup->position[9 * i], ray_x, ray_y, &hit.depth))
            continue;
        int at = count++;
        for (; at > 0 && hits[at - 1].depth > hit.depth; at--)
            hits[at] = hits[at - 1];
        hits[at] = hit;
    }
    return count;
}

/* Every triangle that only one side has at a pixel must be a counted coverage difference, and all
 * that both have must be in the same order. */
START_TEST(test_ray_caster_agrees)
{
    RandomSoup *soup = soup_new((uint64_t)_i + 1, false);
    const RenderDesc desc = {.width = WIDTH, .height = HEIGHT};
    Layers layers = {.sink.put = layers_put};
    Frame frame;
    ck_assert_int_eq(truth_render(&soup->stage->scene, &desc, &layers.sink, &frame), RESULT_OK);
    uint64_t differing = 0, fragments = 0;
    for (int pixel = 0; pixel < WIDTH * HEIGHT; pixel++) {
        int x = pixel % WIDTH, y = pixel / WIDTH;
        Hit hits[SOUP_TRIANGLES];
        int count = cast_pixel(soup, x, y, hits), next = 0;
        for (int step = 1; step <= LAYERS_MAX; step++) {
            uint32_t id = layer_id(&layers, step, x, y);
            if (id == UINT32_MAX)
                break;
            fragments++;
            int at = next;
            while (at < count && hits[at].triangle != id)
                at++;
            if (at == count) { /* not in the rest: either nowhere, or out of order */
                for (int i = 0; i < next; i++)
                    EXPECT(hits[i].triangle != id, "pixel %d,%d: order of triangle %u", x, y, id);
                differing++;
            } else {
                differing += (uint64_t)(at - next);
                next = at + 1;
            }
        }
        differing += (uint64_t)(count - next);
    }
    ck_assert_uint_gt(fragments, 5000);
    ck_assert_uint_eq(fragments, frame.layers.fragments);
    ck_assert_uint_eq(differing, frame.layers.coverage_differs);
    frame_free(&frame);
    layers_free(&layers);
    soup_drop(soup);
}
END_TEST

static void check_equal(const Frame *a, const Frame *b)
{
    size_t pixels = (size_t)a->final.width * (size_t)a->final.height;
    ck_assert_mem_eq(a->final.pixels, b->final.pixels, 16 * pixels);
    ck_assert_mem_eq(a->display.pixels, b->display.pixels, 4 * pixels);
    ck_assert_mem_eq(&a->layers, &b->layers, sizeof a->layers);
}

START_TEST(test_any_threads_and_order_same_bits)
{
    RandomSoup *soup = soup_new(77, true);
    RenderDesc desc = {.width = 300, .height = 200, .threads = 1};
    Layers one_layers = {.sink.put = layers_put};
    Frame one, other;
    ck_assert_int_eq(truth_render(&soup->stage->scene, &desc, &one_layers.sink, &one), RESULT_OK);
    ck_assert_uint_gt(one.layers.fragments, 1000);
    for (int threads = 2; threads <= 3; threads++) {
        Layers layers = {.sink.put = layers_put};
        desc.threads = threads;
        ck_assert_int_eq(truth_render(&soup->stage->scene, &desc, &layers.sink, &other), RESULT_OK);
        check_equal(&one, &other);
        for (int step = 0; step <= LAYERS_MAX; step++) {
            ck_assert((layers.id[step] != NULL) == (one_layers.id[step] != NULL));
            if (layers.id[step])
                ck_assert_mem_eq(layers.id[step], one_layers.id[step], 4 * 300 * 200);
        }
        layers_free(&layers);
        frame_free(&other);
    }
    /* No two fragments tie here: the order of drawing must not matter. */
    Instance *instances = soup->stage->instances;
    Instance first = instances[0];
    instances[0] = instances[1];
    instances[1] = first;
    ck_assert_int_eq(truth_render(&soup->stage->scene, &desc, NULL, &other), RESULT_OK);
    other.layers.comparisons = one.layers.comparisons; /* sorting starts from another order */
    other.layers.exact_comparisons = one.layers.exact_comparisons;
    check_equal(&one, &other);
    frame_free(&other);
    frame_free(&one);
    layers_free(&one_layers);
    soup_drop(soup);
}
END_TEST

/* Anything finite: no failure, no NaN. */
START_TEST(test_extreme_geometry)
{
    static const float values[] = {0,     1,      -1,   1e30f,  -1e30f, 1e-30f, -2, 1e4f,
                                   -1e4f, 1e-42f, 0.5f, -1e10f, 1.5f,   -1.5f,  -3, 2};
    Random random = random_seed((uint64_t)_i);
    RandomSoup *soup = soup_new(1, _i % 2);
    for (int i = 0; i < 9 * SOUP_TRIANGLES; i++) {
        soup->position[i] = values[random_bits(&random) % 16];
        soup->normal[i] = values[random_bits(&random) % 16];
    }
    const RenderDesc desc = {.width = 37, .height = 70, .depth_func = (DepthFunc)(_i % 2)};
    Frame frame;
    ck_assert_int_eq(truth_render(&soup->stage->scene, &desc, NULL, &frame), RESULT_OK);
    for (int i = 0; i < 37 * 70 * 4; i++)
        EXPECT(!isnan(((float *)frame.final.pixels)[i]), "pixel %d is not a number", i / 4);
    frame_free(&frame);
    soup_drop(soup);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("truth_random");
    TCase *tests = tcase_create("truth_random");
    tcase_set_timeout(tests, 120);
    tcase_add_loop_test(tests, test_ray_caster_agrees, 0, 6);
    tcase_add_test(tests, test_any_threads_and_order_same_bits);
    tcase_add_loop_test(tests, test_extreme_geometry, 0, 6);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

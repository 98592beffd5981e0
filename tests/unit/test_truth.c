/* ref/truth end to end: scenes whose order and colours are known by hand. */
#include "ref/truth/radiance.h"
#include "truth_stage.h"

#include <math.h>

enum {
    NONE = -1 /* no quad */
};

/* Renders and asserts that every pixel has these four values, to the bit, and the display that
 * belongs to them. */
static void check_color(const Stage *stage, const RenderDesc *desc, const float expected[4])
{
    Frame frame;
    ck_assert_int_eq(truth_render(&stage->scene, desc, NULL, &frame), RESULT_OK);
    for (int y = 0; y < desc->height; y++) {
        for (int x = 0; x < desc->width; x++) {
            const float *final = image_pixel(&frame.final, x, y);
            const uint8_t *display = image_pixel(&frame.display, x, y);
            for (int i = 0; i < 4; i++)
                EXPECT(final[i] == expected[i], "pixel %d,%d channel %d: got %a, expected %a", x, y,
                       i, (double) final[i], (double)expected[i]);
            for (int i = 0; i < 3; i++) {
                double c = expected[i];
                EXPECT(display[i] == lround(255 * pow(c / (c + 1), 1 / 2.2)), "display %d: %d", i,
                       display[i]);
            }
            EXPECT(display[3] == 255, "display alpha %d", display[3]);
        }
    }
    frame_free(&frame);
}

static const RenderDesc small = {.width = 8, .height = 8, .threads = 1};

START_TEST(test_empty_scene)
{
    Stage *stage = stage_new();
    memcpy(stage->scene.background, (const float[]){0.25f, 0.5f, 2}, sizeof(float[3]));
    const float expected[4] = {0.25f, 0.5f, 2, 0};
    check_color(stage, &(RenderDesc){.width = 1, .height = 1}, expected);
    check_color(stage, &(RenderDesc){.width = 70, .height = 65, .threads = 3}, expected);
    Layers layers = {.sink.put = layers_put};
    Frame frame;
    const RenderDesc desc = {.width = 130, .height = 65};
    ck_assert_int_eq(truth_render(&stage->scene, &desc, &layers.sink, &frame), RESULT_OK);
    for (int i = 0; i < 130 * 65; i++)
        EXPECT(layers.seen[i] == 1 && layers.id[0][i] == UINT32_MAX, "pixel %d", i);
    ck_assert_ptr_null(layers.id[1]);
    ck_assert_uint_eq(frame.layers.max, 0);
    ck_assert_int_eq(frame.peels, 0);
    ck_assert_str_eq(frame.renderer, "truth (double precision A-buffer)");
    frame_free(&frame);
    layers_free(&layers);
    free(stage);
}
END_TEST

START_TEST(test_under_compositing)
{
    /* Front to back red 1/2, green 1/4, then background or opaque blue, drawn in any order. */
    for (int order = 0; order < 2; order++) {
        Stage *stage = stage_new();
        memcpy(stage->scene.background, (const float[]){0.5f, 0, 1}, sizeof(float[3]));
        add_quad(stage, order ? 1.5f : 2, 4, order ? red : green);
        add_quad(stage, order ? 2 : 1.5f, 4, order ? green : red);
        check_color(stage, &small, (const float[]){0.6875f, 0.125f, 0.375f, 0.625f});
        Material *material = add_quad(stage, 2.5f, 4, blue);
        material->occlusion = 0.5f;
        check_color(stage, &small, (const float[]){0.5f, 0.125f, 0.1875f, 1});
        free(stage);
    }
}
END_TEST

START_TEST(test_opaque_hides)
{
    /* Behind and at the same depth: hidden, whatever the order and the depth function. */
    for (int n = 0; n < 8; n++) {
        Stage *stage = stage_new();
        RenderDesc desc = small;
        desc.depth_func = n & 1 ? DEPTH_LEQUAL : DEPTH_LESS;
        float depth = n & 2 ? 2.0f : 2.5f;
        if (n & 4)
            add_quad(stage, 2, 4, blue);
        add_quad(stage, depth, 4, red);
        if (!(n & 4))
            add_quad(stage, 2, 4, blue);
        check_color(stage, &desc, (const float[]){0, 0, 1, 1});
        free(stage);
    }
}
END_TEST

/* The id of peel `step` − 1 (0: opaque) everywhere, as the number of its quad, NONE if none. */
static void check_quads(const Stage *stage, DepthFunc func, const int quads[3])
{
    RenderDesc desc = small;
    desc.depth_func = func;
    Layers layers = {.sink.put = layers_put};
    Frame frame;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, &layers.sink, &frame), RESULT_OK);
    uint32_t visible = 0;
    for (int step = 0; step < 3; step++) {
        visible += step > 0 && quads[step] != NONE;
        for (int i = 0; i < 64; i++) {
            uint32_t id = layer_id(&layers, step, i % 8, i / 8);
            int quad = id == UINT32_MAX ? NONE : (int)(id / 2);
            EXPECT(quad == quads[step], "step %d, pixel %d: quad %d, expected %d", step, i, quad,
                   quads[step]);
        }
    }
    ck_assert_uint_eq(frame.layers.max, visible);
    ck_assert_uint_eq(frame.layers.fragments, 64 * visible);
    ck_assert_uint_eq(frame.layers.coverage_differs, 0);
    frame_free(&frame);
    layers_free(&layers);
}

START_TEST(test_ties_follow_depth_func)
{
    Stage *stage = stage_new();
    add_quad(stage, 2, 4, red);
    add_quad(stage, 2, 4, green);
    check_quads(stage, DEPTH_LESS, (const int[]){NONE, 0, 1});
    check_quads(stage, DEPTH_LEQUAL, (const int[]){NONE, 1, 0});
    check_color(stage, &small, (const float[]){0.5f, 0.125f, 0, 0.625f});
    RenderDesc lequal = small;
    lequal.depth_func = DEPTH_LEQUAL;
    check_color(stage, &lequal, (const float[]){0.375f, 0.25f, 0, 0.625f});
    add_quad(stage, 2.5f, 4, blue);
    add_quad(stage, 2.5f, 4, blue);
    check_quads(stage, DEPTH_LESS, (const int[]){2, 0, 1});
    check_quads(stage, DEPTH_LEQUAL, (const int[]){3, 1, 0});
    free(stage);
}
END_TEST

START_TEST(test_far_plane)
{
    /* Exactly at depth 1: opaque passes LEQUAL against the clear value only; transparent never. */
    Stage *stage = stage_new();
    add_quad(stage, 3, 4, blue);
    check_quads(stage, DEPTH_LESS, (const int[]){NONE, NONE, NONE});
    check_quads(stage, DEPTH_LEQUAL, (const int[]){0, NONE, NONE});
    add_quad(stage, 3, 4, red);
    check_quads(stage, DEPTH_LESS, (const int[]){NONE, NONE, NONE});
    add_quad(stage, 1, 4, red); /* at the near plane: seen */
    check_quads(stage, DEPTH_LESS, (const int[]){NONE, 2, NONE});
    free(stage);
}
END_TEST

START_TEST(test_alpha_extremes)
{
    Stage *stage = stage_new();
    add_quad(stage, 1.5f, 4, (const float[]){1, 1, 1, 1e-4f}); /* a fragment, but adds nothing */
    check_quads(stage, DEPTH_LESS, (const int[]){NONE, 0, NONE});
    check_color(stage, &small, (const float[]){0, 0, 0, 0});
    add_quad(stage, 2, 4, (const float[]){0, 1, 0, 1})->alpha_mode = ALPHA_BLEND;
    check_quads(stage, DEPTH_LESS, (const int[]){NONE, 0, 1});
    add_quad(stage, 2.5f, 4, red);
    check_color(stage, &small, (const float[]){0, 1, 0, 1});
    free(stage);
}
END_TEST

/* A quad turned away (by turning its indices) and lit from the camera's side. */
START_TEST(test_facing)
{
    static uint32_t turned_index[6] = {0, 2, 1, 0, 3, 2};
    Stage *stage = stage_new();
    const float clear[4] = {0, 0, 0, 0}, seen[4] = {0, 0.25f, 0, 0.25f};
    add_quad(stage, 2, 4, green);
    stage->meshes[0].index = turned_index;
    RenderDesc desc = small;
    check_color(stage, &desc, clear);
    desc.cull = CULL_SEED; /* culls opaque materials only */
    check_color(stage, &desc, seen);
    desc.cull = CULL_NONE;
    check_color(stage, &desc, seen);
    stage->materials[0].double_sided = true;
    desc.cull = CULL_GLTF;
    check_color(stage, &desc, seen);
    /* A mirroring matrix turns nothing over: the triangles' own order counts. */
    stage->materials[0].double_sided = false;
    stage->instances[0].world = matrix_scale(-1, 1, 1);
    check_color(stage, &desc, clear);
    stage->meshes[0].index = quad_index;
    check_color(stage, &desc, seen);
    stage->meshes[0].index = turned_index;
    /* The stored normal points to the camera, and so to the light: turned over, it does not. */
    stage->instances[0].world = matrix_identity();
    stage->materials[0].double_sided = true;
    stage->scene.light_count = 1;
    stage->lights[0] = (Light){.color = {1, 1, 1}, .attenuation = {0, 0, 1}};
    check_color(stage, &desc, seen);
    desc.normals = NORMALS_KEPT;
    Frame frame;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, NULL, &frame), RESULT_OK);
    ck_assert_float_gt(((float *)image_pixel(&frame.final, 4, 4))[1], 0.26f);
    frame_free(&frame);
    free(stage);
}
END_TEST

/* The image's first row is the top: a quad above the axis, in a wide image. */
START_TEST(test_orientation)
{
    Stage *stage = stage_new();
    add_quad(stage, 2, 1, blue);
    stage->instances[0].world = matrix_translate(2, 1, 0); /* x 1 … 3, y 0 … 2 at depth 2 */
    const RenderDesc desc = {.width = 16, .height = 8};
    Layers layers = {.sink.put = layers_put};
    Frame frame;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, &layers.sink, &frame), RESULT_OK);
    for (int y = 0; y < 8; y++)
        for (int x = 0; x < 16; x++)
            EXPECT((layer_id(&layers, 0, x, y) != UINT32_MAX) == (x >= 10 && x < 14 && y < 4),
                   "pixel %d,%d", x, y);
    frame_free(&frame);
    layers_free(&layers);
    free(stage);
}
END_TEST

/* A slanted quad whose normals are a linear function of the place: each pixel's light is that of
 * the point where its ray meets the plane. */
START_TEST(test_shading_place)
{
    Stage *stage = stage_new();
    add_quad(stage, 2, 8, blue);
    for (int k = 0; k < 4; k++) { /* z = −2 + y/4, from far behind the far plane to before near */
        float *p = &stage->positions[0][3 * k];
        const float normal[3] = {p[0], p[1], 4};
        p[2] = -2 + p[1] / 4;
        memcpy(&stage->normals[0][3 * k], normal, sizeof normal);
    }
    stage->scene.light_count = 1;
    stage->lights[0] = (Light){{0.5, 1.25, -1}, {2, 3, 4}, {0, 0, 1}, 0};
    ViewLight light = {{0.5f, 1.25f, -1}, {2, 3, 4}, {0, 0, 1}, 0};
    View view = {.light_count = 1, .lights = &light, .ambient = {1, 1, 1}};
    Frame frame;
    const RenderDesc desc = {.width = 96, .height = 96};
    ck_assert_int_eq(truth_render(&stage->scene, &desc, NULL, &frame), RESULT_OK);
    int lit = 0;
    for (int i = 0; i < 96 * 96; i++) {
        double x = (i % 96 + 0.5) / 48 - 1, y = 1 - (i / 96 + 0.5) / 48;
        double depth = 2 / (1 + y / 4); /* of the plane along the ray (x, y, −1) */
        Surface surface = {.position = {x * depth, y * depth, -depth},
                           .normal = {x * depth, y * depth, 4}};
        texture_material(NULL, &stage->materials[0], (const double[]){0, 0}, &surface.material);
        double rgb[3];
        radiance_shade(&view, &surface, rgb);
        const float *final = image_pixel(&frame.final, i % 96, i / 96);
        for (int k = 0; k < 3; k++)
            EXPECT(fabs(final[k] - rgb[k]) <= 1e-7 * fmax(1, rgb[k]),
                   "pixel %d,%d: got %.9g, expected %.9g", i % 96, i / 96, (double) final[k],
                   rgb[k]);
        lit += final[0] > 0;
    }
    ck_assert_int_gt(lit, 5000);
    frame_free(&frame);
    free(stage);
}
END_TEST

START_TEST(test_memory_limit)
{
    Stage *stage = stage_new();
    for (int i = 0; i < ITEMS_MAX; i++)
        add_quad(stage, 1.5f + (float)i / 16, 4, red);
    RenderDesc desc = {.width = 64, .height = 64, .threads = 1};
    Frame frame;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, NULL, &frame), RESULT_OK);
    size_t enough = frame.buffer_bytes;
    ck_assert_uint_ge(frame.layers.fragments, 8 * 64 * 64);
    frame_free(&frame);
    const size_t limits[5] = {1, 81920, 82300, enough / 4, enough / 2};
    for (int i = 0; i < 5; i++) {
        desc.max_memory = limits[i];
        ck_assert_int_eq(truth_render(&stage->scene, &desc, NULL, &frame), RESULT_NO_MEMORY);
        ck_assert_ptr_nonnull(strstr(result_message(), "needs "));
        ck_assert_ptr_null(frame.final.pixels);
    }
    desc.max_memory = 2 * enough;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, NULL, &frame), RESULT_OK);
    frame_free(&frame);
    desc.width = 0;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, NULL, &frame), RESULT_BAD_INPUT);
    free(stage);
}
END_TEST

static Result refuse(TraceSink *sink, const TraceBuffer *buffer)
{
    (void)sink;
    return result_fail(RESULT_IO, "%s: refused", buffer->name);
}

START_TEST(test_trace_failure_ends_rendering)
{
    Stage *stage = stage_new();
    TraceSink sink = {.put = refuse};
    Frame frame;
    const RenderDesc desc = {.width = 300, .height = 300, .threads = 2};
    ck_assert_int_eq(truth_render(&stage->scene, &desc, &sink, &frame), RESULT_IO);
    ck_assert_str_eq(result_message(), "opaque.primitive: refused");
    ck_assert_ptr_null(frame.final.pixels);
    free(stage);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("truth");
    TCase *tests = tcase_create("truth");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, test_empty_scene);
    tcase_add_test(tests, test_under_compositing);
    tcase_add_test(tests, test_opaque_hides);
    tcase_add_test(tests, test_ties_follow_depth_func);
    tcase_add_test(tests, test_far_plane);
    tcase_add_test(tests, test_alpha_extremes);
    tcase_add_test(tests, test_facing);
    tcase_add_test(tests, test_orientation);
    tcase_add_test(tests, test_shading_place);
    tcase_add_test(tests, test_memory_limit);
    tcase_add_test(tests, test_trace_failure_ends_rendering);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

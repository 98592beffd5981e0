/* frame/view.h: matrices, lights, draws and limits of small scenes made by hand. */
#include "testing.h"

#include "frame/view.h"

#include <math.h>

static Mesh meshes[2] = {{.vertex_count = 3, .triangle_count = 5},
                         {.vertex_count = 3, .triangle_count = 2}};
static Material materials[5];
static Instance instances[5];
static Light lights[3];
static Camera cameras[2];
static Scene scene;

static void setup(void)
{
    static const AlphaMode modes[5] = {ALPHA_OPAQUE, ALPHA_BLEND, ALPHA_MASK, ALPHA_MASK,
                                       ALPHA_BLEND};
    static const float alphas[5] = {0.0f, 1.0f, 0.5f, 0.25f, 5e-5f};
    for (int i = 0; i < 5; i++) {
        materials[i] = (Material){.alpha_mode = modes[i], .alpha_cutoff = 0.5f};
        materials[i].base_color[3] = alphas[i];
        instances[i] = (Instance){
            .mesh = (uint32_t)(i % 2), .material = (uint32_t)i, .world = matrix_identity()};
    }
    for (int i = 0; i < 3; i++)
        lights[i] = (Light){
            .position = {1 + i, 2, 3}, .color = {1, 2, 3}, .attenuation = {1, 0.5f, (float)i}};
    for (int i = 0; i < 2; i++)
        cameras[i] = (Camera){.world = matrix_translate(0, 0, 5.0 * i),
                              .yfov = 1.5707963267948966,
                              .near = 1.0,
                              .far = i ? INFINITY : 3.0};
    scene = (Scene){.name = "view",
                    .mesh_count = 2,
                    .material_count = 5,
                    .instance_count = 5,
                    .light_count = 3,
                    .camera_count = 2,
                    .meshes = meshes,
                    .materials = materials,
                    .instances = instances,
                    .lights = lights,
                    .cameras = cameras,
                    .ambient = {0.25f, 0.5f, 0.75f},
                    .background = {1, 2, 3}};
}

static View build(RenderDesc desc)
{
    View view;
    ck_assert_msg(view_build(&scene, &desc, &view) == RESULT_OK, "%s", result_message());
    return view;
}

START_TEST(test_projection)
{
    View view = build((RenderDesc){.width = 200, .height = 100});
    /* 1/tan(45°), over the aspect; (near + far)/(near − far), 2·near·far/(near − far). */
    const float expected[16] = {0.5f, 0, 0, 0, 0, 1, 0, 0, 0, 0, -2, -1, 0, 0, -3, 0};
    for (int i = 0; i < 16; i++)
        ck_assert_float_eq_tol(view.projection[i], expected[i], 1e-7f);
    for (int i = 0; i < 3; i++) {
        ck_assert_float_bits(view.ambient[i], 0.25f * (float)(i + 1));
        ck_assert_float_bits(view.background[i], (float)(i + 1));
    }
    view_free(&view);
    view = build((RenderDesc){.width = 64, .height = 64, .camera = 1});
    ck_assert_float_bits(view.projection[10], -1.0f);
    ck_assert_float_bits(view.projection[14], -2.0f);
    view_free(&view);
}
END_TEST

/* Draws in scene order; what cannot be seen is left out but keeps its primitive ids. */
START_TEST(test_draws)
{
    View view = build((RenderDesc){.width = 64, .height = 64});
    ck_assert_uint_eq(view.draw_count, 3); /* the masked-away and the nearly clear one are not */
    static const uint32_t instance[3] = {0, 1, 2}, first[3] = {0, 5, 7};
    for (int i = 0; i < 3; i++) {
        ck_assert_uint_eq(view.draws[i].instance, instance[i]);
        ck_assert_uint_eq(view.draws[i].first_primitive, first[i]);
        ck_assert(view.draws[i].transparent == (i == 1)); /* BLEND at alpha 1 is transparent */
    }
    view_free(&view);
    materials[0].alpha_mode = ALPHA_BLEND; /* alpha 0: left out */
    view = build((RenderDesc){.width = 64, .height = 64});
    ck_assert_uint_eq(view.draw_count, 2);
    ck_assert_uint_eq(view.draws[0].first_primitive, 5);
    view_free(&view);
}
END_TEST

START_TEST(test_model_view)
{
    Matrix shift = matrix_translate(1, 2, 3), mirror = matrix_scale(-2, 4, 8);
    instances[0].world = matrix_multiply(&shift, &mirror);
    View view = build((RenderDesc){.width = 64, .height = 64, .camera = 1});
    const Draw *draw = &view.draws[0];
    const float expected[16] = {-2, 0, 0, 0, 0, 4, 0, 0, 0, 0, 8, 0, 1, 2, -2, 1};
    for (int i = 0; i < 16; i++)
        ck_assert_float_eq(draw->model_view[i], expected[i]);
    ck_assert(draw->flipped);
    ck_assert(!view.draws[1].flipped);
    /* Inverse transpose. */
    const float normal[9] = {-0.5f, 0, 0, 0, 0.25f, 0, 0, 0, 0.125f};
    for (int i = 0; i < 9; i++)
        ck_assert_float_eq(draw->normal_matrix[i], normal[i]);
    view_free(&view);
}
END_TEST

/* A normal matrix beyond single precision is scaled by a power of two, which changes no normal. */
START_TEST(test_normal_matrix_scale)
{
    double sizes[] = {1e-30, 0x1p-100, 1.0, 0x1p100, 1e30};
    float first[9];
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        instances[0].world = matrix_scale(sizes[i], sizes[i], 2 * sizes[i]);
        View view = build((RenderDesc){.width = 64, .height = 64});
        float largest = 0;
        for (int k = 0; k < 9; k++) {
            ck_assert(isfinite(view.draws[0].normal_matrix[k]));
            largest = fmaxf(largest, fabsf(view.draws[0].normal_matrix[k]));
        }
        ck_assert(largest >= 0.5f && largest <= 1.0f);
        if (i == 1)
            memcpy(first, view.draws[0].normal_matrix, sizeof first);
        else if (i == 2 || i == 3)
            ck_assert_mem_eq(view.draws[0].normal_matrix, first, sizeof first);
        view_free(&view);
    }
}
END_TEST

START_TEST(test_cull)
{
    materials[1].double_sided = true;
    for (int mode = CULL_GLTF; mode <= CULL_NONE; mode++) {
        View view = build((RenderDesc){.width = 64, .height = 64, .cull = (CullMode)mode});
        static const bool expected[3][3] = {{1, 0, 1}, {1, 0, 1}, {0, 0, 0}};
        for (int i = 0; i < 3; i++)
            ck_assert(view.draws[i].cull_back == expected[mode][i]);
        view_free(&view);
    }
    materials[0].double_sided = true;
    materials[1].double_sided = false;
    View gltf = build((RenderDesc){.width = 64, .height = 64});
    View seed = build((RenderDesc){.width = 64, .height = 64, .cull = CULL_SEED});
    ck_assert(!gltf.draws[0].cull_back && gltf.draws[1].cull_back);
    ck_assert(seed.draws[0].cull_back && !seed.draws[1].cull_back);
    view_free(&gltf);
    view_free(&seed);
}
END_TEST

START_TEST(test_lights)
{
    scene.light_degrees_per_second = 15.0;
    static const struct {
        int asked;
        size_t expected;
    } rows[] = {{0, 3}, {1, 1}, {2, 2}, {3, 3}, {128, 3}, {-1, 0}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        View view = build((RenderDesc){.width = 64, .height = 64, .lights = rows[i].asked});
        ck_assert_uint_eq(view.light_count, rows[i].expected);
        view_free(&view);
    }
    /* Six seconds turn by 90° about y: (x, y, z) → (z, y, −x); then the camera's 5 along z. */
    View view = build((RenderDesc){.width = 64, .height = 64, .camera = 1, .time = 6.0});
    for (int i = 0; i < 3; i++) {
        ck_assert_float_eq_tol(view.lights[i].position[0], 3.0f, 1e-6f);
        ck_assert_float_eq_tol(view.lights[i].position[1], 2.0f, 1e-6f);
        ck_assert_float_eq_tol(view.lights[i].position[2], (float)-(1 + i) - 5.0f, 1e-6f);
        ck_assert_float_bits(view.lights[i].attenuation[2], (float)i);
        ck_assert_float_bits(view.lights[i].color[1], 2.0f);
    }
    /* A whole turn is none: the same bits. */
    View still = build((RenderDesc){.width = 64, .height = 64, .camera = 1});
    View turned = build((RenderDesc){.width = 64, .height = 64, .camera = 1, .time = 24.0});
    ck_assert_mem_eq(still.lights, turned.lights, 3 * sizeof *still.lights);
    view_free(&view);
    view_free(&still);
    view_free(&turned);
}
END_TEST

/* Of lights 12, 13 and x from the eye; 0 where a light may overflow or the furthest is too far. */
START_TEST(test_reach)
{
    static const struct {
        double x;
        float color, constant, expected;
    } rows[] = {{5, 1, 1, 13},       {-20, 1e12f, 1e-8f, 20}, {20, 1.01e12f, 1, 0},
                {20, -1, 1, 0},      {20, NAN, 1, 0},         {20, 1, 0.9e-8f, 0},
                {20, 1, -1, 0},      {20, 1, NAN, 0},         {0x1p46, 1, 1, 0x1p46f},
                {0x1.1p47, 1, 1, 0}, {NAN, 1, 1, 0},          {INFINITY, 1, 1, 0}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        float color = rows[i].color;
        lights[0] = (Light){.position = {0, 12, 0}, .color = {1, 1, 1}, .attenuation = {1, 0, 0}};
        lights[1] = (Light){.position = {3, -4, 12}, .color = {1, 1, 1}, .attenuation = {1, 0, 0}};
        lights[2] = (Light){.position = {rows[i].x, 0, 0},
                            .color = {1, 1, color},
                            .attenuation = {rows[i].constant, 0, 0}};
        View view = build((RenderDesc){.width = 64, .height = 64});
        ck_assert_msg(view.light_reach >= rows[i].expected &&
                          view.light_reach <= rows[i].expected * 1.00001f,
                      "row %zu: reach %g, expected %g", i, (double)view.light_reach,
                      (double)rows[i].expected);
        view_free(&view);
    }
    View none = build((RenderDesc){.width = 64, .height = 64, .lights = -1});
    ck_assert_float_bits(none.light_reach, 0.0f);
    view_free(&none);
}
END_TEST

/* Never denormal, nor so large that a product with a squared distance overflows. */
START_TEST(test_ranges)
{
    static const struct {
        float range, expected;
    } rows[] = {{0, 0},
                {1, 1},
                {0.5f, 4},
                {3, 1.0f / 9.0f},
                {0.01f, 1e4f},
                {1e-3f, 2e4f},
                {1e-45f, 2e4f},
                {0x1p62f, 0x1p-124f},
                {0x1p63f, 0x1p-126f},
                {0x1p64f, 0},
                {3e38f, 0}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        lights[0].range = rows[i].range;
        View view = build((RenderDesc){.width = 64, .height = 64});
        ck_assert_float_bits(view.lights[0].inverse_range2, rows[i].expected);
        ck_assert_float_bits(view.lights[1].inverse_range2, 0.0f);
        ck_assert(view.ranged == (rows[i].expected > 0));
        view_free(&view);
    }
}
END_TEST

START_TEST(test_limits)
{
    static const RenderDesc bad[] = {
        {.width = 0, .height = 64},
        {.width = 64, .height = -1},
        {.width = 100000, .height = 64},
        {.width = 64, .height = SIZE_MAX_PIXELS + 1},
        {.width = 64, .height = 64, .camera = 2},
        {.width = 64, .height = 64, .camera = -1},
        {.width = 64, .height = 64, .passes = -1},
        {.width = 64, .height = 64, .passes = PASSES_MAX + 1},
        {.width = 64, .height = 64, .time = INFINITY},
        {.width = 64, .height = 64, .time = NAN},
        {.width = 64, .height = 64, .time = 1e7},
        {.width = 64, .height = 64, .accum = FORMAT_D32F},
        {.width = 64, .height = 64, .accum = FORMAT_COUNT},
        {.width = 64, .height = 64, .depth = FORMAT_RGBA8},
        {.width = 64, .height = 64, .depth = FORMAT_R32UI},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        View view;
        result_fail(RESULT_OK, "unset");
        ck_assert_msg(view_build(&scene, &bad[i], &view) == RESULT_BAD_INPUT, "row %zu", i);
        ck_assert_str_ne(result_message(), "unset");
        ck_assert_ptr_null(strchr(result_message(), '\n'));
    }
    View view = build((RenderDesc){.width = SIZE_MAX_PIXELS, .height = 1, .passes = PASSES_MAX});
    view_free(&view);
    RenderDesc desc = {.width = 64, .height = 64};
    const Camera good = cameras[0];
    const Camera extreme[] = {
        {.yfov = 5e-39, .near = 0.1, .far = 100},
        {.yfov = 1, .near = 1e-39, .far = 100},
        {.yfov = 1, .near = 0x1.fffffep-125, .far = 100},
        {.yfov = 1, .near = 1e10, .far = 1e300},
    };
    for (size_t i = 0; i < sizeof extreme / sizeof extreme[0]; i++) {
        cameras[0].yfov = extreme[i].yfov;
        cameras[0].near = extreme[i].near;
        cameras[0].far = extreme[i].far;
        ck_assert_msg(view_build(&scene, &desc, &view) == RESULT_BAD_INPUT, "camera %zu", i);
    }
    cameras[0] = good;
    cameras[0].world = matrix_scale(0, 1, 1);
    ck_assert_int_eq(view_build(&scene, &desc, &view), RESULT_BAD_INPUT);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("view");
    TCase *tcase = tcase_create("view");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, test_projection);
    tcase_add_test(tcase, test_draws);
    tcase_add_test(tcase, test_model_view);
    tcase_add_test(tcase, test_normal_matrix_scale);
    tcase_add_test(tcase, test_cull);
    tcase_add_test(tcase, test_lights);
    tcase_add_test(tcase, test_reach);
    tcase_add_test(tcase, test_ranges);
    tcase_add_test(tcase, test_limits);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

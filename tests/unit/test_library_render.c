/* peel.h, rendering: the bits and figures of the renderers behind it, the buffers, bad settings,
 * and one scene in several threads. */
#include "library_scenes.h"

#include "ref/pipeline/pipeline.h"
#include "ref/truth/truth.h"
#include "scene/generate.h"

#include <fenv.h>
#include <pthread.h>
#include <stdio.h>

/* ---- rendering ---- */

enum {
    WIDTH = 48,
    HEIGHT = 27,
    PIXELS = WIDTH * HEIGHT
};

/* The same settings for the library and for what is behind it. */
typedef struct Case {
    PeelSettings settings;
    RenderDesc desc;
} Case;

static const Case cases[] = {
    {{.passes = 0}, {.passes = 0}},
    {{.passes = 2, .lights = 1, .threads = 1}, {.passes = 2, .lights = 1, .threads = 1}},
    {{.definition_path = true, .tile = 16, .simd = PEEL_SIMD_SCALAR},
     {.ref_path = REF_PATH_DEFINITION, .tile = 16, .simd = SIMD_SCALAR}},
    {{.depth = PEEL_D16, .accum = PEEL_RGBA8, .gbuffer = PEEL_GBUFFER_COMPACT},
     {.depth = FORMAT_D16, .accum = FORMAT_RGBA8, .gbuffer = GBUFFER_COMPACT}},
    {{.depth = PEEL_D24,
      .accum = PEEL_RGBA16,
      .gbuffer = PEEL_GBUFFER_SEED,
      .less_or_equal = true,
      .raw_test = true,
      .cull = PEEL_CULL_OPAQUE,
      .normals_kept = true},
     {.depth = FORMAT_D24,
      .accum = FORMAT_RGBA16,
      .gbuffer = GBUFFER_SEED,
      .depth_func = DEPTH_LEQUAL,
      .peel_test = PEEL_TEST_RAW,
      .cull = CULL_SEED,
      .normals = NORMALS_KEPT}},
    {{.depth_range = PEEL_DEPTH_REVERSED,
      .reconstruct_position = true,
      .stable_highlight = true,
      .back_light = true,
      .unfused = true,
      .cull = PEEL_CULL_NONE},
     {.depth_range = DEPTH_RANGE_REVERSED,
      .position = POSITION_RECONSTRUCT,
      .ggx = GGX_STABLE,
      .back_light = true,
      .unfused = true,
      .cull = CULL_NONE}},
    {{.depth_range = PEEL_DEPTH_ZERO_ONE, .bias = 0.001f, .phong = true, .lights = -1},
     {.depth_range = DEPTH_RANGE_ZERO_ONE, .bias = 0.001f, .shading = SHADING_PHONG, .lights = -1}},
    {{.method = "painter", .sort_triangles = true, .accum = PEEL_RGBA16F},
     {.method = METHOD_PAINTER, .sort = SORT_TRIANGLES, .accum = FORMAT_RGBA16F}},
    {{.method = "linked-list", .edges = true, .nodes_per_pixel = 1},
     {.method = METHOD_LINKED_LIST, .post = POST_EDGES, .nodes_per_pixel = 1}},
    {{.method = "weighted-blended", .weight_equation = 7},
     {.method = METHOD_WEIGHTED_BLENDED, .weight = WEIGHT_7}},
    {{.method = "weighted-blended", .weight_equation = 10},
     {.method = METHOD_WEIGHTED_BLENDED, .weight = WEIGHT_10}},
};

static void check_case(const Scene *scene, const PeelScene *library, PeelSettings settings,
                       RenderDesc desc, Renderer renderer)
{
    static float linear[PIXELS * 4];
    static uint8_t display[PIXELS * 4];
    PeelFigures figures;
    Frame frame;
    settings.width = desc.width = WIDTH;
    settings.height = desc.height = HEIGHT;
    ck_assert_msg(renderer(scene, &desc, NULL, &frame) == RESULT_OK, "%s", result_message());
    GOOD(peel_scene_render(library, &settings, NULL,
                           &(PeelImages){.linear = linear, .display = display}, &figures));
    ck_assert_mem_eq(linear, frame.final.pixels, sizeof linear);
    ck_assert_mem_eq(display, frame.display.pixels, sizeof display);
    ck_assert_int_eq(figures.passes, frame.peels);
    ck_assert_uint_eq(figures.fragments, frame.layers.fragments);
    ck_assert_uint_eq(figures.max_layers, frame.layers.max);
    ck_assert_uint_eq(figures.lost_to_pass_limit, frame.layers.lost_to_pass_limit);
    ck_assert_uint_eq(figures.lost_to_overflow, frame.layers.lost_to_overflow);
    ck_assert_double_eq(figures.residual_max, frame.residual_max);
    ck_assert_int_eq(figures.threads, frame.threads);
    frame_free(&frame);
}

START_TEST(test_render_is_the_renderer)
{
    Scene scene;
    Arrays arrays;
    PeelScene *library = NULL;
    ck_assert_int_eq(generate_find("crossing_planes")->generate(&scene), RESULT_OK);
    show(&scene, &arrays);
    GOOD(peel_scene_create(&arrays.desc, &library));
    hide(&arrays);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_case(&scene, library, cases[i].settings, cases[i].desc, pipeline_render);
    for (size_t i = 0; peel_method_name(i, NULL); i++)
        check_case(&scene, library, (PeelSettings){.method = peel_method_name(i, NULL)},
                   (RenderDesc){.method = (MethodId)i}, pipeline_render);
    check_case(&scene, library, (PeelSettings){.renderer = PEEL_TRUTH}, (RenderDesc){0},
               truth_render);
    peel_scene_free(library);
    scene_free(&scene);
}
END_TEST

/* Rounding upward in the caller does not reach the scene, its camera or the renderers' threads. */
START_TEST(test_render_environment)
{
    static float images[2][2][PIXELS * 4];
    static const PeelSettings settings = {.width = WIDTH, .height = HEIGHT};
    PeelSettings truth = settings;
    truth.renderer = PEEL_TRUTH;
    for (int i = 0; i < 2; i++) {
        Small small;
        small_scene(&small);
        small.camera.eye[0] = 1.1;
        ck_assert_int_eq(fesetround(i == 0 ? FE_TONEAREST : FE_UPWARD), 0);
        PeelScene *scene = create(&small);
        GOOD(
            peel_scene_render(scene, &settings, NULL, &(PeelImages){.linear = images[i][0]}, NULL));
        GOOD(peel_scene_render(scene, &truth, NULL, &(PeelImages){.linear = images[i][1]}, NULL));
        peel_scene_free(scene);
    }
    fesetround(FE_TONEAREST);
    ck_assert_mem_eq(images[0], images[1], sizeof images[0]);
}
END_TEST

/* What a callback saw. */
typedef struct Seen {
    int buffers, stop_at;
    uint16_t accum[PIXELS * 4];
    char last[64];
} Seen;

static int put(void *context, const PeelBuffer *buffer)
{
    Seen *seen = context;
    snprintf(seen->last, sizeof seen->last, "%s", buffer->name);
    ck_assert_int_eq(buffer->image_width, WIDTH);
    if (strcmp(buffer->name, "accum") == 0)
        for (int y = 0; y < buffer->height; y++)
            memcpy(seen->accum + 4 * ((size_t)(buffer->y + y) * WIDTH + (size_t)buffer->x),
                   (const char *)buffer->pixels + (size_t)y * buffer->row_bytes,
                   8 * (size_t)buffer->width);
    return ++seen->buffers == seen->stop_at;
}

START_TEST(test_render_buffers)
{
    static Seen seen;
    static uint16_t accum[PIXELS * 4], before[PIXELS * 4];
    const PeelTrace trace = {put, &seen};
    PeelSettings settings = {.width = WIDTH, .height = HEIGHT, .accum = PEEL_RGBA16};
    Small small;
    small_scene(&small);
    PeelScene *scene = create(&small);
    const PeelImages images = {.accum = accum};
    for (size_t i = 0; peel_method_name(i, NULL); i++) {
        memset(accum, 0, sizeof accum);
        settings.method = peel_method_name(i, NULL);
        settings.accum = PEEL_RGBA16;
        seen = (Seen){0};
        GOOD(peel_scene_render(scene, &settings, &trace, &images, NULL));
        ck_assert_mem_eq(accum, seen.accum, sizeof accum);
        ck_assert_str_eq(seen.last, "display");
        ck_assert_uint_ne(accum[4 * (HEIGHT / 2 * WIDTH + WIDTH / 2)], 0);
    }
    settings.method = NULL;
    seen = (Seen){.stop_at = 3};
    memcpy(before, accum, sizeof accum);
    FAILS(PEEL_STOPPED, "stopped by the caller",
          peel_scene_render(scene, &settings, &trace, &images, NULL));
    ck_assert_int_eq(seen.buffers, 3);
    ck_assert_mem_eq(accum, before, sizeof accum);
    peel_scene_free(scene);
}
END_TEST

/* Two panes in one place: which is in front, and that the other is lost; and depths of 16 bits,
 * which a raw test finds behind themselves. */
START_TEST(test_render_depths)
{
    static float image[2][PIXELS * 4];
    const size_t center = 4 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
    PeelSettings settings = {.width = WIDTH, .height = HEIGHT};
    PeelFigures figures;
    Small small;
    small_scene(&small);
    const PeelMaterial materials[3] = {small.materials[0],
                                       small.materials[1],
                                       {.base_color = {0, 1, 0, 0.5f},
                                        .roughness = 0.5f,
                                        .occlusion = 1,
                                        .alpha_mode = PEEL_TRANSPARENT}};
    const PeelInstance instances[3] = {{0, 0, NULL}, {0, 1, nearer}, {0, 2, nearer}};
    small.camera.eye[0] = 1;
    small.desc.materials = materials;
    small.desc.instances = instances;
    small.desc.material_count = small.desc.instance_count = 3;
    PeelScene *scene = create(&small);
    for (int i = 0; i < 2; i++) {
        settings.less_or_equal = i == 1;
        GOOD(
            peel_scene_render(scene, &settings, NULL, &(PeelImages){.linear = image[i]}, &figures));
        ck_assert_uint_gt(figures.lost_to_ties, 0);
        ck_assert_uint_eq(2 * figures.lost_to_ties, figures.fragments);
    }
    ck_assert_float_gt(image[0][center], image[1][center]);
    ck_assert_float_lt(image[0][center + 1], image[1][center + 1]);

    settings.depth = PEEL_D16;
    settings.less_or_equal = false;
    settings.passes = 3;
    for (int i = 0; i < 2; i++) {
        settings.raw_test = i == 1;
        GOOD(peel_scene_render(scene, &settings, NULL, &(PeelImages){0}, &figures));
        ck_assert_int_eq(figures.repeated > 0, i == 1);
    }
    peel_scene_free(scene);
}
END_TEST

START_TEST(test_render_bound)
{
    static float linear[PIXELS * 4], ref[PIXELS * 4], bound[PIXELS * 4];
    PeelSettings settings = {.width = WIDTH, .height = HEIGHT};
    Small small;
    small_scene(&small);
    PeelScene *scene = create(&small);
    GOOD(peel_scene_render(scene, &settings, NULL, &(PeelImages){.linear = ref}, NULL));
    settings.renderer = PEEL_TRUTH;
    GOOD(peel_scene_render(scene, &settings, NULL, &(PeelImages){.linear = linear, .bound = bound},
                           NULL));
    int finite = 0;
    for (int i = 0; i < PIXELS * 4; i++) {
        ck_assert_float_le(fabsf(linear[i] - ref[i]), bound[i]);
        finite += bound[i] > 0.0f && bound[i] < 1.0f;
    }
    ck_assert_int_gt(finite, PIXELS);
    settings.method = "painter";
    FAILS(PEEL_UNSUPPORTED, "no bound",
          peel_scene_render(scene, &settings, NULL, &(PeelImages){.bound = bound}, NULL));
    peel_scene_free(scene);
}
END_TEST

/* One setting spoilt, of a rendering that would be good. */
#define UNSET(result, text, spoil)                                                                 \
    do {                                                                                           \
        PeelSettings settings_ = {.width = 8, .height = 8};                                        \
        PeelSettings *s = &settings_;                                                              \
        spoil;                                                                                     \
        FAILS(result, text, peel_scene_render(scene, s, NULL, &images, NULL));                     \
        for (int i_ = 0; i_ < 256; i_++)                                                           \
            ck_assert_float_bits(pixels[i_], 0.0f);                                                \
    } while (0)

START_TEST(test_render_bad)
{
    static float pixels[256];
    const PeelImages images = {.linear = pixels};
    const PeelSettings good = {.width = 8, .height = 8};
    Small small;
    small_scene(&small);
    PeelScene *scene = create(&small);
    BAD("scene is NULL", peel_scene_render(NULL, &good, NULL, &images, NULL));
    BAD("settings is NULL", peel_scene_render(scene, NULL, NULL, &images, NULL));
    BAD("images is NULL", peel_scene_render(scene, &good, NULL, NULL, NULL));
    UNSET(PEEL_BAD_INPUT, "size 0×8", s->width = 0);
    UNSET(PEEL_BAD_INPUT, "size 8×-8", s->height = -8);
    UNSET(PEEL_BAD_INPUT, "size 65536×32768", (s->width = 65536, s->height = 32768));
    UNSET(PEEL_NO_MEMORY, "", (s->width = 16384, s->height = 16384));
    UNSET(PEEL_NO_MEMORY, "", s->max_memory = 1);
    UNSET(PEEL_NO_MEMORY, "", (s->max_memory = 1, s->renderer = PEEL_TRUTH));
    UNSET(PEEL_BAD_INPUT, "renderer 77", s->renderer = (PeelRenderer)NONE);
    UNSET(PEEL_BAD_INPUT, "camera 1", s->camera = 1);
    UNSET(PEEL_BAD_INPUT, "camera -1", s->camera = -1);
    UNSET(PEEL_BAD_INPUT, "method \"peal\"", s->method = "peal");
    UNSET(PEEL_BAD_INPUT, "-1 passes", s->passes = -1);
    UNSET(PEEL_BAD_INPUT, "5000 passes", s->passes = 5000);
    UNSET(PEEL_BAD_INPUT, "depth in format", s->depth = PEEL_RGBA8);
    UNSET(PEEL_BAD_INPUT, "depth in format", s->depth = (PeelFormat)NONE);
    UNSET(PEEL_BAD_INPUT, "accumulation in format", s->accum = PEEL_R32F);
    UNSET(PEEL_BAD_INPUT, "accumulation in format", s->accum = (PeelFormat)-1);
    UNSET(PEEL_BAD_INPUT, "G-buffer 77", s->gbuffer = (PeelGBuffer)NONE);
    UNSET(PEEL_BAD_INPUT, "depth range -1", s->depth_range = (PeelDepthRange)-1);
    UNSET(PEEL_BAD_INPUT, "culling 3", s->cull = (PeelCull)3);
    UNSET(PEEL_BAD_INPUT, "instruction set 5", s->simd = (PeelSimd)5);
    UNSET(PEEL_BAD_INPUT, "bias nan", s->bias = NAN);
    UNSET(PEEL_BAD_INPUT, "bias -1", s->bias = -1.0f);
    UNSET(PEEL_BAD_INPUT, "weight equation 6", s->weight_equation = 6);
    UNSET(PEEL_BAD_INPUT, "-1 nodes", s->nodes_per_pixel = -1);
    UNSET(PEEL_BAD_INPUT, "tiles of 48", s->tile = 48);
    UNSET(PEEL_BAD_INPUT, "-1 threads", s->threads = -1);
    UNSET(PEEL_BAD_INPUT, "257 threads", s->threads = 257);

    PeelSettings truth = good;
    truth.renderer = PEEL_TRUTH;
    BAD("images.accum",
        peel_scene_render(scene, &truth, NULL, &(PeelImages){.accum = pixels}, NULL));
    BAD("images.bound",
        peel_scene_render(scene, &good, NULL, &(PeelImages){.bound = pixels}, NULL));
    BAD("trace.put", peel_scene_render(scene, &good, &(PeelTrace){0}, &images, NULL));
    GOOD(peel_scene_render(scene, &good, NULL, &(PeelImages){0}, NULL));
    peel_scene_free(scene);
}
END_TEST

/* ---- threads ---- */

static void *fail_and_render(void *context)
{
    const PeelScene *scene = context;
    static const PeelSettings good = {.width = 16, .height = 16}, bad = {.width = -1};
    float *image = calloc(1, 16 * 16 * 16);
    bool fails = peel_scene_render(scene, &bad, NULL, &(PeelImages){.linear = image}, NULL) ==
                 PEEL_BAD_INPUT;
    bool renders =
        peel_scene_render(scene, &good, NULL, &(PeelImages){.linear = image}, NULL) == PEEL_OK;
    bool kept = strstr(peel_message(), "size -1×0") != NULL;
    if (fails && renders && kept)
        return image;
    free(image);
    return NULL;
}

/* One scene, several threads, each with its own message. */
START_TEST(test_threads)
{
    pthread_t threads[4];
    void *images[4];
    char before[1024];
    snprintf(before, sizeof before, "%s", peel_message());
    Small small;
    small_scene(&small);
    PeelScene *scene = create(&small);
    for (int i = 0; i < 4; i++)
        ck_assert_int_eq(pthread_create(&threads[i], NULL, fail_and_render, scene), 0);
    for (int i = 0; i < 4; i++)
        ck_assert_int_eq(pthread_join(threads[i], &images[i]), 0);
    for (int i = 0; i < 4; i++) {
        ck_assert_ptr_nonnull(images[i]);
        ck_assert_mem_eq(images[i], images[0], 16 * 16 * 16);
    }
    for (int i = 0; i < 4; i++)
        free(images[i]);
    ck_assert_str_eq(peel_message(), before);
    peel_scene_free(scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("library rendering");
    TCase *tcase = tcase_create("library rendering");
    tcase_set_timeout(tcase, 120);
    tcase_add_test(tcase, test_render_is_the_renderer);
    tcase_add_test(tcase, test_render_environment);
    tcase_add_test(tcase, test_render_buffers);
    tcase_add_test(tcase, test_render_depths);
    tcase_add_test(tcase, test_render_bound);
    tcase_add_test(tcase, test_render_bad);
    tcase_add_test(tcase, test_threads);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

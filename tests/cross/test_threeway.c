/* The three renderers on the built-in scenes: ref and gl agree bit for bit in every buffer, truth
 * agrees within the tolerance, and a renderer that is broken on purpose is found out. */
#include "base/memory.h"
#include "pane.h"
#include "testing.h"

#include "gl/gl_renderer.h"
#include "ref/pipeline/pipeline.h"
#include "ref/truth/truth.h"
#include "scene/builder.h"
#include "scene/generate.h"
#include "study/threeway.h"

#include <math.h>
#include <stdio.h>

#define TOLERANCE 1e-4

enum {
    WIDTH = 160,
    HEIGHT = 90
};

static const Renderer honest[RENDERER_COUNT] = {pipeline_render, gl_render, truth_render};

static Scene generate(const char *name)
{
    Scene scene;
    const BuiltinScene *row = generate_find(name);
    ck_assert_ptr_nonnull(row);
    ck_assert_msg(row->generate(&scene) == RESULT_OK, "%s", result_message());
    return scene;
}

static Threeway run(const Scene *scene, const RenderDesc *desc, const Renderer renderers[])
{
    Threeway report;
    ck_assert_msg(threeway_run(scene, "scene.gltf", desc, renderers, TOLERANCE, false, &report) ==
                      RESULT_OK,
                  "%s", result_message());
    return report;
}

/* Every buffer of ref and gl has equal bits, and all were compared. */
static void check_ref_gl(const Threeway *report)
{
    const PairReport *pair = &report->pairs[0];
    ck_assert_uint_eq(pair->final.differing, 0);
    ck_assert_uint_eq(pair->buffer_count, (size_t)(5 + 6 * report->frames[RENDERER_REF].peels + 2));
    for (size_t i = 0; i < pair->buffer_count; i++) {
        const BufferMetrics *buffer = &pair->buffers[i];
        ck_assert_msg(buffer->differing == 0, "%s: %llu of %llu values differ, first at (%d, %d)",
                      buffer->name, (unsigned long long)buffer->differing,
                      (unsigned long long)buffer->values, buffer->first[0], buffer->first[1]);
        ck_assert_uint_ge(buffer->values,
                          (uint64_t)report->desc.width * (uint64_t)report->desc.height);
    }
    ck_assert_int_eq(report->frames[RENDERER_REF].peels, report->frames[RENDERER_GL].peels);
}

static const struct {
    const char *scene;
    float opacity; /* < 0: as it is */
} cases[] = {
    {"teapot_hall", -1},   {"teapot_hall_stress", -1}, {"tutorial", -1},
    {"chain", -1},         {"crossing_planes", -1},    {"alpha_ladder", -1},
    {"teapot_hall", 0.3f}, {"crossing_planes", 0.3f},  {"lamps", -1},
};

START_TEST(test_scenes)
{
    Scene scene = generate(cases[_i / 2].scene);
    bool seed = _i & 1;
    if (cases[_i / 2].opacity >= 0)
        scene_override_opacity(&scene, cases[_i / 2].opacity);
    if (_i % 3 == 1) { /* a background that is not black */
        scene.background[0] = 0.25f;
        scene.background[2] = 1.5f;
    }
    /* Without lights the overridden scenes show nothing that the others do not. */
    for (int lights = cases[_i / 2].opacity < 0 ? -1 : 3; lights <= 3; lights += 4) {
        RenderDesc desc = {.width = WIDTH, .height = HEIGHT, .lights = lights};
        if (seed)
            render_desc_seed_profile(&desc);
        Threeway report = run(&scene, &desc, honest);
        check_ref_gl(&report);
        ck_assert_uint_eq(report.pairs[1].final.nonfinite, 0);
        if (!seed) {
            ck_assert_msg(report.agree, "%s: p99 %g", scene.name,
                          report.pairs[1].unaffected.p99_rel);
            ck_assert_double_le(report.pairs[1].unaffected.p99_rel, TOLERANCE);
            ck_assert_uint_gt(report.pairs[1].unaffected.pixels, WIDTH * HEIGHT / 2);
            ck_assert_uint_eq(report.structure.layers.lost_to_pass_limit, 0);
        }
        threeway_free(&report);
    }
    scene_free(&scene);
}
END_TEST

/* The distribution's other form, light from behind, and both. */
START_TEST(test_shading_options)
{
    static const char *const names[] = {"teapot_hall", "tutorial", "chain"};
    Scene scene = generate(names[_i % 3]);
    bool seed = _i >= 3;
    for (int options = seed && !testing_full() ? 3 : 1; options < 4; options++) {
        RenderDesc desc = {.width = WIDTH, .height = HEIGHT, .lights = 16};
        if (seed)
            render_desc_seed_profile(&desc);
        desc.ggx = options & 1 ? GGX_STABLE : GGX_SOURCE;
        desc.back_light = options & 2;
        Threeway report = run(&scene, &desc, honest);
        check_ref_gl(&report);
        ck_assert_uint_eq(report.pairs[1].final.nonfinite, 0);
        if (!seed)
            ck_assert_msg(report.agree, "%s: p99 %g", scene.name,
                          report.pairs[1].unaffected.p99_rel);
        threeway_free(&report);
    }
    scene_free(&scene);
}
END_TEST

/* Back light changes transparent surfaces, in every renderer, and opaque ones in none. */
START_TEST(test_back_light)
{
    Scene scene = generate("tutorial");
    for (int opaque = 0; opaque < 2; opaque++) {
        if (opaque)
            scene_override_opacity(&scene, 1.0f);
        for (int i = 0; i < RENDERER_COUNT; i++) {
            RenderDesc desc = {.width = WIDTH, .height = HEIGHT};
            Frame off, on;
            ck_assert(honest[i](&scene, &desc, NULL, &off) == RESULT_OK);
            desc.back_light = true;
            ck_assert(honest[i](&scene, &desc, NULL, &on) == RESULT_OK);
            size_t bytes = (size_t)WIDTH * HEIGHT * format_pixel_bytes(on.final.format);
            ck_assert_int_eq(memcmp(off.final.pixels, on.final.pixels, bytes) == 0, opaque);
            frame_free(&off);
            frame_free(&on);
        }
    }
    scene_free(&scene);
}
END_TEST

/* What the limit loses is counted, and the peels that are made still agree. */
START_TEST(test_pass_limit)
{
    Scene scene = generate("teapot_hall_stress");
    RenderDesc desc = {.width = WIDTH, .height = HEIGHT, .lights = 3, .passes = 2};
    Threeway report = run(&scene, &desc, honest);
    check_ref_gl(&report);
    ck_assert_int_eq(report.frames[RENDERER_REF].peels, 2);
    ck_assert_uint_gt(report.structure.layers.max, 2);
    ck_assert_uint_gt(report.structure.layers.lost_to_pass_limit, 0);
    ck_assert_double_gt(report.frames[RENDERER_REF].residual_max, 0.0);
    threeway_free(&report);
    scene_free(&scene);
}
END_TEST

START_TEST(test_nothing_transparent)
{
    Scene scene = generate("tutorial");
    scene_override_opacity(&scene, 1.0f);
    RenderDesc desc = {.width = WIDTH, .height = HEIGHT};
    Threeway report = run(&scene, &desc, honest);
    check_ref_gl(&report);
    ck_assert(report.agree);
    ck_assert_int_eq(report.frames[RENDERER_REF].peels, 0);
    ck_assert_uint_eq(report.structure.layers.fragments, 0);
    threeway_free(&report);
    scene_free(&scene);
}
END_TEST

START_TEST(test_empty_view)
{
    Scene scene = generate("tutorial");
    scene.background[1] = 0.5f;
    scene.cameras[0].world = matrix_translate(0, 0, -1e4);
    RenderDesc desc = {.width = 65, .height = 33};
    Threeway report = run(&scene, &desc, honest);
    check_ref_gl(&report);
    ck_assert(report.agree);
    for (int i = 0; i < RENDERER_COUNT; i++) {
        const float *pixel = image_pixel(&report.frames[i].final, 64, 32);
        ck_assert_float_bits(pixel[1], 0.5f);
        ck_assert_float_bits(pixel[3], 0.0f);
    }
    threeway_free(&report);
    scene_free(&scene);
}
END_TEST

/* A clipped triangle whose normals are so small that their plane equations are denormal: Mesa sets
 * it up in the calling thread, which must flush as its own threads do. */
START_TEST(test_tiny_varyings)
{
    float size = (float[]){1e-28f, 1e-30f, 1e-33f, 1e-36f, 1e-38f}[_i];
    float position[] = {0, 0, 0, 0, -1.77f, 0, 1, 0, 1}, normal[] = {0, 0, 0, 0, 0, 0, size, 0, 0};
    uint32_t index[] = {0, 1, 2};
    Mesh mesh = {.vertex_count = 3, .triangle_count = 1};
    mesh.position = memory_array(9, sizeof(float));
    mesh.normal = memory_array(9, sizeof(float));
    mesh.index = memory_array(3, sizeof(uint32_t));
    memcpy(mesh.position, position, sizeof position);
    memcpy(mesh.normal, normal, sizeof normal);
    memcpy(mesh.index, index, sizeof index);

    Builder builder = builder_begin("tiny");
    builder_mesh(&builder, RESULT_OK, &mesh);
    builder_material(&builder, &(Material){.base_color = {1, 1, 1, 1}, .occlusion = 1}, NULL);
    builder_instance(&builder, &(Instance){.world = matrix_identity()}, NULL);
    builder_camera(
        &builder,
        &(Camera){.world = matrix_translate(0, 0, 3), .yfov = 0.8, .near = 0.1, .far = 100}, NULL);
    Scene scene;
    ck_assert_msg(builder_finish(&builder, &scene) == RESULT_OK, "%s", result_message());

    RenderDesc desc = {.width = 128, .height = 128};
    Threeway report = run(&scene, &desc, honest);
    check_ref_gl(&report);
    threeway_free(&report);
    scene_free(&scene);
}
END_TEST

/* A triangle behind another, and a background that only a thread which flushes takes for black:
 * where the depth test hides 4x4 pixels that would be stored as halves, Mesa's threads stop to. */
START_TEST(test_hidden_behind_halves)
{
    Mesh mesh = pane_mesh(1.0f, 0.0f, (float[]){0, 0, 1});
    Builder builder = builder_begin("hidden");
    builder_mesh(&builder, RESULT_OK, &mesh);
    builder_material(&builder,
                     &(Material){.base_color = {1, 1, 1, 1}, .occlusion = 1, .double_sided = true},
                     NULL);
    for (int i = 0; i < 2; i++)
        builder_instance(&builder, &(Instance){.world = matrix_translate(0, 0, (float)-i)}, NULL);
    builder_light(&builder, &(Light){.color = {1, 1, 1}, .attenuation = {0, 0, 1}});
    builder_camera(
        &builder,
        &(Camera){.world = matrix_translate(0, 0, 3), .yfov = 0.8, .near = 0.1, .far = 100}, NULL);
    Scene scene;
    ck_assert_msg(builder_finish(&builder, &scene) == RESULT_OK, "%s", result_message());
    memcpy(scene.background, (float[]){1e-40f, 0.3f, 0.5f}, sizeof scene.background);

    RenderDesc desc = {.width = 64, .height = 64, .gbuffer = GBUFFER_SEED};
    Threeway report = run(&scene, &desc, honest);
    check_ref_gl(&report);
    threeway_free(&report);
    scene_free(&scene);
}
END_TEST

/* ---- broken renderers -------------------------------------------------------------------------
 */

typedef enum Fault {
    FAULT_BIT,       /* one bit of one traced value changed */
    FAULT_DROP,      /* one buffer kept back */
    FAULT_ADD,       /* a buffer that ref does not have */
    FAULT_RECTANGLE, /* half a buffer kept back */
    FAULT_FORMAT,    /* a buffer in another format */
    FAULT_FINAL,     /* one bit of the final image */
    FAULT_COUNT
} Fault;

static Fault fault;
static const char *const victim = "peel.1.normal";

typedef struct Saboteur {
    TraceSink sink;
    TraceSink *behind;
} Saboteur;

static Result put(TraceSink *sink, const TraceBuffer *buffer)
{
    TraceSink *behind = ((Saboteur *)sink)->behind;
    if (strcmp(buffer->name, victim) != 0)
        return behind->put(behind, buffer);
    TraceBuffer changed = *buffer;
    Image copy = {0};
    ck_assert(image_create(buffer->width, buffer->height, buffer->format, &copy) == RESULT_OK);
    memcpy(copy.pixels, buffer->pixels, buffer->row_bytes * (size_t)buffer->height);
    changed.pixels = copy.pixels;
    Result result = RESULT_OK;
    switch (fault) {
    case FAULT_BIT:
        ((unsigned char *)copy.pixels)[buffer->row_bytes * 5 + 16 * 7 + 4] ^= 1;
        break;
    case FAULT_DROP:
        image_free(&copy);
        return RESULT_OK;
    case FAULT_RECTANGLE:
        changed.height = 64;
        break;
    case FAULT_FORMAT:
        changed.format = FORMAT_RGBA8;
        changed.row_bytes = (size_t)changed.width * 4;
        break;
    case FAULT_ADD:
        result = behind->put(behind, buffer);
        changed.name = "peel.99.accum";
        break;
    default:
        break;
    }
    if (result == RESULT_OK)
        result = behind->put(behind, &changed);
    image_free(&copy);
    return result;
}

static Result broken_gl(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    Saboteur saboteur = {{.put = put}, trace};
    Result result = gl_render(scene, desc, trace ? &saboteur.sink : NULL, out);
    if (result == RESULT_OK && fault == FAULT_FINAL)
        ((uint32_t *)image_pixel(&out->final, 3, 4))[1] ^= 1;
    return result;
}

START_TEST(test_broken_renderer)
{
    fault = (Fault)_i;
    Scene scene = generate("crossing_planes");
    RenderDesc desc = {.width = WIDTH, .height = HEIGHT};
    const Renderer renderers[] = {pipeline_render, broken_gl, truth_render};
    Threeway report = run(&scene, &desc, renderers);
    ck_assert(!report.agree);
    const BufferMetrics *found = NULL;
    const char *name = fault == FAULT_ADD ? "peel.99.accum" : victim;
    for (size_t i = 0; i < report.pairs[0].buffer_count; i++) {
        const BufferMetrics *buffer = &report.pairs[0].buffers[i];
        if (strcmp(buffer->name, name) == 0)
            found = buffer;
        else
            ck_assert_uint_eq(buffer->differing, 0);
    }
    ck_assert_ptr_nonnull(found);
    static const uint64_t differing[] = {
        1, WIDTH * HEIGHT * 4, WIDTH * HEIGHT * 4, WIDTH * (HEIGHT - 64) * 4, WIDTH * HEIGHT * 4,
        0};
    ck_assert_uint_eq(found->differing, differing[fault]);
    if (fault == FAULT_BIT) {
        ck_assert_int_eq(found->first[0], 7);
        ck_assert_int_eq(found->first[1], 5);
        ck_assert_int_eq(found->first[2], 1);
        ck_assert_uint_eq(found->max_ulp, 1);
    }
    ck_assert_uint_eq(report.pairs[0].final.differing, fault == FAULT_FINAL);
    threeway_free(&report);
    scene_free(&scene);
}
END_TEST

/* A truth that sees nothing shares no structure with ref: that is no agreement. */
static Result blind_truth(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    uint32_t id = 123456789;
    Result result = truth_render(scene, desc, NULL, out);
    Image ids = {0};
    if (result == RESULT_OK)
        result = image_create(desc->width, desc->height, FORMAT_R32UI, &ids);
    for (int i = 0; result == RESULT_OK && i < desc->width * desc->height; i++)
        ((uint32_t *)ids.pixels)[i] = id;
    if (result == RESULT_OK)
        result = trace_put(trace, "opaque.primitive", 0, FORMAT_R32UI, desc->width, desc->height,
                           ids.pixels);
    image_free(&ids);
    return result;
}

START_TEST(test_blind_truth)
{
    Scene scene = generate("crossing_planes");
    RenderDesc desc = {.width = WIDTH, .height = HEIGHT};
    const Renderer renderers[] = {pipeline_render, gl_render, blind_truth};
    Threeway report = run(&scene, &desc, renderers);
    check_ref_gl(&report);
    ck_assert_uint_eq(report.pairs[1].unaffected.pixels, 0);
    ck_assert_uint_eq(report.structure.opaque_flips, WIDTH * HEIGHT);
    ck_assert(!report.agree);
    threeway_free(&report);
    scene_free(&scene);
}
END_TEST

static Result wrong_truth(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    Result result = truth_render(scene, desc, trace, out);
    for (int i = 0; result == RESULT_OK && i < WIDTH * HEIGHT / 50; i++)
        ((float *)out->final.pixels)[4 * i] += 1e-3f;
    return result;
}

START_TEST(test_wrong_truth)
{
    Scene scene = generate("crossing_planes");
    RenderDesc desc = {.width = WIDTH, .height = HEIGHT};
    const Renderer renderers[] = {pipeline_render, gl_render, wrong_truth};
    Threeway report = run(&scene, &desc, renderers);
    ck_assert(!report.agree);
    ck_assert_double_gt(report.pairs[1].unaffected.p99_rel, TOLERANCE);
    threeway_free(&report);
    scene_free(&scene);
}
END_TEST

/* The image of a traced rendering must be the timed one's; a failure keeps its message. */
static Result traced_differently(const Scene *scene, const RenderDesc *desc, TraceSink *trace,
                                 Frame *out)
{
    Result result = pipeline_render(scene, desc, trace, out);
    if (result == RESULT_OK && trace)
        ((uint32_t *)out->final.pixels)[9] ^= 1;
    return result;
}

static Result fails(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    (void)scene, (void)desc, (void)trace;
    *out = (Frame){0};
    return result_fail(RESULT_NO_GL, "gl: no driver");
}

START_TEST(test_failures)
{
    Scene scene = generate("crossing_planes");
    RenderDesc desc = {.width = 32, .height = 18};
    Threeway report;
    const Renderer differently[] = {traced_differently, gl_render, truth_render};
    ck_assert_int_eq(threeway_run(&scene, "", &desc, differently, TOLERANCE, false, &report),
                     RESULT_INTERNAL);
    ck_assert_ptr_nonnull(strstr(result_message(), "ref: 1 pixels"));
    for (int i = 0; i < RENDERER_COUNT; i++) {
        Renderer renderers[] = {pipeline_render, gl_render, truth_render};
        renderers[i] = fails;
        ck_assert_int_eq(threeway_run(&scene, "", &desc, renderers, TOLERANCE, true, &report),
                         RESULT_NO_GL);
        ck_assert_str_eq(result_message(), "gl: no driver");
        ck_assert(!report.agree);
        ck_assert_ptr_null(report.frames[RENDERER_REF].final.pixels);
    }
    scene_free(&scene);
}
END_TEST

START_TEST(test_pictures)
{
    Scene scene = generate("crossing_planes");
    RenderDesc desc = {.width = 330, .height = 100};
    Threeway report;
    ck_assert_int_eq(threeway_run(&scene, "", &desc, honest, TOLERANCE, true, &report), RESULT_OK);
    ck_assert_uint_eq(report.peel_count, (size_t)report.frames[RENDERER_REF].peels);
    ck_assert_uint_gt(report.peel_count, 1);
    for (size_t i = 0; i < report.peel_count; i++) {
        ck_assert_int_eq(report.peels[i].accum.width, 165);
        ck_assert_int_eq(report.peels[i].accum.height, 50);
        ck_assert_uint_gt(report.peels[i].pixels, 0);
        if (i > 0)
            ck_assert_uint_le(report.peels[i].pixels, report.peels[i - 1].pixels);
    }
    threeway_free(&report);
    scene_free(&scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("threeway");
    TCase *tcase = tcase_create("threeway");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, test_scenes, 0, 2 * (int)(sizeof cases / sizeof cases[0]));
    tcase_add_loop_test(tcase, test_shading_options, 0, 6);
    tcase_add_test(tcase, test_back_light);
    tcase_add_test(tcase, test_pass_limit);
    tcase_add_test(tcase, test_nothing_transparent);
    tcase_add_test(tcase, test_empty_view);
    tcase_add_loop_test(tcase, test_tiny_varyings, 0, 5);
    tcase_add_test(tcase, test_hidden_behind_halves);
    tcase_add_loop_test(tcase, test_broken_renderer, 0, FAULT_COUNT);
    tcase_add_test(tcase, test_blind_truth);
    tcase_add_test(tcase, test_wrong_truth);
    tcase_add_test(tcase, test_failures);
    tcase_add_test(tcase, test_pictures);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

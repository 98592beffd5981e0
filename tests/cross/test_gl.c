/* The OpenGL renderer by itself: errors become results, and small frames come out as computed by
 * hand. */
#include "pane.h"
#include "testing.h"

#include "base/memory.h"
#include "gl/context.h"
#include "gl/gl_renderer.h"
#include "gl/program.h"

#include <stdio.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- scenes of quads in front of a camera at the origin ------------------------------------- */

typedef struct Quad {
    double z; /* world space; the quad covers the view */
    float color[4];
    AlphaMode mode;
} Quad;

static char *copy_text(const char *text)
{
    size_t bytes = strlen(text) + 1;
    char *copy = memory_array(bytes, 1);
    memcpy(copy, text, bytes);
    return copy;
}

/* No lights, ambient 1: a surface's colour is its base colour. The caller frees the scene. */
static Scene quad_scene(const Quad *quads, size_t count)
{
    Scene scene = {.name = copy_text("quads"), .camera_count = 1, .ambient = {1, 1, 1}};
    scene.cameras = memory_array(1, sizeof *scene.cameras);
    scene.cameras[0] =
        (Camera){copy_text("camera"), matrix_identity(), .yfov = 1.0, .near = 0.5, .far = 50.0};
    scene.mesh_count = count > 0;
    scene.material_count = scene.instance_count = count;
    scene.meshes = memory_array(scene.mesh_count, sizeof *scene.meshes);
    scene.materials = memory_array(count, sizeof *scene.materials);
    scene.instances = memory_array(count, sizeof *scene.instances);
    scene.lights = memory_array(0, sizeof *scene.lights);
    if (count > 0)
        scene.meshes[0] = pane_mesh(9.0f, 0.0f, (float[]){0, 0, 1});
    for (size_t i = 0; i < count; i++) {
        scene.materials[i] = (Material){.name = copy_text("surface"),
                                        .roughness = 1.0f,
                                        .occlusion = 1.0f,
                                        .alpha_mode = quads[i].mode};
        memcpy(scene.materials[i].base_color, quads[i].color, sizeof quads[i].color);
        scene.instances[i] =
            (Instance){copy_text("quad"), 0, (uint32_t)i, matrix_translate(0, 0, quads[i].z)};
    }
    ck_assert_msg(scene_validate(&scene) == RESULT_OK, "%s", result_message());
    return scene;
}

static void assert_everywhere(const Frame *frame, const float expected[4])
{
    for (int y = 0; y < frame->final.height; y++)
        for (int x = 0; x < frame->final.width; x++)
            for (int k = 0; k < 4; k++)
                ck_assert_float_bits(((float *)image_pixel(&frame->final, x, y))[k], expected[k]);
}

static const RenderDesc small = {.width = 37, .height = 21};

/* ---- frames ---------------------------------------------------------------------------------- */

START_TEST(test_empty_scene_is_background)
{
    Scene scene = quad_scene(NULL, 0);
    memcpy(scene.background, (const float[3]){0.25f, 0.5f, 3.0f}, sizeof scene.background);
    Frame frame;
    ck_assert_msg(gl_render(&scene, &small, NULL, &frame) == RESULT_OK, "%s", result_message());
    assert_everywhere(&frame, (const float[4]){0.25f, 0.5f, 3.0f, 0.0f});
    ck_assert_int_eq(frame.peels, 0);
    ck_assert_int_eq(frame.final.width, 37);
    ck_assert_int_eq(frame.display.height, 21);
    frame_free(&frame);
    scene_free(&scene);
}
END_TEST

static const Quad layered[] = {
    {-9.0, {0.0f, 0.0f, 1.0f, 0.5f}, ALPHA_OPAQUE}, /* alpha of an opaque surface means nothing */
    {-2.0, {0.0f, 1.0f, 0.0f, 0.5f}, ALPHA_BLEND},
    {-1.0, {1.0f, 0.0f, 0.0f, 0.25f}, ALPHA_BLEND},
    {-12.0, {1.0f, 1.0f, 1.0f, 0.5f}, ALPHA_BLEND}, /* hidden */
};

START_TEST(test_layers_are_blended_front_to_back)
{
    Scene scene = quad_scene(layered, 4);
    Frame frame;
    ck_assert_msg(gl_render(&scene, &small, NULL, &frame) == RESULT_OK, "%s", result_message());
    /* 0.25 red, then 0.75·0.5 green, then what is left of blue. */
    assert_everywhere(&frame, (const float[4]){0.25f, 0.375f, 0.375f, 1.0f});
    ck_assert_int_eq(frame.peels, 2);
    ck_assert_uint_gt(frame.buffer_bytes, 0);
    ck_assert_int_ge(frame.threads, 1);
    frame_free(&frame);

    RenderDesc capped = small;
    capped.passes = 1;
    ck_assert(gl_render(&scene, &capped, NULL, &frame) == RESULT_OK);
    assert_everywhere(&frame, (const float[4]){0.25f, 0.0f, 0.75f, 1.0f});
    ck_assert_int_eq(frame.peels, 1);
    frame_free(&frame);
    scene_free(&scene);
}
END_TEST

START_TEST(test_seed_profile_gives_the_same_colour)
{
    Scene scene = quad_scene(layered, 3);
    RenderDesc desc = small;
    render_desc_seed_profile(&desc);
    Frame frame;
    ck_assert_msg(gl_render(&scene, &desc, NULL, &frame) == RESULT_OK, "%s", result_message());
    const float expected[4] = {0.25f, 0.375f, 0.375f, 1.0f};
    const float *pixel = image_pixel(&frame.final, 5, 5);
    for (int k = 0; k < 4; k++) /* 8-bit alpha, 16-bit accumulation */
        ck_assert_float_eq_tol(pixel[k], expected[k], 0.005);
    ck_assert_float_bits(pixel[3], 1.0f);
    frame_free(&frame);
    scene_free(&scene);
}
END_TEST

START_TEST(test_equal_depth_keeps_what_the_depth_function_says)
{
    const Quad coplanar[] = {{-2.0, {1.0f, 0.0f, 0.0f, 0.5f}, ALPHA_BLEND},
                             {-2.0, {0.0f, 1.0f, 0.0f, 0.5f}, ALPHA_BLEND}};
    Scene scene = quad_scene(coplanar, 2);
    Frame frame;
    RenderDesc desc = small;
    ck_assert(gl_render(&scene, &desc, NULL, &frame) == RESULT_OK);
    assert_everywhere(&frame, (const float[4]){0.5f, 0.0f, 0.0f, 0.5f});
    frame_free(&frame);
    desc.depth_func = DEPTH_LEQUAL;
    ck_assert(gl_render(&scene, &desc, NULL, &frame) == RESULT_OK);
    assert_everywhere(&frame, (const float[4]){0.0f, 0.5f, 0.0f, 0.5f});
    frame_free(&frame);
    scene_free(&scene);
}
END_TEST

/* ---- trace ------------------------------------------------------------------------------------
 */

typedef struct NameSink {
    TraceSink sink;
    char names[1024];
    int last_step, fail_after;
    bool top_is_first;
} NameSink;

static Result note_name(TraceSink *sink, const TraceBuffer *buffer)
{
    NameSink *notes = (NameSink *)sink;
    if (notes->fail_after-- == 0)
        return result_fail(RESULT_IO, "the sink is full");
    ck_assert_int_ge(buffer->step, notes->last_step);
    notes->last_step = buffer->step;
    size_t length = strlen(notes->names);
    snprintf(notes->names + length, sizeof notes->names - length, "%s ", buffer->name);
    if (!strcmp(buffer->name, "opaque.position")) {
        const float *first = buffer->pixels;
        notes->top_is_first = first[1] > 0.0f;
    }
    return RESULT_OK;
}

START_TEST(test_trace_is_complete_and_in_order)
{
    Scene scene = quad_scene(layered, 2);
    NameSink notes = {.sink = {.put = note_name}, .fail_after = -1};
    Frame frame;
    ck_assert(gl_render(&scene, &small, &notes.sink, &frame) == RESULT_OK);
    ck_assert_str_eq(notes.names,
                     "opaque.depth opaque.normal opaque.position opaque.diffuse opaque.material "
                     "peel.0.depth peel.0.normal peel.0.position peel.0.diffuse peel.0.material "
                     "peel.0.accum accum display ");
    ck_assert(notes.top_is_first);
    frame_free(&frame);

    notes = (NameSink){.sink = {.put = note_name}, .fail_after = 7};
    ck_assert(gl_render(&scene, &small, &notes.sink, &frame) == RESULT_IO);
    ck_assert_str_eq(result_message(), "the sink is full");
    ck_assert_ptr_null(frame.final.pixels);
    scene_free(&scene);
}
END_TEST

/* ---- errors -----------------------------------------------------------------------------------
 */

START_TEST(test_driver_errors_become_results)
{
    Context *context;
    ck_assert_msg(context_open(0, &context) == RESULT_OK, "%s", result_message());
    ck_assert(context_check(context, "nothing") == RESULT_OK);
    gl.Enable(0xdead);
    ck_assert(context_check(context, "a wrong capability") == RESULT_NO_GL);
    ck_assert_ptr_nonnull(strstr(result_message(), "a wrong capability: "));
    ck_assert_ptr_nonnull(strstr(result_message(), "glEnable"));
    ck_assert(context_check(context, "reported once") == RESULT_OK);
    context_close(context);
}
END_TEST

START_TEST(test_shader_errors_become_results)
{
    Context *context;
    ck_assert(context_open(0, &context) == RESULT_OK);
    GLuint program = 1;
    const char *broken = "void main() { x = 1; }";
    const char *unlinked = "void other();\nvoid main() { other(); }";
    ck_assert(program_build("broken", "", shader_fullscreen_vert, &broken, 1, &program) ==
              RESULT_NO_GL);
    ck_assert_uint_eq(program, 0);
    ck_assert_ptr_nonnull(strstr(result_message(), "broken fragment shader"));
    ck_assert(program_build("unlinked", "", "void main() {}", &unlinked, 1, &program) ==
              RESULT_NO_GL);
    context_close(context);
}
END_TEST

static ApiFunction lookup_nothing(const char *name)
{
    (void)name;
    return NULL;
}

START_TEST(test_missing_entry_point_is_named)
{
    ck_assert(api_load(lookup_nothing) == RESULT_NO_GL);
    ck_assert_ptr_nonnull(strstr(result_message(), "glAttachShader"));
}
END_TEST

START_TEST(test_memory_limit)
{
    Scene scene = quad_scene(layered, 2);
    RenderDesc desc = {.width = 1000, .height = 1000, .model_all = true, .max_memory = 100 << 20};
    Frame frame;
    ck_assert_msg(gl_render(&scene, &desc, NULL, &frame) == RESULT_NO_MEMORY, "%s",
                  result_message());
    ck_assert_ptr_nonnull(strstr(result_message(), "the limit is 102400 KiB"));
    ck_assert_ptr_null(frame.final.pixels);
    desc = (RenderDesc){.width = 0, .height = 5};
    ck_assert(gl_render(&scene, &desc, NULL, &frame) == RESULT_BAD_INPUT);
    scene_free(&scene);
}
END_TEST

START_TEST(test_light_limit)
{
    enum {
        MOST = 65535
    };
    Scene scene = quad_scene(layered, 1);
    RenderDesc desc = {.width = 2, .height = 2};
    Frame frame;
    free(scene.lights);
    scene.lights = memory_array(MOST + 1, sizeof *scene.lights);
    for (int i = 0; i <= MOST; i++)
        scene.lights[i] = (Light){.color = {1, 1, 1}, .attenuation = {1, 0, 0}};
    scene.light_count = MOST;
    ck_assert_msg(gl_render(&scene, &desc, NULL, &frame) == RESULT_OK, "%s", result_message());
    frame_free(&frame);
    scene.light_count = MOST + 1;
    ck_assert_int_eq(gl_render(&scene, &desc, NULL, &frame), RESULT_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(result_message(), "65536 lights, expected at most 65535"));
    scene_free(&scene);
}
END_TEST

/* ---- arithmetic mode ---------------------------------------------------------------------------
 */

/* A driver's mode is fixed per process, so a child finds it: 0 unfused, 1 fused, 2 failed. */
static int mode_of_child(const char *cpu_caps)
{
    pid_t child = fork();
    ck_assert_int_ge(child, 0);
    if (child == 0) {
        if (cpu_caps)
            setenv("GALLIUM_OVERRIDE_CPU_CAPS", cpu_caps, 1);
        else
            unsetenv("GALLIUM_OVERRIDE_CPU_CAPS");
        bool fused = false;
        _exit(gl_driver_fuses(0, &fused) != RESULT_OK ? 2 : fused ? 1 : 0);
    }
    int status;
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    ck_assert(WIFEXITED(status));
    return WEXITSTATUS(status);
}

START_TEST(test_mode_is_found)
{
    ck_assert_int_eq(mode_of_child("sse4.1"), 0);
#if defined(__x86_64__)
    ck_assert_int_eq(mode_of_child(NULL), __builtin_cpu_supports("fma") ? 1 : 0);
#endif
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gl");
    TCase *tcase = tcase_create("renderer");
    tcase_set_timeout(tcase, 120);
    tcase_add_test(tcase, test_empty_scene_is_background);
    tcase_add_test(tcase, test_layers_are_blended_front_to_back);
    tcase_add_test(tcase, test_seed_profile_gives_the_same_colour);
    tcase_add_test(tcase, test_equal_depth_keeps_what_the_depth_function_says);
    tcase_add_test(tcase, test_trace_is_complete_and_in_order);
    tcase_add_test(tcase, test_driver_errors_become_results);
    tcase_add_test(tcase, test_shader_errors_become_results);
    tcase_add_test(tcase, test_missing_entry_point_is_named);
    tcase_add_test(tcase, test_memory_limit);
    tcase_add_test(tcase, test_light_limit);
    tcase_add_test(tcase, test_mode_is_found);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

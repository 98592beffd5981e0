/* A session's frames: the bits of a single rendering, every time, whatever its options. */
#include "testing.h"

#include "frame/method.h"
#include "gl/gl_renderer.h"
#include "scene/generate.h"

#include <stdio.h>

static void ok(Result result)
{
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

static void assert_same(const Image *got, const Image *expected, const char *what)
{
    size_t bytes = format_pixel_bytes(got->format) * (size_t)got->width * (size_t)got->height;
    ck_assert_msg(memcmp(got->pixels, expected->pixels, bytes) == 0, "%s: other bits", what);
}

static const GlOptions options[] = {
    {0}, {.every_pass = true}, {.reject_early = true}, {true, true}};
enum {
    OPTIONS = sizeof options / sizeof *options,
    FRAMES = 2
};

/* All sessions are open at once and draw in turn. */
static void check_scene(const Scene *scene, const RenderDesc *desc, bool has_surfaces)
{
    Frame expected;
    GlSession *sessions[OPTIONS];
    ok(gl_render(scene, desc, NULL, &expected));
    for (int i = 0; i < OPTIONS; i++)
        ok(gl_session_open(scene, desc, &options[i], NULL, &sessions[i]));
    for (int i = 0; i < OPTIONS * FRAMES; i++) {
        Frame frame;
        char what[96];
        snprintf(what, sizeof what, "%s, %s, passes %d, options %d, frame %d", scene->name,
                 method_info(desc->method)->name, desc->passes, i % OPTIONS, i / OPTIONS);
        ok(gl_session_frame(sessions[i % OPTIONS], true, &frame));
        assert_same(&frame.final, &expected.final, what);
        assert_same(&frame.display, &expected.display, what);
        ck_assert_msg(frame.buffer_bytes == expected.buffer_bytes, "%s: memory", what);
        bool fixed = options[i % OPTIONS].every_pass && desc->passes > 0 && has_surfaces;
        if (!fixed)
            ck_assert_msg(frame.peels == expected.peels, "%s: %d peels", what, frame.peels);
        if (fixed && desc->method == METHOD_PEEL)
            ck_assert_int_eq(frame.peels, desc->passes);
        frame_free(&frame);
    }
    for (int i = 0; i < OPTIONS; i++)
        gl_session_close(sessions[i]);
    frame_free(&expected);
}

static void check(const char *name, const RenderDesc *desc)
{
    Scene scene;
    ok(generate_find(name)->generate(&scene));
    check_scene(&scene, desc, true);
    scene_free(&scene);
}

START_TEST(test_frames_are_those_of_a_single_rendering)
{
    /* More passes than there are layers, too few, and until a peel is empty. */
    RenderDesc desc = {.width = 48, .height = 27, .method = (MethodId)_i, .passes = 12};
    check("tutorial", &desc);
    desc.passes = 2;
    desc.depth_range = DEPTH_RANGE_REVERSED;
    desc.depth = FORMAT_D24;
    desc.gbuffer = GBUFFER_COMPACT;
    desc.accum = FORMAT_RGBA8;
    check("tutorial", &desc);
    desc.passes = 0;
    render_desc_seed_profile(&desc);
    check("crossing_planes", &desc);
}
END_TEST

/* Opaque surfaces, too. */
START_TEST(test_scenes_with_opaque_surfaces)
{
    RenderDesc desc = {.width = 48, .height = 27, .lights = 3, .method = (MethodId)_i, .passes = 3};
    check(testing_full() ? "teapot_hall" : "lamps", &desc);
}
END_TEST

/* No pass has a buffer to write to. */
START_TEST(test_scenes_without_surfaces)
{
    RenderDesc desc = {.width = 48, .height = 27, .method = (MethodId)_i, .passes = 3};
    Scene scene;
    ok(generate_find("crossing_planes")->generate(&scene));
    for (size_t i = 0; i < scene.material_count; i++) {
        scene.materials[i].alpha_mode = ALPHA_BLEND;
        scene.materials[i].base_color[3] = 0.0f;
    }
    check_scene(&scene, &desc, false);
    scene_free(&scene);
}
END_TEST

START_TEST(test_images_are_read_back_on_request)
{
    Scene scene;
    GlSession *session;
    Frame frame;
    const RenderDesc desc = {.width = 16, .height = 9};
    ok(generate_find("tutorial")->generate(&scene));
    ok(gl_session_open(&scene, &desc, NULL, NULL, &session));
    ok(gl_session_frame(session, false, &frame));
    ck_assert_ptr_null(frame.final.pixels);
    ck_assert_int_gt(frame.peels, 0);
    ck_assert_uint_gt(frame.buffer_bytes, 0);
    gl_session_close(session);
    gl_session_close(NULL);
    const RenderDesc capped = {.width = 160, .height = 90, .max_memory = 4096};
    ck_assert_int_eq(gl_session_open(&scene, &capped, NULL, NULL, &session), RESULT_NO_MEMORY);
    ck_assert_ptr_null(session);
    scene_free(&scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gl session");
    TCase *frames = tcase_create("frames");
    tcase_set_timeout(frames, 300);
    tcase_add_loop_test(frames, test_frames_are_those_of_a_single_rendering, 0, METHOD_COUNT);
    tcase_add_loop_test(frames, test_scenes_with_opaque_surfaces, 0, METHOD_COUNT);
    tcase_add_loop_test(frames, test_scenes_without_surfaces, 0, METHOD_COUNT);
    tcase_add_test(frames, test_images_are_read_back_on_request);
    suite_add_tcase(suite, frames);
    return testing_run(suite);
}

/* The rules of a scene, and what is added where a file gives nothing. */
#include "scene/builder.h"
#include "scene/scene.h"
#include "scene/shapes.h"

#include "testing.h"

#include <math.h>

static Scene scene; /* two instances of a unit quad at x = ±2, one light, one camera */

static void make(void)
{
    Builder builder = builder_begin("test");
    Mesh mesh;
    Result made = shapes_plane(1.0, 1.0, 1, 1, &mesh);
    Instance instance = {.mesh = builder_mesh(&builder, made, &mesh)};
    Material material = {.base_color = {0.5f, 0.5f, 0.5f, 1.0f},
                         .roughness = 0.5f,
                         .occlusion = 1.0f,
                         .alpha_cutoff = 0.5f};
    instance.material = builder_material(&builder, &material, "gray");
    for (int side = -1; side <= 1; side += 2) {
        instance.world = matrix_translate(2.0 * side, 0.0, 0.0);
        builder_instance(&builder, &instance, "quad");
    }
    builder_light(&builder, &(Light){.color = {1.0f, 1.0f, 1.0f}, .attenuation = {0, 0, 1.0f}});
    builder_camera(&builder,
                   &(Camera){.world = matrix_identity(), .yfov = 1.0, .near = 0.1, .far = INFINITY},
                   "eye");
    ck_assert_msg(builder_finish(&builder, &scene) == RESULT_OK, "%s", result_message());
}

static void drop(void)
{
    scene_free(&scene);
    ck_assert_ptr_null(scene.meshes);
}

/* The scene is refused with a message that contains part. */
static void refused(const char *part)
{
    ck_assert_int_eq(scene_validate(&scene), RESULT_BAD_INPUT);
    ck_assert_msg(strstr(result_message(), part) != NULL, "got \"%s\", expected \"%s\" in it",
                  result_message(), part);
}

START_TEST(good_scene_passes)
{
    ck_assert_int_eq(scene_validate(&scene), RESULT_OK);
    ck_assert_uint_eq(scene_triangle_count(&scene), 4);
}
END_TEST

START_TEST(bad_meshes)
{
    float kept = scene.meshes[0].position[4];
    scene.meshes[0].position[4] = NAN;
    refused("mesh 0: position of vertex 1 is not finite");
    scene.meshes[0].position[4] = kept;
    scene.meshes[0].normal[0] = INFINITY;
    refused("mesh 0: normal of vertex 0 is not finite");
    scene.meshes[0].normal[0] = -1.1e15f;
    refused("mesh 0: normal of vertex 0 has component -1.1e+15");
    scene.meshes[0].normal[0] = 0.0f;
    scene.meshes[0].index[5] = 4;
    refused("mesh 0: index 4 of triangle 1 is out of range");
    scene.meshes[0].index[5] = 3;
    scene.meshes[0].triangle_count = 0;
    refused("mesh 0: 4 vertices and 0 triangles");
    scene.meshes[0].triangle_count = 2;
    ck_assert_int_eq(scene_validate(&scene), RESULT_OK);
}
END_TEST

START_TEST(bad_materials)
{
    Material good = scene.materials[0];
    scene.materials[0].base_color[3] = 1.5f;
    refused("material 0: alpha is 1.5");
    scene.materials[0] = good;
    scene.materials[0].roughness = NAN;
    refused("material 0: roughness");
    scene.materials[0] = good;
    scene.materials[0].alpha_cutoff = -1.0f;
    refused("material 0: alpha cutoff");
    scene.materials[0] = good;
}
END_TEST

START_TEST(bad_instances)
{
    Instance good = scene.instances[1];
    scene.instances[1].mesh = 1;
    refused("instance 1: mesh 1");
    scene.instances[1] = good;
    scene.instances[1].world.m[3] = 0.5;
    refused("instance 1: world matrix is not affine");
    scene.instances[1] = good;
    scene.instances[1].world.m[12] = NAN;
    refused("instance 1: world matrix has element");
    scene.instances[1] = good;
    scene.instances[1].world = matrix_scale(3e15, 1.0, 1.0);
    refused("instance 1: world matrix has element");
    scene.instances[1].world = matrix_scale(1e15, 1.0, 1.0);
    scene.meshes[0].position[0] = 1e3f;
    refused("instance 1: reaches beyond");
    scene.instances[1] = good;
    scene.instances[1].world = matrix_scale(1.0, 0.0, 1.0); /* flat is legal */
    ck_assert_int_eq(scene_validate(&scene), RESULT_OK);
}
END_TEST

START_TEST(bad_lights)
{
    Light good = scene.lights[0];
    scene.lights[0].color[1] = -1.0f;
    refused("light 0: intensity is -1");
    scene.lights[0].color[1] = 2e12f;
    refused("light 0: intensity is 2e+12");
    scene.lights[0] = good;
    scene.lights[0].attenuation[2] = 0.0f;
    refused("light 0: attenuation is 0 at a distance of 0.01");
    scene.lights[0].attenuation[2] = 0.99e-4f;
    refused("at a distance of 0.01");
    scene.lights[0].attenuation[2] = 1e-4f; /* on the limit */
    ck_assert_int_eq(scene_validate(&scene), RESULT_OK);
    scene.lights[0].attenuation[0] = INFINITY;
    refused("light 0: attenuation is inf");
    scene.lights[0] = good;
    scene.lights[0].position[2] = NAN;
    refused("light 0: position");
    scene.lights[0] = good;
    static const float ranges[] = {-1.0f, INFINITY, NAN};
    for (int i = 0; i < 3; i++) {
        scene.lights[0].range = ranges[i];
        refused("light 0: range is");
    }
    scene.lights[0].range = 1e-45f; /* short, but legal */
    ck_assert_int_eq(scene_validate(&scene), RESULT_OK);
    scene.lights[0] = good;
}
END_TEST

START_TEST(bad_cameras)
{
    Camera good = scene.cameras[0];
    scene.cameras[0].yfov = 3.15;
    refused("camera 0: vertical field of view");
    scene.cameras[0] = good;
    scene.cameras[0].far = 0.1;
    refused("camera 0: near 0.1 and far 0.1");
    scene.cameras[0] = good;
    scene.cameras[0].near = 0.0;
    refused("camera 0: near 0");
    scene.cameras[0] = good;
    scene.cameras[0].world = matrix_scale(1.0, 0.0, 1.0);
    refused("camera 0: world matrix has no inverse");
    scene.cameras[0] = good;
    scene.ambient[0] = NAN;
    refused("scene: ambient");
}
END_TEST

START_TEST(bounds_in_world_space)
{
    double low[3], high[3];
    ck_assert(scene_bounds(&scene, low, high));
    ck_assert(low[0] == -2.5 && high[0] == 2.5 && low[1] == -0.5 && high[2] == 0.0);
    size_t count = scene.instance_count;
    scene.instance_count = 0;
    ck_assert(!scene_bounds(&scene, low, high));
    scene.instance_count = count;
}
END_TEST

START_TEST(opacity_sets_the_mode)
{
    scene_override_opacity(&scene, 0.3f);
    ck_assert_int_eq(scene.materials[0].alpha_mode, ALPHA_BLEND);
    ck_assert_float_bits(scene.materials[0].base_color[3], 0.3f);
    scene_override_opacity(&scene, 1.0f);
    ck_assert_int_eq(scene.materials[0].alpha_mode, ALPHA_OPAQUE);
    scene.materials[0].alpha_mode = ALPHA_MASK;
    scene_override_opacity(&scene, 1.0f);
    ck_assert_int_eq(scene.materials[0].alpha_mode, ALPHA_MASK);
    scene_override_opacity(&scene, 0.0f);
    ck_assert_int_eq(scene.materials[0].alpha_mode, ALPHA_BLEND);
}
END_TEST

/* Every corner of the bounds lies inside the framing camera's square frustum. */
static void check_framing(void)
{
    double low[3], high[3];
    ck_assert_int_eq(scene_add_framing_camera(&scene), RESULT_OK);
    ck_assert_int_eq(scene_validate(&scene), RESULT_OK);
    ck_assert(scene_bounds(&scene, low, high));
    const Camera *camera = &scene.cameras[scene.camera_count - 1];
    Matrix view;
    ck_assert(matrix_invert_affine(&camera->world, &view));
    double slope = matrix_tan(camera->yfov * 0.5);
    for (int corner = 0; corner < 8; corner++) {
        const double point[3] = {corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1],
                                 corner & 4 ? high[2] : low[2]};
        double seen[3];
        matrix_point(&view, point, seen);
        ck_assert(-seen[2] > camera->near && -seen[2] < camera->far);
        ck_assert(fabs(seen[0]) < -seen[2] * slope && fabs(seen[1]) < -seen[2] * slope);
    }
}

START_TEST(framing_camera_sees_all)
{
    check_framing();
    scene.instances[0].world = matrix_translate(1e6, -3e6, 2e5);
    check_framing();
    scene.instances[0].world = scene.instances[1].world = matrix_translate(1e9, 1e9, 1e9);
    check_framing();
    scene.instances[0].world = scene.instances[1].world = matrix_scale(1e-9, 1e-9, 1e-9);
    check_framing();
}
END_TEST

START_TEST(default_lights_are_valid)
{
    ck_assert_int_eq(scene_add_default_lights(&scene), RESULT_OK);
    ck_assert_uint_eq(scene.light_count, 4);
    ck_assert_int_eq(scene_validate(&scene), RESULT_OK);
    size_t count = scene.instance_count;
    scene.instance_count = 0; /* nothing to size them by */
    ck_assert_int_eq(scene_add_default_lights(&scene), RESULT_OK);
    ck_assert_int_eq(scene_add_framing_camera(&scene), RESULT_OK);
    ck_assert_int_eq(scene_validate(&scene), RESULT_OK);
    scene.instance_count = count;
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("scene");
    TCase *test = tcase_create("scene");
    tcase_add_checked_fixture(test, make, drop);
    tcase_add_test(test, good_scene_passes);
    tcase_add_test(test, bad_meshes);
    tcase_add_test(test, bad_materials);
    tcase_add_test(test, bad_instances);
    tcase_add_test(test, bad_lights);
    tcase_add_test(test, bad_cameras);
    tcase_add_test(test, bounds_in_world_space);
    tcase_add_test(test, opacity_sets_the_mode);
    tcase_add_test(test, framing_camera_sees_all);
    tcase_add_test(test, default_lights_are_valid);
    suite_add_tcase(suite, test);
    return testing_run(suite);
}

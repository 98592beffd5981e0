/* report/contract: what is exported for other renderers has the bits that Peel's renderers use. */
#include "report/contract.h"

#include "base/file.h"
#include "base/memory.h"
#include "frame/view.h"
#include "scene/generate.h"
#include "scene/gltf.h"
#include "scratch.h"
#include "testing.h"

#include <jansson.h>

static RenderDesc small_desc(void)
{
    return (RenderDesc){
        .width = 64, .height = 36, .lights = 5, .time = 3.5, .depth_range = DEPTH_RANGE_REVERSED};
}

/* A built-in scene whose first material has a texture of 8 bits. */
static void make_scene(Scene *out)
{
    ck_assert_int_eq(generate_find("lamps")->generate(out), RESULT_OK);
    ck_assert_uint_eq(out->texture_count, 0);
    out->textures = memory_array(1, sizeof *out->textures);
    out->texture_count = 1;
    Texture *texture = &out->textures[0];
    *texture = (Texture){.width = 3, .height = 2, .wrap_s = WRAP_MIRROR, .nearest = true};
    texture->texels = memory_array(3 * 2, sizeof(float[4]));
    for (int i = 0; i < 3 * 2 * 4; i++)
        texture->texels[i] = i % 4 == 3 ? 1.0f : (float)(i % 2);
    out->materials[0].base_color_texture = 1;
}

static json_t *export_scene(const Scene *scene, const RenderDesc *desc)
{
    ContractDesc contract = {.name = scene->name,
                             .scene = scene,
                             .desc = *desc,
                             .check = "peel check",
                             .glsl_constants = "#define CONSTANT 1\n",
                             .glsl_shade = "vec4 shade();\n"};
    ck_assert_msg(report_contract_write(&contract, scratch_directory) == RESULT_OK, "%s",
                  result_message());
    json_error_t error;
    json_t *root = json_load_file(scratch_path("contract.json"), 0, &error);
    ck_assert_msg(root != NULL, "%s", error.text);
    return root;
}

static void assert_floats(json_t *object, const char *key, const float *expected, size_t count)
{
    json_t *array = json_object_get(object, key);
    ck_assert_msg(json_array_size(array) == count, "%s: %zu values", key, json_array_size(array));
    for (size_t i = 0; i < count; i++)
        ck_assert_float_bits(strtof(json_string_value(json_array_get(array, i)), NULL),
                             expected[i]);
}

static void assert_float(json_t *object, const char *key, float expected)
{
    ck_assert_float_bits(strtof(json_string_value(json_object_get(object, key)), NULL), expected);
}

static void assert_draws(json_t *draws, const Scene *scene, const View *view)
{
    ck_assert_uint_eq(json_array_size(draws), view->draw_count);
    size_t count;
    unsigned char *vertices, *indices;
    ck_assert_int_eq(file_load(scratch_path("vertices.bin"), &vertices, &count), RESULT_OK);
    ck_assert_int_eq(file_load(scratch_path("indices.bin"), &indices, &count), RESULT_OK);
    for (size_t i = 0; i < view->draw_count; i++) {
        const Draw *draw = &view->draws[i];
        const Mesh *mesh = &scene->meshes[draw->mesh];
        json_t *object = json_array_get(draws, i);
        assert_floats(object, "model_view", draw->model_view, 16);
        assert_floats(object, "normal_matrix", draw->normal_matrix, 9);
        ck_assert_int_eq(json_is_true(json_object_get(object, "transparent")), draw->transparent);
        ck_assert_int_eq(json_is_true(json_object_get(object, "cull_back")), draw->cull_back);
        ck_assert_int_eq(json_is_true(json_object_get(object, "flipped")), draw->flipped);
        json_int_t first = json_integer_value(json_object_get(object, "first_index"));
        json_int_t base = json_integer_value(json_object_get(object, "base_vertex"));
        ck_assert_int_eq(json_integer_value(json_object_get(object, "index_count")),
                         3 * (json_int_t)mesh->triangle_count);
        ck_assert_mem_eq(indices + 4 * first, mesh->index, mesh->triangle_count * 12);
        for (uint32_t v = 0; v < mesh->vertex_count; v++) {
            ck_assert_mem_eq(vertices + 32 * (base + v), mesh->position + 3 * v, 12);
            ck_assert_mem_eq(vertices + 32 * (base + v) + 12, mesh->normal + 3 * v, 12);
        }
    }
    free(vertices);
    free(indices);
}

START_TEST(test_bits)
{
    Scene scene, loaded;
    View view;
    RenderDesc desc = small_desc();
    make_scene(&scene);
    json_t *root = export_scene(&scene, &desc);
    /* What Peel makes of the file that lies beside it. */
    ck_assert_int_eq(gltf_load(scratch_path("scene.gltf"), &loaded), RESULT_OK);
    ck_assert_int_eq(view_build(&loaded, &desc, &view), RESULT_OK);
    json_t *camera = json_object_get(root, "camera"), *depth = json_object_get(root, "depth");
    assert_floats(camera, "world_to_camera", view.world_to_camera, 16);
    assert_floats(camera, "projection", view.projection, 16);
    assert_floats(root, "ambient", view.ambient, 3);
    assert_floats(root, "background", view.background, 3);
    ck_assert_int_eq(json_integer_value(json_object_get(depth, "clear")), 0);
    ck_assert_str_eq(json_string_value(json_object_get(depth, "clip_z")), "0 to w");
    json_t *lights = json_object_get(root, "lights");
    ck_assert_uint_eq(json_array_size(lights), 5);
    for (size_t i = 0; i < 5; i++) {
        json_t *light = json_array_get(lights, i);
        assert_floats(light, "position", view.lights[i].position, 3);
        assert_floats(light, "color", view.lights[i].color, 3);
        assert_floats(light, "attenuation", view.lights[i].attenuation, 3);
        assert_float(light, "inverse_range2", view.lights[i].inverse_range2);
    }
    json_t *materials = json_object_get(root, "materials");
    for (size_t i = 0; i < loaded.material_count; i++)
        assert_floats(json_array_get(materials, i), "base_color", loaded.materials[i].base_color,
                      4);
    assert_draws(json_object_get(root, "draws"), &loaded, &view);
    json_decref(root);
    view_free(&view);
    scene_free(&loaded);
    scene_free(&scene);
}
END_TEST

START_TEST(test_files)
{
    Scene scene;
    RenderDesc desc = small_desc();
    make_scene(&scene);
    json_t *root = export_scene(&scene, &desc);
    json_t *texture = json_array_get(json_object_get(root, "textures"), 0);
    ck_assert_int_eq(json_integer_value(json_object_get(texture, "width")), 3);
    ck_assert_str_eq(json_string_value(json_object_get(texture, "wrap_s")), "mirror");
    ck_assert(json_is_true(json_object_get(texture, "nearest")));
    unsigned char *texels;
    size_t count;
    char text[4096];
    ck_assert_int_eq(file_load(scratch_path("textures.bin"), &texels, &count), RESULT_OK);
    ck_assert_uint_eq(count, 3 * 2 * 16);
    ck_assert_mem_eq(texels, scene.textures[0].texels, count);
    free(texels);
    scratch_read(scratch_path("shade.glsl"), text, sizeof text);
    ck_assert_ptr_nonnull(strstr(text, "#define CONSTANT 1\n#define LIGHT_COUNT 5\n"));
    ck_assert_ptr_nonnull(strstr(text, "vec4 shade();"));
    ck_assert_int_eq(scratch_entries(), 9);
    json_decref(root);
    /* A folder that is not there, a camera that is not there: one line. */
    ContractDesc contract = {.name = "",
                             .scene = &scene,
                             .desc = desc,
                             .check = "",
                             .glsl_constants = "",
                             .glsl_shade = ""};
    ck_assert_int_eq(report_contract_write(&contract, scratch_path("none")), RESULT_IO);
    contract.desc.camera = 99;
    ck_assert_int_eq(report_contract_write(&contract, scratch_directory), RESULT_BAD_INPUT);
    ck_assert_int_eq(report_contract_page(scratch_path("none/page.html")), RESULT_IO);
    scene_free(&scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("contract");
    TCase *tests = tcase_create("contract");
    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, scratch_make, scratch_remove);
    tcase_add_test(tests, test_bits);
    tcase_add_test(tests, test_files);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

/* scene/blob.h: what is written comes back with its bits, and nothing else is taken for a scene. */
#include "testing.h"

#include "base/random.h"
#include "scene/blob.h"
#include "scene/builder.h"
#include "scene/generate.h"
#include "scene/shapes.h"

#include <math.h>
#include <stdio.h>

/* A texture whose red has two values, green one each per texel, and whose zeros differ in sign. */
static Result make_texture(Texture *out)
{
    *out = (Texture){.width = 32, .height = 17, .wrap_t = WRAP_MIRROR, .nearest = true};
    out->texels = malloc(4 * 32 * 17 * sizeof *out->texels);
    for (int i = 0; i < 32 * 17; i++) {
        float texel[4] = {i % 3 ? 0.0f : -0.0f, (float)i / 544.0f, (float)(i % 256) / 255.0f, 1.0f};
        memcpy(&out->texels[4 * i], texel, sizeof texel);
    }
    return RESULT_OK;
}

static void make(Scene *out)
{
    Builder builder = builder_begin("na\xc3\xafve \"quoted\"");
    Mesh mesh;
    Texture texture;
    Result made = shapes_plane(1.0, 2.0, 3, 2, &mesh);
    if (made == RESULT_OK)
        mesh.uv = calloc(mesh.vertex_count, 2 * sizeof *mesh.uv);
    Instance instance = {.mesh = builder_mesh(&builder, made, &mesh),
                         .world = matrix_rotate_y(0.3)};
    Material material = {.base_color = {0.1f, 0.2f, 0.3f, 0.4f},
                         .roughness = 0.5f,
                         .metallic = 0.25f,
                         .occlusion = 0.75f,
                         .alpha_mode = ALPHA_MASK,
                         .alpha_cutoff = 0.125f,
                         .double_sided = true};
    material.base_color_texture = builder_texture(&builder, make_texture(&texture), &texture);
    instance.material = builder_material(&builder, &material, "");
    builder_instance(&builder, &instance, "plane");
    builder_light(&builder, &(Light){.position = {1, 2, 3},
                                     .color = {4, 5, 6},
                                     .attenuation = {1, 0.5f, 0.25f},
                                     .range = 7});
    builder_camera(&builder,
                   &(Camera){.world = matrix_identity(), .yfov = 1.0, .near = 0.1, .far = INFINITY},
                   "eye");
    builder.scene.light_degrees_per_second = 12.5;
    ck_assert_msg(builder_finish(&builder, out) == RESULT_OK, "%s", result_message());
}

/* Writes scene, reads that, writes it again: the same bytes. The caller frees *bytes. */
static void check_round_trip(const Scene *scene, unsigned char **bytes, size_t *count)
{
    unsigned char *again;
    size_t again_count;
    Scene copy;
    ck_assert_int_eq(blob_write(scene, bytes, count), RESULT_OK);
    ck_assert_msg(blob_read(*bytes, *count, &copy) == RESULT_OK, "%s", result_message());
    ck_assert_int_eq(blob_write(&copy, &again, &again_count), RESULT_OK);
    ck_assert_uint_eq(again_count, *count);
    ck_assert_mem_eq(again, *bytes, *count);
    ck_assert_str_eq(copy.name, scene->name);
    ck_assert_uint_eq(scene_triangle_count(&copy), scene_triangle_count(scene));
    free(again);
    scene_free(&copy);
}

START_TEST(test_built_in)
{
    size_t scenes;
    const BuiltinScene *table = generate_table(&scenes);
    for (size_t i = 0; i < scenes; i++) {
        Scene scene;
        unsigned char *bytes;
        size_t count;
        ck_assert_int_eq(table[i].generate(&scene), RESULT_OK);
        check_round_trip(&scene, &bytes, &count);
        free(bytes);
        scene_free(&scene);
    }
}
END_TEST

START_TEST(test_fields)
{
    Scene scene, copy;
    unsigned char *bytes;
    size_t count;
    make(&scene);
    check_round_trip(&scene, &bytes, &count);
    ck_assert_int_eq(blob_read(bytes, count, &copy), RESULT_OK);
    const Texture *texture = &copy.textures[0];
    ck_assert_mem_eq(texture->texels, scene.textures[0].texels,
                     4 * sizeof(float) * texture->width * texture->height);
    ck_assert(texture->wrap_t == WRAP_MIRROR && texture->wrap_s == WRAP_REPEAT && texture->nearest);
    Material got = copy.materials[0], expected = scene.materials[0];
    got.name = expected.name = NULL;
    ck_assert_mem_eq(got.base_color, expected.base_color, sizeof got.base_color);
    ck_assert(got.alpha_mode == expected.alpha_mode && got.double_sided);
    ck_assert_float_bits(got.alpha_cutoff, expected.alpha_cutoff);
    ck_assert_float_bits(got.roughness, 0.5f);
    ck_assert_float_bits(got.metallic, 0.25f);
    ck_assert_float_bits(got.occlusion, 0.75f);
    ck_assert_uint_eq(got.base_color_texture, 1);
    ck_assert_mem_eq(&copy.instances[0].world, &scene.instances[0].world, sizeof(Matrix));
    const Light *light = &copy.lights[0];
    ck_assert(light->position[2] == 3.0 && light->color[1] == 5.0f &&
              light->attenuation[2] == 0.25f && light->range == 7.0f);
    ck_assert(isinf(copy.cameras[0].far) && copy.cameras[0].near == 0.1);
    ck_assert(copy.light_degrees_per_second == 12.5);
    free(bytes);
    scene_free(&copy);
    scene_free(&scene);
}
END_TEST

/* A texture of 256 values a channel takes a byte a channel; one of more takes floats. */
START_TEST(test_palettes)
{
    Scene scene;
    unsigned char *bytes;
    size_t few, many;
    make(&scene);
    Texture *texture = &scene.textures[0];
    size_t texels = (size_t)texture->width * texture->height;
    check_round_trip(&scene, &bytes, &many);
    free(bytes);
    for (size_t i = 0; i < texels; i++)
        texture->texels[4 * i + 1] = 0.5f;
    check_round_trip(&scene, &bytes, &few);
    free(bytes);
    ck_assert_uint_eq(many - few, 3 * texels - sizeof(float)); /* floats against codes, one value */
    scene_free(&scene);
}
END_TEST

START_TEST(test_refuses)
{
    Scene scene, copy;
    unsigned char *bytes;
    size_t count;
    make(&scene);
    ck_assert_int_eq(blob_write(&scene, &bytes, &count), RESULT_OK);
    for (size_t cut = 0; cut < count; cut += cut < 600 ? 1 : 97) {
        ck_assert_int_eq(blob_read(bytes, cut, &copy), RESULT_BAD_INPUT);
        ck_assert_ptr_null(copy.meshes);
    }
    unsigned char *longer = malloc(count + 1);
    memcpy(longer, bytes, count);
    longer[count] = 0;
    ck_assert_int_eq(blob_read(longer, count + 1, &copy), RESULT_BAD_INPUT);
    /* Any byte may be wrong: the scene is refused or a valid one. */
    Random random = random_seed(8);
    for (int i = 0; i < 20000; i++) {
        size_t at = random_bits(&random) % count;
        unsigned char kept = bytes[at];
        bytes[at] = (unsigned char)random_bits(&random);
        if (blob_read(bytes, count, &copy) == RESULT_OK)
            ck_assert_int_eq(scene_validate(&copy), RESULT_OK);
        scene_free(&copy);
        bytes[at] = kept;
    }
    free(longer);
    free(bytes);
    scene_free(&scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("blob");
    TCase *tcase = tcase_create("blob");
    tcase_set_timeout(tcase, 120);
    tcase_add_test(tcase, test_built_in);
    tcase_add_test(tcase, test_fields);
    tcase_add_test(tcase, test_palettes);
    tcase_add_test(tcase, test_refuses);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

/* What a frame needs, item by item, of scenes made by hand. */
#include "testing.h"

#include "frame/needs.h"
#include "number/op.h"

/* Two instances, opaque and transparent, of materials that differ in nothing. */
typedef struct Small {
    Scene scene;
    Material materials[3];
    Draw draws[3];
    View view;
    RenderDesc desc;
} Small;

static Small small;

static void make(void)
{
    const Material material = {.name = "",
                               .base_color = {0.5f, 0.5f, 0.5f, 0.5f},
                               .roughness = 0.3f,
                               .metallic = 0.2f,
                               .occlusion = 0.9f,
                               .double_sided = true};
    memset(&small, 0, sizeof small);
    for (uint32_t i = 0; i < 3; i++) {
        small.materials[i] = material;
        small.draws[i] = (Draw){.material = i, .transparent = i > 0};
    }
    small.scene = (Scene){.material_count = 3, .materials = small.materials, .texture_count = 2};
    small.view = (View){.draw_count = 3, .draws = small.draws, .light_count = 4};
    small.desc = (RenderDesc){.width = 8, .height = 8};
}

static Needs derive(void)
{
    Needs needs;
    needs_derive(&small.scene, &small.view, &small.desc, false, &needs);
    for (int i = 0; i < NEED_COUNT; i++)
        ck_assert_ptr_nonnull(needs.items[i].why);
    return needs;
}

static bool needed(NeedId id)
{
    Needs needs = derive();
    return needs_has(&needs, id);
}

#define NEEDED(id)     ck_assert_msg(needed(id), "%s: expected to be needed", needs_name(id))
#define NOT_NEEDED(id) ck_assert_msg(!needed(id), "%s: expected not to be needed", needs_name(id))

START_TEST(test_lit)
{
    make();
    NEEDED(NEED_OPAQUE);
    NEEDED(NEED_TRANSPARENT);
    NEEDED(NEED_LIGHTS);
    NEEDED(NEED_NORMAL);
    NEEDED(NEED_POSITION);
    NEEDED(NEED_FACING);
    NEEDED(NEED_BACK_FACES);
    NOT_NEEDED(NEED_MATERIAL);
    NOT_NEEDED(NEED_CULLING);
    NOT_NEEDED(NEED_MASK);
    NOT_NEEDED(NEED_BASE_COLOR_TEXTURE);
    NOT_NEEDED(NEED_MATERIAL_TEXTURE);
    NOT_NEEDED(NEED_ALPHA);
    NOT_NEEDED(NEED_ALPHA_TEST);
    NOT_NEEDED(NEED_DOUBLE);
}
END_TEST

START_TEST(test_unlit)
{
    make();
    small.view.light_count = 0;
    NOT_NEEDED(NEED_LIGHTS);
    NOT_NEEDED(NEED_NORMAL);
    NOT_NEEDED(NEED_POSITION);
    NOT_NEEDED(NEED_FACING);
    small.desc.method = METHOD_WEIGHTED_BLENDED;
    NEEDED(NEED_POSITION);
    NOT_NEEDED(NEED_NORMAL);
    small.draws[1].transparent = small.draws[2].transparent = false;
    NOT_NEEDED(NEED_POSITION);
}
END_TEST

START_TEST(test_phong)
{
    make();
    small.view.light_count = 0;
    small.desc.shading = SHADING_PHONG;
    small.materials[1].roughness = small.materials[1].occlusion = 0.1f;
    NEEDED(NEED_NORMAL);
    NOT_NEEDED(NEED_POSITION);
    NOT_NEEDED(NEED_MATERIAL);
}
END_TEST

START_TEST(test_material)
{
    make();
    small.materials[0].roughness = 0.7f; /* another list's */
    NOT_NEEDED(NEED_MATERIAL);
    small.materials[1].roughness = 0.7f;
    NEEDED(NEED_MATERIAL);
    small.view.light_count = 0;
    NOT_NEEDED(NEED_MATERIAL);
    small.materials[2].occlusion = 0.1f;
    NEEDED(NEED_MATERIAL);
    small.desc.method = METHOD_FORWARD;
    NOT_NEEDED(NEED_MATERIAL);
    small.desc.peel_test = PEEL_TEST_RAW;
    NEEDED(NEED_MATERIAL);
    make();
    small.materials[1].metallic = 0.7f;
    NEEDED(NEED_MATERIAL);
    make();
    small.desc.peel_test = PEEL_TEST_RAW;
    NEEDED(NEED_MATERIAL);
    small.desc.method = METHOD_PEEL_ID;
    NOT_NEEDED(NEED_MATERIAL);
}
END_TEST

START_TEST(test_textures)
{
    bool wanted[2];
    make();
    small.materials[0].base_color_texture = 2;
    small.materials[2].metallic_roughness_texture = 1;
    NEEDED(NEED_BASE_COLOR_TEXTURE);
    NEEDED(NEED_MATERIAL_TEXTURE);
    NEEDED(NEED_MATERIAL);
    NOT_NEEDED(NEED_MASK);
    small.draws[0].masked = true;
    NEEDED(NEED_MASK);
    small.view.light_count = 0;
    NEEDED(NEED_BASE_COLOR_TEXTURE);
    NOT_NEEDED(NEED_MATERIAL_TEXTURE);
    NOT_NEEDED(NEED_MATERIAL);
    Needs needs = derive();
    needs_textures(&needs, &small.scene, &small.view, wanted);
    ck_assert(!wanted[0]);
    ck_assert(wanted[1]);
    small.view.draws++; /* the first is not drawn */
    small.view.draw_count--;
    needs = derive();
    needs_textures(&needs, &small.scene, &small.view, wanted);
    ck_assert(!wanted[0]);
    ck_assert(!wanted[1]);
}
END_TEST

START_TEST(test_alpha)
{
    make();
    small.materials[0].base_color[3] = 0.0f; /* opaque */
    NOT_NEEDED(NEED_ALPHA);
    NOT_NEEDED(NEED_ALPHA_TEST);
    small.materials[1].base_color[3] = 0.25f;
    NEEDED(NEED_ALPHA);
    NOT_NEEDED(NEED_ALPHA_TEST);
    small.materials[1].base_color[3] = 0.001f; /* 0 in 8 bits */
    NEEDED(NEED_ALPHA_TEST);
    make();
    small.materials[1].base_color_texture = 1;
    NEEDED(NEED_ALPHA);
    NEEDED(NEED_ALPHA_TEST);
}
END_TEST

START_TEST(test_sides)
{
    make();
    small.draws[1].cull_back = true;
    NEEDED(NEED_CULLING);
    NEEDED(NEED_FACING);
    NEEDED(NEED_BACK_FACES);
    small.desc.normals = NORMALS_KEPT;
    NOT_NEEDED(NEED_FACING);
    small.desc.normals = NORMALS_FACED;
    small.draws[0].cull_back = small.draws[2].cull_back = true;
    NOT_NEEDED(NEED_FACING);
    NOT_NEEDED(NEED_BACK_FACES);
}
END_TEST

static void check_all(const Needs *needs)
{
    for (int i = 0; i < NEED_ACTED_ON; i++)
        ck_assert_msg(needs->items[i].needed || i == NEED_LIGHTS, "%s is left out",
                      needs_name((NeedId)i));
}

START_TEST(test_all)
{
    Needs needs;
    make();
    small.view.light_count = small.view.draw_count = 0;
    needs_derive(&small.scene, &small.view, &small.desc, true, &needs);
    check_all(&needs);
    small.desc.model_all = true;
    needs = derive();
    check_all(&needs);
    small.desc.model_all = false;
    small.desc.method = METHOD_LINKED_LIST;
    needs = derive();
    check_all(&needs);
    small.scene.texture_count = 0;
    needs = derive();
    ck_assert(!needs_has(&needs, NEED_BASE_COLOR_TEXTURE));
    ck_assert(!needs_has(&needs, NEED_MASK));
    ck_assert(needs_has(&needs, NEED_POSITION));
}
END_TEST

START_TEST(test_formats)
{
    make();
    small.view.light_count = 0;
    small.materials[0].occlusion = 0.5f;
    small.draws[1].transparent = small.draws[2].transparent = false;
    small.materials[1] = small.materials[2] = small.materials[0];
    small.desc.gbuffer = GBUFFER_SEED;
    Needs needs = derive();
    GBufferLayout opaque = needs_layout(&needs, &small.desc, false),
                  transparent = needs_layout(&needs, &small.desc, true);
    ck_assert_int_eq(opaque.diffuse, FORMAT_RGBA8);
    ck_assert_int_eq(opaque.normal, FORMAT_NONE);
    ck_assert_int_eq(opaque.position, FORMAT_NONE);
    ck_assert_int_eq(opaque.material, FORMAT_NONE);
    ck_assert_int_eq(transparent.diffuse, FORMAT_NONE);
    uint32_t saved = op_enter();
    float material[4];
    needs_material(&needs, &small.desc, false, material);
    op_leave(saved);
    ck_assert_float_bits(material[0], unorm8_to_float(76)); /* 76.5 to even */
    ck_assert_float_bits(material[2], unorm8_to_float(128));
}
END_TEST

START_TEST(test_dark_lights)
{
    static Light lights[3] = {{.color = {0.0f, -0.0f, 0.0f}, .attenuation = {1}},
                              {.color = {0.0f, 0.0f, 1e-40f}, .attenuation = {1}},
                              {.color = {0.0f, 0.0f, 0.0f}, .attenuation = {1}}};
    Camera camera = {.world = matrix_identity(), .yfov = 1, .near = 1, .far = 9};
    Scene scene = {.light_count = 3, .lights = lights, .camera_count = 1, .cameras = &camera};
    RenderDesc desc = {.width = 8, .height = 8};
    View view;
    ck_assert_int_eq(view_build(&scene, &desc, &view), RESULT_OK);
    ck_assert_uint_eq(view.light_count, 1);
    ck_assert_uint_eq(view.dark_light_count, 2);
    ck_assert_float_bits(view.lights[0].color[2], 1e-40f);
    view_free(&view);
    desc.model_all = true;
    ck_assert_int_eq(view_build(&scene, &desc, &view), RESULT_OK);
    ck_assert_uint_eq(view.light_count, 3);
    view_free(&view);
    desc = (RenderDesc){.width = 8, .height = 8, .lights = 1};
    ck_assert_int_eq(view_build(&scene, &desc, &view), RESULT_OK);
    ck_assert_uint_eq(view.light_count, 0);
    ck_assert_uint_eq(view.dark_light_count, 1);
    view_free(&view);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("needs");
    TCase *tcase = tcase_create("needs");
    tcase_add_test(tcase, test_lit);
    tcase_add_test(tcase, test_unlit);
    tcase_add_test(tcase, test_phong);
    tcase_add_test(tcase, test_material);
    tcase_add_test(tcase, test_textures);
    tcase_add_test(tcase, test_alpha);
    tcase_add_test(tcase, test_sides);
    tcase_add_test(tcase, test_all);
    tcase_add_test(tcase, test_formats);
    tcase_add_test(tcase, test_dark_lights);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

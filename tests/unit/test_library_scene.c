/* peel.h, scenes: what is said of bad arrays, and what may be left out. */
#include "library_scenes.h"

#include "scene/texture.h"

/* One field spoilt: expects the message. */
#define SPOILT(text, spoil)                                                                        \
    do {                                                                                           \
        Small small_;                                                                              \
        small_scene(&small_);                                                                      \
        Small *s = &small_;                                                                        \
        spoil;                                                                                     \
        PeelScene *scene_ = NULL;                                                                  \
        BAD(text, peel_scene_create(&s->desc, &scene_));                                           \
        ck_assert_ptr_null(scene_);                                                                \
    } while (0)

START_TEST(test_scene_bad)
{
    static const float bad[12] = {0, 0, 0, 0, NAN, 0, 0, 0, 0, 0, 0, 0};
    static const uint32_t beyond[6] = {0, 1, 2, 0, 2, 4};
    static const double projective[16] = {[0] = 1, [5] = 1, [10] = 1, [11] = -1};
    static const double singular[16] = {[15] = 1};
    static const float bright[16] = {0, 0, 0, 2};
    PeelScene *scene = NULL;
    PeelSceneDesc desc = {0};
    BAD("desc is NULL", peel_scene_create(NULL, &scene));
    BAD("out is NULL", peel_scene_create(&desc, NULL));
    peel_scene_free(NULL);
    SPOILT("meshes is NULL", s->desc.meshes = NULL);
    SPOILT("textures is NULL", s->desc.textures = NULL);
    SPOILT("materials is NULL", s->desc.materials = NULL);
    SPOILT("instances is NULL", s->desc.instances = NULL);
    SPOILT("lights is NULL", s->desc.lights = NULL);
    SPOILT("cameras is NULL", s->desc.cameras = NULL);
    SPOILT("mesh 0: 0 vertices", s->mesh.vertex_count = 0);
    SPOILT("mesh 0: 4 vertices and 0 triangles", s->mesh.triangle_count = 0);
    SPOILT("mesh 0: no positions", s->mesh.positions = NULL);
    SPOILT("mesh 0: no normals", s->mesh.normals = NULL);
    SPOILT("mesh 0: no indices", s->mesh.indices = NULL);
    SPOILT("mesh 0: position of vertex 1 is not finite", s->mesh.positions = bad);
    SPOILT("mesh 0: normal of vertex 1 is not finite", s->mesh.normals = bad);
    SPOILT("mesh 0: texture coordinate of vertex 2 is not finite", s->mesh.uvs = bad);
    SPOILT("mesh 0: index 4 of triangle 1", s->mesh.indices = beyond);
    SPOILT("texture 0: neither", s->texture.codes = NULL);
    SPOILT("texture 0: both", s->texture.texels = bright);
    SPOILT("texture 0: 0", s->texture.width = 0);
    SPOILT("texture 0: 2×4294967295", s->texture.height = UINT32_MAX);
    SPOILT("texture 0: unknown wrap", s->texture.wrap_s = (PeelWrap)NONE);
    SPOILT("texture 0: unknown wrap", s->texture.wrap_t = (PeelWrap)-1);
    SPOILT("texture 0: texel 0 has 2", (s->texture.codes = NULL, s->texture.texels = bright));
    SPOILT("material 1: alpha is 1.5", s->materials[1].base_color[3] = 1.5f);
    SPOILT("material 0: roughness is nan", s->materials[0].roughness = NAN);
    SPOILT("material 0: metallic is -1", s->materials[0].metallic = -1);
    SPOILT("material 0: unknown alpha mode", s->materials[0].alpha_mode = (PeelAlphaMode)NONE);
    SPOILT("material 0: texture 2", s->materials[0].base_color_texture = 2);
    SPOILT("material 0: texture 1 or 4294967295",
           s->materials[0].metallic_roughness_texture = UINT32_MAX);
    SPOILT("instance 1: mesh 1", s->instances[1].mesh = 1);
    SPOILT("instance 0: mesh 0 or material 2", s->instances[0].material = 2);
    SPOILT("instance 0: world matrix is not affine", s->instances[0].world = projective);
    SPOILT("light 0: position is nan", s->light.position[2] = (double)NAN);
    SPOILT("light 0: intensity is -1", s->light.color[0] = -1);
    SPOILT("light 0: range is inf", s->light.range = INFINITY);
    SPOILT("light 0: attenuation is 0", s->light.attenuation[0] = 0);
    SPOILT("camera 0: near 0", s->camera.near_plane = 0);
    SPOILT("camera 0: near 1 and far 1", s->camera.far_plane = 1);
    SPOILT("camera 0: vertical field of view is nan", s->camera.yfov = (double)NAN);
    SPOILT("camera 0: eye, target and up", s->camera.eye[2] = 0);
    SPOILT("camera 0: eye, target and up", s->camera.up[1] = (double)NAN);
    SPOILT("camera 0: world matrix has no inverse", s->camera.world = singular);
    SPOILT("ambient", s->desc.ambient[1] = NAN);
    SPOILT("background", s->desc.background[1] = -1.0f);
}
END_TEST

/* Nothing at all, without lights, without a camera: all legal. */
START_TEST(test_scene_sparse)
{
    float pixel[4] = {9, 9, 9, 9};
    const PeelSettings settings = {.width = 1, .height = 1};
    const PeelImages images = {.linear = pixel};
    PeelFigures figures;
    PeelScene *scene = NULL;
    const PeelSceneDesc nothing = {.background = {0.5f, 0.25f, 0.125f}};
    GOOD(peel_scene_create(&nothing, &scene));
    for (int renderer = PEEL_REF; renderer <= PEEL_TRUTH; renderer++) {
        PeelSettings chosen = settings;
        chosen.renderer = (PeelRenderer)renderer;
        GOOD(peel_scene_render(scene, &chosen, NULL, &images, &figures));
        ck_assert_float_bits(pixel[0], 0.5f);
        ck_assert_float_bits(pixel[3], 0.0f);
        ck_assert_int_eq(figures.passes, 0);
    }
    peel_scene_free(scene);

    Small small;
    small_scene(&small);
    small.desc.camera_count = small.desc.light_count = 0;
    scene = create(&small);
    GOOD(peel_scene_render(scene, &settings, NULL, &images, &figures));
    ck_assert_uint_eq(figures.fragments, 1);
    peel_scene_free(scene);
}
END_TEST

/* A camera by its matrix is the one by eye and target, and knows no scale. */
START_TEST(test_scene_camera)
{
    static const double worlds[][16] = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 4, 1},
                                        {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1e-9, 0, 0, 0, 4, 1}};
    enum {
        SIDE = 40
    };
    static float one[SIDE * SIDE * 4], other[SIDE * SIDE * 4];
    const PeelSettings settings = {.width = SIDE, .height = SIDE};
    Small small;
    small_scene(&small);
    PeelScene *scene = create(&small);
    GOOD(peel_scene_render(scene, &settings, NULL, &(PeelImages){.linear = one}, NULL));
    peel_scene_free(scene);
    for (size_t i = 0; i < sizeof worlds / sizeof *worlds; i++) {
        small.camera.world = worlds[i];
        scene = create(&small);
        GOOD(peel_scene_render(scene, &settings, NULL, &(PeelImages){.linear = other}, NULL));
        peel_scene_free(scene);
        ck_assert_mem_eq(one, other, sizeof one);
    }
    ck_assert_float_gt(one[(SIDE / 2 * SIDE + SIDE / 2) * 4], 0.0f);
}
END_TEST

enum {
    SIDE = 24
};

static void render(const Small *small, float image[SIDE * SIDE * 4])
{
    const PeelSettings settings = {.width = SIDE, .height = SIDE};
    PeelScene *scene = create(small);
    GOOD(peel_scene_render(scene, &settings, NULL, &(PeelImages){.linear = image}, NULL));
    peel_scene_free(scene);
}

/* Every field of a texture and the threshold of a mask can be seen; floats and codes are the same
 * texels. */
START_TEST(test_scene_surfaces)
{
    static float image[7][SIDE * SIDE * 4];
    float texels[16];
    Small small[7];
    for (int i = 0; i < 7; i++)
        small_scene(&small[i]);
    small[1].texture.nearest = true;
    small[2].texture.srgb = false;
    small[3].texture.wrap_s = PEEL_CLAMP;
    small[4].texture.wrap_t = PEEL_MIRROR;
    small[5].materials[0].alpha_mode = PEEL_MASK;
    small[5].materials[0].alpha_cutoff = 1.25f;
    for (int i = 0; i < 16; i++)
        texels[i] = texture_decode(i % 4 == 3 ? TEXTURE_LINEAR : TEXTURE_SRGB, codes[i], 255);
    small[6].texture.codes = NULL;
    small[6].texture.texels = texels;
    for (int i = 0; i < 7; i++) {
        render(&small[i], image[i]);
        if (i < 6)
            for (int k = 0; k < i; k++)
                ck_assert_msg(memcmp(image[i], image[k], sizeof image[i]) != 0, "%d and %d", i, k);
    }
    ck_assert_mem_eq(image[6], image[0], sizeof image[0]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("library scenes");
    TCase *tcase = tcase_create("library scenes");
    tcase_set_timeout(tcase, 120);
    tcase_add_test(tcase, test_scene_bad);
    tcase_add_test(tcase, test_scene_sparse);
    tcase_add_test(tcase, test_scene_camera);
    tcase_add_test(tcase, test_scene_surfaces);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

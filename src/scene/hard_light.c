/* Hard cases of alpha, blending and lighting. */
#include "scene/hard_kit.h"
#include "scene/hard_scenes.h"

#include "base/random.h"
#include "scene/shapes.h"

#include <math.h>

static void put_pane(Builder *builder, double z, uint32_t material)
{
    HardQuad pane = hard_kit_pane(z, 2.0 / 3.0);
    hard_kit_put(builder, hard_kit_quads(builder, &pane, 1), material);
}

static void put_ball(Builder *builder, double x, double radius, uint32_t material)
{
    Mesh mesh;
    Result made = shapes_sphere(radius, 48, 24, &mesh);
    uint32_t ball = builder_mesh(builder, made, &mesh);
    pieces_place_at(builder, "", ball, material, x, 0.0, -4.0);
}

/* A light at a point whose brightness falls with the square of the distance. */
static void put_light(Builder *builder, double x, double y, double z, float color)
{
    Light light = {.position = {pieces_float(x), pieces_float(y), pieces_float(z)},
                   .color = {color, color, color},
                   .attenuation = {0.0f, 0.0f, 1.0f}};
    builder_light(builder, &light);
}

static void set_ambient(Builder *builder, float ambient)
{
    for (int i = 0; i < 3; i++)
        builder->scene.ambient[i] = ambient;
}

/* Before a half transparent pane one that cannot be seen at all. */
Result hard_scenes_alpha_zero(Scene *out)
{
    Builder builder = hard_kit_begin("alpha_zero", 1.0, 100.0);
    put_pane(&builder, -40.0, hard_kit_glass(&builder, 1.0f, 1.0f, 1.0f, 0.0f));
    put_pane(&builder, -48.0, hard_kit_glass(&builder, 0.75f, 0.5f, 0.25f, 0.5f));
    put_pane(&builder, -56.0, hard_kit_glass(&builder, 1.0f, 1.0f, 1.0f, 0.0f));
    return builder_finish(&builder, out);
}

/* Four strips from left to right: alpha below 1e-4, at it, one step above it, and 2e-4. */
Result hard_scenes_alpha_threshold(Scene *out)
{
    static const float alphas[4] = {9.9e-5f, 1e-4f, 0x1.a36e3p-14f, 2e-4f};
    Builder builder = hard_kit_begin("alpha_threshold", 1.0, 100.0);
    for (int i = 0; i < 4; i++) {
        HardQuad strip = {-32.0 + 16.0 * i, -32.0, -16.0 + 16.0 * i, 32.0, -48.0};
        uint32_t glass = hard_kit_glass(&builder, 1.0f, 1.0f, 1.0f, alphas[i]);
        hard_kit_put(&builder, hard_kit_quads(&builder, &strip, 1), glass);
    }
    put_pane(&builder, -60.0, hard_kit_glass(&builder, 0.5f, 0.5f, 0.5f, 0.5f));
    return builder_finish(&builder, out);
}

/* The light is between the panes: the one behind sends 2^24 and more, of which 2^-24 comes
 * through. */
Result hard_scenes_alpha_almost_one(Scene *out)
{
    Builder builder = hard_kit_begin("alpha_almost_one", 1.0, 100.0);
    set_ambient(&builder, 0.0f);
    put_pane(&builder, -40.0, hard_kit_glass(&builder, 0.5f, 0.5f, 0.5f, 1.0f - 0x1p-24f));
    put_pane(&builder, -48.0, hard_kit_glass(&builder, 0.75f, 0.5f, 0.25f, 0.5f));
    pieces_lamp(&builder, 0.0, 0.0, -44.0, 0x1p26f, 0x1p26f, 0x1p26f);
    return builder_finish(&builder, out);
}

/* Opaque, but in the list of transparent surfaces, with others before and behind it. */
Result hard_scenes_alpha_one(Scene *out)
{
    Builder builder = hard_kit_begin("alpha_one", 1.0, 100.0);
    put_pane(&builder, -56.0, hard_kit_glass(&builder, 1.0f, 1.0f, 1.0f, 0.5f));
    put_pane(&builder, -48.0, hard_kit_glass(&builder, 0.25f, 0.5f, 0.75f, 1.0f));
    put_pane(&builder, -40.0, hard_kit_glass(&builder, 1.0f, 0.5f, 0.0f, 0.25f));
    put_pane(&builder, -64.0, hard_kit_glass(&builder, 1.0f, 1.0f, 1.0f, 1.0f));
    return builder_finish(&builder, out);
}

Result hard_scenes_drift_8(Scene *out)
{
    Builder builder = hard_kit_begin("drift_8", 1.0, 100.0);
    hard_kit_stack(&builder, 96, 40.0, 0.25, 1, 0.01f);
    return builder_finish(&builder, out);
}

/* Three panes in a light of a million. */
Result hard_scenes_half_overflow(Scene *out)
{
    Builder builder = hard_kit_begin("half_overflow", 1.0, 100.0);
    for (int i = 0; i < 3; i++)
        put_pane(&builder, -40.0 - 8.0 * i, hard_kit_glass(&builder, 0.75f, 0.75f, 0.75f, 0.5f));
    pieces_lamp(&builder, 0.0, 0.0, 100.0, 1e6f, 1e6f, 1e6f);
    return builder_finish(&builder, out);
}

/* The brightest light and the least attenuation that a scene may have, on the smoothest metal. */
Result hard_scenes_brightest(Scene *out)
{
    Builder builder = hard_kit_begin("brightest", 1.0, 100.0);
    set_ambient(&builder, 1e12f);
    for (int i = 0; i < 3; i++) {
        Material material = {.base_color = {1.0f, 1.0f, 1.0f, 0.5f},
                             .roughness = 0.0f,
                             .metallic = (float)(i % 2),
                             .occlusion = 1.0f,
                             .alpha_mode = ALPHA_BLEND,
                             .alpha_cutoff = 0.5f,
                             .double_sided = true};
        put_pane(&builder, -40.0 - 8.0 * i, builder_material(&builder, &material, "glass"));
    }
    for (int i = 0; i < 8; i++) {
        Light light = {.position = {0.0, 0.0, 0.125 * i},
                       .color = {1e12f, 1e12f, 1e12f},
                       .attenuation = {1e-8f, 0.0f, 0.0f}};
        builder_light(&builder, &light);
    }
    return builder_finish(&builder, out);
}

/* A dielectric and a metal ball of one roughness. */
static Result balls(const char *name, float roughness, Scene *out)
{
    Builder builder = hard_kit_begin(name, 0.5, 100.0);
    hard_kit_lamps(&builder);
    pieces_lamp(&builder, 0.0, 3.0, 1.0, 1.0f, 1.0f, 1.0f);
    for (int i = 0; i < 2; i++) {
        Material material = {.base_color = {0.9f, 0.6f, 0.3f, 0.5f},
                             .roughness = roughness,
                             .metallic = (float)i,
                             .occlusion = 1.0f,
                             .alpha_mode = ALPHA_BLEND,
                             .alpha_cutoff = 0.5f,
                             .double_sided = true};
        put_ball(&builder, i ? 1.25 : -1.25, 1.5, builder_material(&builder, &material, "ball"));
    }
    return builder_finish(&builder, out);
}

Result hard_scenes_roughness_zero(Scene *out)
{
    return balls("roughness_zero", 0.0f, out);
}

Result hard_scenes_roughness_one(Scene *out)
{
    return balls("roughness_one", 1.0f, out);
}

/* Normals across the gaze in the middle column of the image, and past it on one side. */
Result hard_scenes_grazing(Scene *out)
{
    static const double corners[4][3] = {
        {-32.0, -32.0, -48.0}, {32.0, -32.0, -48.0}, {32.0, 32.0, -48.0}, {-32.0, 32.0, -48.0}};
    static const double across[4][3] = {
        {1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
    Builder builder = hard_kit_begin("grazing", 1.0, 100.0);
    hard_kit_lamps(&builder);
    pieces_lamp(&builder, 100.0, 0.0, -60.0, 2.0f, 2.0f, 2.0f);
    for (int i = 0; i < 2; i++) {
        Material material = {.base_color = {0.9f, 0.9f, 0.9f, 0.5f},
                             .roughness = i ? 0.0f : 0.5f,
                             .metallic = (float)i,
                             .occlusion = 1.0f,
                             .alpha_mode = ALPHA_BLEND,
                             .alpha_cutoff = 0.5f,
                             .double_sided = true};
        uint32_t patch = hard_kit_patch(&builder, corners, across);
        pieces_place_at(&builder, "", patch, builder_material(&builder, &material, "glass"), 0.0,
                        0.0, -8.0 * i);
    }
    return builder_finish(&builder, out);
}

/* Lights in the plane of the pane: at the centre of a pixel, and a hair before and behind it. */
Result hard_scenes_light_at_surface(Scene *out)
{
    Builder builder = hard_kit_begin("light_at_surface", 1.0, 100.0);
    set_ambient(&builder, 0.1f);
    put_pane(&builder, -48.0, hard_kit_glass(&builder, 0.8f, 0.7f, 0.6f, 0.5f));
    put_light(&builder, -15.5, 0.5, -48.0, 1.0f);
    put_light(&builder, 0.5, 0.5, -0x1.7ffffep+5, 1.0f);
    put_light(&builder, 16.5, 0.5, -0x1.800002p+5, 1.0f);
    return builder_finish(&builder, out);
}

/* On the line of sight through the middle pixel: there N·L = −1 and V + L = 0. */
Result hard_scenes_light_behind(Scene *out)
{
    Builder builder = hard_kit_begin("light_behind", 1.0, 100.0);
    set_ambient(&builder, 0.1f);
    for (int i = 0; i < 2; i++)
        put_pane(&builder, -40.0 - 8.0 * i, hard_kit_tint(&builder, i, 0.5f));
    pieces_lamp(&builder, 0.0, 0.0, -64.0, 4.0f, 4.0f, 4.0f);
    return builder_finish(&builder, out);
}

/* Normals of length 0, and normals that cancel halfway between two corners. */
Result hard_scenes_zero_normals(Scene *out)
{
    static const double left[4][3] = {
        {-40.0, -32.0, -48.0}, {-4.0, -32.0, -48.0}, {-4.0, 32.0, -48.0}, {-40.0, 32.0, -48.0}};
    static const double right[4][3] = {
        {4.0, -32.0, -48.0}, {40.0, -32.0, -48.0}, {40.0, 32.0, -48.0}, {4.0, 32.0, -48.0}};
    static const double none[4][3] = {{0.0}};
    static const double against[4][3] = {
        {0.0, 0.0, 1.0}, {0.0, 0.0, -1.0}, {0.0, 0.0, -1.0}, {0.0, 0.0, 1.0}};
    Builder builder = hard_kit_begin("zero_normals", 1.0, 100.0);
    hard_kit_lamps(&builder);
    HardQuad pane = hard_kit_pane(-60.0, 2.0 / 3.0);
    hard_kit_put(&builder, hard_kit_patch(&builder, left, none), hard_kit_tint(&builder, 0, 0.5f));
    hard_kit_put(&builder, hard_kit_patch(&builder, right, against),
                 hard_kit_tint(&builder, 1, 0.5f));
    hard_kit_put(&builder, hard_kit_quads(&builder, &pane, 1), hard_kit_tint(&builder, 2, 0.5f));
    return builder_finish(&builder, out);
}

enum {
    LIGHTS = 128,
    LIGHTS_SEED = 11
};

Result hard_scenes_many_lights(Scene *out)
{
    Builder builder = hard_kit_begin("many_lights", 0.5, 100.0);
    Random random = random_seed(LIGHTS_SEED);
    set_ambient(&builder, 0.1f);
    for (int i = 0; i < 2; i++) {
        Material material = {.base_color = {0.9f, 0.7f, 0.4f, 0.5f},
                             .roughness = 0.3f,
                             .metallic = (float)i,
                             .occlusion = 1.0f,
                             .alpha_mode = ALPHA_BLEND,
                             .alpha_cutoff = 0.5f,
                             .double_sided = true};
        put_ball(&builder, i ? 1.25 : -1.25, 1.5, builder_material(&builder, &material, "ball"));
    }
    for (int i = 0; i < LIGHTS; i++) {
        double x = random_range(&random, -6.0, 6.0), y = random_range(&random, -6.0, 6.0);
        put_light(&builder, x, y, random_range(&random, -6.0, 2.0), 0.25f);
    }
    return builder_finish(&builder, out);
}

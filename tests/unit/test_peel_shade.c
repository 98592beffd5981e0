/* dump/peel_shade.h, which is for programs of others, has the bits of ref's shading. */
#include "testing.h"

#include "base/random.h"
#include "dump/peel_shade.h"
#include "ref/pipeline/shade.h"

#include <math.h>

enum {
    COUNT = 20000,
    LIGHTS = 3
};

static void random_direction(Random *random, float out[3])
{
    double v[3], length2 = 0.0;
    for (int i = 0; i < 3; i++) {
        v[i] = random_range(random, -1.0, 1.0);
        length2 += v[i] * v[i];
    }
    for (int i = 0; i < 3; i++)
        out[i] = (float)(v[i] / sqrt(length2 + 1e-12));
}

static void random_surface(Random *random, PeelShadeSurface *out)
{
    random_direction(random, out->normal);
    for (int i = 0; i < 3; i++)
        out->position[i] = (float)random_range(random, -5.0, i == 2 ? 0.0 : 5.0);
    for (int i = 0; i < 4; i++)
        out->base[i] = (float)random_range(random, 0.01, 1.0);
    out->roughness = (float)random_unit(random);
    out->metallic = random_bits(random) % 3 ? (float)random_unit(random) : 1.0f;
    out->occlusion = (float)random_unit(random);
}

/* Some of them behind the surface, out of range, or in it. */
static void random_light(Random *random, const PeelShadeSurface *surface, PeelShadeLight *out)
{
    for (int i = 0; i < 3; i++) {
        out->position[i] = random_bits(random) % 16 ? (float)random_range(random, -8.0, 8.0)
                                                    : surface->position[i];
        out->color[i] = (float)random_range(random, 0.0, 10.0);
        out->attenuation[i] = (float)random_range(random, 0.01, 1.0);
    }
    out->inverse_range2 = random_bits(random) % 2 ? (float)random_range(random, 1e-3, 0.2) : 0.0f;
}

static void to_view(const PeelShadeLight *lights, ViewLight *view_lights, View *view)
{
    for (int i = 0; i < LIGHTS; i++) {
        memcpy(view_lights[i].position, lights[i].position, sizeof lights[i].position);
        memcpy(view_lights[i].color, lights[i].color, sizeof lights[i].color);
        memcpy(view_lights[i].attenuation, lights[i].attenuation, sizeof lights[i].attenuation);
        view_lights[i].inverse_range2 = lights[i].inverse_range2;
    }
    *view = (View){.light_count = LIGHTS, .lights = view_lights, .ambient = {0.25f, 0.5f, 0.125f}};
}

static Texel to_texel(const PeelShadeSurface *surface)
{
    Texel texel = {.material = {surface->roughness, surface->metallic, surface->occlusion}};
    memcpy(texel.normal, surface->normal, sizeof surface->normal);
    memcpy(texel.position, surface->position, sizeof surface->position);
    memcpy(texel.diffuse, surface->base, sizeof surface->base);
    return texel;
}

START_TEST(test_bits)
{
    const unsigned flags = (unsigned)_i;
    const ShadeForm form = {.ggx = flags & PEEL_SHADE_STABLE ? GGX_STABLE : GGX_SOURCE,
                            .back_light = (flags & PEEL_SHADE_BACK_LIGHT) != 0};
    Random random = random_seed(11 + (uint64_t)_i);
    int lit = 0;
    for (int n = 0; n < COUNT; n++) {
        PeelShadeSurface surface;
        PeelShadeLight lights[LIGHTS];
        ViewLight view_lights[LIGHTS];
        View view;
        float got[4], expected[4];
        random_surface(&random, &surface);
        for (int i = 0; i < LIGHTS; i++)
            random_light(&random, &surface, &lights[i]);
        to_view(lights, view_lights, &view);
        Texel texel = to_texel(&surface);
        uint32_t saved = op_enter();
        bool shaded = shade_pixel(&view, &form, &texel, expected);
        peel_shade(&surface, lights, LIGHTS, view.ambient, flags, got);
        op_leave(saved);
        ck_assert(shaded);
        for (int i = 0; i < 4; i++)
            ck_assert_float_bits(got[i], expected[i]);
        lit += got[0] > view.ambient[0] * surface.base[0];
    }
    ck_assert_int_gt(lit, COUNT / 100);
}
END_TEST

/* Blending and what is shown, too. */
START_TEST(test_resolve)
{
    Random random = random_seed(3);
    View view = {.background = {0.5f, 0.0f, 2.0f}};
    uint32_t saved = op_enter();
    for (int n = 0; n < COUNT; n++) {
        float accum[4], source[4], final[4], expected[4];
        uint8_t display[4];
        for (int i = 0; i < 4; i++) {
            accum[i] = (float)random_range(&random, 0.0, i < 3 ? 4.0 : 1.0);
            source[i] = (float)random_range(&random, 0.0, i < 3 ? 4.0 : 1.0);
        }
        float blended[4];
        for (int i = 0; i < 3; i++)
            blended[i] = op_add(op_mul(source[i], accum[3]), accum[i]);
        blended[3] = op_mul(accum[3], op_sub(1.0f, source[3]));
        peel_shade_under(source, accum);
        peel_shade_final(accum, view.background, final);
        shade_final(&view, blended, blended[3], expected);
        shade_display(true, expected, display);
        for (int i = 0; i < 4; i++) {
            ck_assert_float_bits(accum[i], blended[i]);
            ck_assert_float_bits(final[i], expected[i]);
        }
        for (int i = 0; i < 3; i++) /* a power of the C library: a little off */
            ck_assert_double_le(
                fabs((double)peel_shade_display(final[i]) * 255.0 - (double)display[i]), 0.51);
    }
    op_leave(saved);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("peel_shade");
    TCase *tests = tcase_create("peel_shade");
    tcase_add_loop_test(tests, test_bits, 0, 4);
    tcase_add_test(tests, test_resolve);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

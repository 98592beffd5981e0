/* ref/truth/radiance.c against the formula's closed forms in simple positions. */
#include "frame/shading.h"
#include "ref/truth/radiance.h"
#include "testing.h"

#include <math.h>

static const double pi = (double)SHADING_PI;

static MaterialSample material(float roughness, float metallic)
{
    return (MaterialSample){.base_color = {0.5f, 0.25f, 1, 1},
                            .roughness = roughness,
                            .metallic = metallic,
                            .occlusion = 0.5f};
}

/* Light, eye and normal in one line: every cosine is 1, Fresnel is F0, GGX is 1/(π a²). */
START_TEST(test_head_on)
{
    for (int i = 0; i < 8; i++) {
        float roughness = i & 1 ? 0.5f : 1.0f, metallic = i & 2 ? 1.0f : 0.25f;
        double distance = i & 4 ? 2.0 : 0.5; /* from light to surface */
        ViewLight light = {{0, 0, (float)(distance - 3)}, {1, 2, 4}, {1, 0.5f, 0.25f}, 0};
        View view = {.light_count = 1, .lights = &light, .ambient = {0.25f, 0.25f, 0.5f}};
        MaterialSample m = material(roughness, metallic);
        Surface surface = {{0, 0, -3}, {0, 0, 7}, m, false, false};
        double rgb[3], a2 = pow(roughness, 4);
        radiance_shade(&view, &surface, rgb);
        double attenuation = 1 / (1 + 0.5 * distance + 0.25 * distance * distance);
        for (int k = 0; k < 3; k++) {
            double base = m.base_color[k];
            double f = (double)0.04f * (1 - metallic) + base * metallic;
            double diffuse = (1 - f) * base * (1 - metallic) / pi;
            double specular = f / (pi * a2) / (4 + (double)1e-4f);
            double expected =
                (diffuse + specular) * light.color[k] * attenuation + view.ambient[k] * base * 0.5;
            ck_assert_double_eq_tol(rgb[k], expected, 1e-14);
        }
    }
}
END_TEST

/* Light at 90° around the half vector: eye along +z of a surface whose normal bisects eye and
 * light, so N·V = N·L = H·V = cos 45° and N·H = 1. */
START_TEST(test_bisecting_normal)
{
    ViewLight light = {{5, 0, -3}, {2, 2, 2}, {0, 0, 1}, 0};
    View view = {.light_count = 1, .lights = &light};
    MaterialSample m = material(0.5f, 0);
    Surface surface = {{0, 0, -3}, {1, 0, 1}, m, false, false};
    double rgb[3], c = sqrt(0.5), k = 1.5 * 1.5 / 8, g = c / (c * (1 - k) + k);
    radiance_shade(&view, &surface, rgb);
    for (int i = 0; i < 3; i++) {
        double f0 = 0.04f, f = f0 + (1 - f0) * pow(1 - c, 5), base = m.base_color[i];
        double specular = f / (pi * 0.0625) * g * g / (4 * 0.5 + (double)1e-4f);
        double expected = ((1 - f) * base / pi + specular) * (2.0 / 25) * c;
        ck_assert_double_eq_tol(rgb[i], expected, 1e-15);
    }
}
END_TEST

/* Ambient only: no lights, or all of them behind. */
START_TEST(test_unlit)
{
    ViewLight behind = {{0, 0, -9}, {100, 100, 100}, {1, 0, 0}, 0};
    MaterialSample m = material(0.5f, 0);
    Surface surface = {{0, 0, -3}, {0, 0, 1}, m, false, false};
    for (size_t count = 0; count < 2; count++) {
        View view = {.light_count = count, .lights = &behind, .ambient = {1, 1, 2}};
        double rgb[3];
        radiance_shade(&view, &surface, rgb);
        ck_assert_double_eq(rgb[0], 0.25);
        ck_assert_double_eq(rgb[1], 0.125);
        ck_assert_double_eq(rgb[2], 1.0);
    }
}
END_TEST

/* A light behind a back-lit surface gives what its mirror image gives, without the Lambert term;
 * one in front the same as ever. */
START_TEST(test_back_light)
{
    ViewLight behind = {{1.5f, 0.5f, -4.0f}, {1, 2, 4}, {0.5f, 0.25f, 1}, 0}, front = behind;
    front.position[2] = -2.0f; /* mirrored at z = −3 */
    View view_behind = {.light_count = 1, .lights = &behind},
         view_front = {.light_count = 1, .lights = &front};
    MaterialSample m = material(0.4f, 1), rough = material(0.4f, 0);
    Surface surface = {{0, 0, -3}, {0, 0, 1}, m, true, false};
    double back[3], ahead[3], without[3];
    radiance_shade(&view_behind, &surface, back);
    radiance_shade(&view_front, &surface, ahead);
    for (int k = 0; k < 3; k++) { /* a metal has no Lambert term */
        ck_assert_double_gt(back[k], 0.0);
        ck_assert_double_eq_tol(back[k], ahead[k], 1e-15);
    }
    surface.back_light = false;
    radiance_shade(&view_front, &surface, without);
    ck_assert_mem_eq(without, ahead, sizeof ahead);
    radiance_shade(&view_behind, &surface, without);
    ck_assert_double_eq(without[0], 0.0);
    surface = (Surface){{0, 0, -3}, {0, 0, 1}, rough, true, false};
    radiance_shade(&view_behind, &surface, back);
    radiance_shade(&view_front, &surface, ahead);
    const double L[3] = {1.5 / sqrt(3.5), 0.5 / sqrt(3.5), 1 / sqrt(3.5)};
    double HV = sqrt((1 + L[2]) / 2), f = 0.04f + (1 - (double)0.04f) * pow(1 - HV, 5);
    double attenuation = 1 / (0.5 + 0.25 * sqrt(3.5) + 3.5);
    for (int k = 0; k < 3; k++) {
        double lambert = (1 - f) * rough.base_color[k] / pi * behind.color[k] * attenuation * L[2];
        ck_assert_double_gt(back[k], 0.0);
        ck_assert_double_eq_tol(ahead[k] - back[k], lambert, 1e-15);
    }
}
END_TEST

/* The window's closed form, and nothing from the range on. */
START_TEST(test_range)
{
    for (int i = 0; i < 64; i++) {
        double distance = 0.25 + i / 8.0, range = 4.0, part = distance / range;
        ViewLight light = {{0, 0, (float)(distance - 9)}, {1, 2, 4}, {0, 0, 1}, 0.0625f};
        View view = {.light_count = 1, .lights = &light};
        Surface surface = {{0, 0, -9}, {0.5, 0, 1}, material(0.5f, 0.5f), i & 1, false};
        double rgb[3], whole[3], window = part < 1 ? 1 - part * part * part * part : 0;
        radiance_shade(&view, &surface, rgb);
        light.inverse_range2 = 0;
        radiance_shade(&view, &surface, whole);
        for (int k = 0; k < 3; k++) {
            ck_assert_double_gt(whole[k], 0);
            ck_assert_double_eq_tol(rgb[k], whole[k] * window, 1e-15 * whole[k]);
        }
    }
}
END_TEST

/* The guards: no normal, a light on the surface, a surface at the eye, roughness 0. */
START_TEST(test_guards)
{
    for (int i = 0; i < 16; i++) {
        ViewLight light = {{0, 0, i & 1 ? -3 : 0}, {1, 1, 1}, {0, 0, 1}, 0};
        View view = {.light_count = 1, .lights = &light};
        MaterialSample m = material(i & 2 ? 0.0f : 1.0f, 0);
        Surface surface = {{0, 0, i & 4 ? 0 : -3}, {0, 0, i & 8 ? 0 : 1}, m, false, false};
        double rgb[3];
        radiance_shade(&view, &surface, rgb);
        for (int k = 0; k < 3; k++)
            ck_assert_msg(isfinite(rgb[k]) && rgb[k] >= 0, "case %d: %g", i, rgb[k]);
    }
    /* Roughness 0 means SHADING_ROUGHNESS_MIN. */
    ViewLight light = {{1, 0, 0}, {1, 1, 1}, {0, 0, 1}, 0};
    View view = {.light_count = 1, .lights = &light};
    MaterialSample smooth = material(0, 0), least = material(SHADING_ROUGHNESS_MIN, 0);
    Surface a = {{0, 0, -3}, {0.1, 0, 1}, smooth, false, false},
            b = {{0, 0, -3}, {0.1, 0, 1}, least, false, false};
    double rgb_a[3], rgb_b[3];
    radiance_shade(&view, &a, rgb_a);
    radiance_shade(&view, &b, rgb_b);
    ck_assert_mem_eq(rgb_a, rgb_b, sizeof rgb_a);
}
END_TEST

START_TEST(test_display)
{
    ck_assert_uint_eq(radiance_display(0), 0);
    ck_assert_uint_eq(radiance_display(-1), 0);
    ck_assert_uint_eq(radiance_display(NAN), 0);
    ck_assert_uint_eq(radiance_display(INFINITY), 255);
    ck_assert_uint_eq(radiance_display(1e308), 255);
    ck_assert_uint_eq(radiance_display(1), 186);       /* 255 · 0.5^(1/2.2) = 186.08 */
    ck_assert_uint_eq(radiance_display(1.0 / 3), 136); /* 255 · 0.25^(1/2.2) = 135.79 */
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("truth_radiance");
    TCase *tests = tcase_create("radiance");
    tcase_add_test(tests, test_head_on);
    tcase_add_test(tests, test_bisecting_normal);
    tcase_add_test(tests, test_unlit);
    tcase_add_test(tests, test_back_light);
    tcase_add_test(tests, test_range);
    tcase_add_test(tests, test_guards);
    tcase_add_test(tests, test_display);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

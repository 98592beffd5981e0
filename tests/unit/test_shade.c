/* ref/pipeline/shade.c, one lane: its error against the formula in double near highlights, and what
 * its guards promise. */
#include "testing.h"

#include "base/random.h"
#include "ref/pipeline/shade.h"
#include "ref/truth/radiance.h"

#include <math.h>
#include <stdio.h>

enum {
    COUNT = 20000
};

/* A point whose normal is near the half vector of eye and light, both at random; a2 ≥ 4e-6. */
static void highlight(Random *random, Texel *texel, ViewLight *light)
{
    double V[3] = {0}, h[3], length2 = 0, lobe = random_range(random, 0, 0.02);
    float roughness = (float)random_range(random, 0.045, 0.3);
    *texel = (Texel){.diffuse = {0.9f, 0.5f, 0.1f, 1}, .material = {roughness, 1, 1}};
    *light = (ViewLight){.color = {1, 2, 3}, .attenuation = {1, 0, 0}};
    for (int i = 0; i < 3; i++) {
        texel->position[i] = (float)random_range(random, i == 2 ? -8 : -2, i == 2 ? -2 : 2);
        light->position[i] = (float)random_range(random, i == 2 ? -1 : -3, i == 2 ? 1 : 3);
    }
    double to_eye = 0, to_light = 0;
    for (int i = 0; i < 3; i++) {
        double D = (double)light->position[i] - texel->position[i];
        to_eye += (double)texel->position[i] * texel->position[i];
        to_light += D * D;
    }
    for (int i = 0; i < 3; i++) {
        V[i] = -texel->position[i] / sqrt(to_eye);
        h[i] = V[i] + ((double)light->position[i] - texel->position[i]) / sqrt(to_light);
        h[i] += lobe * random_range(random, -1, 1);
        length2 += h[i] * h[i];
    }
    for (int i = 0; i < 3; i++)
        texel->normal[i] = (float)(h[i] / sqrt(length2));
}

static View one_light(const ViewLight *light)
{
    static ViewLight lights[1];
    lights[0] = *light;
    return (View){.light_count = 1, .lights = lights};
}

static void shade(const View *view, ShadeForm form, const Texel *texel, float source[4])
{
    uint32_t saved = op_enter();
    ck_assert(shade_pixel(view, &form, texel, source));
    op_leave(saved);
}

/* The largest relative difference from radiance_shade on COUNT highlights. */
static double largest_error(GgxForm ggx)
{
    Random random = random_seed(5);
    double largest = 0;
    for (int i = 0; i < COUNT; i++) {
        Texel texel;
        ViewLight light;
        float source[4];
        double rgb[3];
        highlight(&random, &texel, &light);
        View view = one_light(&light);
        Surface surface = {.material = {.base_color = {0.9f, 0.5f, 0.1f, 1},
                                        .roughness = texel.material[0],
                                        .metallic = 1,
                                        .occlusion = 1}};
        for (int k = 0; k < 3; k++) {
            surface.position[k] = texel.position[k];
            surface.normal[k] = texel.normal[k];
        }
        shade(&view, (ShadeForm){.ggx = ggx}, &texel, source);
        radiance_shade(&view, &surface, rgb);
        for (int k = 0; k < 3; k++)
            largest = fmax(largest, fabs(source[k] - rgb[k]) / rgb[k]);
    }
    return largest;
}

START_TEST(test_stable_form)
{
    double source = largest_error(GGX_SOURCE), stable = largest_error(GGX_STABLE);
    printf("largest relative error: source form %.3g, stable form %.3g\n", source, stable);
    ck_assert_msg(stable < 1e-4, "stable form: largest relative error %g", stable);
    ck_assert_msg(source > 1e-2, "source form: largest relative error %g", source);
}
END_TEST

/* Mirroring the light gives the same bits as a metal lit from the front, up to the rounding of the
 * mirroring; lights in front give the same bits as without the option. */
START_TEST(test_back_light)
{
    Random random = random_seed(6);
    for (int i = 0; i < COUNT; i++) {
        Texel texel;
        ViewLight light;
        float plain[4], lit[4], behind[4];
        highlight(&random, &texel, &light);
        texel.material[1] = (float)random_unit(&random);
        View view = one_light(&light);
        ShadeForm form = {.ggx = (GgxForm)(i & 1)}, back = form;
        back.back_light = true;
        shade(&view, form, &texel, plain);
        shade(&view, back, &texel, lit);
        ck_assert_mem_eq(plain, lit, sizeof lit);

        /* Through the plane of the surface. */
        double height = 0;
        for (int k = 0; k < 3; k++)
            height += texel.normal[k] * ((double)light.position[k] - texel.position[k]);
        for (int k = 0; k < 3; k++)
            light.position[k] = (float)(light.position[k] - 2 * height * texel.normal[k]);
        view = one_light(&light);
        shade(&view, form, &texel, plain);
        ck_assert_float_eq(plain[0], 0);
        texel.material[1] = 1;
        texel.material[0] = 0.5f; /* wide: positions are rounded */
        shade(&view, back, &texel, behind);
        for (int k = 0; k < 3; k++)
            light.position[k] = (float)(light.position[k] + 2 * height * texel.normal[k]);
        view = one_light(&light);
        shade(&view, form, &texel, lit);
        for (int k = 0; k < 3; k++)
            ck_assert_msg(fabsf(behind[k] - lit[k]) <= 1e-4f * lit[k], "%a, expected %a",
                          (double)behind[k], (double)lit[k]);
    }
}
END_TEST

/* No normal or a short one, no half vector, a light on the surface, the eye on it: finite. */
START_TEST(test_guards)
{
    static const float length[] = {0, 1e-20f, 1e-10f, 1e-3f, 1};
    for (int i = 0; i < 5 * 64; i++) {
        float x = length[i % 5] * (i / 5 & 32 ? -1.0f : 1.0f);
        ViewLight light = {.color = {50, 50, 50}, .attenuation = {0, 0, 1}};
        light.position[2] = (const float[]){0, -3, -6, 4}[i / 5 & 3];
        View view = one_light(&light);
        Texel texel = {.normal = {0, i / 5 & 4 ? x : 0, x},
                       .position = {0, 0, i / 5 & 8 ? 0.0f : -3.0f},
                       .diffuse = {1, 1, 1, 1},
                       .material = {i / 5 & 16 ? 0.0f : 1.0f, 1, 1}};
        for (int form = 0; form < 4; form++) {
            float source[4];
            shade(&view, (ShadeForm){.ggx = (GgxForm)(form & 1), .back_light = form > 1}, &texel,
                  source);
            for (int k = 0; k < 3; k++)
                ck_assert_msg(isfinite(source[k]) && source[k] >= 0, "case %d, form %d: %g", i,
                              form, (double)source[k]);
        }
    }
}
END_TEST

/* A point, its light at `part` of its range from it, and the range. */
static void in_range(Random *random, double part, Texel *texel, ViewLight *light)
{
    double d2 = 0;
    highlight(random, texel, light);
    texel->material[1] = (float)random_unit(random);
    for (int k = 0; k < 3; k++)
        d2 += ((double)light->position[k] - texel->position[k]) *
              ((double)light->position[k] - texel->position[k]);
    light->inverse_range2 = (float)(part * part / d2);
}

/* Within single precision of the window in double; of a light without end the same bits. */
START_TEST(test_window)
{
    Random random = random_seed(7);
    for (int i = 0; i < COUNT; i++) {
        Texel texel;
        ViewLight light;
        float whole[4], lit[4];
        double part = random_range(&random, 0, 1);
        in_range(&random, part, &texel, &light);
        View view = one_light(&light);
        shade(&view, (ShadeForm){0}, &texel, lit);
        view.lights[0].inverse_range2 = 0;
        shade(&view, (ShadeForm){0}, &texel, whole);
        double window = 1 - part * part * part * part;
        for (int k = 0; k < 3; k++)
            ck_assert_double_eq_tol(lit[k], whole[k] * window, whole[k] * 0x1p-20);
        view.lights[0].inverse_range2 = 0x1p-60f; /* its window rounds to 1 */
        shade(&view, (ShadeForm){0}, &texel, lit);
        ck_assert_mem_eq(lit, whole, sizeof lit);
    }
}
END_TEST

/* Beyond the range, however little: exactly the ambient light, as without the light. */
START_TEST(test_out_of_range)
{
    Random random = random_seed(8);
    for (int i = 0; i < COUNT; i++) {
        Texel texel;
        ViewLight light;
        float lit[4], ambient[4];
        ShadeForm form = {.ggx = (GgxForm)(i & 1), .back_light = i & 2};
        in_range(&random, i & 4 ? 1.0001 : random_range(&random, 1.0001, 100), &texel, &light);
        View view = one_light(&light);
        view.ambient[0] = view.ambient[1] = view.ambient[2] = 0.25f;
        shade(&view, form, &texel, lit);
        view.light_count = 0;
        shade(&view, form, &texel, ambient);
        ck_assert_mem_eq(lit, ambient, sizeof lit);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("shade");
    TCase *tests = tcase_create("shade");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, test_stable_form);
    tcase_add_test(tests, test_back_light);
    tcase_add_test(tests, test_guards);
    tcase_add_test(tests, test_window);
    tcase_add_test(tests, test_out_of_range);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}

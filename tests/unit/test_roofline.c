/* The operations of the lighting loop, counted while it runs; the arithmetic of the report. */
#include "testing.h"

#include "number/op.h"

static int adds, muls, clamps, divs, sqrts;

#define op_add(a, b) (adds++, (op_add)(a, b))
#define op_sub(a, b) (adds++, (op_sub)(a, b))
#define op_mul(a, b) (muls++, (op_mul)(a, b))
#define op_div(a, b) (divs++, (op_div)(a, b))
#define op_sqrt(a)   (sqrts++, (op_sqrt)(a))
#define op_max(a, b) (clamps++, (op_max)(a, b))
#define op_min(a, b) (clamps++, (op_min)(a, b))
#define LANES        1
#include "ref/pipeline/shade_body.h"

#include "ref/pipeline/roofline.h"
#include "study/roofline.h"

#include <math.h>

/* Counts of a fragment lit by so many lights. */
static void shade(size_t lights)
{
    ViewLight light[2] = {{.position = {0.0f, 0.0f, -1.0f}, .color = {1.0f, 1.0f, 1.0f}}};
    light[0].attenuation[0] = 1.0f;
    light[1] = light[0];
    const View view = {.light_count = lights, .lights = light};
    const ShadeForm form = {0};
    ShadeBatch batch = {.normal = {{0.0f}, {0.0f}, {1.0f}},
                        .position = {{0.0f}, {0.0f}, {-5.0f}},
                        .diffuse = {{0.5f}, {0.5f}, {0.5f}, {0.5f}},
                        .material = {{0.5f}, {0.5f}, {1.0f}}};
    adds = muls = clamps = divs = sqrts = 0;
    shade_batch(&view, &form, &batch);
    ck_assert_float_gt(batch.source[0][0], 0.0f);
}

START_TEST(test_operations_are_those_of_the_loop)
{
    shade(1);
    const int one[] = {adds, muls, clamps, divs, sqrts};
    shade(2);
    /* The light's direction is computed in two stages; the formula has it once. */
    ck_assert_int_eq(adds - one[0], ROOFLINE_ADDS + 3);
    ck_assert_int_eq(muls - one[1], ROOFLINE_MULS);
    ck_assert_int_eq(clamps - one[2], ROOFLINE_CLAMPS);
    ck_assert_int_eq(divs - one[3], ROOFLINE_DIVS);
    ck_assert_int_eq(sqrts - one[4], ROOFLINE_SQRTS);
}
END_TEST

START_TEST(test_bounds)
{
    const RooflineWidth width = {
        .muladd = {93e9, 0.0}, .divide = {6e9, 0.0}, .root = {4e9, 0.0}, .light = {0.5e9, 0.0}};
    RooflineLoop loop = roofline_loop(&width);
    ck_assert_double_eq_tol(loop.ns, 2.0, 1e-12);
    ck_assert_double_eq_tol(loop.flops, 50.5e9, 1.0);
    ck_assert_double_eq_tol(loop.share, 50.5 / 93.0, 1e-12);
    ck_assert_double_eq_tol(loop.arithmetic, 1.0, 1e-12);
    ck_assert_double_eq_tol(loop.divider, 1.5, 1e-12);
}
END_TEST

/* Every kernel runs, and lights as the others do. */
START_TEST(test_kernels)
{
    size_t count;
    const RooflineKernels *kernels = roofline_kernels(&count);
    double expected = 0.0;
    ck_assert_uint_ge(count, 1);
    for (size_t i = 0; i < count; i++) {
        RooflineLighting *data;
        float from[128], to[128] = {0.0f};
        ck_assert_int_eq(kernels[i].lighting(&data), RESULT_OK);
        double sum = (double)kernels[i].light(data, 2);
        free(data);
        expected = i ? expected : sum;
        ck_assert(isfinite(sum) && sum > 0.0);
        ck_assert_double_eq_tol(sum, expected, 1e-5 * expected);
        ck_assert_float_eq_tol(kernels[i].muladd(1000), 12.0f * (float)kernels[i].lanes, 1e-3f);
        ck_assert(isfinite(kernels[i].divide(3)) && isfinite(kernels[i].root(3)));
        if (kernels[i].fma)
            ck_assert_float_eq_tol(kernels[i].fma(1000), 12.0f * (float)kernels[i].lanes, 1e-3f);
        kernels[i].write(from, 128);
        ck_assert_float_eq(kernels[i].read(from, 128), 192.0f);
        for (int k = 0; k < 128; k++)
            from[k] = (float)k;
        kernels[i].copy(to, from, 128);
        ck_assert_mem_eq(to, from, sizeof to);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("roofline");
    TCase *tcase = tcase_create("roofline");
    tcase_add_test(tcase, test_operations_are_those_of_the_loop);
    tcase_add_test(tcase, test_bounds);
    tcase_add_test(tcase, test_kernels);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

/* The operations of number/op.h against the driver: the same bits in C and on llvmpipe. */
#include "driver.h"

/* ---- operations -------------------------------------------------------------------------------
 */

typedef struct Operation {
    const char *name, *body;
    float (*model)(const float *x, const float *y); /* of one channel */
    int channels; /* 1: only the first is a result, and x, y are whole vectors */
} Operation;

static float do_add(const float *x, const float *y)
{
    return op_add(*x, *y);
}
static float do_sub(const float *x, const float *y)
{
    return op_sub(*x, *y);
}
static float do_mul(const float *x, const float *y)
{
    return op_mul(*x, *y);
}
static float do_div(const float *x, const float *y)
{
    return op_div(*x, *y);
}
static float do_div_pi(const float *x, const float *y)
{
    (void)y;
    return op_div(*x, 3.14159265f);
}
static float do_muladd(const float *x, const float *y)
{
    return op_add(op_mul(*x, *y), *x);
}
static float do_sqrt(const float *x, const float *y)
{
    (void)y;
    return op_sqrt(*x);
}
static float do_inversesqrt(const float *x, const float *y)
{
    (void)y;
    return op_inversesqrt(*x);
}
static float do_min(const float *x, const float *y)
{
    return op_min(*x, *y);
}
static float do_max(const float *x, const float *y)
{
    return op_max(*x, *y);
}
static float do_saturate(const float *x, const float *y)
{
    (void)y;
    return op_saturate(*x);
}
static float do_mix(const float *x, const float *y)
{
    return op_mix(*x, *y, 0.3f);
}
static float do_dot3(const float *x, const float *y)
{
    return op_dot3(x, y);
}
static float do_cross(const float *x, const float *y)
{
    return op_sub(op_mul(x[1], y[2]), op_mul(x[2], y[1]));
}
static float do_where_less(const float *x, const float *y)
{
    return *x < *y ? 1.0f : *y;
}
static float do_exp2(const float *x, const float *y)
{
    (void)y;
    return op_exp2(fused, *x);
}
static float do_log2(const float *x, const float *y)
{
    (void)y;
    return op_log2(fused, *x);
}
static float do_pow(const float *x, const float *y)
{
    return op_pow(fused, *x, *y);
}

static const Operation operations[] = {
    {"add", "precise vec4 r = a + b; result = r;", do_add, 4},
    {"sub", "precise vec4 r = a - b; result = r;", do_sub, 4},
    {"mul", "precise vec4 r = a * b; result = r;", do_mul, 4},
    {"div", "precise vec4 r = a / b; result = r;", do_div, 4},
    {"div by constant", "precise vec4 r = a / 3.14159265; result = r;", do_div_pi, 4},
    {"mul, add", "precise vec4 r = a * b + a; result = r;", do_muladd, 4},
    {"fma()", "precise vec4 r = fma(a, b, a); result = r;", do_muladd, 4},
    {"sqrt", "precise vec4 r = sqrt(a); result = r;", do_sqrt, 4},
    {"inversesqrt", "precise vec4 r = inversesqrt(a); result = r;", do_inversesqrt, 4},
    {"min", "precise vec4 r = min(a, b); result = r;", do_min, 4},
    {"max", "precise vec4 r = max(a, b); result = r;", do_max, 4},
    {"clamp", "precise vec4 r = clamp(a, 0.0, 1.0); result = r;", do_saturate, 4},
    {"mix", "precise vec4 r = mix(a, b, 0.3); result = r;", do_mix, 4},
    {"dot", "precise float r = dot(a.xyz, b.xyz); result = vec4(r);", do_dot3, 1},
    {"cross", "precise vec3 r = cross(a.xyz, b.xyz); result = r.xxxx;", do_cross, 1},
    {"?:", "precise float r = a.x < b.x ? 1.0 : b.x; result = vec4(r);", do_where_less, 1},
    {"exp2", "precise vec4 r = exp2(a); result = r;", do_exp2, 4},
    {"log2", "precise vec4 r = log2(a); result = r;", do_log2, 4},
    {"pow", "precise vec4 r = pow(a, b); result = r;", do_pow, 4},
};

/* In flushing mode; returns the number of differing values and the first one's place. */
static long count_differing(const Operation *operation, int *texel, int *channel, float *expected)
{
    long differing = 0;
    for (int i = 0; i < TEXELS; i++)
        for (int k = 0; k < operation->channels; k++) {
            float model = operation->model(&a[i][k], &b[i][k]);
            if (driver_same(model, got[i][k]))
                continue;
            if (differing++ == 0) {
                *texel = i;
                *channel = k;
                *expected = model;
            }
        }
    return differing;
}

START_TEST(test_operation)
{
    const Operation *operation = &operations[_i];
    GLuint program = driver_build(driver_color_output, operation->body);
    driver_target(GL_RGBA32F, false);
    for (int set = 0; set < INPUT_SETS; set++) {
        driver_fill((InputSet)set);
        driver_upload();
        driver_draw(program);
        gl.ReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_FLOAT, got);
        int i = 0, k = 0;
        float expected = 0.0f;
        uint32_t mode = op_enter();
        long differing = count_differing(operation, &i, &k, &expected);
        op_leave(mode);
        ck_assert_msg(differing == 0,
                      "%s, set %d: %ld values differ; a %a b %a: driver %a, number/op.h %a",
                      operation->name, set, differing, (double)a[i][k], (double)b[i][k],
                      (double)got[i][k], (double)expected);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("arithmetic");
    TCase *tcase = tcase_create("driver");
    tcase_set_timeout(tcase, 120);
    tcase_add_checked_fixture(tcase, driver_open_after_mode, driver_close);
    tcase_add_loop_test(tcase, test_operation, 0, sizeof operations / sizeof *operations);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

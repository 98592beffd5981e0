/* Trigonometry against MPFR, and the algebra of matrices. */
#include "scene/matrix.h"

#include "base/random.h"
#include "testing.h"

#include <math.h>
#include <mpfr.h>
#include <stdio.h>

#define PI 3.141592653589793

typedef double (*Function)(double);
typedef int (*Exact)(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);

/* |got − exact| in units of the last place of the exact value. */
static double ulps(double angle, Function function, Exact exact)
{
    mpfr_t x, y, difference;
    mpfr_inits2(256, x, y, difference, (mpfr_ptr)0);
    mpfr_set_d(x, angle, MPFR_RNDN);
    exact(y, x, MPFR_RNDN);
    mpfr_sub_d(difference, y, function(angle), MPFR_RNDN);
    int exponent = mpfr_zero_p(y) ? -1022 : (int)mpfr_get_exp(y);
    mpfr_mul_2si(difference, difference, 53 - exponent, MPFR_RNDN);
    double error = fabs(mpfr_get_d(difference, MPFR_RNDN));
    mpfr_clears(x, y, difference, (mpfr_ptr)0);
    return error;
}

/* An angle of one of four kinds: anywhere, in the first turn, small, next to a multiple of π/2. */
static double sample(Random *random, int kind)
{
    if (kind == 0)
        return random_range(random, -1e5, 1e5);
    if (kind == 1)
        return random_range(random, -7.0, 7.0);
    double tiny = ldexp(random_range(random, -1.0, 1.0), -(int)(random_bits(random) % 60));
    if (kind == 2)
        return tiny;
    return (double)(random_bits(random) % 60000) * (PI / 2.0) + tiny;
}

static void check_function(const char *name, Function function, Exact exact, double limit)
{
    Random random = random_seed(7);
    double worst = 0.0, worst_angle = 0.0;
    for (int i = 0; i < 200000; i++) {
        double angle = sample(&random, i % 4), error = ulps(angle, function, exact);
        if (error > worst || error != error) {
            worst = error;
            worst_angle = angle;
        }
    }
    printf("%s: at most %.4f ULP, at %a\n", name, worst, worst_angle);
    ck_assert_msg(worst <= limit, "%s(%a): %g ULP, expected at most %g", name, worst_angle, worst,
                  limit);
}

/* The limits are those that matrix.h states. */
START_TEST(trigonometry_error)
{
    check_function("sin", matrix_sin, mpfr_sin, 0.816);
    check_function("cos", matrix_cos, mpfr_cos, 0.825);
    check_function("tan", matrix_tan, mpfr_tan, 2.17);
}
END_TEST

START_TEST(trigonometry_exact_points)
{
    ck_assert(matrix_sin(0.0) == 0.0);
    ck_assert(matrix_cos(0.0) == 1.0);
    ck_assert(isnan(matrix_sin(NAN)) && isnan(matrix_cos(INFINITY)));
    ck_assert(isnan(matrix_sin(1.0000001e5)) && isnan(matrix_tan(-1e300)));
    ck_assert(!isnan(matrix_sin(1e5)) && !isnan(matrix_sin(-1e5)));
}
END_TEST

static Matrix random_affine(Random *random)
{
    Matrix a = matrix_identity();
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 3; r++)
            a.m[4 * c + r] = random_range(random, -4.0, 4.0);
    return a;
}

START_TEST(inverse_times_matrix_is_identity)
{
    Random random = random_seed(11);
    for (int i = 0; i < 1000; i++) {
        Matrix a = random_affine(&random), inverse;
        ck_assert(matrix_invert_affine(&a, &inverse));
        Matrix product = matrix_multiply(&inverse, &a);
        double scale = 1.0;
        for (int k = 0; k < 16; k++)
            scale = fmax(scale, fabs(inverse.m[k]));
        for (int k = 0; k < 16; k++)
            ck_assert_double_eq_tol(product.m[k], k % 5 == 0 ? 1.0 : 0.0, 1e-13 * scale);
    }
}
END_TEST

START_TEST(singular_matrix_has_no_inverse)
{
    Matrix flat = matrix_scale(1.0, 0.0, 1.0), kept = matrix_identity();
    ck_assert(!matrix_invert_affine(&flat, &kept));
    ck_assert(kept.m[0] == 1.0);
    Matrix tiny = matrix_scale(1e-200, 1e-200, 1.0);
    ck_assert(!matrix_invert_affine(&tiny, &kept));
    Matrix broken = matrix_scale(NAN, 1.0, 1.0);
    ck_assert(!matrix_invert_affine(&broken, &kept));
}
END_TEST

/* (M⁻ᵀ n) · (M v) = n · v for every vector v. */
START_TEST(normal_matrix_keeps_right_angles)
{
    Random random = random_seed(13);
    for (int i = 0; i < 1000; i++) {
        Matrix a = random_affine(&random);
        double normal[9], n[3], v[3], mapped[3], turned[3], before = 0.0, after = 0.0, scale = 1.0;
        matrix_normal(&a, normal);
        a.m[12] = a.m[13] = a.m[14] = 0.0;
        for (int k = 0; k < 3; k++) {
            n[k] = random_range(&random, -1.0, 1.0);
            v[k] = random_range(&random, -1.0, 1.0);
        }
        matrix_point(&a, v, mapped);
        for (int r = 0; r < 3; r++) {
            turned[r] = normal[r] * n[0] + normal[3 + r] * n[1] + normal[6 + r] * n[2];
            before += n[r] * v[r];
            after += turned[r] * mapped[r];
            scale = fmax(scale, fabs(turned[r] * mapped[r]));
        }
        ck_assert_double_eq_tol(after, before, 1e-12 * scale);
    }
}
END_TEST

START_TEST(normal_matrix_of_a_flat_scale)
{
    Matrix flat = matrix_scale(2.0, 0.0, 3.0);
    double normal[9];
    matrix_normal(&flat, normal);
    ck_assert(normal[4] == 6.0 && normal[0] == 0.0 && normal[8] == 0.0);
}
END_TEST

/* Known points: the near and far planes map to −1 and 1, the field's edge to 1. */
static double depth_at(const Matrix *a, double z)
{
    return (a->m[10] * z + a->m[14]) / (a->m[11] * z);
}

START_TEST(perspective_to_other_depths)
{
    for (int endless = 0; endless < 2; endless++) {
        double far = endless ? INFINITY : 100.0;
        Matrix zero_one = matrix_perspective_zero_one(1.0, 1.5, 0.5, far);
        Matrix reversed = matrix_perspective_reversed(1.0, 1.5, 0.5, far);
        double distance = endless ? 1e18 : far;
        ck_assert_double_eq_tol(depth_at(&zero_one, -0.5), 0.0, 1e-15);
        ck_assert_double_eq_tol(depth_at(&zero_one, -distance), 1.0, 1e-15);
        ck_assert_double_eq_tol(depth_at(&reversed, -0.5), 1.0, 1e-15);
        ck_assert_double_eq_tol(depth_at(&reversed, -distance), 0.0, 1e-15);
        ck_assert_double_eq_tol(depth_at(&zero_one, -7.0) + depth_at(&reversed, -7.0), 1.0, 1e-15);
    }
}
END_TEST

START_TEST(perspective_maps_the_frustum)
{
    double aspect = 16.0 / 9.0, yfov = PI / 2.0;
    Matrix a = matrix_perspective(yfov, aspect, 0.5, 100.0);
    ck_assert_double_eq_tol(a.m[5], 1.0, 1e-15);
    ck_assert_double_eq_tol(a.m[0], 9.0 / 16.0, 1e-15);
    ck_assert_double_eq_tol((a.m[10] * -0.5 + a.m[14]) / 0.5, -1.0, 1e-14);
    ck_assert_double_eq_tol((a.m[10] * -100.0 + a.m[14]) / 100.0, 1.0, 1e-14);
    ck_assert(a.m[11] == -1.0 && a.m[15] == 0.0);
    Matrix endless = matrix_perspective(yfov, aspect, 0.5, INFINITY);
    ck_assert(endless.m[10] == -1.0 && endless.m[14] == -1.0);
}
END_TEST

START_TEST(look_at_puts_the_target_ahead)
{
    const double eye[3] = {1.0, 2.0, 3.0}, target[3] = {-4.0, 0.5, 1.0}, up[3] = {0.0, 1.0, 0.0};
    Matrix view = matrix_look_at(eye, target, up);
    double seen[3], origin[3];
    matrix_point(&view, target, seen);
    matrix_point(&view, eye, origin);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(origin[k], 0.0, 1e-14);
    ck_assert_double_eq_tol(seen[0], 0.0, 1e-14);
    ck_assert_double_eq_tol(seen[1], 0.0, 1e-14);
    ck_assert_double_eq_tol(seen[2], -sqrt(25.0 + 2.25 + 4.0), 1e-14);
    ck_assert_double_eq_tol(matrix_determinant3(&view), 1.0, 1e-14);
    ck_assert(view.m[5] > 0.0); /* up stays up */
}
END_TEST

START_TEST(rotation_about_y)
{
    Matrix quarter = matrix_rotate_y(PI / 2.0);
    double turned[3];
    matrix_point(&quarter, (const double[3]){0.0, 5.0, 1.0}, turned);
    ck_assert_double_eq_tol(turned[0], 1.0, 1e-15);
    ck_assert(turned[1] == 5.0);
    ck_assert_double_eq_tol(turned[2], 0.0, 1e-15);
    float rounded[16];
    matrix_round(&quarter, rounded);
    ck_assert_float_bits(rounded[8], 1.0f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("matrix");
    TCase *test = tcase_create("matrix");
    tcase_add_checked_fixture(test, NULL, mpfr_free_cache); /* in thread-local storage */
    tcase_set_timeout(test, 120);
    tcase_add_test(test, trigonometry_error);
    tcase_add_test(test, trigonometry_exact_points);
    tcase_add_test(test, inverse_times_matrix_is_identity);
    tcase_add_test(test, singular_matrix_has_no_inverse);
    tcase_add_test(test, normal_matrix_keeps_right_angles);
    tcase_add_test(test, normal_matrix_of_a_flat_scale);
    tcase_add_test(test, perspective_maps_the_frustum);
    tcase_add_test(test, perspective_to_other_depths);
    tcase_add_test(test, look_at_puts_the_target_ahead);
    tcase_add_test(test, rotation_about_y);
    suite_add_tcase(suite, test);
    return testing_run(suite);
}

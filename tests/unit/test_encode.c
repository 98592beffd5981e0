/* Octahedral normals and positions from depth: round trips against double precision. */
#include "testing.h"

#include "base/random.h"
#include "frame/view.h"
#include "number/format.h"
#include "ref/pipeline/encode.h"
#include "scene/generate.h"

#include <math.h>

/* Stored in 16 bits; returns the angle between what went in and what comes out, radians. */
static __attribute__((noinline)) double octahedral_error(const float normal[3])
{
    float encoded[4] = {0}, fetched[4], decoded[3];
    uint16_t stored[2];
    encode_octahedral(normal, encoded);
    for (int i = 0; i < 2; i++)
        ck_assert(encoded[i] >= 0.0f && encoded[i] <= 1.0f);
    format_store(FORMAT_RG16, encoded, stored);
    format_fetch(FORMAT_RG16, stored, fetched);
    decode_octahedral(fetched, decoded);
    double cross[3], square = 0.0, length2 = 0.0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        cross[i] = (double)normal[j] * decoded[k] - (double)normal[k] * decoded[j];
        square += cross[i] * cross[i];
        length2 += (double)decoded[i] * decoded[i];
    }
    ck_assert_double_eq_tol(length2, 1.0, 5e-7);
    ck_assert_double_gt((double)normal[0] * decoded[0] + (double)normal[1] * decoded[1] +
                            (double)normal[2] * decoded[2],
                        0.0);
    return asin(sqrt(square));
}

/* Half a code in both channels moves p by d = 1/65535 each; in the middle of a face, (1, 1, 1)/3,
 * that turns the normal by the most: (d, d, −2·d) against a length of 1/√3 gives √18·d. */
START_TEST(test_octahedral)
{
    Random random = random_seed(7);
    double worst = 0.0;
    for (int i = 0; i < testing_samples(2000000); i++) {
        double v[3], square = 0.0;
        for (int k = 0; k < 3; k++) {
            v[k] = random_range(&random, -1.0, 1.0);
            if (i % 5 == k)
                v[k] *= 1e-6; /* close to the fold or an axis */
            square += v[k] * v[k];
        }
        float normal[3];
        for (int k = 0; k < 3; k++)
            normal[k] = (float)(v[k] / sqrt(square));
        uint32_t mode = op_enter();
        double error = octahedral_error(normal);
        op_leave(mode);
        worst = error > worst ? error : worst;
    }
    ck_assert_double_lt(worst, sqrt(18.0) / 65535.0 + 2e-7);
    ck_assert_double_gt(worst, 6e-5);
}
END_TEST

/* Axes, signed zeros and no normal at all. */
START_TEST(test_octahedral_special)
{
    uint32_t mode = op_enter();
    for (int axis = 0; axis < 3; axis++)
        for (int sign = -1; sign <= 1; sign += 2)
            for (int zero = 0; zero < 2; zero++) {
                float z = zero ? -0.0f : 0.0f, normal[3] = {z, z, z};
                normal[axis] = (float)sign;
                ck_assert_double_lt(octahedral_error(normal), 3e-5); /* √2·d */
            }
    const float nothing[3] = {0.0f, 0.0f, 0.0f};
    const float backward[3] = {-0.0f, 0.0f, -1.0f};
    float encoded[2], decoded[3], folded[2];
    encode_octahedral(backward, folded);
    encode_octahedral(nothing, encoded);
    decode_octahedral(encoded, decoded);
    op_leave(mode);
    ck_assert_float_bits(folded[0], 1.0f); /* a zero of either sign folds to the positive side */
    ck_assert_float_bits(folded[1], 1.0f);
    ck_assert_float_bits(encoded[0], 0.5f);
    ck_assert_float_bits(encoded[1], 0.5f);
    ck_assert_float_bits(decoded[2], 1.0f);
}
END_TEST

/* Puts a point at view depth `distance` in the middle of pixel (x, y) through the projection in
 * double and back from the depth rounded to float. Returns the largest error over the distance. */
static __attribute__((noinline)) double position_error(const View *view, double distance, int x,
                                                       int y)
{
    const float *m = view->projection;
    bool half = view->depth_range != DEPTH_RANGE_GL;
    double ndc = ((double)m[10] * -distance + (double)m[14]) / distance;
    double depth = half ? ndc : 0.5 * ndc + 0.5, worst = 0.0;
    const double expected[3] = {((2 * x + 1.0) / view->width - 1.0) * distance / (double)m[0],
                                ((2 * y + 1.0) / view->height - 1.0) * distance / (double)m[5],
                                -distance};
    float position[3];
    decode_position(&view->unprojection, (float)depth, x, y, position);
    for (int i = 0; i < 3; i++)
        worst = fmax(worst, fabs((double)position[i] - expected[i]) / distance);
    return worst;
}

/* The rounding of the depth, 2^-25, and of the two operations on it is divided by the slope of
 * depth: relative error about 2^-23·distance/near. Reversed, 1/z keeps its own digits. */
START_TEST(test_position)
{
    Scene scene;
    View view;
    ck_assert_int_eq(generate_find("crossing_planes")->generate(&scene), RESULT_OK);
    double near = scene.cameras[0].near;
    for (int range = 0; range < 3; range++)
        for (int infinite = 0; infinite < 2; infinite++) {
            RenderDesc desc = {.width = 640, .height = 333, .depth_range = (DepthRange)range};
            scene.cameras[0].far = infinite ? INFINITY : 1000.0 * near;
            ck_assert_int_eq(view_build(&scene, &desc, &view), RESULT_OK);
            Random random = random_seed((uint64_t)range + 1);
            uint32_t mode = op_enter();
            for (int i = 0; i < testing_samples(100000); i++) {
                double distance = near * pow(1000.0, random_unit(&random));
                double error = position_error(&view, distance, (int)(random_bits(&random) % 640),
                                              (int)(random_bits(&random) % 333));
                double bound = range == DEPTH_RANGE_REVERSED ? 8.0 : 2.0 * distance / near + 6.0;
                if (error > 0x1p-23 * bound)
                    ck_abort_msg("range %d at %g near: relative error %g", range, distance / near,
                                 error);
            }
            op_leave(mode);
            view_free(&view);
        }
    scene_free(&scene);
}
END_TEST

/* Nothing lies behind the far plane; infinity is 1e15. */
START_TEST(test_far)
{
    static const float far_depth[3] = {1.0f, 1.0f, 0.0f};
    Scene scene;
    View view;
    ck_assert_int_eq(generate_find("crossing_planes")->generate(&scene), RESULT_OK);
    for (int range = 0; range < 3; range++)
        for (int infinite = 0; infinite < 2; infinite++) {
            RenderDesc desc = {.width = 64, .height = 33, .depth_range = (DepthRange)range};
            float position[3];
            scene.cameras[0].near = 0.125;
            scene.cameras[0].far = infinite ? INFINITY : 1e9;
            ck_assert_int_eq(view_build(&scene, &desc, &view), RESULT_OK);
            uint32_t mode = op_enter();
            decode_position(&view.unprojection, far_depth[range], 3, 4, position);
            op_leave(mode);
            ck_assert_double_eq_tol((double)-position[2], infinite ? 1e15 : 1e9,
                                    infinite ? 1e9 : 1e3);
            ck_assert(isfinite(position[0]) && isfinite(position[1]));
            view_free(&view);
        }
    scene_free(&scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("encode");
    TCase *tcase = tcase_create("round trips");
    tcase_set_timeout(tcase, 120);
    tcase_add_test(tcase, test_octahedral);
    tcase_add_test(tcase, test_octahedral_special);
    tcase_add_test(tcase, test_position);
    tcase_add_test(tcase, test_far);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

/* The painter: ref against OpenGL bit for bit, right where sorting can be, wrong where it cannot.
 */
#include "methods.h"

#include "compare/metrics.h"
#include "ref/truth/truth.h"
#include "scene/generate.h"

#include <math.h>
#include <stdio.h>

START_TEST(test_bits)
{
    uint64_t fragments = 0;
    for (uint64_t seed = 1; seed <= 24; seed++) {
        Bits bits;
        methods_check_soup(seed, METHOD_PAINTER, &bits);
        fragments += bits.layers.fragments;
        ck_assert_uint_eq(bits.layers.lost_to_ties, 0);
    }
    ck_assert_uint_gt(fragments, 0);
}
END_TEST

static double greatest(const Image *image)
{
    double most = 0.0;
    for (int i = 0; i < 4 * image->width * image->height; i++)
        most = fmax(most, (double)((const float *)image->pixels)[i]);
    return most;
}

/* Squares one behind the other are in the right order whatever order they are drawn in. Over and
 * under round in other places: each of four layers twice, by half an ULP of what is there. */
START_TEST(test_separate)
{
    static Soup soup;
    static const double depths[] = {3.0, 2.0, 7.0, 5.0};
    RenderDesc desc = {.width = 192, .height = 20};
    Frame peel, painter;
    methods_squares(&soup, depths, 4, 0.4f);
    methods_ok(pipeline_render(&soup.scene, &desc, NULL, &peel));
    ck_assert_int_eq(peel.peels, 4);
    desc.method = METHOD_PAINTER;
    for (int order = DRAW_ORDER_SCENE; order <= DRAW_ORDER_SHUFFLE; order++)
        for (int sort = SORT_OBJECTS; sort <= SORT_TRIANGLES; sort++) {
            FinalMetrics metrics;
            desc.draw_order = (DrawOrder)order;
            desc.draw_seed = 3;
            desc.sort = (SortUnit)sort;
            methods_ok(pipeline_render(&soup.scene, &desc, NULL, &painter));
            metrics_final(&painter.final, &peel.final, &metrics);
            ck_assert_double_le(metrics.max_abs, 16 * 0x1p-24 * greatest(&peel.final));
            frame_free(&painter);
        }
    frame_free(&peel);
}
END_TEST

static double error(const char *name, SortUnit sort, MethodId method)
{
    Scene scene;
    Frame painter, truth;
    FinalMetrics metrics;
    RenderDesc desc = {.width = 160, .height = 90, .lights = 3, .method = method, .sort = sort};
    methods_ok(generate_find(name)->generate(&scene));
    methods_ok(pipeline_render(&scene, &desc, NULL, &painter));
    methods_ok(truth_render(&scene, &desc, NULL, &truth));
    metrics_final(&painter.final, &truth.final, &metrics);
    frame_free(&painter);
    frame_free(&truth);
    scene_free(&scene);
    return metrics.rmse;
}

START_TEST(test_against_truth)
{
    static const char *const names[] = {"chain", "crossing_planes", "alpha_ladder"};
    /* By objects, by triangles. The rings' triangles are small enough. */
    static const bool right[3][2] = {{false, true}, {false, false}, {true, true}};
    for (int i = 0; i < 3; i++) {
        double objects = error(names[i], SORT_OBJECTS, METHOD_PAINTER);
        double triangles = error(names[i], SORT_TRIANGLES, METHOD_PAINTER);
        double peel = error(names[i], SORT_OBJECTS, METHOD_PEEL);
        printf("%s: RMSE against truth %.3g by objects, %.3g by triangles; peel %.3g\n", names[i],
               objects, triangles, peel);
        ck_assert_double_le(peel, 1e-6);
        if (right[i][0])
            ck_assert_double_le(objects, 1e-6);
        else
            ck_assert_double_ge(objects, 1e-2);
        if (right[i][1])
            ck_assert_double_le(triangles, 1e-6);
        else
            ck_assert_double_ge(triangles, 1e-2);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("painter");
    TCase *tcase = tcase_create("painter");
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_bits);
    tcase_add_test(tcase, test_separate);
    tcase_add_test(tcase, test_against_truth);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

/* frame/sort.h against a slow, plain computation. */
#include "testing.h"

#include "../cross/soup.h"
#include "frame/sort.h"
#include "number/op.h"

#include <math.h>

static Soup soup;

static void make(uint64_t seed, const RenderDesc *desc, SortUnit unit, View *view, Sort *sort)
{
    Random random = random_seed(seed);
    soup_make(&random, &soup);
    ck_assert_int_eq(view_build(&soup.scene, desc, view), RESULT_OK);
    ck_assert_int_eq(sort_far_to_near(&soup.scene, view, unit, sort), RESULT_OK);
}

static double mean_z(const View *view, const Draw *draw, uint32_t first, uint32_t count)
{
    const Mesh *mesh = &soup.scene.meshes[draw->mesh];
    double sum = 0.0;
    (void)view;
    for (uint32_t i = 3 * first; i < 3 * (first + count); i++) {
        double z = (double)draw->model_view[14];
        for (int c = 0; c < 3; c++)
            z += (double)draw->model_view[4 * c + 2] *
                 (double)mesh->position[3 * mesh->index[i] + (uint32_t)c];
        sum += z;
    }
    return sum / (3.0 * count);
}

/* Every triangle of a transparent draw once, each not nearer than the one before it, ties by id. */
START_TEST(test_order)
{
    const RenderDesc desc = {.width = 64, .height = 64};
    SortUnit unit = (SortUnit)_i;
    int ties = 0;
    for (uint64_t seed = 1; seed <= 40; seed++) {
        View view;
        Sort sort;
        uint64_t triangles = 0, expected = 0;
        double last_z = -INFINITY;
        int64_t last_id = -1;
        make(seed, &desc, unit, &view, &sort);
        for (size_t i = 0; i < view.draw_count; i++)
            if (view.draws[i].transparent)
                expected += soup.scene.meshes[view.draws[i].mesh].triangle_count;
        static uint8_t seen[SOUP_INSTANCES * SOUP_TRIANGLES];
        memset(seen, 0, sizeof seen);
        for (size_t i = 0; i < sort.count; i++) {
            const SortRun *run = &sort.runs[i];
            const Draw *draw = &view.draws[run->draw];
            uint32_t all = soup.scene.meshes[draw->mesh].triangle_count;
            uint32_t step = unit == SORT_OBJECTS ? all : 1;
            ck_assert(draw->transparent && run->first + run->count <= all);
            ck_assert_uint_eq(run->count % step, 0);
            for (uint32_t t = run->first; t < run->first + run->count; t += step) {
                double z = mean_z(&view, draw, t, step);
                int64_t id = draw->first_primitive + t;
                double slack = 1e-12 * fabs(z);
                ck_assert_double_ge(z, last_z - slack);
                if (z == last_z) {
                    ck_assert_int_gt(id, last_id);
                    ties++;
                }
                last_z = z;
                last_id = id;
                for (uint32_t k = 0; k < step; k++)
                    ck_assert_uint_eq(seen[id + k]++, 0);
            }
            triangles += run->count;
        }
        ck_assert_uint_eq(triangles, expected);
        sort_free(&sort);
        view_free(&view);
    }
    ck_assert_int_gt(ties, 0);
}
END_TEST

/* The order of the draws does not matter, nor does a run join triangles of two draws. */
START_TEST(test_draw_order)
{
    RenderDesc desc = {.width = 64, .height = 64};
    SortUnit unit = (SortUnit)_i;
    for (uint64_t seed = 1; seed <= 20; seed++) {
        View scene_view, view;
        Sort scene_order, sort;
        desc.draw_order = DRAW_ORDER_SCENE;
        make(seed, &desc, unit, &scene_view, &scene_order);
        desc.draw_order = seed % 2 ? DRAW_ORDER_REVERSE : DRAW_ORDER_SHUFFLE;
        desc.draw_seed = seed;
        make(seed, &desc, unit, &view, &sort);
        ck_assert_uint_eq(sort.count, scene_order.count);
        for (size_t i = 0; i < sort.count; i++) {
            const SortRun *a = &scene_order.runs[i], *b = &sort.runs[i];
            ck_assert_uint_eq(scene_view.draws[a->draw].first_primitive,
                              view.draws[b->draw].first_primitive);
            ck_assert_uint_eq(a->first, b->first);
            ck_assert_uint_eq(a->count, b->count);
        }
        sort_free(&sort);
        sort_free(&scene_order);
        view_free(&view);
        view_free(&scene_view);
    }
}
END_TEST

/* A renderer may call it in flushing mode. */
START_TEST(test_flushing)
{
    const RenderDesc desc = {.width = 64, .height = 64};
    View view;
    Sort plain, flushed, nothing;
    make(3, &desc, SORT_TRIANGLES, &view, &plain);
    sort_free(&plain);
    for (int m = 0; m < SOUP_MESHES; m++)
        for (size_t i = 0; i < 9 * (size_t)soup.meshes[m].triangle_count; i++)
            soup.position[m][i] *= 0x1p-130f; /* denormal */
    for (size_t i = 0; i < view.draw_count; i++)
        view.draws[i].model_view[14] = 0.0f;
    ck_assert_int_eq(sort_far_to_near(&soup.scene, &view, SORT_TRIANGLES, &plain), RESULT_OK);
    uint32_t saved = op_enter();
    Result result = sort_far_to_near(&soup.scene, &view, SORT_TRIANGLES, &flushed);
    op_leave(saved);
    ck_assert_int_eq(result, RESULT_OK);
    ck_assert_uint_eq(plain.count, flushed.count);
    ck_assert_mem_eq(plain.runs, flushed.runs, plain.count * sizeof *plain.runs);
    for (int m = 0; m < SOUP_MESHES; m++)
        memset(soup.position[m], 0, sizeof soup.position[m]);
    ck_assert_int_eq(sort_far_to_near(&soup.scene, &view, SORT_TRIANGLES, &nothing), RESULT_OK);
    ck_assert_uint_ne(plain.count, nothing.count);
    sort_free(&plain);
    sort_free(&flushed);
    sort_free(&nothing);
    view_free(&view);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sort");
    TCase *tcase = tcase_create("sort");
    tcase_add_loop_test(tcase, test_order, SORT_OBJECTS, SORT_TRIANGLES + 1);
    tcase_add_loop_test(tcase, test_draw_order, SORT_OBJECTS, SORT_TRIANGLES + 1);
    tcase_add_test(tcase, test_flushing);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

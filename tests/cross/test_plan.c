/* What the plan says of a frame, against the frame: gl's bytes, passes, layers; and the choices of
 * a search. */
#include "testing.h"

#include "random_desc.h"

#include "gl/gl_renderer.h"
#include "ref/pipeline/count.h"
#include "ref/pipeline/pipeline.h"
#include "ref/truth/truth.h"
#include "study/plan.h"

static Soup soup;

static RenderDesc make(uint64_t seed)
{
    Random random = random_seed(seed);
    soup_make(&random, &soup);
    RenderDesc desc = random_desc_settings(&random);
    desc.width = 83;
    desc.height = 71; /* tiles that are cut */
    desc.threads = 2;
    desc.passes = 0;
    desc.nodes_per_pixel = 0;
    desc.method = (MethodId)(seed % METHOD_COUNT);
    return desc;
}

static void render(Renderer renderer, const RenderDesc *desc, Frame *out)
{
    ck_assert_msg(renderer(&soup.scene, desc, NULL, out) == RESULT_OK, "%s", result_message());
}

static void plan_soup(const RenderDesc *desc, Plan *out)
{
    ck_assert_msg(plan_run(&soup.scene, "soup", desc, count_layers, pipeline_render, out) ==
                      RESULT_OK,
                  "%s", result_message());
}

/* ---- memory ---- */

START_TEST(test_bytes)
{
    uint64_t saved = 0;
    for (uint64_t seed = 1; seed <= 30; seed++) {
        RenderDesc desc = make(seed);
        if (seed % 3 == 0)
            soup.scene.light_count = 0;
        Plan plan;
        Frame frame;
        plan_soup(&desc, &plan);
        render(gl_render, &desc, &frame);
        ck_assert_msg(plan.buffers.bytes == frame.buffer_bytes,
                      "seed %llu, method %d: planned %llu bytes, gl has %llu",
                      (unsigned long long)seed, desc.method, (unsigned long long)plan.buffers.bytes,
                      (unsigned long long)frame.buffer_bytes);
        saved += plan.bytes_of_all - plan.buffers.bytes;
        frame_free(&frame);
        desc.model_all = true;
        render(gl_render, &desc, &frame);
        ck_assert_uint_eq(plan.bytes_of_all, frame.buffer_bytes);
        frame_free(&frame);
        plan_free(&plan);
    }
    ck_assert_uint_gt(saved, 0);
}
END_TEST

/* ---- layers ---- */

static uint64_t sum(const uint64_t *histogram, uint32_t most, bool weighted)
{
    uint64_t total = 0;
    for (uint32_t i = 0; i <= most; i++)
        total += histogram[i] * (weighted ? i : 1);
    return total;
}

/* With the raw test gl and ref repeat layers, and a limit is not planned for. */
START_TEST(test_layers)
{
    uint64_t lost = 0;
    for (uint64_t seed = 1; seed <= 60; seed++) {
        RenderDesc desc = make(seed);
        desc.peel_test = PEEL_TEST_STORED;
        Plan plan;
        Frame frame;
        plan_soup(&desc, &plan);
        for (int i = 0; i < METHOD_COUNT; i++) {
            desc.method = (MethodId)i;
            render(pipeline_render, &desc, &frame);
            ck_assert_msg(plan.passes[i] == frame.geometry_passes,
                          "seed %llu, method %d: planned %d passes, ref took %d",
                          (unsigned long long)seed, i, plan.passes[i], frame.geometry_passes);
            ck_assert_uint_eq(plan.layers.most.fragments, frame.layers.max);
            ck_assert_uint_eq(plan.layers.fragments, frame.layers.fragments);
            if (i == METHOD_PEEL && desc.bias == 0.0f) {
                ck_assert_uint_eq(plan.layers.peels,
                                  frame.layers.fragments - frame.layers.lost_to_ties);
                lost += frame.layers.lost_to_ties;
            }
            frame_free(&frame);
        }
        const LayerCounts *layers = &plan.layers;
        ck_assert_uint_eq(sum(layers->histogram, layers->most.fragments, false), 83 * 71);
        ck_assert_uint_eq(sum(layers->histogram, layers->most.fragments, true), layers->fragments);
        ck_assert_uint_eq(sum(layers->peel_histogram, layers->most.peels, false), 83 * 71);
        ck_assert_uint_eq(sum(layers->peel_histogram, layers->most.peels, true), layers->peels);
        plan_free(&plan);
    }
    ck_assert_uint_gt(lost, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("plan");
    TCase *tcase = tcase_create("plan");
    tcase_set_timeout(tcase, 600);
    tcase_add_test(tcase, test_bytes);
    tcase_add_test(tcase, test_layers);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

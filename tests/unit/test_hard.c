/* The catalogue of hard cases: its table, its files, its judgement. */
#include "compare/finite.h"
#include "scene/gltf.h"
#include "study/hard.h"

#include "current_gltf.h"
#include "scratch.h"
#include "testing.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

START_TEST(table_is_complete)
{
    size_t cases, scenes;
    const HardCase *hard = hard_cases(&cases);
    const HardScene *scene = hard_scenes_table(&scenes);
    ck_assert_uint_ge(cases, 32);
    ck_assert_uint_eq(cases, scenes);
    for (size_t i = 0; i < cases; i++) {
        ck_assert_str_eq(hard[i].name, scene[i].name);
        ck_assert_ptr_eq(hard_find(hard[i].name), &hard[i]);
        ck_assert_ptr_eq(hard_scenes_find(hard[i].name), &scene[i]);
        ck_assert_msg(scene[i].why[0] && scene[i].source[0] && hard[i].ought[0], "%s",
                      hard[i].name);
    }
    ck_assert_ptr_null(hard_find("no such case"));
    ck_assert_ptr_null(hard_scenes_find("no such case"));
}
END_TEST

/* Names are unique, images to compare with come before, and the slice is a part of the whole. */
START_TEST(configurations_make_sense)
{
    size_t cases;
    const HardCase *hard = hard_cases(&cases);
    for (size_t i = 0; i < cases; i++) {
        HardConfig all[HARD_CONFIGS], slice[HARD_CONFIGS];
        size_t count = hard_configs(&hard[i], false, all);
        size_t few = hard_configs(&hard[i], true, slice);
        ck_assert_uint_ge(count, 10);
        ck_assert_uint_le(count, HARD_CONFIGS);
        ck_assert_uint_ge(few, 1);
        ck_assert_uint_le(few, 3);
        bool methods[METHOD_COUNT] = {false};
        for (size_t k = 0; k < count; k++) {
            const char *image = all[k].expect.image;
            bool found = !image;
            methods[all[k].desc.method] = true;
            ck_assert_int_eq(all[k].desc.width, hard[i].size);
            for (size_t j = 0; j < k; j++) {
                ck_assert_str_ne(all[j].name, all[k].name);
                found = found || strcmp(all[j].name, image + (image[0] == '!')) == 0;
            }
            ck_assert_msg(found, "%s, %s: no earlier configuration %s", hard[i].name, all[k].name,
                          image);
        }
        for (int m = 0; m < METHOD_COUNT && !hard[i].slow; m++)
            ck_assert_msg(methods[m], "%s: method %d is not there", hard[i].name, m);
    }
}
END_TEST

/* The files of data/hard are what the generators write today. If a case is changed on purpose:
 * build/peel hard --export data/hard. */
START_TEST(files_are_current)
{
    size_t count;
    const HardScene *table = hard_scenes_table(&count);
    for (size_t i = 0; i < count; i++)
        current_gltf_check("hard", table[i].name, table[i].generate);
}
END_TEST

/* A file means the scene that was written, to the bit. */
START_TEST(files_mean_the_scenes)
{
    size_t count;
    const HardScene *table = hard_scenes_table(&count);
    for (size_t i = 0; i < count; i++) {
        Scene made, read;
        char stored[256];
        snprintf(stored, sizeof stored, "%s/data/hard/%s.gltf", PEEL_SOURCE_DIR, table[i].name);
        ck_assert_int_eq(table[i].generate(&made), RESULT_OK);
        ck_assert_msg(gltf_load(stored, &read) == RESULT_OK, "%s", result_message());
        ck_assert_uint_eq(read.instance_count, made.instance_count);
        ck_assert_double_eq(read.cameras[0].near, made.cameras[0].near);
        ck_assert(read.cameras[0].far == made.cameras[0].far);
        for (size_t k = 0; k < made.instance_count; k++) {
            const Instance *a = &made.instances[k], *b = &read.instances[k];
            const Mesh *p = &made.meshes[a->mesh], *q = &read.meshes[b->mesh];
            for (int e = 0; e < 16; e++)
                ck_assert_msg(a->world.m[e] == b->world.m[e], "%s, instance %zu: [%d] %a, %a",
                              table[i].name, k, e, a->world.m[e], b->world.m[e]);
            ck_assert_uint_eq(p->triangle_count, q->triangle_count);
            for (size_t v = 0; v < 3 * (size_t)p->triangle_count; v++) {
                ck_assert_mem_eq(p->position + 3 * p->index[v], q->position + 3 * q->index[v], 12);
                ck_assert_mem_eq(p->normal + 3 * p->index[v], q->normal + 3 * q->index[v], 12);
            }
            ck_assert_mem_eq(made.materials[a->material].base_color,
                             read.materials[b->material].base_color, 4 * sizeof(float));
        }
        ck_assert_mem_eq(made.ambient, read.ambient, sizeof made.ambient);
        ck_assert_uint_eq(made.light_count, read.light_count);
        for (size_t k = 0; k < made.light_count; k++) {
            const Light *a = &made.lights[k], *b = &read.lights[k];
            ck_assert_mem_eq(a->position, b->position, sizeof a->position);
            ck_assert_mem_eq(a->color, b->color, sizeof a->color);
            ck_assert_mem_eq(a->attenuation, b->attenuation, sizeof a->attenuation);
            ck_assert_float_bits(a->range, b->range);
        }
        scene_free(&made);
        scene_free(&read);
    }
}
END_TEST

/* ---- judgement ------------------------------------------------------------------------------ */

/* A row that meets the expectations of a case that has none of its own. */
static HardRow good_row(void)
{
    return (HardRow){.config = {.name = "peel", .desc = {.width = 8, .height = 8}},
                     .structure = true,
                     .layers = {.fragments = 64, .max = 1}};
}

static void check_verdict(const HardCase *hard, HardRow row, bool pass, const char *text)
{
    hard_judge(hard, &row);
    ck_assert_msg(row.pass == pass && strstr(row.failure, text), "got '%s', expected '%s'",
                  row.failure, text);
}

START_TEST(whatever_is_wrong_is_seen)
{
    const HardCase hard = {.name = "x", .fragments = HARD_EXACTLY(64), .deepest = HARD_EXACTLY(1)};
    check_verdict(&hard, good_row(), true, "");
    const struct {
        size_t offset;
        const char *text;
    } counts[] = {
        {offsetof(HardRow, layers.lost_to_ties), "lost to ties"},
        {offsetof(HardRow, layers.lost_to_pass_limit), "lost to the pass limit"},
        {offsetof(HardRow, layers.lost_to_overflow), "lost to overflow"},
        {offsetof(HardRow, layers.repeated), "repeated"},
        {offsetof(HardRow, layers.fragments), "fragments"},
        {offsetof(HardRow, inversions), "inversions"},
        {offsetof(HardRow, sets), "one side only"},
        {offsetof(HardRow, flips), "opaque surface"},
        {offsetof(HardRow, ref_gl), "between ref and gl"},
        {offsetof(HardRow, nonfinite), "not finite"},
    };
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        HardRow row = good_row();
        *(uint64_t *)((char *)&row + counts[i].offset) += 1;
        check_verdict(&hard, row, false, counts[i].text);
    }
    HardRow row = good_row();
    row.layers.max = 2;
    check_verdict(&hard, row, false, "deepest");
}
END_TEST

START_TEST(counts_between_limits)
{
    const HardCase hard = {.name = "x"};
    const HardCount from = HARD_FROM(5), exactly = HARD_EXACTLY(7), range = {5, 8};
    const HardCount expected[3] = {from, exactly, range};
    for (int i = 0; i < 3; i++)
        for (uint64_t got = 0; got < 12; got++) {
            HardRow row = good_row();
            row.config.expect.ties = expected[i];
            row.layers.lost_to_ties = got;
            bool pass = i == 0 ? got >= 5 : i == 1 ? got == 7 : got >= 5 && got <= 8;
            check_verdict(&hard, row, pass, pass ? "" : "lost to ties, expected");
        }
}
END_TEST

START_TEST(errors_pixels_images)
{
    const HardCase hard = {.name = "x"};
    HardRow row = good_row();
    row.error = 1.01e-4;
    check_verdict(&hard, row, false, "expected at most");
    row.error = NAN;
    check_verdict(&hard, row, false, "expected at least");
    row.error = 0.99e-4;
    check_verdict(&hard, row, true, "");
    row.config.expect.error_from = 1e-4;
    check_verdict(&hard, row, false, "expected at least");

    row = good_row();
    row.config.expect.pixels[1] = (HardPixel){1, 2, {0.5, 0.5, 0.5, 1.0}, 1e-5, false};
    check_verdict(&hard, row, false, "ref is 0 in channel 0 of pixel (1, 2)");
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < 4; c++)
            row.pixels[1][side][c] = c < 3 ? 0.5f : 1.0f;
    check_verdict(&hard, row, true, "");
    row.pixels[1][1][3] = 0.99999f;
    check_verdict(&hard, row, false, "truth is");
    row.config.expect.pixels[1].format_only = true;
    check_verdict(&hard, row, true, "");

    row = good_row();
    row.config.expect.image = "other";
    row.image_like = 1;
    check_verdict(&hard, row, false, "differs from that of other");
    row.image_same = true;
    check_verdict(&hard, row, true, "");
    row.config.expect.image = "!other";
    check_verdict(&hard, row, false, "is that of other");
}
END_TEST

START_TEST(bounds_follow_the_formats)
{
    const HardCase hard = {.name = "x"}, bright = {.name = "x", .bright = true};
    RenderDesc desc = {.width = 8, .height = 8};
    ck_assert_double_eq(hard_error_bound(&hard, &desc, 1000), 1e-4);
    desc.accum = FORMAT_RGBA8;
    ck_assert_double_eq_tol(hard_error_bound(&hard, &desc, 3), 1e-4 + 8.0 / 255.0, 1e-12);
    ck_assert(isinf(hard_error_bound(&bright, &desc, 3)));
    desc.accum = FORMAT_RGBA16F;
    ck_assert_double_eq_tol(hard_error_bound(&bright, &desc, 3), 1e-4 + 8.0 / 1024.0, 1e-12);
    desc.method = METHOD_WEIGHTED_SUM;
    ck_assert(isinf(hard_error_bound(&hard, &desc, 3)));
}
END_TEST

/* ---- values that are no finite numbers ------------------------------------------------------- */

static uint64_t nonfinite(PixelFormat format, const void *pixel)
{
    Finite finite = finite_before(NULL);
    ck_assert_int_eq(trace_put(&finite.sink, "x", 0, format, 1, 1, pixel), RESULT_OK);
    return finite.nonfinite;
}

START_TEST(finite_counts)
{
    const float floats[4] = {INFINITY, -NAN, 3.4e38f, -1e-40f};
    const uint16_t halves[4] = {0x7c00, 0xfe01, 0x7bff, 0x0001};
    const uint16_t unorms[4] = {0xffff, 0x7c00, 0xfc00, 0};
    ck_assert_uint_eq(nonfinite(FORMAT_RGBA32F, floats), 2);
    ck_assert_uint_eq(nonfinite(FORMAT_RGBA16F, halves), 2);
    ck_assert_uint_eq(nonfinite(FORMAT_RGBA16, unorms), 0);
    ck_assert_uint_eq(nonfinite(FORMAT_D32F, &floats[1]), 1);
    ck_assert_uint_eq(nonfinite(FORMAT_R32UI, (const uint32_t[]){UINT32_MAX}), 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hard");
    TCase *catalogue = tcase_create("catalogue");
    tcase_set_timeout(catalogue, 120);
    tcase_add_checked_fixture(catalogue, scratch_make, scratch_remove);
    tcase_add_test(catalogue, table_is_complete);
    tcase_add_test(catalogue, configurations_make_sense);
    tcase_add_test(catalogue, files_are_current);
    tcase_add_test(catalogue, files_mean_the_scenes);
    suite_add_tcase(suite, catalogue);
    TCase *judgement = tcase_create("judgement");
    tcase_add_test(judgement, whatever_is_wrong_is_seen);
    tcase_add_test(judgement, counts_between_limits);
    tcase_add_test(judgement, errors_pixels_images);
    tcase_add_test(judgement, bounds_follow_the_formats);
    tcase_add_test(judgement, finite_counts);
    suite_add_tcase(suite, judgement);
    return testing_run(suite);
}

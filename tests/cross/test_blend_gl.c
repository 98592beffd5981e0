/* Fixed-function blending of the GL driver over the sets of vectors: all of the under-blend's 2^24
 * triples in 8 bits, a part of each set in every format and equation; nothing is left unexplained,
 * and a driver that is wrong in one value is found out. `peel blend check --gl` does it all. */
#include "labs.h"

#include "study/blend_driver.h"
#include "study/blend_wrong.h"

enum {
    LIMIT = 4096 /* vectors of each set */
};

static BlendReport report;

static void run(Lab *lab, PixelFormat format, EquationId equation, unsigned sets, uint64_t limit)
{
    uint64_t changed;
    BlendDriverDesc desc = {.format = format,
                            .equation = equation_info(equation)->equation,
                            .sets = sets,
                            .limit = limit,
                            .threads = 2,
                            .worst = 1};
    ck_assert_msg(blend_driver_run(lab, &desc, &report, &changed) == RESULT_OK, "%s",
                  result_message());
    ck_assert_uint_eq(changed, 0);
    ck_assert_uint_eq(report.vectors, blend_driver_vectors(&desc));
}

/* The driver's own arithmetic explains everything. */
static void assert_driver(void)
{
    const char *name = driver_info.mode == FUSES_YES ? "driver" : "driver-unfused";
    size_t best = blend_best_whole(&report);
    const BlendCandidate *one = &report.candidates[best];
    ck_assert_msg(blend_unexplained(&report) == 0, "%s, nearest %s: %llu unexplained, vector %llu",
                  format_info(report.format)->name, one->name,
                  (unsigned long long)blend_unexplained(&report),
                  (unsigned long long)one->simplest.index);
    ck_assert_int_eq(blend_verdict(&report, API_COUNT), BLEND_NAMED);
    bool found = false;
    for (size_t i = 0; i < report.count; i++)
        found |= strcmp(report.candidates[i].name, name) == 0 &&
                 report.candidates[i].vectors == report.vectors &&
                 report.candidates[i].groups[GROUP_COLOR].differing +
                         report.candidates[i].groups[GROUP_ALPHA].differing ==
                     0;
    ck_assert_msg(found, "%s: not %s", format_info(report.format)->name, name);
}

START_TEST(test_all_triples)
{
    run(lab_experiments(driver), FORMAT_RGBA8, EQUATION_UNDER, 1u << VECTORS_EXHAUSTIVE, 0);
    ck_assert_uint_eq(report.vectors, 1u << 24);
    assert_driver();
    blend_report_free(&report);
}
END_TEST

START_TEST(test_every_equation)
{
    for (int e = 0; e < EQUATION_COUNT; e++) {
        run(lab_experiments(driver), arithmetic_formats[_i], (EquationId)e, ~0u, LIMIT);
        assert_driver();
        blend_report_free(&report);
    }
}
END_TEST

/* ---- a driver that is wrong ------------------------------------------------------------------ */

typedef struct FaultyLab {
    Lab lab;
    bool destination; /* stores one destination as another; else one result */
    uint64_t texel;   /* which */
} FaultyLab;

static Result run_faulty(Lab *lab, const Experiment *experiment, uint32_t *out)
{
    FaultyLab *self = (FaultyLab *)lab;
    Result result = model.lab.run(&model.lab, experiment, out);
    self->texel = 99;
    if (self->destination) {
        experiment->before[4 * self->texel] ^= 1;
        return result;
    }
    while ((out[4 * self->texel + 2] & 0x7c00u) == 0x7c00u) /* no NaN of another kind */
        self->texel++;
    out[4 * self->texel + 2] ^= 4;
    return result;
}

START_TEST(test_faulty)
{
    FaultyLab faulty = {.lab = {run_faulty}};
    run(&faulty.lab, FORMAT_RGBA16F, EQUATION_OVER, 1u << VECTORS_RANDOM, LIMIT);
    ck_assert_uint_eq(blend_unexplained(&report), 1);
    ck_assert_uint_eq(report.candidates[blend_best_whole(&report)].simplest.index, faulty.texel);
    ck_assert_int_eq(report.candidates[blend_best_whole(&report)].simplest.channel, 2);
    blend_report_free(&report);
}
END_TEST

/* What was stored is what counts, and what is counted. */
START_TEST(test_stored_otherwise)
{
    uint64_t changed;
    FaultyLab faulty = {.lab = {run_faulty}, .destination = true};
    BlendDriverDesc desc = {.format = FORMAT_RGBA8,
                            .equation = equation_info(EQUATION_ADD)->equation,
                            .sets = 1u << VECTORS_RANDOM,
                            .limit = LIMIT};
    ck_assert(blend_driver_run(&faulty.lab, &desc, &report, &changed) == RESULT_OK);
    ck_assert_uint_eq(changed, 1);
    ck_assert_uint_le(blend_unexplained(&report), 1);
    blend_report_free(&report);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("blend_gl");
    TCase *whole = tcase_create("whole"), *tcase = tcase_create("driver");
    tcase_set_timeout(whole, 400);
    tcase_set_timeout(tcase, 400);
    tcase_add_checked_fixture(whole, labs_open, labs_close);
    tcase_add_checked_fixture(tcase, labs_open, labs_close);
    tcase_add_test(whole, test_all_triples);
    suite_add_tcase(suite, whole);
    tcase_add_loop_test(tcase, test_every_equation, 0, ARITHMETIC_FORMATS);
    tcase_add_test(tcase, test_faulty);
    tcase_add_test(tcase, test_stored_otherwise);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

/* peel driver's rules on OSMesa: every tested one is exact, and a fault on the rules' side shows
 * in the rules that it concerns. */
#include "labs.h"

#include "gl/gl_renderer.h"
#include "study/driver.h"

static void run_rule(size_t index, Lab *rules, DriverRule *out)
{
    ck_assert_msg(driver_run_rule(index, rules, lab_experiments(driver), gl_render, out) ==
                      RESULT_OK,
                  "%s", result_message());
}

static size_t find_rule(const char *id)
{
    size_t index = 0;
    while (index < driver_rule_count() && strcmp(driver_rule_id(index), id) != 0)
        index++;
    ck_assert_msg(index < driver_rule_count(), "no rule %s", id);
    return index;
}

START_TEST(test_exact)
{
    DriverRule rule;
    run_rule((size_t)_i, &model.lab, &rule);
    if (rule.verdict == DRIVER_UNTESTED) {
        ck_assert_ptr_nonnull(rule.reason);
        return;
    }
    ck_assert_msg(rule.verdict == DRIVER_EXACT, "%s: %llu of %llu differ, first %s: 0x%08x, 0x%08x",
                  rule.id, (unsigned long long)rule.differing, (unsigned long long)rule.samples,
                  rule.example.place, rule.example.expected, rule.example.got);
    ck_assert_uint_gt(rule.samples, 0);
}
END_TEST

/* The other arithmetic mode: interpolation and the polynomials differ, other shader arithmetic
 * does not. */
START_TEST(test_other_mode)
{
    static const char *const concerned[] = {"exp2",    "log2",         "pow",        "depth",
                                            "varying", "varying-flat", "fragment-w", "clip-depth"};
    static const char *const others[] = {"add", "fma", "dot", "matrix", "normalize", "mix"};
    PipelineLab wrong = pipeline_lab(!model.fused);
    for (size_t i = 0; i < sizeof concerned / sizeof *concerned; i++) {
        DriverRule rule;
        run_rule(find_rule(concerned[i]), &wrong.lab, &rule);
        ck_assert_msg(rule.verdict == DRIVER_DIFFERS && rule.has_example, "%s is exact", rule.id);
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        DriverRule rule;
        run_rule(find_rule(others[i]), &wrong.lab, &rule);
        ck_assert_msg(rule.verdict == DRIVER_EXACT, "%s differs", rule.id);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("driver");
    TCase *tcase = tcase_create("rules");
    tcase_set_timeout(tcase, 120);
    tcase_add_checked_fixture(tcase, labs_open, labs_close);
    tcase_add_loop_test(tcase, test_exact, 0, (int)driver_rule_count());
    tcase_add_test(tcase, test_other_mode);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

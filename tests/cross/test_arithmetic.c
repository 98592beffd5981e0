/* The operations of number/op.h against the driver: the same bits in C and on llvmpipe, in both
 * shader stages. */
#include "labs.h"

static void check_stage(Operation operation, bool vertex)
{
    Experiment experiment = {
        .kind = EXPERIMENT_OPERATION, .operation = operation, .vertex = vertex};
    for (int set = 0; set < INPUT_SETS; set++) {
        labs_fill((InputSet)(1 << set), 255.0);
        labs_assert_equal(&experiment, labs_float, operation_info(operation)->glsl, set);
    }
}

START_TEST(test_operation)
{
    check_stage((Operation)_i, false);
    if (_i != OPERATION_PIXEL)
        check_stage((Operation)_i, true);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("arithmetic");
    TCase *tcase = tcase_create("driver");
    tcase_set_timeout(tcase, 120);
    tcase_add_checked_fixture(tcase, labs_open, labs_close);
    tcase_add_loop_test(tcase, test_operation, 0, OPERATION_COUNT);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

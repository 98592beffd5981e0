/* The Pareto front. */
#include "testing.h"

#include "study/pareto.h"

#include <math.h>

static void check_marks(const double *cost, const double *error, const char *expected)
{
    bool marks[8];
    size_t count = strlen(expected);
    pareto_mark(cost, error, count, marks);
    for (size_t i = 0; i < count; i++)
        ck_assert_msg(marks[i] == (expected[i] == '*'), "point %zu: got %s, expected %s", i,
                      marks[i] ? "in front" : "beaten", marks[i] ? "beaten" : "in front");
}

START_TEST(test_front)
{
    check_marks((const double[]){1, 2, 3, 4}, (const double[]){8, 4, 5, 1}, "**.*");
    check_marks((const double[]){3, 1, 2}, (const double[]){3, 1, 2}, ".*.");
    check_marks((const double[]){1, 2, 3}, (const double[]){3, 2, 1}, "***");
}
END_TEST

START_TEST(test_equal_in_one)
{
    check_marks((const double[]){1, 1}, (const double[]){2, 3}, "*.");
    check_marks((const double[]){2, 1}, (const double[]){3, 3}, ".*");
    check_marks((const double[]){1, 1, 2}, (const double[]){2, 2, 2}, "**.");
}
END_TEST

START_TEST(test_not_numbers)
{
    check_marks((const double[]){NAN, 5, 1}, (const double[]){0, 5, NAN}, ".*.");
    check_marks((const double[]){1, 5}, (const double[]){INFINITY, 5}, "**");
    check_marks((const double[]){1}, (const double[]){0}, "*");
    pareto_mark(NULL, NULL, 0, NULL);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("pareto");
    TCase *tcase = tcase_create("pareto");
    tcase_add_test(tcase, test_front);
    tcase_add_test(tcase, test_equal_in_one);
    tcase_add_test(tcase, test_not_numbers);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

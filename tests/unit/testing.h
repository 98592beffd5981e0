/* What the unit tests share: bit-exact assertions and a main() for one suite. */
#ifndef PEEL_TESTS_TESTING_H
#define PEEL_TESTS_TESTING_H

#include <check.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* check's four seconds a test are too few where the machine is busy or the build slow; a suite may
 * set its own. */
__attribute__((constructor)) static void testing_be_patient(void)
{
    setenv("CK_DEFAULT_TIMEOUT", "120", 0);
}

/* How many of so many samples are taken: all, or where the build is slow (PEEL_PATIENCE) a part. */
#ifndef TESTING_SHARE
#define TESTING_SHARE 1
#endif
static inline int testing_samples(int count)
{
    return (count + TESTING_SHARE - 1) / TESTING_SHARE;
}

/* Whether a test takes all of its cases: PEEL_TEST_FULL is set. CI has a part of the longest. */
static inline bool testing_full(void)
{
    return getenv("PEEL_TEST_FULL") != NULL;
}

static inline uint32_t testing_bits(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* Equal bits; prints both in decimal and in hexadecimal float. */
#define ck_assert_float_bits(got, expected)                                                        \
    do {                                                                                           \
        float testing_got = (got), testing_expected = (expected);                                  \
        ck_assert_msg(testing_bits(testing_got) == testing_bits(testing_expected),                 \
                      "%s: got %.9g (%a), expected %.9g (%a)", #got, (double)testing_got,          \
                      (double)testing_got, (double)testing_expected, (double)testing_expected);    \
    } while (0)

/* For tests whose processes run into a limit, of memory, stack or time: what instruments programs
 * has memory of its own, and leaves them out (CK_EXCLUDE_TAGS). */
static inline TCase *testing_limits(void)
{
    TCase *tcase = tcase_create("limits");
    tcase_set_tags(tcase, "limits");
    tcase_set_timeout(tcase, 60);
    return tcase;
}

/* Runs the suite in one process per test and returns the exit code of main. */
static inline int testing_run(Suite *suite)
{
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* The same in this process, for suites that sum over their tests. A test may take half an hour:
 * check counts microseconds in an int. */
static inline int testing_run_here(Suite *suite)
{
    SRunner *runner = srunner_create(suite);
    srunner_set_fork_status(runner, CK_NOFORK);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

#endif

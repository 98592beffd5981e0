/* base/child.h: however a child ends, the parent is told, and its limits hold. */
#include "testing.h"

#include "base/child.h"
#include "base/memory.h"

#include <signal.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

/* ---- records ----------------------------------------------------------------------------------
 */

typedef struct Taken {
    int count;
    size_t bytes;
    uint64_t sum;
} Taken;

static void take_bytes(void *context, const void *record, size_t size)
{
    Taken *taken = context;
    const unsigned char *bytes = record;
    taken->count++;
    taken->bytes += size;
    for (size_t i = 0; i < size; i++)
        taken->sum += bytes[i];
}

enum {
    LARGE = 5000000 /* many times what a pipe holds */
};

static Result put_records(void *context, int pipe)
{
    (void)context;
    unsigned char *large = memory_array(LARGE, 1);
    Result result = large ? RESULT_OK : RESULT_NO_MEMORY;
    for (int i = 0; i < 100 && !result; i++)
        result = child_put(pipe, &(unsigned char){(unsigned char)i}, 1);
    if (!result)
        result = child_put(pipe, NULL, 0);
    if (!result)
        memset(large, 1, LARGE);
    if (!result)
        result = child_put(pipe, large, LARGE);
    free(large);
    return result;
}

START_TEST(test_records)
{
    Taken taken = {0};
    const ChildWork work = {.run = put_records, .take = take_bytes, .take_context = &taken};
    ck_assert_msg(child_run(&work) == RESULT_OK, "%s", result_message());
    ck_assert_int_eq(taken.count, 102);
    ck_assert_uint_eq(taken.bytes, 100 + LARGE);
    ck_assert_uint_eq(taken.sum, 4950 + LARGE);
}
END_TEST

/* ---- endings ----------------------------------------------------------------------------------
 */

static Result end_failed(void *context, int pipe)
{
    (void)context, (void)pipe;
    return result_fail(RESULT_NO_GL, "no more");
}

static Result end_killed(void *context, int pipe)
{
    (void)context, (void)pipe;
    raise(SIGKILL);
    return RESULT_OK;
}

static Result end_aborted(void *context, int pipe)
{
    (void)context, (void)pipe;
    abort();
}

static Result end_exited(void *context, int pipe)
{
    (void)context, (void)pipe;
    exit(3);
}

static Result end_silent(void *context, int pipe)
{
    (void)context;
    close(pipe); /* the parent has nothing to wait for */
    pause();
    return RESULT_OK;
}

static Result end_garbled(void *context, int pipe)
{
    (void)context;
    char garbage[4096];
    memset(garbage, 0x7f, sizeof garbage);
    ck_assert_int_eq(write(pipe, garbage, sizeof garbage), (ssize_t)sizeof garbage);
    return RESULT_OK;
}

static Result end_sleeping(void *context, int pipe)
{
    (void)context, (void)pipe;
    pause();
    return RESULT_OK;
}

static Result end_busy(void *context, int pipe)
{
    (void)context, (void)pipe;
    volatile bool busy = true;
    while (busy)
        continue;
    return RESULT_OK;
}

/* Endless, but for the child that it is. */
static int deeper(volatile int *above)
{
    volatile int frame[256];
    frame[0] = *above + 1;
    return frame[0] ? deeper(frame) + frame[0] : 0;
}

static Result end_deep(void *context, int pipe)
{
    (void)context, (void)pipe;
    volatile int first = 1;
    return deeper(&first) ? RESULT_OK : RESULT_IO;
}

START_TEST(test_endings)
{
    static const struct {
        Result (*run)(void *, int);
        Result expected;
        const char *message;
        double seconds;
    } cases[] = {
        {end_failed, RESULT_NO_GL, "no more", 0.0},
        {end_killed, RESULT_INTERNAL, "the worker ended by signal 9", 0.0},
        {end_aborted, RESULT_INTERNAL, "the worker ended ", 0.0},
        {end_exited, RESULT_INTERNAL, "the worker ended without a result, exit code 3", 0.0},
        {end_silent, RESULT_INTERNAL, "the worker ended by signal 9", 0.0},
        {end_garbled, RESULT_INTERNAL, "the worker ended ", 0.0},
        {end_sleeping, RESULT_BAD_INPUT, "the worker took more than 0.4 s", 0.1},
        {end_busy, RESULT_BAD_INPUT, "the worker took more than ", 1.0},
        {end_deep, RESULT_INTERNAL, "the worker ended ", 0.0}};
#ifdef CHILD_SANITIZED
    if (cases[_i].run == end_deep)
        return; /* the report would be hundreds of lines */
#endif
    const ChildWork work = {
        .run = cases[_i].run, .name = "the worker", .limits.seconds = cases[_i].seconds};
    signal(SIGCHLD, _i % 2 ? SIG_IGN : SIG_DFL); /* as whoever started the program had it */
    ck_assert_int_eq(child_run(&work), cases[_i].expected);
    ck_assert_msg(strstr(result_message(), cases[_i].message), "%s", result_message());
}
END_TEST

/* ---- memory -----------------------------------------------------------------------------------
 */

/* Two limits, one after the other; what may be had under either. */
static Result allocate(void *context, int pipe)
{
    static const size_t limits[] = {(size_t)64 << 20, (size_t)256 << 20};
    (void)context;
    for (int i = 0; i < 2; i++) {
        child_limit(pipe, &(ChildLimits){.memory = limits[i]});
        void *volatile fits = malloc(limits[i] / 2), *volatile too_large = malloc(limits[i]);
        bool right = fits && !too_large; /* volatile: or a compiler leaves the allocations out */
        free(fits);
        free(too_large);
        if (!right)
            return result_fail(RESULT_INTERNAL, "limit of %zu bytes: %s", limits[i],
                               fits ? "more can be had" : "half of it cannot be had");
    }
    return RESULT_OK;
}

START_TEST(test_memory)
{
    const ChildWork work = {.run = allocate, .limits = {.memory = (size_t)16 << 20}};
#ifdef CHILD_SANITIZED
    (void)work; /* no such limit there */
#else
    ck_assert_msg(child_run(&work) == RESULT_OK, "%s", result_message());
#endif
}
END_TEST

/* ---- the parent's end --------------------------------------------------------------------------
 */

static Result say_who(void *context, int pipe)
{
    (void)pipe;
    pid_t self = getpid();
    if (write(*(const int *)context, &self, sizeof self) != sizeof self)
        return RESULT_IO;
    pause();
    return RESULT_OK;
}

START_TEST(test_ends_with_its_parent)
{
    int ends[2];
    pid_t grandchild;
    ck_assert_int_eq(pipe(ends), 0);
    pid_t parent = fork();
    if (parent == 0)
        _exit(child_run(&(ChildWork){.run = say_who, .context = &ends[1]}));
    close(ends[1]);
    ck_assert_int_eq(read(ends[0], &grandchild, sizeof grandchild), sizeof grandchild);
    ck_assert_int_eq(kill(grandchild, 0), 0);
    kill(parent, SIGKILL);
    /* All its ends of the pipe are closed: the grandchild's, too. */
    ck_assert_int_eq(read(ends[0], &grandchild, sizeof grandchild), 0);
    close(ends[0]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("child");
    TCase *tcase = tcase_create("child");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, test_records);
    tcase_add_loop_test(tcase, test_endings, 0, 7);
    tcase_add_test(tcase, test_ends_with_its_parent);
    suite_add_tcase(suite, tcase);
    TCase *limits = testing_limits();
    tcase_add_loop_test(limits, test_endings, 7, 9);
    tcase_add_test(limits, test_memory);
    suite_add_tcase(suite, limits);
    return testing_run(suite);
}

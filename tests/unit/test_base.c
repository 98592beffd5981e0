/* base/: messages, memory, the worker pool, the generator, the clock and the progress line. */
#include "testing.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/pool.h"
#include "base/progress.h"
#include "base/random.h"
#include "base/result.h"
#include "base/text.h"

#include <fcntl.h>
#include <pthread.h>
#include <pty.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

/* ---- result ------------------------------------------------------------------------------------
 */

START_TEST(test_message)
{
    ck_assert_str_eq(result_message(), "");
    ck_assert_int_eq(result_fail(RESULT_IO, "%s: line %d", "a\nb\r\nc", 3), RESULT_IO);
    ck_assert_str_eq(result_message(), "a b  c: line 3");
    result_fail(RESULT_IO, "%s", "a\tb\033[2J\177\xc3\xa9"); /* nothing for a terminal to obey */
    ck_assert_str_eq(result_message(), "a b?[2J?\xc3\xa9");
    result_fail(RESULT_IO, "a b  c: line 3");
    /* The previous message can be part of the next. */
    ck_assert_int_eq(result_fail(RESULT_BAD_INPUT, "scene: %s", result_message()),
                     RESULT_BAD_INPUT);
    ck_assert_str_eq(result_message(), "scene: a b  c: line 3");
    static char huge[5000];
    memset(huge, 'x', sizeof huge - 1);
    result_fail(RESULT_IO, "%s: its end says why", huge);
    ck_assert_uint_eq(strlen(result_message()), 1023);
    ck_assert_ptr_nonnull(strstr(result_message(), "xxx ... xxx"));
    ck_assert_ptr_nonnull(strstr(result_message(), "x: its end says why"));
    for (size_t i = 0; i + 2 < sizeof huge; i += 2)
        memcpy(huge + i, "\xc3\xa9", 2);
    for (int i = 0; i < 2; i++) { /* whole characters, wherever it is cut */
        result_fail(RESULT_IO, "%s%s", i ? "x" : "", huge);
        ck_assert_uint_ge(strlen(result_message()), 1020);
        for (const char *c = result_message() + i; *c && *c != ' '; c += 2)
            ck_assert(c[0] == '\xc3' && c[1] == '\xa9');
        ck_assert_mem_eq(strstr(result_message(), " ... ") + 5, "\xc3\xa9", 2);
    }
    result_fail(RESULT_IO, "%s",
                "a\xc2\x9b"
                "31m\xc2\xa0"); /* U+009B is a terminal's, too */
    ck_assert_str_eq(result_message(), "a??31m\xc2\xa0");
    for (int i = RESULT_OK; i <= RESULT_INTERNAL + 1; i++)
        ck_assert_uint_gt(strlen(result_text((Result)i)), 0);
}
END_TEST

/* ---- text --------------------------------------------------------------------------------------
 */

START_TEST(test_text)
{
    Text text = {0};
    for (int i = 0; i < 100; i++)
        text_print(&text, "%d,", i % 10);
    ck_assert_uint_eq(text.count, 200);
    ck_assert_uint_eq(strlen(text.bytes), 200);
    text_free(&text);
    text_json_string(&text, "a\"b\\c\n\xc3\xa9\xff\xf0\x9f\x98\x80\xe0\x80\x80\xed\xa0\x80");
    ck_assert_str_eq(text.bytes, "\"a\\\"b\\\\c\\u000a\xc3\xa9?\xf0\x9f\x98\x80??????\"");
    text_free(&text);
    text_json_string(&text, "");
    ck_assert_str_eq(text.bytes, "\"\"");
    text_free(&text);
}
END_TEST

static void *other_thread(void *message)
{
    *(bool *)message = result_message()[0] == '\0';
    result_fail(RESULT_IO, "theirs");
    return NULL;
}

START_TEST(test_message_per_thread)
{
    pthread_t thread;
    bool empty = false;
    result_fail(RESULT_IO, "mine");
    ck_assert_int_eq(pthread_create(&thread, NULL, other_thread, &empty), 0);
    pthread_join(thread, NULL);
    ck_assert(empty);
    ck_assert_str_eq(result_message(), "mine");
}
END_TEST

/* What goes to stderr while function runs. */
static const char *captured(void (*function)(void))
{
    static char text[256];
    FILE *file = tmpfile();
    int saved = dup(STDERR_FILENO);
    fflush(stderr);
    dup2(fileno(file), STDERR_FILENO);
    function();
    fflush(stderr);
    dup2(saved, STDERR_FILENO);
    close(saved);
    rewind(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    return text;
}

static void warn(void)
{
    result_warn("%s has 2\nlines", "it");
}

static void warn_enabled(void)
{
    result_warnings_enable(true);
    warn();
    result_warnings_enable(false);
}

static void progress(void)
{
    progress_begin("work", 2);
    progress_step(1);
    progress_end();
}

START_TEST(test_stderr)
{
    ck_assert_str_eq(captured(warn_enabled), "peel: warning: it has 2 lines\n");
    ck_assert_str_eq(captured(warn), "");
    ck_assert_str_eq(captured(progress), ""); /* not a terminal */
}
END_TEST

/* Until a line may be drawn again. */
static void pause_briefly(void)
{
    nanosleep(&(struct timespec){.tv_nsec = 110000000}, NULL);
}

static void progress_of_both_kinds(void)
{
    progress_add(); /* nothing has begun */
    progress_begin("peels", 4);
    pause_briefly();
    progress_add();
    progress_end();
    progress_end();
    progress_context("chain");
    progress_begin("peels", 0);
    pause_briefly();
    progress_step(7);
    progress_end();
}

START_TEST(test_progress_on_a_terminal)
{
    char text[512];
    int terminal, stderr_end, saved = dup(STDERR_FILENO);
    size_t size = 0;
    ck_assert_int_eq(openpty(&terminal, &stderr_end, NULL, NULL, NULL), 0);
    dup2(stderr_end, STDERR_FILENO);
    close(stderr_end);
    progress_of_both_kinds();
    dup2(saved, STDERR_FILENO); /* no one has the terminal now: it ends once it is read */
    close(saved);
    for (ssize_t got = 1; got > 0 && size<sizeof text - 1; size += got> 0 ? (size_t)got : 0)
        got = read(terminal, text + size, sizeof text - 1 - size);
    close(terminal);
    text[size] = '\0';
    ck_assert_str_eq(text, "\r\033[Kpeels   0%\r\033[Kpeels  25%\r\033[K"
                           "\r\033[Kchain: peels\r\033[Kchain: peels, step 7\r\033[K");
}
END_TEST

/* ---- memory ------------------------------------------------------------------------------------
 */

START_TEST(test_memory_array)
{
    int *array = memory_array(100, sizeof *array);
    ck_assert_ptr_nonnull(array);
    for (int i = 0; i < 100; i++)
        ck_assert_int_eq(array[i], 0);
    free(array);
    void *none = memory_array(0, 8);
    ck_assert_ptr_nonnull(none);
    free(none);
    volatile size_t huge = SIZE_MAX / 4; /* times 8 overflows */
    ck_assert_ptr_null(memory_array(huge, 8));
    ck_assert_ptr_nonnull(strstr(result_message(), "out of memory"));
}
END_TEST

START_TEST(test_memory_grow)
{
    uint32_t *array = NULL;
    size_t capacity = 0;
    for (uint32_t i = 0; i < 10000; i++) {
        ck_assert_int_eq(memory_grow((void **)&array, &capacity, i + 1, sizeof *array), RESULT_OK);
        array[i] = i;
    }
    for (uint32_t i = 0; i < 10000; i++)
        ck_assert_uint_eq(array[i], i);
    uint32_t *before = array;
    size_t capacity_before = capacity;
    static const size_t impossible[] = {SIZE_MAX, SIZE_MAX / 2, SIZE_MAX / 4 + 1};
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(memory_grow((void **)&array, &capacity, impossible[i], sizeof *array),
                         RESULT_NO_MEMORY);
        ck_assert_ptr_eq(array, before);
        ck_assert_uint_eq(capacity, capacity_before);
    }
    ck_assert_uint_eq(array[9999], 9999);
    free(array);
}
END_TEST

/* ---- pool --------------------------------------------------------------------------------------
 */

enum {
    TASKS_MAX = 1000
};

typedef struct Work {
    atomic_uint runs[TASKS_MAX];
    atomic_uint wrong_workers;
    int threads;
    uint32_t fail_from; /* tasks from here on fail */
} Work;

static Result work_task(void *context, uint32_t index, int worker)
{
    Work *work = context;
    atomic_fetch_add(&work->runs[index], 1);
    if (worker < 0 || worker >= work->threads)
        atomic_fetch_add(&work->wrong_workers, 1);
    if (index >= work->fail_from)
        return result_fail(RESULT_IO, "task %u", index);
    return RESULT_OK;
}

/* Every task once, for 1 to 8 threads, many runs of one pool, any count. */
START_TEST(test_pool_runs_each_once)
{
    static const uint32_t counts[] = {0, 1, 2, 7, TASKS_MAX};
    Pool *pool = pool_create(_i);
    ck_assert_ptr_nonnull(pool);
    ck_assert_int_eq(pool_threads(pool), _i);
    for (int round = 0; round < 200; round++) {
        static Work work;
        memset(&work, 0, sizeof work);
        work.threads = _i;
        work.fail_from = UINT32_MAX;
        uint32_t count = counts[round % 5];
        ck_assert_int_eq(pool_run(pool, count, work_task, &work), RESULT_OK);
        for (uint32_t i = 0; i < TASKS_MAX; i++)
            if (work.runs[i] != (i < count))
                ck_abort_msg("round %d: task %u of %u ran %u times", round, i, count, work.runs[i]);
        ck_assert_uint_eq(work.wrong_workers, 0);
    }
    pool_destroy(pool);
}
END_TEST

/* The first failing task that ran is reported, with its message; the pool works on. */
START_TEST(test_pool_failure)
{
    Pool *pool = pool_create(_i);
    for (int round = 0; round < 200; round++) {
        static Work work;
        char expected[32];
        memset(&work, 0, sizeof work);
        work.threads = _i;
        work.fail_from = (uint32_t)round * 3;
        snprintf(expected, sizeof expected, "task %u", work.fail_from);
        ck_assert_int_eq(pool_run(pool, TASKS_MAX, work_task, &work), RESULT_IO);
        /* Tasks start in order, so the lowest failing index has always run. */
        ck_assert_str_eq(result_message(), expected);
        if (_i == 1)
            ck_assert_uint_eq(work.runs[work.fail_from + 1], 0);
        ck_assert_uint_eq(work.runs[TASKS_MAX - 1], 0);
        work.fail_from = UINT32_MAX;
        ck_assert_int_eq(pool_run(pool, 10, work_task, &work), RESULT_OK);
    }
    pool_destroy(pool);
}
END_TEST

/* Task 1 fails first, task 0 after it: the message is that of the lower index all the same. */
static Result late_task(void *context, uint32_t index, int worker)
{
    atomic_bool *failed = context;
    (void)worker;
    while (index == 0 && !atomic_load(failed))
        sched_yield();
    if (index == 0)
        usleep(1000); /* task 1 is about to be recorded */
    Result result = result_fail(index ? RESULT_BAD_INPUT : RESULT_IO, "task %u", index);
    atomic_store(failed, true);
    return result;
}

START_TEST(test_pool_lowest_failure)
{
    Pool *pool = pool_create(2);
    for (int round = 0; round < 20; round++) {
        atomic_bool failed = false;
        ck_assert_int_eq(pool_run(pool, 2, late_task, &failed), RESULT_IO);
        ck_assert_str_eq(result_message(), "task 0");
    }
    pool_destroy(pool);
}
END_TEST

START_TEST(test_pool_default)
{
    Pool *pool = pool_create(0);
    ck_assert_int_eq(pool_threads(pool), (int)sysconf(_SC_NPROCESSORS_ONLN));
    pool_destroy(pool);
    pool_destroy(NULL);
}
END_TEST

/* ---- random and clock --------------------------------------------------------------------------
 */

START_TEST(test_random)
{
    /* SplitMix64 from seed 1234567, as published with Vigna's implementation. */
    static const uint64_t expected[] = {6457827717110365317u, 3203168211198807973u,
                                        9817491932198370423u, 4593380528125082431u,
                                        16408922859458223821u};
    Random random = random_seed(1234567);
    for (int i = 0; i < 5; i++)
        ck_assert_uint_eq(random_bits(&random), expected[i]);
    for (int i = 0; i < 100000; i++) {
        double unit = random_unit(&random), ranged = random_range(&random, -2, 3);
        if (!(unit >= 0 && unit < 1 && ranged >= -2 && ranged < 3))
            ck_abort_msg("out of range: %.17g, %.17g", unit, ranged);
    }
}
END_TEST

START_TEST(test_clock)
{
    Clock start = clock_now();
    double wall_ms, cpu_ms;
    clock_elapsed(&start, &wall_ms, &cpu_ms);
    ck_assert_double_ge(wall_ms, 0.0);
    ck_assert_double_ge(cpu_ms, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("base");
    TCase *tcase = tcase_create("base");
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_message);
    tcase_add_test(tcase, test_text);
    tcase_add_test(tcase, test_message_per_thread);
    tcase_add_test(tcase, test_stderr);
    tcase_add_test(tcase, test_progress_on_a_terminal);
    tcase_add_test(tcase, test_memory_array);
    tcase_add_test(tcase, test_memory_grow);
    tcase_add_loop_test(tcase, test_pool_runs_each_once, 1, 9);
    tcase_add_loop_test(tcase, test_pool_failure, 1, 9);
    tcase_add_test(tcase, test_pool_lowest_failure);
    tcase_add_test(tcase, test_pool_default);
    tcase_add_test(tcase, test_random);
    tcase_add_test(tcase, test_clock);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

/* peel.h without memory: every allocation fails in turn, and the call says so, leaks nothing and
 * leaves its outputs alone. */
#include "library_scenes.h"

#include <stdatomic.h>

/* The allocation that fails, counted from 1; 0: none. */
static atomic_long fails_at, counted;

static bool fails(void)
{
    long at = atomic_fetch_add(&counted, 1) + 1;
    return at == atomic_load(&fails_at);
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
char *__real_strdup(const char *text);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);
char *__wrap_strdup(const char *text);

void *__wrap_malloc(size_t size)
{
    return fails() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return fails() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *memory, size_t size)
{
    return fails() ? NULL : __real_realloc(memory, size);
}

char *__wrap_strdup(const char *text)
{
    return fails() ? NULL : __real_strdup(text);
}

enum {
    SIDE = 16,
    VALUES = SIDE * SIDE * 4
};

typedef struct Outputs {
    float linear[VALUES], bound[VALUES], accum[VALUES];
    PeelDifference difference;
} Outputs;

static int ignore(void *context, const PeelBuffer *buffer)
{
    (void)context;
    (void)buffer;
    return 0;
}

/* A scene, both renderers, and a comparison of them; the first failure is returned. */
static PeelResult work(const char *method, Outputs *out)
{
    const PeelSettings ref = {.width = SIDE, .height = SIDE, .method = method, .threads = 1};
    const PeelTrace trace = {ignore, NULL};
    PeelSettings truth = ref;
    truth.renderer = PEEL_TRUTH;
    Small small;
    small_scene(&small);
    small.desc.camera_count = 0;
    PeelScene *scene = NULL;
    PeelResult result = peel_scene_create(&small.desc, &scene);
    if (!result)
        result = peel_scene_render(scene, &ref, NULL, &(PeelImages){.linear = out->linear}, NULL);
    if (!result)
        result = peel_scene_render(scene, &ref, &trace, &(PeelImages){.accum = out->accum}, NULL);
    if (!result)
        result = peel_scene_render(scene, &truth, NULL, &(PeelImages){.bound = out->bound}, NULL);
    if (!result)
        result = peel_compare(PEEL_RGBA32F, SIDE, SIDE, out->linear, out->accum, &out->difference);
    peel_scene_free(scene);
    return result;
}

START_TEST(test_memory)
{
    static const char *const methods[] = {"peel", "linked-list"};
    static Outputs outputs;
    for (int m = 0; m < 2; m++) {
        atomic_store(&fails_at, 0);
        atomic_store(&counted, 0);
        PeelResult good = work(methods[m], &outputs);
        long count = atomic_load(&counted); /* before check allocates */
        ck_assert_int_eq(good, PEEL_OK);
        ck_assert_int_gt(count, 100);
        for (long i = 1; i <= count; i++) {
            memset(&outputs, 0, sizeof outputs);
            atomic_store(&counted, 0);
            atomic_store(&fails_at, i);
            PeelResult result = work(methods[m], &outputs);
            atomic_store(&fails_at, 0);
            ck_assert_msg(result == PEEL_NO_MEMORY, "allocation %ld of %ld: %s: %s", i, count,
                          peel_result_text(result), peel_message());
            ck_assert_str_ne(peel_message(), "");
            ck_assert_double_eq(outputs.difference.rms, 0.0);
        }
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("library memory");
    TCase *tcase = tcase_create("library memory");
    tcase_set_timeout(tcase, 120);
    tcase_add_test(tcase, test_memory);
    suite_add_tcase(suite, tcase);
    return testing_run_here(suite);
}

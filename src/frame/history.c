#include "frame/history.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

void history_free(History *history)
{
    free(history->fragments);
    free(history->tests);
    free(history->terms);
    free(history->steps);
    *history = (History){0};
}

const char *history_fate_name(HistoryFate fate)
{
    static const char *const names[HISTORY_FATES] = {
        [HISTORY_PEELED] = "peeled",
        [HISTORY_BLENDED] = "blended",
        [HISTORY_SEEN] = "seen",
        [HISTORY_HIDDEN] = "hidden",
        [HISTORY_TIE] = "tie",
        [HISTORY_SKIPPED] = "skipped",
        [HISTORY_PASS_LIMIT] = "pass_limit",
        [HISTORY_OVERFLOW] = "overflow",
        [HISTORY_INVISIBLE] = "invisible",
        [HISTORY_MASKED] = "masked",
        [HISTORY_FILL_RULE] = "fill_rule",
        [HISTORY_CULLED] = "culled",
        [HISTORY_CLIPPED] = "clipped",
    };
    return names[fate];
}

const char *history_test_name(HistoryTest test)
{
    static const char *const names[HISTORY_TESTS] = {
        [HISTORY_KEPT] = "kept",
        [HISTORY_OPAQUE_DEPTH] = "opaque depth",
        [HISTORY_PREVIOUS_DEPTH] = "previous depth",
        [HISTORY_BETWEEN] = "between",
        [HISTORY_DEPTH_TEST] = "depth test",
        [HISTORY_ALPHA_TEST] = "alpha test",
    };
    return names[test];
}

/* Room for count more of an array's items, zeroed and counted. */
static void *add(void *array_at, size_t *count, size_t *room, size_t more, size_t size)
{
    void **array = array_at;
    if (memory_grow(array, room, *count + more, size) != RESULT_OK)
        return NULL;
    void *first = (char *)*array + *count * size;
    memset(first, 0, more * size);
    *count += more;
    return first;
}

HistoryFragment *history_add_fragment(History *history)
{
    HistoryFragment *fragment = add(&history->fragments, &history->fragment_count,
                                    &history->fragment_room, 1, sizeof *history->fragments);
    if (fragment)
        fragment->peel = HISTORY_NONE;
    return fragment;
}

HistoryStep *history_add_step(History *history)
{
    return add(&history->steps, &history->step_count, &history->step_room, 1,
               sizeof *history->steps);
}

HistoryTerm *history_add_terms(History *history, size_t count)
{
    return add(&history->terms, &history->term_count, &history->term_room, count,
               sizeof *history->terms);
}

Result history_put_test(History *history, size_t fragment, int pass, HistoryTest test)
{
    size_t count = history->fragment_count, at = (size_t)pass * count + fragment;
    if (at >= history->test_count &&
        !add(&history->tests, &history->test_count, &history->test_room,
             ((size_t)pass + 1) * count - history->test_count, 1))
        return RESULT_NO_MEMORY;
    history->tests[at] = (uint8_t)test;
    if (history->fragments[fragment].passes <= pass)
        history->fragments[fragment].passes = pass + 1;
    return RESULT_OK;
}

HistoryTest history_test(const History *history, size_t fragment, int pass)
{
    return (HistoryTest)history->tests[(size_t)pass * history->fragment_count + fragment];
}

void history_values(PixelFormat format, const void *pixel, double out[4])
{
    for (int i = 0; i < 4; i++)
        out[i] = i < format_info(format)->channels ? (double)format_channel(format, pixel, i) : 0.0;
}

size_t history_count(const History *history, HistoryFate fate)
{
    size_t count = 0;
    for (size_t i = 0; i < history->fragment_count; i++)
        count += history->fragments[i].fate == fate;
    return count;
}

void history_summary(const History *history, Text *out)
{
    static const struct {
        HistoryFate fate;
        const char *text;
    } rows[] = {
        {HISTORY_HIDDEN, "hidden"},
        {HISTORY_TIE, "lost to a tie"},
        {HISTORY_SKIPPED, "skipped"},
        {HISTORY_PASS_LIMIT, "lost to the pass limit"},
        {HISTORY_OVERFLOW, "lost to an overflow"},
        {HISTORY_INVISIBLE, "invisible"},
        {HISTORY_MASKED, "masked"},
        {HISTORY_FILL_RULE, "left to a neighbour by the fill rule"},
        {HISTORY_CULLED, "culled"},
        {HISTORY_CLIPPED, "clipped"},
    };
    size_t layers =
        history_count(history, HISTORY_PEELED) + history_count(history, HISTORY_BLENDED);
    text_print(out, "%zu layer%s", layers, layers == 1 ? "" : "s");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        size_t count = history_count(history, rows[i].fate);
        if (count > 0)
            text_print(out, ", %zu %s", count, rows[i].text);
    }
    if (history_count(history, HISTORY_SEEN) > 0)
        text_print(out, ", an opaque surface");
}

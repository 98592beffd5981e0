/* The history of single pixels against the whole frame: its trace, images and counts; and the
 * history against itself: blend steps replayed, shading terms summed. */
#include "testing.h"

#include "random_desc.h"

#include "base/memory.h"
#include "frame/method.h"
#include "frame/shading.h"
#include "number/op.h"
#include "ref/pipeline/pipeline.h"
#include "ref/pipeline/retrace.h"
#include "scene/generate.h"
#include "step_blend.h"

#include <stdio.h>

enum {
    TRACED = 40 /* pixels of a frame whose trace is kept */
};

static uint64_t running; /* the case's seed, for messages */

static void ok(Result result)
{
    ck_assert_msg(result == RESULT_OK, "seed %llu: %s", (unsigned long long)running,
                  result_message());
}

static void check_bytes(const PixelValue *traced, const double values[4], const char *what,
                        const History *history)
{
    double expected[4];
    history_values(traced->format, traced->bytes, expected);
    for (int i = 0; i < format_info(traced->format)->channels; i++)
        ck_assert_msg(values[i] == expected[i] ||
                          (values[i] != values[i] && expected[i] != expected[i]),
                      "seed %llu, %s, pixel %d,%d: %s, channel %d: got %a, expected %a",
                      (unsigned long long)running, method_info(history->method)->name, history->x,
                      history->y, what, i, values[i], expected[i]);
}

/* ---- the history against the trace ---- */

static const HistoryFragment *peeled_at(const History *history, int peel)
{
    const HistoryFragment *found = NULL;
    for (size_t i = 0; i < history->fragment_count; i++) {
        const HistoryFragment *fragment = &history->fragments[i];
        if (fragment->fate != HISTORY_PEELED || fragment->peel != peel || fragment->back)
            continue;
        ck_assert_msg(!found, "seed %llu: two fragments of peel %d", (unsigned long long)running,
                      peel);
        found = fragment;
    }
    return found;
}

static bool repeats(const History *history, uint32_t primitive, int peel)
{
    for (size_t i = 0; i < history->fragment_count; i++)
        if (history->fragments[i].primitive == primitive &&
            history->fragments[i].fate == HISTORY_PEELED && history->fragments[i].peel < peel)
            return true;
    return false;
}

static void check_layer(const History *history, const PixelTrace *trace, int peel)
{
    uint32_t id =
        pixel_trace_bits(pixel_trace_numbered(trace, "peel", peel, "primitive"), UINT32_MAX);
    const PixelValue *depth = pixel_trace_numbered(trace, "peel", peel, "depth");
    const HistoryFragment *fragment = peeled_at(history, peel);
    if (!fragment) {
        ck_assert_msg(id == UINT32_MAX || repeats(history, id, peel),
                      "seed %llu, pixel %d,%d: no fragment of peel %d", (unsigned long long)running,
                      history->x, history->y, peel);
        return;
    }
    ck_assert_msg(fragment->primitive == id,
                  "seed %llu, pixel %d,%d, peel %d: primitive %u, "
                  "expected %u",
                  (unsigned long long)running, history->x, history->y, peel, fragment->primitive,
                  id);
    if (depth)
        ck_assert_uint_eq(fragment->code, pixel_trace_bits(depth, 0));
    int number = history->method == METHOD_LINKED_LIST ? 0 : peel;
    ck_assert_int_eq(history_test(history, (size_t)(fragment - history->fragments), number),
                     HISTORY_KEPT);
}

static void check_steps(const History *history, const PixelTrace *trace)
{
    for (size_t i = 0; i < history->step_count; i++) {
        const HistoryStep *step = &history->steps[i];
        int peel;
        if (strcmp(step->target, "accum") == 0 && sscanf(step->step, "peel.%d", &peel) == 1)
            check_bytes(pixel_trace_numbered(trace, "peel", peel, "accum"), step->after, step->step,
                        history);
        if (strcmp(step->target, "back") == 0 && sscanf(step->step, "peel.%d", &peel) == 1)
            check_bytes(
                pixel_trace_numbered(trace, method_info(history->method)->name, peel, "back_accum"),
                step->after, step->step, history);
    }
}

static void check_trace(const History *history, const PixelTrace *trace)
{
    check_bytes(pixel_trace_find(trace, "accum"), history->accum, "accum", history);
    int fronts = 0;
    for (int k = 0; pixel_trace_numbered(trace, "peel", k, "accum") ||
                    pixel_trace_numbered(trace, "forward-dual", k, "front");
         k++)
        fronts = k + 1;
    for (int k = 0; k < fronts; k++)
        check_layer(history, trace, k);
    check_steps(history, trace);
    uint32_t opaque = pixel_trace_bits(pixel_trace_find(trace, "opaque.primitive"), UINT32_MAX);
    ck_assert_int_eq(history_count(history, HISTORY_SEEN), opaque != UINT32_MAX);
    for (size_t i = 0; i < history->fragment_count; i++)
        if (history->fragments[i].fate == HISTORY_SEEN)
            ck_assert_uint_eq(history->fragments[i].primitive, opaque);
}

/* ---- the history against itself ---- */

static PixelFormat find_format(const char *name)
{
    PixelFormat format = FORMAT_NONE;
    format_find(name, &format);
    return format;
}

static void replay_step(const HistoryStep *step, PixelFormat format, void *pixel)
{
    float source[4];
    for (int i = 0; i < 4; i++)
        source[i] = (float)step->source[i];
    ck_assert_msg(step_blend(step->equation, format, source, pixel), "no equation %s",
                  step->equation);
}

/* Every target's steps, from its clear value to what the next step finds; the last one of the
 * accumulation gives the stored one. */
static void check_replay(const History *history)
{
    static const char *const targets[] = {"accum", "back", "sum", "count", "product"};
    for (size_t t = 0; t < sizeof targets / sizeof *targets; t++) {
        _Alignas(8) unsigned char pixel[16] = {0};
        PixelValue value;
        bool begun = false;
        for (size_t i = 0; i < history->step_count; i++) {
            const HistoryStep *step = &history->steps[i];
            if (strcmp(step->target, targets[t]) != 0)
                continue;
            value.format = find_format(step->format);
            if (!begun)
                step_clear(step->target, value.format, pixel);
            begun = true;
            memcpy(value.bytes, pixel, sizeof pixel);
            check_bytes(&value, step->before, "before", history);
            replay_step(step, value.format, pixel);
            memcpy(value.bytes, pixel, sizeof pixel);
            check_bytes(&value, step->after, "after", history);
        }
        if (begun && t == 0)
            check_bytes(&value, history->accum, "last step", history);
    }
}

/* The terms' sum, the ambient term and alpha give the bits of the lit, premultiplied colour. */
static void check_terms(const History *history, const RenderDesc *desc, size_t *checked)
{
    for (size_t i = 0; i < history->fragment_count; i++) {
        const HistorySurface *surface = &history->fragments[i].surface;
        if (!surface->lit || desc->shading == SHADING_PHONG)
            continue;
        for (int k = 0; k < 3; k++) {
            float sum = 0.0f;
            for (size_t light = 0; light < surface->term_count; light++) {
                const HistoryTerm *term = &history->terms[surface->first_term + light];
                sum = op_add(sum, (float)term->term[k]);
                ck_assert_float_bits((float)term->sum[k], sum);
            }
            sum = op_mul(op_add(sum, (float)surface->ambient[k]), (float)surface->base[3]);
            if (desc->method == METHOD_FORWARD_DUAL && format_info(desc->accum)->kind == KIND_UNORM)
                continue; /* the source is clamped to [0, 1] */
            ck_assert_float_bits((float)surface->source[k], sum);
        }
        *checked += surface->term_count > 0;
    }
}

/* ---- whole frames ---- */

typedef struct Totals {
    uint64_t fates[HISTORY_FATES], terms;
} Totals;

static void check_counts(const Frame *frame, const Totals *totals)
{
    const uint64_t *fates = totals->fates;
    const LayerStats *layers = &frame->layers;
    if (layers->lost_to_overflow > 0)
        return;
    uint64_t lost = fates[HISTORY_TIE] + fates[HISTORY_SKIPPED];
    /* Frames count a layer at the previous one's stored depth as repeated, and another fragment
     * that the raw test let be that layer as lost. */
    bool same = layers->repeated > 0 ? layers->lost_to_ties >= lost : layers->lost_to_ties == lost;
    ck_assert_msg(same, "seed %llu: %llu lost to ties, expected %llu", (unsigned long long)running,
                  (unsigned long long)lost, (unsigned long long)layers->lost_to_ties);
    ck_assert_msg(layers->lost_to_pass_limit == fates[HISTORY_PASS_LIMIT],
                  "seed %llu: %llu lost to the pass limit, expected %llu",
                  (unsigned long long)running, (unsigned long long)fates[HISTORY_PASS_LIMIT],
                  (unsigned long long)layers->lost_to_pass_limit);
    uint64_t kept = fates[HISTORY_PEELED] + fates[HISTORY_BLENDED] + fates[HISTORY_INVISIBLE];
    ck_assert_uint_eq(layers->fragments, kept + lost + fates[HISTORY_PASS_LIMIT]);
}

static void check_pixel(Retrace *retrace, const RenderDesc *desc, const Frame *frame, int x, int y,
                        const PixelTrace *trace, Totals *totals)
{
    History history;
    ok(retrace_pixel(retrace, x, y, &history));
    const float *final = image_pixel(&frame->final, x, y);
    for (int i = 0; i < 4; i++)
        ck_assert_msg(testing_bits((float)history.final[i]) == testing_bits(final[i]),
                      "seed %llu, %s, pixel %d,%d: final %a, expected %a",
                      (unsigned long long)running, method_info(desc->method)->name, x, y,
                      history.final[i], (double) final[i]);
    ck_assert_int_eq(memcmp(history.display, image_pixel(&frame->display, x, y), 4), 0);
    if (trace)
        check_trace(&history, trace);
    check_replay(&history);
    check_terms(&history, desc, &totals->terms);
    /* Hidden opaque ones are not counted by frames. */
    for (size_t i = 0; i < history.fragment_count; i++)
        totals->fates[history.fragments[i].fate] +=
            history.fragments[i].transparent || history.fragments[i].fate != HISTORY_TIE;
    history_free(&history);
}

static void check_frame(const Scene *scene, const RenderDesc *desc, uint64_t seed, bool whole,
                        Totals *sum)
{
    Random random = random_seed(seed);
    PixelTrace traces[TRACED];
    PixelFan fan = pixel_fan_of(traces, TRACED);
    Totals totals = {0};
    Frame frame;
    Retrace *retrace;
    for (int i = 0; i < TRACED; i++)
        traces[i] = pixel_trace_of((int)(random_bits(&random) % (uint64_t)desc->width),
                                   (int)(random_bits(&random) % (uint64_t)desc->height));
    ok(pipeline_render(scene, desc, &fan.sink, &frame));
    ok(retrace_open(scene, desc, &retrace));
    uint32_t saved = op_enter();
    for (int i = 0; i < TRACED; i++)
        check_pixel(retrace, desc, &frame, traces[i].x, traces[i].y, &traces[i], &totals);
    if (whole) {
        totals = (Totals){.terms = totals.terms};
        for (int y = 0; y < desc->height; y++)
            for (int x = 0; x < desc->width; x++)
                check_pixel(retrace, desc, &frame, x, y, NULL, &totals);
        check_counts(&frame, &totals);
    }
    op_leave(saved);
    for (int i = 0; i < HISTORY_FATES; i++)
        sum->fates[i] += totals.fates[i];
    sum->terms += totals.terms;
    for (int i = 0; i < TRACED; i++)
        pixel_trace_free(&traces[i]);
    retrace_close(retrace);
    frame_free(&frame);
}

static void check_soup(uint64_t seed, Totals *sum)
{
    static Soup soup;
    Random random = random_seed(running = seed);
    SoupKind kind = (SoupKind)(seed % SOUP_KINDS);
    RenderDesc desc = random_desc_settings(&random);
    desc.method = (MethodId)(seed % METHOD_COUNT);
    desc.width = 16;
    desc.height = soup_kind_is_exact(kind) ? 16 : 11;
    desc.unfused = seed % 5 == 0;
    desc.threads = 1 + (int)(seed % 2);
    soup_make_kind(&random, kind, desc.width, desc.height, &soup);
    ok(scene_validate(&soup.scene));
    check_frame(&soup.scene, &desc, seed, true, sum);
}

START_TEST(test_soups)
{
    static const HistoryFate shown[] = {HISTORY_PEELED,     HISTORY_BLENDED,  HISTORY_SEEN,
                                        HISTORY_HIDDEN,     HISTORY_TIE,      HISTORY_SKIPPED,
                                        HISTORY_PASS_LIMIT, HISTORY_OVERFLOW, HISTORY_MASKED,
                                        HISTORY_CULLED,     HISTORY_CLIPPED,  HISTORY_FILL_RULE};
    const char *only = getenv("PEEL_TEST_SEED");
    Totals sum = {0};
    result_warnings_enable(false);
    if (only) {
        check_soup(strtoull(only, NULL, 0), &sum);
        return;
    }
    for (uint64_t seed = 1; seed <= 200; seed++)
        check_soup(seed, &sum);
    for (size_t i = 0; i < sizeof shown / sizeof *shown; i++)
        ck_assert_msg(sum.fates[shown[i]] > 0, "no soup showed %s", history_fate_name(shown[i]));
    ck_assert_uint_gt(sum.terms, 1000);
}
END_TEST

/* ---- built-in scenes ---- */

START_TEST(test_scenes)
{
    static const char *const names[] = {"tutorial", "crossing_planes", "lamps"};
    Scene scene;
    Totals sum = {0};
    ok(generate_find(names[_i])->generate(&scene));
    for (int method = 0; method < METHOD_COUNT; method++)
        for (int seed = 0; seed < 2; seed++) {
            RenderDesc desc = {.width = 160, .height = 90, .method = (MethodId)method};
            running = (uint64_t)method;
            if (seed)
                render_desc_seed_profile(&desc);
            check_frame(&scene, &desc, (uint64_t)method + 1, false, &sum);
        }
    ck_assert_uint_gt(sum.fates[HISTORY_PEELED], 0);
    scene_free(&scene);
}
END_TEST

START_TEST(test_outside)
{
    static const int pixels[][2] = {{-1, 0}, {0, -1}, {8, 0}, {0, 4}};
    Scene scene;
    History history;
    Retrace *retrace;
    RenderDesc desc = {.width = 8, .height = 4};
    ok(generate_find("tutorial")->generate(&scene));
    ok(retrace_open(&scene, &desc, &retrace));
    for (int i = 0; i < 4; i++) {
        ck_assert_int_eq(retrace_pixel(retrace, pixels[i][0], pixels[i][1], &history),
                         RESULT_BAD_INPUT);
        history_free(&history);
    }
    retrace_close(retrace);
    desc.mutations = 1;
    ck_assert_int_eq(retrace_open(&scene, &desc, &retrace), RESULT_UNSUPPORTED);
    scene_free(&scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("history");
    TCase *tcase = tcase_create("ref");
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_soups);
    tcase_add_loop_test(tcase, test_scenes, 0, 3);
    tcase_add_test(tcase, test_outside);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

#include "study/plan.h"

#include "base/memory.h"
#include "base/progress.h"
#include "compare/metrics.h"
#include "frame/method.h"
#include "study/bench_stats.h"
#include "study/pareto.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    RUNS = 3
};
/* Settings that were this much slower than the fastest in the first run are not measured again. */
#define SLOWER 1.5

typedef struct Timed {
    double cpu_ms[RUNS], wall_ms[RUNS];
} Timed;

typedef struct Search {
    const Scene *scene;
    const Plan *plan;
    const PlanSpace *space;
    Renderer ref;
    Image truth;
    Timed *times; /* beside out->choices */
    size_t capacity;
    PlanSearch *out;
} Search;

static const PixelFormat accums[PLAN_ACCUMS] = {FORMAT_RGBA32F, FORMAT_RGBA16F, FORMAT_RGBA16,
                                                FORMAT_RGBA8};

const char *plan_metric_name(PlanMetric metric)
{
    static const char *const names[PLAN_METRICS] = {"max", "rmse", "p99"};
    return names[metric];
}

RenderDesc plan_choice_desc(const RenderDesc *desc, const PlanChoice *choice)
{
    RenderDesc out = *desc;
    out.method = choice->method;
    out.passes = choice->passes;
    out.accum = choice->accum;
    out.gbuffer = choice->gbuffer;
    return out;
}

/* ---- measuring ---- */

static Result error_of(const Search *search, const Image *image, double *out)
{
    FinalMetrics metrics;
    if (search->out->metric == PLAN_P99)
        return metrics_p99(image, &search->truth, out);
    metrics_final(image, &search->truth, &metrics);
    *out = metrics.nonfinite > 0              ? (double)INFINITY
           : search->out->metric == PLAN_RMSE ? metrics.rmse
                                              : metrics.max_abs;
    return RESULT_OK;
}

/* One more run of choices[index]. */
static Result run(Search *search, size_t index)
{
    PlanChoice *choice = &search->out->choices[index];
    RenderDesc desc = plan_choice_desc(&search->plan->desc, choice);
    char context[64];
    Frame frame;
    snprintf(context, sizeof context, "choice %zu, %s", index + 1,
             method_info(choice->method)->name);
    progress_context(context);
    progress_begin("ref", 0);
    Result result = search->ref(search->scene, &desc, NULL, &frame);
    progress_end();
    progress_context(NULL);
    if (result != RESULT_OK)
        return result;
    Timed *times = &search->times[index];
    times->cpu_ms[choice->runs] = frame.cpu_ms;
    times->wall_ms[choice->runs++] = frame.time_ms;
    if (choice->runs == 1)
        result = error_of(search, &frame.final, &choice->error);
    frame_free(&frame);
    return result;
}

static Result grow(Search *search)
{
    size_t capacity = search->capacity ? 2 * search->capacity : 64;
    PlanChoice *choices = realloc(search->out->choices, capacity * sizeof *choices);
    if (choices)
        search->out->choices = choices;
    Timed *times = realloc(search->times, capacity * sizeof *times);
    if (times)
        search->times = times;
    if (!choices || !times)
        return result_fail(RESULT_NO_MEMORY, "plan: out of memory");
    search->capacity = capacity;
    return RESULT_OK;
}

/* A first run. *error: infinite of settings that need more memory than there may be, which are no
 * choice. */
static Result try(Search *search, PlanChoice choice, double *error)
{
    PlanSearch *out = search->out;
    Result result = out->count < search->capacity ? RESULT_OK : grow(search);
    if (result != RESULT_OK)
        return result;
    out->choices[out->count] = choice;
    result = run(search, out->count);
    *error = (double)INFINITY;
    if (result == RESULT_NO_MEMORY || result == RESULT_UNSUPPORTED)
        return RESULT_OK;
    if (result == RESULT_OK)
        *error = out->choices[out->count++].error;
    return result;
}

/* ---- the settings ---- */

/* Peels that take all layers; 0 of a method that does not peel. */
static int peels_of(const LayerCount *most, MethodId method)
{
    switch (method) {
    case METHOD_PEEL:
    case METHOD_FORWARD:
        return (int)most->peels;
    case METHOD_PEEL_ID:
        return (int)most->ids;
    case METHOD_DUAL:
    case METHOD_FORWARD_DUAL:
        return ((int)most->depths + 1) / 2;
    default:
        return 0;
    }
}

/* Whether another G-buffer would change anything: not linked-list's, which is compact, nor one that
 * only opaque surfaces go through where there are none. Forward peeling has two. */
static bool has_gbuffer(const Search *search, MethodId method, GBufferFormat gbuffer)
{
    bool opaque = needs_has(&search->plan->needs, NEED_OPAQUE);
    switch (method) {
    case METHOD_PEEL:
    case METHOD_PEEL_ID:
    case METHOD_DUAL:
        return true;
    case METHOD_FORWARD:
        return gbuffer != GBUFFER_COMPACT;
    case METHOD_LINKED_LIST:
        return false;
    default:
        return opaque;
    }
}

/* Fewer passes than all, doubling until the error is reached: more only cost more. */
static Result try_passes(Search *search, PlanChoice choice)
{
    int all = peels_of(&search->plan->layers.most, choice.method);
    double error = (double)INFINITY;
    Result result = RESULT_OK;
    for (int passes = 1; passes < all && passes <= PASSES_MAX && result == RESULT_OK &&
                         !(error <= search->out->max_error);
         passes *= 2) {
        choice.passes = passes;
        result = try(search, choice, &error);
    }
    return result;
}

/* *first: nothing was tried yet. Its error, the least that the method's settings are expected to
 * have, decides whether the others are. */
static Result try_method(Search *search, MethodId method)
{
    const PlanSpace *space = search->space;
    bool first = true, any_gbuffer = false;
    for (int g = 0; g < PLAN_GBUFFERS; g++) {
        if (!space->gbuffers[g] || (any_gbuffer && !has_gbuffer(search, method, (GBufferFormat)g)))
            continue;
        any_gbuffer = true;
        for (int a = 0; a < PLAN_ACCUMS; a++) {
            if (!space->accums[a])
                continue;
            PlanChoice choice = {method,    space->passes > 0 ? space->passes : 0,
                                 accums[a], (GBufferFormat)g,
                                 0,         0,
                                 0,         0,
                                 false,     false};
            double error = (double)INFINITY;
            Result result = try(search, choice, &error);
            bool reached = error <= search->out->max_error;
            if (result == RESULT_OK && reached && space->passes < 0)
                result = try_passes(search, choice);
            if (result != RESULT_OK || (first && !reached))
                return result;
            first = false;
        }
    }
    return RESULT_OK;
}

/* ---- the answer ---- */

static void take_medians(const Search *search)
{
    for (size_t i = 0; i < search->out->count; i++) {
        PlanChoice *choice = &search->out->choices[i];
        double spread;
        choice->cpu_ms = bench_median(search->times[i].cpu_ms, choice->runs, &spread);
        choice->wall_ms = bench_median(search->times[i].wall_ms, choice->runs, &spread);
    }
}

static bool reaches(const PlanSearch *search, const PlanChoice *choice)
{
    return choice->error <= search->max_error;
}

/* The cheapest that reaches the error, or −1; at one cost, the better. */
static int cheapest(const PlanSearch *search)
{
    int found = -1;
    for (size_t i = 0; i < search->count; i++) {
        const PlanChoice *choice = &search->choices[i],
                         *best = &search->choices[found < 0 ? 0 : found];
        if (reaches(search, choice) &&
            (found < 0 || choice->cpu_ms < best->cpu_ms ||
             (choice->cpu_ms == best->cpu_ms && choice->error < best->error)))
            found = (int)i;
    }
    return found;
}

/* The rest of the runs, in turns, of what the first run leaves in question. */
static Result repeat(Search *search)
{
    PlanSearch *out = search->out;
    take_medians(search);
    int first = cheapest(out);
    double most = first < 0 ? 0.0 : SLOWER * out->choices[first].cpu_ms;
    Result result = RESULT_OK;
    for (int round = 1; round < RUNS; round++)
        for (size_t i = 0; i < out->count && result == RESULT_OK; i++)
            if (out->choices[i].pareto ||
                (reaches(out, &out->choices[i]) && out->choices[i].cpu_ms <= most))
                result = run(search, i);
    return result;
}

static Result mark_front(PlanSearch *search)
{
    double *cost = memory_array(2 * search->count, sizeof *cost);
    bool *marks = memory_array(search->count, sizeof *marks);
    if (cost && marks) {
        for (size_t i = 0; i < search->count; i++) {
            cost[i] = search->choices[i].cpu_ms;
            cost[search->count + i] = search->choices[i].error;
        }
        pareto_mark(cost, cost + search->count, search->count, marks);
        for (size_t i = 0; i < search->count; i++)
            search->choices[i].pareto = marks[i];
    }
    Result result = cost && marks ? RESULT_OK : RESULT_NO_MEMORY;
    free(cost);
    free(marks);
    return result;
}

static Result answer(Search *search)
{
    PlanSearch *out = search->out;
    take_medians(search);
    Result result = mark_front(out);
    if (result == RESULT_OK)
        result = repeat(search);
    take_medians(search);
    if (result == RESULT_OK)
        result = mark_front(out);
    out->chosen = cheapest(out);
    if (out->chosen >= 0)
        out->choices[out->chosen].chosen = true;
    for (size_t i = 0; i < out->count; i++)
        if (out->choices[i].error < out->choices[out->best].error)
            out->best = (int)i;
    return result;
}

static Result render_truth(Search *search, Renderer truth)
{
    RenderDesc desc = search->plan->desc;
    Frame frame;
    desc.bound = false;
    progress_begin("truth", 0);
    Result result = truth(search->scene, &desc, NULL, &frame);
    progress_end();
    if (result != RESULT_OK)
        return result;
    search->truth = frame.final;
    frame.final = (Image){0};
    frame_free(&frame);
    return RESULT_OK;
}

Result plan_search(const Scene *scene, const Plan *plan, const PlanRequest *request, Renderer ref,
                   Renderer truth, PlanSearch *out)
{
    const PlanSpace *space = &request->space;
    *out = (PlanSearch){.metric = request->metric, .max_error = request->max_error, .chosen = -1};
    Search search = {.scene = scene, .plan = plan, .space = space, .ref = ref, .out = out};
    Result result = render_truth(&search, truth);
    for (int i = 0; i < METHOD_COUNT && result == RESULT_OK; i++)
        if (space->methods[i])
            result = try_method(&search, (MethodId)i);
    if (result == RESULT_OK && out->count == 0)
        result = result_fail(RESULT_NO_MEMORY, "plan: no method fits into the memory allowed "
                                               "(--max-memory)");
    if (result == RESULT_OK)
        result = answer(&search);
    image_free(&search.truth);
    free(search.times);
    if (result != RESULT_OK)
        plan_search_free(out);
    return result;
}

void plan_search_free(PlanSearch *search)
{
    free(search->choices);
    *search = (PlanSearch){0};
}

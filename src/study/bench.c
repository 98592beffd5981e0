#include "study/bench.h"

#include "base/child.h"
#include "base/memory.h"
#include "base/progress.h"
#include "compare/metrics.h"
#include "frame/method.h"
#include "study/bench_stats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *bench_renderer_name(int renderer)
{
    static const char *const names[BENCH_RENDERERS] = {"ref", "gl", "gl-early", "truth"};
    return names[renderer];
}

/* ---- formats --------------------------------------------------------------------------------- */

static bool parse_word(const char *word, BenchFormat *out)
{
    static const PixelFormat depths[] = {FORMAT_D32F, FORMAT_D24, FORMAT_D16};
    static const PixelFormat accums[] = {FORMAT_RGBA32F, FORMAT_RGBA16F, FORMAT_RGBA16,
                                         FORMAT_RGBA8};
    if (strcmp(word, "default") == 0)
        return true;
    if (strcmp(word, "seed") == 0)
        return out->seed = true;
    if (strcmp(word, "compact") == 0) {
        out->gbuffer = GBUFFER_COMPACT;
        return true;
    }
    for (size_t i = 0; i < sizeof depths / sizeof *depths; i++)
        if (strcmp(word, format_info(depths[i])->name) == 0) {
            out->depth = (int)depths[i];
            return true;
        }
    for (size_t i = 0; i < sizeof accums / sizeof *accums; i++)
        if (strcmp(word, format_info(accums[i])->name) == 0) {
            out->accum = (int)accums[i];
            return true;
        }
    return false;
}

bool bench_format_parse(const char *text, BenchFormat *out)
{
    char copy[sizeof out->name], *rest = copy, *word;
    *out = (BenchFormat){.gbuffer = -1, .depth = -1, .accum = -1};
    if (strlen(text) >= sizeof copy)
        return false;
    strcpy(copy, text);
    strcpy(out->name, text);
    while ((word = strsep(&rest, "+")))
        if (!parse_word(word, out))
            return false;
    return true;
}

void bench_format_apply(const BenchFormat *format, RenderDesc *desc)
{
    if (format->seed)
        render_desc_seed_profile(desc);
    if (format->gbuffer >= 0) {
        desc->gbuffer = (GBufferFormat)format->gbuffer;
        desc->position = POSITION_RECONSTRUCT; /* a compact one stores none */
    }
    if (format->depth >= 0)
        desc->depth = (PixelFormat)format->depth;
    if (format->accum >= 0)
        desc->accum = (PixelFormat)format->accum;
}

/* ---- a cell: all renderers with one description ---------------------------------------------- */

/* One scene, size, number of lights and number of threads; drawn in a process of its own, for a GL
 * driver starts its threads once. */
typedef struct Group {
    const BenchPlan *plan;
    int scene;
    RenderDesc desc; /* scene, size and lights */
    int lights;      /* lit */
    int threads;
    Image truths[BENCH_AXIS_MAX]; /* final, per format; one that an earlier format has is empty */
    int truth_of[BENCH_AXIS_MAX]; /* which of truths a format has */
    size_t first, total;          /* rows before, and of the plan, for progress */
    int pipe;
} Group;

typedef struct Cell {
    const Group *group;
    RenderDesc desc;
    BenchRow rows[BENCH_RENDERERS];
    void *states[BENCH_RENDERERS];
    double cpu_ms[BENCH_RENDERERS][BENCH_RUNS_MAX], wall_ms[BENCH_RENDERERS][BENCH_RUNS_MAX];
    Frame first; /* the first renderer's, with images */
    bool has_first;
} Cell;

static Result frame(const Cell *cell, int renderer, bool images, Frame *out)
{
    progress_begin(bench_renderer_name(renderer), 0);
    Result result = cell->group->plan->bound[renderer].frame(cell->states[renderer], images, out);
    progress_end();
    return result;
}

static uint64_t count_differing(const Frame *a, const Frame *b)
{
    size_t pixels = (size_t)a->final.width * (size_t)a->final.height;
    const char *finals[2] = {a->final.pixels, b->final.pixels};
    const char *displays[2] = {a->display.pixels, b->display.pixels};
    uint64_t differing = 0;
    for (size_t i = 0; i < pixels; i++)
        differing += memcmp(finals[0] + 16 * i, finals[1] + 16 * i, 16) != 0 ||
                     memcmp(displays[0] + 4 * i, displays[1] + 4 * i, 4) != 0;
    return differing;
}

/* Takes the first renderer's frame; holds others against it. truth has bits of its own. What a list
 * without room lost may depend on threads. */
static void check_bits(Cell *cell, int renderer, Frame *drawn)
{
    if (renderer == BENCH_TRUTH) {
        frame_free(drawn);
        return;
    }
    if (cell->has_first) {
        if (drawn->layers.lost_to_overflow == 0)
            cell->rows[renderer].differing = count_differing(&cell->first, drawn);
        frame_free(drawn);
        return;
    }
    cell->first = *drawn;
    cell->has_first = true;
}

/* Whether the driver fuses is its own choice; ref then does the same. */
static Result follow_driver(Cell *cell, int renderer, const Frame *drawn)
{
    bool unfused = !drawn->fused;
    if (renderer != BENCH_GL && renderer != BENCH_GL_EARLY)
        return RESULT_OK;
    if (cell->group->plan->fma_fixed && unfused != cell->desc.unfused)
        return result_fail(RESULT_NO_GL, "--fma %s: the GL driver here %s multiply-adds",
                           unfused ? "on" : "off", unfused ? "does not fuse" : "fuses");
    cell->desc.unfused = unfused;
    return RESULT_OK;
}

static Result warm_up(Cell *cell, int renderer)
{
    const Group *group = cell->group;
    const BenchRow *row = &cell->rows[renderer];
    Frame drawn;
    Result result = group->plan->bound[renderer].open(group->plan->scenes[group->scene].scene,
                                                      &cell->desc, &cell->states[renderer]);
    if (result == RESULT_OK)
        result = frame(cell, renderer, true, &drawn);
    if (result != RESULT_OK)
        return result;
    result = follow_driver(cell, renderer, &drawn);
    cell->rows[renderer].peels = drawn.peels;
    cell->rows[renderer].peak_bytes = drawn.buffer_bytes;
    cell->rows[renderer].max_abs = cell->rows[renderer].rmse = NAN;
    if (group->plan->errors) {
        FinalMetrics metrics;
        metrics_final(&drawn.final, &group->truths[group->truth_of[row->format]], &metrics);
        cell->rows[renderer].max_abs = metrics.nonfinite ? INFINITY : metrics.max_abs;
        cell->rows[renderer].rmse = metrics.nonfinite ? INFINITY : metrics.rmse;
    }
    check_bits(cell, renderer, &drawn);
    return result;
}

static Result measure(Cell *cell)
{
    const BenchPlan *plan = cell->group->plan;
    for (int run = 0; run < plan->runs; run++)
        for (int i = 0; i < BENCH_RENDERERS; i++) {
            Frame drawn;
            if (!plan->renderers[i])
                continue;
            Result result = frame(cell, i, false, &drawn);
            if (result != RESULT_OK)
                return result;
            cell->cpu_ms[i][run] = drawn.cpu_ms;
            cell->wall_ms[i][run] = drawn.time_ms;
            frame_free(&drawn);
        }
    return RESULT_OK;
}

static Result put_rows(Cell *cell)
{
    const BenchPlan *plan = cell->group->plan;
    Result result = RESULT_OK;
    for (int i = 0; i < BENCH_RENDERERS && result == RESULT_OK; i++) {
        BenchRow *row = &cell->rows[i];
        if (!plan->renderers[i])
            continue;
        row->cpu_ms = bench_median(cell->cpu_ms[i], plan->runs, &row->spread);
        row->wall_ms = bench_median(cell->wall_ms[i], plan->runs, &row->wall_spread);
        result = child_put(cell->group->pipe, row, sizeof *row);
    }
    return result;
}

/* gl before ref, which follows it. */
static Result run_cell(Cell *cell)
{
    static const int order[BENCH_RENDERERS] = {BENCH_GL, BENCH_GL_EARLY, BENCH_REF, BENCH_TRUTH};
    const BenchPlan *plan = cell->group->plan;
    Result result = RESULT_OK;
    for (int i = 0; i < BENCH_RENDERERS && result == RESULT_OK; i++)
        if (plan->renderers[order[i]])
            result = warm_up(cell, order[i]);
    if (result == RESULT_OK)
        result = measure(cell);
    if (result == RESULT_OK)
        result = put_rows(cell);
    for (int i = 0; i < BENCH_RENDERERS; i++)
        if (cell->states[i])
            plan->bound[i].close(cell->states[i]);
    frame_free(&cell->first);
    return result;
}

static int rows_per_cell(const BenchPlan *plan)
{
    int count = 0;
    for (int i = 0; i < BENCH_RENDERERS; i++)
        count += plan->renderers[i];
    return count;
}

static Result make_and_run_cell(const Group *group, int method, int format, int passes, size_t done)
{
    const BenchPlan *plan = group->plan;
    char context[64];
    Cell *cell = memory_array(1, sizeof *cell);
    if (!cell)
        return RESULT_NO_MEMORY;
    cell->group = group;
    cell->desc = group->desc;
    cell->desc.threads = group->threads;
    cell->desc.method = plan->methods[method];
    cell->desc.passes = plan->passes[passes];
    bench_format_apply(&plan->formats[format], &cell->desc);
    for (int i = 0; i < BENCH_RENDERERS; i++)
        cell->rows[i] = (BenchRow){.scene = group->scene,
                                   .format = format,
                                   .width = group->desc.width,
                                   .height = group->desc.height,
                                   .threads = group->threads,
                                   .lights = group->lights,
                                   .method = cell->desc.method,
                                   .passes = cell->desc.passes,
                                   .renderer = i};
    snprintf(context, sizeof context, "row %zu of %zu", group->first + done + 1, group->total);
    progress_context(context);
    Result result = run_cell(cell);
    progress_context(NULL);
    free(cell);
    return result;
}

/* In the child. */
static Result run_group(void *context, int pipe)
{
    Group *group = context;
    const BenchPlan *plan = group->plan;
    Result result = RESULT_OK;
    size_t done = 0;
    group->pipe = pipe;
    for (int m = 0; m < plan->method_count; m++)
        for (int f = 0; f < plan->format_count; f++)
            for (int p = 0; p < plan->pass_count && result == RESULT_OK; p++) {
                result = make_and_run_cell(group, m, f, p, done);
                done += (size_t)rows_per_cell(plan);
            }
    return result;
}

/* ---- the plan -------------------------------------------------------------------------------- */

static size_t rows_per_group(const BenchPlan *plan)
{
    return (size_t)plan->method_count * (size_t)plan->format_count * (size_t)plan->pass_count *
           (size_t)rows_per_cell(plan);
}

size_t bench_row_count(const BenchPlan *plan)
{
    return (size_t)plan->scene_count * (size_t)plan->size_count * (size_t)plan->light_count *
           (size_t)plan->thread_count * rows_per_group(plan);
}

static void take_row(void *context, const void *record, size_t size)
{
    (void)size;
    BenchReport *report = context;
    const BenchRow *row = record;
    report->rows[report->count++] = *row;
    report->differing += row->differing > 0;
}

/* Of what formats change, only the profile's other choices mean something to truth. */
static Result render_truths(Group *group)
{
    const BenchPlan *plan = group->plan;
    int of_kind[2] = {-1, -1};
    for (int f = 0; f < plan->format_count && plan->errors; f++) {
        int *same = &of_kind[plan->formats[f].seed];
        if (*same >= 0) {
            group->truth_of[f] = *same;
            continue;
        }
        Frame truth;
        RenderDesc desc = group->desc;
        bench_format_apply(&plan->formats[f], &desc);
        progress_begin("truth, to compare with", 0);
        Result result = plan->truth(plan->scenes[group->scene].scene, &desc, NULL, &truth);
        progress_end();
        if (result != RESULT_OK)
            return result;
        group->truths[f] = truth.final;
        truth.final = (Image){0};
        frame_free(&truth);
        group->truth_of[f] = *same = f;
    }
    return RESULT_OK;
}

static Result run_threads(Group *group, BenchGroup take, void *context, BenchReport *out)
{
    const BenchPlan *plan = group->plan;
    Result result = RESULT_OK;
    for (int t = 0; t < plan->thread_count && result == RESULT_OK; t++) {
        size_t first = out->count;
        const ChildWork work = {
            .run = run_group, .context = group, .take = take_row, .take_context = out};
        group->threads = plan->threads[t];
        group->first = first;
        result = child_run(&work);
        if (result == RESULT_OK)
            result = bench_mark_pareto(out->rows + first, out->count - first);
        if (result == RESULT_OK && take)
            take(context, out, first);
    }
    return result;
}

static Result run_lights(const BenchPlan *plan, int scene, BenchSize size, int lights,
                         BenchGroup take, void *context, BenchReport *out)
{
    size_t have = plan->scenes[scene].scene->light_count;
    Group group = {.plan = plan,
                   .scene = scene,
                   .desc = plan->scenes[scene].desc,
                   .lights = lights == 0  ? (int)have
                             : lights < 0 ? 0
                                          : lights,
                   .total = bench_row_count(plan)};
    group.desc.width = size.width;
    group.desc.height = size.height;
    group.desc.lights = lights;
    Result result = render_truths(&group);
    if (result == RESULT_OK)
        result = run_threads(&group, take, context, out);
    for (int i = 0; i < BENCH_AXIS_MAX; i++)
        image_free(&group.truths[i]);
    return result;
}

static Result check_lights(const BenchPlan *plan)
{
    for (int s = 0; s < plan->scene_count; s++)
        for (int l = 0; l < plan->light_count; l++) {
            const Scene *scene = plan->scenes[s].scene;
            if (plan->lights[l] > 0 && (size_t)plan->lights[l] > scene->light_count)
                return result_fail(RESULT_BAD_INPUT, "--lights %d: expected at most the %zu of %s",
                                   plan->lights[l], scene->light_count, scene->name);
        }
    return RESULT_OK;
}

Result bench_run(const BenchPlan *plan, BenchGroup group, void *context, BenchReport *out)
{
    *out = (BenchReport){.plan = plan};
    Result result = check_lights(plan);
    if (result != RESULT_OK)
        return result;
    out->rows = memory_array(bench_row_count(plan), sizeof *out->rows);
    if (!out->rows)
        return RESULT_NO_MEMORY;
    for (int s = 0; s < plan->scene_count; s++)
        for (int z = 0; z < plan->size_count; z++)
            for (int l = 0; l < plan->light_count && result == RESULT_OK; l++)
                result = run_lights(plan, s, plan->sizes[z], plan->lights[l], group, context, out);
    if (result != RESULT_OK)
        bench_free(out);
    return result;
}

void bench_free(BenchReport *report)
{
    free(report->rows);
    *report = (BenchReport){0};
}

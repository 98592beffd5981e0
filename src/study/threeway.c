#include "study/threeway.h"

#include "base/memory.h"
#include "base/progress.h"
#include "compare/against.h"
#include "compare/finite.h"
#include "compare/structure.h"
#include "frame/method.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    PICTURE_WIDTH_MAX = 320
};

const char *threeway_renderer_name(int renderer)
{
    static const char *const names[RENDERER_COUNT] = {"ref", "gl", "truth"};
    return names[renderer];
}

typedef struct Run {
    const Scene *scene;
    RenderDesc desc;
    const Renderer *renderers;
    TraceStore *ref_trace, *truth_trace;
    Threeway *report;
} Run;

static Result render(const Run *run, int renderer, const char *label, TraceSink *trace, Frame *out)
{
    progress_begin(label, 0);
    Result result = run->renderers[renderer](run->scene, &run->desc, trace, out);
    progress_end();
    return result;
}

/* The traced rendering takes another way through the renderer (ref's definition path, gl's
 * readbacks); it must not change a bit of the image that was timed, unless lists overflowed: what
 * is lost then may depend on threads. */
static Result check_same(int renderer, const Frame *timed, const Frame *traced)
{
    FinalMetrics metrics;
    if (traced->layers.lost_to_overflow > 0)
        return RESULT_OK;
    metrics_final(&timed->final, &traced->final, &metrics);
    if (metrics.differing == 0)
        return RESULT_OK;
    return result_fail(RESULT_INTERNAL,
                       "%s: %llu pixels of the image change when it is traced, expected none",
                       threeway_renderer_name(renderer), (unsigned long long)metrics.differing);
}

static Result trace_ref(Run *run)
{
    Frame traced;
    Finite finite = finite_before(store_sink(run->ref_trace));
    Result result = render(run, RENDERER_REF, "ref, traced", &finite.sink, &traced);
    run->report->nonfinite = finite.nonfinite;
    if (result != RESULT_OK)
        return result;
    result = check_same(RENDERER_REF, &run->report->frames[RENDERER_REF], &traced);
    frame_free(&traced);
    return result;
}

static Result trace_gl(Run *run)
{
    Against against = against_of(run->ref_trace);
    Frame traced;
    Result result =
        render(run, RENDERER_GL, "gl, compared buffer by buffer", &against.sink, &traced);
    if (result == RESULT_OK) {
        result = check_same(RENDERER_GL, &run->report->frames[RENDERER_GL], &traced);
        frame_free(&traced);
    }
    if (result == RESULT_OK)
        result = against_finish(&against);
    if (result == RESULT_OK) {
        PairReport *pair = &run->report->pairs[0];
        pair->buffers = against.buffers;
        pair->buffer_count = against.count;
        against.buffers = NULL;
    }
    against_free(&against);
    return result;
}

static Result render_all(Run *run)
{
    Frame *frames = run->report->frames;
    Result result = render(run, RENDERER_GL, "gl", NULL, &frames[RENDERER_GL]);
    if (result != RESULT_OK)
        return result;
    /* Whether the driver fuses is its machine's choice; ref then does the same. */
    run->desc.unfused = !frames[RENDERER_GL].fused;
    run->report->desc = run->desc;
    result = render(run, RENDERER_REF, "ref", NULL, &frames[RENDERER_REF]);
    if (result == RESULT_OK)
        result = render(run, RENDERER_TRUTH, "truth", store_sink(run->truth_trace),
                        &frames[RENDERER_TRUTH]);
    if (result == RESULT_OK)
        result = trace_ref(run);
    if (result == RESULT_OK)
        result = trace_gl(run);
    return result;
}

/* Methods that do not trace their layers: every pixel counts, none is empty but where both show
 * only the background. */
static void assume_structure(Threeway *report)
{
    const Image *ref = &report->frames[RENDERER_REF].final;
    const float *a = ref->pixels, *b = report->frames[RENDERER_TRUTH].final.pixels;
    StructureReport *structure = &report->structure;
    for (size_t i = 0; i < (size_t)ref->width * (size_t)ref->height; i++)
        structure->same[i] =
            a[4 * i + 3] == 0.0f && b[4 * i + 3] == 0.0f ? STRUCTURE_EMPTY : STRUCTURE_SAME;
    structure->same_scene = true;
}

static Result compare_structure(Run *run)
{
    Threeway *report = run->report;
    StructureReport *structure = &report->structure;
    int width = run->desc.width, height = run->desc.height;
    structure->same = memory_array((size_t)width * (size_t)height, 1);
    if (!structure->same)
        return RESULT_NO_MEMORY;
    StructureCounts counts = {0};
    structure->known = method_info(run->desc.method)->layers;
    if (!structure->known)
        assume_structure(report);
    if (structure->known) {
        progress_begin("fragments against truth", 0);
        Result result = structure_compare(run->ref_trace, run->truth_trace, width, height,
                                          structure->same, &counts);
        progress_end();
        if (result != RESULT_OK)
            return result;
    }
    const LayerStats *truth = &report->frames[RENDERER_TRUTH].layers;
    structure->layers = report->frames[RENDERER_REF].layers;
    structure->layers.max = truth->max;
    structure->layers.fragments = truth->fragments;
    structure->layers.coverage_differs = truth->coverage_differs;
    structure->layers.comparisons = truth->comparisons;
    structure->layers.exact_comparisons = truth->exact_comparisons;
    structure->layers.ties = truth->ties;
    structure->layers.undecided = truth->undecided;
    structure->order_inversions = counts.order_inversions;
    structure->opaque_flips = counts.opaque_flips;
    if (!structure->known)
        return RESULT_OK;
    uint64_t explained = structure->layers.lost_to_ties + structure->layers.lost_to_pass_limit;
    structure->set_differs =
        counts.only_a + (counts.only_b > explained ? counts.only_b - explained : 0);
    /* A few pixels differ by the rounding of a vertex. Order is not judged: single precision
     * cannot tell close layers apart, and says so in the counts. */
    uint64_t different =
        structure->opaque_flips + structure->set_differs + structure->layers.repeated;
    uint64_t all = (uint64_t)width * (uint64_t)height + structure->layers.fragments;
    structure->same_scene = different <= all / 100 || different <= 4;
    return RESULT_OK;
}

static Result compare_pairs(Run *run)
{
    static const int sides[3][2] = {
        {RENDERER_REF, RENDERER_GL}, {RENDERER_REF, RENDERER_TRUTH}, {RENDERER_GL, RENDERER_TRUTH}};
    Threeway *report = run->report;
    for (int i = 0; i < 3; i++) {
        PairReport *pair = &report->pairs[i];
        pair->a = sides[i][0];
        pair->b = sides[i][1];
        const Image *a = &report->frames[pair->a].final, *b = &report->frames[pair->b].final;
        metrics_final(a, b, &pair->final);
        pair->has_unaffected = pair->b == RENDERER_TRUTH;
        if (!pair->has_unaffected)
            continue;
        Result result = metrics_unaffected(a, b, report->structure.same, &pair->unaffected);
        const Frame *truth = &report->frames[RENDERER_TRUTH];
        pair->has_bound = truth->bound.pixels != NULL;
        if (result == RESULT_OK && pair->has_bound)
            result = metrics_bound(a, truth, report->structure.same, &pair->bound);
        if (result != RESULT_OK)
            return result;
    }
    return RESULT_OK;
}

static bool judge(const Threeway *report)
{
    const PairReport *ref_gl = &report->pairs[0], *ref_truth = &report->pairs[1];
    if (ref_gl->final.differing > 0)
        return false;
    for (size_t i = 0; i < ref_gl->buffer_count; i++)
        if (ref_gl->buffers[i].differing > 0)
            return false;
    if (ref_truth->final.nonfinite > 0)
        return false;
    return !method_is_judged(&report->desc) ||
           (ref_truth->unaffected.pixels > 0 &&
            ref_truth->unaffected.p99_rel <= report->tolerance && report->structure.same_scene);
}

/* ---- pictures of the peels ---- */

/* Averages squares of step × step pixels of a float image; a partial square at the edge too. */
static Result reduce(const Image *image, int step, Image *out)
{
    Result result = image_create((image->width + step - 1) / step,
                                 (image->height + step - 1) / step, FORMAT_RGBA32F, out);
    if (result != RESULT_OK)
        return result;
    for (int y = 0; y < out->height; y++)
        for (int x = 0; x < out->width; x++) {
            double sum[4] = {0};
            int count = 0;
            for (int j = y * step; j < (y + 1) * step && j < image->height; j++)
                for (int i = x * step; i < (x + 1) * step && i < image->width; i++, count++)
                    for (int c = 0; c < 4; c++)
                        sum[c] +=
                            (double)format_channel(image->format, image_pixel(image, i, j), c);
            float *pixel = image_pixel(out, x, y);
            for (int c = 0; c < 4; c++)
                pixel[c] = (float)(sum[c] / count);
        }
    return RESULT_OK;
}

static uint64_t count_pixels(const Image *primitive)
{
    const uint32_t *ids = primitive->pixels;
    uint64_t count = 0;
    for (size_t i = 0; i < (size_t)primitive->width * (size_t)primitive->height; i++)
        count += ids[i] != UINT32_MAX;
    return count;
}

static Result load_peel_buffer(const TraceStore *store, int peel, const char *what, Image *out)
{
    char name[48];
    snprintf(name, sizeof name, "peel.%d.%s", peel, what);
    int index = store_find(store, name);
    if (index < 0)
        return result_fail(RESULT_INTERNAL, "trace: no buffer %s", name);
    return store_image(store, index, out);
}

/* What peel added: the difference of two accumulations; alpha marks where transmittance fell. */
static Result difference(const Image *before, const Image *after, Image *out)
{
    Result result = image_create(after->width, after->height, FORMAT_RGBA32F, out);
    if (result != RESULT_OK)
        return result;
    const float *b = before ? before->pixels : NULL, *a = after->pixels;
    float *d = out->pixels;
    for (size_t i = 0; i < (size_t)after->width * (size_t)after->height; i++, a += 4, d += 4) {
        for (int c = 0; c < 3; c++)
            d[c] = a[c] - (b ? b[4 * i + (size_t)c] : 0.0f);
        d[3] = a[3] < (b ? b[4 * i + 3] : 1.0f) ? 1.0f : 0.0f;
    }
    return RESULT_OK;
}

static Result take_picture(const Run *run, int peel, const Image *before, PeelPicture *out)
{
    Image accum = {0}, primitive = {0};
    Result result = load_peel_buffer(run->ref_trace, peel, "accum", &accum);
    if (result == RESULT_OK)
        result = load_peel_buffer(run->ref_trace, peel, "primitive", &primitive);
    if (result == RESULT_OK) {
        out->peel = peel;
        out->pixels = count_pixels(&primitive);
        int step = (accum.width + PICTURE_WIDTH_MAX - 1) / PICTURE_WIDTH_MAX;
        result = reduce(&accum, step, &out->accum);
    }
    if (result == RESULT_OK)
        result = difference(before, &out->accum, &out->added);
    image_free(&accum);
    image_free(&primitive);
    return result;
}

/* None of a method that has no accumulation after each peel. */
static Result take_pictures(const Run *run)
{
    Threeway *report = run->report;
    bool traced = report->structure.known && store_find(run->ref_trace, "peel.0.accum") >= 0;
    int peels = traced ? report->frames[RENDERER_REF].peels : 0;
    int count = peels < PEEL_PICTURES_MAX ? peels : PEEL_PICTURES_MAX;
    report->peels = memory_array((size_t)count, sizeof *report->peels);
    if (!report->peels)
        return RESULT_NO_MEMORY;
    for (int peel = 0; peel < count; peel++) {
        const Image *before = peel ? &report->peels[peel - 1].accum : NULL;
        report->peel_count = (size_t)peel + 1;
        Result result = take_picture(run, peel, before, &report->peels[peel]);
        if (result != RESULT_OK)
            return result;
    }
    return RESULT_OK;
}

/* ---- the whole ---- */

static Result run_all(Run *run, bool keep_pictures)
{
    Result result = store_create(0, &run->ref_trace);
    if (result == RESULT_OK)
        result = store_create(0, &run->truth_trace);
    if (result == RESULT_OK)
        result = render_all(run);
    if (result == RESULT_OK)
        result = compare_structure(run);
    if (result == RESULT_OK)
        result = compare_pairs(run);
    if (result == RESULT_OK && keep_pictures)
        result = take_pictures(run);
    run->report->agree = result == RESULT_OK && judge(run->report);
    return result;
}

Result threeway_run(const Scene *scene, const char *path, const RenderDesc *desc,
                    const Renderer renderers[RENDERER_COUNT], double tolerance, bool keep_pictures,
                    Threeway *out)
{
    *out =
        (Threeway){.scene_name = scene->name,
                   .scene_path = path,
                   .desc = *desc,
                   .light_count = scene->light_count,
                   .seed_profile = render_desc_is_seed(desc),
                   .tolerance = tolerance < 0.0 ? method_info(desc->method)->tolerance : tolerance};
    Run run = {.scene = scene, .desc = *desc, .renderers = renderers, .report = out};
    Result result = run_all(&run, keep_pictures);
    store_destroy(run.ref_trace);
    store_destroy(run.truth_trace);
    if (result != RESULT_OK)
        threeway_free(out);
    return result;
}

void threeway_release_images(Threeway *report)
{
    for (int i = 0; i < RENDERER_COUNT; i++) {
        image_free(&report->frames[i].final);
        image_free(&report->frames[i].display);
        image_free(&report->frames[i].bound);
        image_free(&report->frames[i].rounding);
    }
    for (size_t i = 0; i < report->peel_count; i++) {
        image_free(&report->peels[i].accum);
        image_free(&report->peels[i].added);
    }
    free(report->peels);
    report->peels = NULL;
    report->peel_count = 0;
    free(report->structure.same);
    report->structure.same = NULL;
}

void threeway_free(Threeway *report)
{
    threeway_release_images(report);
    for (int i = 0; i < RENDERER_COUNT; i++)
        frame_free(&report->frames[i]);
    for (int i = 0; i < 3; i++)
        free(report->pairs[i].buffers);
    *report = (Threeway){0};
}

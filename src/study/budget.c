#include "study/budget.h"

#include "base/memory.h"
#include "base/progress.h"
#include "frame/method.h"
#include "study/replay.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    CHANNELS = 4
};

typedef struct Study {
    const Scene *scene;
    const RenderDesc *desc;
    Renderer ref, truth;
    size_t pixels;
    Image truth_image, actual;
    Image bound; /* of single precision, where desc asks for it; else without pixels */
    TraceStore *truth_trace, *actual_trace, *best_trace, *method_trace;
    TraceStore *stored_trace; /* best in desc's format of depth; NULL where that is the same */
    double *sum;              /* CHANNELS per pixel: of all shares */
    float *greatest;          /* per pixel: the greatest share so far */
    uint8_t *term;            /* and whose it is */
    uint8_t *ordered;         /* a StructureSame: whether the best rendering has truth's order */
    Budget *budget;
} Study;

static const struct {
    const char *key, *text;
} terms[BUDGET_TERMS] = {
    [BUDGET_ROUNDING] = {"rounding", "single precision, where the fragments and their order agree"},
    [BUDGET_ORDER] = {"order", "single precision, where they do not"},
    [BUDGET_TIES] = {"ties", "layers lost to equal depths"},
    [BUDGET_METHOD] = {"method", "what the method itself changes"},
    [BUDGET_PASSES] = {"passes", "layers behind the last pass"},
    [BUDGET_BIAS] = {"bias", "layers that the bias passes over"},
    [BUDGET_DEPTH] = {"depth", "depth format and peel test"},
    [BUDGET_GBUFFER] = {"gbuffer", "G-buffer formats, position from depth"},
    [BUDGET_CLAMP] = {"clamp", "colours clamped to 1 before and after blending"},
    [BUDGET_ACCUM] = {"accum", "accumulation format, clamping apart"},
};

const char *budget_term_key(BudgetTerm term)
{
    return terms[term].key;
}

const char *budget_term_text(BudgetTerm term)
{
    return terms[term].text;
}

/* ---- figures ---- */

typedef struct Tally {
    double max_abs, squares;
    uint64_t pixels;
} Tally;

static bool is_finite(const float value[CHANNELS])
{
    return isfinite(value[0]) && isfinite(value[1]) && isfinite(value[2]) && isfinite(value[3]);
}

/* The greatest part of a difference, which is added to the tally. */
static double tally_add(Tally *tally, const double difference[CHANNELS])
{
    double most = 0.0;
    for (int c = 0; c < CHANNELS; c++) {
        most = fmax(most, fabs(difference[c]));
        tally->squares += difference[c] * difference[c];
    }
    tally->max_abs = fmax(tally->max_abs, most);
    tally->pixels += most > 0.0;
    return most;
}

static BudgetFigure figure(const Study *study, const Tally *tally)
{
    return (BudgetFigure){true, tally->max_abs,
                          sqrt(tally->squares / ((double)study->pixels * CHANNELS)), tally->pixels};
}

/* b − a is a term's share at a pixel; where one is not finite it has none. */
static void add_share(Study *study, BudgetTerm term, size_t pixel, const float *a, const float *b,
                      Tally *tally)
{
    double share[CHANNELS];
    if (!is_finite(a) || !is_finite(b))
        return;
    for (int c = 0; c < CHANNELS; c++) {
        share[c] = (double)b[c] - (double)a[c];
        study->sum[CHANNELS * pixel + (size_t)c] += share[c];
    }
    double most = tally_add(tally, share);
    if (most > (double)study->greatest[pixel]) {
        study->greatest[pixel] = (float)most;
        study->term[pixel] = (uint8_t)term;
    }
}

static void add_term(Study *study, BudgetTerm term, const Image *from, const Image *to)
{
    const float *a = from->pixels, *b = to->pixels;
    Tally tally = {0};
    for (size_t i = 0; i < study->pixels; i++)
        add_share(study, term, i, a + CHANNELS * i, b + CHANNELS * i, &tally);
    study->budget->terms[term] = figure(study, &tally);
}

/* Truth to the best rendering: two terms. */
static void add_single_precision(Study *study, const Image *best)
{
    const float *a = study->truth_image.pixels, *b = best->pixels;
    Tally tallies[2] = {{0.0, 0.0, 0}, {0.0, 0.0, 0}};
    for (size_t i = 0; i < study->pixels; i++) {
        bool other = study->ordered[i] == STRUCTURE_DIFFERS;
        add_share(study, other ? BUDGET_ORDER : BUDGET_ROUNDING, i, a + CHANNELS * i,
                  b + CHANNELS * i, &tallies[other]);
    }
    study->budget->terms[BUDGET_ROUNDING] = figure(study, &tallies[0]);
    study->budget->terms[BUDGET_ORDER] = figure(study, &tallies[1]);
}

/* ---- renderings ---- */

static Result render(const Study *study, Renderer renderer, const RenderDesc *desc,
                     const char *label, TraceStore *trace, Image *out, Image *bound)
{
    Frame frame;
    progress_begin(label, 0);
    Result result = renderer(study->scene, desc, trace ? store_sink(trace) : NULL, &frame);
    progress_end();
    if (result != RESULT_OK)
        return result;
    *out = frame.final;
    if (bound)
        *bound = frame.bound;
    frame.final = (Image){0};
    if (bound)
        frame.bound = (Image){0};
    frame_free(&frame);
    return RESULT_OK;
}

RenderDesc budget_best(const RenderDesc *desc, MethodId method)
{
    RenderDesc best = *desc;
    best.method = method;
    best.passes = 0;
    best.bias = 0.0f;
    best.depth = FORMAT_D32F;
    best.peel_test = PEEL_TEST_STORED;
    best.gbuffer = GBUFFER_FULL;
    best.position = POSITION_BUFFER;
    best.accum = FORMAT_RGBA32F;
    best.nodes_per_pixel = 0;
    best.post = POST_NONE;
    return best;
}

static bool same_method(const RenderDesc *a, const RenderDesc *b)
{
    return a->method == b->method && a->nodes_per_pixel == b->nodes_per_pixel && a->post == b->post;
}

/* from → a rendering of desc, which it becomes. */
static Result step(Study *study, BudgetTerm term, const RenderDesc *desc, TraceStore *trace,
                   Image *from)
{
    Image to = {0};
    Result result = render(study, study->ref, desc, terms[term].key, trace, &to, NULL);
    if (result != RESULT_OK)
        return result;
    add_term(study, term, from, &to);
    image_free(from);
    *from = to;
    return RESULT_OK;
}

/* One thing changed alone. */
static Result change(Study *study, BudgetTerm term, const RenderDesc *desc, const Image *from)
{
    Image to = {0};
    Result result = render(study, study->ref, desc, terms[term].key, NULL, &to, NULL);
    if (result == RESULT_OK)
        add_term(study, term, from, &to);
    image_free(&to);
    return result;
}

/* ---- the changes ---- */

/* Fixed-point accumulations clamp; the rest of what they change is their format's. Where the trace
 * has no accumulation of each layer, all of it is. */
static Result change_accum(Study *study, const RenderDesc *desc, const Image *from)
{
    Image base = {0}, to = {0};
    bool clamps =
        format_info(desc->accum)->kind == KIND_UNORM && replay_possible(study->method_trace);
    Result result = clamps ? replay_clamped(study->method_trace, from, &base) : RESULT_OK;
    if (result == RESULT_OK)
        result = render(study, study->ref, desc, terms[BUDGET_ACCUM].key, NULL, &to, NULL);
    if (result == RESULT_OK && clamps)
        add_term(study, BUDGET_CLAMP, from, &base);
    if (result == RESULT_OK)
        add_term(study, BUDGET_ACCUM, clamps ? &base : from, &to);
    image_free(&base);
    image_free(&to);
    return result;
}

static Result change_formats(Study *study, const RenderDesc *best, const Image *from)
{
    const RenderDesc *desc = study->desc;
    RenderDesc changed = *best;
    Result result = RESULT_OK;
    changed.passes = desc->passes;
    if (desc->passes)
        result = change(study, BUDGET_PASSES, &changed, from);
    changed = *best;
    changed.bias = desc->bias;
    if (result == RESULT_OK && desc->bias > 0.0f)
        result = change(study, BUDGET_BIAS, &changed, from);
    changed = *best;
    changed.depth = desc->depth;
    changed.peel_test = desc->peel_test;
    if (result == RESULT_OK &&
        (render_desc_depth(desc) != FORMAT_D32F || desc->peel_test != PEEL_TEST_STORED))
        result = change(study, BUDGET_DEPTH, &changed, from);
    changed = *best;
    changed.gbuffer = desc->gbuffer;
    changed.position = desc->position;
    if (result == RESULT_OK && (desc->gbuffer != GBUFFER_FULL || desc->position != POSITION_BUFFER))
        result = change(study, BUDGET_GBUFFER, &changed, from);
    changed = *best;
    changed.accum = desc->accum;
    if (result == RESULT_OK && desc->accum != FORMAT_RGBA32F)
        result = change_accum(study, &changed, from);
    return result;
}

static Result render_stored(Study *study, const RenderDesc *best)
{
    RenderDesc stored = *best;
    Image image = {0};
    stored.depth = study->desc->depth;
    if (render_desc_depth(&stored) == render_desc_depth(best))
        return RESULT_OK;
    Result result = store_create(0, &study->stored_trace);
    if (result == RESULT_OK)
        result = render(study, study->ref, &stored, "stored", study->stored_trace, &image, NULL);
    image_free(&image);
    return result;
}

static Result explain(Study *study)
{
    const RenderDesc *desc = study->desc;
    RenderDesc best = budget_best(desc, METHOD_PEEL_ID), tied = budget_best(desc, METHOD_PEEL);
    RenderDesc method = budget_best(desc, desc->method);
    StructureCounts counts;
    Image image = {0};
    method.nodes_per_pixel = desc->nodes_per_pixel;
    method.post = desc->post;
    Result result = render(study, study->ref, &best, "best", study->best_trace, &image, NULL);
    if (result == RESULT_OK)
        result = structure_compare(study->best_trace, study->truth_trace, desc->width, desc->height,
                                   study->ordered, &counts);
    if (result == RESULT_OK)
        add_single_precision(study, &image);
    if (result == RESULT_OK)
        result = render_stored(study, &best);
    RenderDesc *last = &best;
    if (result == RESULT_OK && method_info(desc->method)->loses_ties) {
        last = &tied;
        result = step(study, BUDGET_TIES, &tied, NULL, &image);
    }
    if (result == RESULT_OK && !same_method(last, &method))
        result = step(study, BUDGET_METHOD, &method, study->method_trace, &image);
    else if (result == RESULT_OK && format_info(desc->accum)->kind == KIND_UNORM) {
        image_free(&image);
        result = render(study, study->ref, &method, "layers", study->method_trace, &image, NULL);
    }
    if (result == RESULT_OK)
        result = change_formats(study, &method, &image);
    image_free(&image);
    return result;
}

/* The total, the sum, what is left. */
static void conclude(Study *study)
{
    const float *a = study->truth_image.pixels, *b = study->actual.pixels;
    Budget *budget = study->budget;
    Tally total = {0}, sum = {0}, rest = {0};
    for (size_t i = 0; i < study->pixels; i++, a += CHANNELS, b += CHANNELS) {
        double whole[CHANNELS], left[CHANNELS];
        const double *shares = &study->sum[CHANNELS * i];
        if (!is_finite(a) || !is_finite(b)) {
            budget->nonfinite++;
            study->term[i] = BUDGET_TERMS;
            continue;
        }
        for (int c = 0; c < CHANNELS; c++) {
            whole[c] = (double)b[c] - (double)a[c];
            left[c] = whole[c] - shares[c];
        }
        tally_add(&total, whole);
        tally_add(&sum, shares);
        if (tally_add(&rest, left) > (double)study->greatest[i])
            study->term[i] = BUDGET_TERMS;
    }
    budget->total = figure(study, &total);
    budget->sum = figure(study, &sum);
    budget->unexplained = figure(study, &rest);
    budget->explained = total.squares > 0.0 ? 1.0 - rest.squares / total.squares : 1.0;
}

/* ---- classes ---- */

static PixelClass class_of_share(int term)
{
    static const PixelClass of[BUDGET_TERMS + 1] = {
        [BUDGET_ROUNDING] = CLASS_ROUNDING, [BUDGET_ORDER] = CLASS_INVERSION,
        [BUDGET_TIES] = CLASS_LOST_TIE,     [BUDGET_METHOD] = CLASS_METHOD,
        [BUDGET_PASSES] = CLASS_LOST_LIMIT, [BUDGET_BIAS] = CLASS_LOST_BIAS,
        [BUDGET_DEPTH] = CLASS_DEPTH,       [BUDGET_GBUFFER] = CLASS_GBUFFER,
        [BUDGET_CLAMP] = CLASS_ACCUM,       [BUDGET_ACCUM] = CLASS_ACCUM,
        [BUDGET_TERMS] = CLASS_UNEXPLAINED,
    };
    return of[term];
}

/* Whether single precision may be that far from truth. */
static bool in_bound(const Study *study, size_t pixel, const float *a, const float *b)
{
    const float *bound = study->bound.pixels;
    for (int c = 0; bound && c < CHANNELS; c++)
        if (fabs((double)b[c] - (double)a[c]) > (double)bound[CHANNELS * pixel + (size_t)c])
            return false;
    return true;
}

static void classify(void *context, size_t pixel, StructurePixel *sides)
{
    Study *study = context;
    const float *a = (const float *)study->truth_image.pixels + CHANNELS * pixel;
    const float *b = (const float *)study->actual.pixels + CHANNELS * pixel;
    bool layers = method_info(study->desc->method)->layers;
    PixelClass class = CLASS_EQUAL;
    if (memcmp(a, b, CHANNELS * sizeof *a) != 0) {
        if (layers)
            class = class_of_fragments(study->desc, &sides[0], &sides[1], &sides[2],
                                       &sides[study->stored_trace ? 3 : 2]);
        if (class == CLASS_EQUAL)
            class = class_of_share(study->term[pixel]);
        if (class == CLASS_ROUNDING && !in_bound(study, pixel, a, b))
            class = CLASS_UNEXPLAINED;
    }
    study->budget->counts[class]++;
    study->budget->classes[pixel] = (uint8_t) class;
}

/* ---- the whole ---- */

static Result allocate(Study *study)
{
    Budget *budget = study->budget;
    TraceStore **stores[] = {&study->truth_trace, &study->actual_trace, &study->best_trace,
                             &study->method_trace};
    study->sum = memory_array(study->pixels, CHANNELS * sizeof *study->sum);
    study->greatest = memory_array(study->pixels, sizeof *study->greatest);
    study->term = memory_array(study->pixels, 1);
    study->ordered = memory_array(study->pixels, 1);
    budget->classes = memory_array(study->pixels, 1);
    if (!study->sum || !study->greatest || !study->term || !study->ordered || !budget->classes)
        return RESULT_NO_MEMORY;
    Result result = RESULT_OK;
    for (int i = 0; i < 4 && result == RESULT_OK; i++)
        result = store_create(0, stores[i]);
    return result;
}

static void release(Study *study)
{
    image_free(&study->truth_image);
    image_free(&study->actual);
    image_free(&study->bound);
    store_destroy(study->truth_trace);
    store_destroy(study->actual_trace);
    store_destroy(study->best_trace);
    store_destroy(study->stored_trace);
    store_destroy(study->method_trace);
    free(study->sum);
    free(study->greatest);
    free(study->term);
    free(study->ordered);
}

static Result run(Study *study)
{
    const RenderDesc *desc = study->desc;
    Result result = allocate(study);
    if (result == RESULT_OK)
        result = render(study, study->truth, desc, "truth", study->truth_trace, &study->truth_image,
                        &study->bound);
    if (result == RESULT_OK)
        result = render(study, study->ref, desc, "ref", study->actual_trace, &study->actual, NULL);
    if (result == RESULT_OK)
        result = explain(study);
    if (result != RESULT_OK)
        return result;
    conclude(study);
    const TraceStore *const stores[] = {study->actual_trace, study->truth_trace, study->best_trace,
                                        study->stored_trace};
    int count = study->stored_trace ? 4 : 3;
    return structure_visit(stores, count, count - 1, desc->width, desc->height, classify, study);
}

Result budget_run(const Scene *scene, const RenderDesc *desc, Renderer ref, Renderer truth,
                  Budget *out)
{
    *out = (Budget){.width = desc->width, .height = desc->height};
    Study study = {.scene = scene,
                   .desc = desc,
                   .ref = ref,
                   .truth = truth,
                   .pixels = (size_t)desc->width * (size_t)desc->height,
                   .budget = out};
    Result result = run(&study);
    release(&study);
    if (result != RESULT_OK)
        budget_free(out);
    return result;
}

void budget_free(Budget *budget)
{
    free(budget->classes);
    *budget = (Budget){0};
}

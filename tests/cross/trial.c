/* Against truth. Where both see the same fragments in the same order, ref may be as far from it as
 * the bound of single precision allows, and no farther (ref/truth/bound.h); a method without bound
 * is replaced by its sister that has one, with the same settings. Where they do not, the reason
 * must be one of study/classes.h, found with two more renderings, both of peel-id, which has
 * neither ties nor limits: one in 32 bits, which tells what single precision can have, and one in
 * the frame's own format of depth, which tells what that format hides; and what each of them has
 * there, and truth, must be possible by the bounds of every triangle (possible.h). And of a method
 * without bound: its layers are classified in the same way; one that has none must leave every
 * pixel alone in which nothing transparent is. */
#include "trial.h"

#include "bits.h"
#include "paths.h"
#include "possible.h"
#include "truths.h"

#include "frame/method.h"
#include "study/budget.h"

const char *trial_name(TrialId trial)
{
    static const char *const names[TRIAL_COUNT] = {"ref and gl", "definition and tiles",
                                                   "ref and truth"};
    return names[trial];
}

/* ---- ref and gl; ref's two paths ------------------------------------------------------------ */

static Result run_gl(const Scene *scene, const RenderDesc *desc, TrialFigures *out)
{
    Bits bits;
    Result result = bits_measure(scene, desc, &bits);
    out->pixels = bits.pixels;
    out->values = bits.values;
    out->fragments = bits.layers.fragments;
    out->differences = bits.differing;
    memcpy(out->text, bits.difference, sizeof bits.difference);
    return result;
}

static Result run_paths(const Scene *scene, const RenderDesc *desc, TrialFigures *out)
{
    RenderDesc traced = *desc;
    Frame definition = {0}, tile = {0};
    traced.ref_path = REF_PATH_DEFINITION;
    traced.threads = 1;
    Result result = pipeline_render(scene, &traced, NULL, &definition);
    if (result == RESULT_OK)
        result = paths_tile(scene, *desc, &tile);
    if (result == RESULT_OK)
        out->differences = paths_frames_differ(&tile, &definition, out->text);
    frame_free(&definition);
    frame_free(&tile);
    return result;
}

/* ---- ref and truth -------------------------------------------------------------------------- */

/* One pixel's four sides, in this order in the stores. */
enum {
    SIDE_REF,
    SIDE_TRUTH,
    SIDE_BEST,
    SIDE_STORED,
    SIDES
};

typedef struct Truthful {
    const Scene *scene;
    const RenderDesc *desc; /* of the method in question */
    const Truths *truths;
    Possible *possible;
    RenderDesc best_desc, stored_desc;
    TraceStore *best, *stored;
    bool structure;    /* desc is not what truths compared: of fragments alone */
    const Image *mine; /* of a method without layers: its image; else NULL */
    TrialFigures *out;
} Truthful;

static void unexplained(Truthful *study, size_t pixel, const char *what)
{
    int width = study->desc->width;
    if (!study->out->differences++)
        snprintf(study->out->text, sizeof study->out->text, "pixel (%d, %d), method %s: %s",
                 (int)(pixel % (size_t)width), (int)(pixel / (size_t)width),
                 method_info(study->desc->method)->name, what);
}

static bool within_bound(const Truths *truths, size_t pixel)
{
    const float *a = truths->ref.final.pixels, *b = truths->truth.final.pixels;
    const float *most = truths->truth.bound.pixels;
    for (size_t i = 4 * pixel; i < 4 * pixel + 4; i++)
        if (memcmp(&a[i], &b[i], sizeof a[i]) != 0 && !isinf(most[i]) &&
            !(fabs((double)a[i] - (double)b[i]) <= (double)most[i]))
            return false;
    return true;
}

static bool same_bits(const Image *a, const Image *b, size_t pixel)
{
    return memcmp((const float *)a->pixels + 4 * pixel, (const float *)b->pixels + 4 * pixel,
                  4 * sizeof(float)) == 0;
}

/* NULL, or what cannot be. */
static const char *impossible(const Truthful *study, size_t pixel, const StructurePixel *sides)
{
    const StructurePixel *truth = &sides[SIDE_TRUTH], *best = &sides[SIDE_BEST],
                         *stored = &sides[SIDE_STORED];
    const char *what = NULL;
    if (!structure_same(best, truth)) {
        what = possible_all(study->possible, &study->best_desc, pixel, best, truth);
        if (!what)
            what = possible_all(study->possible, NULL, pixel, truth, best);
    }
    if (!what && !structure_same(stored, truth))
        what = possible_all(study->possible, &study->stored_desc, pixel, stored, truth);
    return what;
}

/* The same of the method itself, repetitions dropped: its layers, and those that it lost as ties.
 */
static const char *impossible_layers(const Truthful *study, size_t pixel, PixelClass class,
                                     const StructurePixel *sides)
{
    const StructurePixel *ref = &sides[SIDE_REF], *stored = &sides[SIDE_STORED];
    const char *what = NULL;
    if (!structure_same(ref, stored))
        what = possible_fragments(study->possible, study->desc, pixel, ref);
    /* Of all of its layers: beyond the limit, or a layer that is peeled for ever. */
    bool behind = study->desc->passes > 0 || study->desc->peel_test == PEEL_TEST_RAW;
    for (int i = stored->count; class == CLASS_LOST_TIE && i-- > 0 && !what;) {
        if (structure_find(stored->ids, i, stored->ids[i]) >= 0)
            continue; /* its first place counts */
        bool there = structure_find(ref->ids, ref->count, stored->ids[i]) >= 0;
        behind = behind && !there;
        if (!there && !behind &&
            !possible_tie(study->possible, study->desc, pixel, stored, stored->ids[i]))
            what = "a layer lost that no other is as deep as";
    }
    return what;
}

static void visit(void *context, size_t pixel, StructurePixel *sides)
{
    Truthful *study = context;
    const Truths *truths = study->truths;
    const char *what = impossible(study, pixel, sides);
    if (!what && study->desc->peel_test != PEEL_TEST_RAW)
        what = possible_repetitions(study->possible, study->desc, pixel, &sides[SIDE_REF]);
    PixelClass class = class_of_fragments(study->desc, &sides[SIDE_REF], &sides[SIDE_TRUTH],
                                          &sides[SIDE_BEST], &sides[SIDE_STORED]);
    if (!what)
        what = impossible_layers(study, pixel, class, sides);
    if (class == CLASS_UNEXPLAINED)
        what = "a fragment is missing, and nothing explains it";
    if (what) {
        class = CLASS_UNEXPLAINED;
        unexplained(study, pixel, what);
    } else if (class == CLASS_EQUAL && study->structure)
        class = CLASS_METHOD;
    else if (class == CLASS_EQUAL && !same_bits(&truths->ref.final, &truths->truth.final, pixel)) {
        class = within_bound(truths, pixel) ? CLASS_ROUNDING : CLASS_UNEXPLAINED;
        if (class == CLASS_UNEXPLAINED)
            unexplained(study, pixel, "the colour is beyond the bound of single precision");
    }
    study->out->classes[class]++;
}

/* Where there is nothing transparent for it to approximate. */
static void visit_unlayered(void *context, size_t pixel, StructurePixel *sides)
{
    Truthful *study = context;
    bool empty = sides[SIDE_REF].count == 0 && sides[SIDE_STORED].count == 0;
    PixelClass class = CLASS_METHOD;
    if (empty) {
        bool same = same_bits(study->mine, &study->truths->ref.final, pixel);
        class = same ? CLASS_EQUAL : CLASS_UNEXPLAINED;
        if (!same)
            unexplained(study, pixel, "nothing transparent, and not the colour of other methods");
    }
    study->out->classes[class]++;
}

static Result render_trace(const Scene *scene, const RenderDesc *desc, TraceStore **store,
                           Frame *out)
{
    Result result = store_create(0, store);
    if (result == RESULT_OK)
        result = pipeline_render(scene, desc, store_sink(*store), out);
    return result;
}

static Result compare_sides(Truthful *study, const TraceStore *ref, StructureVisit visitor)
{
    const TraceStore *const stores[SIDES] = {[SIDE_REF] = ref,
                                             [SIDE_TRUTH] = study->truths->truth_trace,
                                             [SIDE_BEST] = study->best,
                                             [SIDE_STORED] = study->stored};
    return structure_visit(stores, SIDES, SIDE_STORED, study->desc->width, study->desc->height,
                           visitor, study);
}

static Result render_helpers(Truthful *study)
{
    RenderDesc *best = &study->best_desc, *stored = &study->stored_desc;
    Frame frames[2] = {0};
    *best = *stored = budget_best(study->desc, METHOD_PEEL_ID);
    stored->depth = study->desc->depth;
    Result result = possible_create(study->scene, study->desc, &study->possible);
    if (result == RESULT_OK)
        result = render_trace(study->scene, best, &study->best, &frames[0]);
    if (result == RESULT_OK)
        result = render_trace(study->scene, stored, &study->stored, &frames[1]);
    for (int i = 0; i < 2; i++)
        frame_free(&frames[i]);
    return result;
}

/* The method itself, where it is not what was compared with truth. */
static Result run_unbounded(Truthful *study, const RenderDesc *desc)
{
    TraceStore *store = NULL;
    Frame frame = {0};
    bool layers = method_info(desc->method)->layers;
    Result result = render_trace(study->scene, desc, &store, &frame);
    study->desc = desc;
    study->structure = true;
    study->mine = layers ? NULL : &frame.final;
    if (result == RESULT_OK)
        result = compare_sides(study, layers ? store : study->truths->ref_trace,
                               layers ? visit : visit_unlayered);
    store_destroy(store);
    frame_free(&frame);
    return result;
}

RenderDesc trial_desc(TrialId trial, const RenderDesc *desc)
{
    RenderDesc bounded = *desc;
    bounded.bound = trial == TRIAL_TRUTH;
    if (trial != TRIAL_TRUTH || method_has_bound(desc))
        return bounded;
    bounded.post = POST_NONE;
    if (desc->method == METHOD_DUAL)
        bounded.method = METHOD_PEEL;
    else if (desc->method == METHOD_FORWARD_DUAL)
        bounded.method = METHOD_FORWARD;
    else if (desc->method != METHOD_LINKED_LIST)
        bounded.method = METHOD_PEEL_ID;
    return bounded;
}

static Result run_truth(const Scene *scene, const RenderDesc *desc, TrialFigures *out)
{
    RenderDesc bounded = trial_desc(TRIAL_TRUTH, desc);
    Truths truths;
    Truthful study = {.scene = scene, .desc = &bounded, .truths = &truths, .out = out};
    Result result = truths_compare(scene, &bounded, &truths);
    out->bounded = truths.bound.pixels;
    out->unbounded = truths.bound.unbounded;
    out->max_ratio = truths.bound.max_ratio;
    if (result == RESULT_OK)
        result = render_helpers(&study);
    if (result == RESULT_OK)
        result = compare_sides(&study, truths.ref_trace, visit);
    if (result == RESULT_OK && bounded.method != desc->method)
        result = run_unbounded(&study, desc);
    possible_destroy(study.possible);
    store_destroy(study.best);
    store_destroy(study.stored);
    truths_free(&truths);
    return result;
}

Result trial_run(TrialId trial, const Scene *scene, const RenderDesc *desc, TrialFigures *out)
{
    static Result (*const runs[TRIAL_COUNT])(const Scene *, const RenderDesc *,
                                             TrialFigures *) = {run_gl, run_paths, run_truth};
    *out = (TrialFigures){0};
    return runs[trial](scene, desc, out);
}

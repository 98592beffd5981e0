#include "study/diagnose.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/progress.h"
#include "study/changes.h"
#include "study/evidence.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    KEPT = 8,     /* files of the best mistakes so far, to find equals among */
    PAIRED = 4,   /* the best mistakes, which are tried in pairs */
    PARTNERS = 6, /* and those that change what the best leaves unexplained */
    ROWS = MUTATION_COUNT + PAIRED * (PAIRED - 1) / 2 + PAIRED * PARTNERS
};
#define PAIR_GAIN 0.02 /* what a pair has to explain beyond the better of the two */

typedef struct Kept {
    int row;
    Image predicted;
} Kept;

typedef struct Work {
    const Scene *scene;
    RenderDesc desc;
    Renderer ref;
    Fit fit;
    Image final; /* of the reference */
    FitResult none;
    Image predicted; /* of the reference, in the form of `none` */
    Kept kept[KEPT];
    int kept_count, groups;
    Changes changes;
    Diagnosis *out;
} Work;

/* ---- rendering ------------------------------------------------------------------------------- */

static Result render(Work *work, const RenderDesc *desc, const char *label, Image *out)
{
    Frame frame;
    progress_begin(label, 0);
    Result result = work->ref(work->scene, desc, NULL, &frame);
    progress_end();
    if (result != RESULT_OK)
        return result;
    *out = frame.final;
    frame.final = (Image){0};
    frame_free(&frame);
    work->out->rendered++;
    return RESULT_OK;
}

static RenderDesc with_mutations(const Work *work, uint64_t mutations)
{
    RenderDesc asked = work->desc, out;
    asked.mutations = mutations;
    mutation_apply(&asked, &out);
    return out;
}

static MutationId id_of(uint64_t bit)
{
    return (MutationId)__builtin_ctzll(bit);
}

static bool is_single(uint64_t mutations)
{
    return (mutations & (mutations - 1)) == 0;
}

static bool obeys(MethodId method)
{
    return method == METHOD_PEEL || method == METHOD_FORWARD;
}

static FitRendering rendering_of(uint64_t mutations, const Image *final)
{
    return (FitRendering){final, (mutations & mutation_bit(MUTATION_SRGB_ENCODED_TWICE)) != 0};
}

static bool same_bits(const Image *a, const Image *b)
{
    size_t pixels = (size_t)a->width * (size_t)a->height;
    return memcmp(a->pixels, b->pixels, pixels * format_pixel_bytes(a->format)) == 0;
}

/* ---- hypotheses ------------------------------------------------------------------------------ */

static bool same_form(const GivenMeaning *a, const GivenMeaning *b)
{
    return a->encoding == b->encoding && a->rows == b->rows && a->alpha == b->alpha;
}

/* Exact ones first; then what explains more. */
static int compare_rows(const void *first, const void *second)
{
    const DiagnoseRow *a = first, *b = second;
    if ((a->beyond == 0) != (b->beyond == 0))
        return a->beyond == 0 ? -1 : 1;
    if (a->squares != b->squares && a->beyond > 0)
        return a->squares < b->squares ? -1 : 1;
    int singles = __builtin_popcountll(a->mutations) - __builtin_popcountll(b->mutations);
    if (singles != 0)
        return singles;
    return (a->mutations > b->mutations) - (a->mutations < b->mutations);
}

/* Gives the row its group: that of a kept file that it makes too, or a new one. Takes over
 * predicted. */
static void keep(Work *work, int index, Image *predicted)
{
    DiagnoseRow *row = &work->out->rows[index];
    int worst = 0;
    for (int i = 0; i < work->kept_count; i++) {
        const DiagnoseRow *other = &work->out->rows[work->kept[i].row];
        if (same_form(&row->form, &other->form) &&
            fit_same(&work->fit, &row->form, predicted, &work->kept[i].predicted)) {
            row->group = other->group;
            image_free(predicted);
            return;
        }
        if (other->squares > work->out->rows[work->kept[worst].row].squares)
            worst = i;
    }
    row->group = work->groups++;
    if (work->kept_count < KEPT) {
        work->kept[work->kept_count++] = (Kept){index, *predicted};
        return;
    }
    Kept *place = &work->kept[worst];
    if (row->squares < work->out->rows[place->row].squares) {
        image_swap(&place->predicted, predicted);
        place->row = index;
    }
    image_free(predicted);
}

/* Adds a row for a rendering, unless their file would be what it is without the mutations. */
static Result judge(Work *work, uint64_t mutations, const Image *final, bool *visible)
{
    Diagnosis *out = work->out;
    FitResult fit;
    Image predicted;
    *visible = false;
    if (same_bits(final, &work->final))
        return RESULT_OK;
    FitRendering rendering = rendering_of(mutations, final);
    Result result = fit_measure(&work->fit, &rendering, &fit);
    if (result == RESULT_OK)
        result = fit_predict(&work->fit, &rendering, &fit.form, &predicted);
    if (result != RESULT_OK)
        return result;
    if (same_form(&fit.form, &work->none.form) &&
        fit_same(&work->fit, &fit.form, &predicted, &work->predicted)) {
        image_free(&predicted);
        return RESULT_OK;
    }
    double share = work->none.squares > 0.0 ? 1.0 - fit.squares / work->none.squares : 0.0;
    *visible = true;
    out->rows[out->count] = (DiagnoseRow){.mutations = mutations,
                                          .explains = fmax(share, 0.0),
                                          .beyond = fit.beyond,
                                          .form = fit.form,
                                          .squares = fit.squares};
    keep(work, (int)out->count++, &predicted);
    return RESULT_OK;
}

static Result try_mutations(Work *work, uint64_t mutations, const char *label, bool *visible)
{
    RenderDesc desc = with_mutations(work, mutations);
    Image final;
    *visible = false;
    /* The setting that it stands for is the one asked for. */
    if (desc.mutations == 0 && memcmp(&desc, &work->desc, sizeof desc) == 0)
        return RESULT_OK;
    Result result = render(work, &desc, label, &final);
    if (result != RESULT_OK)
        return result;
    result = judge(work, mutations, &final, visible);
    if (result == RESULT_OK && *visible && is_single(mutations))
        changes_mark(&work->changes, id_of(mutations), &work->final, &final);
    image_free(&final);
    return result;
}

static Result try_singles(Work *work)
{
    Result result = RESULT_OK;
    for (int id = 0; id < MUTATION_COUNT && result == RESULT_OK; id++) {
        uint64_t bit = mutation_bit((MutationId)id);
        char context[64];
        bool visible;
        snprintf(context, sizeof context, "mistake %d of %d", id + 1, MUTATION_COUNT);
        progress_context(context);
        result = try_mutations(work, bit, mutation_info((MutationId)id)->name, &visible);
        if (result == RESULT_OK && !visible)
            work->out->invisible |= bit;
    }
    progress_context(NULL);
    return result;
}

/* ---- pairs ----------------------------------------------------------------------------------- */

static double explained_by(const Work *work, uint64_t bit)
{
    for (size_t i = 0; i < work->out->count; i++)
        if (work->out->rows[i].mutations == bit)
            return work->out->rows[i].explains;
    return 0.0;
}

static Result try_pair(Work *work, uint64_t a, uint64_t b)
{
    for (size_t i = 0; i < work->out->count; i++)
        if (work->out->rows[i].mutations == (a | b))
            return RESULT_OK; /* tried already */
    double single = fmax(explained_by(work, a), explained_by(work, b));
    bool visible;
    RenderDesc both = with_mutations(work, a | b);
    /* Another method's renderer obeys settings only. */
    if (a == b || mutation_excludes(id_of(a), id_of(b)) || (both.mutations && !obeys(both.method)))
        return RESULT_OK;
    Result result = try_mutations(work, a | b, "two of the best", &visible);
    if (result != RESULT_OK || !visible)
        return result;
    /* One that adds nothing is dropped; its file may stay among those kept: it is as good as
     * another's. */
    DiagnoseRow *row = &work->out->rows[work->out->count - 1];
    if (row->beyond > 0 && row->explains < single + PAIR_GAIN)
        row->mutations = 0;
    return RESULT_OK;
}

static void drop_rows(Diagnosis *out)
{
    size_t left = 0;
    for (size_t i = 0; i < out->count; i++)
        if (out->rows[i].mutations)
            out->rows[left++] = out->rows[i];
    out->count = left;
}

/* Pixels that the first row leaves unexplained: a byte each. False when its file was not kept. */
static bool mark_left(const Work *work, const DiagnoseRow *row, uint8_t *left)
{
    for (int i = 0; i < work->kept_count; i++) {
        const Image *predicted = &work->kept[i].predicted;
        if (work->out->rows[work->kept[i].row].group != row->group)
            continue;
        for (int y = 0; y < predicted->height; y++)
            for (int x = 0; x < predicted->width; x++)
                *left++ = fit_residual(&work->fit, &row->form, predicted, x, y) > 0.0;
        return true;
    }
    return false;
}

/* The mistakes that change what is left, the likest first; returns how many. */
static int choose_partners(const Work *work, const uint8_t *left, uint64_t partners[PARTNERS])
{
    double likeness[PARTNERS] = {0};
    int count = 0;
    for (int id = 0; id < MUTATION_COUNT; id++) {
        double like = changes_likeness(&work->changes, (MutationId)id, left);
        int place = count < PARTNERS ? count++ : PARTNERS;
        for (; place > 0 && likeness[place - 1] < like; place--)
            if (place < PARTNERS) {
                likeness[place] = likeness[place - 1];
                partners[place] = partners[place - 1];
            }
        if (place < PARTNERS) {
            likeness[place] = like;
            partners[place] = mutation_bit((MutationId)id);
        }
    }
    return count;
}

/* sorted: the single mistakes by rank. Each of the best file's with what may complete it. */
static Result try_partners(Work *work, const DiagnoseRow *sorted, int count)
{
    uint64_t partners[PARTNERS];
    uint8_t *left = memory_array(work->changes.pixels, 1);
    if (!left)
        return RESULT_NO_MEMORY;
    int partner_count =
        mark_left(work, &sorted[0], left) ? choose_partners(work, left, partners) : 0;
    Result result = RESULT_OK;
    for (int i = 0; i < count && i < PAIRED && sorted[i].group == sorted[0].group; i++)
        for (int j = 0; j < partner_count && result == RESULT_OK; j++)
            result = try_pair(work, sorted[i].mutations, partners[j]);
    free(left);
    return result;
}

/* Where no single mistake explains all. */
static Result try_pairs(Work *work)
{
    int count = (int)work->out->count;
    DiagnoseRow *sorted = memory_array((size_t)count, sizeof *sorted);
    Result result = RESULT_OK;
    if (!sorted)
        return RESULT_NO_MEMORY;
    memcpy(sorted, work->out->rows, (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, compare_rows);
    progress_context("pairs of mistakes");
    if (count > 1 && sorted[0].beyond > 0)
        result = try_partners(work, sorted, count);
    for (int i = 0; i < count && i < PAIRED && sorted[0].beyond > 0; i++)
        for (int j = i + 1; j < count && j < PAIRED && result == RESULT_OK; j++)
            result = try_pair(work, sorted[i].mutations, sorted[j].mutations);
    progress_context(NULL);
    free(sorted);
    return result;
}

/* ---- the verdict ----------------------------------------------------------------------------- */

static bool equals(const DiagnoseRow *a, const DiagnoseRow *b)
{
    if (a->beyond == 0 || b->beyond == 0)
        return a->beyond == b->beyond;
    return a->group == b->group || (a->squares == 0.0 && b->squares == 0.0);
}

static void rank(Diagnosis *out)
{
    drop_rows(out);
    qsort(out->rows, out->count, sizeof *out->rows, compare_rows);
    for (size_t i = 0; i < out->count; i++) {
        DiagnoseRow *row = &out->rows[i];
        if (row->beyond == 0)
            row->explains = 1.0;
        row->rank = i > 0 && equals(&row[-1], row) ? row[-1].rank : (int)i + 1;
        out->equals += row->rank == 1;
    }
}

static void decide(Work *work)
{
    Diagnosis *out = work->out;
    const FitResult *none = &work->none;
    const DiagnoseRow *best = out->count ? &out->rows[0] : NULL;
    /* Where the reference fits, what fits as well cannot be told from it. */
    for (size_t i = 0; none->beyond == 0 && i < out->count && out->rows[i].beyond == 0; i++)
        out->invisible |= out->rows[i].mutations;
    if (none->beyond == 0)
        out->reason = DIAGNOSE_QUANTISED;
    else if (best && best->beyond == 0)
        out->reason = DIAGNOSE_EXACT;
    else if (fit_tolerates(&work->fit, none, false))
        out->reason = DIAGNOSE_TOLERATED;
    else if (best && best->explains >= DIAGNOSE_EXPLAINS)
        out->reason = DIAGNOSE_NEARLY;
    else
        out->reason = fit_tolerates(&work->fit, none, true) ? DIAGNOSE_COLORS : DIAGNOSE_NOTHING;
    out->verdict = out->reason == DIAGNOSE_NOTHING ? DIAGNOSE_UNKNOWN
                   : out->reason == DIAGNOSE_EXACT || out->reason == DIAGNOSE_NEARLY
                       ? DIAGNOSE_MISTAKE
                       : DIAGNOSE_AGREES;
    out->form = out->verdict == DIAGNOSE_MISTAKE ? best->form : none->form;
}

/* ---- the evidence ---------------------------------------------------------------------------- */

static Result render_row(Work *work, size_t row, Image *final, FitRendering *out)
{
    uint64_t mutations = work->out->rows[row].mutations;
    RenderDesc desc = with_mutations(work, mutations);
    *out = rendering_of(mutations, final);
    return render(work, &desc, "evidence", final);
}

/* The best is told from the next that is not its equal, or from the reference. */
static Result gather(Work *work)
{
    Diagnosis *out = work->out;
    Image images[2] = {{0}, {0}};
    FitRendering reference = {&work->final, false}, best = reference, second = reference;
    bool explained =
        out->verdict != DIAGNOSE_AGREES && out->count > 0 && out->rows[0].explains > 0.0;
    out->second = out->equals;
    out->has_second =
        explained && out->second < out->count && out->rows[out->second].explains > 0.0;
    Result result = explained ? render_row(work, 0, &images[0], &best) : RESULT_OK;
    if (result == RESULT_OK && out->has_second)
        result = render_row(work, out->second, &images[1], &second);
    if (result == RESULT_OK)
        result = evidence_gather(&work->fit, &reference, &best, &second, out);
    image_free(&images[0]);
    image_free(&images[1]);
    return result;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static Result check(const RenderDesc *desc, const GivenImage *given, const GivenMeaning *options)
{
    if (desc->mutations || !obeys(desc->method))
        return result_fail(RESULT_BAD_INPUT, "diagnose: the catalogue of mistakes is of depth "
                                             "peeling, expected --method peel or forward");
    if (given->stored.width != desc->width || given->stored.height != desc->height)
        return result_fail(RESULT_INTERNAL, "diagnose: expected an image of the size rendered");
    return given_check_alpha(options, given->has_alpha);
}

static void describe(Work *work)
{
    GivenReading reading = {.meaning = work->out->form};
    given_describe(work->fit.given, &reading, work->out->described, sizeof work->out->described);
}

static Result run(Work *work)
{
    Diagnosis *out = work->out;
    out->rows = memory_array(ROWS, sizeof *out->rows);
    Result result = out->rows ? changes_create(out->pixels, &work->changes) : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = render(work, &work->desc, "reference", &work->final);
    FitRendering reference = {&work->final, false};
    if (result == RESULT_OK)
        result = fit_reference(&work->fit, &reference, &work->none);
    if (result == RESULT_OK)
        result = fit_predict(&work->fit, &reference, &work->none.form, &work->predicted);
    if (result == RESULT_OK)
        result = try_singles(work);
    if (result == RESULT_OK && work->none.beyond > 0)
        result = try_pairs(work);
    if (result != RESULT_OK)
        return result;
    out->beyond = work->none.beyond;
    out->over = work->none.over;
    out->far = work->none.far;
    rank(out);
    decide(work);
    describe(work);
    return gather(work);
}

static void release(Work *work)
{
    fit_free(&work->fit);
    changes_free(&work->changes);
    image_free(&work->final);
    image_free(&work->predicted);
    for (int i = 0; i < work->kept_count; i++)
        image_free(&work->kept[i].predicted);
}

Result diagnose_run(const Scene *scene, const RenderDesc *desc, const GivenImage *given,
                    const GivenMeaning *options, Renderer ref, Diagnosis *out)
{
    *out = (Diagnosis){.format = given->stored.format,
                       .nonfinite = given->nonfinite,
                       .pixels = (uint64_t)desc->width * (uint64_t)desc->height};
    Result result = check(desc, given, options);
    if (result != RESULT_OK)
        return result;
    Clock start = clock_now();
    double cpu_ms;
    Work work = {.scene = scene, .desc = *desc, .ref = ref, .out = out};
    Pool *pool = pool_create(desc->threads);
    result = pool ? fit_create(given, options, pool, &work.fit) : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = run(&work);
    release(&work);
    pool_destroy(pool);
    clock_elapsed(&start, &out->time_ms, &cpu_ms);
    if (result != RESULT_OK)
        diagnose_free(out);
    return result;
}

void diagnose_free(Diagnosis *diagnosis)
{
    free(diagnosis->rows);
    image_free(&diagnosis->theirs);
    image_free(&diagnosis->reference);
    image_free(&diagnosis->best);
    free(diagnosis->classes);
    *diagnosis = (Diagnosis){0};
}

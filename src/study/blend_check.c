#include "study/blend_check.h"

#include "base/memory.h"
#include "base/pool.h"
#include "study/blend_fit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    CHUNK = 4096,   /* vectors that a task takes at a time */
    RULE_PARTS = 8, /* tasks for the rules */
    STEP = 64,      /* vectors between looks whether an arithmetic without a name still fits */
    FIRST = 256,    /* vectors after which most arithmetics without a name are out */
    FITS = 8,       /* arithmetics without a name that are kept after that: the simplest */
    /* An arithmetic that differs in a sixteenth of all values after so many vectors is no
     * candidate any more. */
    ENOUGH = 1 << 17,
    QUICK = 1 << 13,
    FAR_OFF = 16
};

struct BlendCheck {
    BlendCheckDesc desc;
    BlendReport report;
    Pool *pool;
    unsigned char *scratch; /* CHUNK pixels for each worker */
    BlendRuleTally (*parts)[BLEND_RULES];
    /* Of the call in progress: */
    VectorSet set;
    uint64_t index;
    size_t count;
    const float (*source)[4];
    const unsigned char *destination, *results;
};

/* ---- one arithmetic -------------------------------------------------------------------------- */

static bool is_simpler(const BlendExample *a, const BlendExample *b)
{
    return a->complexity < b->complexity || (a->complexity == b->complexity && a->index < b->index);
}

/* Keeps the list of the worst in order: farthest first, then simplest. */
static void keep_worst(BlendCandidate *candidate, int most, const BlendExample *example)
{
    int at = candidate->worst_count;
    while (at > 0 && (example->ulp > candidate->worst[at - 1].ulp ||
                      (example->ulp == candidate->worst[at - 1].ulp &&
                       is_simpler(example, &candidate->worst[at - 1]))))
        at--;
    if (at >= most)
        return;
    int moved = candidate->worst_count < most ? candidate->worst_count - at : most - 1 - at;
    memmove(&candidate->worst[at + 1], &candidate->worst[at], (size_t)moved * sizeof *example);
    candidate->worst[at] = *example;
    candidate->worst_count += candidate->worst_count < most;
}

static void note(const BlendCheck *check, BlendCandidate *candidate, size_t i, int channel,
                 BlendExample *example)
{
    size_t bytes = format_pixel_bytes(check->desc.format);
    BlendCase one = {&check->report.equation,
                     check->desc.format,
                     channel,
                     check->source[i],
                     check->destination + i * bytes,
                     false};
    bool first =
        candidate->groups[GROUP_COLOR].differing + candidate->groups[GROUP_ALPHA].differing == 1;
    example->set = check->set;
    example->index = check->index + i;
    example->channel = channel;
    example->complexity = blend_case_complexity(&one);
    bool simpler = first || is_simpler(example, &candidate->simplest);
    bool worse =
        candidate->worst_count < check->desc.worst ||
        (check->desc.worst > 0 && example->ulp >= candidate->worst[candidate->worst_count - 1].ulp);
    if (!simpler && !worse)
        return;
    memcpy(example->source, one.source, sizeof example->source);
    memcpy(example->pixel, one.pixel, bytes);
    if (simpler)
        candidate->simplest = *example;
    if (worse)
        keep_worst(candidate, check->desc.worst, example);
}

/* A pixel that is not the expected one. */
static void compare_pixel(const BlendCheck *check, BlendCandidate *candidate, size_t i,
                          const void *expected, const void *got)
{
    const FormatInfo *info = format_info(check->desc.format);
    for (int k = 0; k < info->channels; k++) {
        BlendExample example = {.expected = format_bits(check->desc.format, expected, k),
                                .got = format_bits(check->desc.format, got, k)};
        example.ulp = format_ulp(info->kind, example.expected, example.got);
        if (example.ulp == 0)
            continue;
        BlendTally *tally = &candidate->groups[k == 3 ? GROUP_ALPHA : GROUP_COLOR];
        tally->differing++;
        tally->max_ulp = example.ulp > tally->max_ulp ? example.ulp : tally->max_ulp;
        note(check, candidate, i, k, &example);
    }
}

static void compare_some(const BlendCheck *check, BlendCandidate *candidate, size_t first,
                         size_t count, unsigned char *pixels)
{
    const FormatInfo *info = format_info(check->desc.format);
    size_t bytes = format_pixel_bytes(check->desc.format);
    memcpy(pixels, check->destination + first * bytes, count * bytes);
    arithmetic_blend(&candidate->arithmetic, &check->report.equation, check->desc.format, count,
                     check->source + first, pixels);
    for (size_t i = 0; i < count; i++) {
        const unsigned char *got = check->results + (first + i) * bytes;
        if (memcmp(pixels + i * bytes, got, bytes) != 0)
            compare_pixel(check, candidate, first + i, pixels + i * bytes, got);
    }
    int alpha = info->channels == 4;
    candidate->groups[GROUP_COLOR].values += (uint64_t)(info->channels - alpha) * count;
    candidate->groups[GROUP_ALPHA].values += (uint64_t)alpha * count;
    candidate->vectors += count;
}

/* Whether every group differs in at least 1 of `share` values, and in one at all. */
static bool differs(const BlendCandidate *candidate, uint64_t share)
{
    for (int i = 0; i < GROUP_COUNT; i++) {
        const BlendTally *tally = &candidate->groups[i];
        if (tally->values && (!tally->differing || tally->differing < tally->values / share))
            return false;
    }
    return candidate->vectors > 0;
}

static bool is_fit(const BlendReport *report, const BlendCandidate *candidate)
{
    return !candidate->info && !(report->has_against && candidate == report->candidates);
}

static Result compare_task(const BlendCheck *check, BlendCandidate *candidate,
                           unsigned char *pixels)
{
    bool against = check->report.has_against && candidate == check->report.candidates;
    bool fitted = is_fit(&check->report, candidate);
    if (candidate->refused || candidate->stopped)
        return RESULT_OK;
    size_t step = fitted && candidate->vectors == 0 ? STEP : CHUNK;
    for (size_t at = 0; at < check->count; at += step) {
        size_t count = check->count - at < step ? check->count - at : step;
        compare_some(check, candidate, at, count, pixels);
        if (fitted && differs(candidate, UINT64_MAX))
            candidate->stopped = true;
        if (!fitted && candidate->vectors >= ENOUGH && !against && !check->desc.every &&
            differs(candidate, FAR_OFF))
            candidate->stopped = true;
        if (candidate->stopped)
            break;
    }
    return RESULT_OK;
}

/* ---- all of them ----------------------------------------------------------------------------- */

static Result judge_task(const BlendCheck *check, uint32_t part)
{
    const FormatInfo *info = format_info(check->desc.format);
    size_t bytes = format_pixel_bytes(check->desc.format);
    size_t from = check->count * part / RULE_PARTS, to = check->count * (part + 1) / RULE_PARTS;
    for (size_t i = from; i < to; i++)
        for (int k = 0; k < info->channels; k++) {
            BlendCase one = {&check->report.equation,
                             check->desc.format,
                             k,
                             check->source[i],
                             check->destination + i * bytes,
                             false};
            uint32_t got = format_bits(check->desc.format, check->results + i * bytes, k);
            blend_rules_add(&one, (BlendPlace){check->set, check->index + i}, got,
                            check->parts[part]);
        }
    return RESULT_OK;
}

static Result run_task(void *context, uint32_t index, int worker)
{
    const BlendCheck *check = context;
    if (index < RULE_PARTS)
        return judge_task(check, index);
    size_t scratch = CHUNK * format_pixel_bytes(check->desc.format);
    return compare_task(check, &check->report.candidates[index - RULE_PARTS],
                        check->scratch + (size_t)worker * scratch);
}

static void init_candidate(const BlendCheckDesc *desc, const ArithmeticInfo *info,
                           const Arithmetic *arithmetic, BlendCandidate *out)
{
    *out = (BlendCandidate){.info = info, .arithmetic = *arithmetic};
    if (info)
        snprintf(out->name, sizeof out->name, "%s", info->name);
    else
        arithmetic_print(arithmetic, out->name);
    out->refused = arithmetic_refuses(arithmetic, &desc->equation, desc->format);
}

static Result list_candidates(BlendCheck *check)
{
    const BlendCheckDesc *desc = &check->desc;
    BlendReport *report = &check->report;
    Arithmetic *fits;
    size_t fit_count, at = 0;
    Result result = blend_fit_list(&desc->equation, desc->format, &fits, &fit_count);
    if (result != RESULT_OK)
        return result;
    report->has_against = desc->against != NULL;
    report->count = report->has_against + arithmetic_count() + fit_count;
    report->candidates = memory_array(report->count, sizeof *report->candidates);
    if (report->candidates) {
        if (desc->against)
            init_candidate(desc, blend_fit_name(desc->against), desc->against,
                           &report->candidates[at++]);
        for (size_t i = 0; i < arithmetic_count(); i++)
            init_candidate(desc, arithmetic_info(i), &arithmetic_info(i)->arithmetic,
                           &report->candidates[at++]);
        for (size_t i = 0; i < fit_count; i++)
            init_candidate(desc, NULL, &fits[i], &report->candidates[at++]);
        for (size_t i = 0; i < report->count && result == RESULT_OK; i++) {
            BlendCandidate *candidate = &report->candidates[i];
            candidate->worst = memory_array((size_t)desc->worst + 1, sizeof *candidate->worst);
            result = candidate->worst ? RESULT_OK : RESULT_NO_MEMORY;
        }
    }
    free(fits);
    return report->candidates ? result : RESULT_NO_MEMORY;
}

Result blend_check_open(const BlendCheckDesc *desc, BlendCheck **out)
{
    BlendCheck *check = *out = memory_array(1, sizeof *check);
    if (!check)
        return RESULT_NO_MEMORY;
    check->desc = *desc;
    check->report.format = desc->format;
    check->report.equation = desc->equation;
    check->pool = pool_create(desc->threads);
    if (!check->pool)
        return RESULT_NO_MEMORY;
    check->scratch =
        memory_array((size_t)pool_threads(check->pool) * CHUNK, format_pixel_bytes(desc->format));
    check->parts = memory_array(RULE_PARTS, sizeof *check->parts);
    if (!check->scratch || !check->parts)
        return RESULT_NO_MEMORY;
    blend_rules_start(desc->format, check->report.rules);
    return list_candidates(check);
}

/* Whether the candidate explains a group that no named one does. */
static bool adds(const BlendReport *report, size_t candidate)
{
    for (int group = 0; group < GROUP_COUNT; group++) {
        bool named = false;
        for (size_t i = 0; i < report->count && !named; i++)
            named = report->candidates[i].info && blend_explains(report, i, (BlendGroup)group);
        if (!named && blend_explains(report, candidate, (BlendGroup)group))
            return true;
    }
    return false;
}

/* Those without a name stay only where they explain something (named: that no named one explains),
 * and the first `most` of them. */
static void drop_unfit(BlendReport *report, size_t most, bool named)
{
    size_t kept = 0, fits = 0;
    for (size_t i = 0; i < report->count; i++) {
        BlendCandidate *candidate = &report->candidates[i];
        bool fit = is_fit(report, candidate);
        if (fit && (fits == most || (named && !adds(report, i)) ||
                    (!blend_explains(report, i, GROUP_COLOR) &&
                     !blend_explains(report, i, GROUP_ALPHA)))) {
            free(candidate->worst);
            continue;
        }
        fits += fit;
        if (kept != i)
            report->candidates[kept] = *candidate;
        kept++;
    }
    report->count = kept;
}

/* Where a right arithmetic gives all so far: stops those that do not, or have no name. */
static void stop_others(BlendReport *report)
{
    size_t best = blend_best_whole(report);
    const ArithmeticInfo *info = report->candidates[best].info;
    if (!info || arithmetic_is_wrong(info, report->format) || blend_unexplained(report) > 0)
        return;
    for (size_t i = 0; i < report->count; i++) {
        BlendCandidate *one = &report->candidates[i];
        one->stopped |= !one->info || one->groups[GROUP_COLOR].differing > 0 ||
                        one->groups[GROUP_ALPHA].differing > 0;
    }
}

static Result add_some(BlendCheck *check, uint64_t index, size_t count, const float (*source)[4],
                       const unsigned char *destination, const unsigned char *results)
{
    check->index = index;
    check->count = count;
    check->source = source;
    check->destination = destination;
    check->results = results;
    for (int i = 0; i < RULE_PARTS; i++)
        blend_rules_start(check->desc.format, check->parts[i]);
    Result result =
        pool_run(check->pool, RULE_PARTS + (uint32_t)check->report.count, run_task, check);
    for (int i = 0; i < RULE_PARTS; i++)
        blend_rules_merge(check->report.rules, check->parts[i]);
    check->report.vectors += count;
    if (result == RESULT_OK && check->desc.quick && check->report.vectors >= QUICK)
        stop_others(&check->report);
    return result;
}

Result blend_check_add(BlendCheck *check, VectorSet set, uint64_t index, size_t count,
                       const float (*source)[4], const void *destination, const void *results)
{
    check->set = set;
    size_t bytes = format_pixel_bytes(check->desc.format), first = 0;
    Result result = RESULT_OK;
    if (check->report.vectors == 0) {
        first = count < FIRST ? count : FIRST;
        result = add_some(check, index, first, source, destination, results);
        drop_unfit(&check->report, FITS, false);
    }
    if (result != RESULT_OK || first == count)
        return result;
    return add_some(check, index + first, count - first, source + first,
                    (const unsigned char *)destination + first * bytes,
                    (const unsigned char *)results + first * bytes);
}

void blend_check_finish(BlendCheck *check, BlendReport *out)
{
    drop_unfit(&check->report, FITS, true);
    *out = check->report;
    check->report.candidates = NULL;
    check->report.count = 0;
}

void blend_report_free(BlendReport *report)
{
    for (size_t i = 0; i < report->count; i++)
        free(report->candidates[i].worst);
    free(report->candidates);
    *report = (BlendReport){0};
}

void blend_check_close(BlendCheck *check)
{
    if (!check)
        return;
    blend_report_free(&check->report);
    pool_destroy(check->pool);
    free(check->scratch);
    free(check->parts);
    free(check);
}

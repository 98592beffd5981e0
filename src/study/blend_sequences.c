#include "study/blend_sequences.h"

#include "base/memory.h"

#include <stdlib.h>

Result sequence_report_start(PixelFormat format, SequenceReport *out)
{
    BlendEquation under = equation_info(EQUATION_UNDER)->equation;
    *out = (SequenceReport){.format = format, .count = arithmetic_count()};
    out->candidates = memory_array(out->count, sizeof *out->candidates);
    if (!out->candidates)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < out->count; i++) {
        const ArithmeticInfo *info = arithmetic_info(i);
        out->candidates[i].info = info;
        out->candidates[i].refused = arithmetic_refuses(&info->arithmetic, &under, format);
    }
    return RESULT_OK;
}

void sequence_report_free(SequenceReport *report)
{
    free(report->candidates);
    *report = (SequenceReport){0};
}

static void compare(const SequenceReport *report, SequenceCandidate *candidate, int layers,
                    const float (*source)[4], const unsigned char *pixels, const bool *given)
{
    const FormatInfo *info = format_info(report->format);
    size_t bytes = format_pixel_bytes(report->format);
    unsigned char expected[SEQUENCE_LAYERS_MAX * 16];
    sequence_blend(&candidate->info->arithmetic, report->format, layers, source, expected);
    for (int i = 0; i < layers; i++)
        for (int k = 0; k < info->channels && given[i]; k++) {
            size_t at = (size_t)i * bytes;
            uint32_t ulp = format_ulp(info->kind, format_bits(report->format, expected + at, k),
                                      format_bits(report->format, pixels + at, k));
            candidate->values++;
            candidate->differing += ulp != 0;
            candidate->max_ulp = ulp > candidate->max_ulp ? ulp : candidate->max_ulp;
        }
}

/* One channel of the last pixel against the bound and the rounded result. */
static void judge(SequenceReport *report, const SequenceExample *one, bool inside)
{
    report->values++;
    report->rounded += one->ulp == 0;
    bool first = !inside && report->outside == 0;
    report->outside += !inside;
    if (!report->has_worst || first ||
        (inside == (report->outside == 0) && one->ulp > report->worst.ulp))
        report->worst = *one;
    report->has_worst = true;
}

Result sequence_report_add(SequenceReport *report, uint64_t index, int layers,
                           const float (*source)[4], const void *pixels, const bool *given)
{
    const FormatInfo *info = format_info(report->format);
    const unsigned char *last =
        (const unsigned char *)pixels + (size_t)(layers - 1) * format_pixel_bytes(report->format);
    unsigned char rounded[16];
    double low[4], high[4];
    Rational exact[4];
    for (int k = 0; k < 4; k++)
        rational_init(&exact[k]);
    sequence_exact(report->format, layers, source, exact);
    sequence_round(report->format, exact, rounded);
    sequence_bound(report->format, layers, source, low, high);
    for (int k = 0; k < 4; k++)
        rational_clear(&exact[k]);
    for (int k = 0; k < info->channels; k++) {
        SequenceExample one = {.index = index,
                               .layers = layers,
                               .channel = k,
                               .low = low[k],
                               .high = high[k],
                               .rounded = format_bits(report->format, rounded, k),
                               .got = format_bits(report->format, last, k)};
        one.ulp = format_ulp(info->kind, one.rounded, one.got);
        judge(report, &one, sequence_inside(report->format, last, k, low, high));
    }
    for (size_t i = 0; i < report->count; i++)
        if (!report->candidates[i].refused)
            compare(report, &report->candidates[i], layers, source, pixels, given);
    report->sequences++;
    return RESULT_OK;
}

size_t sequence_report_best(const SequenceReport *report)
{
    size_t best = SIZE_MAX;
    for (size_t i = report->count; i-- > 0;) {
        const SequenceCandidate *one = &report->candidates[i];
        bool gives_all = !one->refused && one->values > 0 && one->differing == 0;
        if (gives_all && (best == SIZE_MAX || !arithmetic_is_wrong(one->info, report->format) ||
                          arithmetic_is_wrong(report->candidates[best].info, report->format)))
            best = i;
    }
    return best;
}

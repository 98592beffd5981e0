/* The text: the lines that idiff 2.4 prints come first, in its words, so that scripts which read
 * them go on working. */
#include "report/diff.h"

#include "number/numeral.h"
#include "report/summary.h"

#include <math.h>
#include <string.h>

/* Identifiers have more digits than a float. */
static const char *value_text(const char *kind, double value, char out[SUMMARY_NUMBER])
{
    if (strcmp(kind, "uint") != 0)
        return numeral_float(value, out);
    snprintf(out, SUMMARY_NUMBER, "%.0f", value);
    return out;
}

static void print_values(const DiffPart *part, const DiffPixel *pixel, FILE *out)
{
    char number[SUMMARY_NUMBER];
    for (int side = 0; side < DIFF_SIDES; side++) {
        fputs(side ? " vs" : "", out);
        const char *separator = side ? " " : "";
        for (int c = 0; c < part->channel_count; c++) {
            if (!part->channels[c].kinds[side])
                continue;
            fprintf(out, "%s%s", separator,
                    value_text(part->channels[c].kinds[side], pixel->values[side][c], number));
            separator = ", ";
        }
    }
}

static void print_over(uint64_t count, const DiffPart *part, double threshold, FILE *out)
{
    fprintf(out, "  %llu pixels (%.3g%%) over %g\n", (unsigned long long)count,
            100.0 * (double)count / (double)part->pixels, threshold);
}

static void print_figures(const DiffPart *part, const DiffOptions *options, FILE *out)
{
    fprintf(out, "  Mean error = %g\n  RMS error = %g\n  Peak SNR = %g\n  Max error  = %g",
            fabs(part->mean), fabs(part->rms), fabs(part->psnr), part->max);
    if (part->max > 0.0) {
        fprintf(out, " @ (%d, %d, %s)", part->x + part->max_at.x, part->y + part->max_at.y,
                part->channels[part->max_at.channel].name);
        fputs("  values are ", out);
        print_values(part, &part->max_at, out);
    }
    fputc('\n', out);
    print_over(part->over_warn, part, options->warn.absolute, out);
    print_over(part->over_fail, part, options->fail.absolute, out);
    if (part->perceived)
        fprintf(out, "  %llu pixels (%3.3g%%) failed the perceptual test\n",
                (unsigned long long)part->seen, 100.0 * (double)part->seen / (double)part->pixels);
}

/* ---- what idiff does not say ---- */

/* How many bins have to be shown so that none with a value is left out. */
static int used_bins(const DiffPart *part)
{
    int used = 1;
    for (int c = 0; c < part->channel_count; c++)
        for (int bin = used; bin < DIFF_BINS; bin++)
            if (part->channels[c].bins[bin])
                used = bin + 1;
    return used;
}

static void print_channel(const DiffPart *part, const DiffChannel *channel, FILE *out)
{
    char kinds[SUMMARY_NUMBER], place[SUMMARY_NUMBER] = "-", number[SUMMARY_NUMBER];
    const char *a = channel->kinds[0], *b = channel->kinds[1];
    if (a && b && strcmp(a, b) == 0)
        snprintf(kinds, sizeof kinds, "%s", a);
    else
        snprintf(kinds, sizeof kinds, "%s/%s", a ? a : "-", b ? b : "-");
    if (channel->has_max)
        snprintf(place, sizeof place, "%d, %d", part->x + channel->max_x, part->y + channel->max_y);
    fprintf(out, "  %-12s %-13s %11.5g %11.5g %8.4g %11.5g %12s %11s", channel->name, kinds,
            fabs(channel->mean), fabs(channel->rms), fabs(channel->psnr), channel->max, place,
            summary_count(channel->differing, number));
    if (!channel->has_ulp)
        fprintf(out, " %13s", "-");
    else
        fprintf(out, " %13s", summary_count(channel->max_ulp, number));
    for (int bin = 0; bin < used_bins(part) && channel->has_ulp; bin++)
        fprintf(out, " %10s", summary_count(channel->bins[bin], number));
    fputc('\n', out);
}

static void print_channels(const DiffPart *part, FILE *out)
{
    fprintf(out, "  %-12s %-13s %11s %11s %8s %11s %12s %11s %13s", "channel", "stored as", "mean",
            "RMS", "PSNR", "max", "@", "differing", "max ULP");
    for (int bin = 0; bin < used_bins(part); bin++)
        fprintf(out, " %10s", diff_bin_text(bin));
    fputc('\n', out);
    for (int c = 0; c < part->channel_count; c++)
        print_channel(part, &part->channels[c], out);
}

static void print_nonfinite(const DiffPart *part, FILE *out)
{
    char number[SUMMARY_NUMBER];
    for (int c = 0; c < part->channel_count; c++) {
        const DiffChannel *channel = &part->channels[c];
        uint64_t all = 0;
        for (int side = 0; side < DIFF_SIDES; side++)
            all += channel->nan[side] + channel->infinite[side];
        if (!all)
            continue;
        fprintf(out, "  Not finite: %s: %s NaN", channel->name,
                summary_count(channel->nan[0], number));
        fprintf(out, " and %s infinite vs", summary_count(channel->infinite[0], number));
        fprintf(out, " %s NaN", summary_count(channel->nan[1], number));
        fprintf(out, " and %s infinite\n", summary_count(channel->infinite[1], number));
    }
    if (part->broken > part->counts_differ)
        fprintf(out, "  %s pixels are not finite, and not alike: a failure\n",
                summary_count(part->broken - part->counts_differ, number));
}

static void print_deep(const DiffPart *part, FILE *out)
{
    char a[SUMMARY_NUMBER], b[SUMMARY_NUMBER];
    if (!part->deep)
        return;
    fprintf(out, "  Samples: %s vs %s", summary_count(part->samples[0], a),
            summary_count(part->samples[1], b));
    if (!part->counts_differ)
        fprintf(out, ", as many in every pixel\n");
    else
        fprintf(out, "; %s pixels have another number: a failure; first @ (%d, %d): %u vs %u\n",
                summary_count(part->counts_differ, a), part->count_at[0], part->count_at[1],
                part->counts_there[0], part->counts_there[1]);
}

static void print_worst(const ReportDiff *diff, const DiffPart *part, FILE *out)
{
    bool classes = diff->budget && part == &diff->report->parts[diff->report->pictured];
    char error[SUMMARY_NUMBER], ulp[SUMMARY_NUMBER];
    if (!part->worst_count)
        return;
    fprintf(out, "  %-12s %-12s %11s %13s  %s%s\n", "worst @", "channel", "error", "ULP",
            classes ? "class            " : "", "values");
    for (int i = 0; i < part->worst_count; i++) {
        const DiffPixel *pixel = &part->worst[i];
        char place[SUMMARY_NUMBER];
        snprintf(place, sizeof place, "%d, %d", part->x + pixel->x, part->y + pixel->y);
        fprintf(out, "  %-12s %-12s %11s %13s  ", place,
                pixel->counts ? "samples" : part->channels[pixel->channel].name,
                pixel->counts         ? "count"
                : isinf(pixel->error) ? "not finite"
                                      : numeral_float(pixel->error, error),
                pixel->has_ulp ? summary_count(pixel->ulp, ulp) : "-");
        if (classes) {
            size_t at = (size_t)pixel->y * (size_t)part->width + (size_t)pixel->x;
            fprintf(out, "%-17s", class_key((PixelClass)diff->budget->classes[at]));
        }
        print_values(part, pixel, out);
        fputc('\n', out);
    }
}

static void print_missing_channels(const ReportDiff *diff, const DiffPart *part, FILE *out)
{
    for (int side = 0; side < DIFF_SIDES; side++) {
        const char *separator = "";
        for (int c = 0; c < part->channel_count; c++)
            if (!part->channels[c].kinds[side]) {
                fprintf(out, "%s%s",
                        *separator ? separator
                                   : "  Channels that read as 0, being "
                                     "in one file only: ",
                        part->channels[c].name);
                separator = ", ";
            }
        if (*separator)
            fprintf(out, " of \"%s\"; --channels leaves them out\n", diff->report->paths[side]);
    }
}

/* Whether they differ or not: what a verdict is not of. */
static void print_not_compared(const ReportDiff *diff, FILE *out)
{
    const DiffReport *report = diff->report;
    for (size_t i = 0; i < report->count; i++)
        for (int side = 0; side < DIFF_SIDES; side++)
            if (report->parts[i].not_compared[side])
                fprintf(out, "Not compared: %s of \"%s\"\n", report->parts[i].not_compared[side],
                        report->paths[side]);
}

/* ---- parts ---- */

static void print_part(const ReportDiff *diff, const DiffPart *part, FILE *out)
{
    const DiffReport *report = diff->report;
    if (report->all) {
        fprintf(out, "Subimage %d%s%s : ", (int)(part - report->parts), *part->name ? " " : "",
                part->name);
        if (part->lacks[0] || part->lacks[1]) {
            fprintf(out, "only \"%s\" has it\n", report->paths[part->lacks[0]]);
            return;
        }
        fprintf(out, "%d x %d, %d channels\n", part->width, part->height, part->channel_count);
    }
    print_figures(part, &diff->options->diff, out);
    print_missing_channels(diff, part, out);
    print_channels(part, out);
    print_nonfinite(part, out);
    print_deep(part, out);
    print_worst(diff, part, out);
}

static void print_buffer(const DiffReport *report, const DiffPart *part, FILE *out)
{
    char number[SUMMARY_NUMBER];
    uint32_t max_ulp = 0;
    for (int c = 0; c < part->channel_count; c++)
        max_ulp = part->channels[c].max_ulp > max_ulp ? part->channels[c].max_ulp : max_ulp;
    fprintf(out, "  %-34s", part->name);
    if (part->lacks[0] || part->lacks[1]) {
        fprintf(out, " only \"%s\" has it\n", report->paths[part->lacks[0]]);
        return;
    }
    fprintf(out, " %15s", summary_count(part->values, number));
    fprintf(out, " %13s", summary_count(part->differing_values, number));
    fprintf(out, " %13s", summary_count(max_ulp, number));
    fprintf(out, " %11.5g  %d, %d, %s\n", part->max, part->first[0], part->first[1],
            part->channels[part->first[2]].name);
}

static bool differs(const DiffPart *part)
{
    return part->differing || part->lacks[0] || part->lacks[1];
}

/* A row for each buffer that differs, and all about the first of them. */
static void print_trace(const ReportDiff *diff, FILE *out)
{
    const DiffReport *report = diff->report;
    size_t count = 0;
    if (report->first < 0)
        return;
    fprintf(out, "  %-34s %15s %13s %13s %11s  %s\n", "buffer", "values", "differing", "max ULP",
            "max error", "first: x, y, channel");
    for (size_t i = 0; i < report->count; i++)
        if (differs(&report->parts[i])) {
            print_buffer(report, &report->parts[i], out);
            count++;
        }
    fprintf(out, "First differing buffer: %s (%zu of %zu differ)\n",
            report->parts[report->first].name, count, report->count);
    print_part(diff, &report->parts[report->first], out);
}

/* ---- classes ---- */

void report_diff_classes(const ReportDiff *diff, uint64_t counts[CLASS_COUNT])
{
    const DiffPart *part = &diff->report->parts[diff->report->pictured];
    memset(counts, 0, CLASS_COUNT * sizeof *counts);
    for (size_t i = 0; i < part->pixels; i++)
        if (part->flags[i] & DIFF_DIFFERS)
            counts[diff->budget->classes[i]]++;
}

static void print_classes(const ReportDiff *diff, FILE *out)
{
    uint64_t counts[CLASS_COUNT];
    char number[SUMMARY_NUMBER], all[SUMMARY_NUMBER];
    report_diff_classes(diff, counts);
    fprintf(out, "  %-16s %11s %11s  %s\n", "class", "pixels", "in all",
            "of the differing pixels: why ref is not truth there");
    for (int i = 0; i < CLASS_COUNT; i++)
        if (counts[i])
            fprintf(out, "  %-16s %11s %11s  %s\n", class_key((PixelClass)i),
                    summary_count(counts[i], number), summary_count(diff->budget->counts[i], all),
                    class_text((PixelClass)i));
}

/* ---- the whole ---- */

static void print_parts(const ReportDiff *diff, bool verbose, FILE *out)
{
    const DiffReport *report = diff->report;
    bool failed = false;
    if (report->trace && !verbose) {
        print_trace(diff, out);
        return;
    }
    for (size_t i = 0; i < report->count; i++) {
        failed |= report->parts[i].verdict != DIFF_PASS; /* from then on all, as idiff has it */
        if (verbose || failed)
            print_part(diff, &report->parts[i], out);
    }
    if (report->first >= 0 && report->all)
        fprintf(out, "First differing subimage: %d %s\n", report->first,
                report->parts[report->first].name);
}

void report_diff_print(const ReportDiff *diff, bool verbose, FILE *out)
{
    static const char *const verdicts[] = {"PASS", "WARNING", "FAILURE"};
    const DiffReport *report = diff->report;
    bool lacking = false;
    for (size_t i = 0; i < report->count; i++)
        lacking |= report->parts[i].lacks[0] || report->parts[i].lacks[1];
    print_parts(diff, verbose, out);
    if (report->deep_differs)
        fprintf(out, "One image contains deep data, the other does not\n");
    print_not_compared(diff, out);
    if (report->left_out)
        fprintf(out, "Left out: %d *.primitive buffers, which only one trace has\n",
                report->left_out);
    if (report->all && report->part_counts[0] != report->part_counts[1] && lacking)
        fprintf(out, "Images had differing numbers of subimages (%d vs %d)\n",
                report->part_counts[0], report->part_counts[1]);
    if (!report->all && (report->part_counts[0] > 1 || report->part_counts[1] > 1))
        fprintf(out, "Only compared the first subimage (of %d and %d, respectively)\n",
                report->part_counts[0], report->part_counts[1]);
    if (diff->budget && report->pictured >= 0)
        print_classes(diff, out);
    fprintf(out, "%s\n", verdicts[report->verdict]);
}

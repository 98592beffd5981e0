/* The JSON document of `peel diff`: its keys are a contract; more may be added. */
#include "report/diff.h"

#include "report/document.h"

#include <math.h>

static json_t *pair_of_counts(uint64_t a, uint64_t b)
{
    return json_pack("[II]", (json_int_t)a, (json_int_t)b);
}

static json_t *text_or_null(const char *text)
{
    return text ? document_string(text) : json_null();
}

static json_t *channel_of(Document *json, const DiffPart *part, const DiffChannel *channel)
{
    json_t *one = json_object(), *bins = json_object();
    document_put(json, one, "name", document_string(channel->name));
    document_put(json, one, "stored_a", text_or_null(channel->kinds[0]));
    document_put(json, one, "stored_b", text_or_null(channel->kinds[1]));
    document_put(json, one, "values", document_count(channel->values));
    document_put(json, one, "differing", document_count(channel->differing));
    document_put(json, one, "nan", pair_of_counts(channel->nan[0], channel->nan[1]));
    document_put(json, one, "infinite", pair_of_counts(channel->infinite[0], channel->infinite[1]));
    document_put(json, one, "mean_error", document_real(channel->mean));
    document_put(json, one, "rms_error", document_real(channel->rms));
    document_put(json, one, "psnr", document_real(channel->psnr));
    document_put(json, one, "max_error", document_real(channel->max));
    document_put(json, one, "max_at",
                 channel->has_max
                     ? json_pack("[ii]", part->x + channel->max_x, part->y + channel->max_y)
                     : json_null());
    document_put(json, one, "max_ulp",
                 channel->has_ulp ? document_count(channel->max_ulp) : json_null());
    for (int bin = 0; bin < DIFF_BINS && channel->has_ulp; bin++)
        document_put(json, bins, diff_bin_text(bin), document_count(channel->bins[bin]));
    document_put(json, one, "ulp", bins);
    return one;
}

static json_t *values_of(Document *json, const DiffPart *part, const DiffPixel *pixel, int side)
{
    json_t *values = json_array();
    for (int c = 0; c < part->channel_count; c++)
        document_append(json, values,
                        part->channels[c].kinds[side] ? document_real(pixel->values[side][c])
                                                      : json_null());
    return values;
}

/* Null for what is not finite. */
static json_t *pixel_of(Document *json, const ReportDiff *diff, const DiffPart *part,
                        const DiffPixel *pixel)
{
    json_t *one = json_object();
    size_t at = (size_t)pixel->y * (size_t)part->width + (size_t)pixel->x;
    document_put(json, one, "at", json_pack("[ii]", part->x + pixel->x, part->y + pixel->y));
    document_put(json, one, "channel", document_string(part->channels[pixel->channel].name));
    if (part->deep)
        document_put(json, one, "sample", document_count(pixel->sample));
    document_put(json, one, "error", document_real(pixel->error));
    document_put(json, one, "ulp", pixel->has_ulp ? document_count(pixel->ulp) : json_null());
    if (diff->budget && part == &diff->report->parts[diff->report->pictured])
        document_put(json, one, "class",
                     document_string(class_key((PixelClass)diff->budget->classes[at])));
    document_put(json, one, "a", values_of(json, part, pixel, 0));
    document_put(json, one, "b", values_of(json, part, pixel, 1));
    return one;
}

/* x, y, channel. */
static json_t *first_of(Document *json, const DiffPart *part)
{
    json_t *first = json_pack("[ii]", part->x + part->first[0], part->y + part->first[1]);
    document_append(json, first, document_string(part->channels[part->first[2]].name));
    return first;
}

static void put_figures(Document *json, const DiffPart *part, json_t *one)
{
    document_put(json, one, "pixels", document_count(part->pixels));
    document_put(json, one, "differing_pixels", document_count(part->differing));
    document_put(json, one, "values", document_count(part->values));
    document_put(json, one, "differing", document_count(part->differing_values));
    document_put(json, one, "over_warn", document_count(part->over_warn));
    document_put(json, one, "over_fail", document_count(part->over_fail));
    if (part->perceived)
        document_put(json, one, "perceptual", document_count(part->seen));
    document_put(json, one, "nonfinite", pair_of_counts(part->nonfinite[0], part->nonfinite[1]));
    document_put(json, one, "nonfinite_one_side",
                 document_count(part->broken - part->counts_differ));
    document_put(json, one, "mean_error", document_real(part->mean));
    document_put(json, one, "rms_error", document_real(part->rms));
    document_put(json, one, "psnr", document_real(part->psnr));
    document_put(json, one, "max_error", document_real(part->max));
    document_put(json, one, "first", part->differing ? first_of(json, part) : json_null());
    if (!part->deep)
        return;
    document_put(json, one, "samples", pair_of_counts(part->samples[0], part->samples[1]));
    document_put(json, one, "counts_differ", document_count(part->counts_differ));
    json_t *others = json_array();
    for (int side = 0; side < DIFF_SIDES; side++)
        document_append(json, others,
                        document_string(part->not_compared[side] ? part->not_compared[side] : ""));
    document_put(json, one, "not_compared", others);
}

static json_t *part_of(Document *json, const ReportDiff *diff, const DiffPart *part)
{
    static const char *const verdicts[] = {"pass", "warning", "failure"};
    json_t *one = json_object(), *channels = json_array(), *worst = json_array();
    document_put(json, one, "name", document_string(part->name));
    document_put(json, one, "verdict", document_string(verdicts[part->verdict]));
    if (part->lacks[0] || part->lacks[1])
        document_put(json, one, "only", document_string(part->lacks[0] ? "b" : "a"));
    document_put(json, one, "size", json_pack("[ii]", part->width, part->height));
    document_put(json, one, "deep", json_boolean(part->deep));
    put_figures(json, part, one);
    for (int c = 0; c < part->channel_count; c++)
        document_append(json, channels, channel_of(json, part, &part->channels[c]));
    document_put(json, one, "channels", channels);
    for (int i = 0; i < part->worst_count; i++)
        document_append(json, worst, pixel_of(json, diff, part, &part->worst[i]));
    document_put(json, one, "worst", worst);
    return one;
}

static json_t *threshold_of(Document *json, const DiffThreshold *threshold)
{
    json_t *one = json_object();
    document_put(json, one, "absolute", document_real(threshold->absolute));
    document_put(json, one, "relative", document_real(threshold->relative));
    document_put(json, one, "percent", document_real(threshold->percent));
    document_put(json, one, "hard", document_real(threshold->hard));
    document_put(json, one, "allowed", document_count(threshold->allowed));
    return one;
}

static json_t *classes_of(Document *json, const ReportDiff *diff)
{
    uint64_t counts[CLASS_COUNT];
    json_t *one = json_object();
    report_diff_classes(diff, counts);
    for (int i = 0; i < CLASS_COUNT; i++)
        if (counts[i])
            document_put(json, one, class_key((PixelClass)i), document_count(counts[i]));
    return one;
}

Result report_diff_json(const ReportDiff *diff, int exit_code, const char *path)
{
    static const char *const verdicts[] = {"pass", "warning", "failure", "sizes"};
    const DiffReport *report = diff->report;
    Document json = {0};
    json_t *root = json_object(), *parts = json_array();
    document_put(&json, root, "a", document_string(report->paths[0]));
    document_put(&json, root, "b", document_string(report->paths[1]));
    document_put(&json, root, "verdict", document_string(verdicts[exit_code]));
    document_put(&json, root, "exit_code", json_integer(exit_code));
    document_put(&json, root, "fail", threshold_of(&json, &diff->options->diff.fail));
    document_put(&json, root, "warn", threshold_of(&json, &diff->options->diff.warn));
    document_put(&json, root, "trace", json_boolean(report->trace));
    for (int side = 0; side < DIFF_SIDES && report->sizes_differ; side++)
        document_put(&json, root, side ? "size_b" : "size_a",
                     json_pack("[iiii]", report->sizes[side].x, report->sizes[side].y,
                               report->sizes[side].width, report->sizes[side].height));
    document_put(&json, root, "first_differing",
                 text_or_null(report->first < 0 ? NULL : report->parts[report->first].name));
    if (diff->budget && report->pictured >= 0)
        document_put(&json, root, "classes", classes_of(&json, diff));
    for (size_t i = 0; i < report->count; i++)
        document_append(&json, parts, part_of(&json, diff, &report->parts[i]));
    document_put(&json, root, "parts", parts);
    return document_write(&json, root, path);
}

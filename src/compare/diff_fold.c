#include "compare/diff_fold.h"

#include "base/memory.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_integer(const FoldChannel *channel)
{
    return channel->kind[0] == KIND_UINT && channel->kind[1] == KIND_UINT;
}

/* Whether the part's averages and its greatest error are of this channel too. */
static bool is_averaged(const Fold *fold, int channel)
{
    return fold->integers || !is_integer(&fold->channels[channel]);
}

static Result begin_channel(const FoldChannel *from, DiffChannel *channel)
{
    channel->name = strdup(from->name);
    if (channel->name)
        text_make_line(channel->name);
    channel->has_ulp = from->has[0] && from->has[1];
    for (int side = 0; side < DIFF_SIDES; side++)
        if (from->has[side])
            channel->kinds[side] = planes_kind_name(from->kind[side], from->unorm_max[side]);
    return channel->name ? RESULT_OK : result_fail(RESULT_NO_MEMORY, "out of memory");
}

Result fold_begin(const DiffOptions *options, const FoldChannel *channels, int count,
                  DiffPart *part, Fold *out)
{
    size_t pixels = (size_t)part->width * (size_t)part->height;
    *out = (Fold){.options = options, .channels = channels, .part = part};
    part->pixels = pixels;
    out->sums = memory_array((size_t)count, sizeof *out->sums);
    part->channels = memory_array((size_t)count, sizeof *part->channels);
    part->flags = memory_array(pixels, 1);
    part->errors = memory_array(pixels, sizeof *part->errors);
    out->capacity = 2 * options->worst; /* half of it is spare, so that sorting is seldom */
    part->worst = memory_array((size_t)out->capacity, sizeof *part->worst);
    if (!out->sums || !part->channels || !part->flags || !part->errors || !part->worst)
        return RESULT_NO_MEMORY;
    part->channel_count = count;
    Result result = RESULT_OK;
    out->integers = true;
    for (int i = 0; i < count; i++)
        out->integers &= is_integer(&channels[i]);
    for (int i = 0; i < count && result == RESULT_OK; i++)
        result = begin_channel(&channels[i], &part->channels[i]);
    return result;
}

void fold_free(Fold *fold)
{
    free(fold->sums);
    fold->sums = NULL;
}

/* ---- values ---- */

static void count_distance(DiffChannel *channel, uint32_t ulp)
{
    static const uint32_t least[DIFF_BINS] = {0, 1, 2, 4, 16, 256, 65536};
    int bin = DIFF_BINS - 1;
    while (ulp < least[bin])
        bin--;
    channel->bins[bin]++;
    channel->max_ulp = ulp > channel->max_ulp ? ulp : channel->max_ulp;
}

static bool is_over(const DiffThreshold *threshold, double error, double a, double b)
{
    return error > threshold->absolute && error > threshold->relative * 0.5 * (fabs(a) + fabs(b));
}

static void count_nonfinite(DiffPart *part, DiffChannel *channel, int side, double value)
{
    if (isfinite(value))
        return;
    if (isnan(value))
        channel->nan[side]++;
    else
        channel->infinite[side]++;
    part->nonfinite[side]++;
}

/* Both finite. */
static void add_error(Fold *fold, int index, double a, double b)
{
    DiffChannel *channel = &fold->part->channels[index];
    FoldSums *sums = &fold->sums[index];
    double error = fabs(a - b);
    channel->finite++;
    sums->sum += error;
    sums->squares += error * error;
    sums->peak = fmax(sums->peak, fmax(fabs(a), fabs(b)));
    if (error > channel->max) {
        channel->max = error;
        channel->has_max = true;
        channel->max_x = fold->pixel.x;
        channel->max_y = fold->pixel.y;
    }
    if (is_over(&fold->options->fail, error, a, b))
        fold->flags |= DIFF_OVER_FAIL;
    if (is_over(&fold->options->warn, error, a, b))
        fold->flags |= DIFF_OVER_WARN;
}

/* Equal where both are NaN, or infinities of one sign. */
static double error_of(double a, double b)
{
    if (isfinite(a) && isfinite(b))
        return fabs(a - b);
    return (isnan(a) && isnan(b)) || a == b ? 0.0 : (double)INFINITY;
}

static uint32_t distance_of(const FoldChannel *channel, const uint32_t bits[DIFF_SIDES], double a,
                            double b)
{
    if (channel->kind[0] == channel->kind[1] && channel->unorm_max[0] == channel->unorm_max[1])
        return format_ulp(channel->kind[0], bits[0], bits[1]);
    return ulp_distance((float)a, (float)b);
}

void fold_value(Fold *fold, int index, uint32_t sample, uint32_t a_bits, uint32_t b_bits)
{
    const FoldChannel *from = &fold->channels[index];
    const uint32_t bits[DIFF_SIDES] = {a_bits, b_bits};
    DiffChannel *channel = &fold->part->channels[index];
    double a = planes_value(from->kind[0], from->unorm_max[0], a_bits);
    double b = planes_value(from->kind[1], from->unorm_max[1], b_bits);
    double error = error_of(a, b);
    bool finite = isfinite(a) && isfinite(b);
    uint32_t ulp = distance_of(from, bits, a, b);
    channel->values++;
    count_nonfinite(fold->part, channel, 0, a);
    count_nonfinite(fold->part, channel, 1, b);
    if (finite)
        add_error(fold, index, a, b);
    if (isinf(error))
        fold->broken = true;
    if (channel->has_ulp && isnan(a) == isnan(b))
        count_distance(channel, ulp);
    bool differs = ulp != 0 || error > 0.0; /* an integer may be no float */
    channel->differing += differs;
    if (differs && !fold->part->differing && !(fold->flags & DIFF_DIFFERS)) {
        fold->part->first[0] = fold->pixel.x;
        fold->part->first[1] = fold->pixel.y;
        fold->part->first[2] = index;
    }
    if (isfinite(error))
        fold->greatest = fmax(fold->greatest, error);
    if (error > fold->part->max && isfinite(error) && is_averaged(fold, index)) {
        fold->part->max = error;
        fold->part->max_at = fold->pixel;
        fold->part->max_at.channel = index;
        fold->part->max_at.sample = sample;
    }
    if (differs && (!(fold->flags & DIFF_DIFFERS) || error > fold->pixel.error)) {
        fold->flags |= DIFF_DIFFERS;
        fold->pixel.error = error;
        fold->pixel.channel = index;
        fold->pixel.sample = sample;
        fold->pixel.has_ulp = isnan(a) == isnan(b);
        fold->pixel.ulp = ulp;
    }
}

/* ---- pixels ---- */

void fold_pixel(Fold *fold, int x, int y)
{
    fold->pixel = (DiffPixel){.x = x, .y = y};
    fold->flags = 0;
    fold->broken = false;
}

void fold_break(Fold *fold)
{
    if (!fold->part->differing) {
        fold->part->first[0] = fold->pixel.x;
        fold->part->first[1] = fold->pixel.y;
    }
    fold->broken = true;
    fold->flags |= DIFF_DIFFERS;
    fold->pixel.error = (double)INFINITY;
    fold->pixel.counts = true;
}

static int compare_pixels(const void *a, const void *b)
{
    const DiffPixel *p = a, *q = b;
    if (p->error != q->error)
        return p->error > q->error ? -1 : 1;
    if (p->y != q->y)
        return p->y < q->y ? -1 : 1;
    return p->x < q->x ? -1 : p->x > q->x;
}

static void sort_worst(Fold *fold)
{
    DiffPart *part = fold->part;
    qsort(part->worst, (size_t)part->worst_count, sizeof *part->worst, compare_pixels);
    if (part->worst_count > fold->options->worst)
        part->worst_count = fold->options->worst;
}

void fold_pixel_end(Fold *fold)
{
    DiffPart *part = fold->part;
    size_t at = (size_t)fold->pixel.y * (size_t)part->width + (size_t)fold->pixel.x;
    if (fold->broken)
        fold->flags |= DIFF_OVER_FAIL | DIFF_OVER_WARN;
    part->broken += fold->broken;
    part->differing += (fold->flags & DIFF_DIFFERS) != 0;
    part->over_warn += (fold->flags & DIFF_OVER_WARN) != 0;
    part->over_fail += (fold->flags & DIFF_OVER_FAIL) != 0;
    part->flags[at] = fold->flags;
    part->errors[at] = fold->broken ? NAN : (float)fold->pixel.error;
    if (!(fold->flags & DIFF_DIFFERS) || fold->capacity == 0)
        return;
    if (part->worst_count == fold->capacity)
        sort_worst(fold);
    part->worst[part->worst_count++] = fold->pixel;
}

/* ---- the end ---- */

static void average(const FoldSums *sums, uint64_t values, bool differs, double out[3])
{
    double count = (double)values, nothing = differs ? (double)NAN : 0.0;
    out[0] = values ? sums->sum / count : nothing;
    out[1] = values ? sqrt(sums->squares / count) : nothing;
    out[2] = out[1] > 0.0 ? 20.0 * log10(fmax(1.0, sums->peak) / out[1]) : (double)INFINITY;
    if (isnan(out[1]))
        out[2] = (double)NAN;
}

static void finish_channels(Fold *fold)
{
    DiffPart *part = fold->part;
    FoldSums all = {0};
    uint64_t finite = 0;
    double figures[3];
    for (int i = 0; i < part->channel_count; i++) {
        DiffChannel *channel = &part->channels[i];
        average(&fold->sums[i], channel->finite, channel->differing > 0, figures);
        channel->mean = figures[0];
        channel->rms = figures[1];
        channel->psnr = figures[2];
        part->values += channel->values;
        part->differing_values += channel->differing;
        if (!is_averaged(fold, i))
            continue;
        finite += channel->finite;
        all.sum += fold->sums[i].sum;
        all.squares += fold->sums[i].squares;
        all.peak = fmax(all.peak, fold->sums[i].peak);
    }
    average(&all, finite, part->differing > 0, figures);
    part->mean = figures[0];
    part->rms = figures[1];
    part->psnr = figures[2];
}

static bool is_too_much(const DiffThreshold *threshold, uint64_t over, const Fold *fold)
{
    return (over > threshold->allowed &&
            (double)over > threshold->percent / 100.0 * (double)fold->part->pixels) ||
           fold->greatest > threshold->hard;
}

static void fill(const Fold *fold, FoldFetch fetch, const void *context, double *room,
                 DiffPixel *pixel)
{
    for (int side = 0; side < DIFF_SIDES; side++) {
        pixel->values[side] = room + side * fold->part->channel_count;
        for (int c = 0; c < fold->part->channel_count; c++) {
            const FoldChannel *channel = &fold->channels[c];
            uint32_t bits = fetch(context, side, c, pixel);
            pixel->values[side][c] =
                planes_value(channel->kind[side], channel->unorm_max[side], bits);
        }
    }
}

Result fold_finish(Fold *fold, FoldFetch fetch, const void *context)
{
    DiffPart *part = fold->part;
    finish_channels(fold);
    sort_worst(fold);
    part->verdict = DIFF_PASS;
    bool warns = fold->options->warn_always || part->over_fail;
    if (warns && is_too_much(&fold->options->warn, part->over_warn, fold))
        part->verdict = DIFF_WARNING;
    if (part->broken || is_too_much(&fold->options->fail, part->over_fail, fold))
        part->verdict = DIFF_FAILURE;
    size_t stride = DIFF_SIDES * (size_t)part->channel_count;
    part->values_block =
        memory_array(((size_t)part->worst_count + 1) * stride, sizeof *part->values_block);
    if (!part->values_block)
        return RESULT_NO_MEMORY;
    fill(fold, fetch, context, part->values_block, &part->max_at);
    for (int i = 0; i < part->worst_count; i++)
        fill(fold, fetch, context, part->values_block + ((size_t)i + 1) * stride, &part->worst[i]);
    return RESULT_OK;
}

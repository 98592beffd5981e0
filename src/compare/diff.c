#include "compare/diff.h"

#include "base/memory.h"
#include "compare/diff_fold.h"
#include "compare/perceive.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

DiffOptions diff_options_default(void)
{
    const DiffThreshold threshold = {.absolute = 1e-6, .hard = (double)INFINITY};
    return (DiffOptions){.fail = threshold, .warn = threshold};
}

const char *diff_bin_text(int bin)
{
    static const char *const texts[DIFF_BINS] = {"0",      "1",         "2-3",   "4-15",
                                                 "16-255", "256-65535", "65536-"};
    return texts[bin];
}

void diff_part_release_pixels(DiffPart *part)
{
    free(part->flags);
    free(part->errors);
    part->flags = NULL;
    part->errors = NULL;
}

void diff_part_free(DiffPart *part)
{
    for (int i = 0; i < part->channel_count; i++)
        free(part->channels[i].name);
    free(part->channels);
    free(part->worst);
    free(part->values_block);
    free(part->name);
    for (int side = 0; side < DIFF_SIDES; side++)
        free(part->not_compared[side]);
    diff_part_release_pixels(part);
    *part = (DiffPart){0};
}

/* ---- pairs of channels ---- */

/* The channels of both sides: of each, its plane on each side, or NULL. */
typedef struct Pairs {
    const Planes *sides[DIFF_SIDES];
    int count;
    FoldChannel *channels;
    const Plane **planes[DIFF_SIDES];
} Pairs;

static void free_pairs(Pairs *pairs)
{
    free(pairs->channels);
    free(pairs->planes[0]);
    free(pairs->planes[1]);
}

static void add_pair(Pairs *pairs, const Plane *a, const Plane *b)
{
    const Plane *sides[DIFF_SIDES] = {a, b};
    FoldChannel *channel = &pairs->channels[pairs->count];
    assert(a || b);
    channel->name = a ? a->name : b->name;
    for (int side = 0; side < DIFF_SIDES; side++) {
        const Plane *stored = sides[side] ? sides[side] : sides[!side];
        channel->has[side] = sides[side] != NULL;
        channel->kind[side] = stored->kind;
        channel->unorm_max[side] = stored->unorm_max;
        pairs->planes[side][pairs->count] = sides[side];
    }
    pairs->count++;
}

static Result make_pairs(const Planes *a, const Planes *b, Pairs *out)
{
    size_t most = (size_t)a->count + (size_t)b->count;
    *out = (Pairs){.sides = {a, b}, .channels = memory_array(most, sizeof *out->channels)};
    for (int side = 0; side < DIFF_SIDES; side++)
        out->planes[side] = memory_array(most, sizeof *out->planes[side]);
    if (!out->channels || !out->planes[0] || !out->planes[1])
        return RESULT_NO_MEMORY;
    for (int i = 0; i < a->count; i++) {
        int other = planes_find(b, a->planes[i].name);
        add_pair(out, &a->planes[i], other < 0 ? NULL : &b->planes[other]);
    }
    for (int i = 0; i < b->count; i++)
        if (planes_find(a, b->planes[i].name) < 0)
            add_pair(out, NULL, &b->planes[i]);
    return RESULT_OK;
}

static uint32_t pair_bits(const Pairs *pairs, int side, int channel, size_t at)
{
    const Plane *plane = pairs->planes[side][channel];
    return plane ? plane->bits[at] : 0;
}

static uint32_t fetch(const void *context, int side, int channel, const DiffPixel *pixel)
{
    const Pairs *pairs = context;
    size_t width = (size_t)pairs->sides[0]->width;
    return pair_bits(pairs, side, channel, (size_t)pixel->y * width + (size_t)pixel->x);
}

/* ---- images ---- */

static Result compare(const Pairs *pairs, const DiffOptions *options, DiffPart *out)
{
    Fold fold;
    Result result = fold_begin(options, pairs->channels, pairs->count, out, &fold);
    if (result == RESULT_OK) {
        size_t at = 0;
        for (int y = 0; y < out->height; y++)
            for (int x = 0; x < out->width; x++, at++) {
                fold_pixel(&fold, x, y);
                for (int c = 0; c < pairs->count; c++)
                    fold_value(&fold, c, 0, pair_bits(pairs, 0, c, at), pair_bits(pairs, 1, c, at));
                fold_pixel_end(&fold);
            }
        result = fold_finish(&fold, fetch, pairs);
    }
    fold_free(&fold);
    return result;
}

static Result perceive(const Planes *a, const Planes *b, const DiffOptions *options, DiffPart *part)
{
    Result result = perceive_count(a, b, options->max_bytes, &part->seen);
    part->perceived = true;
    if ((double)part->seen > options->fail.percent / 100.0 * (double)part->pixels &&
        part->seen > options->fail.allowed)
        part->verdict = DIFF_FAILURE;
    return result;
}

Result diff_planes(const Planes *a, const Planes *b, const DiffOptions *options, DiffPart *out)
{
    Pairs pairs;
    *out = (DiffPart){.x = a->x, .y = a->y, .width = a->width, .height = a->height};
    Result result = make_pairs(a, b, &pairs);
    if (result == RESULT_OK)
        result = compare(&pairs, options, out);
    if (result == RESULT_OK && options->perceptual && perceive_possible(a, b))
        result = perceive(a, b, options, out);
    free_pairs(&pairs);
    return result;
}

static void difference(const Pairs *pairs, int channel, double scale, bool magnitude, Plane *out)
{
    const FoldChannel *from = &pairs->channels[channel];
    size_t pixels = (size_t)pairs->sides[0]->width * (size_t)pairs->sides[0]->height;
    for (size_t i = 0; i < pixels; i++) {
        double a = planes_value(from->kind[0], from->unorm_max[0], pair_bits(pairs, 0, channel, i));
        double b = planes_value(from->kind[1], from->unorm_max[1], pair_bits(pairs, 1, channel, i));
        float value = (float)((magnitude ? fabs(a - b) : a - b) * scale);
        memcpy(&out->bits[i], &value, sizeof value);
    }
}

Result diff_image(const Planes *a, const Planes *b, double scale, bool magnitude, Planes *out)
{
    Pairs pairs;
    *out = (Planes){0};
    Result result = make_pairs(a, b, &pairs);
    if (result == RESULT_OK)
        result = planes_create(a->width, a->height, pairs.count, 0, "difference", out);
    out->x = a->x;
    out->y = a->y;
    for (int i = 0; i < pairs.count && result == RESULT_OK; i++) {
        result = planes_name(&out->planes[i], pairs.channels[i].name);
        difference(&pairs, i, scale, magnitude, &out->planes[i]);
    }
    free_pairs(&pairs);
    if (result != RESULT_OK)
        planes_free(out);
    return result;
}

/* Deep images: counts of samples first, then the samples. */
#include "compare/diff_fold.h"

#include <stddef.h>
#include <string.h>

enum {
    REQUIRED = 5, /* Z, R, G, B, A */
    CHANNELS = 8
};

static const struct {
    const char *name;
    FormatKind kind;
    size_t offset; /* of its 4 bytes in DeepSample */
    uint32_t none; /* the bits that a file without the channel has */
} known[CHANNELS] = {
    {"Z", KIND_FLOAT, offsetof(DeepSample, z), 0},
    {"R", KIND_FLOAT, offsetof(DeepSample, rgba), 0},
    {"G", KIND_FLOAT, offsetof(DeepSample, rgba) + 4, 0},
    {"B", KIND_FLOAT, offsetof(DeepSample, rgba) + 8, 0},
    {"A", KIND_FLOAT, offsetof(DeepSample, rgba) + 12, 0},
    {"depth.window", KIND_FLOAT, offsetof(DeepSample, depth), 0},
    {"materialid", KIND_UINT, offsetof(DeepSample, material), DEEP_NO_ID},
    {"primitiveid", KIND_UINT, offsetof(DeepSample, primitive), DEEP_NO_ID},
};

typedef struct DeepPair {
    const DeepImage *sides[DIFF_SIDES];
    int map[CHANNELS]; /* compared channel → row of known */
    int count;
} DeepPair;

static uint32_t sample_bits(const DeepSample *sample, int row)
{
    uint32_t bits;
    memcpy(&bits, (const char *)sample + known[row].offset, sizeof bits);
    return bits;
}

static bool has_channel(const DeepImage *image, int row)
{
    for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++)
        for (uint32_t s = 0; s < image->counts[i]; s++)
            if (sample_bits(&image->pixels[i][s], row) != known[row].none)
                return true;
    return false;
}

static uint32_t fetch(const void *context, int side, int channel, const DiffPixel *pixel)
{
    const DeepPair *pair = context;
    uint32_t count;
    const DeepSample *samples = deep_pixel(pair->sides[side], pixel->x, pixel->y, &count);
    return pixel->sample < count ? sample_bits(&samples[pixel->sample], pair->map[channel]) : 0;
}

static void compare_pixel(const DeepPair *pair, int x, int y, Fold *fold)
{
    DiffPart *part = fold->part;
    uint32_t counts[DIFF_SIDES];
    const DeepSample *a = deep_pixel(pair->sides[0], x, y, &counts[0]);
    const DeepSample *b = deep_pixel(pair->sides[1], x, y, &counts[1]);
    fold_pixel(fold, x, y);
    for (uint32_t s = 0; s < counts[0] && counts[0] == counts[1]; s++)
        for (int c = 0; c < pair->count; c++)
            fold_value(fold, c, s, sample_bits(&a[s], pair->map[c]),
                       sample_bits(&b[s], pair->map[c]));
    if (counts[0] != counts[1]) {
        fold_break(fold);
        if (!part->counts_differ++) {
            part->count_at[0] = x;
            part->count_at[1] = y;
            memcpy(part->counts_there, counts, sizeof counts);
        }
    }
    fold_pixel_end(fold);
}

Result diff_deep(const DeepImage *a, const DeepImage *b, const DiffOptions *options, DiffPart *out)
{
    DeepPair pair = {.sides = {a, b}};
    FoldChannel channels[CHANNELS];
    Fold fold;
    *out = (DiffPart){.deep = true,
                      .x = a->has_window ? a->window.x : 0,
                      .y = a->has_window ? a->window.y : 0,
                      .width = a->width,
                      .height = a->height,
                      .samples = {a->sample_count, b->sample_count}};
    for (int row = 0; row < CHANNELS; row++)
        if (row < REQUIRED || (has_channel(a, row) && has_channel(b, row))) {
            FormatKind kind = known[row].kind;
            channels[pair.count] = (FoldChannel){known[row].name, {true, true}, {kind, kind}, {0}};
            pair.map[pair.count++] = row;
        }
    Result result = fold_begin(options, channels, pair.count, out, &fold);
    if (result == RESULT_OK) {
        for (int y = 0; y < a->height; y++)
            for (int x = 0; x < a->width; x++)
                compare_pixel(&pair, x, y, &fold);
        result = fold_finish(&fold, fetch, &pair);
    }
    fold_free(&fold);
    return result;
}

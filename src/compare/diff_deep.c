/* Deep images: counts of samples first, then the samples. */
#include "base/text.h"
#include "compare/diff_fold.h"

#include <string.h>

typedef struct DeepPair {
    const DeepImage *sides[DIFF_SIDES];
    int map[DEEP_CHANNELS]; /* compared channel → of a sample */
    int count;
} DeepPair;

/* In the order in which they are compared; the first ones every file has. */
static const int order[DEEP_CHANNELS] = {DEEP_Z, DEEP_R,     DEEP_G,        DEEP_B,
                                         DEEP_A, DEEP_DEPTH, DEEP_MATERIAL, DEEP_PRIMITIVE};

static FormatKind stored_kind(const DeepImage *image, int channel)
{
    return image->half[channel] ? KIND_HALF : deep_channels[channel].kind;
}

/* As the file has it. */
static uint32_t sample_bits(const DeepImage *image, const DeepSample *sample, int channel)
{
    const char *at = (const char *)sample + deep_channels[channel].offset;
    uint32_t bits;
    float value;
    memcpy(&bits, at, sizeof bits);
    memcpy(&value, at, sizeof value);
    return image->half[channel] ? half_from_float(value) : bits;
}

static uint32_t fetch(const void *context, int side, int channel, const DiffPixel *pixel)
{
    const DeepPair *pair = context;
    uint32_t count;
    const DeepSample *samples = deep_pixel(pair->sides[side], pixel->x, pixel->y, &count);
    return pixel->sample < count
               ? sample_bits(pair->sides[side], &samples[pixel->sample], pair->map[channel])
               : 0;
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
            fold_value(fold, c, s, sample_bits(pair->sides[0], &a[s], pair->map[c]),
                       sample_bits(pair->sides[1], &b[s], pair->map[c]));
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

static bool both_have(const DeepPair *pair, int channel)
{
    return !pair->sides[0]->missing[channel] && !pair->sides[1]->missing[channel];
}

/* −1 when it cannot be compared. */
static int find_channel(const DeepPair *pair, const char *name, size_t length)
{
    for (int i = 0; i < DEEP_CHANNELS; i++)
        if (strlen(deep_channels[i].name) == length &&
            strncmp(deep_channels[i].name, name, length) == 0)
            return both_have(pair, i) ? i : -1;
    return -1;
}

static void choose(DeepPair *pair, int channel)
{
    for (int i = 0; i < pair->count; i++)
        if (pair->map[i] == channel)
            return; /* named twice */
    pair->map[pair->count++] = channel;
}

/* Those of `channels` in their order; all that can be compared if it is NULL. */
static Result choose_channels(DeepPair *pair, const char *channels)
{
    for (int i = 0; i < DEEP_CHANNELS && !channels; i++)
        if (both_have(pair, order[i]))
            choose(pair, order[i]);
    for (const char *name = channels; name && *name;) {
        size_t length = strcspn(name, ",");
        int channel = find_channel(pair, name, length);
        if (channel < 0)
            return result_fail(RESULT_BAD_INPUT,
                               "--channels %s: expected of deep images Z, R, G, B or A, or of "
                               "depth.window, materialid and primitiveid what both have",
                               channels);
        choose(pair, channel);
        name += length + (name[length] == ',');
    }
    return RESULT_OK;
}

/* What the image has, and is compared with nothing. */
static Result list_others(const DeepImage *image, const DeepImage *other, char **out)
{
    Text names = {0};
    for (int i = 0; i < DEEP_CHANNELS; i++)
        if (!image->missing[order[i]] && other->missing[order[i]])
            text_print(&names, "%s%s", names.count ? ", " : "", deep_channels[order[i]].name);
    if (image->left_out)
        text_print(&names, "%s%s", names.count ? ", " : "", image->left_out);
    if (names.bytes)
        text_make_line(names.bytes);
    *out = names.bytes;
    return names.result;
}

Result diff_deep(const DeepImage *a, const DeepImage *b, const char *channels,
                 const DiffOptions *options, DiffPart *out)
{
    DeepPair pair = {.sides = {a, b}};
    FoldChannel folded[DEEP_CHANNELS];
    Fold fold;
    *out = (DiffPart){.deep = true,
                      .x = a->has_window ? a->window.x : 0,
                      .y = a->has_window ? a->window.y : 0,
                      .width = a->width,
                      .height = a->height,
                      .samples = {a->sample_count, b->sample_count}};
    Result result = choose_channels(&pair, channels);
    for (int side = 0; side < DIFF_SIDES && result == RESULT_OK && !channels; side++)
        result = list_others(pair.sides[side], pair.sides[1 - side], &out->not_compared[side]);
    if (result != RESULT_OK)
        return result;
    for (int i = 0; i < pair.count; i++)
        folded[i] = (FoldChannel){deep_channels[pair.map[i]].name,
                                  {true, true},
                                  {stored_kind(a, pair.map[i]), stored_kind(b, pair.map[i])},
                                  {0}};
    result = fold_begin(options, folded, pair.count, out, &fold);
    if (result == RESULT_OK) {
        for (int y = 0; y < a->height; y++)
            for (int x = 0; x < a->width; x++)
                compare_pixel(&pair, x, y, &fold);
        result = fold_finish(&fold, fetch, &pair);
    }
    fold_free(&fold);
    return result;
}

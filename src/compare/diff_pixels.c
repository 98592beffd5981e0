#include "compare/diff_pixels.h"

#include "compare/diff_fold.h"

/* Two images of one size and format. */
typedef struct Pair {
    PixelFormat format;
    int width;
    const unsigned char *sides[DIFF_SIDES];
} Pair;

static uint32_t fetch(const void *context, int side, int channel, const DiffPixel *pixel)
{
    const Pair *pair = context;
    size_t at = (size_t)pixel->y * (size_t)pair->width + (size_t)pixel->x;
    return format_bits(pair->format, pair->sides[side] + at * format_pixel_bytes(pair->format),
                       channel);
}

static void fold_pixels(const Pair *pair, Fold *fold)
{
    int channels = fold->part->channel_count;
    for (int y = 0; y < fold->part->height; y++)
        for (int x = 0; x < fold->part->width; x++) {
            fold_pixel(fold, x, y);
            for (int c = 0; c < channels; c++)
                fold_value(fold, c, 0, fetch(pair, 0, c, &fold->pixel),
                           fetch(pair, 1, c, &fold->pixel));
            fold_pixel_end(fold);
        }
}

Result diff_pixels(PixelFormat format, int width, int height, const void *a, const void *b,
                   const DiffOptions *options, DiffPart *out)
{
    static const char *const names[] = {"R", "G", "B", "A"};
    const FormatInfo *info = format_info(format);
    const Pair pair = {format, width, {a, b}};
    FoldChannel channels[4];
    for (int c = 0; c < info->channels; c++)
        channels[c] = (FoldChannel){.name = names[c],
                                    .has = {true, true},
                                    .kind = {info->kind, info->kind},
                                    .unorm_max = {info->unorm_max, info->unorm_max}};
    Fold fold;
    *out = (DiffPart){.width = width, .height = height};
    Result result = fold_begin(options, channels, info->channels, out, &fold);
    if (result == RESULT_OK) {
        fold_pixels(&pair, &fold);
        result = fold_finish(&fold, fetch, &pair);
    }
    fold_free(&fold);
    return result;
}

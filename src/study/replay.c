#include "study/replay.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>

bool replay_possible(const TraceStore *trace)
{
    return store_find(trace, "peel.0.accum") >= 0 && store_find(trace, "dual.0.back_accum") < 0;
}

/* A replayed accumulation: premultiplied colour so far. */
typedef struct Replay {
    double plain[3], clamped[3];
} Replay;

static double clamp_unit(double x)
{
    return x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
}

/* One blend of `after` from `before`, under: without rounding, with and without clamping. */
static void replay_layer(Replay *replay, const float *before, const float *after)
{
    double transmittance = (double)before[3];
    for (int c = 0; c < 3; c++) {
        double added = (double)after[c] - (double)before[c];
        double source = transmittance > 0.0 ? added / transmittance : 0.0;
        replay->plain[c] += added;
        replay->clamped[c] = clamp_unit(replay->clamped[c] + clamp_unit(source) * transmittance);
    }
}

static void replay_image(Replay *replays, size_t pixels, const Image *before, const Image *after)
{
    static const float start[4] = {0.0f, 0.0f, 0.0f, 1.0f};
    const float *a = before->pixels, *b = after->pixels;
    for (size_t i = 0; i < pixels; i++)
        replay_layer(&replays[i], a ? a + 4 * i : start, b + 4 * i);
}

/* The colours of `from`, had each blend clamped. */
static void clamp_image(const Replay *replays, size_t pixels, const Image *from, Image *out)
{
    const float *f = from->pixels;
    float *o = out->pixels;
    for (size_t i = 0; i < pixels; i++, f += 4, o += 4) {
        for (int c = 0; c < 3; c++)
            o[c] = (float)((double)f[c] + (replays[i].clamped[c] - replays[i].plain[c]));
        o[3] = f[3];
    }
}

static Result load_accum(const TraceStore *trace, int peel, Image *out)
{
    char name[48] = "accum";
    if (peel >= 0)
        snprintf(name, sizeof name, "peel.%d.accum", peel);
    int index = store_find(trace, name);
    return index < 0 ? RESULT_OK : store_image(trace, index, out);
}

/* Through the traced accumulations of all peels, and the last one. */
static Result replay_trace(const TraceStore *trace, Replay *replays, size_t pixels)
{
    Image before = {0}, after = {0};
    Result result = RESULT_OK;
    for (int peel = 0; result == RESULT_OK; peel++) {
        result = load_accum(trace, peel, &after);
        bool last = result == RESULT_OK && !after.pixels;
        if (last)
            result = load_accum(trace, -1, &after);
        if (result == RESULT_OK && after.pixels)
            replay_image(replays, pixels, &before, &after);
        image_free(&before);
        before = after;
        after = (Image){0};
        if (last)
            break;
    }
    image_free(&before);
    return result;
}

Result replay_clamped(const TraceStore *trace, const Image *from, Image *out)
{
    size_t pixels = (size_t)from->width * (size_t)from->height;
    Replay *replays = memory_array(pixels, sizeof *replays);
    Result result = replays ? replay_trace(trace, replays, pixels) : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = image_create(from->width, from->height, FORMAT_RGBA32F, out);
    if (result == RESULT_OK)
        clamp_image(replays, pixels, from, out);
    free(replays);
    return result;
}

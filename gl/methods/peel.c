/* Deferred depth peeling.
 *
 * This work is based on: L. Rapetta, "OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling";
 * C. Everitt, "Interactive Order-Independent Transparency", 2001. Opaque geometry is drawn once;
 * each peel is a geometry pass behind the previous one, shaded by a full-screen pass and blended
 * under what is in front of it; the opaque surfaces are shaded last. */
#include "methods/peel.h"

#include "base/memory.h"
#include "base/progress.h"
#include "readback.h"

#include <stdlib.h>
#include <string.h>

/* Read-back of the peels; NULL where a run does not need it. */
typedef struct Scratch {
    void *pixels;       /* one buffer for the trace */
    uint32_t *depth[2]; /* this peel's and the previous one's, as bits */
    void *material;
} Scratch;

static Result make_scratch(const Passes *passes, const TraceSink *trace, Scratch *out)
{
    *out = (Scratch){0};
    size_t pixels = (size_t)passes->targets.width * (size_t)passes->targets.height;
    if (trace && !(out->pixels = memory_array(pixels, 4 * sizeof(float))))
        return RESULT_NO_MEMORY;
    if (passes->desc->peel_test != PEEL_TEST_RAW)
        return RESULT_OK;
    out->depth[0] = memory_array(pixels, sizeof(uint32_t));
    out->depth[1] = memory_array(pixels, sizeof(uint32_t));
    out->material = memory_array(pixels, 4 * sizeof(float));
    return out->depth[0] && out->depth[1] && out->material ? RESULT_OK : RESULT_NO_MEMORY;
}

static void free_scratch(Scratch *scratch)
{
    free(scratch->pixels);
    free(scratch->depth[0]);
    free(scratch->depth[1]);
    free(scratch->material);
}

/* Compares a peel's depths with the previous peel's: *repeated counts the pixels that have a
 * fragment at the same stored depth, *fresh those that have one at another. A pixel has a fragment
 * where its material's fourth channel is not 0; its depth may equal the cleared one. */
static void count_repeats(const Passes *passes, int peel, Scratch *scratch, uint64_t *repeated,
                          uint64_t *fresh)
{
    const Targets *targets = &passes->targets;
    GLuint framebuffer = targets->peel_buffer[peel & 1];
    PixelFormat format = targets->color_format[GBUFFER_MATERIAL];
    uint32_t *depth = scratch->depth[peel & 1], *previous = scratch->depth[1 - (peel & 1)];
    readback_depth(targets, framebuffer, READBACK_BOTTOM_UP, depth);
    readback_color(targets, framebuffer, targets->attachment[GBUFFER_MATERIAL], format,
                   READBACK_BOTTOM_UP, scratch->material);
    *repeated = *fresh = 0;
    size_t pixels = (size_t)targets->width * (size_t)targets->height;
    size_t stride = format_pixel_bytes(format);
    for (size_t i = 0; i < pixels; i++) {
        if (format_channel(format, (const char *)scratch->material + i * stride, 3) == 0.0f)
            continue;
        if (peel > 0 && depth[i] == previous[i])
            ++*repeated;
        else
            ++*fresh;
    }
}

static Result trace_accum(const Passes *passes, int peel, TraceSink *trace, void *pixels)
{
    const Targets *targets = &passes->targets;
    PixelFormat format = targets->accum_format;
    readback_color(targets, targets->plain_buffer, 0, format, READBACK_TOP_DOWN, pixels);
    return trace_put_peel(trace, peel, "accum", format, targets->width, targets->height, pixels);
}

/* One peel. *more: false when it brought nothing new and was left out. */
static Result run_peel(Passes *passes, int peel, TraceSink *trace, Scratch *scratch, Frame *out,
                       bool *more)
{
    uint64_t samples = 0;
    *more = false;
    progress_add();
    Result result = passes_peel_geometry(passes, peel, &samples);
    if (result != RESULT_OK || samples == 0)
        return result;
    if (passes->desc->peel_test == PEEL_TEST_RAW) {
        uint64_t repeated, fresh;
        count_repeats(passes, peel, scratch, &repeated, &fresh);
        if (passes->desc->passes == 0 && fresh == 0)
            return RESULT_OK;
        out->layers.repeated += repeated;
    }
    *more = true;
    out->peels = peel + 1;
    passes_peel_lighting(passes, peel);
    if (!trace)
        return RESULT_OK;
    result = readback_trace_gbuffer(&passes->targets, passes->targets.peel_buffer[peel & 1], peel,
                                    trace, scratch->pixels);
    return result == RESULT_OK ? trace_accum(passes, peel, trace, scratch->pixels) : result;
}

static Result run_peels(Passes *passes, TraceSink *trace, Scratch *scratch, Frame *out)
{
    int most = passes->desc->passes ? passes->desc->passes : PASSES_MAX;
    bool more = true;
    Result result = RESULT_OK;
    for (int peel = 0; peel < most && more && result == RESULT_OK; peel++)
        result = run_peel(passes, peel, trace, scratch, out, &more);
    return result;
}

static Result run(Passes *passes, TraceSink *trace, Scratch *scratch, Frame *out)
{
    const Targets *targets = &passes->targets;
    Result result = passes_opaque_geometry(passes);
    if (result == RESULT_OK && trace)
        result =
            readback_trace_gbuffer(targets, targets->opaque_buffer, -1, trace, scratch->pixels);
    if (result == RESULT_OK)
        result = run_peels(passes, trace, scratch, out);
    if (result != RESULT_OK)
        return result;
    passes_opaque_lighting(passes);
    if (!trace)
        return RESULT_OK;
    readback_color(targets, targets->plain_buffer, 0, targets->accum_format, READBACK_TOP_DOWN,
                   scratch->pixels);
    return trace_put(trace, "accum", out->peels + 1, targets->accum_format, targets->width,
                     targets->height, scratch->pixels);
}

Result gl_peel(Passes *passes, TraceSink *trace, Frame *out)
{
    Scratch scratch;
    Result result = make_scratch(passes, trace, &scratch);
    if (result == RESULT_OK)
        result = run(passes, trace, &scratch, out);
    free_scratch(&scratch);
    return result;
}

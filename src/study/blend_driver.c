#include "study/blend_driver.h"

#include "base/memory.h"
#include "number/op.h"
#include "study/driver_inputs.h"

#include <stdlib.h>
#include <string.h>

enum {
    RANDOM_DEFAULT = 1 << 20,
    PIECES = 8 /* of a part of a set, at least */
};

typedef struct Run {
    const BlendDriverDesc *desc;
    Lab *driver;
    BlendCheck *check;
    float (*source)[4], (*before)[4]; /* EXPERIMENT_TEXELS each */
    unsigned char *destination, *results;
    uint32_t *stored, *blended; /* EXPERIMENT_VALUES_MAX */
    uint64_t changed, done;
} Run;

static VectorSpec spec_of(const BlendDriverDesc *desc, VectorSet set)
{
    return (VectorSpec){.set = set,
                        .format = desc->format,
                        .seed = desc->seed,
                        .count = desc->limit ? desc->limit : RANDOM_DEFAULT};
}

/* Vectors taken of a set; 0 where the format has none. */
static uint64_t set_vectors(const BlendDriverDesc *desc, VectorSet set)
{
    VectorSpec spec = spec_of(desc, set);
    if (!(desc->sets >> set & 1) || set == VECTORS_SEQUENCES || vectors_check(&spec) != RESULT_OK)
        return 0;
    uint64_t count = vectors_count(&spec);
    return desc->limit && desc->limit < count ? desc->limit : count;
}

uint64_t blend_driver_vectors(const BlendDriverDesc *desc)
{
    uint64_t sum = 0;
    for (int i = 0; i < VECTORS_SET_COUNT; i++)
        sum += set_vectors(desc, (VectorSet)i);
    return sum;
}

static void put_bits(PixelFormat format, void *pixel, int channel, uint32_t bits)
{
    size_t bytes = (size_t)format_info(format)->channel_bytes;
    unsigned char *at = (unsigned char *)pixel + (size_t)channel * bytes;
    uint8_t byte = (uint8_t)bits;
    uint16_t word = (uint16_t)bits;
    memcpy(at, bytes == 1 ? (const void *)&byte : bytes == 2 ? (const void *)&word : &bits, bytes);
}

/* Codes of the lab, four a texel, to pixels. */
static void narrow(PixelFormat format, size_t count, const uint32_t *codes, unsigned char *pixels)
{
    size_t bytes = format_pixel_bytes(format);
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < format_info(format)->channels; k++)
            put_bits(format, pixels + i * bytes, k, codes[4 * i + (size_t)k]);
}

/* Takes over what the driver stored, where it is not what was meant. */
static void take_stored(Run *run, size_t count)
{
    PixelFormat format = run->desc->format;
    const FormatInfo *info = format_info(format);
    size_t bytes = format_pixel_bytes(format);
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < info->channels; k++) {
            unsigned char *pixel = run->destination + i * bytes;
            uint32_t meant = format_bits(format, pixel, k), is = run->stored[4 * i + (size_t)k];
            if (meant == is)
                continue;
            run->changed += format_ulp(info->kind, meant, is) != 0;
            put_bits(format, pixel, k, is);
        }
}

static Result blend_some(Run *run, VectorSet set, uint64_t index, size_t count)
{
    PixelFormat format = run->desc->format;
    size_t bytes = format_pixel_bytes(format);
    Experiment experiment = {.kind = EXPERIMENT_BLEND,
                             .format = format,
                             .equation = run->desc->equation,
                             .a = (const float(*)[4])run->source,
                             .b = (const float(*)[4])run->before,
                             .before = run->stored};
    uint32_t saved = op_enter();
    for (size_t i = 0; i < count; i++)
        format_fetch(format, run->destination + i * bytes, run->before[i]);
    op_leave(saved);
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 4; k++)
            run->source[i][k] = inputs_bounded(format, run->source[i][k]);
    Result result = run->driver->run(run->driver, &experiment, run->blended);
    if (result != RESULT_OK)
        return result;
    take_stored(run, count);
    narrow(format, count, run->blended, run->results);
    run->done += count;
    if (run->desc->progress)
        run->desc->progress(run->done);
    return blend_check_add(run->check, set, index, count, (const float(*)[4])run->source,
                           run->destination, run->results);
}

/* All of the set, or `count` vectors in pieces that are spread over it. */
static Result run_set(Run *run, VectorSet set)
{
    VectorSpec spec = spec_of(run->desc, set);
    uint64_t count = set_vectors(run->desc, set), all = count ? vectors_count(&spec) : 0;
    uint64_t piece = count == all ? EXPERIMENT_TEXELS : (count + PIECES - 1) / PIECES;
    Result result = RESULT_OK;
    piece = piece < EXPERIMENT_TEXELS ? piece : EXPERIMENT_TEXELS;
    for (uint64_t at = 0; at < count && result == RESULT_OK; at += piece) {
        uint64_t some = count - at < piece ? count - at : piece;
        double part = count > some ? (double)at / (double)(count - some) : 0.0;
        uint64_t from = count == all ? at : (uint64_t)(part * (double)(all - some));
        vectors_make(&spec, from, (size_t)some, run->source, run->destination);
        result = blend_some(run, set, from, (size_t)some);
    }
    return result;
}

static Result open_run(Run *run)
{
    size_t bytes = format_pixel_bytes(run->desc->format);
    BlendCheckDesc desc = {.format = run->desc->format,
                           .equation = run->desc->equation,
                           .worst = run->desc->worst,
                           .quick = true,
                           .threads = run->desc->threads};
    run->source = memory_array(EXPERIMENT_TEXELS, sizeof *run->source);
    run->before = memory_array(EXPERIMENT_TEXELS, sizeof *run->before);
    run->destination = memory_array(EXPERIMENT_TEXELS, bytes);
    run->results = memory_array(EXPERIMENT_TEXELS, bytes);
    run->stored = memory_array(EXPERIMENT_VALUES_MAX, sizeof *run->stored);
    run->blended = memory_array(EXPERIMENT_VALUES_MAX, sizeof *run->blended);
    if (!run->source || !run->before || !run->destination || !run->results || !run->stored ||
        !run->blended)
        return RESULT_NO_MEMORY;
    return blend_check_open(&desc, &run->check);
}

Result blend_driver_run(Lab *driver, const BlendDriverDesc *desc, BlendReport *out,
                        uint64_t *changed)
{
    Run run = {.desc = desc, .driver = driver};
    Result result = open_run(&run);
    for (int i = 0; i < VECTORS_SET_COUNT && result == RESULT_OK; i++)
        result = run_set(&run, (VectorSet)i);
    if (result == RESULT_OK)
        blend_check_finish(run.check, out);
    *changed = run.changed;
    blend_check_close(run.check);
    free(run.source);
    free(run.before);
    free(run.destination);
    free(run.results);
    free(run.stored);
    free(run.blended);
    return result;
}

#include "image/deep.h"

#include "base/memory.h"

#include <stddef.h>
#include <stdlib.h>

const DeepChannel deep_channels[DEEP_CHANNELS] = {
    [DEEP_A] = {"A", KIND_FLOAT, offsetof(DeepSample, rgba[3])},
    [DEEP_B] = {"B", KIND_FLOAT, offsetof(DeepSample, rgba[2])},
    [DEEP_G] = {"G", KIND_FLOAT, offsetof(DeepSample, rgba[1])},
    [DEEP_R] = {"R", KIND_FLOAT, offsetof(DeepSample, rgba[0])},
    [DEEP_Z] = {"Z", KIND_FLOAT, offsetof(DeepSample, z)},
    [DEEP_DEPTH] = {"depth.window", KIND_FLOAT, offsetof(DeepSample, depth)},
    [DEEP_MATERIAL] = {"materialid", KIND_UINT, offsetof(DeepSample, material)},
    [DEEP_PRIMITIVE] = {"primitiveid", KIND_UINT, offsetof(DeepSample, primitive)},
};

struct DeepBlock {
    DeepBlock *next;
    DeepSample samples[];
};

Result deep_room(const DeepImage *image, size_t bytes)
{
    size_t left = image->max_bytes - image->bytes;
    if (bytes > left)
        return result_fail(RESULT_NO_MEMORY,
                           "deep image of %dx%d pixels: needs more than %zu KiB, the limit is %zu "
                           "KiB (--max-memory)",
                           image->width, image->height, (image->bytes + bytes) >> 10,
                           image->max_bytes >> 10);
    return RESULT_OK;
}

/* Counts what there is room for. */
static Result reserve(DeepImage *image, size_t bytes)
{
    Result result = deep_room(image, bytes);
    if (result == RESULT_OK)
        image->bytes += bytes;
    return result;
}

Result deep_create(int width, int height, size_t max_bytes, DeepImage *out)
{
    *out = (DeepImage){.width = width, .height = height, .max_bytes = max_bytes};
    if (width < 1 || height < 1)
        return result_fail(RESULT_BAD_INPUT, "deep image of %dx%d pixels, expected at least 1x1",
                           width, height);
    size_t pixels = (size_t)width * (size_t)height;
    Result result = reserve(out, pixels * (sizeof *out->counts + sizeof *out->pixels));
    if (result != RESULT_OK)
        return result;
    out->counts = memory_array(pixels, sizeof *out->counts);
    out->pixels = memory_array(pixels, sizeof(DeepSample *));
    return out->counts && out->pixels ? RESULT_OK : RESULT_NO_MEMORY;
}

void deep_free(DeepImage *image)
{
    while (image->blocks) {
        DeepBlock *block = image->blocks;
        image->blocks = block->next;
        free(block);
    }
    free(image->counts);
    free(image->pixels);
    free(image->left_out);
    *image = (DeepImage){0};
}

Result deep_block(DeepImage *image, size_t count, DeepSample **out)
{
    *out = NULL;
    size_t fits = (SIZE_MAX - sizeof(DeepBlock)) / sizeof(DeepSample);
    size_t bytes = sizeof(DeepBlock) + (count < fits ? count : fits) * sizeof(DeepSample);
    Result result = reserve(image, bytes);
    if (result != RESULT_OK)
        return result;
    DeepBlock *block = memory_array(1, bytes);
    if (!block)
        return RESULT_NO_MEMORY;
    block->next = image->blocks;
    image->blocks = block;
    image->sample_count += count;
    *out = block->samples;
    return RESULT_OK;
}

void deep_set(DeepImage *image, int x, int y, DeepSample *samples, uint32_t count)
{
    size_t at = (size_t)y * (size_t)image->width + (size_t)x;
    image->counts[at] = count;
    image->pixels[at] = count ? samples : NULL;
}

uint32_t deep_most(const DeepImage *image)
{
    size_t pixels = (size_t)image->width * (size_t)image->height;
    uint32_t most = 0;
    for (size_t i = 0; i < pixels; i++)
        most = image->counts[i] > most ? image->counts[i] : most;
    return most;
}

Result deep_flatten(const DeepImage *image, Image *out)
{
    Result result = image_create(image->width, image->height, FORMAT_RGBA32F, out);
    size_t pixels = (size_t)image->width * (size_t)image->height;
    for (size_t at = 0; at < pixels && result == RESULT_OK; at++) {
        double rgb[3] = {0.0}, transmittance = 1.0;
        for (uint32_t s = 0; s < image->counts[at] && transmittance > 0.0; s++) {
            const DeepSample *sample = &image->pixels[at][s];
            for (int i = 0; i < 3; i++)
                rgb[i] += transmittance * (double)sample->rgba[i];
            transmittance *= 1.0 - (double)sample->rgba[3];
        }
        float *flat = &((float *)out->pixels)[4 * at];
        for (int i = 0; i < 3; i++)
            flat[i] = (float)rgb[i];
        flat[3] = (float)(1.0 - transmittance);
    }
    return result;
}

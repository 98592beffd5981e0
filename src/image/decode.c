#include "image/decode.h"

#include "image/decode_jpeg.h"

#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Whether an allocation of stb's has failed: it takes that for a fault of the image in places, and
 * for another kind of image. */
static _Thread_local bool short_of_memory;

static void *decode_allocate(size_t size)
{
    void *out = malloc(size);
    short_of_memory |= !out;
    return out;
}

static void *decode_grow(void *memory, size_t size)
{
    void *out = realloc(memory, size);
    short_of_memory |= !out;
    return out;
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wmissing-prototypes"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wundef"
#pragma GCC diagnostic ignored "-Wunused-function"
#ifndef __clang_analyzer__ /* to which stb's own code is only declared */
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#endif
#define STBI_ONLY_PNG
#define STBI_NO_GIF
#define STBI_NO_STDIO
#define STBI_NO_SIMD /* one code for all processors */
#define STBI_FAILURE_USERMSG
#define STBI_MALLOC  decode_allocate
#define STBI_REALLOC decode_grow
#define STBI_FREE    free
/* Declared and defined under different names, which a compiler warns of at the file's end. */
#define stbi_set_unpremultiply_on_load_thread stbi__unpremultiply_on_load_thread
#include <stb_image.h>
#pragma GCC diagnostic pop

enum {
    PALETTE_BYTES = 3 * 256,
    /* A JPEG stores a block of 8×8 samples in a bit at least, and a sample in each direction stands
     * for 4 pixels at most. */
    JPEG_PIXELS_A_BYTE = 8 * 32 * 32
};

/* "PNG" or "JPEG" by the first bytes; NULL for anything else. */
static const char *kind_of(const unsigned char *bytes, size_t count)
{
    if (count >= 8 && memcmp(bytes, "\x89PNG\r\n\x1a\n", 8) == 0)
        return "PNG";
    return count >= 3 && memcmp(bytes, "\xff\xd8\xff", 3) == 0 ? "JPEG" : NULL;
}

static Result out_of_memory(const char *label)
{
    return result_fail(RESULT_NO_MEMORY, "%s: out of memory for its pixels", label);
}

static Result stb_failure(const char *label)
{
    const char *reason = stbi_failure_reason();
    if (short_of_memory || (reason && strcmp(reason, "Out of memory") == 0))
        return out_of_memory(label);
    return result_fail(RESULT_BAD_INPUT, "%s: cannot decode the PNG: %s", label,
                       reason ? reason : "no reason given");
}

static Result png_size(const unsigned char *bytes, size_t count, const char *label, int *width,
                       int *height, int *channels)
{
    short_of_memory = false;
    return stbi_info_from_memory(bytes, (int)count, width, height, channels) ? RESULT_OK
                                                                             : stb_failure(label);
}

/* Where a PNG's chunk of this type begins, before its pixels; 0: there is none. Source: PNG (Third
 * Edition), 5.3. */
static size_t find_chunk(const unsigned char *bytes, size_t count, const char *type, size_t *length)
{
    for (size_t at = 8; count - at >= 12;) {
        const unsigned char *chunk = bytes + at;
        *length = (size_t)chunk[0] << 24 | (size_t)chunk[1] << 16 | (size_t)chunk[2] << 8 |
                  (size_t)chunk[3];
        if (*length > count - at - 12 || memcmp(chunk + 4, "IDAT", 4) == 0)
            return 0;
        if (memcmp(chunk + 4, type, 4) == 0)
            return at;
        at += 12 + *length;
    }
    return 0;
}

/* Where a PNG's PLTE chunk begins, if it has colours stored as indices and fewer than the 256 that
 * indices can name; 0 otherwise. Source: PNG (Third Edition), 11.2.2. */
static size_t find_short_palette(const unsigned char *bytes, size_t count)
{
    size_t length,
        at = count >= 26 && bytes[25] == 3 ? find_chunk(bytes, count, "PLTE", &length) : 0;
    return at && length < PALETTE_BYTES && length % 3 == 0 ? at : 0;
}

/* The file with the palette that begins at `at` filled up with black, the colour of what has none:
 * of such an index stb would take what is on the stack. It does not look at checksums. The caller
 * frees *out. */
static Result fill_palette(const unsigned char *bytes, size_t count, size_t at, const char *label,
                           unsigned char **out, size_t *out_count)
{
    size_t length = (size_t)bytes[at + 2] << 8 | bytes[at + 3], behind = at + 8 + length;
    unsigned char *filled = calloc(count + PALETTE_BYTES - length, 1);
    if (!filled)
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory", label);
    memcpy(filled, bytes, behind);
    filled[at + 2] = PALETTE_BYTES >> 8;
    filled[at + 3] = PALETTE_BYTES & 0xff;
    memcpy(filled + at + 8 + PALETTE_BYTES, bytes + behind, count - behind);
    *out = filled;
    *out_count = count + PALETTE_BYTES - length;
    return RESULT_OK;
}

/* Of a file whose kind and header were found to be sound. */
static Result size_of(const unsigned char *bytes, size_t count, const char *label, int *width,
                      int *height, int *channels)
{
    return *kind_of(bytes, count) == 'J'
               ? decode_jpeg_size(bytes, count, label, width, height, channels)
               : png_size(bytes, count, label, width, height, channels);
}

Result decode_size(const unsigned char *bytes, size_t count, const char *label, int *width,
                   int *height)
{
    const char *kind = kind_of(bytes, count);
    int channels;
    if (!kind)
        return result_fail(RESULT_BAD_INPUT, "%s: expected PNG or JPEG data", label);
    if (count > INT_MAX - PALETTE_BYTES)
        return result_fail(RESULT_BAD_INPUT, "%s: %zu bytes of %s, expected below 2^31", label,
                           count, kind);
    Result result = size_of(bytes, count, label, width, height, &channels);
    if (result != RESULT_OK)
        return result;
    if (*width < 1 || *height < 1 || *width > DECODE_MAX_PIXELS || *height > DECODE_MAX_PIXELS)
        return result_fail(RESULT_BAD_INPUT, "%s: %dx%d pixels, expected 1 to %d a side", label,
                           *width, *height, DECODE_MAX_PIXELS);
    if (*kind == 'J' && (uint64_t)*width * (uint64_t)*height / JPEG_PIXELS_A_BYTE > count)
        return result_fail(RESULT_BAD_INPUT,
                           "%s: cannot decode the JPEG: %zu bytes of %dx%d pixels", label, count,
                           *width, *height);
    return RESULT_OK;
}

static Result load_png(const unsigned char *bytes, size_t count, const char *label, Image *out)
{
    int width, height, channels;
    /* stb keeps its latest reason, and does not always give one: this is none of a real file. */
    stbi_info_from_memory((const unsigned char *)"", 0, &width, &height, &channels);
    const char *before = stbi_failure_reason();
    bool wide = stbi_is_16_bit_from_memory(bytes, (int)count);
    void *pixels = wide ? (void *)stbi_load_16_from_memory(bytes, (int)count, &width, &height,
                                                           &channels, STBI_rgb_alpha)
                        : (void *)stbi_load_from_memory(bytes, (int)count, &width, &height,
                                                        &channels, STBI_rgb_alpha);
    if (!pixels && !short_of_memory && stbi_failure_reason() == before)
        return result_fail(RESULT_BAD_INPUT,
                           "%s: cannot decode the PNG: it is broken, or 2^31 bytes or more", label);
    if (!pixels)
        return stb_failure(label);
    if (short_of_memory) {
        free(pixels);
        return out_of_memory(label);
    }
    *out = (Image){width, height, wide ? FORMAT_RGBA16 : FORMAT_RGBA8, pixels};
    return RESULT_OK;
}

Result decode_image(const unsigned char *bytes, size_t count, const char *label, Image *out)
{
    int width, height;
    unsigned char *filled = NULL;
    *out = (Image){0};
    Result result = decode_size(bytes, count, label, &width, &height);
    if (result != RESULT_OK)
        return result;
    if (*kind_of(bytes, count) == 'J')
        return decode_jpeg_image(bytes, count, label, out);
    size_t palette = find_short_palette(bytes, count);
    if (palette)
        result = fill_palette(bytes, count, palette, label, &filled, &count);
    if (result == RESULT_OK)
        result = load_png(filled ? filled : bytes, count, label, out);
    free(filled);
    return result;
}

Result decode_channels(const unsigned char *bytes, size_t count, const char *label, int *channels)
{
    int width, height;
    size_t length;
    Result result = size_of(bytes, count, label, &width, &height, channels);
    /* One colour of a PNG may be transparent: then it was decoded with alpha. */
    bool colors = result == RESULT_OK && *kind_of(bytes, count) == 'P' && *channels % 2 == 1;
    *channels += colors && find_chunk(bytes, count, "tRNS", &length);
    return result;
}

#include "image/decode.h"

#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wmissing-prototypes"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wundef"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_GIF
#define STBI_NO_STDIO
#define STBI_NO_SIMD /* one code for all processors */
#define STBI_FAILURE_USERMSG
/* Zeroed: of a JPEG that lacks tables or scans stb reads what it has not written. What grows is a
 * PNG's, and is not read before. */
#define STBI_MALLOC(size)       calloc(1, size)
#define STBI_REALLOC(old, size) realloc(old, size)
#define STBI_FREE(old)          free(old)
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

static Result stb_failure(const char *label, const char *kind)
{
    const char *reason = stbi_failure_reason();
    if (reason && strcmp(reason, "Out of memory") == 0)
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory for its pixels", label);
    return result_fail(RESULT_BAD_INPUT, "%s: cannot decode the %s: %s", label, kind,
                       reason ? reason : "no reason given");
}

/* Whether a DHT segment is whole tables of at most 256 codes: Debian 12's stb reads the counts of
 * a table even behind the segment, and writes past its own table when they are more. */
static bool tables_fit(const unsigned char *segment, size_t count)
{
    size_t at = 0;
    while (at + 17 <= count) {
        size_t codes = 0;
        for (size_t i = 1; i <= 16; i++)
            codes += segment[at + i];
        if (codes > 256)
            return false;
        at += 17 + codes;
    }
    return at == count;
}

/* NULL, or what is wrong with a JPEG that stb would not tell: it fills what is missing with grey.
 * Source: ITU-T T.81, annex B: segments with a length each; a scan's data, in which 0xff 0x00 and
 * the restarts d0 to d7 are no markers, behind each da. stb looks for markers in the same way. */
static const char *jpeg_fault(const unsigned char *bytes, size_t count)
{
    static const char *const early = "it ends too early";
    size_t at = 2;
    while (at + 1 < count) {
        unsigned char marker = bytes[at + 1];
        bool data = bytes[at] != 0xff || marker == 0 || (marker >= 0xd0 && marker <= 0xd7);
        if (data || marker == 0xff) {
            at++;
            continue;
        }
        if (marker == 0xd9)
            return NULL;
        if (at + 3 >= count)
            return early;
        size_t length = (size_t)bytes[at + 2] << 8 | bytes[at + 3];
        if (length < 2 || length > count - at - 2)
            return early;
        if (marker == 0xc4 && !tables_fit(bytes + at + 4, length - 2))
            return "broken Huffman tables";
        at += 2 + length;
    }
    return early;
}

/* Where a PNG's PLTE chunk begins, if it has colours stored as indices and fewer than the 256 that
 * indices can name; 0 otherwise. Source: PNG (Third Edition), 5.3 and 11.2.2. */
static size_t find_short_palette(const unsigned char *bytes, size_t count)
{
    if (count < 26 || bytes[25] != 3)
        return 0;
    for (size_t at = 8; count - at >= 12;) {
        const unsigned char *chunk = bytes + at;
        size_t length = (size_t)chunk[0] << 24 | (size_t)chunk[1] << 16 | (size_t)chunk[2] << 8 |
                        (size_t)chunk[3];
        if (length > count - at - 12)
            return 0;
        if (memcmp(chunk + 4, "PLTE", 4) == 0)
            return length < PALETTE_BYTES && length % 3 == 0 ? at : 0;
        at += 12 + length;
    }
    return 0;
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
    const char *fault = *kind == 'J' ? jpeg_fault(bytes, count) : NULL;
    if (fault)
        return result_fail(RESULT_BAD_INPUT, "%s: cannot decode the JPEG: %s", label, fault);
    if (!stbi_info_from_memory(bytes, (int)count, width, height, &channels))
        return stb_failure(label, kind);
    if (*width < 1 || *height < 1 || *width > DECODE_MAX_PIXELS || *height > DECODE_MAX_PIXELS)
        return result_fail(RESULT_BAD_INPUT, "%s: %dx%d pixels, expected 1 to %d a side", label,
                           *width, *height, DECODE_MAX_PIXELS);
    if (*kind == 'J' && (uint64_t)*width * (uint64_t)*height / JPEG_PIXELS_A_BYTE > count)
        return result_fail(RESULT_BAD_INPUT,
                           "%s: cannot decode the JPEG: %zu bytes of %dx%d pixels", label, count,
                           *width, *height);
    return RESULT_OK;
}

/* Of a file whose header was found to be sound. */
static Result load(const unsigned char *bytes, size_t count, const char *label, Image *out)
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
    if (!pixels && stbi_failure_reason() == before)
        return result_fail(RESULT_BAD_INPUT,
                           "%s: cannot decode the %s: it is broken, or 2^31 bytes or more", label,
                           kind_of(bytes, count));
    if (!pixels)
        return stb_failure(label, kind_of(bytes, count));
    *out = (Image){width, height, wide ? FORMAT_RGBA16 : FORMAT_RGBA8, pixels};
    return RESULT_OK;
}

Result decode_image(const unsigned char *bytes, size_t count, const char *label, Image *out)
{
    int width, height;
    unsigned char *filled = NULL;
    *out = (Image){0};
    Result result = decode_size(bytes, count, label, &width, &height);
    if (result)
        return result;
    size_t palette = *kind_of(bytes, count) == 'P' ? find_short_palette(bytes, count) : 0;
    if (palette)
        result = fill_palette(bytes, count, palette, label, &filled, &count);
    if (result == RESULT_OK)
        result = load(filled ? filled : bytes, count, label, out);
    free(filled);
    return result;
}

int decode_channels(const unsigned char *bytes, size_t count)
{
    int width, height, channels = 4;
    return stbi_info_from_memory(bytes, (int)count, &width, &height, &channels) ? channels : 4;
}

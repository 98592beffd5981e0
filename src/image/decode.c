#include "image/decode.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

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
#define STBI_ONLY_JPEG
#define STBI_NO_GIF
#define STBI_NO_STDIO
#define STBI_NO_SIMD /* one code for all processors */
#define STBI_FAILURE_USERMSG
/* Declared and defined under different names, which a compiler warns of at the file's end. */
#define stbi_set_unpremultiply_on_load_thread stbi__unpremultiply_on_load_thread
#include <stb_image.h>
#pragma GCC diagnostic pop

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

Result decode_size(const unsigned char *bytes, size_t count, const char *label, int *width,
                   int *height)
{
    const char *kind = kind_of(bytes, count);
    int channels;
    if (!kind)
        return result_fail(RESULT_BAD_INPUT, "%s: expected PNG or JPEG data", label);
    if (count > INT_MAX)
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
    return RESULT_OK;
}

Result decode_image(const unsigned char *bytes, size_t count, const char *label, Image *out)
{
    int width, height, channels;
    *out = (Image){0};
    Result result = decode_size(bytes, count, label, &width, &height);
    if (result)
        return result;
    const char *kind = kind_of(bytes, count);
    bool wide = stbi_is_16_bit_from_memory(bytes, (int)count);
    void *pixels = wide ? (void *)stbi_load_16_from_memory(bytes, (int)count, &width, &height,
                                                           &channels, STBI_rgb_alpha)
                        : (void *)stbi_load_from_memory(bytes, (int)count, &width, &height,
                                                        &channels, STBI_rgb_alpha);
    if (!pixels)
        return stb_failure(label, kind);
    *out = (Image){width, height, wide ? FORMAT_RGBA16 : FORMAT_RGBA8, pixels};
    return RESULT_OK;
}

int decode_channels(const unsigned char *bytes, size_t count)
{
    int width, height, channels = 4;
    return stbi_info_from_memory(bytes, (int)count, &width, &height, &channels) ? channels : 4;
}

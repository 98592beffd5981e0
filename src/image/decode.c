#include "image/decode.h"

#include "image/decode_jpeg.h"
#include "image/png.h"

#include <stdint.h>
#include <string.h>

enum {
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

Result decode_size(const unsigned char *bytes, size_t count, const char *label, int *width,
                   int *height, int *channels)
{
    const char *kind = kind_of(bytes, count);
    if (!kind)
        return result_fail(RESULT_BAD_INPUT, "%s: expected PNG or JPEG data", label);
    Result result = *kind == 'J' ? decode_jpeg_size(bytes, count, label, width, height, channels)
                                 : png_decode_size(bytes, count, label, width, height, channels);
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

Result decode_image(const unsigned char *bytes, size_t count, const char *label, Image *out)
{
    int width, height, channels;
    *out = (Image){0};
    Result result = decode_size(bytes, count, label, &width, &height, &channels);
    if (result != RESULT_OK)
        return result;
    return *kind_of(bytes, count) == 'J' ? decode_jpeg_image(bytes, count, label, out)
                                         : png_decode(bytes, count, label, out);
}

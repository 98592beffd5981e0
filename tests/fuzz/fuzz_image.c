/* PNG and JPEG files: what decode_image makes of any bytes, and of a PNG once more with the
 * checksums that it wants. Images of more than 2^18 pixels are left out, for the time they take. */
#include "fuzz.h"

#include "image/decode.h"
#include "image/png.h"

#include <malloc.h>
#include <stdlib.h>
#include <zlib.h>

enum {
    PIXELS_MAX = 1 << 18
};

static void check_equal(const Image *a, const Image *b, const char *what)
{
    FUZZ_CHECK(a->width == b->width && a->height == b->height && a->format == b->format &&
                   memcmp(a->pixels, b->pixels,
                          (size_t)a->width * (size_t)a->height * format_pixel_bytes(a->format)) ==
                       0,
               "%s: an image of %dx%d pixels", what, a->width, a->height);
}

/* Written as PNG, it reads the same. */
static void check_encoded(const Image *image)
{
    unsigned char *bytes;
    size_t count;
    Image again;
    FUZZ_CHECK(png_encode(image, "encoded", &bytes, &count) == RESULT_OK &&
                   decode_image(bytes, count, "encoded", &again) == RESULT_OK,
               "a decoded image");
    check_equal(image, &again, "encoded and decoded");
    image_free(&again);
    free(bytes);
}

static void try(const uint8_t *data, size_t size)
{
    int width, height, channels;
    Image image, again;
    if (decode_size(data, size, "input", &width, &height, &channels) != RESULT_OK) {
        fuzz_check_message();
        FUZZ_CHECK(decode_image(data, size, "input", &image) != RESULT_OK && !image.pixels,
                   "an image without a size");
        return;
    }
    FUZZ_CHECK(width > 0 && height > 0 && width <= DECODE_MAX_PIXELS && height <= DECODE_MAX_PIXELS,
               "%dx%d", width, height);
    if ((int64_t)width * height > PIXELS_MAX)
        return;
    if (decode_image(data, size, "input", &image) != RESULT_OK) {
        fuzz_check_message();
        FUZZ_CHECK(!image.pixels, "pixels after a failure");
        return;
    }
    FUZZ_CHECK(image.width == width && image.height == height, "%dx%d, the header has %dx%d",
               image.width, image.height, width, height);
    FUZZ_CHECK(image.format == FORMAT_RGBA8 || image.format == FORMAT_RGBA16, "format %d",
               (int)image.format);
    FUZZ_CHECK(channels >= 1 && channels <= 4, "%d channels", channels);
    mallopt(M_PERTURB, 0x5a); /* other bytes in what is not written before it is read */
    FUZZ_CHECK(decode_image(data, size, "input", &again) == RESULT_OK, "decoded once");
    mallopt(M_PERTURB, 0);
    check_equal(&image, &again, "decoded twice");
    if (image.format == FORMAT_RGBA8)
        check_encoded(&image);
    image_free(&again);
    image_free(&image);
}

static void put_word(uint8_t *at, uint32_t word)
{
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(word >> (24 - 8 * i));
}

/* Gives every chunk its checksum. Source: PNG (Third Edition), 5.3. */
static void seal(uint8_t *png, size_t size)
{
    for (size_t at = 8; size - at >= 12;) {
        const uint8_t *chunk = png + at;
        size_t length = (size_t)chunk[0] << 24 | (size_t)chunk[1] << 16 | (size_t)chunk[2] << 8 |
                        (size_t)chunk[3];
        if (length > size - at - 12)
            return;
        put_word(png + at + 8 + length, (uint32_t)crc32(0, chunk + 4, (uInt)length + 4));
        at += 12 + length;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    try(data, size);
    if (size < 8 || memcmp(data, "\x89PNG\r\n\x1a\n", 8) != 0)
        return 0;
    uint8_t *sealed = malloc(size);
    FUZZ_CHECK(sealed, "%zu bytes", size);
    memcpy(sealed, data, size);
    seal(sealed, size);
    if (memcmp(sealed, data, size) != 0)
        try(sealed, size);
    free(sealed);
    return 0;
}

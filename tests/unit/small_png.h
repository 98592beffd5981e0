/* Small PNG files for tests, written here: the program's own encoder makes only one kind. */
#ifndef PEEL_TESTS_SMALL_PNG_H
#define PEEL_TESTS_SMALL_PNG_H

#include <check.h>
#include <stdint.h>
#include <string.h>
#include <zlib.h>

/* Colour types of PNG. */
enum {
    PNG_GREY = 0,
    PNG_RGB = 2,
    PNG_PALETTE = 3,
    PNG_GREY_ALPHA = 4,
    PNG_RGBA = 6
};

typedef struct SmallPng {
    unsigned char bytes[4096];
    size_t count;
} SmallPng;

static inline void png_word(SmallPng *png, uint32_t word)
{
    for (int shift = 24; shift >= 0; shift -= 8)
        png->bytes[png->count++] = (unsigned char)(word >> shift);
}

static inline void png_chunk(SmallPng *png, const char *type, const void *data, size_t count)
{
    size_t begin = png->count + 4;
    ck_assert_uint_le(png->count + count + 12, sizeof png->bytes);
    png_word(png, (uint32_t)count);
    memcpy(png->bytes + begin, type, 4);
    if (count)
        memcpy(png->bytes + begin + 4, data, count);
    png->count = begin + 4 + count;
    png_word(png, (uint32_t)crc32(0, png->bytes + begin, (uInt)count + 4));
}

static inline SmallPng png_begin(uint32_t width, uint32_t height, int depth, int type)
{
    SmallPng png = {.count = 8}, header = {.count = 0};
    memcpy(png.bytes, "\x89PNG\r\n\x1a\n", 8);
    png_word(&header, width);
    png_word(&header, height);
    header.bytes[8] = (unsigned char)depth;
    header.bytes[9] = (unsigned char)type;
    png_chunk(&png, "IHDR", header.bytes, 13);
    return png;
}

/* rows: as PNG stores them, each row_bytes long; 16-bit samples with their high byte first. */
static inline void png_end(SmallPng *png, const void *rows, size_t row_bytes, size_t row_count)
{
    unsigned char raw[2048], packed[2400];
    uLongf size = sizeof packed;
    ck_assert_uint_le((row_bytes + 1) * row_count, sizeof raw);
    for (size_t y = 0; y < row_count; y++) {
        raw[y * (row_bytes + 1)] = 0; /* no filter */
        memcpy(raw + y * (row_bytes + 1) + 1, (const unsigned char *)rows + y * row_bytes,
               row_bytes);
    }
    ck_assert_int_eq(compress(packed, &size, raw, (uLong)((row_bytes + 1) * row_count)), Z_OK);
    png_chunk(png, "IDAT", packed, size);
    png_chunk(png, "IEND", NULL, 0);
}

static inline SmallPng png_make(uint32_t width, uint32_t height, int depth, int type,
                                const void *rows, size_t row_bytes)
{
    SmallPng png = png_begin(width, height, depth, type);
    png_end(&png, rows, row_bytes, height);
    return png;
}

#endif

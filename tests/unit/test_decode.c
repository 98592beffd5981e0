/* image/decode: what a PNG or JPEG holds comes out, what is broken is refused. */
#include "image/decode.h"
#include "image/png.h"

#include "scratch.h"
#include "small_png.h"
#include "testing.h"

#include <stdio.h>

static void decodes(const SmallPng *png, PixelFormat format, const void *expected, size_t size)
{
    Image image;
    Result result = decode_image(png->bytes, png->count, "x", &image);
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
    ck_assert_int_eq(image.format, format);
    ck_assert_uint_eq((size_t)image.width * (size_t)image.height * format_pixel_bytes(format),
                      size);
    ck_assert_mem_eq(image.pixels, expected, size);
    image_free(&image);
}

START_TEST(channels)
{
    static const uint8_t grey[] = {0, 7, 255}, pair[] = {9, 8, 200, 0}, rgb[] = {1, 2, 3, 4, 5, 6};
    static const uint8_t rgba[] = {1, 2, 3, 0, 250, 251, 252, 253}, bits[] = {0x80};
    SmallPng png = png_make(1, 3, 8, PNG_GREY, grey, 1);
    decodes(&png, FORMAT_RGBA8, (uint8_t[]){0, 0, 0, 255, 7, 7, 7, 255, 255, 255, 255, 255}, 12);
    png = png_make(2, 1, 8, PNG_GREY_ALPHA, pair, 4);
    decodes(&png, FORMAT_RGBA8, (uint8_t[]){9, 9, 9, 8, 200, 200, 200, 0}, 8);
    png = png_make(2, 1, 8, PNG_RGB, rgb, 6);
    decodes(&png, FORMAT_RGBA8, (uint8_t[]){1, 2, 3, 255, 4, 5, 6, 255}, 8);
    png = png_make(2, 1, 8, PNG_RGBA, rgba, 8);
    decodes(&png, FORMAT_RGBA8, rgba, 8);
    png = png_make(2, 1, 1, PNG_GREY, bits, 1);
    decodes(&png, FORMAT_RGBA8, (uint8_t[]){255, 255, 255, 255, 0, 0, 0, 255}, 8);
}
END_TEST

START_TEST(palettes)
{
    SmallPng png = png_begin(3, 1, 8, PNG_PALETTE);
    png_chunk(&png, "PLTE", (uint8_t[]){10, 20, 30, 40, 50, 60}, 6);
    png_chunk(&png, "tRNS", (uint8_t[]){128}, 1);
    png_end(&png, (uint8_t[]){1, 0, 1}, 3, 1);
    decodes(&png, FORMAT_RGBA8, (uint8_t[]){40, 50, 60, 255, 10, 20, 30, 128, 40, 50, 60, 255}, 12);
}
END_TEST

/* Black: not what memory had there. */
START_TEST(index_behind_the_palette)
{
    SmallPng png = png_begin(3, 1, 8, PNG_PALETTE);
    png_chunk(&png, "gAMA", (uint8_t[]){0, 0, 0x27, 0x10}, 4);
    png_chunk(&png, "PLTE", (uint8_t[]){10, 20, 30, 40, 50, 60}, 6);
    png_end(&png, (uint8_t[]){1, 2, 255}, 3, 1);
    decodes(&png, FORMAT_RGBA8, (uint8_t[]){40, 50, 60, 255, 0, 0, 0, 255, 0, 0, 0, 255}, 12);
}
END_TEST

START_TEST(sixteen_bits)
{
    static const uint8_t rgb[] = {0x12, 0x34, 0, 1, 0xff, 0xff}, grey[] = {0x80, 0x01};
    SmallPng png = png_make(1, 1, 16, PNG_RGB, rgb, 6);
    decodes(&png, FORMAT_RGBA16, (uint16_t[]){0x1234, 1, 65535, 65535}, 8);
    png = png_make(1, 1, 16, PNG_GREY, grey, 2);
    decodes(&png, FORMAT_RGBA16, (uint16_t[]){0x8001, 0x8001, 0x8001, 65535}, 8);
}
END_TEST

/* A declared gamma changes nothing. */
START_TEST(gamma_is_ignored)
{
    SmallPng png = png_begin(1, 1, 8, PNG_RGB);
    png_chunk(&png, "gAMA", (uint8_t[]){0, 0, 0x27, 0x10}, 4); /* 0.1 */
    png_end(&png, (uint8_t[]){100, 50, 25}, 3, 1);
    decodes(&png, FORMAT_RGBA8, (uint8_t[]){100, 50, 25, 255}, 4);
}
END_TEST

START_TEST(encoded_pixels_come_back)
{
    Image image;
    SmallPng png;
    unsigned char *bytes = NULL;
    ck_assert_int_eq(image_create(7, 5, FORMAT_RGBA8, &image), RESULT_OK);
    uint8_t *pixels = image.pixels;
    for (int i = 0; i < 140; i++)
        pixels[i] = (uint8_t)(i * 37);
    ck_assert_int_eq(png_encode(&image, "x", &bytes, &png.count), RESULT_OK);
    ck_assert_uint_le(png.count, sizeof png.bytes);
    memcpy(png.bytes, bytes, png.count);
    free(bytes);
    decodes(&png, FORMAT_RGBA8, pixels, 140);
    image_free(&image);
}
END_TEST

static void refused(const unsigned char *bytes, size_t count, const char *part)
{
    Image image;
    /* An exact copy, so that a read past its end is seen under the sanitizers. */
    unsigned char *copy = malloc(count ? count : 1);
    ck_assert_ptr_nonnull(copy);
    memcpy(copy, bytes, count);
    ck_assert_msg(decode_image(copy, count, "here", &image) == RESULT_BAD_INPUT,
                  "%zu bytes are not refused", count);
    ck_assert_ptr_null(image.pixels);
    ck_assert_msg(strncmp(result_message(), "here: ", 6) == 0 && strstr(result_message(), part),
                  "got \"%s\", expected \"%s\" in it", result_message(), part);
    free(copy);
}

START_TEST(broken_files)
{
    static const uint8_t rgb[48] = {3, 1, 4, 1, 5, 9};
    SmallPng png = png_make(4, 4, 8, PNG_RGB, rgb, 12);
    for (size_t count = 0; count < png.count - 12; count++) /* IEND says nothing */
        refused(png.bytes, count, "");
    refused((const unsigned char *)"GIF89a", 6, "expected PNG or JPEG data");
    png = png_make(4, 2, 8, PNG_RGB, rgb, 12);
    png.bytes[23] = 4; /* says four rows, has two */
    refused(png.bytes, png.count, "cannot decode the PNG: Corrupt PNG");
    png = png_make(16385, 1, 8, PNG_GREY, rgb, 1);
    refused(png.bytes, png.count, "16385x1 pixels, expected 1 to 16384 a side");
    png = png_make(0, 1, 8, PNG_GREY, rgb, 1);
    refused(png.bytes, png.count, "cannot decode the PNG");
}
END_TEST

/* A JPEG by oiiotool, four colours 8 × 8 each; it keeps flat colours to within a few codes. */
static size_t make_jpeg(unsigned char *bytes, size_t room)
{
    char command[512], text[256];
    const char *path = scratch_path("a.jpg");
    snprintf(command, sizeof command,
             "oiiotool --create 32x8 3 --box:color=0.2,0.4,0.6:fill=1 0,0,15,7 "
             "--box:color=1,0,0.5:fill=1 16,0,31,7 -d uint8 --compression jpeg:95 "
             "--attrib jpeg:subsampling 4:4:4 -o %s 2>&1",
             path);
    ck_assert_msg(scratch_run(command, text, sizeof text) == 0, "%s", text);
    return scratch_read(path, (char *)bytes, room);
}

START_TEST(jpeg)
{
    static const int expected[2][3] = {{51, 102, 153}, {255, 0, 128}};
    unsigned char bytes[8192];
    size_t count = make_jpeg(bytes, sizeof bytes);
    Image image;
    ck_assert_uint_lt(count, sizeof bytes - 1);
    Result result = decode_image(bytes, count, "x", &image);
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
    ck_assert_int_eq(image.width, 32);
    ck_assert_int_eq(image.height, 8);
    for (int side = 0; side < 2; side++) {
        const uint8_t *pixel = image_pixel(&image, 4 + 24 * side, 4);
        for (int c = 0; c < 3; c++)
            ck_assert_int_le(abs(pixel[c] - expected[side][c]), 3);
        ck_assert_int_eq(pixel[3], 255);
    }
    image_free(&image);
    for (size_t cut = 0; cut + 1 < count; cut++)
        refused(bytes, cut, "");
    refused(bytes, count - 2, "ends too early");
    size_t at = 0;
    while (memcmp(bytes + at, "\xff\xc0", 2) != 0) /* the frame's header: of that many pixels */
        ck_assert_uint_lt(++at, count - 9);
    memcpy(bytes + at + 5, "\x40\0\x40\0", 4);
    refused(bytes, count, "bytes of 16384x16384 pixels");
}
END_TEST

/* The same pixels with a restart behind the last of the four blocks. */
START_TEST(jpeg_restarts)
{
    unsigned char bytes[8192];
    size_t count = make_jpeg(bytes, sizeof bytes - 8), at = 0;
    Image plain, restarted;
    ck_assert_int_eq(decode_image(bytes, count, "x", &plain), RESULT_OK);
    while (memcmp(bytes + at, "\xff\xda", 2) != 0)
        ck_assert_uint_lt(++at, count - 1);
    memmove(bytes + at + 6, bytes + at, count - at);
    memcpy(bytes + at, "\xff\xdd\0\4\0\4", 6);
    memcpy(bytes + count + 4, "\xff\xd0\xff\xd9", 4);
    Result result = decode_image(bytes, count + 8, "x", &restarted);
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
    ck_assert_mem_eq(plain.pixels, restarted.pixels, 32 * 8 * 4);
    image_free(&plain);
    image_free(&restarted);
}
END_TEST

/* stb writes past its table for more than 256 codes, and reads on where a segment ends too early.
 */
START_TEST(huffman_tables)
{
    for (size_t codes = 255; codes <= 257; codes++) {
        unsigned char bytes[300] = {0xff, 0xd8, 0xff, 0xc4};
        size_t length = 2 + 17 + codes;
        bytes[4] = (unsigned char)(length >> 8);
        bytes[5] = (unsigned char)length;
        bytes[21] = 255;
        bytes[22] = (unsigned char)(codes - 255);
        bytes[2 + 2 + length] = 0xff;
        bytes[2 + 2 + length + 1] = 0xd9;
        refused(bytes, 2 + 2 + length + 2, codes > 256 ? "broken Huffman tables" : "or corrupt");
        bytes[5]--; /* the last code is outside */
        refused(bytes, 2 + 2 + length + 2, "broken Huffman tables");
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("decode");
    TCase *test = tcase_create("decode");
    tcase_set_timeout(test, 60);
    tcase_add_checked_fixture(test, scratch_make, scratch_remove);
    tcase_add_test(test, channels);
    tcase_add_test(test, palettes);
    tcase_add_test(test, index_behind_the_palette);
    tcase_add_test(test, sixteen_bits);
    tcase_add_test(test, gamma_is_ignored);
    tcase_add_test(test, encoded_pixels_come_back);
    tcase_add_test(test, broken_files);
    tcase_add_test(test, jpeg);
    tcase_add_test(test, jpeg_restarts);
    tcase_add_test(test, huffman_tables);
    suite_add_tcase(suite, test);
    return testing_run(suite);
}

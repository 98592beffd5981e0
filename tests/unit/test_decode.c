/* image/decode: what a PNG or JPEG holds comes out, what is broken is refused. */
#include "image/decode.h"
#include "image/png.h"

#include "scratch.h"
#include "small_png.h"
#include "testing.h"

#include <stdio.h>

#include <jpeglib.h>

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

/* One colour that is transparent: a channel more. */
START_TEST(color_key)
{
    static const struct {
        int type;
        uint8_t row[6], key[6], rgba[8];
        int row_bytes, key_bytes;
    } kinds[] = {
        {PNG_RGB, {1, 2, 3, 4, 5, 6}, {0, 4, 0, 5, 0, 6}, {1, 2, 3, 255, 4, 5, 6, 0}, 6, 6},
        {PNG_GREY, {7, 8}, {0, 7}, {7, 7, 7, 0, 8, 8, 8, 255}, 2, 2}};
    for (int i = 0; i < 2; i++)
        for (int keyed = 0; keyed < 2; keyed++) {
            int width, height, stored = 0;
            SmallPng png = png_begin(2, 1, 8, kinds[i].type);
            if (keyed)
                png_chunk(&png, "tRNS", kinds[i].key, (size_t)kinds[i].key_bytes);
            png_end(&png, kinds[i].row, (size_t)kinds[i].row_bytes, 1);
            if (keyed)
                decodes(&png, FORMAT_RGBA8, kinds[i].rgba, 8);
            ck_assert_int_eq(decode_size(png.bytes, png.count, "x", &width, &height, &stored),
                             RESULT_OK);
            ck_assert_int_eq(stored, (kinds[i].type == PNG_RGB ? 3 : 1) + keyed);
        }
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
    for (size_t count = 0; count < png.count; count++)
        refused(png.bytes, count, "");
    refused((const unsigned char *)"GIF89a", 6, "expected PNG or JPEG data");
    png = png_begin(4, 4, 8, PNG_RGB);
    png_end(&png, rgb, 12, 2);
    refused(png.bytes, png.count, "cannot decode the PNG: Not enough image data");
    png = png_make(16385, 1, 8, PNG_GREY, rgb, 1);
    refused(png.bytes, png.count, "16385x1 pixels, expected 1 to 16384 a side");
    png = png_make(0, 1, 8, PNG_GREY, rgb, 1);
    refused(png.bytes, png.count, "cannot decode the PNG");
}
END_TEST

/* Every chunk has a checksum: no bit can be another without being seen. */
START_TEST(png_damaged)
{
    SmallPng png = png_begin(2, 1, 8, PNG_PALETTE);
    png_chunk(&png, "PLTE", (uint8_t[]){10, 20, 30, 40, 50, 60}, 6);
    png_chunk(&png, "tRNS", (uint8_t[]){128}, 1);
    png_chunk(&png, "tEXt", "a\0b", 3);
    png_end(&png, (uint8_t[]){1, 0}, 2, 1);
    decodes(&png, FORMAT_RGBA8, (uint8_t[]){40, 50, 60, 255, 10, 20, 30, 128}, 8);
    for (size_t bit = 0; bit < 8 * png.count; bit++) {
        png.bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
        refused(png.bytes, png.count, "");
        png.bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
    }
}
END_TEST

/* Four by four pixels in Adam7's seven passes, of which five have any. */
START_TEST(interlaced)
{
    static const uint8_t passes[] = {0,  0, 0, 2, 0, 8, 10, 0,  1,  3,  0, 9,
                                     11, 0, 4, 5, 6, 7, 0,  12, 13, 14, 15};
    SmallPng png = {.count = 8}, header = {.count = 0};
    unsigned char packed[64];
    uLongf size = sizeof packed;
    memcpy(png.bytes, "\x89PNG\r\n\x1a\n", 8);
    png_word(&header, 4);
    png_word(&header, 4);
    memcpy(header.bytes + 8, (uint8_t[]){8, PNG_GREY, 0, 0, 1}, 5);
    png_chunk(&png, "IHDR", header.bytes, 13);
    ck_assert_int_eq(compress(packed, &size, passes, sizeof passes), Z_OK);
    png_chunk(&png, "IDAT", packed, size);
    png_chunk(&png, "IEND", NULL, 0);
    uint8_t expected[64];
    for (int i = 0; i < 64; i++)
        expected[i] = (uint8_t)(i % 4 == 3 ? 255 : i / 4);
    decodes(&png, FORMAT_RGBA8, expected, sizeof expected);
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
    refused(bytes, count - 2, "remature end of JPEG file");
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

/* ---- JPEG files by libjpeg ---- */

typedef struct JpegKind {
    J_COLOR_SPACE space;
    int channels;
    bool progressive;
    unsigned char pixel[4], expected[3];
} JpegKind;

/* 24 × 16 pixels of one colour; with a script in these scans. The caller frees *bytes. */
static unsigned long write_jpeg(const JpegKind *kind, const jpeg_scan_info *script, int scans,
                                unsigned char **bytes)
{
    struct jpeg_compress_struct info = {0};
    struct jpeg_error_mgr errors;
    unsigned long count = 0;
    unsigned char row[4 * 24], *rows[1] = {row};
    for (int i = 0; i < 24 * kind->channels; i++)
        row[i] = kind->pixel[i % kind->channels];
    *bytes = NULL;
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    jpeg_mem_dest(&info, bytes, &count);
    info.image_width = 24;
    info.image_height = 16;
    info.input_components = kind->channels;
    info.in_color_space = kind->space;
    jpeg_set_defaults(&info);
    if (kind->progressive)
        jpeg_simple_progression(&info);
    if (script) {
        info.scan_info = script;
        info.num_scans = scans;
    }
    jpeg_start_compress(&info, TRUE);
    while (info.next_scanline < info.image_height)
        jpeg_write_scanlines(&info, rows, 1);
    jpeg_finish_compress(&info);
    jpeg_destroy_compress(&info);
    return count;
}

/* What is written for CMYK has Adobe's marker: 255 is no ink. */
START_TEST(jpeg_kinds)
{
    static const JpegKind kinds[] = {
        {JCS_GRAYSCALE, 1, false, {77}, {77, 77, 77}},
        {JCS_RGB, 3, false, {10, 200, 90}, {10, 200, 90}},
        {JCS_RGB, 3, true, {10, 200, 90}, {10, 200, 90}},
        {JCS_CMYK, 4, false, {255, 128, 0, 255}, {255, 128, 0}},
        {JCS_CMYK, 4, true, {255, 128, 64, 128}, {128, 64, 32}},
    };
    const JpegKind *kind = &kinds[_i];
    unsigned char *bytes;
    size_t count = write_jpeg(kind, NULL, 0, &bytes);
    Image image;
    int width, height, stored;
    Result result = decode_image(bytes, count, "x", &image);
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
    ck_assert(image.width == 24 && image.height == 16 && image.format == FORMAT_RGBA8);
    for (int at = 0; at < 24 * 16; at++) {
        const uint8_t *pixel = image_pixel(&image, at % 24, at / 24);
        for (int c = 0; c < 3; c++)
            ck_assert_int_le(abs(pixel[c] - kind->expected[c]), 3);
        ck_assert_int_eq(pixel[3], 255);
    }
    ck_assert_int_eq(decode_size(bytes, count, "x", &width, &height, &stored), RESULT_OK);
    ck_assert(width == image.width && height == image.height);
    ck_assert_int_eq(stored, kind->channels == 1 ? 1 : 3);
    image_free(&image);
    for (size_t cut = 0; cut + 1 < count; cut++)
        refused(bytes, cut, "");
    free(bytes);
}
END_TEST

/* One byte of the data changed at a time: decoded or refused, never more. */
START_TEST(jpeg_damaged)
{
    static const JpegKind kind = {JCS_RGB, 3, true, {10, 200, 90}, {0}};
    unsigned char *bytes;
    unsigned long count = write_jpeg(&kind, NULL, 0, &bytes);
    int decoded = 0;
    for (unsigned long at = 0; at < count; at++)
        for (int bit = 0; bit < 8; bit++) {
            Image image;
            bytes[at] ^= (unsigned char)(1 << bit);
            Result result = decode_image(bytes, count, "x", &image);
            ck_assert_msg(result == RESULT_OK || result == RESULT_BAD_INPUT, "%s",
                          result_message());
            decoded += result == RESULT_OK;
            image_free(&image);
            bytes[at] ^= (unsigned char)(1 << bit);
        }
    ck_assert_int_gt(decoded, 0);
    free(bytes);
}
END_TEST

/* Each coefficient of each block in scans of its own, a bit at a time. */
START_TEST(jpeg_scans)
{
    static const JpegKind kind = {JCS_GRAYSCALE, 1, true, {77}, {0}};
    static jpeg_scan_info script[1 + 63 * 10] = {{.comps_in_scan = 1}};
    int scans = 1;
    for (int coefficient = 1; coefficient < 64; coefficient++)
        for (int bit = 9; bit >= 0; bit--)
            script[scans++] = (jpeg_scan_info){.comps_in_scan = 1,
                                               .Ss = coefficient,
                                               .Se = coefficient,
                                               .Ah = bit == 9 ? 0 : bit + 1,
                                               .Al = bit};
    for (int many = 0; many < 2; many++) {
        unsigned char *bytes;
        unsigned long count = write_jpeg(&kind, script, many ? scans : 401, &bytes);
        Image image;
        if (many) {
            refused(bytes, count, "more than 500 scans");
        } else {
            ck_assert_int_eq(decode_image(bytes, count, "x", &image), RESULT_OK);
            image_free(&image);
        }
        free(bytes);
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
    tcase_add_test(test, color_key);
    tcase_add_test(test, index_behind_the_palette);
    tcase_add_test(test, sixteen_bits);
    tcase_add_test(test, gamma_is_ignored);
    tcase_add_test(test, encoded_pixels_come_back);
    tcase_add_test(test, broken_files);
    tcase_add_test(test, png_damaged);
    tcase_add_test(test, interlaced);
    tcase_add_test(test, jpeg);
    tcase_add_test(test, jpeg_restarts);
    tcase_add_loop_test(test, jpeg_kinds, 0, 5);
    tcase_add_test(test, jpeg_damaged);
    tcase_add_test(test, jpeg_scans);
    suite_add_tcase(suite, test);
    return testing_run(suite);
}

#include "image/decode_png.h"

#include <png.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

typedef struct PngReader {
    png_structp png;
    png_infop info;
    const unsigned char *bytes;
    size_t left;
    const char *label;
    bool short_of_memory; /* which libpng takes for a fault of the image in places */
    Result result;
} PngReader;

/* ---- what libpng calls ----------------------------------------------------------------------- */

static png_voidp allocate(png_structp png, png_alloc_size_t size)
{
    PngReader *reader = png_get_mem_ptr(png);
    void *out = malloc(size);
    reader->short_of_memory |= !out;
    return out;
}

static void release(png_structp png, png_voidp memory)
{
    (void)png;
    free(memory);
}

static Result out_of_memory(const PngReader *reader)
{
    return result_fail(RESULT_NO_MEMORY, "%s: out of memory for its pixels", reader->label);
}

static void on_error(png_structp png, png_const_charp reason)
{
    PngReader *reader = png_get_error_ptr(png);
    reader->result =
        reader->short_of_memory
            ? out_of_memory(reader)
            : result_fail(RESULT_BAD_INPUT, "%s: cannot decode the PNG: %s", reader->label, reason);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp reason)
{
    (void)png, (void)reason;
}

static void read_bytes(png_structp png, png_bytep out, size_t count)
{
    PngReader *reader = png_get_io_ptr(png);
    if (count > reader->left)
        png_error(png, "the file ends too early");
    memcpy(out, reader->bytes, count);
    reader->bytes += count;
    reader->left -= count;
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Chunks that say how the pixels are to be shown are left out; damaged, they are still refused. */
static void begin(PngReader *reader)
{
    png_structp png = reader->png;
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    png_set_read_fn(png, reader, read_bytes);
    png_read_info(png, reader->info);
}

/* Whether the pixels have alpha, a transparent colour's included. */
static bool has_alpha(const PngReader *reader)
{
    return (png_get_color_type(reader->png, reader->info) & PNG_COLOR_MASK_ALPHA) ||
           png_get_valid(reader->png, reader->info, PNG_INFO_tRNS);
}

static void read_pixels(PngReader *reader, Image *out)
{
    png_structp png = reader->png;
    int width = (int)png_get_image_width(png, reader->info);
    int height = (int)png_get_image_height(png, reader->info);
    bool wide = png_get_bit_depth(png, reader->info) == 16;
    const uint16_t one = 1;
    png_set_expand(png);
    png_set_gray_to_rgb(png);
    if (!has_alpha(reader))
        png_set_add_alpha(png, wide ? 0xffff : 0xff, PNG_FILLER_AFTER);
    if (wide && *(const unsigned char *)&one)
        png_set_swap(png); /* the file's are big-endian */
    int passes = png_set_interlace_handling(png);
    png_read_update_info(png, reader->info);
    reader->short_of_memory |=
        image_create(width, height, wide ? FORMAT_RGBA16 : FORMAT_RGBA8, out) != RESULT_OK;
    if (reader->short_of_memory)
        png_error(png, "");
    for (int pass = 0; pass < passes; pass++)
        for (int y = 0; y < height; y++)
            png_read_row(png, image_pixel(out, 0, y), NULL);
    png_read_end(png, NULL);
}

/* Begins to read, and reads the pixels to out, unless that is NULL. Whatever it returns, end_png
 * follows. */
static Result begin_png(PngReader *reader, Image *out)
{
    reader->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, reader, on_error, on_warning,
                                           reader, allocate, release);
    reader->info = reader->png ? png_create_info_struct(reader->png) : NULL;
    if (!reader->info)
        return out_of_memory(reader);
    if (setjmp(png_jmpbuf(reader->png)) == 0) {
        begin(reader);
        if (out)
            read_pixels(reader, out);
    }
    /* It went on without what there was no memory for. */
    if (reader->result == RESULT_OK && reader->short_of_memory)
        reader->result = out_of_memory(reader);
    if (reader->result != RESULT_OK && out)
        image_free(out);
    return reader->result;
}

static void end_png(PngReader *reader)
{
    png_destroy_read_struct(&reader->png, &reader->info, NULL);
}

Result decode_png_size(const unsigned char *bytes, size_t count, const char *label, int *width,
                       int *height, int *channels)
{
    PngReader reader = {.bytes = bytes, .left = count, .label = label};
    Result result = begin_png(&reader, NULL);
    if (result == RESULT_OK) {
        bool colors = png_get_color_type(reader.png, reader.info) & PNG_COLOR_MASK_COLOR;
        *width = (int)png_get_image_width(reader.png, reader.info);
        *height = (int)png_get_image_height(reader.png, reader.info);
        *channels = (colors ? 3 : 1) + has_alpha(&reader);
    }
    end_png(&reader);
    return result;
}

Result decode_png_image(const unsigned char *bytes, size_t count, const char *label, Image *out)
{
    PngReader reader = {.bytes = bytes, .left = count, .label = label};
    *out = (Image){0};
    Result result = begin_png(&reader, out);
    end_png(&reader);
    return result;
}

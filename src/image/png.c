#include "image/png.h"

#include "base/file.h"
#include "base/memory.h"

#include <png.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* A file that is read or written. */
typedef struct Png {
    png_structp png;
    png_infop info;
    const char *label, *doing; /* "decode" or "encode": for messages */
    bool short_of_memory;      /* which libpng takes for a fault of the image in places */
    Result result;
    const unsigned char *bytes; /* to be read, */
    size_t left;                /* and how many */
    FileWriter *file;           /* to be written; NULL: to out */
    unsigned char *out;
    size_t count, capacity;
} Png;

/* ---- what libpng calls ----------------------------------------------------------------------- */

static png_voidp allocate(png_structp png, png_alloc_size_t size)
{
    Png *file = png_get_mem_ptr(png);
    void *out = malloc(size);
    file->short_of_memory |= !out;
    return out;
}

static void release(png_structp png, png_voidp memory)
{
    (void)png;
    free(memory);
}

static Result out_of_memory(const Png *file)
{
    return result_fail(RESULT_NO_MEMORY, "%s: out of memory for its pixels", file->label);
}

static void on_error(png_structp png, png_const_charp reason)
{
    Png *file = png_get_error_ptr(png);
    file->result = file->short_of_memory
                       ? out_of_memory(file)
                       : result_fail(RESULT_BAD_INPUT, "%s: cannot %s the PNG: %s", file->label,
                                     file->doing, reason);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp reason)
{
    (void)png, (void)reason;
}

static void read_bytes(png_structp png, png_bytep out, size_t count)
{
    Png *file = png_get_io_ptr(png);
    if (count > file->left)
        png_error(png, "the file ends too early");
    memcpy(out, file->bytes, count);
    file->bytes += count;
    file->left -= count;
}

static void write_bytes(png_structp png, png_bytep bytes, size_t count)
{
    Png *file = png_get_io_ptr(png);
    if (file->file) {
        file_writer_put(file->file, bytes, count);
        return;
    }
    file->short_of_memory |=
        memory_grow((void **)&file->out, &file->capacity, file->count + count, 1) != RESULT_OK;
    if (file->short_of_memory)
        png_error(png, "");
    memcpy(file->out + file->count, bytes, count);
    file->count += count;
}

/* The file is at its end, or will not be read or written further: whether all is well. */
static Result finish(Png *file)
{
    /* libpng may have gone on without what there was no memory for. */
    if (file->result == RESULT_OK && file->short_of_memory)
        file->result = out_of_memory(file);
    return file->result;
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Chunks that say how the pixels are to be shown are left out; damaged, they are still refused. */
static void begin(Png *file)
{
    png_structp png = file->png;
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    png_set_read_fn(png, file, read_bytes);
    png_read_info(png, file->info);
}

/* Whether the pixels have alpha, a transparent colour's included. */
static bool has_alpha(const Png *file)
{
    return (png_get_color_type(file->png, file->info) & PNG_COLOR_MASK_ALPHA) ||
           png_get_valid(file->png, file->info, PNG_INFO_tRNS);
}

static void read_pixels(Png *file, Image *out)
{
    png_structp png = file->png;
    int width = (int)png_get_image_width(png, file->info);
    int height = (int)png_get_image_height(png, file->info);
    bool wide = png_get_bit_depth(png, file->info) == 16;
    const uint16_t one = 1;
    png_set_expand(png);
    png_set_gray_to_rgb(png);
    if (!has_alpha(file))
        png_set_add_alpha(png, wide ? 0xffff : 0xff, PNG_FILLER_AFTER);
    if (wide && *(const unsigned char *)&one)
        png_set_swap(png); /* the file's are big-endian */
    int passes = png_set_interlace_handling(png);
    png_read_update_info(png, file->info);
    file->short_of_memory |=
        image_create(width, height, wide ? FORMAT_RGBA16 : FORMAT_RGBA8, out) != RESULT_OK;
    if (file->short_of_memory)
        png_error(png, "");
    for (int pass = 0; pass < passes; pass++)
        for (int y = 0; y < height; y++)
            png_read_row(png, image_pixel(out, 0, y), NULL);
    png_read_end(png, NULL);
}

/* Begins to read, and reads the pixels to out, unless that is NULL. Whatever it returns,
 * png_destroy_read_struct follows. */
static Result read_png(Png *file, Image *out)
{
    file->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, file, on_error, on_warning, file,
                                         allocate, release);
    file->info = file->png ? png_create_info_struct(file->png) : NULL;
    if (!file->info)
        return out_of_memory(file);
    if (setjmp(png_jmpbuf(file->png)) == 0) {
        begin(file);
        if (out)
            read_pixels(file, out);
    }
    Result result = finish(file);
    if (result != RESULT_OK && out)
        image_free(out);
    return result;
}

Result png_decode_size(const unsigned char *bytes, size_t count, const char *label, int *width,
                       int *height, int *channels)
{
    Png file = {.bytes = bytes, .left = count, .label = label, .doing = "decode"};
    Result result = read_png(&file, NULL);
    if (result == RESULT_OK) {
        bool colors = png_get_color_type(file.png, file.info) & PNG_COLOR_MASK_COLOR;
        *width = (int)png_get_image_width(file.png, file.info);
        *height = (int)png_get_image_height(file.png, file.info);
        *channels = (colors ? 3 : 1) + has_alpha(&file);
    }
    png_destroy_read_struct(&file.png, &file.info, NULL);
    return result;
}

Result png_decode(const unsigned char *bytes, size_t count, const char *label, Image *out)
{
    Png file = {.bytes = bytes, .left = count, .label = label, .doing = "decode"};
    *out = (Image){0};
    Result result = read_png(&file, out);
    png_destroy_read_struct(&file.png, &file.info, NULL);
    return result;
}

/* ---- writing --------------------------------------------------------------------------------- */

/* rgb: alpha is left out. */
static void write_pixels(Png *file, const Image *image, bool rgb)
{
    png_structp png = file->png;
    png_set_write_fn(png, file, write_bytes, NULL);
    png_set_IHDR(png, file->info, (png_uint_32)image->width, (png_uint_32)image->height, 8,
                 rgb ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, file->info);
    if (rgb)
        png_set_filler(png, 0, PNG_FILLER_AFTER);
    for (int y = 0; y < image->height; y++)
        png_write_row(png, image_pixel(image, 0, y));
    png_write_end(png, NULL);
}

static Result write_png(Png *file, const Image *image, bool rgb)
{
    file->png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, file, on_error, on_warning, file,
                                          allocate, release);
    file->info = file->png ? png_create_info_struct(file->png) : NULL;
    if (!file->info)
        file->result = out_of_memory(file);
    else if (setjmp(png_jmpbuf(file->png)) == 0)
        write_pixels(file, image, rgb);
    png_destroy_write_struct(&file->png, &file->info);
    return finish(file);
}

static Result check(const Image *image, const char *label)
{
    if (image->format != FORMAT_RGBA8 || !image->pixels || image->width < 1 || image->height < 1)
        return result_fail(RESULT_INTERNAL, "%s: expected an rgba8 image with pixels", label);
    return RESULT_OK;
}

Result png_encode(const Image *image, const char *label, unsigned char **bytes, size_t *count)
{
    Png file = {.label = label, .doing = "encode"};
    *bytes = NULL;
    Result result = check(image, label);
    if (result == RESULT_OK)
        result = write_png(&file, image, false);
    if (result != RESULT_OK) {
        free(file.out);
        return result;
    }
    *bytes = file.out;
    *count = file.count;
    return RESULT_OK;
}

Result png_write(const Image *image, const char *path)
{
    FileWriter writer;
    Png file = {.label = path, .doing = "encode", .file = &writer};
    Result result = check(image, path);
    if (result == RESULT_OK)
        result = file_writer_open(path, &writer);
    if (result != RESULT_OK)
        return result;
    result = write_png(&file, image, true);
    Result closed = file_writer_close(&writer, result == RESULT_OK);
    return result == RESULT_OK ? closed : result;
}

#include "image/dump.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum {
    SIDE_MAX = 16384
};

/* One buffer's line. */
typedef struct Header {
    char name[DUMP_NAME];
    PixelFormat format;
    int width, height;
    bool bottom_up;
} Header;

static Result fail(const char *path, int number, const char *what)
{
    return result_fail(RESULT_BAD_INPUT, "%s: buffer %d: %s", path, number, what);
}

static Result parse(const char *path, int number, const char *line, Header *out)
{
    static const union {
        uint16_t value;
        unsigned char first;
    } one = {1};
    char format[16], rows[8], order[8];
    int length = 0;
    /* NOLINTNEXTLINE(cert-err34-c): five digits fit */
    int fields = sscanf(line, "peel-dump 1 %47s %15s %5dx%5d %7s %7s\n%n", out->name, format,
                        &out->width, &out->height, rows, order, &length);
    if (fields != 6 || line[length])
        return fail(path, number,
                    "expected a line 'peel-dump 1 NAME FORMAT WIDTHxHEIGHT ROWS ORDER'");
    if (!format_find(format, &out->format))
        return fail(path, number, "its format is none of those of peel_dump.h");
    if (out->width < 1 || out->height < 1 || out->width > SIDE_MAX || out->height > SIDE_MAX)
        return fail(path, number, "its size is not 1 to 16384 pixels a side");
    out->bottom_up = strcmp(rows, "bottom") == 0;
    if (!out->bottom_up && strcmp(rows, "top") != 0)
        return fail(path, number, "its first row is neither bottom nor top");
    if (strcmp(order, one.first ? "little" : "big") != 0)
        return result_fail(RESULT_UNSUPPORTED,
                           "%s: buffer %d: its byte order is not this machine's", path, number);
    return RESULT_OK;
}

/* Depths beyond what their format stores. */
static bool is_sound(const Image *image)
{
    const uint32_t *depths = image->pixels;
    size_t count = (size_t)image->width * (size_t)image->height;
    if (image->format != FORMAT_D24 && image->format != FORMAT_D16)
        return true;
    for (size_t i = 0; i < count; i++)
        if (depths[i] > format_info(image->format)->unorm_max)
            return false;
    return true;
}

static Result read_pixels(FILE *file, const char *path, int number, const Header *header,
                          Image *image)
{
    size_t row_bytes = (size_t)header->width * format_pixel_bytes(header->format);
    struct stat info;
    /* Before memory is asked for. */
    if (fstat(fileno(file), &info) != 0 ||
        (uint64_t)info.st_size < (uint64_t)row_bytes * (uint64_t)header->height)
        return fail(path, number, "the file ends within its pixels");
    Result result = image_create(header->width, header->height, header->format, image);
    for (int y = 0; result == RESULT_OK && y < header->height; y++) {
        int row = header->bottom_up ? header->height - 1 - y : y;
        if (fread(image_pixel(image, 0, row), 1, row_bytes, file) != row_bytes)
            result = fail(path, number, "the file ends within its pixels");
    }
    if (result == RESULT_OK && !is_sound(image))
        result = fail(path, number, "it has integers beyond its format's range");
    if (result != RESULT_OK)
        image_free(image);
    return result;
}

Result dump_read(const char *path, DumpTake take, void *context)
{
    char line[160];
    FILE *file = fopen(path, "rb");
    if (!file)
        return result_fail(RESULT_IO, "%s: cannot read: %s", path, strerror(errno));
    Result result = RESULT_OK;
    int number = 0;
    while (result == RESULT_OK && fgets(line, sizeof line, file)) {
        Header header;
        Image image;
        result = parse(path, number, line, &header);
        if (result == RESULT_OK)
            result = read_pixels(file, path, number, &header, &image);
        if (result != RESULT_OK)
            break;
        result = take(context, header.name, &image);
        image_free(&image);
        number++;
    }
    if (result == RESULT_OK && ferror(file))
        result = result_fail(RESULT_IO, "%s: cannot read: %s", path, strerror(errno));
    (void)fclose(file);
    if (result == RESULT_OK && number == 0)
        result = result_fail(RESULT_BAD_INPUT, "%s: empty, expected buffers", path);
    return result;
}

#include "image/png.h"

#include "base/file.h"

#include <limits.h>
#include <stdlib.h>
#include <zlib.h>

/* What png_deflate has made last: stb loses it when there is no memory to go on. */
static _Thread_local unsigned char *deflated;

/* stb frees what this returns with free(). Level 6: stb's own compressor is slower and larger. */
__attribute__((unused)) static unsigned char *png_deflate(unsigned char *data, int size,
                                                          int *out_size, int quality)
{
    (void)quality;
    deflated = NULL;
    uLongf compressed = compressBound((uLong)size);
    unsigned char *out = compressed <= INT_MAX - 64 ? malloc(compressed) : NULL;
    if (!out || compress2(out, &compressed, data, (uLong)size, 6) != Z_OK) {
        free(out);
        return NULL;
    }
    *out_size = (int)compressed;
    deflated = out;
    return out;
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wmissing-prototypes"
#pragma GCC diagnostic ignored "-Wundef"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#ifdef __clang_analyzer__ /* to which stb's own code is only declared */
unsigned char *stbi_write_png_to_mem(const unsigned char *pixels, int stride_bytes, int x, int y,
                                     int n, int *out_len);
#else
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBIW_ZLIB_COMPRESS png_deflate
#endif
#include <stb_image_write.h>
#pragma GCC diagnostic pop

/* Rows of RGB without alpha, so that viewers and other tools cannot misread it. */
static unsigned char *drop_alpha(const Image *image)
{
    size_t count = (size_t)image->width * (size_t)image->height;
    unsigned char *rgb = malloc(count * 3);
    const unsigned char *rgba = image->pixels;
    for (size_t i = 0; rgb && i < count; i++)
        for (size_t c = 0; c < 3; c++)
            rgb[3 * i + c] = rgba[4 * i + c];
    return rgb;
}

static Result check(const Image *image, const char *label, int channels)
{
    if (image->format != FORMAT_RGBA8 || !image->pixels || image->width < 1 || image->height < 1)
        return result_fail(RESULT_INTERNAL, "%s: expected an rgba8 image with pixels", label);
    /* stb counts bytes in int. */
    if ((int64_t)image->width * image->height > (INT_MAX / 2 - image->height) / channels)
        return result_fail(RESULT_UNSUPPORTED, "%s: %dx%d pixels are too many for a PNG file here",
                           label, image->width, image->height);
    return RESULT_OK;
}

static Result encode(const void *pixels, const Image *image, int channels, const char *label,
                     unsigned char **bytes, size_t *count)
{
    int size = 0;
    deflated = NULL;
    *bytes = stbi_write_png_to_mem(pixels, image->width * channels, image->width, image->height,
                                   channels, &size);
    if (!*bytes) {
        free(deflated);
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory", label);
    }
    *count = (size_t)size;
    return RESULT_OK;
}

Result png_encode(const Image *image, const char *label, unsigned char **bytes, size_t *count)
{
    Result result = check(image, label, 4);
    return result ? result : encode(image->pixels, image, 4, label, bytes, count);
}

Result png_write(const Image *image, const char *path)
{
    unsigned char *bytes = NULL;
    size_t count = 0;
    Result result = check(image, path, 3);
    if (result)
        return result;
    unsigned char *rgb = drop_alpha(image);
    if (!rgb)
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory", path);
    result = encode(rgb, image, 3, path, &bytes, &count);
    free(rgb);
    if (result == RESULT_OK)
        result = file_write(path, bytes, count);
    free(bytes);
    return result;
}

/* An image in memory: rows from top to bottom, pixels tightly packed in one PixelFormat. */
#ifndef PEEL_IMAGE_IMAGE_H
#define PEEL_IMAGE_IMAGE_H

#include "base/result.h"
#include "number/format.h"

#include <stddef.h>

typedef struct Image {
    int width, height;
    PixelFormat format;
    void *pixels; /* width·height·format_pixel_bytes(format) bytes, owned */
} Image;

/* Where the pixels of an EXR file lie: the first one, and the corners of the window that they are
 * part of, the last ones included. */
typedef struct ImageWindow {
    int x, y;
    int left, top, right, bottom;
} ImageWindow;

/* Zeroed pixels. The caller frees with image_free. */
Result image_create(int width, int height, PixelFormat format, Image *out);
void image_free(Image *image); /* leaves an empty image; NULL pixels are fine */

static inline void image_swap(Image *one, Image *other)
{
    Image image = *one;
    *one = *other;
    *other = image;
}

static inline void *image_pixel(const Image *image, int x, int y)
{
    return (char *)image->pixels +
           ((size_t)y * (size_t)image->width + (size_t)x) * format_pixel_bytes(image->format);
}

#endif

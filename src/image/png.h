/* 8-bit PNG out, through stb_image_write. */
#ifndef PEEL_IMAGE_PNG_H
#define PEEL_IMAGE_PNG_H

#include "image/image.h"

#include <stddef.h>

/* image: FORMAT_RGBA8, written as RGB (alpha dropped) to a temporary name, then renamed. */
Result png_write(const Image *image, const char *path);

/* The bytes of a PNG file with all four channels of image, FORMAT_RGBA8; the caller frees *bytes.
 * NO_MEMORY, or UNSUPPORTED for more pixels than stb counts; label begins the message. */
Result png_encode(const Image *image, const char *label, unsigned char **bytes, size_t *count);

#endif

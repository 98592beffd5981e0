/* PNG files to pixels and back, through libpng. decode.h reads what may also be another format. */
#ifndef PEEL_IMAGE_PNG_H
#define PEEL_IMAGE_PNG_H

#include "image/image.h"

#include <stddef.h>

/* What stands in front of the pixels; channels counts a colour that is transparent as alpha, and a
 * palette as its colours. label begins the message. BAD_INPUT with libpng's reason, NO_MEMORY. */
Result png_decode_size(const unsigned char *bytes, size_t count, const char *label, int *width,
                       int *height, int *channels);

/* FORMAT_RGBA16 of 16 bits, else FORMAT_RGBA8; an index that the palette does not have is black.
 * BAD_INPUT also where the checksum of any chunk is wrong or the file ends before IEND does. The
 * caller frees *out with image_free. */
Result png_decode(const unsigned char *bytes, size_t count, const char *label, Image *out);

/* image: FORMAT_RGBA8, written as RGB (alpha dropped) to a temporary name, then renamed. */
Result png_write(const Image *image, const char *path);

/* The bytes of a PNG file with all four channels of image, FORMAT_RGBA8; the caller frees *bytes.
 * NO_MEMORY; label begins the message. */
Result png_encode(const Image *image, const char *label, unsigned char **bytes, size_t *count);

#endif

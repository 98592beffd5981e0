/* PNG files in memory to pixels, through libpng: decode.h for this one format. */
#ifndef PEEL_IMAGE_DECODE_PNG_H
#define PEEL_IMAGE_DECODE_PNG_H

#include "image/image.h"

#include <stddef.h>

/* What stands in front of the pixels; channels counts a colour that is transparent as alpha, and a
 * palette as its colours. label begins the message. BAD_INPUT with libpng's reason, NO_MEMORY. */
Result decode_png_size(const unsigned char *bytes, size_t count, const char *label, int *width,
                       int *height, int *channels);

/* FORMAT_RGBA16 of 16 bits, else FORMAT_RGBA8; an index that the palette does not have is black.
 * BAD_INPUT also where the checksum of any chunk is wrong or the file ends before IEND does. The
 * caller frees *out with image_free. */
Result decode_png_image(const unsigned char *bytes, size_t count, const char *label, Image *out);

#endif

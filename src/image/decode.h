/* PNG and JPEG files in memory to pixels, through libpng and libjpeg. */
#ifndef PEEL_IMAGE_DECODE_H
#define PEEL_IMAGE_DECODE_H

#include "image/image.h"

#include <stddef.h>

enum {
    DECODE_MAX_PIXELS = 16384
}; /* per side */

/* The size of an image, in pixels, without decoding it, and how many channels the file stores: 1
 * grey, 2 grey and alpha, 3 RGB, 4 RGBA; a palette counts as its colours, one that is transparent
 * as alpha. The format is told from the first bytes. label begins the message. BAD_INPUT for what
 * is neither PNG nor JPEG, a broken header, or more than DECODE_MAX_PIXELS a side. */
Result decode_size(const unsigned char *bytes, size_t count, const char *label, int *width,
                   int *height, int *channels);

/* The pixels as stored: FORMAT_RGBA16 of a PNG with 16 bits, else FORMAT_RGBA8. Grey is repeated
 * in red, green and blue; alpha is 1 where the file has none. Colour profiles and gamma are
 * ignored, as glTF demands. The same bytes give the same pixels on every processor. The caller
 * frees *out with image_free. BAD_INPUT with the library's reason, also for a file that ends too
 * early; NO_MEMORY. */
Result decode_image(const unsigned char *bytes, size_t count, const char *label, Image *out);

#endif

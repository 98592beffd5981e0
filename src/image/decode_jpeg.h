/* JPEG files in memory to pixels, through libjpeg: decode.h for this one format. */
#ifndef PEEL_IMAGE_DECODE_JPEG_H
#define PEEL_IMAGE_DECODE_JPEG_H

#include "image/image.h"

#include <stddef.h>

/* What the header says; channels is 1 of grey, else 3. label begins the message. BAD_INPUT with
 * libjpeg's reason, NO_MEMORY. */
Result decode_jpeg_size(const unsigned char *bytes, size_t count, const char *label, int *width,
                        int *height, int *channels);

/* FORMAT_RGBA8; CMYK becomes red, green and blue as the product of what each ink and black leave.
 * BAD_INPUT also for data that libjpeg would make up: a file that ends too early, a code that no
 * table has. The caller frees *out with image_free. */
Result decode_jpeg_image(const unsigned char *bytes, size_t count, const char *label, Image *out);

#endif

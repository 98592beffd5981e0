/* 8-bit PNG files through stb_image_write. */
#ifndef PEEL_IMAGE_PNG_H
#define PEEL_IMAGE_PNG_H

#include "image/image.h"

/* image: FORMAT_RGBA8, written as RGB (alpha dropped) to a temporary name, then renamed. */
Result png_write(const Image *image, const char *path);

#endif

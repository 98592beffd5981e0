/* Texels from stored images, and back.
 *
 * Everything is + − × ÷ in double in a fixed order, rounded to float once, so that the texels are
 * the same on every machine: no libm. tests/unit/test_texture.c compares all codes of 8 and 16 bits
 * with MPFR: every texel is the correctly rounded value of its formula. */
#ifndef PEEL_SCENE_TEXTURE_H
#define PEEL_SCENE_TEXTURE_H

#include "image/image.h"
#include "scene/scene.h"

/* How an image's red, green and blue are stored; alpha is linear always. */
typedef enum TextureEncoding {
    TEXTURE_LINEAR = 0, /* code / most */
    TEXTURE_SRGB        /* IEC 61966-2-1, exponent 2.4 */
} TextureEncoding;

/* The linear value in [0, 1] of a code out of 0 … most, most being 255 or 65535. */
float texture_decode(TextureEncoding encoding, uint32_t code, uint32_t most);

/* image: FORMAT_RGBA8 or FORMAT_RGBA16, at most TEXTURE_MAX_PIXELS a side. *out repeats and is
 * bilinear; the caller frees its texels. NO_MEMORY leaves it empty. */
Result texture_from_image(const Image *image, TextureEncoding encoding, Texture *out);

/* The codes of 8 bits nearest to the texels (the smaller of two as near), FORMAT_RGBA8. *exact:
 * whether decoding gives every texel back, as it does for textures that come from 8 bits. The
 * caller frees *out with image_free. NO_MEMORY leaves it empty. */
Result texture_to_image(const Texture *texture, TextureEncoding encoding, Image *out, bool *exact);

#endif

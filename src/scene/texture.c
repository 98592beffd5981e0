#include "scene/texture.h"

#include "base/memory.h"
#include "image/decode.h"

#include <stdlib.h>

_Static_assert((int)DECODE_MAX_PIXELS == (int)TEXTURE_MAX_PIXELS, "what is decoded is a texture");

enum {
    MOST8 = 255,
    MOST16 = 65535,
    NEWTON_STEPS = 10 /* 8 reach the last bit from 1 for x ≥ 0.09 */
};

/* x^(12/5) for x in [0.09, 1], to a relative 1e-15: x²·r² with Newton's fifth root r. */
static double power_12_5(double x)
{
    double root = 1.0;
    for (int i = 0; i < NEWTON_STEPS; i++) {
        double square = root * root;
        root = root - (root - x / (square * square)) / 5.0;
    }
    double product = x * root;
    return product * product;
}

/* The formula's constants as integers, so that nothing is rounded before the division:
 * 1/12.92 = 25/323 and (c + 0.055)/1.055 = (200·c + 11)/211. */
float texture_decode(TextureEncoding encoding, uint32_t code, uint32_t most)
{
    double c = (double)code, m = (double)most;
    if (encoding == TEXTURE_LINEAR)
        return (float)code / (float)most;
    if (c * 100000.0 <= m * 4045.0)
        return (float)(c * 25.0 / (m * 323.0));
    return (float)power_12_5((c * 200.0 + m * 11.0) / (m * 211.0));
}

/* The values of all codes; the caller frees them. NULL without memory. */
static float *decode_table(TextureEncoding encoding, uint32_t most)
{
    float *table = memory_array((size_t)most + 1, sizeof *table);
    for (uint32_t code = 0; table && code <= most; code++)
        table[code] = texture_decode(encoding, code, most);
    return table;
}

static void look_up(const Image *image, const float *color, const float *alpha, float *texels)
{
    size_t count = (size_t)image->width * (size_t)image->height * 4;
    const uint8_t *narrow = image->pixels;
    const uint16_t *wide = image->pixels;
    for (size_t i = 0; i < count; i++) {
        const float *table = i % 4 == 3 ? alpha : color;
        texels[i] = table[image->format == FORMAT_RGBA8 ? narrow[i] : wide[i]];
    }
}

Result texture_from_image(const Image *image, TextureEncoding encoding, Texture *out)
{
    uint32_t most = image->format == FORMAT_RGBA8 ? MOST8 : MOST16;
    *out = (Texture){0};
    float *color = decode_table(encoding, most), *alpha = decode_table(TEXTURE_LINEAR, most);
    float *texels = memory_array((size_t)image->width * (size_t)image->height, 4 * sizeof *texels);
    Result result = color && alpha && texels ? RESULT_OK : RESULT_NO_MEMORY;
    if (!result) {
        look_up(image, color, alpha, texels);
        *out = (Texture){
            .width = (uint32_t)image->width, .height = (uint32_t)image->height, .texels = texels};
    } else {
        free(texels);
    }
    free(color);
    free(alpha);
    return result;
}

/* The code whose value is nearest. */
static uint8_t nearest_code(const float *table, float value)
{
    unsigned low = 0, high = MOST8; /* table[low] ≤ value ≤ table[high] */
    while (high - low > 1) {
        unsigned middle = (low + high) / 2;
        if (table[middle] <= value)
            low = middle;
        else
            high = middle;
    }
    double below = (double)value - (double)table[low], above = (double)table[high] - (double)value;
    return (uint8_t)(below <= above ? low : high);
}

Result texture_to_image(const Texture *texture, TextureEncoding encoding, Image *out, bool *exact)
{
    *out = (Image){0};
    *exact = true;
    float *color = decode_table(encoding, MOST8), *alpha = decode_table(TEXTURE_LINEAR, MOST8);
    Result result = color && alpha ? RESULT_OK : RESULT_NO_MEMORY;
    if (!result)
        result = image_create((int)texture->width, (int)texture->height, FORMAT_RGBA8, out);
    uint8_t *codes = out->pixels;
    size_t count = (size_t)texture->width * texture->height * 4;
    for (size_t i = 0; !result && i < count; i++) {
        const float *table = i % 4 == 3 ? alpha : color;
        codes[i] = nearest_code(table, texture->texels[i]);
        *exact = *exact && table[codes[i]] == texture->texels[i];
    }
    free(color);
    free(alpha);
    return result;
}

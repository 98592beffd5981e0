#include "report/heatmap.h"

#include <math.h>
#include <stdint.h>

/* At equal steps along the scale, in linear light; relative luminance rises from 0.03 to 0.93, so
 * the order survives a print in grey and any kind of colour blindness. */
static const double stops[][3] = {
    {0.04, 0.015, 0.20}, {0.10, 0.03, 0.45}, {0.45, 0.05, 0.50},
    {0.90, 0.20, 0.12},  {1.00, 0.60, 0.10}, {1.00, 0.95, 0.60},
};
enum {
    STOPS = sizeof stops / sizeof stops[0]
};

/* Linear light to the sRGB transfer curve. Source: IEC 61966-2-1. */
static uint8_t encode(double linear)
{
    double value = linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
    return (uint8_t)lround(255 * value);
}

/* t in [0, 1] along the scale. Cube roots of linear light are near to perceived lightness, so
 * steps between the stops look even. */
static void color_at(double t, uint8_t rgba[4])
{
    double place = t * (STOPS - 1);
    int low = place >= STOPS - 1 ? STOPS - 2 : (int)place;
    double part = place - low;
    for (int c = 0; c < 3; c++) {
        double from = cbrt(stops[low][c]), to = cbrt(stops[low + 1][c]);
        rgba[c] = encode(pow(from + part * (to - from), 3));
    }
    rgba[3] = 255;
}

static void color_of(double difference, uint8_t rgba[4])
{
    if (!isfinite(difference)) {
        rgba[0] = rgba[2] = rgba[3] = 255;
        rgba[1] = 0;
    } else if (difference == 0) {
        rgba[0] = rgba[1] = rgba[2] = 0;
        rgba[3] = 255;
    } else {
        double t = log(difference / HEATMAP_LOW) / log(HEATMAP_HIGH / HEATMAP_LOW);
        color_at(t < 0 ? 0 : t > 1 ? 1 : t, rgba);
    }
}

/* Greatest absolute channel difference; NaN where a channel is NaN or infinite on either side. */
static double pixel_difference(const float a[4], const float b[4])
{
    double greatest = 0;
    for (int c = 0; c < 4; c++) {
        if (!isfinite(a[c]) || !isfinite(b[c]))
            return NAN;
        greatest = fmax(greatest, fabs((double)a[c] - (double)b[c]));
    }
    return greatest;
}

/* The greatest difference in a block; NaN beats all. */
static double block_difference(const Image *a, const Image *b, int left, int top, int block)
{
    int right = left + block < a->width ? left + block : a->width;
    int bottom = top + block < a->height ? top + block : a->height;
    double greatest = 0;
    for (int y = top; y < bottom; y++)
        for (int x = left; x < right; x++) {
            double difference = pixel_difference(image_pixel(a, x, y), image_pixel(b, x, y));
            if (isnan(difference))
                return difference;
            greatest = fmax(greatest, difference);
        }
    return greatest;
}

Result heatmap_reduced(const Image *a, const Image *b, int block, Image *out)
{
    *out = (Image){0};
    if (a->format != FORMAT_RGBA32F || b->format != FORMAT_RGBA32F || a->width != b->width ||
        a->height != b->height || block < 1)
        return result_fail(RESULT_INTERNAL, "heat map: expected two rgba32f images of one size");
    Result result = image_create((a->width + block - 1) / block, (a->height + block - 1) / block,
                                 FORMAT_RGBA8, out);
    if (result != RESULT_OK)
        return result;
    for (int y = 0; y < out->height; y++)
        for (int x = 0; x < out->width; x++)
            color_of(block_difference(a, b, x * block, y * block, block), image_pixel(out, x, y));
    return RESULT_OK;
}

Result heatmap_image(const Image *a, const Image *b, Image *out)
{
    return heatmap_reduced(a, b, 1, out);
}

Result heatmap_differences(const float *differences, int width, int height, Image *out)
{
    Result result = image_create(width, height, FORMAT_RGBA8, out);
    if (result != RESULT_OK)
        return result;
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++)
        color_of((double)differences[i], (uint8_t *)out->pixels + 4 * i);
    return RESULT_OK;
}

Result heatmap_scale(int width, int height, Image *out)
{
    Result result = image_create(width, height, FORMAT_RGBA8, out);
    if (result != RESULT_OK)
        return result;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            color_at(width > 1 ? (double)x / (width - 1) : 0, image_pixel(out, x, y));
    return RESULT_OK;
}

#include "report/heatmap.h"

#include <math.h>
#include <stdint.h>

/* Equal steps along the scale, in linear light; relative luminance rises from 0.03 to 0.93, so
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

/* t in [0, 1] along the scale. */
static void color_at(double t, uint8_t rgba[4])
{
    double place = t * (STOPS - 1);
    int low = place >= STOPS - 1 ? STOPS - 2 : (int)place;
    double part = place - low;
    for (int c = 0; c < 3; c++)
        rgba[c] = encode(stops[low][c] + part * (stops[low + 1][c] - stops[low][c]));
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

Result heatmap_image(const Image *a, const Image *b, Image *out)
{
    *out = (Image){0};
    if (a->format != FORMAT_RGBA32F || b->format != FORMAT_RGBA32F || a->width != b->width ||
        a->height != b->height)
        return result_fail(RESULT_INTERNAL, "heat map: expected two rgba32f images of one size");
    Result result = image_create(a->width, a->height, FORMAT_RGBA8, out);
    if (result != RESULT_OK)
        return result;
    for (int y = 0; y < a->height; y++)
        for (int x = 0; x < a->width; x++)
            color_of(pixel_difference(image_pixel(a, x, y), image_pixel(b, x, y)),
                     image_pixel(out, x, y));
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

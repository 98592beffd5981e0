#include "compare/perceive.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

enum {
    LEVELS = 8,
    SIDES = 2
};
static const double white_luminance = 100.0, field_of_view = 45.0, pi = 3.14159265358979323846;

/* An image as the eye takes it: luminance (level 0), ever more blurred, and colour. */
typedef struct View {
    float *level[LEVELS];
    float *red_green, *yellow_blue; /* a and b of CIE L*a*b* */
} View;

typedef struct Eye {
    int width, height, adapted; /* adapted: the level that is a degree wide */
    double cycles[LEVELS], frequency[LEVELS];
} Eye;

static const char *const primaries[] = {"R", "G", "B"};

bool perceive_possible(const Planes *a, const Planes *b)
{
    bool possible = true;
    for (int c = 0; c < 3; c++)
        possible &= planes_find(a, primaries[c]) >= 0 && planes_find(b, primaries[c]) >= 0;
    return possible;
}

/* ---- light ---- */

static double linear_of(const Plane *plane, size_t at)
{
    double value = planes_value(plane->kind, plane->unorm_max, plane->bits[at]);
    if (!isfinite(value) || value < 0.0)
        return 0.0;
    if (plane->kind != KIND_UNORM)
        return value;
    return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

/* CIE 15, L*a*b*: the cube root, with a line near 0. */
static double lab_curve(double ratio)
{
    return ratio > 216.0 / 24389.0 ? cbrt(ratio) : (24389.0 / 27.0 * ratio + 16.0) / 116.0;
}

/* sRGB's primaries and white, IEC 61966-2-1. */
static void see_pixel(const double rgb[3], size_t at, View *view)
{
    double x = 0.4124 * rgb[0] + 0.3576 * rgb[1] + 0.1805 * rgb[2];
    double y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    double z = 0.0193 * rgb[0] + 0.1192 * rgb[1] + 0.9505 * rgb[2];
    double fx = lab_curve(x / 0.9505), fy = lab_curve(y), fz = lab_curve(z / 1.089);
    view->level[0][at] = (float)(white_luminance * y);
    view->red_green[at] = (float)(500.0 * (fx - fy));
    view->yellow_blue[at] = (float)(200.0 * (fy - fz));
}

/* ---- blur ---- */

static int mirrored(int i, int size)
{
    i = i < 0 ? -i : i;
    i = i >= size ? 2 * size - 2 - i : i;
    return i < 0 ? 0 : i; /* of one pixel, or two */
}

/* One direction: `step` between the values of a line, `count` of them. */
static void blur_line(const float *from, size_t step, int count, float *to)
{
    static const double weights[] = {0.05, 0.25, 0.4, 0.25, 0.05};
    for (int i = 0; i < count; i++) {
        double sum = 0.0;
        for (int k = -2; k <= 2; k++)
            sum += weights[k + 2] * (double)from[(size_t)mirrored(i + k, count) * step];
        to[(size_t)i * step] = (float)sum;
    }
}

static void blur(const Eye *eye, const float *from, float *scratch, float *to)
{
    size_t width = (size_t)eye->width;
    for (int y = 0; y < eye->height; y++)
        blur_line(from + (size_t)y * width, 1, eye->width, scratch + (size_t)y * width);
    for (int x = 0; x < eye->width; x++)
        blur_line(scratch + x, width, eye->height, to + x);
}

static void free_view(View *view)
{
    for (int i = 0; i < LEVELS; i++)
        free(view->level[i]);
    free(view->red_green);
    free(view->yellow_blue);
}

static Result see(const Eye *eye, const Planes *planes, float *scratch, View *out)
{
    size_t pixels = (size_t)eye->width * (size_t)eye->height;
    bool room = true;
    for (int i = 0; i < LEVELS; i++)
        room &= (out->level[i] = memory_array(pixels, sizeof(float))) != NULL;
    out->red_green = memory_array(pixels, sizeof(float));
    out->yellow_blue = memory_array(pixels, sizeof(float));
    if (!room || !out->red_green || !out->yellow_blue)
        return RESULT_NO_MEMORY;
    const Plane *plane[3];
    for (int c = 0; c < 3; c++)
        plane[c] = &planes->planes[planes_find(planes, primaries[c])];
    for (size_t i = 0; i < pixels; i++) {
        const double rgb[3] = {linear_of(plane[0], i), linear_of(plane[1], i),
                               linear_of(plane[2], i)};
        see_pixel(rgb, i, out);
    }
    for (int i = 1; i < LEVELS; i++)
        blur(eye, out->level[i - 1], scratch, out->level[i]);
    return RESULT_OK;
}

/* ---- sensitivity: the paper's equations ---- */

/* Of contrast, at cycles per degree and luminance. */
static double sensitivity(double cycles, double luminance)
{
    double a = 440.0 * pow(1.0 + 0.7 / luminance, -0.2);
    double b = 0.3 * pow(1.0 + 100.0 / luminance, 0.15);
    return a * cycles * exp(-b * cycles) * sqrt(1.0 + 0.06 * exp(b * cycles));
}

static double masking(double contrast)
{
    return pow(1.0 + pow(0.0153 * pow(392.498 * contrast, 0.7), 4.0), 0.25);
}

/* The least difference that is seen at an adaptation luminance, in cd/m². */
static double least_seen(double luminance)
{
    double l = log10(luminance), threshold;
    if (l < -3.94)
        threshold = -2.86;
    else if (l < -1.44)
        threshold = pow(0.405 * l + 1.6, 2.18) - 2.86;
    else if (l < -0.0184)
        threshold = l - 0.395;
    else if (l < 1.9)
        threshold = pow(0.249 * l + 0.65, 2.7) - 0.72;
    else
        threshold = l - 1.255;
    return pow(10.0, threshold);
}

static Eye make_eye(int width, int height)
{
    Eye eye = {.width = width, .height = height};
    double degrees = 2.0 * tan(0.5 * field_of_view * pi / 180.0) * 180.0 / pi;
    double most = sensitivity(3.248, 100.0);
    eye.cycles[0] = 0.5 * width / degrees;
    for (int i = 1; i < LEVELS; i++)
        eye.cycles[i] = 0.5 * eye.cycles[i - 1];
    for (int i = 0; i < LEVELS; i++)
        eye.frequency[i] = most / sensitivity(eye.cycles[i], 100.0);
    while (eye.adapted < LEVELS - 1 && ldexp(1.0, eye.adapted) <= degrees)
        eye.adapted++;
    return eye;
}

/* ---- pixels ---- */

/* How much less is seen because of the contrasts around: 1 to 10. */
static double elevation(const Eye *eye, const View views[SIDES], size_t at, double adapted)
{
    double sum = 0.0, weighted = 0.0;
    for (int i = 0; i < LEVELS - 2; i++) {
        double contrast = 0.0, ground = 1e-5;
        for (int side = 0; side < SIDES; side++) {
            const View *view = &views[side];
            contrast =
                fmax(contrast, fabs((double)view->level[i][at] - (double)view->level[i + 1][at]));
            ground = fmax(ground, fabs((double)view->level[i + 2][at]));
        }
        contrast /= ground;
        sum += contrast;
        weighted +=
            contrast * eye->frequency[i] * masking(contrast * sensitivity(eye->cycles[i], adapted));
    }
    return fmin(fmax(sum > 0.0 ? weighted / sum : 1.0, 1.0), 10.0);
}

static bool is_seen(const Eye *eye, const View views[SIDES], size_t at)
{
    const View *a = &views[0], *b = &views[1];
    double adapted =
        fmax(0.5 * ((double)a->level[eye->adapted][at] + (double)b->level[eye->adapted][at]), 1e-5);
    double factor = elevation(eye, views, at, adapted);
    double delta = fabs((double)a->level[0][at] - (double)b->level[0][at]);
    double red_green = (double)a->red_green[at] - (double)b->red_green[at];
    double yellow_blue = (double)a->yellow_blue[at] - (double)b->yellow_blue[at];
    /* In the dark colours fade. */
    double dark = adapted < 10.0 ? 1.0 - (10.0 - adapted) / 10.0 : 1.0;
    return delta > factor * least_seen(adapted) ||
           (red_green * red_green + yellow_blue * yellow_blue) * dark * dark > factor;
}

Result perceive_count(const Planes *a, const Planes *b, size_t max_bytes, uint64_t *out)
{
    size_t pixels = (size_t)a->width * (size_t)a->height;
    size_t pixel_bytes = (SIDES * (LEVELS + 2) + 1) * sizeof(float); /* the views, and scratch */
    if (max_bytes && pixels > max_bytes / pixel_bytes)
        return result_fail(RESULT_NO_MEMORY,
                           "perceptual test of %dx%d pixels: needs more than %zu bytes", a->width,
                           a->height, max_bytes);
    Eye eye = make_eye(a->width, a->height);
    View views[SIDES] = {0};
    float *scratch = memory_array(pixels, sizeof *scratch);
    *out = 0;
    Result result = scratch ? see(&eye, a, scratch, &views[0]) : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = see(&eye, b, scratch, &views[1]);
    for (size_t i = 0; i < pixels && result == RESULT_OK; i++)
        *out += is_seen(&eye, views, i);
    free_view(&views[0]);
    free_view(&views[1]);
    free(scratch);
    return result;
}

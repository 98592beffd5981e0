#include "compare/given.h"

#include "base/file.h"
#include "frame/shading.h"
#include "image/decode.h"
#include "image/exr.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A meaning that is not the usual one has to be this much better. */
#define MUCH_BETTER 0.5
/* Differences about this large, of display-encoded values, are half as bad as any. */
#define LOSS_SCALE 0.02
enum {
    SAMPLES = 1 << 18 /* pixels that are looked at, about */
};

const char *given_encoding_name(GivenEncoding encoding)
{
    static const char *const names[] = {"detect", "linear", "srgb", "seed"};
    return names[encoding];
}

const char *given_alpha_name(GivenAlpha alpha)
{
    static const char *const names[] = {"detect", "none", "coverage", "transmittance"};
    return names[alpha];
}

/* ---- files ---------------------------------------------------------------------------------- */

static Result load_png(const char *path, const int size[2], GivenImage *out)
{
    unsigned char *bytes;
    size_t count;
    Result result = file_load(path, &bytes, &count);
    if (result != RESULT_OK)
        return result;
    int width, height, channels = 0;
    result = decode_size(bytes, count, path, &width, &height, &channels);
    if (result == RESULT_OK && size && (width != size[0] || height != size[1]))
        out->stored = (Image){.width = width, .height = height};
    else if (result == RESULT_OK)
        result = decode_image(bytes, count, path, &out->stored);
    out->kind = "PNG";
    out->has_alpha = channels % 2 == 0;
    free(bytes);
    return result;
}

static Result load_exr(const char *path, const int size[2], GivenImage *out)
{
    char name[64];
    out->kind = "EXR";
    Result result = exr_read_sized(path, 0, size, &out->stored, name);
    if (result != RESULT_OK)
        return result;
    if (format_info(out->stored.format)->channels != 4) {
        image_free(&out->stored);
        return result_fail(RESULT_UNSUPPORTED,
                           "%s: no channels R, G and B in its first part, expected a colour image",
                           path);
    }
    return exr_has_channel(path, 0, "A", &out->has_alpha);
}

static void count_nonfinite(GivenImage *given)
{
    PixelFormat format = given->stored.format;
    size_t bytes = format_pixel_bytes(format);
    size_t pixels = (size_t)given->stored.width * (size_t)given->stored.height;
    const unsigned char *pixel = given->stored.pixels;
    for (size_t i = 0; i < pixels; i++, pixel += bytes) {
        bool finite = true;
        for (int c = 0; c < 4; c++)
            finite = finite && isfinite(format_channel(format, pixel, c));
        given->nonfinite += !finite;
    }
}

Result given_load(const char *path, const int size[2], GivenImage *out)
{
    bool exr;
    char magic[4];
    size_t count;
    *out = (GivenImage){0};
    Result result = exr_is(path, &exr);
    if (result == RESULT_OK)
        result = file_head(path, magic, sizeof magic, &count);
    if (result != RESULT_OK)
        return result;
    if (exr)
        result = load_exr(path, size, out);
    else if (count == 4 && memcmp(magic, "\x89PNG", 4) == 0)
        result = load_png(path, size, out);
    else
        result =
            result_fail(RESULT_BAD_INPUT, "%s: neither PNG nor EXR, expected one of them", path);
    if (result != RESULT_OK)
        given_free(out);
    else if (out->stored.pixels)
        count_nonfinite(out);
    return result;
}

void given_free(GivenImage *given)
{
    image_free(&given->stored);
    *given = (GivenImage){0};
}

/* ---- encodings ------------------------------------------------------------------------------ */

double given_encode(GivenEncoding encoding, double linear)
{
    double c = linear > 0.0 || isnan(linear) ? linear : 0.0;
    switch (encoding) {
    case GIVEN_SRGB:
        return c <= 0.0031308 ? 12.92 * linear : 1.055 * pow(c, 1.0 / 2.4) - 0.055;
    case GIVEN_SEED:
        return isinf(c) ? 1.0 : pow(c / (c + 1.0), (double)SHADING_DISPLAY_POWER);
    case GIVEN_ENCODING_DETECT:
    case GIVEN_LINEAR:
        break;
    }
    return linear;
}

double given_decode(GivenEncoding encoding, double value)
{
    switch (encoding) {
    case GIVEN_SRGB:
        return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
    case GIVEN_SEED: {
        double mapped =
            pow(value > 0.0 || isnan(value) ? value : 0.0, 1.0 / (double)SHADING_DISPLAY_POWER);
        return mapped < 1.0 || isnan(mapped) ? mapped / (1.0 - mapped) : INFINITY;
    }
    case GIVEN_ENCODING_DETECT:
    case GIVEN_LINEAR:
        break;
    }
    return value;
}

double given_stored_value(PixelFormat format, GivenEncoding encoding, double linear)
{
    double value = given_encode(encoding, linear);
    if (format_info(format)->kind != KIND_UNORM || isnan(value))
        return value;
    return fmin(fmax(value, 0.0), 1.0);
}

double given_quantum(PixelFormat format, double value)
{
    const FormatInfo *info = format_info(format);
    if (info->kind == KIND_UNORM)
        return 0.5 / (double)info->unorm_max;
    if (info->kind != KIND_HALF || !isfinite(value))
        return 0.0;
    int exponent; /* of the bit above the value's highest; a half has 11 bits, the least 2^-24 */
    frexp(value, &exponent);
    return ldexp(1.0, value != 0.0 && exponent > -13 ? exponent - 11 : -24);
}

/* ---- meaning -------------------------------------------------------------------------------- */

static const unsigned char *pixel_at(const GivenImage *given, GivenRows rows, int x, int y)
{
    int row = rows == GIVEN_BOTTOM_UP ? given->stored.height - 1 - y : y;
    return image_pixel(&given->stored, x, row);
}

/* Display-encoded, whatever it was, so that all encodings are judged alike. */
static double display_of(GivenEncoding encoding, double value)
{
    return encoding == GIVEN_SEED ? fmin(fmax(value, 0.0), 1.0)
                                  : given_encode(GIVEN_SEED, given_decode(encoding, value));
}

/* How far expected is from all values that storing may have made into this one: 0 … 1, half at
 * LOSS_SCALE, so that what a mistake changed much counts little more than what it changed. */
static double value_loss(PixelFormat format, GivenEncoding encoding, double value, double expected)
{
    double quantum = given_quantum(format, value);
    double low = display_of(encoding, value - quantum),
           high = display_of(encoding, value + quantum);
    double distance = fmax(fmax(low - expected, expected - high), 0.0);
    return distance / (distance + LOSS_SCALE);
}

typedef struct Trial {
    GivenEncoding encoding;
    GivenRows rows;
    double loss; /* summed */
} Trial;

static void add_pixel(const GivenImage *given, const float *reference, int x, int y, Trial *trials,
                      int count)
{
    PixelFormat format = given->stored.format;
    double expected[3];
    for (int c = 0; c < 3; c++)
        expected[c] = given_encode(GIVEN_SEED, (double)reference[c]);
    for (int i = 0; i < count; i++) {
        const unsigned char *pixel = pixel_at(given, trials[i].rows, x, y);
        for (int c = 0; c < 3; c++) {
            double value = (double)format_channel(format, pixel, c);
            if (isfinite(value) && isfinite(expected[c]))
                trials[i].loss += value_loss(format, trials[i].encoding, value, expected[c]);
        }
    }
}

/* Every combination that options leave open, the usual one first. */
static int list_trials(const GivenImage *given, const GivenMeaning *options, Trial trials[6])
{
    static const GivenEncoding display_first[] = {GIVEN_SEED, GIVEN_SRGB, GIVEN_LINEAR};
    static const GivenEncoding linear_first[] = {GIVEN_LINEAR, GIVEN_SRGB, GIVEN_SEED};
    const GivenEncoding *order = *given->kind == 'P' ? display_first : linear_first;
    int count = 0;
    for (int rows = GIVEN_TOP_DOWN; rows <= GIVEN_BOTTOM_UP; rows++)
        for (int i = 0; i < 3; i++)
            if ((options->rows == GIVEN_ROWS_DETECT || options->rows == (GivenRows)rows) &&
                (options->encoding == GIVEN_ENCODING_DETECT || options->encoding == order[i]))
                trials[count++] = (Trial){order[i], (GivenRows)rows, 0.0};
    return count;
}

static void detect_colors(const GivenImage *given, const Image *reference,
                          const GivenMeaning *options, GivenReading *out)
{
    Trial trials[6];
    int count = list_trials(given, options, trials), best = 0;
    int width = reference->width, height = reference->height, stride = 1;
    while ((int64_t)(width / stride) * (height / stride) > SAMPLES)
        stride++;
    for (int y = 0; y < height && count > 1; y += stride)
        for (int x = 0; x < width; x += stride)
            add_pixel(given, image_pixel(reference, x, y), x, y, trials, count);
    for (int i = 1; i < count; i++)
        if (trials[i].loss < trials[best].loss)
            best = i;
    if (trials[best].loss > MUCH_BETTER * trials[0].loss)
        best = 0;
    out->meaning.encoding = trials[best].encoding;
    out->meaning.rows = trials[best].rows;
    out->sure = true;
    for (int i = 0; i < count; i++)
        out->sure = out->sure && (i == best || trials[best].loss < MUCH_BETTER * trials[i].loss);
}

/* Constant alpha that is neither means nothing: it was never written, or set to 1. */
static GivenAlpha detect_alpha(const GivenImage *given, const Image *reference, GivenRows rows)
{
    PixelFormat format = given->stored.format;
    double coverage = 0.0, transmittance = 0.0, low = INFINITY, high = -INFINITY;
    double quantum = given_quantum(format, 1.0) + 1e-4;
    size_t pixels = (size_t)reference->width * (size_t)reference->height;
    for (int y = 0; y < reference->height; y++)
        for (int x = 0; x < reference->width; x++) {
            double a = (double)format_channel(format, pixel_at(given, rows, x, y), 3);
            double expected = (double)((const float *)image_pixel(reference, x, y))[3];
            if (!isfinite(a))
                continue;
            low = fmin(low, a);
            high = fmax(high, a);
            coverage += fabs(a - expected);
            transmittance += fabs(a - (1.0 - expected));
        }
    bool neither = fmin(coverage, transmittance) > quantum * (double)pixels;
    if (low >= high && neither)
        return GIVEN_ALPHA_NONE;
    return coverage <= transmittance ? GIVEN_COVERAGE : GIVEN_TRANSMITTANCE;
}

static void convert(const GivenImage *given, GivenReading *out)
{
    PixelFormat format = given->stored.format;
    const GivenMeaning *meaning = &out->meaning;
    for (int y = 0; y < given->stored.height; y++)
        for (int x = 0; x < given->stored.width; x++) {
            const unsigned char *pixel = pixel_at(given, meaning->rows, x, y);
            float *encoded = image_pixel(&out->encoded, x, y);
            float *linear = image_pixel(&out->linear, x, y);
            for (int c = 0; c < 3; c++) {
                encoded[c] = format_channel(format, pixel, c);
                linear[c] = (float)given_decode(meaning->encoding, (double)encoded[c]);
            }
            float a = format_channel(format, pixel, 3);
            if (meaning->alpha != GIVEN_COVERAGE)
                a = meaning->alpha == GIVEN_TRANSMITTANCE ? 1.0f - a : 1.0f;
            encoded[3] = linear[3] = a;
        }
}

Result given_check_alpha(const GivenMeaning *options, bool has_alpha)
{
    return has_alpha || options->alpha <= GIVEN_ALPHA_NONE
               ? RESULT_OK
               : result_fail(RESULT_BAD_INPUT, "--alpha %s: there is no alpha, expected none",
                             given_alpha_name(options->alpha));
}

Result given_interpret(const GivenImage *given, const Image *reference, const GivenMeaning *options,
                       GivenReading *out)
{
    int width = given->stored.width, height = given->stored.height;
    *out = (GivenReading){0};
    if (reference->width != width || reference->height != height ||
        reference->format != FORMAT_RGBA32F)
        return result_fail(RESULT_INTERNAL,
                           "given image of %dx%d: expected a reference of its size", width, height);
    detect_colors(given, reference, options, out);
    out->meaning.alpha = options->alpha;
    if (!given->has_alpha)
        out->meaning.alpha = GIVEN_ALPHA_NONE;
    else if (options->alpha == GIVEN_ALPHA_DETECT)
        out->meaning.alpha = detect_alpha(given, reference, out->meaning.rows);
    Result result = image_create(width, height, FORMAT_RGBA32F, &out->encoded);
    if (result == RESULT_OK)
        result = image_create(width, height, FORMAT_RGBA32F, &out->linear);
    if (result == RESULT_OK)
        convert(given, out);
    else
        given_reading_free(out);
    return result;
}

void given_reading_free(GivenReading *reading)
{
    image_free(&reading->encoded);
    image_free(&reading->linear);
    *reading = (GivenReading){0};
}

void given_describe(const GivenImage *given, const GivenReading *reading, char *text, size_t size)
{
    static const char *const encodings[] = {"", "linear", "sRGB", "display-encoded (seed)"};
    static const char *const alphas[] = {"", "no alpha", "alpha is coverage",
                                         "alpha is transmittance"};
    const FormatInfo *info = format_info(given->stored.format);
    const GivenMeaning *meaning = &reading->meaning;
    const char *alpha = given->has_alpha && meaning->alpha == GIVEN_ALPHA_NONE
                            ? "alpha means nothing"
                            : alphas[meaning->alpha];
    snprintf(text, size, "%d-bit %s%s, %s, rows from the %s, %s", 8 * info->channel_bytes,
             info->kind == KIND_UNORM ? "" : "float ", given->kind, encodings[meaning->encoding],
             meaning->rows == GIVEN_TOP_DOWN ? "top" : "bottom", alpha);
}

#include "study/fit.h"

#include "base/memory.h"
#include "frame/shading.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CAP            4.0  /* medians */
#define MUCH_BETTER    0.25 /* of squares: half as far away */
#define CODE_SLACK     0.01 /* codes: another power function rounds otherwise */
#define FLOAT_ROUNDING 1e-6 /* of values; of colours that are black all but: of FLOAT_BLACK */
#define FLOAT_BLACK    0.1
enum {
    PHASES = 8 /* rows are measured in so many parts, after each of which a bad form is left */
};

/* ---- forms ----------------------------------------------------------------------------------- */

/* Alpha that is the same number everywhere was never written, or tells nothing. */
static bool alpha_varies(const Image *stored)
{
    size_t pixels = (size_t)stored->width * (size_t)stored->height;
    const char *pixel = stored->pixels;
    if (!isfinite(format_channel(stored->format, pixel, 3)))
        return true;
    for (size_t i = 0; i < pixels; i++)
        if (format_bits(stored->format, pixel + i * format_pixel_bytes(stored->format), 3) !=
            format_bits(stored->format, pixel, 3))
            return true;
    return false;
}

/* The combinations that options leave open, one encoding after the other. */
static void list_forms(Fit *fit, const GivenMeaning *options)
{
    static const GivenEncoding orders[2][3] = {{GIVEN_LINEAR, GIVEN_SRGB, GIVEN_SEED},
                                               {GIVEN_SEED, GIVEN_SRGB, GIVEN_LINEAR}};
    const GivenEncoding *order = orders[strcmp(fit->given->kind, "PNG") == 0];
    bool detected = options->alpha == GIVEN_ALPHA_DETECT;
    bool alpha = fit->given->has_alpha && options->alpha != GIVEN_ALPHA_NONE &&
                 (!detected || alpha_varies(&fit->given->stored));
    for (int i = 0; i < FIT_FORMS; i++) {
        GivenMeaning form = {order[i / 4], i / 2 % 2 ? GIVEN_BOTTOM_UP : GIVEN_TOP_DOWN,
                             i % 2 ? GIVEN_TRANSMITTANCE : GIVEN_COVERAGE};
        bool wanted = alpha ? detected || options->alpha == form.alpha : i % 2 == 0;
        if (!alpha)
            form.alpha = GIVEN_ALPHA_NONE;
        if (wanted && (options->rows == GIVEN_ROWS_DETECT || options->rows == form.rows) &&
            (options->encoding == GIVEN_ENCODING_DETECT || options->encoding == form.encoding))
            fit->forms[fit->form_count++] = form;
    }
}

typedef struct Encoding {
    PixelFormat format;
    GivenEncoding encoding;
    bool twice;
    const Image *final;
    Image *out;
} Encoding;

/* A final colour that was encoded too much by the power of the seed's transform is in a linear file
 * as it is; in an encoded one its own encoding comes a second time. */
static double encode(const Encoding *form, double color)
{
    if (!form->twice || form->encoding == GIVEN_LINEAR)
        return given_stored_value(form->format, form->encoding, color);
    double linear = pow(fmax(color, 0.0), 1.0 / (double)SHADING_DISPLAY_POWER);
    double once = given_encode(form->encoding, linear);
    double twice = form->encoding == GIVEN_SEED ? pow(once, (double)SHADING_DISPLAY_POWER)
                                                : given_encode(form->encoding, once);
    return given_stored_value(form->format, GIVEN_LINEAR, twice);
}

/* Alpha stays coverage. Neighbours often have the same colour. */
static void encode_row(const Encoding *form, int row)
{
    const float *in = image_pixel(form->final, 0, row);
    float *out = image_pixel(form->out, 0, row);
    for (int x = 0; x < form->final->width; x++, in += 4, out += 4) {
        for (int c = 0; c < 3; c++)
            out[c] = x > 0 && in[c] == in[c - 4] ? out[c - 4] : (float)encode(form, (double)in[c]);
        out[3] = in[3];
    }
}

static Encoding encoding_of(Fit *fit, const FitRendering *rendering, GivenEncoding encoding,
                            Image *out)
{
    return (Encoding){fit->given->stored.format, encoding, rendering->encoded_twice,
                      rendering->final, out};
}

int fit_channels(const GivenMeaning *form)
{
    return form->alpha == GIVEN_ALPHA_NONE ? 3 : 4;
}

static double in_form(const GivenMeaning *form, const float *encoded, int channel)
{
    double value = (double)encoded[channel];
    return channel == 3 && form->alpha == GIVEN_TRANSMITTANCE ? 1.0 - value : value;
}

const float *fit_theirs(const Fit *fit, const GivenMeaning *form, int x, int y)
{
    const Image *image = &fit->theirs;
    return image_pixel(image, x, form->rows == GIVEN_BOTTOM_UP ? image->height - 1 - y : y);
}

/* ---- residuals ------------------------------------------------------------------------------- */

typedef struct Limits {
    double quantisation, tolerance, unit; /* unit: what a residual is relative to */
} Limits;

static Limits limits_at(const Fit *fit, double theirs, double predicted)
{
    PixelFormat format = fit->given->stored.format;
    double size = fmax(fabs(theirs), fabs(predicted)), quantum = given_quantum(format, size);
    if (format_info(format)->kind == KIND_UNORM) {
        double slack = 2.0 * CODE_SLACK * quantum + FLOAT_ROUNDING;
        return (Limits){quantum + slack, 2.0 * quantum + slack, 1.0};
    }
    double unit = fmax(1.0, fabs(theirs));
    double quantisation = quantum + FLOAT_ROUNDING * fmax(size, FLOAT_BLACK);
    return (Limits){quantisation, quantisation + FIT_TOLERANCE * unit, unit};
}

/* Infinite where a side is not finite. */
typedef struct PixelResidual {
    double quantised, tolerant; /* of the values beyond each limit */
    bool far, over_rgb, far_rgb;
    bool broken; /* theirs is not finite, and should be */
} PixelResidual;

static PixelResidual residual_of(const Fit *fit, const GivenMeaning *form, const float *theirs,
                                 const float *encoded)
{
    double quantised = 0.0, tolerant = 0.0;
    PixelResidual out = {0};
    for (int c = 0; c < fit_channels(form); c++) {
        double t = (double)theirs[c], p = in_form(form, encoded, c);
        if (isinf(t) && t == p)
            continue;
        if (!isfinite(t) || !isfinite(p))
            return (PixelResidual){INFINITY, INFINITY, true, true, true, isfinite(p)};
        Limits limits = limits_at(fit, t, p);
        double difference = fabs(t - p), residual = difference / limits.unit;
        if (difference > limits.quantisation)
            quantised += residual * residual;
        if (difference > limits.tolerance)
            tolerant += residual * residual;
        bool over = difference > limits.tolerance, far = over && residual > FIT_FAR;
        out.far |= far;
        out.over_rgb |= c < 3 && over;
        out.far_rgb |= c < 3 && far;
    }
    out.quantised = sqrt(quantised);
    out.tolerant = sqrt(tolerant);
    return out;
}

typedef struct Measuring {
    Fit *fit;
    GivenMeaning form;
    Encoding encoding;
    FitResult *rows; /* counts of each */
    uint32_t phase;
} Measuring;

static void measure_row(const Measuring *measuring, int row)
{
    Fit *fit = measuring->fit;
    FitResult *out = &measuring->rows[row];
    int width = fit->encoded.width;
    float *residuals = fit->residuals + (size_t)row * (size_t)width;
    for (int x = 0; x < width; x++) {
        PixelResidual residual =
            residual_of(fit, &measuring->form, fit_theirs(fit, &measuring->form, x, row),
                        image_pixel(&fit->encoded, x, row));
        double counts = fit->tolerant ? residual.tolerant : residual.quantised;
        residuals[x] = (float)counts;
        counts = fmin(counts, fit->cap);
        out->squares += counts * counts;
        out->beyond += residual.quantised > 0.0;
        out->over += residual.tolerant > 0.0;
        out->far += residual.far;
        out->over_rgb += residual.over_rgb;
        out->far_rgb += residual.far_rgb;
        out->broken += residual.broken;
    }
}

/* Rows are encoded when they are first measured. */
static Result measure_task(void *context, uint32_t index, int worker)
{
    const Measuring *measuring = context;
    uint32_t row = measuring->phase + PHASES * index;
    uint8_t *encoded = &measuring->fit->encoded_rows[row];
    (void)worker;
    if (*encoded != (uint8_t)measuring->form.encoding)
        encode_row(&measuring->encoding, (int)row);
    *encoded = (uint8_t)measuring->form.encoding;
    measure_row(measuring, (int)row);
    return RESULT_OK;
}

static void add_rows(const Measuring *measuring, uint32_t rows, FitResult *out)
{
    for (uint32_t row = measuring->phase; row < rows; row += PHASES) {
        out->squares += measuring->rows[row].squares;
        out->beyond += measuring->rows[row].beyond;
        out->over += measuring->rows[row].over;
        out->far += measuring->rows[row].far;
        out->over_rgb += measuring->rows[row].over_rgb;
        out->far_rgb += measuring->rows[row].far_rgb;
        out->broken += measuring->rows[row].broken;
    }
}

/* Ends as soon as the squares are more than limit: squares can only grow. Fills fit->residuals if
 * it does not. */
static Result measure_form(Fit *fit, const FitRendering *rendering, const GivenMeaning *form,
                           double limit, FitResult *out)
{
    uint32_t rows = (uint32_t)fit->encoded.height;
    Measuring measuring = {fit, *form, encoding_of(fit, rendering, form->encoding, &fit->encoded),
                           memory_array(rows, sizeof(FitResult)), 0};
    Result result = measuring.rows ? RESULT_OK : RESULT_NO_MEMORY;
    *out = (FitResult){.form = *form};
    for (; measuring.phase < PHASES && measuring.phase < rows; measuring.phase++) {
        if (result != RESULT_OK || out->squares > limit)
            break;
        uint32_t count = (rows - measuring.phase + PHASES - 1) / PHASES;
        result = pool_run(fit->pool, count, measure_task, &measuring);
        if (result == RESULT_OK)
            add_rows(&measuring, rows, out);
    }
    free(measuring.rows);
    return result;
}

static Result check_size(const Fit *fit, const FitRendering *rendering)
{
    const Image *final = rendering->final;
    if (final->format == FORMAT_RGBA32F && final->width == fit->theirs.width &&
        final->height == fit->theirs.height)
        return RESULT_OK;
    return result_fail(RESULT_INTERNAL, "fit: expected a rendering of %dx%d in floats",
                       fit->theirs.width, fit->theirs.height);
}

static bool better(const FitResult *a, const FitResult *b)
{
    return a->squares < b->squares || (a->squares == b->squares && a->beyond < b->beyond);
}

Result fit_measure(Fit *fit, const FitRendering *rendering, FitResult *out)
{
    FitResult usual, best;
    Result result = check_size(fit, rendering);
    memset(fit->encoded_rows, GIVEN_ENCODING_DETECT, (size_t)fit->encoded.height);
    if (result == RESULT_OK)
        result = measure_form(fit, rendering, &fit->forms[0], INFINITY, &usual);
    if (result != RESULT_OK)
        return result;
    best = usual;
    double limit = MUCH_BETTER * usual.squares;
    for (int i = 1; i < fit->form_count && best.beyond > 0; i++) {
        FitResult one;
        result = measure_form(fit, rendering, &fit->forms[i], limit, &one);
        if (result != RESULT_OK)
            return result;
        if (one.squares <= limit && better(&one, &best)) {
            best = one;
            limit = one.squares;
        }
    }
    *out = best;
    return RESULT_OK;
}

/* ---- what counts ----------------------------------------------------------------------------- */

bool fit_tolerates(const Fit *fit, const FitResult *result, bool colors)
{
    uint64_t pixels = (uint64_t)fit->theirs.width * (uint64_t)fit->theirs.height;
    uint64_t over = colors ? result->over_rgb : result->over;
    uint64_t far = colors ? result->far_rgb : result->far;
    return result->broken == 0 && over <= pixels / FIT_FEW && far <= pixels / FIT_FEW_FAR;
}

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Of those that are not 0; spoils their order. 0 if there is none. */
static double median(float *residuals, size_t count)
{
    size_t left = 0;
    for (size_t i = 0; i < count; i++)
        if (residuals[i] > 0.0f)
            residuals[left++] = residuals[i];
    qsort(residuals, left, sizeof *residuals, compare_floats);
    return left ? (double)residuals[left / 2] : 0.0;
}

/* The form is chosen with a provisional cap, so that a few large differences do not decide. */
Result fit_reference(Fit *fit, const FitRendering *rendering, FitResult *out)
{
    size_t pixels = (size_t)fit->theirs.width * (size_t)fit->theirs.height;
    fit->tolerant = false;
    fit->cap = 1.0;
    Result result = fit_measure(fit, rendering, out);
    if (result != RESULT_OK)
        return result;
    fit->tolerant = !fit_tolerates(fit, out, false);
    GivenMeaning form = out->form;
    memset(fit->encoded_rows, GIVEN_ENCODING_DETECT, (size_t)fit->encoded.height);
    result = measure_form(fit, rendering, &form, INFINITY, out);
    if (result != RESULT_OK)
        return result;
    double scale = median(fit->residuals, pixels);
    if (scale > 0.0 && isfinite(scale))
        fit->cap = CAP * scale;
    return fit_measure(fit, rendering, out);
}

/* ---- predictions ----------------------------------------------------------------------------- */

Result fit_predict(Fit *fit, const FitRendering *rendering, const GivenMeaning *form, Image *out)
{
    *out = (Image){0};
    Result result = check_size(fit, rendering);
    if (result == RESULT_OK)
        result = image_create(fit->theirs.width, fit->theirs.height, FORMAT_RGBA32F, out);
    for (int y = 0; result == RESULT_OK && y < out->height; y++) {
        Encoding encoding = encoding_of(fit, rendering, form->encoding, out);
        encode_row(&encoding, y);
    }
    float *pixel = out->pixels;
    for (size_t i = 0; result == RESULT_OK && i < (size_t)out->width * (size_t)out->height; i++)
        pixel[4 * i + 3] =
            form->alpha == GIVEN_ALPHA_NONE ? 1.0f : (float)in_form(form, &pixel[4 * i], 3);
    if (result != RESULT_OK)
        image_free(out);
    return result;
}

double fit_residual(const Fit *fit, const GivenMeaning *form, const Image *predicted, int x, int y)
{
    GivenMeaning plain = *form; /* predictions hold alpha as their file does */
    if (plain.alpha == GIVEN_TRANSMITTANCE)
        plain.alpha = GIVEN_COVERAGE;
    PixelResidual residual =
        residual_of(fit, &plain, fit_theirs(fit, form, x, y), image_pixel(predicted, x, y));
    return fit->tolerant ? residual.tolerant : residual.quantised;
}

/* Integers: the same codes. Floats: within quantisation. */
static bool same_value(const Fit *fit, double a, double b)
{
    const FormatInfo *format = format_info(fit->given->stored.format);
    if (!isfinite(a) || !isfinite(b))
        return isfinite(a) == isfinite(b);
    if (format->kind != KIND_UNORM)
        return fabs(a - b) <= limits_at(fit, a, b).quantisation;
    return lrint(a * (double)format->unorm_max) == lrint(b * (double)format->unorm_max);
}

bool fit_same(const Fit *fit, const GivenMeaning *form, const Image *a, const Image *b)
{
    const float *p = a->pixels, *q = b->pixels;
    size_t pixels = (size_t)a->width * (size_t)a->height;
    for (size_t i = 0; i < pixels; i++, p += 4, q += 4)
        for (int c = 0; c < fit_channels(form); c++)
            if (p[c] != q[c] && !same_value(fit, (double)p[c], (double)q[c]))
                return false;
    return true;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static Result copy_theirs(Fit *fit)
{
    const Image *stored = &fit->given->stored;
    Result result = image_create(stored->width, stored->height, FORMAT_RGBA32F, &fit->theirs);
    if (result != RESULT_OK)
        return result;
    float *out = fit->theirs.pixels;
    for (int y = 0; y < stored->height; y++)
        for (int x = 0; x < stored->width; x++)
            for (int c = 0; c < 4; c++)
                *out++ = format_channel(stored->format, image_pixel(stored, x, y), c);
    return RESULT_OK;
}

Result fit_create(const GivenImage *given, const GivenMeaning *options, Pool *pool, Fit *out)
{
    const Image *stored = &given->stored;
    *out = (Fit){.given = given, .pool = pool, .cap = 1.0};
    list_forms(out, options);
    Result result = copy_theirs(out);
    if (result == RESULT_OK)
        result = image_create(stored->width, stored->height, FORMAT_RGBA32F, &out->encoded);
    if (result == RESULT_OK) {
        out->residuals =
            memory_array((size_t)stored->width * (size_t)stored->height, sizeof *out->residuals);
        out->encoded_rows = memory_array((size_t)stored->height, 1);
        result = out->residuals && out->encoded_rows ? RESULT_OK : RESULT_NO_MEMORY;
    }
    if (result != RESULT_OK)
        fit_free(out);
    return result;
}

void fit_free(Fit *fit)
{
    image_free(&fit->theirs);
    image_free(&fit->encoded);
    free(fit->residuals);
    free(fit->encoded_rows);
    *fit = (Fit){0};
}

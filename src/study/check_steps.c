#include "study/check_steps.h"

#include "base/memory.h"
#include "compare/trace_file.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of window depths: what another order of a plane's operations may do in single precision. */
#define DEPTH_TOLERANCE 1e-6

/* A new step that agrees so far; NULL when memory is exhausted. Valid until the next. */
static CheckStep *add_step(CheckRun *run, int order, const char *name)
{
    CheckReport *report = run->report;
    CheckStep *steps = realloc(report->steps, (report->step_count + 1) * sizeof *steps);
    if (!steps) {
        result_fail(RESULT_NO_MEMORY, "out of memory for the steps");
        return NULL;
    }
    report->steps = steps;
    CheckStep *step = &steps[report->step_count++];
    *step = (CheckStep){.order = order, .agree = true};
    snprintf(step->name, sizeof step->name, "%s", name);
    return step;
}

__attribute__((format(printf, 2, 3))) static void note(CheckStep *step, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(step->note, sizeof step->note, format, arguments);
    va_end(arguments);
}

static Result judge_step(CheckStep *step, const JudgeDesc *desc)
{
    Result result = judge(desc, &step->figures);
    step->judged = result == RESULT_OK;
    step->agree = step->figures.agree;
    step->format = desc->format;
    return result;
}

/* Four floats a pixel; what a format has not is 0. */
static Result widen(const Image *image, Image *out)
{
    Result result = image_create(image->width, image->height, FORMAT_RGBA32F, out);
    if (result != RESULT_OK)
        return result;
    size_t count = (size_t)image->width * (size_t)image->height;
    size_t bytes = format_pixel_bytes(image->format);
    int channels = format_info(image->format)->channels;
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < channels; c++)
            ((float *)out->pixels)[4 * i + (size_t)c] =
                format_channel(image->format, (const unsigned char *)image->pixels + i * bytes, c);
    return RESULT_OK;
}

static Result widened_buffer(const TraceStore *store, int index, Image *out)
{
    Image image;
    Result result = store_image(store, index, &image);
    if (result != RESULT_OK)
        return result;
    result = widen(&image, out);
    image_free(&image);
    return result;
}

/* Of final colours: what single precision may do to them, where that is asked for. */
static void allow_bound(const CheckRun *run, JudgeDesc *desc)
{
    if (!run->truth.bound.pixels)
        return;
    desc->center = &run->truth.final;
    desc->slack = &run->truth.bound;
}

/* ---- their image ------------------------------------------------------------------------------
 */

static Result check_image(CheckRun *run)
{
    GivenReading reading;
    CheckReport *report = run->report;
    const GivenImage *given = &run->image;
    Result result = given_interpret(given, &report->frame.final, &run->check->meaning, &reading);
    if (result != RESULT_OK)
        return result;
    given_describe(given, &reading, report->reading, sizeof report->reading);
    report->meaning = reading.meaning;
    report->sure = reading.sure;
    JudgeDesc desc = {.theirs = &reading.encoded,
                      .reference = &report->frame.final,
                      .display = &report->frame.display,
                      .encoding = reading.meaning.encoding,
                      .format = given->stored.format,
                      .reference_format = FORMAT_RGBA32F,
                      .channels = reading.meaning.alpha == GIVEN_ALPHA_NONE ? 3 : 4,
                      .tolerance = report->tolerance};
    allow_bound(run, &desc);
    CheckStep *step = add_step(run, INT_MAX, "image");
    result = step ? judge_step(step, &desc) : RESULT_NO_MEMORY;
    image_swap(&report->theirs_image, &reading.linear);
    given_reading_free(&reading);
    return result;
}

/* ---- buffers of a trace -----------------------------------------------------------------------
 */

/* Their display against the final colours, in which a step of 8 bits more or less is decided. */
static void display_desc(const CheckRun *run, JudgeDesc *desc)
{
    desc->reference = &run->report->frame.final;
    desc->display = &run->report->frame.display;
    desc->encoding = GIVEN_SEED;
    desc->channels = 3;
    allow_bound(run, desc);
}

static Result judge_buffer(CheckRun *run, CheckStep *step, int theirs, int reference)
{
    const StoredBuffer *a = store_buffer(run->theirs, theirs);
    const StoredBuffer *b = store_buffer(run->reference, reference);
    int channels = format_info(a->format)->channels;
    step->format = a->format;
    if (channels != format_info(b->format)->channels) {
        note(step, "not compared: %d channels, the reference has %d", channels,
             format_info(b->format)->channels);
        return RESULT_OK;
    }
    Image images[2] = {0};
    Result result = widened_buffer(run->theirs, theirs, &images[0]);
    if (result == RESULT_OK)
        result = widened_buffer(run->reference, reference, &images[1]);
    JudgeDesc desc = {.theirs = &images[0],
                      .reference = &images[1],
                      .encoding = GIVEN_LINEAR,
                      .format = a->format,
                      .reference_format = b->format,
                      .channels = channels,
                      .tolerance = channels == 1 ? DEPTH_TOLERANCE : run->report->tolerance};
    if (strcmp(a->name, "display") == 0)
        display_desc(run, &desc);
    if (result == RESULT_OK)
        result = judge_step(step, &desc);
    image_free(&images[0]);
    image_free(&images[1]);
    return result;
}

/* The last accumulation of the peels, which an empty peel leaves as it is; −1: there is none. */
static int last_accum(const TraceStore *store)
{
    int last = -1;
    for (int i = 0; i < store_count(store); i++) {
        const char *name = store_buffer(store, i)->name, *what = strrchr(name, '.');
        if (trace_name_peel(name) >= 0 && strcmp(what, ".accum") == 0)
            last = i;
    }
    return last;
}

/* Buffers of theirs alone come behind those of the reference's last peel. */
static int extra_order(const TraceStore *reference)
{
    int order = 0;
    for (int i = 0; i < store_count(reference); i++)
        if (trace_name_step(store_buffer(reference, i)->name) != INT_MAX)
            order = 2 * i + 1;
    return order;
}

/* Counts buffers that the other has, too. */
static int peel_count(const TraceStore *store, const TraceStore *other)
{
    int count = 0;
    for (int i = 0; i < store_count(store); i++) {
        const char *name = store_buffer(store, i)->name;
        int peel = trace_name_peel(name);
        if (peel >= count && store_find(other, name) >= 0)
            count = peel + 1;
    }
    return count;
}

/* Buffers of theirs that the reference has not: of a peel beyond its last, or of another method. */
static Result check_extra(CheckRun *run, int index)
{
    const StoredBuffer *buffer = store_buffer(run->theirs, index);
    const char *name = buffer->name, *what = strrchr(name, '.');
    CheckStep *step = add_step(run, extra_order(run->reference), name);
    if (!step)
        return RESULT_NO_MEMORY;
    int peels = peel_count(run->reference, run->reference), last = last_accum(run->reference);
    step->format = buffer->format;
    if (trace_name_peel(name) < peels || last < 0 || strcmp(what, ".accum") != 0) {
        note(step, "not compared: the reference has no such buffer");
        return RESULT_OK;
    }
    note(step, "the reference has only %d peels: this one must add nothing", peels);
    return judge_buffer(run, step, index, last);
}

/* Where their trace ends too early, the peel that is missing is the first difference. */
static Result check_missing(CheckRun *run)
{
    int theirs = peel_count(run->theirs, run->reference);
    int reference = peel_count(run->reference, run->reference);
    char name[48];
    if (theirs == 0 || theirs >= reference)
        return RESULT_OK;
    snprintf(name, sizeof name, "peel.%d", theirs);
    int order = 0;
    while (trace_name_peel(store_buffer(run->reference, order)->name) != theirs)
        order++;
    CheckStep *step = add_step(run, 2 * order, name);
    if (!step)
        return RESULT_NO_MEMORY;
    step->agree = false;
    note(step, "missing: theirs ends after %d peels, the reference has %d", theirs, reference);
    return RESULT_OK;
}

/* Which triangle a fragment is of: numbers that only Peel gives. */
static bool is_diagnostic(const char *name)
{
    const char *what = strrchr(name, '.');
    return what && strcmp(what, ".primitive") == 0;
}

static Result check_trace(CheckRun *run)
{
    Result result = RESULT_OK;
    for (int i = 0; i < store_count(run->reference) && result == RESULT_OK; i++) {
        const char *name = store_buffer(run->reference, i)->name;
        int theirs = store_find(run->theirs, name);
        if (theirs < 0 || is_diagnostic(name))
            continue;
        CheckStep *step = add_step(run, 2 * i, name);
        result = step ? judge_buffer(run, step, theirs, i) : RESULT_NO_MEMORY;
    }
    for (int i = 0; i < store_count(run->theirs) && result == RESULT_OK; i++) {
        const char *name = store_buffer(run->theirs, i)->name;
        if (store_find(run->reference, name) < 0 && !is_diagnostic(name))
            result = check_extra(run, i);
    }
    return result == RESULT_OK ? check_missing(run) : result;
}

/* ---- single files -----------------------------------------------------------------------------
 */

/* The rows of a file of depths are in the order that fits better. */
static bool is_bottom_up(const Image *theirs, const Image *reference)
{
    double sums[2] = {0.0, 0.0};
    for (int y = 0; y < theirs->height; y++)
        for (int x = 0; x < theirs->width; x++) {
            double expected = (double)*(const float *)image_pixel(reference, x, y);
            for (int flip = 0; flip < 2; flip++) {
                int row = flip ? theirs->height - 1 - y : y;
                double d = fabs((double)*(const float *)image_pixel(theirs, x, row) - expected);
                sums[flip] += isfinite(d) ? d : 0.0;
            }
        }
    return sums[1] < 0.5 * sums[0];
}

static void flip_rows(Image *image)
{
    size_t bytes = (size_t)image->width * format_pixel_bytes(image->format);
    for (int top = 0, bottom = image->height - 1; top < bottom; top++, bottom--) {
        char *a = image_pixel(image, 0, top), *b = image_pixel(image, 0, bottom);
        for (size_t i = 0; i < bytes; i++) {
            char byte = a[i];
            a[i] = b[i];
            b[i] = byte;
        }
    }
}

static Result check_depth(CheckRun *run, CheckStep *step, const CheckLoaded *loaded, int reference)
{
    const Image *depth = &loaded->depth;
    Image images[2] = {0};
    Result result = widen(depth, &images[0]);
    if (result == RESULT_OK)
        result = widened_buffer(run->reference, reference, &images[1]);
    if (result == RESULT_OK) {
        GivenRows rows = run->check->meaning.rows;
        bool flip = rows == GIVEN_ROWS_DETECT ? is_bottom_up(&images[0], &images[1])
                                              : rows == GIVEN_BOTTOM_UP;
        if (flip)
            flip_rows(&images[0]);
        note(step, "%srows from the %s", loaded->half ? "halves, " : "", flip ? "bottom" : "top");
        JudgeDesc desc = {.theirs = &images[0],
                          .reference = &images[1],
                          .encoding = GIVEN_LINEAR,
                          .format = loaded->half ? FORMAT_RGBA16F : depth->format,
                          .reference_format = store_buffer(run->reference, reference)->format,
                          .channels = 1,
                          .tolerance = DEPTH_TOLERANCE};
        result = judge_step(step, &desc);
        step->format = depth->format;
    }
    image_free(&images[0]);
    image_free(&images[1]);
    return result;
}

/* A layer's colour: the accumulation, or with forward methods the layer alone. In the buffer A is
 * the transmittance, or the layer's alpha. */
static Result check_layer(CheckRun *run, CheckStep *step, const GivenImage *given, int reference,
                          bool accum)
{
    Image expected;
    GivenReading reading = {0};
    Result result = widened_buffer(run->reference, reference, &expected);
    if (result != RESULT_OK)
        return result;
    float *pixels = expected.pixels;
    size_t count = (size_t)expected.width * (size_t)expected.height;
    for (size_t i = 0; accum && i < count; i++)
        pixels[4 * i + 3] = 1.0f - pixels[4 * i + 3];
    result = given_interpret(given, &expected, &run->check->meaning, &reading);
    if (result == RESULT_OK) {
        char text[128];
        given_describe(given, &reading, text, sizeof text);
        note(step, "%.95s", text);
        JudgeDesc desc = {.theirs = &reading.encoded,
                          .reference = &expected,
                          .encoding = reading.meaning.encoding,
                          .format = given->stored.format,
                          .reference_format = store_buffer(run->reference, reference)->format,
                          .channels = reading.meaning.alpha == GIVEN_ALPHA_NONE ? 3 : 4,
                          .tolerance = run->report->tolerance};
        result = judge_step(step, &desc);
    }
    given_reading_free(&reading);
    image_free(&expected);
    return result;
}

/* The layer's accumulation, or its own colour where that is there and fits better. */
static Result check_color(CheckRun *run, CheckStep *step, size_t index, int accum)
{
    char name[48];
    const GivenImage *given = &run->files[index].image;
    snprintf(name, sizeof name, "peel.%d.color", run->check->files[index].peel);
    int color = store_find(run->reference, name);
    CheckStep other = *step;
    Result result = check_layer(run, step, given, accum, true);
    if (result != RESULT_OK || color < 0)
        return result;
    snprintf(other.name, sizeof other.name, "%s", name);
    result = check_layer(run, &other, given, color, false);
    if (result == RESULT_OK && other.figures.rmse < step->figures.rmse)
        *step = other;
    return result;
}

static Result check_file(CheckRun *run, size_t index)
{
    const CheckFile *file = &run->check->files[index];
    char name[48];
    if (file->peel < 0)
        snprintf(name, sizeof name, "opaque.%s", file->depth ? "depth" : "color");
    else
        snprintf(name, sizeof name, "peel.%d.%s", file->peel, file->depth ? "depth" : "accum");
    int reference = store_find(run->reference, name);
    if (reference < 0)
        return result_fail(RESULT_BAD_INPUT,
                           "%s: the reference has no %s (it has %d peels), expected one of its "
                           "buffers",
                           file->path, name, peel_count(run->reference, run->reference));
    CheckStep *step = add_step(run, 2 * reference, name);
    if (!step)
        return RESULT_NO_MEMORY;
    return file->depth ? check_depth(run, step, &run->files[index], reference)
                       : check_color(run, step, index, reference);
}

/* ---- all --------------------------------------------------------------------------------------
 */

/* Of a trace, for pictures: the accumulation over the background. With the seed's opaque blend its
 * alpha is no transmittance; the reference's is taken. */
static Result trace_picture(CheckRun *run)
{
    Image *out = &run->report->theirs_image;
    int index = store_find(run->theirs, "accum");
    if (index < 0 || format_info(store_buffer(run->theirs, index)->format)->channels != 4)
        return RESULT_OK;
    Result result = widened_buffer(run->theirs, index, out);
    if (result != RESULT_OK)
        return result;
    float *pixel = out->pixels;
    const float *reference = run->report->frame.final.pixels;
    size_t count = (size_t)out->width * (size_t)out->height;
    for (size_t i = 0; i < count; i++, pixel += 4, reference += 4) {
        float left = run->desc.opaque_blend == OPAQUE_BLEND_SEED ? 1.0f - reference[3] : pixel[3];
        for (int c = 0; c < 3; c++)
            pixel[c] += run->background[c] * left;
        pixel[3] = 1.0f - left;
    }
    return RESULT_OK;
}

Result check_steps(CheckRun *run)
{
    Result result = RESULT_OK;
    if (store_count(run->theirs) > 0)
        result = check_trace(run);
    if (result == RESULT_OK && store_count(run->theirs) > 0)
        result = trace_picture(run);
    for (size_t i = 0; i < run->check->file_count && result == RESULT_OK; i++)
        result = check_file(run, i);
    if (result == RESULT_OK && run->image.stored.pixels)
        result = check_image(run);
    return result;
}

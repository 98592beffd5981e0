#include "study/check.h"

#include "base/memory.h"
#include "base/progress.h"
#include "compare/store.h"
#include "compare/trace_file.h"
#include "frame/method.h"
#include "number/numeral.h"
#include "study/check_steps.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Where the method's own tolerance is 0, because it is not exact: here the same method is meant. */
#define TOLERANCE_DEFAULT 1e-4

static Result size_failure(const CheckRun *run, const char *path, const char *buffer, int width,
                           int height)
{
    *run->sizes = CHECK_SIZES_DIFFER;
    return result_fail(RESULT_BAD_INPUT,
                       "%s:%s%s %dx%d pixels, the reference has %dx%d; expected the same size "
                       "(--size)",
                       path, *buffer ? " " : "", buffer, width, height, run->desc.width,
                       run->desc.height);
}

/* ---- what they gave, before anything is rendered --------------------------------------------- */

static Result load_image(const CheckRun *run, const char *path, GivenImage *out)
{
    const int size[] = {run->desc.width, run->desc.height};
    Result result = given_load(path, size, out);
    if (result != RESULT_OK)
        return result;
    if (out->stored.width == run->desc.width && out->stored.height == run->desc.height)
        return RESULT_OK;
    result = size_failure(run, path, "", out->stored.width, out->stored.height);
    given_free(out);
    return result;
}

static Result load_trace(CheckRun *run, const char *path)
{
    Result result = trace_file_read(path, run->theirs);
    for (int i = 0; i < store_count(run->theirs) && result == RESULT_OK; i++) {
        const StoredBuffer *buffer = store_buffer(run->theirs, i);
        if (buffer->width != run->desc.width || buffer->height != run->desc.height)
            result = size_failure(run, path, buffer->name, buffer->width, buffer->height);
    }
    return result;
}

/* Of a colour image, whatever its size, nobody knows which channel would be meant. */
static Result expect_grey(const Image *image, const char *path)
{
    const FormatInfo *info = format_info(image->format);
    size_t pixels = image->pixels ? (size_t)image->width * (size_t)image->height : 0;
    bool grey = info->channels == 1 || info->kind == KIND_UNORM;
    for (size_t i = 0; i < pixels && grey && info->channels > 1; i++) {
        const char *pixel = (const char *)image->pixels + i * format_pixel_bytes(image->format);
        grey = format_bits(image->format, pixel, 0) == format_bits(image->format, pixel, 1) &&
               format_bits(image->format, pixel, 0) == format_bits(image->format, pixel, 2);
    }
    return grey ? RESULT_OK
                : result_fail(RESULT_BAD_INPUT,
                              "--depth: %s has colours, expected an EXR with one channel or a grey "
                              "PNG",
                              path);
}

static Result load_depth(const CheckRun *run, const char *path, CheckLoaded *loaded)
{
    const int size[] = {run->desc.width, run->desc.height};
    Image *out = &loaded->depth;
    bool exr;
    char name[64];
    Result result = exr_is(path, &exr);
    if (result != RESULT_OK)
        return result;
    if (exr) {
        result = exr_read_sized(path, 0, size, out, name);
        if (result == RESULT_OK)
            result = exr_is_half(path, 0, &loaded->half);
    } else {
        GivenImage given; /* of grey, each channel has the value */
        result = given_load(path, size, &given);
        *out = given.stored;
    }
    if (result == RESULT_OK)
        result = expect_grey(out, path);
    if (result == RESULT_OK && (out->width != run->desc.width || out->height != run->desc.height))
        result = size_failure(run, path, "", out->width, out->height);
    if (result != RESULT_OK)
        image_free(out);
    return result;
}

static Result load_files(CheckRun *run)
{
    const CheckDesc *check = run->check;
    run->files = memory_array(check->file_count, sizeof *run->files);
    Result result = run->files ? RESULT_OK : RESULT_NO_MEMORY;
    for (size_t i = 0; i < check->file_count && result == RESULT_OK; i++) {
        const CheckFile *file = &check->files[i];
        result = file->depth ? load_depth(run, file->path, &run->files[i])
                             : load_image(run, file->path, &run->files[i].image);
    }
    return result;
}

/* What is said of values has to be of some. */
static Result check_meaning(const CheckRun *run, bool trace)
{
    const CheckDesc *check = run->check;
    const GivenMeaning *meaning = &check->meaning;
    bool colors = check->theirs && !trace, alpha = run->image.has_alpha;
    for (size_t i = 0; i < check->file_count; i++) {
        colors |= !check->files[i].depth;
        alpha |= run->files[i].image.has_alpha;
    }
    bool rows = colors || check->file_count > 0;
    if (((meaning->encoding || meaning->alpha) && !colors) || (meaning->rows && !rows))
        return result_fail(
            RESULT_BAD_INPUT,
            "--encoding, --alpha, --flip, --no-flip: expected an image: a trace says "
            "itself what it holds, and depths have rows alone");
    return given_check_alpha(meaning, alpha);
}

static Result load(CheckRun *run)
{
    bool trace = false;
    Result result = store_create(0, &run->theirs);
    if (result == RESULT_OK && run->check->theirs)
        result = trace_file_is(run->check->theirs, &trace);
    if (result == RESULT_OK && run->check->theirs)
        result = trace ? load_trace(run, run->check->theirs)
                       : load_image(run, run->check->theirs, &run->image);
    if (result == RESULT_OK)
        result = load_files(run);
    return result == RESULT_OK ? check_meaning(run, trace) : result;
}

/* ---- the reference --------------------------------------------------------------------------- */

static Result render(CheckRun *run, const Scene *scene, Renderer ref, Renderer truth)
{
    RenderDesc desc = run->desc;
    bool traced = store_count(run->theirs) > 0 || run->check->file_count > 0;
    Result result = traced ? store_create(0, &run->reference) : RESULT_OK;
    if (result != RESULT_OK)
        return result;
    desc.bound = false;
    progress_begin("ref", 0);
    result = ref(scene, &desc, traced ? store_sink(run->reference) : NULL, &run->report->frame);
    progress_end();
    if (result != RESULT_OK || !run->desc.bound)
        return result;
    progress_begin("truth, with bounds", 0);
    result = truth(scene, &run->desc, NULL, &run->truth);
    progress_end();
    return result;
}

/* ---- the verdict ----------------------------------------------------------------------------- */

/* By their order, which for equal ones stays: few steps are out of place. */
static void sort_steps(CheckStep *steps, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        CheckStep step = steps[i];
        size_t at = i;
        for (; at > 0 && steps[at - 1].order > step.order; at--)
            steps[at] = steps[at - 1];
        steps[at] = step;
    }
}

static Result conclude(CheckReport *report)
{
    bool any = false;
    sort_steps(report->steps, report->step_count);
    report->first = -1;
    for (size_t i = report->step_count; i-- > 0;) {
        any |= report->steps[i].judged;
        if (!report->steps[i].agree)
            report->first = (int)i;
    }
    report->agree = report->first < 0;
    if (any || !report->agree)
        return RESULT_OK;
    return result_fail(RESULT_BAD_INPUT,
                       "%s: the reference has none of its buffers (by --method %s), expected at "
                       "least one",
                       report->theirs, method_info(report->desc.method)->name);
}

static void free_run(CheckRun *run)
{
    for (size_t i = 0; run->files && i < run->check->file_count; i++) {
        given_free(&run->files[i].image);
        image_free(&run->files[i].depth);
    }
    free(run->files);
    given_free(&run->image);
    frame_free(&run->truth);
    store_destroy(run->theirs);
    store_destroy(run->reference);
}

Result check_run(const Scene *scene, const RenderDesc *desc, Renderer ref, Renderer truth,
                 const CheckDesc *check, CheckReport *out, CheckSizes *sizes)
{
    double method = method_info(desc->method)->tolerance;
    *out = (CheckReport){.scene_name = scene->name,
                         .scene_path = check->scene_path,
                         .theirs = check->theirs,
                         .desc = *desc,
                         .tolerance = check->tolerance,
                         .first = -1};
    if (out->tolerance < 0.0)
        out->tolerance = method > 0.0 ? method : TOLERANCE_DEFAULT;
    *sizes = CHECK_SIZES_EQUAL;
    CheckRun run = {.desc = *desc,
                    .background = scene->background,
                    .check = check,
                    .report = out,
                    .sizes = sizes};
    Result result = load(&run);
    if (result == RESULT_OK)
        result = render(&run, scene, ref, truth);
    if (result == RESULT_OK)
        result = check_steps(&run);
    if (result == RESULT_OK)
        result = conclude(out);
    if (result != RESULT_OK)
        check_free(out);
    free_run(&run);
    return result;
}

void check_free(CheckReport *report)
{
    frame_free(&report->frame);
    image_free(&report->theirs_image);
    free(report->steps);
    *report = (CheckReport){.first = -1};
}

void check_describe_worst(const CheckStep *step, char *text, size_t size)
{
    const JudgeWorst *worst = &step->figures.worst;
    const char *unit = format_info(step->format)->kind == KIND_UNORM ? "steps" : "ULP";
    char apart[48] = "";
    if (worst->ulp >= 0.0)
        snprintf(apart, sizeof apart, ", %.10g %s apart", worst->ulp, unit);
    const char *channel = format_info(step->format)->channels == 1 ? "" : "RGBA";
    char theirs[NUMERAL_BOTH], reference[NUMERAL_BOTH];
    snprintf(text, size, "pixel (%d, %d)%s%.1s: theirs %s, reference %s%s", worst->x, worst->y,
             *channel ? ", " : "", *channel ? channel + worst->channel : "",
             numeral_both(worst->theirs, theirs), numeral_both(worst->reference, reference), apart);
}

#include "study/hard.h"

#include "frame/method.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- configurations -------------------------------------------------------------------------- */

typedef enum DepthKind {
    DEPTH_KIND_32F,
    DEPTH_KIND_24,
    DEPTH_KIND_16,
    DEPTH_KIND_REVERSED
} DepthKind;

/* What every case goes through beside the default and its own. */
static const struct {
    const char *name;
    RenderDesc desc;
    DepthKind depth;
} standard[] = {
    {"peel-id", {.method = METHOD_PEEL_ID}, DEPTH_KIND_32F},
    {"linked-list", {.method = METHOD_LINKED_LIST}, DEPTH_KIND_32F},
    {"d24", {.depth = FORMAT_D24}, DEPTH_KIND_24},
    {"d16", {.depth = FORMAT_D16}, DEPTH_KIND_16},
    {"reversed", {.depth_range = DEPTH_RANGE_REVERSED}, DEPTH_KIND_REVERSED},
    {"rgba16f", {.accum = FORMAT_RGBA16F}, DEPTH_KIND_32F},
    {"rgba16", {.accum = FORMAT_RGBA16}, DEPTH_KIND_32F},
    {"rgba8", {.accum = FORMAT_RGBA8}, DEPTH_KIND_32F},
    {"dual", {.method = METHOD_DUAL}, DEPTH_KIND_32F},
    {"forward", {.method = METHOD_FORWARD}, DEPTH_KIND_32F},
    {"forward-dual", {.method = METHOD_FORWARD_DUAL}, DEPTH_KIND_32F},
    {"weighted-average", {.method = METHOD_WEIGHTED_AVERAGE}, DEPTH_KIND_32F},
    {"weighted-sum", {.method = METHOD_WEIGHTED_SUM}, DEPTH_KIND_32F},
    {"weighted-blended", {.method = METHOD_WEIGHTED_BLENDED}, DEPTH_KIND_32F},
    {"weighted-blended rgba16f",
     {.method = METHOD_WEIGHTED_BLENDED, .accum = FORMAT_RGBA16F},
     DEPTH_KIND_32F},
    {"painter", {.method = METHOD_PAINTER}, DEPTH_KIND_32F},
};

/* What is expected of a standard configuration. */
static HardExpect standard_expect(const HardCase *hard, const RenderDesc *desc, DepthKind depth)
{
    const HardExpect *const by_depth[] = {&hard->d32f, &hard->d24, &hard->d16, &hard->reversed};
    HardExpect expect = *by_depth[depth];
    const HardCount none = {0, 0};
    if (!method_info(desc->method)->loses_ties)
        expect.ties = none;
    if (desc->method != METHOD_PEEL || desc->accum != FORMAT_RGBA32F)
        memset(expect.pixels, 0, sizeof expect.pixels);
    return expect;
}

static bool has_own(const HardCase *hard, const char *name)
{
    for (int i = 0; i < HARD_OWN && hard->own[i].name; i++)
        if (strcmp(hard->own[i].name, name) == 0)
            return true;
    return false;
}

/* A slow case leaves out formats and methods that peel as often and show nothing more. */
static bool is_left_out(const HardCase *hard, const char *name)
{
    static const char *const names[] = {"d24", "d16", "reversed", "forward", "forward-dual"};
    for (size_t i = 0; hard->slow && i < sizeof names / sizeof names[0]; i++)
        if (strcmp(names[i], name) == 0)
            return true;
    return has_own(hard, name);
}

size_t hard_configs(const HardCase *hard, bool slice, HardConfig out[HARD_CONFIGS])
{
    enum {
        SLICE = 3
    };
    size_t count = 0;
    if (!(slice && hard->slow))
        out[count++] = (HardConfig){.name = "peel", .expect = hard->d32f};
    for (int i = 0; i < HARD_OWN && hard->own[i].name; i++)
        out[count++] = hard->own[i];
    for (size_t i = 0; i < sizeof standard / sizeof standard[0]; i++)
        if (!is_left_out(hard, standard[i].name))
            out[count++] =
                (HardConfig){.name = standard[i].name,
                             .desc = standard[i].desc,
                             .expect = standard_expect(hard, &standard[i].desc, standard[i].depth)};
    if (slice)
        count = hard->slow ? 1 : count < SLICE ? count : SLICE;
    for (size_t i = 0; i < count; i++)
        out[i].desc.width = out[i].desc.height = hard->size;
    return count;
}

/* ---- judgement ------------------------------------------------------------------------------- */

/* Blending under with stored colours and transmittance of steps of `step` (halves truncate; their
 * steps are relative to the value): a layer of alpha a and colour c ≤ 1 adds a·c·T to the colour
 * and multiplies T with 1 − a. Storing both adds an error of at most one step to each (as integers
 * the source is rounded first, by half a step, and the result by half a step); the error e of T
 * becomes (1 − a)·e there and a·c·e in the colour, together no more than e. So the two errors
 * together grow by at most two steps with every layer.
 *
 * A linked list's nodes have colour and alpha in 8 bits: half a step more for each of the two. */
static double accum_step(PixelFormat format)
{
    switch (format) {
    case FORMAT_RGBA16F:
        return 0x1p-10;
    case FORMAT_RGBA16:
        return 1.0 / 65535.0;
    case FORMAT_RGBA8:
        return 1.0 / 255.0;
    default:
        return 0.0;
    }
}

double hard_error_bound(const HardCase *hard, const RenderDesc *desc, uint32_t layers)
{
    const MethodInfo *method = method_info(desc->method);
    bool unorm = desc->accum == FORMAT_RGBA16 || desc->accum == FORMAT_RGBA8;
    if (!method->exact || (hard->bright && unorm))
        return INFINITY;
    double single = fmax(hard->error > 0.0 ? hard->error : 1e-4, method->tolerance);
    if (desc->method == METHOD_LINKED_LIST)
        single += (layers + 1.0) / 255.0;
    return single + 2.0 * (layers + 1.0) * accum_step(desc->accum);
}

static bool within(HardCount expected, uint64_t got)
{
    return got >= expected.least && got <= expected.most;
}

/* "3", "at least 3", "3 to 5". */
static void count_text(HardCount count, char *out, size_t size)
{
    if (count.least == count.most)
        snprintf(out, size, "%" PRIu64, count.least);
    else if (count.most == UINT64_MAX)
        snprintf(out, size, "at least %" PRIu64, count.least);
    else
        snprintf(out, size, "%" PRIu64 " to %" PRIu64, count.least, count.most);
}

static bool judge_count(HardRow *row, const char *what, HardCount expected, uint64_t got)
{
    char text[64];
    if (within(expected, got))
        return true;
    count_text(expected, text, sizeof text);
    snprintf(row->failure, sizeof row->failure, "%" PRIu64 " %s, expected %s", got, what, text);
    return false;
}

static bool judge_counts(const HardCase *hard, HardRow *row)
{
    const HardExpect *expect = &row->config.expect;
    const LayerStats *layers = &row->layers;
    const HardCount none = {0, 0}, any = HARD_ANY;
    const struct {
        const char *what;
        HardCount expected;
        uint64_t got;
        bool always; /* known of every method */
    } counts[] = {
        {"values differ between ref and gl", expect->gl_apart ? any : none, row->ref_gl, true},
        {"stored values are not finite", none, row->nonfinite, true},
        {"layers lost to ties", expect->ties, layers->lost_to_ties, false},
        {"layers lost to the pass limit", expect->limit, layers->lost_to_pass_limit, false},
        {"layers lost to overflow", expect->overflow, layers->lost_to_overflow, false},
        {"layers repeated", expect->repeated, layers->repeated, false},
        {"inversions", expect->inversions, row->inversions, false},
        {"fragments on one side only", expect->sets, row->sets, false},
        {"pixels with another opaque surface", expect->flips, row->flips, false},
    };
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        if ((counts[i].always || row->structure) &&
            !judge_count(row, counts[i].what, counts[i].expected, counts[i].got))
            return false;
    if (hard->fragments.most && row->structure &&
        !judge_count(row, "fragments", hard->fragments, layers->fragments))
        return false;
    return !(hard->deepest.most && row->structure) ||
           judge_count(row, "layers in the deepest pixel", hard->deepest, layers->max);
}

static bool judge_pixel(HardRow *row, int index, int side)
{
    static const char *const names[2] = {"ref", "truth"};
    const HardPixel *expect = &row->config.expect.pixels[index];
    for (int c = 0; c < 4; c++) {
        double got = (double)row->pixels[index][side][c], value = expect->value[c];
        double allowed = side == 0 ? expect->tolerance : 1e-6;
        if (fabs(got - value) <= allowed * fmax(1.0, fabs(value)))
            continue;
        snprintf(row->failure, sizeof row->failure,
                 "%s is %.9g in channel %d of pixel (%d, %d), expected %.9g within %.2g",
                 names[side], got, c, expect->x, expect->y, value, allowed);
        return false;
    }
    return true;
}

static bool judge_pixels(HardRow *row)
{
    for (int i = 0; i < HARD_PIXELS; i++) {
        const HardPixel *expect = &row->config.expect.pixels[i];
        if (!(expect->tolerance > 0.0))
            continue;
        if (!judge_pixel(row, i, 0) || (!expect->format_only && !judge_pixel(row, i, 1)))
            return false;
    }
    return true;
}

static bool judge_image(HardRow *row)
{
    const char *image = row->config.expect.image;
    if (!row->image_like)
        return true;
    bool same = image[0] != '!';
    if (row->image_same == same)
        return true;
    snprintf(row->failure, sizeof row->failure, "the image %s that of %s",
             same ? "differs from" : "is", same ? image : image + 1);
    return false;
}

static bool judge_error(HardRow *row)
{
    if (row->error <= row->bound && row->error >= row->config.expect.error_from)
        return true;
    if (row->error > row->bound)
        snprintf(row->failure, sizeof row->failure, "error %.3g, expected at most %.3g", row->error,
                 row->bound);
    else
        snprintf(row->failure, sizeof row->failure, "error %.3g, expected at least %.3g",
                 row->error, row->config.expect.error_from);
    return false;
}

void hard_judge(const HardCase *hard, HardRow *row)
{
    double bound = row->config.expect.error;
    row->failure[0] = 0;
    row->bound = bound > 0.0 ? bound : hard_error_bound(hard, &row->config.desc, row->layers.max);
    row->pass =
        judge_counts(hard, row) && judge_error(row) && judge_pixels(row) && judge_image(row);
}

/* ---- running --------------------------------------------------------------------------------- */

static void take_figures(const Threeway *report, HardRow *row)
{
    const PairReport *ref_gl = &report->pairs[0], *ref_truth = &report->pairs[1];
    row->structure = report->structure.known;
    row->layers = report->structure.layers;
    row->inversions = report->structure.order_inversions;
    row->sets = report->structure.set_differs;
    row->flips = report->structure.opaque_flips;
    row->nonfinite = report->nonfinite + ref_gl->final.nonfinite + ref_truth->final.nonfinite;
    row->ref_gl = ref_gl->final.differing;
    row->max_ulp_gl = ref_gl->final.max_ulp;
    for (size_t i = 0; i < ref_gl->buffer_count; i++) {
        row->ref_gl += ref_gl->buffers[i].differing;
        if (ref_gl->buffers[i].max_ulp > row->max_ulp_gl)
            row->max_ulp_gl = ref_gl->buffers[i].max_ulp;
    }
    row->max_abs = ref_truth->final.max_abs;
    row->rmse = ref_truth->final.rmse;
    row->error = ref_truth->unaffected.max_rel;
    row->max_ulp_truth = ref_truth->final.max_ulp;
    for (int i = 0; i < RENDERER_COUNT; i++)
        row->time_ms += report->frames[i].time_ms;
    for (int i = 0; i < HARD_PIXELS; i++)
        for (int side = 0; side < 2; side++) {
            const HardPixel *pixel = &row->config.expect.pixels[i];
            const Frame *frame = &report->frames[side ? RENDERER_TRUTH : RENDERER_REF];
            memcpy(row->pixels[i][side], image_pixel(&frame->final, pixel->x, pixel->y),
                   sizeof row->pixels[i][side]);
        }
}

/* Moves the pictures out of a comparison. */
static void take_images(Threeway *from, size_t index, HardReport *out)
{
    Frame *ref = &from->frames[RENDERER_REF], *truth = &from->frames[RENDERER_TRUTH];
    out->finals[index] = ref->final;
    ref->final = (Image){0};
    if (index > 0)
        return;
    out->truth = truth->final;
    out->displays[0] = ref->display;
    out->displays[1] = truth->display;
    truth->final = ref->display = truth->display = (Image){0};
}

static void compare_images(HardReport *report, size_t index)
{
    HardRow *row = &report->rows[index];
    const char *name = row->config.expect.image;
    if (!name)
        return;
    name += name[0] == '!';
    for (size_t i = 0; i < index; i++)
        if (strcmp(report->rows[i].config.name, name) == 0)
            row->image_like = (int)i + 1;
    if (!row->image_like)
        return;
    const Image *a = &report->finals[row->image_like - 1], *b = &report->finals[index];
    size_t bytes = (size_t)a->width * (size_t)a->height * format_pixel_bytes(a->format);
    row->image_same = memcmp(a->pixels, b->pixels, bytes) == 0;
}

static Result run_config(const Scene *scene, const HardConfig *config, size_t index,
                         const Renderer renderers[RENDERER_COUNT], HardReport *out)
{
    Threeway report;
    Result result =
        threeway_run(scene, scene->name, &config->desc, renderers, -1.0, false, &report);
    if (result != RESULT_OK)
        return result;
    HardRow *row = &out->rows[index];
    *row = (HardRow){.config = *config};
    row->config.desc = report.desc;
    take_figures(&report, row);
    take_images(&report, index, out);
    threeway_free(&report);
    out->row_count = index + 1;
    compare_images(out, index);
    hard_judge(out->hard, row);
    out->failed += !row->pass;
    return RESULT_OK;
}

Result hard_run(const HardCase *hard, bool slice, const Renderer renderers[RENDERER_COUNT],
                HardReport *out)
{
    *out = (HardReport){.hard = hard, .scene = hard_scenes_find(hard->name)};
    if (!out->scene)
        return result_fail(RESULT_INTERNAL, "hard case %s has no scene", hard->name);
    HardConfig configs[HARD_CONFIGS];
    size_t count = hard_configs(hard, slice, configs);
    Scene scene;
    Result result = out->scene->generate(&scene);
    if (result != RESULT_OK)
        return result;
    for (size_t i = 0; i < count && result == RESULT_OK; i++)
        result = run_config(&scene, &configs[i], i, renderers, out);
    scene_free(&scene);
    return result;
}

void hard_free(HardReport *report)
{
    for (size_t i = 0; i < report->row_count; i++)
        image_free(&report->finals[i]);
    image_free(&report->truth);
    image_free(&report->displays[0]);
    image_free(&report->displays[1]);
    *report = (HardReport){0};
}

#include "ref/pipeline/methods/minmax.h"

#include "base/memory.h"
#include "frame/method.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NO_LAYER (-2.0f)

/* ---- fragments ---- */

static bool is_visible(const StageVisit *visit, const Setup *setup, int x, int y,
                       MinMaxFragment *out)
{
    const Stage *stage = visit->stage;
    const Pass *pass = stage->pass;
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    out->pixel = stage_pixel(pass, x, y);
    out->distance = minmax_distance(pass, depth.z);
    return !pass_hidden(pass, depth, stage_key(&stage->opaque.depth, out->pixel)) &&
           !fragment_masked(pass, setup, visit->primitive, x, y);
}

static void widen(MinMax *minmax, const MinMaxFragment *fragment)
{
    const float source[4] = {op_neg(fragment->distance), fragment->distance};
    blend_max(FORMAT_RG32F, source, minmax_pixel(&minmax->current, fragment->pixel));
}

/* Of several at one depth the one that the depth function would keep. */
static void note_primitive(const StageVisit *visit, const Image *ids, size_t pixel)
{
    uint32_t *id = minmax_pixel(ids, pixel);
    if (*id == PRIMITIVE_NONE || visit->stage->pass->desc->depth_func == DEPTH_LEQUAL)
        *id = visit->primitive->id;
}

bool minmax_visible(const StageVisit *visit, const Setup *setup, int x, int y, MinMaxFragment *out)
{
    MinMax *minmax = minmax_of(visit->stage);
    if (!is_visible(visit, setup, x, y, out))
        return false;
    out->side = minmax_side(minmax_pixel(&minmax->previous, out->pixel), out->distance);
    if (out->side == MINMAX_BETWEEN)
        widen(minmax, out);
    else if (out->side != MINMAX_PEELED)
        note_primitive(visit, out->side == MINMAX_FRONT ? &minmax->front_id : &minmax->back_id,
                       out->pixel);
    return true;
}

/* ---- the first pass, and what a pass limit left ---- */

static void visit_first(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    MinMaxFragment fragment;
    if (!is_visible(visit, setup, x, y, &fragment))
        return;
    visit->stage->fragments[fragment.pixel]++;
    widen(minmax_of(visit->stage), &fragment);
}

static void first_tile(Stage *stage, uint32_t tile)
{
    StageVisit visit = {.stage = stage, .list = &stage->pass->geometry.transparent};
    stage_draw(&stage->pass->transparent_bins, tile, visit_first, &visit);
}

static void visit_remaining(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    Stage *stage = visit->stage;
    MinMaxFragment fragment;
    if (is_visible(visit, setup, x, y, &fragment) &&
        minmax_side(minmax_pixel(&minmax_of(stage)->current, fragment.pixel), fragment.distance) !=
            MINMAX_PEELED)
        stage->remaining[fragment.pixel]++;
}

static void remaining_tile(Stage *stage, uint32_t tile)
{
    const Pass *pass = stage->pass;
    StageVisit visit = {.stage = stage, .list = &pass->geometry.transparent};
    stage_draw(&pass->transparent_bins, tile, visit_remaining, &visit);
    PixelRect rect = pass_tile_rect(pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            size_t pixel = stage_pixel(pass, x, y);
            pass_count_remaining(&stage->tile_counts[tile], stage->remaining[pixel],
                                 minmax_of(stage)->method->transmittance(stage, pixel));
        }
}

/* ---- the peels ---- */

void minmax_clear_zero(Image *image)
{
    memset(image->pixels, 0,
           (size_t)image->width * (size_t)image->height * format_pixel_bytes(image->format));
}

void minmax_clear_accum(Image *image)
{
    for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++)
        blend_clear(image->format, minmax_pixel(image, i));
}

static void clear_ids(Image *image)
{
    memset(image->pixels, 0xff, (size_t)image->width * (size_t)image->height * sizeof(uint32_t));
}

static void clear_limits(Image *image)
{
    float *limits = image->pixels;
    for (size_t i = 0; i < 2 * (size_t)image->width * (size_t)image->height; i++)
        limits[i] = NO_LAYER;
}

/* How many layers the next peel takes: one of a pixel whose nearest is the farthest, else two. */
static uint64_t count_layers(const Image *image)
{
    uint64_t layers = 0;
    const float *limits = image->pixels;
    for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++, limits += 2)
        if (limits[1] != NO_LAYER)
            layers += -limits[0] == limits[1] ? 1 : 2;
    return layers;
}

static Result put_named(const Stage *stage, const char *step_name, int step, const char *what,
                        const Image *image)
{
    char name[48];
    snprintf(name, sizeof name, "%s.%s.%s", method_info(stage->pass->desc->method)->name, step_name,
             what);
    return trace_put(stage->trace, name, step, image->format, image->width, image->height,
                     image->pixels);
}

Result minmax_put(const Stage *stage, const char *what, const Image *image)
{
    char number[16];
    int peel = minmax_of(stage)->peel;
    snprintf(number, sizeof number, "%d", peel);
    return put_named(stage, number, peel + 1, what, image);
}

/* The front layers are the first; which number a back layer has is known at the end. */
static Result keep_ids(Stage *stage)
{
    MinMax *minmax = minmax_of(stage);
    if (!stage->trace)
        return RESULT_OK;
    Result result = memory_grow((void **)&minmax->backs, &minmax->back_capacity,
                                minmax->back_count + 1, sizeof *minmax->backs);
    if (result != RESULT_OK)
        return result;
    Image *copy = &minmax->backs[minmax->back_count];
    result =
        image_create(minmax->back_id.width, minmax->back_id.height, minmax->back_id.format, copy);
    if (result != RESULT_OK)
        return result;
    minmax->back_count++;
    memcpy(copy->pixels, minmax->back_id.pixels,
           (size_t)copy->width * (size_t)copy->height * sizeof(uint32_t));
    return stage_put(stage, minmax->peel, "primitive", &minmax->front_id);
}

static Result put_back_ids(const Stage *stage)
{
    const MinMax *minmax = minmax_of(stage);
    Result result = RESULT_OK;
    int peels = (int)minmax->back_count;
    for (int i = 0; i < peels && result == RESULT_OK; i++) {
        const Image *ids = &minmax->backs[peels - 1 - i];
        char name[48];
        snprintf(name, sizeof name, "peel.%d.primitive", peels + i);
        result =
            trace_put(stage->trace, name, peels, ids->format, ids->width, ids->height, ids->pixels);
    }
    return result;
}

static Result run_peel(Stage *stage)
{
    MinMax *minmax = minmax_of(stage);
    const MinMaxMethod *method = minmax->method;
    image_swap(&minmax->current, &minmax->previous);
    clear_limits(&minmax->current);
    clear_ids(&minmax->front_id);
    clear_ids(&minmax->back_id);
    method->clear(stage);
    Result result = stage_run(stage, method->geometry);
    if (result == RESULT_OK)
        result = minmax_put(stage, "depth", &minmax->current);
    if (result == RESULT_OK)
        result = method->blend(stage);
    return result == RESULT_OK ? keep_ids(stage) : result;
}

Result minmax_peels(Stage *stage)
{
    MinMax *minmax = minmax_of(stage);
    Frame *frame = stage->frame;
    int limit = render_desc_pass_limit(stage->pass->desc);
    clear_limits(&minmax->current);
    Result result = stage_run(stage, first_tile);
    if (result == RESULT_OK)
        result = put_named(stage, "first", 0, "depth", &minmax->current);
    uint64_t layers = count_layers(&minmax->current);
    for (int peel = 0; peel < limit && layers > 0 && result == RESULT_OK; peel++) {
        minmax->peel = peel;
        stage->counts.peeled += layers;
        result = run_peel(stage);
        layers = count_layers(&minmax->current);
        frame->peels = peel + 1;
    }
    frame->geometry_passes = 1 + frame->peels;
    if (result == RESULT_OK && layers > 0)
        result = stage_run(stage, remaining_tile);
    return result == RESULT_OK ? put_back_ids(stage) : result;
}

/* ---- composition ---- */

static void compose_tile(Stage *stage, uint32_t tile)
{
    const Image *back = &minmax_of(stage)->back;
    PixelRect rect = pass_tile_rect(stage->pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            size_t pixel = stage_pixel(stage->pass, x, y);
            float source[4];
            format_fetch(back->format, minmax_pixel(back, pixel), source);
            source[3] = op_sub(1.0f, source[3]);
            stage_blend(stage, blend_under, "under", "accum", PRIMITIVE_NONE, source, &stage->accum,
                        pixel);
        }
}

Result minmax_compose(Stage *stage)
{
    return stage_run(stage, compose_tile);
}

/* ---- memory ---- */

uint64_t minmax_bytes(const Pass *pass)
{
    return (uint64_t)pass->view.width * (uint64_t)pass->view.height *
           (2 * format_pixel_bytes(FORMAT_RG32F) + format_pixel_bytes(pass->desc->accum) +
            2 * format_pixel_bytes(FORMAT_R32UI));
}

Result minmax_create(const Pass *pass, const MinMaxMethod *method, MinMax *out)
{
    int width = pass->view.width, height = pass->view.height;
    *out = (MinMax){.method = method};
    Result result = image_create(width, height, FORMAT_RG32F, &out->previous);
    if (result == RESULT_OK)
        result = image_create(width, height, FORMAT_RG32F, &out->current);
    if (result == RESULT_OK)
        result = image_create(width, height, pass->desc->accum, &out->back);
    if (result == RESULT_OK)
        result = image_create(width, height, FORMAT_R32UI, &out->front_id);
    if (result == RESULT_OK)
        result = image_create(width, height, FORMAT_R32UI, &out->back_id);
    if (result == RESULT_OK)
        minmax_clear_accum(&out->back);
    return result;
}

void minmax_free(MinMax *minmax)
{
    image_free(&minmax->previous);
    image_free(&minmax->current);
    image_free(&minmax->back);
    image_free(&minmax->front_id);
    image_free(&minmax->back_id);
    for (size_t i = 0; i < minmax->back_count; i++)
        image_free(&minmax->backs[i]);
    free(minmax->backs);
}

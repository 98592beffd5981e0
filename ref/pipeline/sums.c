#include "ref/pipeline/sums.h"

#include "number/blend.h"
#include <stdio.h>

typedef struct Sums {
    const SumsMethod *method;
    Image sum, second; /* second has no pixels where the method has none */
} Sums;

/* ---- geometry pass ---- */

static void add(const Stage *stage, size_t pixel, const ShadedFragment *fragment)
{
    const Sums *sums = stage->method;
    float sum[4], second[4] = {0};
    sums->method->write(stage->pass->desc, fragment, sum, second);
    stage_blend(stage, blend_add, "add", "sum", fragment->primitive, sum, &sums->sum, pixel);
    if (sums->second.pixels)
        stage_blend(stage, sums->method->blend, sums->method->equation, sums->method->second,
                    fragment->primitive, second, &sums->second, pixel);
}

static void visit_fragment(void *context, const Setup *setup, int x, int y)
{
    ShadedFragment fragment;
    if (shaded_fragment(context, setup, x, y, &fragment))
        add(((const ShadedVisit *)context)->draw.stage, fragment.pixel, &fragment);
}

static void geometry_tile(Stage *stage, uint32_t tile)
{
    ShadedVisit visit = shaded_visit(stage, tile);
    stage_draw(&stage->pass->transparent_bins, tile, visit_fragment, &visit.draw);
}

static Result trace_sums(const Stage *stage)
{
    const Sums *sums = stage->method;
    const Image *images[] = {&sums->sum, &sums->second};
    const char *what[] = {"sum", sums->method->second};
    Result result = RESULT_OK;
    for (int i = 0; i < 2 && images[i]->pixels && result == RESULT_OK; i++) {
        char name[48];
        snprintf(name, sizeof name, "%s.%s", sums->method->name, what[i]);
        result = trace_put(stage->trace, name, 1, images[i]->format, images[i]->width,
                           images[i]->height, images[i]->pixels);
    }
    return result;
}

/* ---- the pass over the pixels ---- */

static void combine_tile(Stage *stage, uint32_t tile)
{
    const Sums *sums = stage->method;
    PixelRect rect = pass_tile_rect(stage->pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            int column = stage_column(stage->pass, x), row = stage_row(stage->pass, y);
            const void *stored = image_pixel(&sums->sum, column, row);
            float sum[4], source[4], second = 0.0f;
            stage->tile_counts[tile].overflowed += format_overflowed(sums->sum.format, stored);
            format_fetch(sums->sum.format, stored, sum);
            if (sums->second.pixels)
                second = *(const float *)image_pixel(&sums->second, column, row);
            if (sums->method->combine(sum, second, source))
                stage_blend(stage, blend_under, "under", "accum", PRIMITIVE_NONE, source,
                            &stage->accum, stage_pixel(stage->pass, x, y));
        }
}

/* ---- the frame ---- */

static Result allocate(const Pass *pass, Sums *sums)
{
    int width = pass->view.width, height = pass->view.height;
    Result result = image_create(width, height, sums->sum.format, &sums->sum);
    if (result == RESULT_OK && *sums->method->second)
        result = image_create(width, height, FORMAT_R32F, &sums->second);
    if (result == RESULT_OK && sums->second.pixels)
        for (size_t i = 0; i < (size_t)width * (size_t)height; i++)
            ((float *)sums->second.pixels)[i] = sums->method->start;
    return result;
}

static Result run(Stage *stage)
{
    Result result = stage_opaque(stage);
    if (result == RESULT_OK)
        result = stage_run(stage, geometry_tile);
    if (result != RESULT_OK)
        return result;
    shaded_count(stage);
    result = trace_sums(stage);
    if (result == RESULT_OK)
        result = stage_run(stage, combine_tile);
    return result == RESULT_OK ? stage_finish(stage) : result;
}

Result sums_render(Pass *pass, TraceSink *trace, Frame *frame, const SumsMethod *method)
{
    Sums sums = {method, .sum = {.format = render_desc_sum_format(pass->desc)}};
    uint64_t pixel_bytes = format_pixel_bytes(sums.sum.format) +
                           (*method->second ? format_pixel_bytes(FORMAT_R32F) : 0);
    Stage stage;
    Result result = stage_create(
        pass, trace, frame, &sums,
        pixel_bytes * (uint64_t)pass->view.width * (uint64_t)pass->view.height, &stage);
    if (result != RESULT_OK)
        return result;
    result = allocate(pass, &sums);
    if (result == RESULT_OK)
        result = run(&stage);
    image_free(&sums.sum);
    image_free(&sums.second);
    stage_free(&stage);
    return result;
}

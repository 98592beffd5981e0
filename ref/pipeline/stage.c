#include "ref/pipeline/stage.h"

#include "base/memory.h"
#include "number/blend.h"
#include "number/op.h"
#include "ref/pipeline/shade.h"

#include <stdio.h>
#include <stdlib.h>

/* ---- geometry ---- */

/* Forward: the lit, premultiplied colour takes the place of the surface's own. */
static void light_texel(const StageVisit *visit, size_t pixel, uint32_t primitive, Texel *texel)
{
    const Stage *stage = visit->stage;
    ShadeForm form = pass_shade_form(stage->pass, visit->target != &stage->opaque);
    float color[4] = {0.0f, 0.0f, 0.0f, texel->diffuse[3]};
    stage_shade(stage, pixel, primitive, &form, texel, color);
    memcpy(texel->diffuse, color, sizeof color);
}

void stage_shade_winners(const StageVisit *visit, uint32_t tile)
{
    const Pass *pass = visit->stage->pass;
    PixelRect rect = pass_tile_rect(pass, tile);
    const uint32_t *ids = visit->target->primitive.pixels;
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            size_t pixel = stage_pixel(pass, x, y);
            if (ids[pixel] == PRIMITIVE_NONE)
                continue;
            const Primitive *primitive = &visit->list->items[visit->stage->winner[pixel]];
            Setup setup;
            Texel texel;
            pass_setup(pass, primitive, &setup);
            fragment_shade(pass, &setup, primitive, x, y, &texel);
            if (visit->stage->forward)
                light_texel(visit, pixel, primitive->id, &texel);
            gbuffer_store(visit->target, stage_column(pass, x), stage_row(pass, y), &texel);
        }
}

static void visit_opaque(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    stage_keep(visit, setup, x, y, pass_fragment_depth(visit->stage->pass, setup, x, y));
}

static void opaque_tile(Stage *stage, uint32_t tile)
{
    StageVisit visit = {
        .stage = stage, .target = &stage->opaque, .list = &stage->pass->geometry.opaque};
    stage_draw(&stage->pass->opaque_bins, tile, visit_opaque, &visit);
    stage_shade_winners(&visit, tile);
}

Result stage_opaque(Stage *stage)
{
    Result result = stage_run(stage, opaque_tile);
    return result == RESULT_OK ? stage_put_gbuffer(stage, -1, &stage->opaque) : result;
}

/* ---- lighting ---- */

/* Whether the neighbour of a fragment with this normal and position, in the same layer, is so
 * different that there is an edge between them: POST_EDGES. */
static bool differs_from(const Stage *stage, int x, int y, const Texel *texel)
{
    const Pass *pass = stage->pass;
    const GBuffer *source = stage->lit;
    Texel other;
    int column = stage_column(pass, x), row = stage_row(pass, y);
    if (column < 0 || row < 0 || column >= pass->view.width || row >= pass->view.height)
        return false;
    gbuffer_load(source, column, row, &other);
    if (other.material[3] == 0.0f)
        return true;
    fragment_decode(pass, stage_key(&source->depth, stage_pixel(pass, x, y)), x, y, &other);
    float z = op_neg(texel->position[2]);
    return op_dot3(texel->normal, other.normal) < SHADING_EDGE_DOT ||
           op_abs(op_add(z, other.position[2])) > op_mul(SHADING_EDGE_DEPTH, z);
}

static bool is_edge(const Stage *stage, int x, int y, const Texel *texel)
{
    return differs_from(stage, x - 1, y, texel) || differs_from(stage, x + 1, y, texel) ||
           differs_from(stage, x, y - 1, texel) || differs_from(stage, x, y + 1, texel);
}

/* The colour that pixel (x, y) blends, and the surface it is of; false where it is discarded. */
static inline bool light_pixel(const Stage *stage, const ShadeForm *form, int x, int y,
                               const float material[4], Texel *texel, float color[4])
{
    const Pass *pass = stage->pass;
    gbuffer_load(stage->lit, stage_column(pass, x), stage_row(pass, y), texel);
    if (stage->lit->material.format == FORMAT_NONE)
        memcpy(texel->material, material, 4 * sizeof *material);
    if (stage->forward) {
        memcpy(color, texel->diffuse, 4 * sizeof *color);
        return color[3] > stage->alpha_test;
    }
    size_t pixel = stage_pixel(pass, x, y);
    fragment_decode(pass, stage_key(&stage->lit->depth, pixel), x, y, texel);
    return stage_shade(stage, pixel, ((const uint32_t *)stage->lit->primitive.pixels)[pixel], form,
                       texel, color);
}

static inline void blend_pixel(const Stage *stage, bool transparent, size_t pixel,
                               const float color[4])
{
    const Pass *pass = stage->pass;
    const Image *accum = &stage->accum;
    uint32_t primitive = ((const uint32_t *)stage->lit->primitive.pixels)[pixel];
    if (pass->desc->mutations)
        mutate_blend(pass, transparent, color,
                     (char *)accum->pixels + pixel * format_pixel_bytes(accum->format));
    else if (!transparent && pass->desc->opaque_blend == OPAQUE_BLEND_SEED)
        stage_blend(stage, blend_opaque_seed, "opaque_seed", "accum", primitive, color, accum,
                    pixel);
    else
        stage_blend(stage, blend_under, "under", "accum", primitive, color, accum, pixel);
}

static inline void light_tile(Stage *stage, uint32_t tile, bool transparent)
{
    const Pass *pass = stage->pass;
    bool edges = render_desc_edges(pass->desc);
    ShadeForm form = pass_shade_form(pass, transparent);
    PixelRect rect = pass_tile_rect(pass, tile);
    float material[4]; /* where it is not stored */
    needs_material(&pass->needs, pass->desc, transparent, material);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            Texel texel;
            float color[4];
            if (!light_pixel(stage, &form, x, y, material, &texel, color))
                continue;
            stage->tile_counts[tile].shaded++;
            if (edges && is_edge(stage, x, y, &texel))
                color[0] = color[1] = color[2] = 0.0f;
            details_put_color(&stage->details, stage_pixel(pass, x, y), color);
            blend_pixel(stage, transparent, stage_pixel(pass, x, y), color);
        }
}

static void light_transparent_tile(Stage *stage, uint32_t tile)
{
    light_tile(stage, tile, true);
}

static void light_opaque_tile(Stage *stage, uint32_t tile)
{
    light_tile(stage, tile, false);
}

Result stage_light(Stage *stage, const GBuffer *source, bool transparent)
{
    stage->lit = source;
    details_clear_source(&stage->details);
    return stage_run(stage, transparent ? light_transparent_tile : light_opaque_tile);
}

/* ---- resolve ---- */

static void resolve_pixel(Stage *stage, int x, int row)
{
    const Pass *pass = stage->pass;
    const Image *diffuse = &stage->opaque.diffuse;
    float accum[4], opaque[4] = {0};
    format_fetch(stage->accum.format, image_pixel(&stage->accum, x, row), accum);
    if (diffuse->pixels)
        format_fetch(diffuse->format, image_pixel(diffuse, x, row), opaque);
    float *final = image_pixel(&stage->frame->final, x, row);
    uint8_t *display = image_pixel(&stage->frame->display, x, row);
    float weight = pass_background_weight(pass, accum[3], opaque[3]);
    if (pass->desc->mutations) {
        mutate_resolve(pass, accum, weight, final, display);
        return;
    }
    shade_final(&pass->view, accum, weight, final);
    shade_display(pass->fused, final, display);
}

static void resolve_tile(Stage *stage, uint32_t tile)
{
    PixelRect rect = pass_tile_rect(stage->pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            resolve_pixel(stage, stage_column(stage->pass, x), stage_row(stage->pass, y));
            pass_count_fragments(&stage->tile_counts[tile],
                                 stage->fragments[stage_pixel(stage->pass, x, y)]);
        }
}

Result stage_resolve(Stage *stage)
{
    int step = stage->frame->peels + 1;
    const Image *accum = &stage->accum, *display = &stage->frame->display;
    Result result = trace_put(stage->trace, "accum", step, accum->format, accum->width,
                              accum->height, accum->pixels);
    if (result == RESULT_OK)
        result = stage_run(stage, resolve_tile);
    if (result == RESULT_OK)
        result = trace_put(stage->trace, "display", step + 1, display->format, display->width,
                           display->height, display->pixels);
    PassCounts sum = stage->counts;
    for (uint32_t tile = 0; tile < stage->pass->tile_count; tile++)
        pass_counts_add(&sum, &stage->tile_counts[tile]);
    /* A mistaken peel's counts do not add up. */
    if (stage->pass->desc->mutations) {
        sum.peeled = sum.fragments + sum.repeated;
        sum.remaining = 0;
    }
    pass_counts_report(&sum, stage->frame);
    return result;
}

Result stage_finish(Stage *stage)
{
    Result result = RESULT_OK;
    if (needs_has(&stage->pass->needs, NEED_OPAQUE))
        result = stage_light(stage, &stage->opaque, false);
    if (result == RESULT_OK)
        result = stage_put_source(stage, -1);
    return result == RESULT_OK ? stage_resolve(stage) : result;
}

Result stage_opaque_only(Pass *pass, Frame *frame)
{
    Stage stage;
    Result result = stage_create(pass, NULL, frame, NULL, 0, &stage);
    if (result != RESULT_OK)
        return result;
    result = stage_opaque(&stage);
    if (result == RESULT_OK)
        result = stage_finish(&stage);
    frame->geometry_passes = pass_geometry_passes(pass, 0);
    stage_free(&stage);
    return result;
}

/* ---- running and tracing ---- */

static Result tile_task(void *context, uint32_t tile, int worker)
{
    Stage *stage = context;
    (void)worker;
    uint32_t saved = op_enter();
    stage->function(stage, tile);
    op_leave(saved);
    return RESULT_OK;
}

Result stage_run(Stage *stage, StageTile function)
{
    stage->function = function;
    return pool_run(stage->pass->pool, stage->pass->tile_count, tile_task, stage);
}

Result stage_put(const Stage *stage, int peel, const char *what, const Image *image)
{
    if (peel >= 0)
        return trace_put_peel(stage->trace, peel, what, image->format, image->width, image->height,
                              image->pixels);
    char name[48];
    snprintf(name, sizeof name, "opaque.%s", what);
    return trace_put(stage->trace, name, 0, image->format, image->width, image->height,
                     image->pixels);
}

Result stage_put_gbuffer(const Stage *stage, int peel, const GBuffer *buffers)
{
    const struct {
        const char *what;
        const Image *image;
    } rows[] = {
        {"depth", &buffers->depth},       {"normal", &buffers->normal},
        {"position", &buffers->position}, {stage->forward ? "color" : "diffuse", &buffers->diffuse},
        {"material", &buffers->material}, {"primitive", &buffers->primitive},
    };
    Result result = RESULT_OK;
    for (size_t i = 0; result == RESULT_OK && i < sizeof rows / sizeof rows[0]; i++)
        if (rows[i].image->format != FORMAT_NONE)
            result = stage_put(stage, peel, rows[i].what, rows[i].image);
    return result;
}

Result stage_put_source(const Stage *stage, int peel)
{
    const Image *source = &stage->details.source;
    return source->pixels ? stage_put(stage, peel, "source", source) : RESULT_OK;
}

void stage_count_drawn(const GBuffer *layer, const Image *previous_depth, uint64_t *drawn,
                       uint64_t *repeated)
{
    const Image *primitive = &layer->primitive;
    *drawn = *repeated = 0;
    for (size_t i = 0; i < (size_t)primitive->width * (size_t)primitive->height; i++) {
        if (((const uint32_t *)primitive->pixels)[i] == PRIMITIVE_NONE)
            continue;
        ++*drawn;
        *repeated += previous_depth && stage_key(&layer->depth, i) == stage_key(previous_depth, i);
    }
}

void stage_count_remaining(Stage *stage, uint32_t tile)
{
    const Pass *pass = stage->pass;
    PixelRect rect = pass_tile_rect(pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            float accum[4];
            format_fetch(stage->accum.format,
                         image_pixel(&stage->accum, stage_column(pass, x), stage_row(pass, y)),
                         accum);
            pass_count_remaining(&stage->tile_counts[tile],
                                 stage->remaining[stage_pixel(pass, x, y)], accum[3]);
        }
}

/* ---- memory ---- */

uint64_t stage_gbuffer_bytes(const Pass *pass, bool transparent)
{
    const GBufferLayout *layout = &pass->stored[transparent];
    uint64_t pixel = format_pixel_bytes(layout->normal) + format_pixel_bytes(layout->position) +
                     format_pixel_bytes(layout->diffuse) + format_pixel_bytes(layout->material) +
                     format_pixel_bytes(pass->depth_format) + format_pixel_bytes(FORMAT_R32UI);
    return pixel * (uint64_t)pass->view.width * (uint64_t)pass->view.height;
}

void stage_clear_accum(Stage *stage)
{
    static const float nothing[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    Image *accum = &stage->accum;
    bool zero = mutate_has(stage->pass, MUTATION_DESTINATION_ALPHA_ZERO);
    for (int y = 0; y < accum->height; y++)
        for (int x = 0; x < accum->width; x++)
            if (zero)
                format_store(accum->format, nothing, image_pixel(accum, x, y));
            else
                blend_clear(accum->format, image_pixel(accum, x, y));
}

static Result allocate(Stage *stage)
{
    const Pass *pass = stage->pass;
    const RenderDesc *desc = pass->desc;
    size_t pixels = (size_t)desc->width * (size_t)desc->height;
    Result result = gbuffer_create(desc, &pass->stored[0], &stage->opaque);
    if (result == RESULT_OK)
        result = image_create(desc->width, desc->height, desc->accum, &stage->accum);
    if (result != RESULT_OK)
        return result;
    if (stage->trace && stage->trace->details)
        result = details_create(desc, &stage->details);
    if (result != RESULT_OK)
        return result;
    mutate_clear(pass, &stage->opaque);
    stage_clear_accum(stage);
    stage->fragments = memory_array(pixels, sizeof *stage->fragments);
    stage->remaining = memory_array(pixels, sizeof *stage->remaining);
    stage->winner = memory_array(pixels, sizeof *stage->winner);
    stage->tile_counts = memory_array(pass->tile_count, sizeof *stage->tile_counts);
    return stage->fragments && stage->remaining && stage->winner && stage->tile_counts
               ? RESULT_OK
               : RESULT_NO_MEMORY;
}

Result stage_create(Pass *pass, TraceSink *trace, Frame *frame, void *method, uint64_t bytes,
                    Stage *out)
{
    uint64_t pixels = (uint64_t)pass->view.width * (uint64_t)pass->view.height;
    uint64_t own = stage_gbuffer_bytes(pass, false) +
                   pixels * (format_pixel_bytes(pass->desc->accum) + 3 * sizeof(uint32_t));
    if (trace && trace->details)
        own += pixels * details_pixel_bytes();
    *out = (Stage){.pass = pass,
                   .trace = trace,
                   .frame = frame,
                   .method = method,
                   .forward = pass->desc->method == METHOD_FORWARD,
                   .alpha_test = mutate_alpha_test(pass)};
    Result result = pass_reserve(pass, own + bytes);
    if (result == RESULT_OK)
        result = allocate(out);
    if (result != RESULT_OK)
        stage_free(out);
    return result;
}

void stage_free(Stage *stage)
{
    gbuffer_free(&stage->opaque);
    image_free(&stage->accum);
    details_free(&stage->details);
    free(stage->fragments);
    free(stage->remaining);
    free(stage->winner);
    free(stage->tile_counts);
    *stage = (Stage){0};
}

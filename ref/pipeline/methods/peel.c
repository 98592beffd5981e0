/* Deferred depth peeling, the definition path: scalar, pass by pass over whole buffers, traced.
 *
 * This work is based on: Luigi Rapetta, "OpenGL 4.6 Deferred Renderer with Deferred Depth
 * Peeling"; Cass Everitt, "Interactive Order-Independent Transparency", NVIDIA, 2001.
 *
 * Opaque geometry pass; then peels, each a geometry pass that keeps the nearest fragment behind
 * the previous peel and in front of the opaque depth, and a lighting pass blended under; then the
 * opaque lighting pass, blended under; then the background. Two depth buffers take turns; the
 * color buffers of the peels are shared. A pass is a task per tile: pixels do not depend on each
 * other, so neither the order of tiles nor the number of threads changes a bit. */
#include "ref/pipeline/methods/peel.h"

#include "base/memory.h"
#include "number/blend.h"
#include "number/op.h"
#include "ref/pipeline/fragment.h"
#include "ref/pipeline/pass.h"
#include "ref/pipeline/shade.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct Peel Peel;
typedef void (*TileFunction)(Peel *state, uint32_t tile);

struct Peel {
    const Pass *pass;
    GBuffer opaque, layer; /* layer.depth is the current peel's */
    Image previous_depth;  /* the other of the two depth buffers */
    Image accum;
    uint32_t *fragments;     /* per pixel: transparent fragments in front of the opaque depth */
    uint32_t *remaining;     /* of those, behind the last peel */
    uint32_t *winner;        /* per pixel with a fragment in the current pass: index in its list */
    PassCounts counts;       /* of the frame: peels */
    PassCounts *tile_counts; /* the rest */
    int peel;                /* −1 during the opaque pass */
    Frame *frame;
    TileFunction function; /* of the pass that runs */
};

/* ---- geometry pass ---- */

typedef struct TileVisit {
    Peel *state;
    GBuffer *target;
    const PrimitiveList *list;
    const Primitive *primitive;
} TileVisit;

static size_t pixel_index(const Pass *pass, int x, int y)
{
    return (size_t)(pass->view.height - 1 - y) * (size_t)pass->view.width + (size_t)x;
}

static uint32_t key_at(const Image *depth, size_t pixel)
{
    return ((const uint32_t *)depth->pixels)[pixel];
}

static void visit_fragment(void *context, const Setup *setup, int x, int y)
{
    TileVisit *visit = context;
    Peel *state = visit->state;
    const Pass *pass = state->pass;
    size_t pixel = pixel_index(pass, x, y);
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    if (state->peel >= 0) {
        if (pass_hidden(pass, depth, key_at(&state->opaque.depth, pixel)))
            return;
        if (state->peel == 0)
            state->fragments[pixel]++;
        else if (pass_peeled(pass, depth, key_at(&state->previous_depth, pixel)))
            return;
    }
    uint32_t *stored = (uint32_t *)visit->target->depth.pixels + pixel;
    if (!pass_depth_test(pass, depth.key, *stored) ||
        fragment_masked(pass, setup, visit->primitive, x, y))
        return;
    *stored = depth.key;
    ((uint32_t *)visit->target->primitive.pixels)[pixel] = visit->primitive->id;
    state->winner[pixel] = (uint32_t)(visit->primitive - visit->list->items);
}

/* Runs the fragment shader for the fragments that the depth test left: the others' writes would
 * have been overwritten, and many layers drawn back to front would shade each many times. */
static void shade_winners(const TileVisit *visit, uint32_t tile)
{
    const Pass *pass = visit->state->pass;
    PixelRect rect = pass_tile_rect(pass, tile);
    const uint32_t *ids = visit->target->primitive.pixels;
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            size_t pixel = pixel_index(pass, x, y);
            if (ids[pixel] == PRIMITIVE_NONE)
                continue;
            const Primitive *primitive = &visit->list->items[visit->state->winner[pixel]];
            Setup setup;
            Texel texel;
            pass_setup(pass, primitive, &setup);
            fragment_shade(pass, &setup, primitive, x, y, &texel);
            gbuffer_store(visit->target, x, pass->view.height - 1 - y, &texel);
        }
}

static void draw_tile(const Bins *bins, uint32_t tile, SetupVisit function, TileVisit *visit)
{
    const Pass *pass = visit->state->pass;
    PixelRect rect = pass_tile_rect(pass, tile);
    for (size_t i = bins->first[tile]; i < bins->first[tile + 1]; i++) {
        Setup setup;
        visit->primitive = &visit->list->items[bins->item[i]];
        pass_setup(pass, visit->primitive, &setup);
        setup_visit(&setup, rect, function, visit);
    }
}

static void geometry_tile(Peel *state, uint32_t tile)
{
    const Pass *pass = state->pass;
    bool opaque = state->peel < 0;
    TileVisit visit = {
        .state = state,
        .target = opaque ? &state->opaque : &state->layer,
        .list = opaque ? &pass->geometry.opaque : &pass->geometry.transparent,
    };
    draw_tile(opaque ? &pass->opaque_bins : &pass->transparent_bins, tile, visit_fragment, &visit);
    shade_winners(&visit, tile);
}

/* ---- lighting pass ---- */

static void lighting_tile(Peel *state, uint32_t tile)
{
    const Pass *pass = state->pass;
    bool opaque = state->peel < 0;
    const GBuffer *source = opaque ? &state->opaque : &state->layer;
    bool seed = opaque && pass->desc->opaque_blend == OPAQUE_BLEND_SEED;
    ShadeForm form = pass_shade_form(pass, !opaque);
    PixelRect rect = pass_tile_rect(pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            int row = pass->view.height - 1 - y;
            Texel texel;
            float color[4];
            gbuffer_load(source, x, row, &texel);
            fragment_decode(pass, key_at(&source->depth, pixel_index(pass, x, y)), x, y, &texel);
            if (!shade_pixel(&pass->view, &form, &texel, color))
                continue;
            void *pixel = image_pixel(&state->accum, x, row);
            if (seed)
                blend_opaque_seed(state->accum.format, color, pixel);
            else
                blend_under(state->accum.format, color, pixel);
        }
}

/* ---- what a pass limit left behind ---- */

static void visit_remaining(void *context, const Setup *setup, int x, int y)
{
    TileVisit *visit = context;
    Peel *state = visit->state;
    const Pass *pass = state->pass;
    size_t pixel = pixel_index(pass, x, y);
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    uint32_t previous = key_at(&state->previous_depth, pixel);
    if (!pass_hidden(pass, depth, key_at(&state->opaque.depth, pixel)) &&
        pass_remains(pass, depth, previous))
        state->remaining[pixel]++;
}

static void remaining_tile(Peel *state, uint32_t tile)
{
    const Pass *pass = state->pass;
    TileVisit visit = {.state = state, .list = &pass->geometry.transparent};
    draw_tile(&pass->transparent_bins, tile, visit_remaining, &visit);
    PixelRect rect = pass_tile_rect(pass, tile);
    PassCounts *counts = &state->tile_counts[tile];
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            float accum[4];
            format_fetch(state->accum.format,
                         image_pixel(&state->accum, x, pass->view.height - 1 - y), accum);
            pass_count_remaining(counts, state->remaining[pixel_index(pass, x, y)], accum[3]);
        }
}

/* ---- resolve ---- */

static void resolve_pixel(Peel *state, int x, int row)
{
    const Pass *pass = state->pass;
    float accum[4], opaque[4];
    format_fetch(state->accum.format, image_pixel(&state->accum, x, row), accum);
    format_fetch(state->opaque.diffuse.format, image_pixel(&state->opaque.diffuse, x, row), opaque);
    float *final = image_pixel(&state->frame->final, x, row);
    shade_final(&pass->view, accum, pass_background_weight(pass, accum, opaque[3]), final);
    shade_display(pass->fused, final, image_pixel(&state->frame->display, x, row));
}

static void resolve_tile(Peel *state, uint32_t tile)
{
    PixelRect rect = pass_tile_rect(state->pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            resolve_pixel(state, x, state->pass->view.height - 1 - y);
            pass_count_fragments(&state->tile_counts[tile],
                                 state->fragments[pixel_index(state->pass, x, y)]);
        }
}

/* ---- the frame ---- */

static void clear_accum(Image *accum)
{
    for (int y = 0; y < accum->height; y++)
        for (int x = 0; x < accum->width; x++)
            blend_clear(accum->format, image_pixel(accum, x, y));
}

static PassCounts total(const Peel *state)
{
    PassCounts sum = state->counts;
    for (uint32_t tile = 0; tile < state->pass->tile_count; tile++)
        pass_counts_add(&sum, &state->tile_counts[tile]);
    return sum;
}

static Result tile_task(void *context, uint32_t tile, int worker)
{
    Peel *state = context;
    (void)worker;
    uint32_t saved = op_enter();
    state->function(state, tile);
    op_leave(saved);
    return RESULT_OK;
}

/* One pass: the function for every tile, on all threads. */
static Result run(Peel *state, TileFunction function)
{
    state->function = function;
    return pool_run(state->pass->pool, state->pass->tile_count, tile_task, state);
}

/* One buffer under "opaque.<what>" or "peel.K.<what>". */
static Result put(const Peel *state, TraceSink *trace, const char *what, const Image *image)
{
    if (state->peel >= 0)
        return trace_put_peel(trace, state->peel, what, image->format, image->width, image->height,
                              image->pixels);
    char name[48];
    snprintf(name, sizeof name, "opaque.%s", what);
    return trace_put(trace, name, 0, image->format, image->width, image->height, image->pixels);
}

static Result put_gbuffer(const Peel *state, TraceSink *trace, const GBuffer *buffers)
{
    const struct {
        const char *what;
        const Image *image;
    } rows[] = {
        {"depth", &buffers->depth},       {"normal", &buffers->normal},
        {"position", &buffers->position}, {"diffuse", &buffers->diffuse},
        {"material", &buffers->material}, {"primitive", &buffers->primitive},
    };
    Result result = RESULT_OK;
    for (size_t i = 0; result == RESULT_OK && i < sizeof rows / sizeof rows[0]; i++)
        if (rows[i].image->format != FORMAT_NONE)
            result = put(state, trace, rows[i].what, rows[i].image);
    return result;
}

/* Pixels that the current peel drew, and of those at the previous peel's depth again. */
static void count_drawn(const Peel *state, uint64_t *drawn, uint64_t *repeated)
{
    const Image *primitive = &state->layer.primitive;
    *drawn = *repeated = 0;
    for (size_t i = 0; i < (size_t)primitive->width * (size_t)primitive->height; i++) {
        if (((const uint32_t *)primitive->pixels)[i] == PRIMITIVE_NONE)
            continue;
        ++*drawn;
        *repeated +=
            state->peel > 0 && key_at(&state->layer.depth, i) == key_at(&state->previous_depth, i);
    }
}

/* Geometry pass of peel state->peel. *stop: it yielded nothing (auto with the raw test: nothing
 * new), and there is nothing to blend or to count. */
static Result draw_peel(Peel *state, bool *stop)
{
    const RenderDesc *desc = state->pass->desc;
    gbuffer_clear(&state->layer, desc->depth_range);
    Result result = run(state, geometry_tile);
    uint64_t drawn, repeated;
    count_drawn(state, &drawn, &repeated);
    bool stale = desc->passes == 0 && desc->peel_test == PEEL_TEST_RAW && repeated == drawn;
    *stop = drawn == 0 || stale;
    if (!*stop) {
        state->counts.peeled += drawn;
        state->counts.repeated += repeated;
    }
    return result;
}

static Result peels(Peel *state, TraceSink *trace)
{
    int limit = state->pass->desc->passes ? state->pass->desc->passes : PASSES_MAX;
    for (state->peel = 0; state->peel < limit; state->peel++) {
        bool stop;
        Result result = draw_peel(state, &stop);
        if (result != RESULT_OK)
            return result;
        if (stop)
            break;
        result = put_gbuffer(state, trace, &state->layer);
        if (result == RESULT_OK)
            result = run(state, lighting_tile);
        if (result == RESULT_OK)
            result = put(state, trace, "accum", &state->accum);
        if (result != RESULT_OK)
            return result;
        Image current = state->layer.depth;
        state->layer.depth = state->previous_depth;
        state->previous_depth = current;
        state->frame->peels = state->peel + 1;
    }
    return pass_may_leave(state->pass, state->frame->peels, limit) ? run(state, remaining_tile)
                                                                   : RESULT_OK;
}

static Result render(Peel *state, TraceSink *trace)
{
    clear_accum(&state->accum);
    state->peel = -1;
    Result result = run(state, geometry_tile);
    if (result == RESULT_OK)
        result = put_gbuffer(state, trace, &state->opaque);
    if (result == RESULT_OK)
        result = peels(state, trace);
    state->peel = -1;
    if (result == RESULT_OK)
        result = run(state, lighting_tile);
    int step = state->frame->peels + 1;
    const Image *accum = &state->accum, *display = &state->frame->display;
    if (result == RESULT_OK)
        result = trace_put(trace, "accum", step, accum->format, accum->width, accum->height,
                           accum->pixels);
    if (result == RESULT_OK)
        result = run(state, resolve_tile);
    if (result == RESULT_OK)
        result = trace_put(trace, "display", step + 1, display->format, display->width,
                           display->height, display->pixels);
    return result;
}

static Result allocate(Peel *state)
{
    const Pass *pass = state->pass;
    const RenderDesc *desc = pass->desc;
    int width = pass->view.width, height = pass->view.height;
    size_t pixels = (size_t)width * (size_t)height;
    Result result = gbuffer_create(desc, &state->opaque);
    if (result == RESULT_OK)
        result = gbuffer_create(desc, &state->layer);
    if (result == RESULT_OK)
        result = image_create(width, height, pass->depth_format, &state->previous_depth);
    if (result == RESULT_OK)
        result = image_create(width, height, desc->accum, &state->accum);
    state->fragments = memory_array(pixels, sizeof *state->fragments);
    state->remaining = memory_array(pixels, sizeof *state->remaining);
    state->winner = memory_array(pixels, sizeof *state->winner);
    state->tile_counts = memory_array(pass->tile_count, sizeof *state->tile_counts);
    if (result == RESULT_OK &&
        !(state->fragments && state->remaining && state->winner && state->tile_counts))
        result = RESULT_NO_MEMORY;
    return result;
}

static uint64_t buffer_bytes(const Pass *pass)
{
    const GBufferLayout *layout = &pass->layout;
    uint64_t color = format_pixel_bytes(layout->normal) + format_pixel_bytes(layout->position) +
                     format_pixel_bytes(layout->diffuse) + format_pixel_bytes(layout->material);
    uint64_t pixel = 2 * (color + 4 + 4) /* two G-buffers with depth and primitive */
                     + 4 + format_pixel_bytes(pass->desc->accum) + 3 * sizeof(uint32_t);
    return pixel * (uint64_t)pass->view.width * (uint64_t)pass->view.height;
}

Result peel_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    Peel state = {.pass = pass, .frame = frame};
    Result result = pass_reserve(pass, buffer_bytes(pass));
    if (result == RESULT_OK)
        result = allocate(&state);
    if (result == RESULT_OK)
        result = render(&state, trace);
    if (result == RESULT_OK) {
        PassCounts counts = total(&state);
        pass_counts_report(&counts, frame);
    }
    gbuffer_free(&state.opaque);
    gbuffer_free(&state.layer);
    image_free(&state.previous_depth);
    image_free(&state.accum);
    free(state.fragments);
    free(state.remaining);
    free(state.winner);
    free(state.tile_counts);
    return result;
}

#include "ref/pipeline/retrace.h"

#include "base/memory.h"
#include "frame/method.h"
#include "ref/pipeline/fragment.h"
#include "ref/pipeline/pipeline.h"
#include "ref/pipeline/retrace_state.h"
#include "ref/pipeline/stage.h"

#include <stdio.h>
#include <stdlib.h>

/* What the definition path tells while it draws the pixel. */
typedef struct Watch {
    PassWatch watch; /* first */
    const Pass *pass;
    const Frame *frame; /* that is being drawn */
    size_t pixel;       /* the others are not looked at */
    History *history;
    bool opaque_is_next; /* the layers are blended */
    Result result;
} Watch;

/* ---- opening ---- */

/* Peels may repeat a layer for as long as any pixel has a new one. */
static bool needs_frame(const RenderDesc *desc)
{
    return (desc->method == METHOD_PEEL || desc->method == METHOD_FORWARD) && desc->passes == 0 &&
           desc->peel_test == PEEL_TEST_RAW;
}

static Result count_passes(const Scene *scene, RenderDesc *desc)
{
    Frame frame;
    Result result = pipeline_render(scene, desc, NULL, &frame);
    if (result != RESULT_OK)
        return result;
    desc->passes = frame.peels > 0 ? frame.peels : 1;
    frame_free(&frame);
    return RESULT_OK;
}

/* The triangles of a frame in which nothing is culled. */
static Result build_unculled(Retrace *retrace)
{
    const Pass *pass = &retrace->pass;
    View view = pass->view;
    bool culls = false;
    view.draws = memory_array(view.draw_count, sizeof *view.draws);
    if (!view.draws)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < view.draw_count; i++) {
        view.draws[i] = pass->view.draws[i];
        culls = culls || view.draws[i].cull_back;
        view.draws[i].cull_back = false;
    }
    Result result = RESULT_OK;
    if (culls)
        result = geometry_build(pass->scene, &view, pass->fused, pass->pool, &retrace->unculled);
    free(view.draws);
    return result == RESULT_OK
               ? retrace_find_cut(pass, culls ? &retrace->unculled : &pass->geometry, &retrace->all)
               : result;
}

Result retrace_open(const Scene *scene, const RenderDesc *desc, Retrace **out)
{
    *out = NULL;
    if (desc->mutations)
        return result_fail(RESULT_UNSUPPORTED, "a pixel's history: expected no mutations");
    Retrace *retrace = memory_array(1, sizeof *retrace);
    if (!retrace)
        return RESULT_NO_MEMORY;
    retrace->scene = scene;
    retrace->desc = *desc;
    Result result = needs_frame(desc) ? count_passes(scene, &retrace->desc) : RESULT_OK;
    if (result == RESULT_OK)
        result = pass_create(scene, &retrace->desc, true, &retrace->pass);
    if (result == RESULT_OK) {
        retrace->pool = pool_create(1);
        result = retrace->pool ? build_unculled(retrace) : RESULT_NO_MEMORY;
    }
    if (result == RESULT_OK)
        *out = retrace;
    else
        retrace_close(retrace);
    return result;
}

void retrace_close(Retrace *retrace)
{
    if (!retrace)
        return;
    free(retrace->all.cut);
    geometry_free(&retrace->unculled);
    if (retrace->pool)
        pool_destroy(retrace->pool);
    if (retrace->pass.pool)
        pass_free(&retrace->pass);
    free(retrace);
}

/* ---- watching ---- */

/* Of a triangle's pieces the first that was drawn. */
static int fragment_of(const History *history, uint32_t primitive)
{
    for (size_t i = 0; i < history->fragment_count; i++)
        if (history->fragments[i].primitive == primitive && retrace_drawn(&history->fragments[i]))
            return (int)i;
    return HISTORY_NONE;
}

static void copy_term(const ShadeTerm *term, HistoryTerm *out)
{
    *out = (HistoryTerm){
        .n_dot_l = (double)term->n_dot_l,
        .n_dot_h = (double)term->n_dot_h,
        .h_dot_v = (double)term->h_dot_v,
        .distance = (double)term->distance,
        .distribution = (double)term->distribution,
        .geometry = (double)term->geometry,
        .specular = (double)term->specular,
        .attenuation = (double)term->attenuation,
    };
    retrace_copy(out->fresnel, term->fresnel, 3);
    retrace_copy(out->term, term->term, 3);
    retrace_copy(out->sum, term->sum, 3);
}

Result retrace_put_shading(const Pass *pass, History *history, HistorySurface *surface,
                           const ShadeForm *form, const Texel *texel, const float source[4])
{
    retrace_put_surface(texel, surface);
    retrace_copy(surface->source, source, 4);
    surface->lit = true;
    size_t count = pass->view.light_count;
    if (form->model == SHADING_PHONG)
        return RESULT_OK;
    float ambient[3];
    ShadeTerm *terms = memory_array(count, sizeof *terms);
    HistoryTerm *out = terms && count > 0 ? history_add_terms(history, count) : NULL;
    bool room = terms && (out || count == 0);
    if (room) {
        shade_terms(&pass->view, form, texel, terms, ambient);
        for (size_t i = 0; i < count; i++)
            copy_term(&terms[i], &out[i]);
        surface->first_term = history->term_count - count;
        surface->term_count = count;
        retrace_copy(surface->ambient, ambient, 3);
    }
    free(terms);
    return room ? RESULT_OK : RESULT_NO_MEMORY;
}

static void on_shade(PassWatch *base, size_t pixel, uint32_t primitive, const ShadeForm *form,
                     const Texel *texel, const float source[4])
{
    Watch *watch = (Watch *)base;
    if (pixel != watch->pixel || watch->result != RESULT_OK)
        return;
    int index = fragment_of(watch->history, primitive);
    if (index == HISTORY_NONE || watch->history->fragments[index].surface.lit)
        return; /* a repeated layer is lit as it was */
    watch->result =
        retrace_put_shading(watch->pass, watch->history, &watch->history->fragments[index].surface,
                            form, texel, source);
}

/* What a blend of no fragment's puts into the accumulation. */
static const char *composed(const Watch *watch)
{
    size_t before = 0;
    for (size_t i = 0; i < watch->history->step_count; i++)
        before += strcmp(watch->history->steps[i].target, "accum") == 0;
    switch (watch->pass->desc->method) {
    case METHOD_DUAL:
        return "back";
    case METHOD_FORWARD_DUAL:
        return before == 0 ? "front" : "back";
    default:
        return "sum";
    }
}

static void name_step(const Watch *watch, uint32_t primitive, HistoryStep *out)
{
    const History *history = watch->history;
    MethodId method = watch->pass->desc->method;
    bool opaque = out->fragment != HISTORY_NONE && !history->fragments[out->fragment].transparent;
    bool peels =
        method_info(method)->loses_ties || method == METHOD_PEEL_ID || method == METHOD_LINKED_LIST;
    if (opaque)
        snprintf(out->step, sizeof out->step, "opaque");
    else if (primitive == PRIMITIVE_NONE && strcmp(out->target, "accum") == 0)
        snprintf(out->step, sizeof out->step, "%s", composed(watch));
    else if (peels)
        snprintf(out->step, sizeof out->step, "peel.%d", watch->frame->peels);
    else
        snprintf(out->step, sizeof out->step, "fragment.%d", out->fragment);
}

static void on_blend(PassWatch *base, size_t pixel, uint32_t primitive, const char *target,
                     const char *equation, PixelFormat format, const float source[4],
                     const void *before, const void *after)
{
    Watch *watch = (Watch *)base;
    if (pixel != watch->pixel || watch->result != RESULT_OK)
        return;
    HistoryStep *step = history_add_step(watch->history);
    if (!step) {
        watch->result = RESULT_NO_MEMORY;
        return;
    }
    *step = (HistoryStep){.target = target,
                          .equation = equation,
                          .format = format_info(format)->name,
                          .channels = format_info(format)->channels,
                          .fragment = fragment_of(watch->history, primitive),
                          .stored = true};
    watch->history->step_count--; /* what came before it names it */
    name_step(watch, primitive, step);
    watch->history->step_count++;
    retrace_copy(step->source, source, 4);
    history_values(format, before, step->before);
    history_values(format, after, step->after);
}

/* ---- one pixel ---- */

static const char *note_of(const RenderDesc *desc)
{
    switch (desc->method) {
    case METHOD_FORWARD_DUAL:
        return "forward-dual adds its front layers in the fragment shader: they are one step";
    case METHOD_PAINTER:
    case METHOD_WEIGHTED_AVERAGE:
    case METHOD_WEIGHTED_SUM:
    case METHOD_WEIGHTED_BLENDED:
        return "this method has no layers: fragments are blended in the order of the steps";
    default:
        return NULL;
    }
}

History retrace_begin(const Retrace *retrace, const char *renderer, int x, int y)
{
    const RenderDesc *desc = &retrace->desc;
    return (History){.renderer = renderer,
                     .x = x,
                     .y = y,
                     .method = desc->method,
                     .accum_format = format_info(desc->accum)->name,
                     .depth_format = format_info(retrace->pass.depth_format)->name,
                     .note = note_of(desc)};
}

void retrace_put_results(const PixelTrace *trace, const Frame *frame, int x, int y, History *out)
{
    const PixelValue *accum = pixel_trace_find(trace, "accum");
    double behind = 1.0;
    if (accum)
        history_values(accum->format, accum->bytes, out->accum);
    if (frame->final.pixels) {
        history_values(frame->final.format, image_pixel(&frame->final, x, y), out->final);
        memcpy(out->display, image_pixel(&frame->display, x, y), sizeof out->display);
    }
    for (size_t i = 0; i < out->step_count; i++)
        if (strcmp(out->steps[i].target, "accum") == 0 && strcmp(out->steps[i].step, "opaque") != 0)
            behind = out->steps[i].after[3];
    out->transmittance = behind;
}

/* Draws pass, whose buffers have the pixel at (x, y). */
static Result draw(const Retrace *retrace, Pass *pass, int x, int y, History *out)
{
    PixelTrace trace = pixel_trace_of(x, y);
    Frame frame = {0};
    Watch watch = {.watch = {on_shade, on_blend},
                   .pass = pass,
                   .frame = &frame,
                   .pixel = (size_t)y * (size_t)pass->view.width + (size_t)x,
                   .history = out};
    pass->watch = &watch.watch;
    Result result = pipeline_definition(pass, &trace.sink, &frame);
    pass->watch = NULL;
    if (result == RESULT_OK)
        result = watch.result;
    if (result == RESULT_OK) {
        uint32_t saved = op_enter();
        result = retrace_decide(&retrace->pass, &trace, frame.layers.lost_to_overflow > 0, out);
        op_leave(saved);
        retrace_put_results(&trace, &frame, x, y, out);
    }
    pixel_trace_free(&trace);
    frame_free(&frame);
    return result;
}

/* The pixel alone, or with its neighbours where outlines look at them. */
static Result draw_part(Retrace *retrace, int x, int y, History *out)
{
    const Pass *pass = &retrace->pass;
    int reach = render_desc_edges(&retrace->desc) ? 1 : 0;
    int right = pass->view.width - 1, top = pass->view.height - 1;
    PixelRect rect = {(int16_t)(x > reach ? x - reach : 0), (int16_t)(y > reach ? y - reach : 0),
                      (int16_t)(x + reach < right ? x + reach : right),
                      (int16_t)(y + reach < top ? y + reach : top)};
    RenderDesc desc = retrace->desc;
    desc.width = rect.x1 - rect.x0 + 1;
    desc.height = rect.y1 - rect.y0 + 1;
    Pass part;
    Result result = pass_part(pass, &desc, rect, retrace->pool, &part);
    if (result != RESULT_OK)
        return result;
    result = draw(retrace, &part, stage_column(&part, x), stage_row(&part, y), out);
    pass_part_free(&part);
    return result;
}

Result retrace_check_pixel(const Retrace *retrace, int x, int y)
{
    const View *view = &retrace->pass.view;
    if (x >= 0 && y >= 0 && x < view->width && y < view->height)
        return RESULT_OK;
    return result_fail(RESULT_BAD_INPUT, "pixel %d,%d: expected 0,0 to %d,%d, from the top left", x,
                       y, view->width - 1, view->height - 1);
}

Result retrace_find_at(const Retrace *retrace, int x, int y, History *out)
{
    const Pass *pass = &retrace->pass;
    uint32_t saved = op_enter();
    Result result = retrace_find_fragments(pass, &retrace->all, x, pass->view.height - 1 - y, out);
    op_leave(saved);
    return result;
}

Result retrace_pixel(Retrace *retrace, int x, int y, History *out)
{
    *out = retrace_begin(retrace, "ref", x, y);
    Result result = retrace_check_pixel(retrace, x, y);
    if (result == RESULT_OK)
        result = retrace_find_at(retrace, x, y, out);
    if (result != RESULT_OK)
        return result;
    /* Which nodes find room depends on all pixels. */
    if (retrace->desc.method == METHOD_LINKED_LIST && retrace->desc.nodes_per_pixel > 0)
        return draw(retrace, &retrace->pass, x, y, out);
    return draw_part(retrace, x, retrace->pass.view.height - 1 - y, out);
}

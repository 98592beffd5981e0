/* The history of a pixel from what another renderer traced. */
#include "ref/pipeline/retrace_state.h"

#include "frame/method.h"
#include "number/blend.h"
#include "ref/pipeline/fragment.h"

#include <stdio.h>
#include <string.h>

/* ---- layers with a G-buffer, lit again ---- */

static bool has_gbuffer(const RenderDesc *desc)
{
    return (desc->method == METHOD_PEEL || desc->method == METHOD_PEEL_ID ||
            desc->method == METHOD_FORWARD || desc->method == METHOD_LINKED_LIST) &&
           !render_desc_edges(desc);
}

/* layer: "peel.2", or "opaque". */
static const PixelValue *find(const PixelTrace *trace, const char *layer, const char *what)
{
    char name[PIXEL_TRACE_NAME];
    snprintf(name, sizeof name, "%s.%s", layer, what);
    return pixel_trace_find(trace, name);
}

static void fetch(const PixelValue *value, float out[4])
{
    memset(out, 0, 4 * sizeof *out);
    if (value)
        format_fetch(value->format, value->bytes, out);
}

static HistoryFragment *fragment_at(History *history, bool transparent, uint32_t code)
{
    HistoryFragment *found = NULL;
    for (size_t i = 0; i < history->fragment_count; i++) {
        HistoryFragment *fragment = &history->fragments[i];
        if ((fragment->fate == HISTORY_PEELED || fragment->fate == HISTORY_SEEN) &&
            fragment->transparent == transparent && fragment->code == code)
            found = fragment;
    }
    return found;
}

/* What of peel-id and linked lists tells fragments of one depth apart. */
static HistoryFragment *fragment_of(History *history, const PixelTrace *trace, const char *layer,
                                    bool transparent)
{
    const PixelValue *id = find(trace, layer, "id");
    uint32_t code = pixel_trace_bits(find(trace, layer, "depth"), 0);
    for (size_t i = 0; id && i < history->fragment_count; i++) {
        HistoryFragment *fragment = &history->fragments[i];
        if (fragment->fate == HISTORY_PEELED && fragment->code == code &&
            fragment->primitive == pixel_trace_bits(id, 0))
            return fragment;
    }
    return fragment_at(history, transparent, code);
}

/* The colour that this layer blended; false where it is discarded. */
static Result light(const Retrace *retrace, const PixelTrace *trace, const char *layer,
                    bool transparent, History *out, HistoryStep *step, bool *lit)
{
    const Pass *pass = &retrace->pass;
    const PixelValue *color = find(trace, layer, "color");
    HistoryFragment *fragment = fragment_of(out, trace, layer, transparent);
    ShadeForm form = pass_shade_form(pass, transparent);
    float source[4];
    Texel texel;
    step->fragment = fragment ? (int)(fragment - out->fragments) : HISTORY_NONE;
    out->source_of_ref = !color;
    fetch(color, source);
    *lit = source[3] > SHADING_ALPHA_TEST;
    if (!color) {
        fetch(find(trace, layer, "normal"), texel.normal);
        fetch(find(trace, layer, "position"), texel.position);
        fetch(find(trace, layer, "diffuse"), texel.diffuse);
        fetch(find(trace, layer, "material"), texel.material);
        fragment_decode(pass, pixel_trace_bits(find(trace, layer, "depth"), 0), trace->x,
                        pass->view.height - 1 - trace->y, &texel);
        *lit = shade_pixel(&pass->view, &form, &texel, source);
    }
    if (!*lit)
        return RESULT_OK;
    retrace_copy(step->source, source, 4);
    return fragment && !color && !fragment->surface.lit
               ? retrace_put_shading(pass, out, &fragment->surface, &form, &texel, source)
               : RESULT_OK;
}

/* before: the accumulation so far, which becomes what it is after this layer. */
static Result relight_layer(const Retrace *retrace, const PixelTrace *trace, const char *layer,
                            const PixelValue *after, PixelValue *before, History *out)
{
    bool transparent = strcmp(layer, "opaque") != 0, lit;
    bool seed = !transparent && retrace->desc.opaque_blend == OPAQUE_BLEND_SEED;
    HistoryStep step = {.target = "accum",
                        .equation = seed ? "opaque_seed" : "under",
                        .format = format_info(after->format)->name,
                        .channels = format_info(after->format)->channels,
                        .stored = true};
    Result result = light(retrace, trace, layer, transparent, out, &step, &lit);
    if (result == RESULT_OK && lit) {
        HistoryStep *added = history_add_step(out);
        if (!added)
            return RESULT_NO_MEMORY;
        snprintf(step.step, sizeof step.step, "%s", layer);
        history_values(before->format, before->bytes, step.before);
        history_values(after->format, after->bytes, step.after);
        *added = step;
    }
    *before = *after;
    return result;
}

static Result relight(const Retrace *retrace, const PixelTrace *trace, History *out)
{
    PixelValue before = {.format = retrace->desc.accum};
    const PixelValue *after;
    Result result = RESULT_OK;
    blend_clear(before.format, before.bytes);
    for (int k = 0;
         result == RESULT_OK && (after = pixel_trace_numbered(trace, "peel", k, "accum")); k++) {
        char layer[HISTORY_NAME];
        snprintf(layer, sizeof layer, "peel.%d", k);
        result = relight_layer(retrace, trace, layer, after, &before, out);
    }
    after = pixel_trace_find(trace, "accum");
    return result == RESULT_OK && after
               ? relight_layer(retrace, trace, "opaque", after, &before, out)
               : result;
}

/* ---- other methods: ref's steps, with what was stored where it was traced ---- */

static bool is_last(const History *history, size_t index, bool before_opaque)
{
    const HistoryStep *step = &history->steps[index];
    for (size_t i = index + 1; i < history->step_count; i++) {
        const HistoryStep *other = &history->steps[i];
        if (strcmp(other->target, step->target) == 0 &&
            (!before_opaque || strcmp(other->step, "opaque") != 0))
            return false;
    }
    return true;
}

/* What was traced of a step's target after the step; NULL: nothing. */
static const PixelValue *stored_after(const PixelTrace *trace, const History *history, size_t index)
{
    const HistoryStep *step = &history->steps[index];
    const char *method = method_info(history->method)->name;
    const char *rest;
    int peel = trace_peel_number(step->step, &rest);
    bool accum = strcmp(step->target, "accum") == 0;
    if (peel >= 0)
        return accum ? pixel_trace_numbered(trace, "peel", peel, "accum")
                     : pixel_trace_numbered(trace, method, peel, "back_accum");
    if (accum && is_last(history, index, false))
        return pixel_trace_find(trace, "accum");
    if (accum && history->method == METHOD_PAINTER && is_last(history, index, true))
        return pixel_trace_find(trace, "painter.layers");
    return !accum && is_last(history, index, false) ? find(trace, method, step->target) : NULL;
}

static void put_stored(const PixelTrace *trace, History *history)
{
    for (size_t i = 0; i < history->step_count; i++) {
        HistoryStep *step = &history->steps[i];
        const PixelValue *after = stored_after(trace, history, i);
        step->stored = after != NULL;
        if (!after)
            continue;
        history_values(after->format, after->bytes, step->after);
        for (size_t k = i + 1; k < history->step_count; k++)
            if (strcmp(history->steps[k].target, step->target) == 0) {
                memcpy(history->steps[k].before, step->after, sizeof step->after);
                break;
            }
    }
}

static Result borrow(Retrace *retrace, const PixelTrace *trace, const char *renderer, History *out)
{
    Result result = retrace_pixel(retrace, trace->x, trace->y, out);
    out->renderer = renderer;
    out->source_of_ref = true;
    out->test_count = 0;
    for (size_t i = 0; i < out->fragment_count; i++) {
        out->fragments[i].passes = 0;
        out->fragments[i].peel = HISTORY_NONE;
        out->fragments[i].back = false;
    }
    if (result == RESULT_OK)
        put_stored(trace, out);
    return result;
}

Result retrace_traced(Retrace *retrace, const char *renderer, const PixelTrace *trace,
                      const Frame *frame, History *out)
{
    bool lists = has_gbuffer(&retrace->desc);
    *out = retrace_begin(retrace, renderer, trace->x, trace->y);
    Result result = retrace_check_pixel(retrace, trace->x, trace->y);
    if (result == RESULT_OK)
        result = lists ? retrace_find_at(retrace, trace->x, trace->y, out)
                       : borrow(retrace, trace, renderer, out);
    uint32_t saved = op_enter();
    if (result == RESULT_OK)
        result = retrace_decide(&retrace->pass, trace, frame->layers.lost_to_overflow > 0, out);
    if (result == RESULT_OK && lists)
        result = relight(retrace, trace, out);
    op_leave(saved);
    if (result == RESULT_OK)
        retrace_put_results(trace, frame, trace->x, trace->y, out);
    return result;
}

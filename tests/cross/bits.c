#include "bits.h"

#include "scene_geometry.h"
#include "testing.h"

#include "compare/against.h"
#include "compare/store.h"
#include "gl/gl_renderer.h"
#include "ref/pipeline/pipeline.h"

#include <stdio.h>
#include <string.h>

static void ok(Result result)
{
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

/* Buffers that show layers. */
static bool is_layered(const char *name)
{
    return strncmp(name, "opaque.", 7) != 0;
}

static Result add_buffers(const Against *against, const RenderDesc *desc, Bits *out)
{
    out->buffers = against->count;
    for (size_t i = 0; i < against->count; i++) {
        const BufferMetrics *buffer = &against->buffers[i];
        if (buffer->values == 0)
            return result_fail(RESULT_INTERNAL, "%s: nothing was compared", buffer->name);
        if (out->layers.lost_to_overflow > 0 && is_layered(buffer->name))
            continue;
        out->pixels += (uint64_t)desc->width * (uint64_t)desc->height;
        out->values += buffer->values;
        out->differing += buffer->differing;
        if (buffer->differing > 0 && !*out->difference)
            snprintf(out->difference, sizeof out->difference,
                     "%s: %llu of %llu values differ, first at (%d, %d) channel %d, by at most %u "
                     "ULP, %g (%a)",
                     buffer->name, (unsigned long long)buffer->differing,
                     (unsigned long long)buffer->values, buffer->first[0], buffer->first[1],
                     buffer->first[2], buffer->max_ulp, buffer->max_abs, buffer->max_abs);
    }
    return RESULT_OK;
}

/* What is known of lists whatever nodes are lost, and then of their layers too; of other methods gl
 * does not count. */
static bool same_lists(const Frame *ref, const Frame *driver)
{
    const LayerStats *a = &ref->layers, *b = &driver->layers;
    if (ref->nodes != driver->nodes || ref->node_bytes != driver->node_bytes ||
        a->lost_to_overflow != b->lost_to_overflow)
        return false;
    return ref->nodes == 0 || a->lost_to_overflow > 0 ||
           (a->max == b->max && a->fragments == b->fragments &&
            a->lost_to_pass_limit == b->lost_to_pass_limit);
}

static bool same_frames(const Frame *ref, const Frame *driver)
{
    size_t pixels = (size_t)ref->final.width * (size_t)ref->final.height;
    /* A driver may draw a list again with more room. */
    bool passes = ref->geometry_passes == driver->geometry_passes ||
                  (ref->nodes > 0 && driver->geometry_passes == 2);
    bool layers = ref->peels == driver->peels && ref->layers.repeated == driver->layers.repeated &&
                  ref->layers.overflowed == driver->layers.overflowed &&
                  memcmp(ref->final.pixels, driver->final.pixels, pixels * 16) == 0;
    return passes && same_lists(ref, driver) && (layers || ref->layers.lost_to_overflow > 0);
}

static bool is_wide(const Geometry *geometry)
{
    return geometry->wide;
}

/* The same but for what the driver counted outside of the frame: ref/pipeline/wide.h. */
static bool same_inside(const Frame *ref, const Frame *driver)
{
    Frame inside = *driver;
    if (inside.nodes > ref->nodes)
        inside.nodes = ref->nodes;
    if (inside.layers.lost_to_overflow > ref->layers.lost_to_overflow)
        inside.layers.lost_to_overflow = ref->layers.lost_to_overflow;
    if (inside.peels > ref->peels)
        inside.peels = ref->peels;
    return same_frames(ref, &inside);
}

/* What no buffer of the trace shows. desc: as ref drew it. */
static Result add_frames(const Scene *scene, const RenderDesc *desc, const Frame *ref,
                         const Frame *driver, Bits *out)
{
    bool same = same_frames(ref, driver), wide = false;
    if (!same) {
        Result result = scene_geometry_ask(scene, desc, is_wide, &wide);
        if (result != RESULT_OK)
            return result;
    }
    same |= wide && same_inside(ref, driver);
    out->differing += !same;
    if (!same && !*out->difference)
        snprintf(
            out->difference, sizeof out->difference,
            "%d peels of ref and %d of gl, %d and %d geometry passes, %llu and %llu layers "
            "repeated, %llu and %llu sums overflowed, %llu and %llu nodes, %llu and %llu of "
            "them lost, or the final image",
            ref->peels, driver->peels, ref->geometry_passes, driver->geometry_passes,
            (unsigned long long)ref->layers.repeated, (unsigned long long)driver->layers.repeated,
            (unsigned long long)ref->layers.overflowed,
            (unsigned long long)driver->layers.overflowed, (unsigned long long)ref->nodes,
            (unsigned long long)driver->nodes, (unsigned long long)ref->layers.lost_to_overflow,
            (unsigned long long)driver->layers.lost_to_overflow);
    return RESULT_OK;
}

/* Every fragment is peeled, or counted as lost. */
static Result check_counts(const LayerStats *layers)
{
    if (layers->lost_to_overflow > 0 || (layers->lost_to_ties <= layers->fragments &&
                                         layers->lost_to_pass_limit <= layers->fragments))
        return RESULT_OK;
    return result_fail(
        RESULT_INTERNAL, "of %llu fragments %llu lost to ties, %llu to the pass limit",
        (unsigned long long)layers->fragments, (unsigned long long)layers->lost_to_ties,
        (unsigned long long)layers->lost_to_pass_limit);
}

/* Depth and the stored colours of the opaque pass, the last accumulation and the display; and what
 * the method adds for each peel, or at once: the same and its accumulation, or what its header
 * says. */
static size_t expected_buffers(const RenderDesc *desc, int peels)
{
    GBufferLayout layout = render_desc_layout(desc);
    const PixelFormat colors[] = {layout.normal, layout.position, layout.diffuse, layout.material};
    size_t stored = 1;
    for (int i = 0; i < 4; i++)
        stored += colors[i] != FORMAT_NONE;
    size_t others = 0, peel = stored + 1;
    switch (desc->method) {
    case METHOD_DUAL:
        others = 1, peel = 9;
        break;
    case METHOD_FORWARD_DUAL:
        others = 1, peel = 4;
        break;
    case METHOD_PEEL_ID:
    case METHOD_LINKED_LIST:
        peel++;
        break;
    case METHOD_WEIGHTED_SUM:
    case METHOD_PAINTER:
        others = 1, peel = 0;
        break;
    case METHOD_WEIGHTED_AVERAGE:
    case METHOD_WEIGHTED_BLENDED:
        others = 2, peel = 0;
        break;
    default:
        break;
    }
    return stored + others + peel * (size_t)peels + 2;
}

/* driver: what gl traced; *frame: what it returned. */
static Result compare_with(const Scene *scene, const RenderDesc *desc, const TraceStore *driver,
                           const Frame *frame, Bits *out)
{
    Against against = against_of(driver);
    Frame ref = {0};
    RenderDesc modelled = *desc;
    modelled.ref_path = REF_PATH_DEFINITION;
    modelled.unfused = !frame->fused;
    Result result = pipeline_render(scene, &modelled, &against.sink, &ref);
    if (result == RESULT_OK)
        result = against_finish(&against);
    out->fused = frame->fused;
    out->peels = ref.peels;
    out->geometry_passes[0] = ref.geometry_passes;
    out->geometry_passes[1] = frame->geometry_passes;
    out->layers = ref.layers;
    if (result == RESULT_OK)
        result = check_counts(&ref.layers);
    if (result == RESULT_OK)
        result = add_buffers(&against, desc, out);
    if (result == RESULT_OK)
        result = add_frames(scene, &modelled, &ref, frame, out);
    size_t expected = expected_buffers(desc, ref.peels > frame->peels ? ref.peels : frame->peels);
    if (result == RESULT_OK && against.count != expected)
        result = result_fail(RESULT_INTERNAL, "%zu buffers in the traces, expected %zu",
                             against.count, expected);
    frame_free(&ref);
    against_free(&against);
    return result;
}

Result bits_measure(const Scene *scene, const RenderDesc *desc, Bits *out)
{
    TraceStore *driver = NULL;
    Frame frame;
    *out = (Bits){0};
    Result result = store_create(0, &driver);
    if (result == RESULT_OK)
        result = gl_render(scene, desc, store_sink(driver), &frame);
    if (result == RESULT_OK) {
        result = compare_with(scene, desc, driver, &frame, out);
        frame_free(&frame);
    }
    store_destroy(driver);
    return result;
}

void bits_compare(const Scene *scene, const RenderDesc *desc, Bits *out)
{
    ok(bits_measure(scene, desc, out));
}

uint64_t bits_between(Renderer renderer, const Scene *scene, const RenderDesc *a,
                      const RenderDesc *b)
{
    TraceStore *store;
    Frame frames[2];
    uint64_t differing = 0;
    ok(store_create(0, &store));
    ok(renderer(scene, a, store_sink(store), &frames[0]));
    Against against = against_of(store);
    ok(renderer(scene, b, &against.sink, &frames[1]));
    ok(against_finish(&against));
    for (size_t i = 0; i < against.count; i++)
        differing += against.buffers[i].differing;
    size_t pixels = (size_t)frames[0].final.width * (size_t)frames[0].final.height;
    differing += memcmp(frames[0].final.pixels, frames[1].final.pixels, pixels * 16) != 0;
    for (int i = 0; i < 2; i++)
        frame_free(&frames[i]);
    against_free(&against);
    store_destroy(store);
    return differing;
}

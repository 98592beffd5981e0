#include "bits.h"

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

static void add_buffers(const Against *against, const RenderDesc *desc, Bits *out)
{
    out->buffers = against->count;
    for (size_t i = 0; i < against->count; i++) {
        const BufferMetrics *buffer = &against->buffers[i];
        ck_assert_uint_gt(buffer->values, 0);
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
}

/* What no buffer of the trace shows. */
static void add_frames(const Frame *ref, const Frame *driver, Bits *out)
{
    size_t pixels = (size_t)ref->final.width * (size_t)ref->final.height;
    bool same = ref->peels == driver->peels && ref->layers.repeated == driver->layers.repeated &&
                ref->layers.overflowed == driver->layers.overflowed &&
                ref->geometry_passes == driver->geometry_passes &&
                memcmp(ref->final.pixels, driver->final.pixels, pixels * 16) == 0;
    out->differing += !same;
    if (!same && !*out->difference)
        snprintf(out->difference, sizeof out->difference,
                 "%d peels of ref and %d of gl, %llu and %llu layers repeated, %llu and %llu sums "
                 "overflowed, %d and %d geometry passes, or the final image",
                 ref->peels, driver->peels, (unsigned long long)ref->layers.repeated,
                 (unsigned long long)driver->layers.repeated,
                 (unsigned long long)ref->layers.overflowed,
                 (unsigned long long)driver->layers.overflowed, ref->geometry_passes,
                 driver->geometry_passes);
}

/* The opaque depth and stored colours, the last accumulation and the display; and the method's:
 * the same colours and the accumulation of each peel, or its sums. */
static size_t expected_buffers(const RenderDesc *desc, int peels)
{
    size_t stored = render_desc_layout(desc).position == FORMAT_NONE ? 4 : 5;
    switch (desc->method) {
    case METHOD_WEIGHTED_SUM:
    case METHOD_PAINTER:
        return stored + 1 + 2;
    case METHOD_WEIGHTED_AVERAGE:
    case METHOD_WEIGHTED_BLENDED:
        return stored + 2 + 2;
    default:
        return stored + (stored + 1) * (size_t)peels + 2;
    }
}

void bits_compare(const Scene *scene, const RenderDesc *desc, Bits *out)
{
    TraceStore *driver;
    Against against;
    Frame ref, frame;
    RenderDesc modelled = *desc;
    *out = (Bits){0};
    modelled.ref_path = REF_PATH_DEFINITION;
    ok(store_create(0, &driver));
    ok(gl_render(scene, desc, store_sink(driver), &frame));
    modelled.unfused = !frame.fused;
    ok(against_create(driver, &against));
    ok(pipeline_render(scene, &modelled, &against.sink, &ref));
    ok(against_finish(&against));
    out->fused = frame.fused;
    out->peels = ref.peels;
    out->layers = ref.layers;
    add_buffers(&against, desc, out);
    add_frames(&ref, &frame, out);
    ck_assert_uint_eq(against.count, expected_buffers(desc, ref.peels));
    frame_free(&ref);
    frame_free(&frame);
    against_free(&against);
    store_destroy(driver);
}

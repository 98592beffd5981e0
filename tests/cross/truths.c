#include "truths.h"

#include "base/memory.h"
#include "ref/pipeline/pipeline.h"
#include "ref/truth/truth.h"

#include <stdlib.h>

static Result traced(Renderer renderer, const Scene *scene, const RenderDesc *desc,
                     TraceStore **store, Frame *out)
{
    Result result = store_create(0, store);
    return result == RESULT_OK ? renderer(scene, desc, store_sink(*store), out) : result;
}

Result truths_compare(const Scene *scene, const RenderDesc *desc, Truths *out)
{
    RenderDesc bounded = *desc;
    bounded.bound = true;
    *out = (Truths){.same = memory_array((size_t)desc->width, (size_t)desc->height)};
    Result result = out->same ? RESULT_OK : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = traced(pipeline_render, scene, desc, &out->ref_trace, &out->ref);
    if (result == RESULT_OK)
        result = traced(truth_render, scene, &bounded, &out->truth_trace, &out->truth);
    if (result == RESULT_OK)
        result = structure_compare(out->ref_trace, out->truth_trace, desc->width, desc->height,
                                   out->same, &out->counts);
    if (result == RESULT_OK)
        result = metrics_bound(&out->ref.final, &out->truth, out->same, &out->bound);
    return result;
}

void truths_free(Truths *truths)
{
    store_destroy(truths->ref_trace);
    store_destroy(truths->truth_trace);
    frame_free(&truths->ref);
    frame_free(&truths->truth);
    free(truths->same);
    *truths = (Truths){0};
}

#include "ref/pipeline/pipeline.h"

#include "base/clock.h"
#include "ref/pipeline/pass.h"
#include "ref/pipeline/tile.h"

#include <stdio.h>

/* What the chosen path needs beside the scene, against the caller's limit. */
static Result check_memory(const Pass *pass, bool definition, uint64_t *bytes)
{
    const RenderDesc *desc = pass->desc;
    uint64_t pixels = (uint64_t)desc->width * (uint64_t)desc->height;
    uint64_t limit = desc->max_memory ? desc->max_memory : RENDER_MEMORY_DEFAULT;
    *bytes = pass_bytes(pass) + pixels * 20 + (definition ? peel_buffer_bytes(pass) : 0);
    if (*bytes > limit)
        return result_fail(RESULT_NO_MEMORY,
                           "ref: %d×%d needs %llu MiB, more than the limit of %llu MiB "
                           "(--max-memory)",
                           desc->width, desc->height, (unsigned long long)(*bytes >> 20),
                           (unsigned long long)(limit >> 20));
    return RESULT_OK;
}

static Result render(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    Pass pass;
    Result result = pass_create(scene, desc, &pass);
    if (result != RESULT_OK)
        return result;
    bool definition = trace || desc->ref_path == REF_PATH_DEFINITION;
    out->threads = pool_threads(pass.pool);
    out->fused = pass.fused;
    snprintf(out->version, sizeof out->version, "Peel %s", PEEL_VERSION);
    snprintf(out->renderer, sizeof out->renderer, "ref (%s path)",
             definition ? "definition" : "tile");
    result = check_memory(&pass, definition, &out->buffer_bytes);
    if (result == RESULT_OK)
        result = image_create(desc->width, desc->height, FORMAT_RGBA32F, &out->final);
    if (result == RESULT_OK)
        result = image_create(desc->width, desc->height, FORMAT_RGBA8, &out->display);
    if (result == RESULT_OK)
        result = definition ? peel_render(&pass, trace, out) : tile_render(&pass, out);
    pass_free(&pass);
    return result;
}

Result pipeline_render(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out)
{
    *out = (Frame){0};
    Clock start = clock_now();
    Result result = render(scene, desc, trace, out);
    if (result != RESULT_OK) {
        frame_free(out);
        return result;
    }
    clock_elapsed(&start, &out->time_ms, &out->cpu_ms);
    return RESULT_OK;
}

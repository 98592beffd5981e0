#include "cli/explain_page.h"

#include "base/progress.h"
#include "cli/bind.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct Sides {
    const char *name; /* of the scene */
    Frame frames[RENDERER_COUNT];
    TraceStore *traces[RENDERER_COUNT];
    bool full;                         /* a trace is more than a page can keep */
    char missing[RENDERER_COUNT][256]; /* why there is no frame; "" where there is one */
} Sides;

static Result render(const Scene *scene, const RenderDesc *desc, int renderer, Sides *sides)
{
    TraceStore **trace = &sides->traces[renderer];
    Result result = renderer == RENDERER_TRUTH ? RESULT_OK : store_create(0, trace);
    if (result != RESULT_OK)
        return result;
    ExplainSink sink = report_explain_sink(*trace ? store_sink(*trace) : NULL, sides->name);
    progress_begin(threeway_renderer_name(renderer), 0);
    result =
        bind_renderers[renderer](scene, desc, *trace ? &sink.sink : NULL, &sides->frames[renderer]);
    progress_end();
    sides->full = sink.full;
    return result;
}

/* The page can do without gl or the truth, and then says why. */
static Result render_beside(const RenderOptions *options, const Scene *scene,
                            const RenderDesc *desc, int renderer, Sides *sides)
{
    Result result = renderer == RENDERER_GL ? options_check_fma(options) : RESULT_OK;
    if (result == RESULT_OK)
        result = render(scene, desc, renderer, sides);
    if (sides->full || (result != RESULT_NO_GL && result != RESULT_UNSUPPORTED))
        return result;
    snprintf(sides->missing[renderer], sizeof sides->missing[renderer], "%s", result_message());
    return RESULT_OK;
}

/* gl first: where nobody says so, ref fuses as the driver does. */
static Result render_all(const RenderOptions *options, const Scene *scene, RenderDesc *desc,
                         Sides *sides)
{
    Result result = render_beside(options, scene, desc, RENDERER_GL, sides);
    if (result == RESULT_OK && !sides->missing[RENDERER_GL][0])
        desc->unfused = !sides->frames[RENDERER_GL].fused;
    if (result == RESULT_OK)
        result = render(scene, desc, RENDERER_REF, sides);
    if (result == RESULT_OK)
        result = render_beside(options, scene, desc, RENDERER_TRUTH, sides);
    return result;
}

static ExplainSide side_of(const Sides *sides, int renderer)
{
    bool missing = sides->missing[renderer][0];
    return (ExplainSide){.frame = missing ? NULL : &sides->frames[renderer],
                         .trace = sides->traces[renderer],
                         .missing = sides->missing[renderer]};
}

Result explain_page_write(const RenderOptions *options, const Scene *scene, const ExplainPage *page,
                          size_t *bytes)
{
    Sides sides = {.name = scene->name ? scene->name : options->scene_path};
    RenderDesc desc = options->desc;
    Result result = render_all(options, scene, &desc, &sides);
    if (result == RESULT_OK) {
        ExplainDesc explain = {.name = sides.name,
                               .command = page->command,
                               .scene = scene,
                               .desc = desc,
                               .ref = side_of(&sides, RENDERER_REF),
                               .gl = side_of(&sides, RENDERER_GL),
                               .truth = side_of(&sides, RENDERER_TRUTH),
                               .max_bytes = page->max_bytes,
                               .lesson = page->lesson};
        result = report_explain_write(&explain, page->dir, page->file, bytes);
    }
    for (int i = 0; i < RENDERER_COUNT; i++) {
        frame_free(&sides.frames[i]);
        store_destroy(sides.traces[i]);
    }
    return result;
}

#include "cli/bind.h"

#include "gl/gl_renderer.h"
#include "ref/pipeline/pipeline.h"
#include "ref/truth/truth.h"

#include <string.h>

const Renderer bind_renderers[RENDERER_COUNT] = {
    [RENDERER_REF] = pipeline_render,
    [RENDERER_GL] = gl_render,
    [RENDERER_TRUTH] = truth_render,
};

int bind_find_renderer(const char *name)
{
    for (int i = 0; i < RENDERER_COUNT; i++)
        if (strcmp(threeway_renderer_name(i), name) == 0)
            return i;
    return -1;
}

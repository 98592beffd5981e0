#include "frame/node.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

static int by_primitive(const void *a, const void *b)
{
    uint32_t x = ((const NodeMaterial *)a)->first_primitive;
    uint32_t y = ((const NodeMaterial *)b)->first_primitive;
    return (x > y) - (x < y);
}

static uint32_t pack(float r, float g, float b, float a)
{
    uint32_t word;
    unsigned char pixel[4];
    format_store(FORMAT_RGBA8, (const float[4]){r, g, b, a}, pixel);
    memcpy(&word, pixel, sizeof word);
    return word;
}

Result node_materials(const Scene *scene, const View *view, NodeMaterial **out, uint32_t *count)
{
    *count = 0;
    *out = memory_array(view->draw_count + 1, sizeof **out);
    if (!*out)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < view->draw_count; i++) {
        const Draw *draw = &view->draws[i];
        const Material *m = &scene->materials[draw->material];
        if (!draw->transparent)
            continue;
        (*out)[(*count)++] = (NodeMaterial){
            .first_primitive = draw->first_primitive,
            .diffuse = pack(m->base_color[0], m->base_color[1], m->base_color[2], m->base_color[3]),
            .material = pack(m->roughness, m->metallic, m->occlusion, 1.0f)};
    }
    qsort(*out, *count, sizeof **out, by_primitive);
    return RESULT_OK;
}

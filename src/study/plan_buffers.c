#include "study/plan_buffers.h"

#include "base/memory.h"
#include "frame/node.h"
#include "frame/sort.h"

#include <assert.h>
#include <stdlib.h>

typedef struct Planner {
    const Scene *scene;
    const View *view;
    const RenderDesc *desc;
    const Needs *needs;
    PlanBuffers *out;
} Planner;

static void add(const Planner *planner, const char *name, PixelFormat format, uint64_t bytes)
{
    if (bytes == 0)
        return;
    assert(planner->out->count < PLAN_BUFFERS_MAX);
    planner->out->items[planner->out->count++] = (PlanBuffer){name, format, bytes};
    planner->out->bytes += bytes;
}

static uint64_t pixels(const Planner *planner)
{
    return (uint64_t)planner->desc->width * (uint64_t)planner->desc->height;
}

static void add_image(const Planner *planner, const char *name, PixelFormat format)
{
    add(planner, name, format, format_pixel_bytes(format) * pixels(planner));
}

/* names: of normal, position, diffuse and material. */
static void add_colors(const Planner *planner, const GBufferLayout *layout,
                       const char *const names[4])
{
    add_image(planner, names[0], layout->normal);
    add_image(planner, names[1], layout->position);
    add_image(planner, names[2], layout->diffuse);
    add_image(planner, names[3], layout->material);
}

static void add_frame(const Planner *planner)
{
    static const char *const names[] = {"opaque.normal", "opaque.position", "opaque.diffuse",
                                        "opaque.material"};
    const RenderDesc *desc = planner->desc;
    GBufferLayout layout = needs_layout(planner->needs, desc, false);
    add_image(planner, "opaque.depth", render_desc_depth(desc));
    add_colors(planner, &layout, names);
    if (render_desc_needs_code(desc))
        add_image(planner, "opaque.code", FORMAT_R32UI);
    add_image(planner, "accum", desc->accum);
    add_image(planner, "final", FORMAT_RGBA32F);
    add_image(planner, "display", FORMAT_RGBA8);
}

/* ---- of methods ---- */

static void add_peel(const Planner *planner, bool by_id)
{
    static const char *const names[] = {"peel.normal", "peel.position", "peel.diffuse",
                                        "peel.material"};
    const RenderDesc *desc = planner->desc;
    GBufferLayout layout = needs_layout(planner->needs, desc, true);
    add_image(planner, "peel.depth, one", render_desc_depth(desc));
    add_image(planner, "peel.depth, other", render_desc_depth(desc));
    add_colors(planner, &layout, names);
    if (by_id) {
        add_image(planner, "peel.rank, one", FORMAT_R32UI);
        add_image(planner, "peel.rank, other", FORMAT_R32UI);
    }
    if (render_desc_needs_previous_code(desc))
        add_image(planner, "peel.code", FORMAT_R32UI);
}

static void add_limits(const Planner *planner)
{
    add_image(planner, "limits, one", FORMAT_RG32F);
    add_image(planner, "limits, other", FORMAT_RG32F);
    add_image(planner, "back.accum", planner->desc->accum);
}

static void add_dual(const Planner *planner)
{
    static const char *const names[] = {"front.normal", "front.diffuse", "front.material",
                                        "back.normal",  "back.diffuse",  "back.material"};
    add_limits(planner);
    for (int i = 0; i < 6; i++)
        add_image(planner, names[i], render_desc_dual_format(planner->desc, i % 3 == 0));
}

static void add_forward_dual(const Planner *planner)
{
    add_limits(planner);
    add_image(planner, "back.color", planner->desc->accum);
    add_image(planner, "front.color, one", planner->desc->accum);
    add_image(planner, "front.color, other", planner->desc->accum);
}

static void add_sums(const Planner *planner, bool second)
{
    add_image(planner, "sum", render_desc_sum_format(planner->desc));
    if (second)
        add_image(planner, "second sum", FORMAT_R32F);
}

static uint64_t list_capacity(const Planner *planner, uint64_t nodes)
{
    uint64_t guessed = NODES_GUESSED * pixels(planner);
    if (planner->desc->nodes_per_pixel > 0)
        return (uint64_t)planner->desc->nodes_per_pixel * pixels(planner);
    return nodes > guessed ? nodes : guessed;
}

static Result add_lists(const Planner *planner, uint64_t nodes)
{
    static const char *const names[] = {"layer.normal", "layer.position", "layer.diffuse",
                                        "layer.material"};
    GBufferLayout layout = needs_layout(planner->needs, planner->desc, true);
    uint32_t words = node_words(planner->scene), count;
    NodeMaterial *entries;
    add_image(planner, "layer.depth", render_desc_depth(planner->desc));
    add_colors(planner, &layout, names);
    add_image(planner, "layer.id", FORMAT_R32UI);
    add(planner, "list heads", FORMAT_NONE,
        (NODES_HEADER_WORDS + pixels(planner)) * sizeof(uint32_t));
    add(planner, "list nodes", FORMAT_NONE,
        list_capacity(planner, nodes) * words * sizeof(uint32_t));
    if (words != NODE_WORDS)
        return RESULT_OK;
    Result result = node_materials(planner->scene, planner->view, &entries, &count);
    if (result != RESULT_OK)
        return result;
    free(entries);
    add(planner, "list materials", FORMAT_NONE, (count + (uint64_t)1) * sizeof *entries);
    return RESULT_OK;
}

static Result add_method(const Planner *planner, uint64_t nodes)
{
    const RenderDesc *desc = planner->desc;
    switch (desc->method) {
    case METHOD_PEEL:
    case METHOD_FORWARD:
        add_peel(planner, false);
        break;
    case METHOD_PEEL_ID:
        add_peel(planner, true);
        break;
    case METHOD_DUAL:
        add_dual(planner);
        break;
    case METHOD_FORWARD_DUAL:
        add_forward_dual(planner);
        break;
    case METHOD_LINKED_LIST:
        return add_lists(planner, nodes);
    case METHOD_WEIGHTED_AVERAGE:
    case METHOD_WEIGHTED_BLENDED:
        add_sums(planner, true);
        break;
    case METHOD_WEIGHTED_SUM:
        add_sums(planner, false);
        break;
    case METHOD_PAINTER:
        add(planner, "sorted runs", FORMAT_NONE,
            sort_bytes(planner->scene, planner->view, desc->sort));
        break;
    case METHOD_COUNT:
        break;
    }
    return RESULT_OK;
}

/* ---- of the scene ---- */

static Result texture_bytes(const Planner *planner, uint64_t *bytes)
{
    const Scene *scene = planner->scene;
    bool *wanted = memory_array(scene->texture_count, sizeof *wanted);
    if (!wanted)
        return RESULT_NO_MEMORY;
    needs_textures(planner->needs, scene, planner->view, wanted);
    for (size_t i = 0; i < scene->texture_count; i++)
        if (wanted[i])
            *bytes +=
                4 * sizeof(float) * (uint64_t)scene->textures[i].width * scene->textures[i].height;
    free(wanted);
    return RESULT_OK;
}

static Result add_scene(const Planner *planner)
{
    const Needs *needs = planner->needs;
    uint64_t vertices = 0, indices = 0, bytes = 0;
    for (size_t i = 0; i < planner->scene->mesh_count; i++) {
        vertices += planner->scene->meshes[i].vertex_count;
        indices += 3 * (uint64_t)planner->scene->meshes[i].triangle_count;
    }
    bool textured =
        needs_has(needs, NEED_BASE_COLOR_TEXTURE) || needs_has(needs, NEED_MATERIAL_TEXTURE);
    add(planner, "vertex positions", FORMAT_NONE, vertices * 3 * sizeof(float));
    if (needs_has(needs, NEED_NORMAL))
        add(planner, "vertex normals", FORMAT_NONE, vertices * 3 * sizeof(float));
    if (textured)
        add(planner, "vertex uvs", FORMAT_NONE, vertices * 2 * sizeof(float));
    add(planner, "indices", FORMAT_NONE, indices * sizeof(uint32_t));
    add(planner, "lights", FORMAT_NONE, planner->view->light_count * 12 * sizeof(float));
    Result result = texture_bytes(planner, &bytes);
    add(planner, "textures", FORMAT_NONE, bytes);
    return result;
}

Result plan_buffers(const Scene *scene, const View *view, const RenderDesc *desc,
                    const Needs *needs, uint64_t nodes, PlanBuffers *out)
{
    const Planner planner = {scene, view, desc, needs, out};
    *out = (PlanBuffers){0};
    add_frame(&planner);
    Result result = needs_has(needs, NEED_TRANSPARENT) ? add_method(&planner, nodes) : RESULT_OK;
    return result == RESULT_OK ? add_scene(&planner) : result;
}

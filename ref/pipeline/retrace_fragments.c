#include "ref/pipeline/retrace_fragments.h"

#include "base/memory.h"
#include "ref/pipeline/fragment.h"

#include <math.h>

/* ---- what the pipeline rasterizes, culled or not ---- */

void retrace_copy(double *out, const float *values, int count)
{
    for (int i = 0; i < count; i++)
        out[i] = (double)values[i];
}

void retrace_put_surface(const Texel *texel, HistorySurface *out)
{
    retrace_copy(out->position, texel->position, 3);
    retrace_copy(out->normal, texel->normal, 3);
    retrace_copy(out->base, texel->diffuse, 4);
    out->roughness = (double)texel->material[0];
    out->metallic = (double)texel->material[1];
    out->occlusion = (double)texel->material[2];
}

static void fill_draw(const Pass *pass, uint32_t draw_index, HistoryFragment *out)
{
    const Draw *draw = &pass->view.draws[draw_index];
    out->instance = draw->instance;
    out->mesh = draw->mesh;
    out->material = draw->material;
    out->transparent = draw->transparent;
}

/* Edge functions at the pixel's centre. Returns whether none has it outside; *covered: whether
 * the fill rule gives all edges through the centre to this triangle. */
static bool fill_edges(const Setup *setup, int x, int y, HistoryFragment *out, bool *covered)
{
    bool wide = setup_needs_wide(setup);
    *covered = out->has_edges = true;
    for (int i = 0; i < 3; i++) {
        const Edge *edge = &setup->edge[i];
        uint64_t value = setup_edge_at(edge, x, y);
        out->owned[i] = edge->a < 0 || (edge->a == 0 && edge->b >= 0);
        out->edge[i] = (int64_t)(value - out->owned[i]);
        *covered = *covered && (int64_t)value > 0;
        if (out->edge[i] < 0 && !wide)
            return false;
    }
    if (wide) {
        Wide of;
        wide_make(setup, &of);
        *covered = wide_covers(&of, x, y);
        return *covered;
    }
    return true;
}

static Result find_one(const Pass *pass, const Geometry *geometry, const Primitive *primitive,
                       int x, int y, History *out)
{
    const Vertex *vertices = geometry->vertices;
    const Vertex *const corners[3] = {&vertices[primitive->vertex[0]],
                                      &vertices[primitive->vertex[1]],
                                      &vertices[primitive->vertex[2]]};
    const Draw *draw = &pass->view.draws[primitive->draw];
    Setup setup;
    HistoryFragment found = {.primitive = primitive->id, .peel = HISTORY_NONE};
    Texel texel;
    bool covered;
    setup_make(corners, primitive->swap, draw->flipped, primitive->box, &setup);
    if (!fill_edges(&setup, x, y, &found, &covered))
        return RESULT_OK;
    HistoryFragment *fragment = history_add_fragment(out);
    if (!fragment)
        return RESULT_NO_MEMORY;
    FragmentDepth depth = pass_fragment_depth(pass, &setup, x, y);
    found.front = setup.front;
    found.z = (double)depth.z;
    found.code = depth.key;
    found.depth = (double)depth_fetch(pass->depth_format, depth.key);
    found.masked = fragment_masked(pass, &setup, primitive, x, y);
    found.fate = draw->cull_back && !setup.front ? HISTORY_CULLED
                 : covered                       ? HISTORY_HIDDEN
                                                 : HISTORY_FILL_RULE;
    fill_draw(pass, primitive->draw, &found);
    fragment_surface(pass, &setup, primitive, x, y, &texel);
    retrace_put_surface(&texel, &found.surface);
    found.distance = -found.surface.position[2];
    *fragment = found;
    return RESULT_OK;
}

/* The fill rule never gives a triangle the pixels on its greatest coordinate, which are outside its
 * box. */
static bool may_touch(const PixelRect *box, int x, int y)
{
    return x >= box->x0 && x <= box->x1 + 1 && y >= box->y0 && y <= box->y1 + 1;
}

static Result find_list(const Pass *pass, const Geometry *geometry, const PrimitiveList *list,
                        int x, int y, History *out)
{
    Result result = RESULT_OK;
    for (size_t i = 0; i < list->count && result == RESULT_OK; i++)
        if (may_touch(&list->items[i].box, x, y))
            result = find_one(pass, geometry, &list->items[i], x, y, out);
    return result;
}

/* ---- what the near and the far plane cut off ---- */

Result retrace_find_cut(const Pass *pass, const Geometry *geometry, AllTriangles *out)
{
    enum {
        NEAR_FAR = 16 | 32 /* clip_outcode */
    };
    *out = (AllTriangles){.geometry = geometry};
    uint32_t first = 0;
    for (uint32_t d = 0; d < pass->view.draw_count; d++) {
        const Draw *draw = &pass->view.draws[d];
        const Mesh *mesh = &pass->scene->meshes[draw->mesh];
        for (uint32_t t = 0; t < mesh->triangle_count; t++) {
            CutTriangle cut = {.id = draw->first_primitive + t, .draw = d};
            uint32_t outcode = 0;
            for (int i = 0; i < 3; i++) {
                cut.vertex[i] = first + mesh->index[3 * (size_t)t + (size_t)i];
                outcode |= geometry->vertices[cut.vertex[i]].outcode;
            }
            if (!(outcode & NEAR_FAR))
                continue;
            void *array = out->cut;
            Result result =
                memory_grow(&array, &out->cut_room, out->cut_count + 1, sizeof *out->cut);
            out->cut = array;
            if (result != RESULT_OK)
                return result;
            out->cut[out->cut_count++] = cut;
        }
        first += mesh->vertex_count;
    }
    return RESULT_OK;
}

/* Where the pixel's ray meets the triangle: its corners' weights, which sum to 1; false where it
 * does not, or behind the eye. ndc: of the pixel's centre. *front: before mirroring. */
static bool hit(const Vertex *const corners[3], const double ndc[2], double weight[3], bool *front)
{
    double u[3], v[3], sum = 0.0, w = 0.0;
    for (int i = 0; i < 3; i++) {
        const float *clip = corners[i]->clip;
        u[i] = (double)clip[0] - ndc[0] * (double)clip[3];
        v[i] = (double)clip[1] - ndc[1] * (double)clip[3];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        weight[i] = u[j] * v[k] - u[k] * v[j];
        sum += weight[i];
    }
    if (!(fabs(sum) > 0.0))
        return false;
    for (int i = 0; i < 3; i++) {
        weight[i] /= sum;
        if (!(weight[i] >= 0.0))
            return false;
        w += weight[i] * (double)corners[i]->clip[3];
    }
    *front = sum > 0.0;
    return w > 0.0;
}

static Result find_clipped(const Pass *pass, const AllTriangles *all, const CutTriangle *cut,
                           const double ndc[2], History *out)
{
    const Vertex *vertices = all->geometry->vertices;
    const Vertex *const corners[3] = {&vertices[cut->vertex[0]], &vertices[cut->vertex[1]],
                                      &vertices[cut->vertex[2]]};
    double weight[3], z = 0.0, w = 0.0;
    bool front;
    if (!hit(corners, ndc, weight, &front))
        return RESULT_OK;
    for (int i = 0; i < 3; i++) {
        z += weight[i] * (double)corners[i]->clip[2];
        w += weight[i] * (double)corners[i]->clip[3];
    }
    bool half = pass->desc->depth_range != DEPTH_RANGE_GL;
    if (z <= w && z >= (half ? 0.0 : -w))
        return RESULT_OK;
    HistoryFragment *fragment = history_add_fragment(out);
    if (!fragment)
        return RESULT_NO_MEMORY;
    fragment->primitive = cut->id;
    fragment->fate = HISTORY_CLIPPED;
    fragment->front = front != pass->view.draws[cut->draw].flipped;
    fragment->z = fragment->depth = half ? z / w : 0.5 * (z / w) + 0.5;
    fill_draw(pass, cut->draw, fragment);
    const Material *material = &pass->scene->materials[fragment->material];
    HistorySurface *surface = &fragment->surface;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            surface->position[i] += weight[k] * (double)corners[k]->position[i];
            surface->normal[i] += weight[k] * (double)corners[k]->normal[i];
        }
    retrace_copy(surface->base, material->base_color, 4);
    surface->roughness = (double)material->roughness;
    surface->metallic = (double)material->metallic;
    surface->occlusion = (double)material->occlusion;
    fragment->distance = -surface->position[2];
    return RESULT_OK;
}

Result retrace_find_fragments(const Pass *pass, const AllTriangles *all, int x, int y, History *out)
{
    const Geometry *geometry = all->geometry;
    const double ndc[2] = {(2.0 * x + 1.0) / pass->view.width - 1.0,
                           (2.0 * y + 1.0) / pass->view.height - 1.0};
    Result result = find_list(pass, geometry, &geometry->opaque, x, y, out);
    if (result == RESULT_OK)
        result = find_list(pass, geometry, &geometry->transparent, x, y, out);
    for (size_t i = 0; i < all->cut_count && result == RESULT_OK; i++)
        result = find_clipped(pass, all, &all->cut[i], ndc, out);
    return result;
}

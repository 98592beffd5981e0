#include "ref/pipeline/geometry.h"

#include "base/memory.h"
#include "number/op.h"
#include "ref/pipeline/setup.h"

#include <stdlib.h>

/* What one draw contributes; concatenated in draw order when all are done. */
typedef struct DrawOutput {
    size_t first_vertex; /* of its transformed mesh vertices in Geometry.vertices */
    Vertex *cut;         /* vertices that the clipper made */
    size_t cut_count, cut_capacity;
    Primitive *primitives; /* vertex indices ≥ mesh_vertices mean cut[index − mesh_vertices] */
    size_t primitive_count, primitive_capacity;
} DrawOutput;

typedef struct Build {
    const Scene *scene;
    const View *view;
    Viewport viewport;
    Geometry *geometry;
    DrawOutput *outputs;
    size_t mesh_vertices; /* over all draws */
} Build;

/* mat4·(v, 1): columns from first to last, the fourth term is the column itself. */
static void transform_point(const float m[16], const float v[3], int rows, float *out)
{
    for (int r = 0; r < rows; r++)
        out[r] = op_add(
            op_add(op_add(op_mul(m[r], v[0]), op_mul(m[4 + r], v[1])), op_mul(m[8 + r], v[2])),
            m[12 + r]);
}

static void transform_vertices(const Build *build, const Draw *draw, size_t first)
{
    const Mesh *mesh = &build->scene->meshes[draw->mesh];
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        Vertex *vertex = &build->geometry->vertices[first + i];
        transform_point(draw->model_view, &mesh->position[3 * (size_t)i], 3, vertex->position);
        transform_point(build->view->projection, vertex->position, 4, vertex->clip);
        const float *n = &mesh->normal[3 * (size_t)i], *m = draw->normal_matrix;
        for (int r = 0; r < 3; r++)
            vertex->normal[r] =
                op_add(op_add(op_mul(m[r], n[0]), op_mul(m[3 + r], n[1])), op_mul(m[6 + r], n[2]));
        for (int k = 0; k < 2; k++)
            vertex->uv[k] = mesh->uv ? mesh->uv[2 * (size_t)i + (size_t)k] : 0.0f;
        viewport_transform(&build->viewport, false, vertex);
        vertex->outcode = clip_outcode(&build->viewport, vertex);
    }
}

static Result emit(const Build *build, DrawOutput *output, const Vertex *const corners[3],
                   Primitive primitive)
{
    const Draw *draw = &build->view->draws[primitive.draw];
    Facing facing = setup_facing(corners, draw->flipped);
    if (facing == FACING_NONE || (facing == FACING_BACK && draw->cull_back))
        return RESULT_OK;
    primitive.box = setup_bounds(corners, build->view->width, build->view->height);
    primitive.swap = (facing == FACING_FRONT) != draw->flipped;
    if (primitive.box.x0 > primitive.box.x1 || primitive.box.y0 > primitive.box.y1)
        return RESULT_OK;
    Result result = memory_grow((void **)&output->primitives, &output->primitive_capacity,
                                output->primitive_count + 1, sizeof primitive);
    if (result == RESULT_OK)
        output->primitives[output->primitive_count++] = primitive;
    return result;
}

static Result emit_clipped(const Build *build, DrawOutput *output, const Vertex *const corners[3],
                           unsigned planes, const Primitive *whole)
{
    ClipVertex polygon[CLIP_VERTICES_MAX];
    int count = clip_triangle(&build->viewport, corners, planes, polygon);
    uint32_t index[CLIP_VERTICES_MAX];
    const Vertex *vertex[CLIP_VERTICES_MAX];
    for (int i = 0; i < count; i++) {
        if (polygon[i].source >= 0) {
            index[i] = whole->vertex[polygon[i].source];
            vertex[i] = corners[polygon[i].source];
            continue;
        }
        Result result = memory_grow((void **)&output->cut, &output->cut_capacity,
                                    output->cut_count + 1, sizeof *output->cut);
        if (result != RESULT_OK)
            return result;
        index[i] = (uint32_t)(build->mesh_vertices + output->cut_count);
        output->cut[output->cut_count++] = polygon[i].fresh;
        vertex[i] = &polygon[i].fresh;
    }
    for (int i = 2; i < count; i++) {
        Primitive piece = {
            .vertex = {index[i - 1], index[i], index[0]}, .id = whole->id, .draw = whole->draw};
        const Vertex *const piece_corners[3] = {vertex[i - 1], vertex[i], vertex[0]};
        Result result = emit(build, output, piece_corners, piece);
        if (result != RESULT_OK)
            return result;
    }
    return RESULT_OK;
}

static Result assemble(const Build *build, uint32_t draw_index, DrawOutput *output)
{
    const Draw *draw = &build->view->draws[draw_index];
    const Mesh *mesh = &build->scene->meshes[draw->mesh];
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        Primitive primitive = {.id = draw->first_primitive + t, .draw = draw_index};
        const Vertex *corners[3];
        unsigned any = 0, all = ~0u;
        for (int i = 0; i < 3; i++) {
            primitive.vertex[i] =
                (uint32_t)(output->first_vertex + mesh->index[3 * (size_t)t + (size_t)i]);
            corners[i] = &build->geometry->vertices[primitive.vertex[i]];
            any |= corners[i]->outcode;
            all &= corners[i]->outcode;
        }
        if (all)
            continue;
        Result result = any ? emit_clipped(build, output, corners, any, &primitive)
                            : emit(build, output, corners, primitive);
        if (result != RESULT_OK)
            return result;
    }
    return RESULT_OK;
}

static __attribute__((noinline)) Result process_draw(const Build *build, uint32_t index)
{
    DrawOutput *output = &build->outputs[index];
    transform_vertices(build, &build->view->draws[index], output->first_vertex);
    return assemble(build, index, output);
}

static Result draw_task(void *context, uint32_t index, int worker)
{
    (void)worker;
    uint32_t saved = op_enter();
    Result result = process_draw(context, index);
    op_leave(saved);
    return result;
}

/* Appends the draws' cut vertices to the vertex array and their primitives to the two lists. */
static Result concatenate(Build *build)
{
    Geometry *geometry = build->geometry;
    const View *view = build->view;
    size_t cut_total = 0;
    for (size_t i = 0; i < view->draw_count; i++) {
        cut_total += build->outputs[i].cut_count;
        PrimitiveList *list =
            view->draws[i].transparent ? &geometry->transparent : &geometry->opaque;
        list->count += build->outputs[i].primitive_count;
    }
    if (build->mesh_vertices + cut_total > UINT32_MAX)
        return result_fail(RESULT_UNSUPPORTED, "more than 2^32 − 1 vertices after clipping");
    Vertex *vertices =
        realloc(geometry->vertices, (build->mesh_vertices + cut_total + 1) * sizeof *vertices);
    geometry->opaque.items = memory_array(geometry->opaque.count, sizeof(Primitive));
    geometry->transparent.items = memory_array(geometry->transparent.count, sizeof(Primitive));
    if (vertices)
        geometry->vertices = vertices;
    if (!vertices || !geometry->opaque.items || !geometry->transparent.items)
        return result_fail(RESULT_NO_MEMORY, "out of memory: %zu vertices",
                           build->mesh_vertices + cut_total);

    geometry->vertex_count = build->mesh_vertices;
    geometry->opaque.count = geometry->transparent.count = 0;
    for (size_t i = 0; i < view->draw_count; i++) {
        const DrawOutput *output = &build->outputs[i];
        PrimitiveList *list =
            view->draws[i].transparent ? &geometry->transparent : &geometry->opaque;
        uint32_t shift = (uint32_t)(geometry->vertex_count - build->mesh_vertices);
        for (size_t p = 0; p < output->primitive_count; p++) {
            Primitive primitive = output->primitives[p];
            for (int k = 0; k < 3; k++)
                if (primitive.vertex[k] >= build->mesh_vertices)
                    primitive.vertex[k] += shift;
            list->items[list->count++] = primitive;
        }
        if (output->cut_count)
            memcpy(&geometry->vertices[geometry->vertex_count], output->cut,
                   output->cut_count * sizeof(Vertex));
        geometry->vertex_count += output->cut_count;
    }
    return RESULT_OK;
}

static Result allocate(Build *build)
{
    const View *view = build->view;
    build->outputs = memory_array(view->draw_count, sizeof *build->outputs);
    if (!build->outputs)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < view->draw_count; i++) {
        build->outputs[i].first_vertex = build->mesh_vertices;
        build->mesh_vertices += build->scene->meshes[view->draws[i].mesh].vertex_count;
    }
    if (build->mesh_vertices >= UINT32_MAX)
        return result_fail(RESULT_UNSUPPORTED, "more than 2^32 − 1 vertices");
    build->geometry->vertices = memory_array(build->mesh_vertices, sizeof(Vertex));
    return build->geometry->vertices ? RESULT_OK : RESULT_NO_MEMORY;
}

Result geometry_build(const Scene *scene, const View *view, bool fused, Pool *pool, Geometry *out)
{
    *out = (Geometry){0};
    Build build = {
        .scene = scene,
        .view = view,
        .viewport = viewport_make(view->width, view->height, view->depth_range, fused),
        .geometry = out,
    };
    Result result = allocate(&build);
    if (result == RESULT_OK)
        result = pool_run(pool, (uint32_t)view->draw_count, draw_task, &build);
    if (result == RESULT_OK)
        result = concatenate(&build);
    for (size_t i = 0; build.outputs && i < view->draw_count; i++) {
        free(build.outputs[i].cut);
        free(build.outputs[i].primitives);
    }
    free(build.outputs);
    if (result != RESULT_OK)
        geometry_free(out);
    return result;
}

void geometry_free(Geometry *geometry)
{
    free(geometry->vertices);
    free(geometry->opaque.items);
    free(geometry->transparent.items);
    *geometry = (Geometry){0};
}

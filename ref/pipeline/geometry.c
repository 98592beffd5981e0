#include "ref/pipeline/geometry.h"

#include "base/memory.h"
#include "number/op.h"
#include "ref/pipeline/setup.h"

#include <stdlib.h>

enum {
    CHUNK = 8192 /* vertices or triangles of a task */
};

/* Some vertices or triangles of one draw. */
typedef struct Chunk {
    uint32_t draw, first, count;
    size_t first_vertex; /* of the draw's transformed mesh vertices in Geometry.vertices */
} Chunk;

/* What one chunk of triangles contributes; concatenated in draw order when all are done. */
typedef struct ChunkOutput {
    Vertex *cut; /* vertices that the clipper made */
    size_t cut_count, cut_capacity;
    /* In Build.primitives, or in `grown` where clipping made more than there were triangles. Vertex
     * indices ≥ mesh_vertices mean cut[index − mesh_vertices]. */
    Primitive *primitives, *grown;
    size_t primitive_count, primitive_capacity, grown_capacity;
    size_t first_cut, first_primitive; /* where they go, in Geometry.vertices and the list */
    bool wide;                         /* as Geometry.wide */
} ChunkOutput;

typedef struct Build {
    const Scene *scene;
    const View *view;
    Viewport viewport;
    Geometry *geometry;
    Chunk *vertex_chunks, *triangle_chunks;
    ChunkOutput *outputs;  /* one per chunk of triangles */
    Primitive *primitives; /* room for one per triangle */
    size_t vertex_chunk_count, triangle_chunk_count;
    size_t mesh_vertices, triangles; /* over all draws */
    size_t vertex_capacity; /* room for those that clipping makes in all but unusual frames */
} Build;

/* mat4·(v, 1): columns from first to last, the fourth term is the column itself. */
static void transform_point(const float m[16], const float v[3], int rows, float *out)
{
    for (int r = 0; r < rows; r++)
        out[r] = op_add(
            op_add(op_add(op_mul(m[r], v[0]), op_mul(m[4 + r], v[1])), op_mul(m[8 + r], v[2])),
            m[12 + r]);
}

static __attribute__((noinline)) void transform_vertices(const Build *build, const Chunk *chunk)
{
    const Draw *draw = &build->view->draws[chunk->draw];
    const Mesh *mesh = &build->scene->meshes[draw->mesh];
    for (uint32_t i = chunk->first; i < chunk->first + chunk->count; i++) {
        Vertex *vertex = &build->geometry->vertices[chunk->first_vertex + i];
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

static Result make_room(ChunkOutput *output)
{
    bool moves = output->grown == NULL;
    Result result = memory_grow((void **)&output->grown, &output->grown_capacity,
                                output->primitive_count + 1, sizeof *output->grown);
    if (result != RESULT_OK)
        return result;
    if (moves && output->primitive_count > 0)
        memcpy(output->grown, output->primitives, output->primitive_count * sizeof *output->grown);
    output->primitives = output->grown;
    output->primitive_capacity = output->grown_capacity;
    return RESULT_OK;
}

static Result emit(const Build *build, ChunkOutput *output, const Vertex *const corners[3],
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
    if (output->primitive_count == output->primitive_capacity) {
        Result result = make_room(output);
        if (result != RESULT_OK)
            return result;
    }
    if (setup_is_wide(corners)) {
        output->wide = true;
        primitive.box = wide_bounds(primitive.box, build->view->width, build->view->height);
    }
    output->primitives[output->primitive_count++] = primitive;
    return RESULT_OK;
}

static Result emit_clipped(const Build *build, ChunkOutput *output, const Vertex *const corners[3],
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

static __attribute__((noinline)) Result assemble(const Build *build, const Chunk *chunk,
                                                 ChunkOutput *output)
{
    const Draw *draw = &build->view->draws[chunk->draw];
    const Mesh *mesh = &build->scene->meshes[draw->mesh];
    for (uint32_t t = chunk->first; t < chunk->first + chunk->count; t++) {
        Primitive primitive = {.id = draw->first_primitive + t, .draw = chunk->draw};
        const Vertex *corners[3];
        unsigned any = 0, all = ~0u;
        for (int i = 0; i < 3; i++) {
            primitive.vertex[i] =
                (uint32_t)(chunk->first_vertex + mesh->index[3 * (size_t)t + (size_t)i]);
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

static Result vertex_task(void *context, uint32_t index, int worker)
{
    (void)worker;
    const Build *build = context;
    uint32_t saved = op_enter();
    transform_vertices(build, &build->vertex_chunks[index]);
    op_leave(saved);
    return RESULT_OK;
}

static Result triangle_task(void *context, uint32_t index, int worker)
{
    (void)worker;
    const Build *build = context;
    uint32_t saved = op_enter();
    Result result = assemble(build, &build->triangle_chunks[index], &build->outputs[index]);
    op_leave(saved);
    return result;
}

static PrimitiveList *list_of(const Build *build, uint32_t chunk)
{
    bool transparent = build->view->draws[build->triangle_chunks[chunk].draw].transparent;
    return transparent ? &build->geometry->transparent : &build->geometry->opaque;
}

/* Appends a chunk's cut vertices to the vertex array and its primitives to its list. */
static Result copy_task(void *context, uint32_t index, int worker)
{
    (void)worker;
    const Build *build = context;
    ChunkOutput *output = &build->outputs[index];
    Primitive *items = list_of(build, index)->items + output->first_primitive;
    uint32_t shift = (uint32_t)(output->first_cut - build->mesh_vertices);
    for (size_t p = 0; p < output->primitive_count; p++) {
        items[p] = output->primitives[p];
        for (int k = 0; k < 3; k++)
            if (items[p].vertex[k] >= build->mesh_vertices)
                items[p].vertex[k] += shift;
    }
    if (output->cut_count)
        memcpy(&build->geometry->vertices[output->first_cut], output->cut,
               output->cut_count * sizeof(Vertex));
    return RESULT_OK;
}

/* Decides where every chunk's output goes, and makes room for it. */
static Result place(Build *build)
{
    Geometry *geometry = build->geometry;
    geometry->vertex_count = build->mesh_vertices;
    for (size_t i = 0; i < build->triangle_chunk_count; i++) {
        ChunkOutput *output = &build->outputs[i];
        PrimitiveList *list = list_of(build, (uint32_t)i);
        output->first_cut = geometry->vertex_count;
        output->first_primitive = list->count;
        geometry->vertex_count += output->cut_count;
        list->count += output->primitive_count;
        geometry->wide |= output->wide;
    }
    if (geometry->vertex_count > UINT32_MAX)
        return result_fail(RESULT_UNSUPPORTED, "more than 2^32 − 1 vertices after clipping");
    if (geometry->opaque.count > INT32_MAX || geometry->transparent.count > INT32_MAX)
        return result_fail(RESULT_UNSUPPORTED, "more than 2^31 − 1 triangles after clipping");
    geometry->opaque.items = memory_array(geometry->opaque.count, sizeof(Primitive));
    geometry->transparent.items = memory_array(geometry->transparent.count, sizeof(Primitive));
    Vertex *vertices = geometry->vertices;
    if (geometry->vertex_count > build->vertex_capacity)
        vertices = realloc(vertices, geometry->vertex_count * sizeof *vertices);
    if (vertices)
        geometry->vertices = vertices;
    if (!vertices || !geometry->opaque.items || !geometry->transparent.items)
        return result_fail(RESULT_NO_MEMORY, "out of memory: %zu vertices", geometry->vertex_count);
    return RESULT_OK;
}

/* Appends the chunks of `count` vertices or triangles to chunks; NULL: only counts them. */
static void add_chunks(uint32_t draw, uint32_t count, size_t first_vertex, Chunk *chunks,
                       size_t *chunk_count)
{
    uint32_t taken;
    for (uint32_t first = 0; first < count; first += taken) {
        taken = count - first < CHUNK ? count - first : CHUNK;
        if (chunks)
            chunks[*chunk_count] = (Chunk){
                .draw = draw,
                .first = first,
                .count = taken,
                .first_vertex = first_vertex,
            };
        ++*chunk_count;
    }
}

/* A chunk's part of the room for primitives: as much as it has triangles. */
static void share_room(Build *build)
{
    size_t first = 0;
    for (size_t i = 0; i < build->triangle_chunk_count; i++) {
        build->outputs[i].primitives = build->primitives + first;
        build->outputs[i].primitive_capacity = build->triangle_chunks[i].count;
        first += build->triangle_chunks[i].count;
    }
}

static void cut_into_chunks(Build *build)
{
    const View *view = build->view;
    build->vertex_chunk_count = build->triangle_chunk_count = 0;
    build->mesh_vertices = build->triangles = 0;
    for (size_t i = 0; i < view->draw_count; i++) {
        const Mesh *mesh = &build->scene->meshes[view->draws[i].mesh];
        add_chunks((uint32_t)i, mesh->vertex_count, build->mesh_vertices, build->vertex_chunks,
                   &build->vertex_chunk_count);
        add_chunks((uint32_t)i, mesh->triangle_count, build->mesh_vertices, build->triangle_chunks,
                   &build->triangle_chunk_count);
        build->mesh_vertices += mesh->vertex_count;
        build->triangles += mesh->triangle_count;
    }
}

static Result allocate(Build *build)
{
    cut_into_chunks(build);
    if (build->mesh_vertices >= UINT32_MAX)
        return result_fail(RESULT_UNSUPPORTED, "more than 2^32 − 1 vertices");
    build->vertex_chunks = memory_array(build->vertex_chunk_count, sizeof *build->vertex_chunks);
    build->triangle_chunks =
        memory_array(build->triangle_chunk_count, sizeof *build->triangle_chunks);
    build->outputs = memory_array(build->triangle_chunk_count, sizeof *build->outputs);
    build->primitives = memory_array(build->triangles, sizeof *build->primitives);
    build->vertex_capacity = build->mesh_vertices + build->mesh_vertices / 4 + CHUNK;
    build->geometry->vertices = memory_array(build->vertex_capacity, sizeof(Vertex));
    if (!build->vertex_chunks || !build->triangle_chunks || !build->outputs || !build->primitives ||
        !build->geometry->vertices)
        return RESULT_NO_MEMORY;
    cut_into_chunks(build);
    share_room(build);
    return RESULT_OK;
}

static void free_chunks(Build *build)
{
    for (size_t i = 0; build->outputs && i < build->triangle_chunk_count; i++) {
        free(build->outputs[i].cut);
        free(build->outputs[i].grown);
    }
    free(build->outputs);
    free(build->primitives);
    free(build->vertex_chunks);
    free(build->triangle_chunks);
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
    uint32_t triangle_chunks = (uint32_t)build.triangle_chunk_count;
    if (result == RESULT_OK)
        result = pool_run(pool, (uint32_t)build.vertex_chunk_count, vertex_task, &build);
    if (result == RESULT_OK)
        result = pool_run(pool, triangle_chunks, triangle_task, &build);
    if (result == RESULT_OK)
        result = place(&build);
    if (result == RESULT_OK)
        result = pool_run(pool, triangle_chunks, copy_task, &build);
    free_chunks(&build);
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

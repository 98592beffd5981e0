#include "upload.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

enum {
    LIGHT_FLOATS = 12
};

/* Sums the meshes and fills their ranges. */
static Result lay_out(const Scene *scene, Meshes *out, size_t *vertex_count, size_t *index_count)
{
    *vertex_count = *index_count = 0;
    for (size_t i = 0; i < scene->mesh_count; i++) {
        const Mesh *mesh = &scene->meshes[i];
        if (*vertex_count + mesh->vertex_count > INT32_MAX ||
            *index_count + 3 * (size_t)mesh->triangle_count > INT32_MAX)
            return result_fail(RESULT_UNSUPPORTED,
                               "mesh %zu: expected at most 2^31 - 1 vertices and indices in all",
                               i);
        out->ranges[i] = (MeshRange){
            .first_index = (uint32_t)*index_count,
            .index_count = 3 * mesh->triangle_count,
            .base_vertex = (int32_t)*vertex_count,
        };
        *vertex_count += mesh->vertex_count;
        *index_count += 3 * (size_t)mesh->triangle_count;
    }
    return RESULT_OK;
}

/* Positions of all meshes first, then normals. A buffer of no bytes is not allowed: at least one
 * vertex is reserved. */
static void fill_buffers(const Scene *scene, const Meshes *meshes, size_t vertex_count)
{
    GLintptr vec3 = 3 * sizeof(float);
    for (size_t i = 0; i < scene->mesh_count; i++) {
        const Mesh *mesh = &scene->meshes[i];
        const MeshRange *range = &meshes->ranges[i];
        GLintptr at = range->base_vertex * vec3;
        if (mesh->vertex_count > 0) {
            GLsizeiptr bytes = (GLsizeiptr)mesh->vertex_count * vec3;
            gl.NamedBufferSubData(meshes->vertices, at, bytes, mesh->position);
            gl.NamedBufferSubData(meshes->vertices, (GLintptr)vertex_count * vec3 + at, bytes,
                                  mesh->normal);
        }
        if (range->index_count > 0)
            gl.NamedBufferSubData(
                meshes->indices, (GLintptr)range->first_index * (GLintptr)sizeof(uint32_t),
                (GLsizeiptr)range->index_count * (GLsizeiptr)sizeof(uint32_t), mesh->index);
    }
}

static void make_vertex_array(Meshes *meshes, size_t vertex_count)
{
    GLsizei stride = 3 * sizeof(float);
    gl.CreateVertexArrays(1, &meshes->vertex_array);
    for (GLuint i = 0; i < 2; i++) {
        gl.VertexArrayVertexBuffer(meshes->vertex_array, i, meshes->vertices,
                                   (GLintptr)(i * vertex_count) * stride, stride);
        gl.EnableVertexArrayAttrib(meshes->vertex_array, i);
        gl.VertexArrayAttribFormat(meshes->vertex_array, i, 3, GL_FLOAT, GL_FALSE, 0);
        gl.VertexArrayAttribBinding(meshes->vertex_array, i, i);
    }
    gl.VertexArrayElementBuffer(meshes->vertex_array, meshes->indices);
}

static GLuint make_buffer(size_t bytes)
{
    GLuint buffer;
    gl.CreateBuffers(1, &buffer);
    gl.NamedBufferStorage(buffer, (GLsizeiptr)(bytes ? bytes : 1), NULL, GL_DYNAMIC_STORAGE_BIT);
    return buffer;
}

Result upload_meshes(Context *context, const Scene *scene, Meshes *out)
{
    *out = (Meshes){0};
    out->ranges = memory_array(scene->mesh_count, sizeof *out->ranges);
    if (!out->ranges)
        return RESULT_NO_MEMORY;
    size_t vertex_count, index_count;
    Result result = lay_out(scene, out, &vertex_count, &index_count);
    if (result == RESULT_OK) {
        size_t vertex_bytes = vertex_count * 6 * sizeof(float);
        size_t index_bytes = index_count * sizeof(uint32_t);
        out->bytes = vertex_bytes + index_bytes;
        out->vertices = make_buffer(vertex_bytes);
        out->indices = make_buffer(index_bytes);
        fill_buffers(scene, out, vertex_count);
        make_vertex_array(out, vertex_count);
        result = context_check(context, "mesh upload");
    }
    if (result != RESULT_OK)
        upload_free_meshes(out);
    return result;
}

void upload_free_meshes(Meshes *meshes)
{
    gl.DeleteVertexArrays(1, &meshes->vertex_array);
    gl.DeleteBuffers(1, &meshes->vertices);
    gl.DeleteBuffers(1, &meshes->indices);
    free(meshes->ranges);
    *meshes = (Meshes){0};
}

Result upload_lights(Context *context, const View *view, LightBuffer *out)
{
    *out = (LightBuffer){.bytes = view->light_count * LIGHT_FLOATS * sizeof(float)};
    if (view->light_count == 0)
        return RESULT_OK;
    const ContextLimits *limits = context_limits(context);
    out->storage = out->bytes > (size_t)limits->uniform_block;
    if (out->storage && out->bytes > (size_t)limits->storage_block)
        return result_fail(RESULT_UNSUPPORTED, "%zu lights: the OpenGL driver holds %zu",
                           view->light_count,
                           (size_t)limits->storage_block / (LIGHT_FLOATS * sizeof(float)));
    float *packed = memory_array(view->light_count, LIGHT_FLOATS * sizeof(float));
    if (!packed)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < view->light_count; i++) {
        const ViewLight *light = &view->lights[i];
        memcpy(packed + i * LIGHT_FLOATS, light->position, sizeof light->position);
        memcpy(packed + i * LIGHT_FLOATS + 4, light->color, sizeof light->color);
        memcpy(packed + i * LIGHT_FLOATS + 8, light->attenuation, sizeof light->attenuation);
    }
    out->buffer = make_buffer(out->bytes);
    gl.NamedBufferSubData(out->buffer, 0, (GLsizeiptr)out->bytes, packed);
    free(packed);
    gl.BindBufferBase(out->storage ? GL_SHADER_STORAGE_BUFFER : GL_UNIFORM_BUFFER, 0, out->buffer);
    Result result = context_check(context, "light upload");
    if (result != RESULT_OK)
        upload_free_lights(out);
    return result;
}

void upload_free_lights(LightBuffer *lights)
{
    gl.DeleteBuffers(1, &lights->buffer);
    *lights = (LightBuffer){0};
}

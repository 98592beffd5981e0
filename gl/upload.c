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

/* A vertex attribute, one array for all meshes. */
typedef struct Attribute {
    GLint components;
    GLintptr at; /* bytes from the start of the vertex buffer */
} Attribute;

enum {
    ATTRIBUTES = 3
};

/* Positions of all meshes first, then normals, then uvs. */
static size_t lay_out_attributes(size_t vertex_count, const Needs *needs, Attribute out[ATTRIBUTES])
{
    bool textured =
        needs_has(needs, NEED_BASE_COLOR_TEXTURE) || needs_has(needs, NEED_MATERIAL_TEXTURE);
    const GLint components[ATTRIBUTES] = {3, needs_has(needs, NEED_NORMAL) ? 3 : 0,
                                          textured ? 2 : 0};
    size_t at = 0;
    for (int i = 0; i < ATTRIBUTES; i++) {
        out[i] = (Attribute){components[i], (GLintptr)at};
        at += vertex_count * (size_t)out[i].components * sizeof(float);
    }
    return at;
}

/* What a mesh lacks stays as it is: 0. */
static void fill_buffers(const Scene *scene, const Meshes *meshes,
                         const Attribute attributes[ATTRIBUTES])
{
    for (size_t i = 0; i < scene->mesh_count; i++) {
        const Mesh *mesh = &scene->meshes[i];
        const MeshRange *range = &meshes->ranges[i];
        const float *const values[ATTRIBUTES] = {mesh->position, mesh->normal, mesh->uv};
        for (int k = 0; k < ATTRIBUTES; k++) {
            GLintptr vertex = attributes[k].components * (GLintptr)sizeof(float);
            if (vertex > 0 && values[k] && mesh->vertex_count > 0)
                gl.NamedBufferSubData(meshes->vertices,
                                      attributes[k].at + range->base_vertex * vertex,
                                      (GLsizeiptr)mesh->vertex_count * vertex, values[k]);
        }
        if (range->index_count > 0)
            gl.NamedBufferSubData(
                meshes->indices, (GLintptr)range->first_index * (GLintptr)sizeof(uint32_t),
                (GLsizeiptr)range->index_count * (GLsizeiptr)sizeof(uint32_t), mesh->index);
    }
}

static void make_vertex_array(Meshes *meshes, const Attribute attributes[ATTRIBUTES])
{
    gl.CreateVertexArrays(1, &meshes->vertex_array);
    for (GLuint i = 0; i < ATTRIBUTES; i++) {
        GLint components = attributes[i].components;
        if (components == 0)
            continue;
        gl.VertexArrayVertexBuffer(meshes->vertex_array, i, meshes->vertices, attributes[i].at,
                                   components * (GLsizei)sizeof(float));
        gl.EnableVertexArrayAttrib(meshes->vertex_array, i);
        gl.VertexArrayAttribFormat(meshes->vertex_array, i, components, GL_FLOAT, GL_FALSE, 0);
        gl.VertexArrayAttribBinding(meshes->vertex_array, i, i);
    }
    gl.VertexArrayElementBuffer(meshes->vertex_array, meshes->indices);
}

/* Zeroed. A buffer of no bytes is not allowed. */
static GLuint make_buffer(size_t bytes)
{
    GLuint buffer;
    gl.CreateBuffers(1, &buffer);
    gl.NamedBufferStorage(buffer, (GLsizeiptr)(bytes ? bytes : 1), NULL, GL_DYNAMIC_STORAGE_BIT);
    gl.ClearNamedBufferData(buffer, GL_R8, GL_RED, GL_UNSIGNED_BYTE, NULL);
    return buffer;
}

Result upload_meshes(Context *context, const Scene *scene, const Needs *needs, Meshes *out)
{
    *out = (Meshes){0};
    out->ranges = memory_array(scene->mesh_count, sizeof *out->ranges);
    if (!out->ranges)
        return RESULT_NO_MEMORY;
    size_t vertex_count, index_count;
    Result result = lay_out(scene, out, &vertex_count, &index_count);
    if (result == RESULT_OK) {
        Attribute attributes[ATTRIBUTES];
        size_t vertex_bytes = lay_out_attributes(vertex_count, needs, attributes);
        size_t index_bytes = index_count * sizeof(uint32_t);
        out->bytes = vertex_bytes + index_bytes;
        out->vertices = make_buffer(vertex_bytes);
        out->indices = make_buffer(index_bytes);
        fill_buffers(scene, out, attributes);
        make_vertex_array(out, attributes);
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
        packed[i * LIGHT_FLOATS + 11] = light->inverse_range2;
        out->ranges |= light->inverse_range2 > 0.0f;
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

static Result check_textures(const Context *context, const Scene *scene, const bool *wanted,
                             const RenderDesc *desc, size_t used, size_t *bytes)
{
    uint32_t side = (uint32_t)context_limits(context)->texture_size;
    for (size_t i = 0; i < scene->texture_count; i++) {
        const Texture *texture = &scene->textures[i];
        if (texture->width > side || texture->height > side)
            return result_fail(RESULT_BAD_INPUT,
                               "texture %zu: %u×%u texels: the OpenGL driver allows %u a side", i,
                               texture->width, texture->height, side);
        if (wanted[i])
            *bytes += (size_t)texture->width * texture->height * 4 * sizeof(float);
    }
    size_t most = desc->max_memory ? desc->max_memory : RENDER_MEMORY_DEFAULT;
    if (*bytes > 0 && (used > most || *bytes > most - used))
        return result_fail(RESULT_NO_MEMORY,
                           "gl: buffers and textures need %zu KiB, the limit is %zu KiB "
                           "(--max-memory)",
                           (used + *bytes) >> 10, most >> 10);
    return RESULT_OK;
}

Result upload_textures(Context *context, const Scene *scene, const bool *wanted,
                       const RenderDesc *desc, size_t used, Textures *out)
{
    *out = (Textures){0};
    Result result = check_textures(context, scene, wanted, desc, used, &out->bytes);
    if (result != RESULT_OK || scene->texture_count == 0)
        return result;
    out->names = memory_array(scene->texture_count, sizeof *out->names);
    if (!out->names)
        return RESULT_NO_MEMORY;
    out->count = scene->texture_count;
    for (size_t i = 0; i < out->count; i++) {
        if (!wanted[i])
            continue;
        gl.CreateTextures(GL_TEXTURE_2D, 1, &out->names[i]);
        const Texture *texture = &scene->textures[i];
        GLsizei width = (GLsizei)texture->width, height = (GLsizei)texture->height;
        gl.TextureStorage2D(out->names[i], 1, GL_RGBA32F, width, height);
        gl.TextureSubImage2D(out->names[i], 0, 0, 0, width, height, GL_RGBA, GL_FLOAT,
                             texture->texels);
        gl.TextureParameteri(out->names[i], GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        gl.TextureParameteri(out->names[i], GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
    result = context_check(context, "texture upload");
    if (result != RESULT_OK)
        upload_free_textures(out);
    return result;
}

void upload_free_textures(Textures *textures)
{
    if (textures->names)
        gl.DeleteTextures((GLsizei)textures->count, textures->names);
    free(textures->names);
    *textures = (Textures){0};
}

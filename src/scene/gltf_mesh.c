#include "scene/gltf_mesh.h"

#include "base/memory.h"
#include "scene/shapes.h"

#include <assimp/mesh.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static Result check_vectors(const struct aiVector3D *vectors, unsigned count, const char *what,
                            const char *label)
{
    for (unsigned i = 0; i < count; i++)
        if (!isfinite(vectors[i].x) || !isfinite(vectors[i].y) || !isfinite(vectors[i].z))
            return result_fail(RESULT_BAD_INPUT, "%s: %s %u is not finite", label, what, i);
    return RESULT_OK;
}

static Result check(const struct aiMesh *from, size_t triangles, const float *uv, const char *label)
{
    if (!from->mVertices || from->mNumVertices == 0 || from->mNumFaces == 0)
        return result_fail(RESULT_BAD_INPUT, "%s: no vertices or no triangles", label);
    if (from->mNumFaces != triangles)
        return result_fail(RESULT_BAD_INPUT,
                           "%s: %zu of %zu triangles have an index out of range, expected below %u",
                           label, triangles - from->mNumFaces, triangles, from->mNumVertices);
    for (unsigned f = 0; f < from->mNumFaces; f++)
        for (unsigned k = 0; k < from->mFaces[f].mNumIndices; k++)
            if (from->mFaces[f].mNumIndices != 3 ||
                from->mFaces[f].mIndices[k] >= from->mNumVertices)
                return result_fail(RESULT_BAD_INPUT, "%s: face %u is no triangle of its vertices",
                                   label, f);
    Result result = check_vectors(from->mVertices, from->mNumVertices, "position", label);
    if (!result && from->mNormals)
        result = check_vectors(from->mNormals, from->mNumVertices, "normal", label);
    for (unsigned i = 0; !result && uv && i < from->mNumVertices; i++)
        if (!isfinite(uv[2 * (size_t)i]) || !isfinite(uv[2 * (size_t)i + 1]))
            result =
                result_fail(RESULT_BAD_INPUT, "%s: texture coordinate %u is not finite", label, i);
    return result;
}

static Result add_uv_array(const float *uv, Mesh *out)
{
    if (!uv)
        return RESULT_OK;
    out->uv = memory_array((size_t)out->vertex_count * 2, sizeof *out->uv);
    return out->uv ? RESULT_OK : RESULT_NO_MEMORY;
}

static void copy_vertex(const struct aiMesh *from, const float *uv, size_t source, Mesh *out,
                        size_t vertex)
{
    memcpy(out->position + 3 * vertex, &from->mVertices[source], 3 * sizeof(float));
    if (from->mNormals)
        memcpy(out->normal + 3 * vertex, &from->mNormals[source], 3 * sizeof(float));
    if (out->uv)
        memcpy(out->uv + 2 * vertex, uv + 2 * source, 2 * sizeof(float));
}

/* map: UINT32_MAX for every vertex of Assimp's. */
static Result convert_shared(const struct aiMesh *from, const float *uv, uint32_t *map, Mesh *out)
{
    uint32_t used = 0;
    for (unsigned f = 0; f < from->mNumFaces; f++)
        for (int k = 0; k < 3; k++)
            map[from->mFaces[f].mIndices[k]] = 0;
    for (unsigned v = 0; v < from->mNumVertices; v++)
        if (map[v] == 0)
            map[v] = used++;
    Result result = shapes_allocate(used, from->mNumFaces, out);
    if (!result)
        result = add_uv_array(uv, out);
    if (result)
        return result;
    for (unsigned v = 0; v < from->mNumVertices; v++)
        if (map[v] != UINT32_MAX)
            copy_vertex(from, uv, v, out, map[v]);
    for (unsigned f = 0; f < from->mNumFaces; f++)
        for (int k = 0; k < 3; k++)
            out->index[3 * (size_t)f + k] = map[from->mFaces[f].mIndices[k]];
    return RESULT_OK;
}

static void flat_normal(const float *p, float out[3])
{
    double u[3], v[3], n[3];
    for (int i = 0; i < 3; i++) {
        u[i] = (double)p[3 + i] - (double)p[i];
        v[i] = (double)p[6 + i] - (double)p[i];
    }
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
    double length = sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
    for (int i = 0; i < 3; i++)
        out[i] = length > 0.0 && isfinite(length) ? (float)(n[i] / length) : (i == 2 ? 1.0f : 0.0f);
}

static Result convert_flat(const struct aiMesh *from, const float *uv, Mesh *out)
{
    if (from->mNumFaces > UINT32_MAX / 3)
        return result_fail(RESULT_UNSUPPORTED, "too many triangles without normals");
    Result result = shapes_allocate(3 * from->mNumFaces, from->mNumFaces, out);
    if (!result)
        result = add_uv_array(uv, out);
    if (result)
        return result;
    for (size_t f = 0; f < from->mNumFaces; f++) {
        for (size_t k = 0; k < 3; k++) {
            copy_vertex(from, uv, from->mFaces[f].mIndices[k], out, 3 * f + k);
            out->index[3 * f + k] = (uint32_t)(3 * f + k);
        }
        float normal[3];
        flat_normal(out->position + 9 * f, normal);
        for (size_t k = 0; k < 3; k++)
            memcpy(out->normal + 9 * f + 3 * k, normal, sizeof normal);
    }
    return RESULT_OK;
}

Result gltf_mesh_convert(const struct aiMesh *from, size_t triangles, const float *uv,
                         const char *label, Mesh *out)
{
    *out = (Mesh){0};
    Result result = check(from, triangles, uv, label);
    if (result)
        return result;
    if (from->mNormals) {
        uint32_t *map = memory_array(from->mNumVertices, sizeof *map);
        if (!map)
            return RESULT_NO_MEMORY;
        memset(map, 0xff, from->mNumVertices * sizeof *map);
        result = convert_shared(from, uv, map, out);
        free(map);
    } else {
        result = convert_flat(from, uv, out);
    }
    if (result)
        shapes_free(out);
    return result;
}

#include "scene/hard_kit.h"

#include "base/memory.h"
#include "scene/shapes.h"

#include <math.h>
#include <stdlib.h>

Builder hard_kit_begin(const char *name, double near, double far)
{
    Builder builder = builder_begin(name);
    for (int i = 0; i < 3; i++)
        builder.scene.ambient[i] = 1.0f;
    pieces_look(&builder, &(Gaze){"default",
                                  {0.0, 0.0, 0.0},
                                  {0.0, 0.0, -1.0},
                                  PIECES_PI / 2.0,
                                  pieces_float(near),
                                  isinf(far) ? far : pieces_float(far)});
    /* A file without any light is given the default ones. */
    pieces_lamp(&builder, 0.0, 0.0, 1.0, 0.0f, 0.0f, 0.0f);
    return builder;
}

void hard_kit_lamps(Builder *builder)
{
    for (int i = 0; i < 3; i++)
        builder->scene.ambient[i] = 0.25f;
    pieces_lamp(builder, 30.0, 40.0, 20.0, 2.0f, 2.0f, 2.0f);
    pieces_lamp(builder, -40.0, 10.0, 10.0, 0.5f, 0.6f, 0.75f);
}

static void set_corner(Mesh *mesh, size_t vertex, const double position[3], const double normal[3])
{
    for (size_t k = 0; k < 3; k++) {
        mesh->position[3 * vertex + k] = (float)position[k];
        mesh->normal[3 * vertex + k] = (float)normal[k];
    }
}

/* The two triangles of the corners first … first + 3. */
static void set_quad(Mesh *mesh, size_t quad, uint32_t first)
{
    static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
    for (size_t k = 0; k < 6; k++)
        mesh->index[6 * quad + k] = first + corners[k];
}

uint32_t hard_kit_quads(Builder *builder, const HardQuad *quads, size_t count)
{
    Mesh mesh;
    Result made = shapes_allocate((uint32_t)(4 * count), (uint32_t)(2 * count), &mesh);
    for (size_t i = 0; made == RESULT_OK && i < count; i++) {
        const HardQuad *q = &quads[i];
        const double corners[4][3] = {
            {q->x0, q->y0, q->z}, {q->x1, q->y0, q->z}, {q->x1, q->y1, q->z}, {q->x0, q->y1, q->z}};
        for (size_t k = 0; k < 4; k++)
            set_corner(&mesh, 4 * i + k, corners[k], (const double[3]){0.0, 0.0, 1.0});
        set_quad(&mesh, i, (uint32_t)(4 * i));
    }
    return builder_mesh(builder, made, &mesh);
}

static void plane_normal(const HardTriangle corners, double out[3])
{
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = corners[1][k] - corners[0][k];
        v[k] = corners[2][k] - corners[0][k];
    }
    for (int k = 0; k < 3; k++) {
        int b = (k + 1) % 3, c = (k + 2) % 3;
        out[k] = u[b] * v[c] - u[c] * v[b];
    }
    double length = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    for (int k = 0; k < 3; k++)
        out[k] = length > 0.0 ? out[k] / length : k == 2;
}

uint32_t hard_kit_triangles(Builder *builder, const HardTriangle *triangles, size_t count)
{
    Mesh mesh;
    Result made = shapes_allocate((uint32_t)(3 * count), (uint32_t)count, &mesh);
    for (size_t i = 0; made == RESULT_OK && i < count; i++) {
        double normal[3];
        plane_normal(triangles[i], normal);
        for (size_t k = 0; k < 3; k++) {
            set_corner(&mesh, 3 * i + k, triangles[i][k], normal);
            mesh.index[3 * i + k] = (uint32_t)(3 * i + k);
        }
    }
    return builder_mesh(builder, made, &mesh);
}

uint32_t hard_kit_patch(Builder *builder, const double corners[4][3], const double normals[4][3])
{
    Mesh mesh;
    Result made = shapes_allocate(4, 2, &mesh);
    for (size_t k = 0; made == RESULT_OK && k < 4; k++)
        set_corner(&mesh, k, corners[k], normals[k]);
    if (made == RESULT_OK)
        set_quad(&mesh, 0, 0);
    return builder_mesh(builder, made, &mesh);
}

HardQuad hard_kit_pane(double z, double part)
{
    double half = fabs(z) * part;
    return (HardQuad){-half, -half, half, half, z};
}

uint32_t hard_kit_glass(Builder *builder, float r, float g, float b, float a)
{
    const Material material = {.base_color = {r, g, b, a},
                               .roughness = 0.5f,
                               .occlusion = 1.0f,
                               .alpha_mode = ALPHA_BLEND,
                               .alpha_cutoff = 0.5f,
                               .double_sided = true};
    return builder_material(builder, &material, "glass");
}

uint32_t hard_kit_tint(Builder *builder, int color, float a)
{
    static const float colors[8][3] = {
        {0.9f, 0.2f, 0.15f}, {0.2f, 0.75f, 0.3f},  {0.2f, 0.35f, 0.9f},  {0.95f, 0.8f, 0.2f},
        {0.15f, 0.7f, 0.8f}, {0.65f, 0.3f, 0.85f}, {0.95f, 0.55f, 0.1f}, {0.8f, 0.8f, 0.8f}};
    const float *c = colors[color % 8];
    return hard_kit_glass(builder, c[0], c[1], c[2], a);
}

uint32_t hard_kit_wall(Builder *builder, float gray)
{
    return pieces_surface(builder, "wall", (const float[4]){gray, gray, gray, 1.0f}, 0.9f, 0.0f);
}

void hard_kit_put(Builder *builder, uint32_t mesh, uint32_t material)
{
    pieces_place_at(builder, "", mesh, material, 0.0, 0.0, 0.0);
}

/* Layer k has colour k mod colors; within a colour the layers are drawn by multiples of a number
 * that has no factor in common with how many there are. */
void hard_kit_stack(Builder *builder, int count, double first, double step, int colors, float a)
{
    HardQuad *quads = memory_array((size_t)count, sizeof *quads);
    if (!quads) {
        builder->result = RESULT_NO_MEMORY;
        return;
    }
    for (int color = 0; color < colors; color++) {
        int layers = (count - color + colors - 1) / colors;
        for (int i = 0; i < layers; i++) {
            int layer = (i * 37 + 11) % layers * colors + color;
            quads[i] = hard_kit_pane(-pieces_float(first + step * layer), 2.0 / 3.0);
        }
        uint32_t mesh = hard_kit_quads(builder, quads, (size_t)layers);
        hard_kit_put(builder, mesh, hard_kit_tint(builder, color, a));
    }
    free(quads);
}

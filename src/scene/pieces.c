#include "scene/pieces.h"

#include <string.h>

/* (The build keeps gcc from leaving the rounding out.) */
double pieces_float(double x)
{
    return (double)(float)x;
}

static Matrix rounded(const Matrix *a)
{
    Matrix out;
    for (int i = 0; i < 16; i++)
        out.m[i] = pieces_float(a->m[i]);
    return out;
}

void pieces_place(Builder *builder, const char *name, uint32_t mesh, uint32_t material,
                  const Matrix *world)
{
    Instance instance = {.mesh = mesh, .material = material, .world = rounded(world)};
    builder_instance(builder, &instance, name);
}

void pieces_place_at(Builder *builder, const char *name, uint32_t mesh, uint32_t material, double x,
                     double y, double z)
{
    Matrix world = matrix_translate(x, y, z);
    pieces_place(builder, name, mesh, material, &world);
}

uint32_t pieces_surface(Builder *builder, const char *name, const float color[4], float roughness,
                        float metallic)
{
    bool transparent = color[3] < 1.0f;
    Material material = {.roughness = roughness,
                         .metallic = metallic,
                         .occlusion = 1.0f,
                         .alpha_mode = transparent ? ALPHA_BLEND : ALPHA_OPAQUE,
                         .alpha_cutoff = 0.5f,
                         .double_sided = transparent};
    memcpy(material.base_color, color, sizeof material.base_color);
    return builder_material(builder, &material, name);
}

void pieces_look(Builder *builder, const Gaze *gaze)
{
    Matrix world, view = matrix_look_at(gaze->eye, gaze->target, (const double[3]){0.0, 1.0, 0.0});
    Camera camera = {.yfov = gaze->yfov, .near = gaze->near, .far = gaze->far};
    matrix_invert_affine(&view, &world);
    camera.world = rounded(&world);
    builder_camera(builder, &camera, gaze->name);
}

void pieces_lamp(Builder *builder, double x, double y, double z, float r, float g, float b)
{
    Light light = {.position = {x, y, z}, .color = {r, g, b}, .attenuation = {1.0f, 0.0f, 0.0f}};
    builder_light(builder, &light);
}

Matrix pieces_lying(double x, double y, double z)
{
    return (Matrix){{[0] = 1.0, [6] = -1.0, [9] = 1.0, [12] = x, [13] = y, [14] = z, [15] = 1.0}};
}

/* Random triangle soups as scenes, made by a seed: opaque, masked and transparent materials, half
 * of the soups with textures, mirrored instances, coplanar duplicates, triangles through every
 * plane of the view volume, now and then one without area or a vertex without normal. */
#ifndef PEEL_TESTS_SOUP_H
#define PEEL_TESTS_SOUP_H

#include "base/random.h"
#include "scene/scene.h"

#include <string.h>

enum {
    SOUP_MESHES = 6,
    SOUP_INSTANCES = 12,
    SOUP_TRIANGLES = 24,
    SOUP_LIGHTS = 3,
    SOUP_TEXTURES = 4,
    SOUP_TEXELS = 9 /* at most, per side */
};

/* Owns everything by value: nothing to free. Do not copy once made. */
typedef struct Soup {
    Scene scene;
    Mesh meshes[SOUP_MESHES];
    float position[SOUP_MESHES][9 * SOUP_TRIANGLES], normal[SOUP_MESHES][9 * SOUP_TRIANGLES];
    float uv[SOUP_MESHES][6 * SOUP_TRIANGLES];
    uint32_t index[SOUP_MESHES][3 * SOUP_TRIANGLES];
    Texture textures[SOUP_TEXTURES];
    float texels[SOUP_TEXTURES][4 * SOUP_TEXELS * SOUP_TEXELS];
    Material materials[8];
    Instance instances[SOUP_INSTANCES];
    Light lights[SOUP_LIGHTS];
    Camera camera;
} Soup;

static inline void soup_triangle(Random *random, float position[9], float normal[9])
{
    double depth = random_range(random, 0.3, 8.0), size = depth * random_range(random, 0.05, 2.5);
    double centre[3] = {random_range(random, -depth, depth), random_range(random, -depth, depth),
                        -depth};
    bool flat = random_bits(random) % 3 == 0; /* all at one depth: ties with others like it */
    if (flat)
        centre[2] = -0.5 * (double)(1 + random_bits(random) % 8);
    for (int i = 0; i < 9; i++) {
        double offset = i % 3 == 2 && flat ? 0.0 : random_range(random, -size, size);
        position[i] = (float)(centre[i % 3] + offset);
        normal[i] = (float)random_range(random, -1, 1);
    }
}

static inline void soup_materials(Random *random, Soup *soup)
{
    static const float alpha[8] = {1.0f, 1.0f, 0.3f, 0.5f, 0.9f, 1.0f, 0.4f, 5e-5f};
    static const AlphaMode mode[8] = {ALPHA_OPAQUE, ALPHA_MASK,  ALPHA_BLEND, ALPHA_BLEND,
                                      ALPHA_BLEND,  ALPHA_BLEND, ALPHA_MASK,  ALPHA_BLEND};
    for (int i = 0; i < 8; i++) {
        Material *material = &soup->materials[i];
        *material = (Material){.name = "",
                               .roughness = (float)random_unit(random),
                               .metallic = (float)random_unit(random),
                               .occlusion = (float)random_unit(random),
                               .alpha_mode = mode[i],
                               .alpha_cutoff = 0.5f,
                               .double_sided = random_bits(random) & 1};
        for (int c = 0; c < 3; c++)
            material->base_color[c] = (float)random_unit(random);
        material->base_color[3] = alpha[i];
    }
}

static inline void soup_instances(Random *random, Soup *soup)
{
    for (uint32_t i = 0; i < SOUP_INSTANCES; i++) {
        Instance *instance = &soup->instances[i];
        *instance = (Instance){.name = "",
                               .mesh = (uint32_t)(random_bits(random) % SOUP_MESHES),
                               .material = (uint32_t)(random_bits(random) % 8),
                               .world = matrix_identity()};
        switch (random_bits(random) % 4) {
        case 0:
            instance->world = matrix_scale(-1, 1, 1);
            break;
        case 1: {
            Matrix turn = matrix_rotate_y(random_range(random, -0.2, 0.2));
            Matrix shift = matrix_translate(random_range(random, -1, 1), 0, -0.5);
            /* Sheared, so that every row has three terms whose order of summation shows. */
            turn.m[1] = 0.125;
            turn.m[4] = -0.1875;
            turn.m[6] = 0.0625;
            turn.m[9] = -0.25;
            instance->world = matrix_multiply(&shift, &turn);
            break;
        }
        default:
            break; /* in place: coincides with every other instance of the mesh that is */
        }
    }
}

/* Multiples of 1/8 often lie on the border between texels. */
static inline float soup_coordinate(Random *random)
{
    static const float odd[] = {0.0f, -0.0f, 1.0f, -1.0f, 1e-40f, 1e-30f, -1e-10f, 1e6f, -3e15f};
    switch (random_bits(random) % 8) {
    case 0:
        return odd[random_bits(random) % (sizeof odd / sizeof *odd)] / 3.0f;
    case 1:
    case 2:
        return (float)(random_bits(random) % 33) * 0.125f - 2.0f;
    default:
        return (float)random_range(random, -2.5, 2.5);
    }
}

/* Textures for about half of the materials, uvs for most meshes. Called last, so that without it
 * the rest of the soup is the same. */
static inline void soup_texture(Random *random, Soup *soup)
{
    for (int t = 0; t < SOUP_TEXTURES; t++) {
        Texture *texture = &soup->textures[t];
        *texture = (Texture){.width = 1 + (uint32_t)(random_bits(random) % SOUP_TEXELS),
                             .height = 1 + (uint32_t)(random_bits(random) % SOUP_TEXELS),
                             .texels = soup->texels[t],
                             .wrap_s = (TextureWrap)(random_bits(random) % 3),
                             .wrap_t = (TextureWrap)(random_bits(random) % 3),
                             .nearest = random_bits(random) % 2};
        for (uint32_t i = 0; i < 4 * texture->width * texture->height; i++)
            texture->texels[i] = (float)(random_bits(random) % 256) / 255.0f;
    }
    for (int m = 0; m < SOUP_MESHES; m++) {
        soup->meshes[m].uv = random_bits(random) % 8 ? soup->uv[m] : NULL;
        for (int i = 0; i < 6 * SOUP_TRIANGLES; i++)
            soup->uv[m][i] = soup_coordinate(random);
    }
    for (int i = 0; i < 8; i++) {
        Material *material = &soup->materials[i];
        if (random_bits(random) % 2)
            material->base_color_texture = 1 + (uint32_t)(random_bits(random) % SOUP_TEXTURES);
        if (random_bits(random) % 2)
            material->metallic_roughness_texture =
                1 + (uint32_t)(random_bits(random) % SOUP_TEXTURES);
        if (material->alpha_mode == ALPHA_MASK) /* often the alpha of a texel */
            material->alpha_cutoff =
                soup->texels[random_bits(random) % SOUP_TEXTURES][random_bits(random) % 4];
    }
    soup->scene.textures = soup->textures;
    soup->scene.texture_count = SOUP_TEXTURES;
}

/* Ranges of lights in every second soup: most end within the soup, some before its first and some
 * behind its last surface. Drawn by a generator of their own, so that a seed's soup is otherwise
 * what it was without them. */
static inline void soup_ranges(Random own, Soup *soup)
{
    static const float ends[] = {0.0f, 1e-20f, 1e-3f, 0.01f, 1e3f, 1e18f, 1e25f};
    if (random_bits(&own) % 2)
        return;
    for (int i = 0; i < SOUP_LIGHTS; i++) {
        float end = ends[random_bits(&own) % (sizeof ends / sizeof *ends)];
        soup->lights[i].range = random_bits(&own) % 4 ? (float)random_range(&own, 0.5, 12.0) : end;
    }
}

static inline void soup_make(Random *random, Soup *soup)
{
    memset(soup, 0, sizeof *soup);
    for (int m = 0; m < SOUP_MESHES; m++) {
        uint32_t triangles = 1 + (uint32_t)(random_bits(random) % SOUP_TRIANGLES);
        for (uint32_t t = 0; t < triangles; t++)
            soup_triangle(random, &soup->position[m][9 * t], &soup->normal[m][9 * t]);
        for (uint32_t i = 0; i < 3 * triangles; i++) {
            soup->index[m][i] = i % 31 == 2 ? i - 1 : i;
            if (i % 17 == 0)
                memset(&soup->normal[m][3 * i], 0, 3 * sizeof(float));
        }
        soup->meshes[m] = (Mesh){.vertex_count = 3 * triangles,
                                 .triangle_count = triangles,
                                 .position = soup->position[m],
                                 .normal = soup->normal[m],
                                 .index = soup->index[m]};
    }
    soup_materials(random, soup);
    soup_instances(random, soup);
    for (int i = 0; i < SOUP_LIGHTS; i++) {
        Light light = {.attenuation = {1.0f, 0.14f, 0.07f}};
        for (int c = 0; c < 3; c++) {
            light.position[c] = random_range(random, -5, 5);
            light.color[c] = (float)random_range(random, 0, 20);
        }
        soup->lights[i] = light;
    }
    soup->camera =
        (Camera){.name = "", .world = matrix_identity(), .yfov = 1.4, .near = 0.125, .far = 9.0};
    soup->scene = (Scene){
        .name = "soup",
        .mesh_count = SOUP_MESHES,
        .material_count = 8,
        .instance_count = SOUP_INSTANCES,
        .light_count = (size_t)(random_bits(random) % (SOUP_LIGHTS + 1)),
        .camera_count = 1,
        .meshes = soup->meshes,
        .materials = soup->materials,
        .instances = soup->instances,
        .lights = soup->lights,
        .cameras = &soup->camera,
        .ambient = {0.25f, 0.25f, 0.25f},
    };
    for (int c = 0; c < 3 && random_bits(random) % 2; c++)
        soup->scene.background[c] = (float)random_unit(random);
    if (random_bits(random) % 2)
        soup_texture(random, soup);
    soup_ranges(*random, soup);
}

/* Makes mesh and instance `index`, the scene's last, a transparent square facing the eye at view
 * depth `depth`, over x0 … x1 of the width [−1, 1] of a window of 192 × 20 pixels whose vertical
 * field of view is 1 radian. */
static inline void soup_square(Soup *soup, uint32_t index, double depth, double x0, double x1)
{
    double half = depth * 0.5463024898437905; /* tan(0.5) */
    const double x[4] = {x0, x1, x1, x0}, y[4] = {-1, -1, 1, 1};
    static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
    Mesh *mesh = &soup->meshes[index];
    *mesh = (Mesh){.vertex_count = 4,
                   .triangle_count = 2,
                   .position = soup->position[index],
                   .normal = soup->normal[index],
                   .index = soup->index[index]};
    for (int i = 0; i < 4; i++) {
        mesh->position[3 * i] = (float)(half * 9.6 * x[i]);
        mesh->position[3 * i + 1] = (float)(half * y[i]);
        mesh->position[3 * i + 2] = (float)-depth;
        mesh->normal[3 * i + 2] = 1.0f;
    }
    memcpy(mesh->index, corners, sizeof corners);
    soup->instances[index] =
        (Instance){.name = "", .mesh = index, .material = 2, .world = matrix_identity()};
    soup->scene.instance_count = soup->scene.mesh_count = index + 1;
}

#endif

/* Adversarial soups: the geometry kinds on which the driver's rules were measured, each a way to
 * place a triangle in the window or around the eye. Materials, instances and lights are soup.h's,
 * now and then driven to the ends of their ranges.
 *
 * Every number survives a glTF file (matrices, camera and lights are floats; occlusion is not
 * written), so that a scene that fails can be handed on as one. */
#ifndef PEEL_TESTS_SOUP_KINDS_H
#define PEEL_TESTS_SOUP_KINDS_H

#include "soup.h"

#include <math.h>

typedef enum SoupKind {
    SOUP_FLAT, /* each triangle at one w, a power of two */
    SOUP_PERSPECTIVE,
    SOUP_SUBPIXEL,
    SOUP_GRID, /* vertices at multiples of 1/16 pixel */
    SOUP_CLIPPED,
    SOUP_BEHIND, /* across the plane of the eye */
    SOUP_HUGE,   /* beyond 10^4 viewports */
    SOUP_SLIVER,
    SOUP_EDGES,    /* shared, axis-aligned and degenerate */
    SOUP_TIES,     /* vertices halfway between two snapped positions */
    SOUP_DENORMAL, /* coordinates and depths around the smallest normal number */
    SOUP_INSIDE,   /* boxes around the eye */
    SOUP_KINDS
} SoupKind;

static inline const char *soup_kind_name(SoupKind kind)
{
    static const char *const names[SOUP_KINDS] = {
        "flat", "perspective", "sub-pixel", "1/16 grid", "clipped",  "behind the eye",
        "huge", "sliver",      "edges",     "ties",      "denormal", "inside"};
    return names[kind];
}

/* Kinds that place vertices exactly need a window of a power of two and a projection of one. */
static inline bool soup_kind_is_exact(SoupKind kind)
{
    return kind == SOUP_FLAT || kind == SOUP_GRID || kind == SOUP_EDGES || kind == SOUP_TIES;
}

typedef struct SoupWindow {
    double width, height; /* pixels */
    double half;          /* tangent of half the field of view */
    double near, far;
} SoupWindow;

/* A vertex in view space from window coordinates and its distance from the eye's plane. */
static inline void soup_from_window(const SoupWindow *window, const double at[3], float position[3])
{
    double aspect = window->width / window->height;
    position[0] = (float)((2.0 * at[0] / window->width - 1.0) * aspect * window->half * at[2]);
    position[1] = (float)((2.0 * at[1] / window->height - 1.0) * window->half * at[2]);
    position[2] = (float)-at[2];
}

/* Of any size from 2^low to 2^high. */
static inline double soup_power(Random *random, int low, int high)
{
    int exponent = low + (int)(random_bits(random) % (uint64_t)(high - low));
    return ldexp(random_range(random, 1.0, 2.0), exponent);
}

/* Multiples of 1/parts of a pixel, shifted by `shift` of such a part. */
static inline double soup_grid(Random *random, double size, int parts, double shift)
{
    uint64_t steps = (uint64_t)(size * parts) + 1;
    return ((double)(random_bits(random) % steps) + shift) / parts;
}

/* On one of few lines, through pixel centres or between pixels, so that edges meet and fall on
 * centres. */
static inline double soup_edge(Random *random, double size)
{
    double line = (double)(random_bits(random) % 9) * size / 8.0;
    return random_bits(random) & 1 ? line + 0.5 : line;
}

static inline double soup_power_of_two(Random *random)
{
    return 0.25 * (double)(1 << random_bits(random) % 5); /* 1/4 … 4 */
}

static inline void soup_sliver(Random *random, const SoupWindow *window, double at[3][3])
{
    double t = random_range(random, -0.2, 1.2), width = soup_power(random, -16, 1);
    for (int c = 0; c < 2; c++) {
        double size = c ? window->height : window->width;
        at[0][c] = random_range(random, 0, size);
        at[1][c] = random_range(random, 0, size);
    }
    at[2][0] = at[0][0] + t * (at[1][0] - at[0][0]) + width;
    at[2][1] = at[0][1] + t * (at[1][1] - at[0][1]) - width;
}

/* A centre and a reach around it, both in pixels. */
static inline void soup_around(Random *random, const double centre[2], double reach,
                               double at[3][3])
{
    for (int v = 0; v < 3; v++)
        for (int c = 0; c < 2; c++)
            at[v][c] = centre[c] + random_range(random, -reach, reach);
}

/* Three vertices in window coordinates. Depths are set by the caller. */
static inline void soup_window_triangle(Random *random, SoupKind kind, const SoupWindow *window,
                                        double at[3][3])
{
    const double size[2] = {window->width, window->height};
    double centre[2] = {random_range(random, 0, size[0]), random_range(random, 0, size[1])};
    int side = (int)(random_bits(random) & 1);
    switch (kind) {
    case SOUP_SUBPIXEL:
        soup_around(random, centre, soup_power(random, -7, 2), at);
        return;
    case SOUP_CLIPPED:
        centre[side] = random_bits(random) & 1 ? size[side] : 0.0;
        soup_around(random, centre, random_range(random, 0.1, 1.5) * size[side], at);
        return;
    case SOUP_HUGE:
        soup_around(random, centre,
                    size[side] * soup_power(random, random_bits(random) % 2 ? 13 : 3, 24), at);
        return;
    case SOUP_SLIVER:
        soup_sliver(random, window, at);
        return;
    default:
        break;
    }
    for (int v = 0; v < 3; v++)
        for (int c = 0; c < 2; c++)
            if (kind == SOUP_GRID)
                at[v][c] = soup_grid(random, size[c], 16, 0.0);
            else if (kind == SOUP_TIES)
                at[v][c] = soup_grid(random, size[c], 256, 0.5);
            else if (kind == SOUP_EDGES)
                at[v][c] = soup_edge(random, size[c]);
            else
                at[v][c] = random_range(random, -0.3, 1.3) * size[c];
}

static inline void soup_depths(Random *random, SoupKind kind, const SoupWindow *window,
                               double at[3][3])
{
    bool flat = kind == SOUP_FLAT || random_bits(random) % 4 == 0;
    double together = soup_kind_is_exact(kind)
                          ? soup_power_of_two(random)
                          : window->near * (1.0 + (double)(random_bits(random) % 16));
    for (int v = 0; v < 3; v++) {
        if (flat)
            at[v][2] = together;
        else if (soup_kind_is_exact(kind))
            at[v][2] = soup_power_of_two(random);
        else if (kind == SOUP_CLIPPED)
            at[v][2] = random_range(random, 0.2, 40.0) * window->near;
        else
            at[v][2] = random_range(random, 1.0, window->far / window->near) * window->near;
    }
}

static inline void soup_kind_triangle(Random *random, SoupKind kind, const SoupWindow *window,
                                      float position[9])
{
    double at[3][3];
    if (kind == SOUP_BEHIND) {
        for (int i = 0; i < 9; i++)
            position[i] = (float)random_range(random, -4, 4);
        return;
    }
    soup_window_triangle(random, kind, window, at);
    soup_depths(random, kind, window, at);
    for (int v = 0; v < 3; v++)
        soup_from_window(window, at[v], &position[3 * v]);
    if (kind == SOUP_EDGES && random_bits(random) % 8 == 0)
        memcpy(&position[6], &position[3 * (random_bits(random) & 1)], 3 * sizeof(float));
}

/* Two triangles on each side of a box around the eye. */
static inline void soup_box(Random *random, float *position)
{
    static const int corners[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    double half[3];
    for (int c = 0; c < 3; c++)
        half[c] = random_range(random, 0.05, 5.0);
    for (int face = 0; face < 6; face++)
        for (int i = 0; i < 6; i++) {
            int axis = face >> 1, u = (axis + 1) % 3, v = (axis + 2) % 3;
            float *vertex = &position[3 * (6 * face + i)];
            vertex[axis] = (float)(face & 1 ? half[axis] : -half[axis]);
            vertex[u] = (float)(corners[i][face & 1] ? half[u] : -half[u]);
            vertex[v] = (float)(corners[i][!(face & 1)] ? half[v] : -half[v]);
        }
}

/* Triangles of a mesh that share edges with the one before: its last two vertices, turned. */
static inline void soup_share_edges(Random *random, Mesh *mesh)
{
    for (uint32_t t = 1; t < mesh->triangle_count; t++)
        if (random_bits(random) % 3 == 0) {
            mesh->index[3 * t] = mesh->index[3 * t - 1];
            mesh->index[3 * t + 1] = mesh->index[3 * t - 2];
        }
}

/* ---- everything but the triangles ----------------------------------------------------------- */

static inline void soup_extremes(Random *random, Soup *soup)
{
    static const float ends[4] = {0.0f, 1.0f, 0.045f, 1e-20f};
    static const float falls[4][3] = {{0, 0, 1}, {1, 0, 0}, {1, 0.14f, 0.07f}, {0, 1, 0}};
    for (int i = 0; i < 8; i++) {
        Material *material = &soup->materials[i];
        material->occlusion = 1.0f;
        if (random_bits(random) % 4 == 0)
            material->roughness = ends[random_bits(random) % 4];
        if (random_bits(random) % 4 == 0)
            material->metallic = ends[random_bits(random) % 2];
        if (random_bits(random) % 4 == 0)
            material->base_color[random_bits(random) % 3] = ends[random_bits(random) % 4];
    }
    for (int i = 0; i < SOUP_LIGHTS; i++) {
        Light *light = &soup->lights[i];
        memcpy(light->attenuation, falls[random_bits(random) % 4], sizeof falls[0]);
        bool at_eye = random_bits(random) % 8 == 0;
        for (int c = 0; c < 3; c++)
            light->position[c] = at_eye ? 0.0 : (double)(float)light->position[c];
        if (random_bits(random) % 8 == 0)
            light->color[random_bits(random) % 3] = 1e6f;
    }
}

/* No far plane, and one mesh so far away that depths round to its end. */
static inline void soup_horizon(Random *random, Soup *soup)
{
    Mesh *mesh = &soup->meshes[random_bits(random) % SOUP_MESHES];
    soup->camera.far = INFINITY;
    for (uint32_t i = 0; i < 3 * mesh->vertex_count; i++)
        mesh->position[i] = fmaxf(fminf(mesh->position[i] * 1e9f, 1e14f), -1e14f);
}

static inline void soup_round(Matrix *matrix, double scale)
{
    for (int i = 0; i < 16; i++) {
        double element = i >= 12 && i < 15 ? matrix->m[i] * scale : matrix->m[i];
        matrix->m[i] = (double)(float)element;
    }
}

static inline void soup_kind_meshes(Random *random, SoupKind kind, const SoupWindow *window,
                                    Soup *soup)
{
    for (int m = 0; m < SOUP_MESHES; m++) {
        Mesh *mesh = &soup->meshes[m];
        if (kind == SOUP_INSIDE) {
            if (mesh->triangle_count >= 12)
                soup_box(random, mesh->position);
            continue;
        }
        for (uint32_t t = 0; t < mesh->triangle_count && kind != SOUP_PERSPECTIVE; t++)
            soup_kind_triangle(random, kind, window, &mesh->position[9 * t]);
        if (kind == SOUP_EDGES || random_bits(random) % 4 == 0)
            soup_share_edges(random, mesh);
    }
}

/* A soup of one kind for a window of width × height pixels. Nothing to free; do not copy. */
static inline void soup_make_kind(Random *random, SoupKind kind, int width, int height, Soup *soup)
{
    soup_make(random, soup);
    /* Down to a near plane of 2^-124: below, w may be flushed to 0 on it and windows are infinite,
     * where no rule holds. */
    double scale = kind == SOUP_DENORMAL ? ldexp(1.0, -100 - (int)(random_bits(random) % 22)) : 1.0;
    SoupWindow window = {width, height, 0.84, 0.125 * scale, 9.0 * scale}; /* about yfov 1.4 */
    if (soup_kind_is_exact(kind)) {
        window.half = 1.0;
        soup->camera.yfov = 1.5707963267948966; /* projects by 1.0f exactly */
    }
    soup->camera.near = window.near;
    soup->camera.far = window.far;
    soup_kind_meshes(random, kind, &window, soup);
    soup_extremes(random, soup);
    if (!soup_kind_is_exact(kind) && random_bits(random) % 4 == 0)
        soup_horizon(random, soup);
    for (int i = 0; i < SOUP_INSTANCES; i++)
        soup_round(&soup->instances[i].world, scale);
    if (!soup_kind_is_exact(kind) && random_bits(random) % 4 == 0) {
        soup->camera.world = matrix_rotate_y(random_range(random, -0.5, 0.5));
        soup_round(&soup->camera.world, scale);
    }
}

#endif

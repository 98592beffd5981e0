/* Bytes as a triangle soup with settings: any bytes are one, so that what changes in an input
 * changes in the picture. Materials, instances, lights and textures are soup.h's by a seed in the
 * input; triangles and their places are the input's own.
 *
 * Bytes: settings (4), everything but the triangles (4), window, path and camera (8), then a
 * triangle each: one byte that says how it is given and of which mesh it is, and what it takes. */
#ifndef PEEL_TESTS_RASTER_INPUT_H
#define PEEL_TESTS_RASTER_INPUT_H

#include "fuzz.h"
#include "random_desc.h"
#include "soup_kinds.h"

typedef struct RasterInput {
    Soup soup;
    RenderDesc desc, other; /* other: the same picture by another tile size, SIMD path, threads */
    bool against_truth;
    uint32_t counts[SOUP_MESHES]; /* triangles given */
} RasterInput;

/* Ways to give a triangle. */
enum {
    RASTER_WINDOW, /* pixels in 1/256, and a distance */
    RASTER_FLOATS, /* floats of 8 bits of exponent and 7 of mantissa, any of them */
    RASTER_SHARED, /* two corners of the triangle before, and one of its own */
    RASTER_AGAIN,  /* that triangle, some ULP nearer or farther */
    RASTER_WAYS
};

enum {
    RASTER_TRIANGLES = 64 /* more than these are not looked at, for the time they take */
};

static inline int16_t raster_take_signed(FuzzBytes *bytes)
{
    return (int16_t)(uint16_t)fuzz_take(bytes, 2);
}

static inline float raster_float(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* A distance from the eye: near and far planes are within, and most are on few planes. */
static inline double raster_distance(FuzzBytes *bytes, const SoupWindow *window)
{
    uint64_t code = fuzz_take(bytes, 2);
    if (code & 1)
        return window->near * (double)(1 + (code >> 1 & 15));
    return window->near * ldexp(1.0 + (double)(code >> 1 & 0xfff) / 4096.0, (int)(code >> 13));
}

static inline void raster_corner(FuzzBytes *bytes, const SoupWindow *window, float position[3])
{
    const double at[3] = {window->width / 2 + raster_take_signed(bytes) / 256.0,
                          window->height / 2 + raster_take_signed(bytes) / 256.0,
                          raster_distance(bytes, window)};
    soup_from_window(window, at, position);
}

/* Finite, and near enough for scene_validate. */
static inline float raster_any(FuzzBytes *bytes)
{
    float value = raster_float((uint32_t)fuzz_take(bytes, 2) << 16);
    return isfinite(value) && fabsf(value) < 1e13f ? value : 0.0f;
}

static inline void raster_nudge(float position[9], int ulps)
{
    for (int v = 0; v < 3; v++) {
        uint32_t bits;
        memcpy(&bits, &position[3 * v + 2], sizeof bits);
        float moved = raster_float(bits + (uint32_t)ulps);
        position[3 * v + 2] = isfinite(moved) && fabsf(moved) < 1e13f ? moved : 0.0f;
    }
}

static inline void raster_triangle(FuzzBytes *bytes, const SoupWindow *window, int way,
                                   const float before[9], float position[9])
{
    memcpy(position, before, 9 * sizeof *position);
    switch (way) {
    case RASTER_WINDOW:
        for (int v = 0; v < 3; v++)
            raster_corner(bytes, window, position + 3 * v);
        return;
    case RASTER_FLOATS:
        for (int i = 0; i < 9; i++)
            position[i] = raster_any(bytes);
        return;
    case RASTER_SHARED:
        memcpy(position, before + 3, 3 * sizeof *position);
        memcpy(position + 3, before, 3 * sizeof *position);
        raster_corner(bytes, window, position + 6);
        return;
    default:
        raster_nudge(position, (int)(int8_t)fuzz_take(bytes, 1));
    }
}

static inline void raster_meshes(FuzzBytes *bytes, const SoupWindow *window, RasterInput *out)
{
    float before[9] = {0};
    for (int i = 0; bytes->left && i < RASTER_TRIANGLES; i++) {
        unsigned code = (unsigned)fuzz_take(bytes, 1);
        uint32_t mesh = code / RASTER_WAYS % SOUP_MESHES, *count = &out->counts[mesh];
        float position[9];
        raster_triangle(bytes, window, (int)(code % RASTER_WAYS), before, position);
        memcpy(before, position, sizeof before);
        if (*count < SOUP_TRIANGLES)
            memcpy(&out->soup.position[mesh][9 * (*count)++], position, sizeof position);
    }
    for (int m = 0; m < SOUP_MESHES; m++) {
        Mesh *mesh = &out->soup.meshes[m];
        uint32_t count = out->counts[m] ? out->counts[m] : 1;
        if (!out->counts[m]) /* without area */
            memset(mesh->position, 0, 9 * sizeof *mesh->position);
        mesh->triangle_count = count;
        mesh->vertex_count = 3 * count;
        for (uint32_t i = 0; i < 3 * count; i++)
            mesh->index[i] = i;
    }
}

/* The window, the camera and ref's path. */
static inline SoupWindow raster_window(FuzzBytes *bytes, RasterInput *out)
{
    Camera *camera = &out->soup.camera;
    RenderDesc *desc = &out->desc;
    desc->width = 1 + (int)(fuzz_take(bytes, 1) % 72);
    desc->height = 1 + (int)(fuzz_take(bytes, 1) % 72);
    uint64_t path = fuzz_take(bytes, 2), view = fuzz_take(bytes, 2), scale = fuzz_take(bytes, 1);
    desc->threads = 1 + (int)(path & 1);
    desc->unfused = path >> 1 & 1;
    desc->tile = TILE_MIN << (path >> 2) % 6;
    desc->simd = (SimdChoice)((path >> 5) % SIMD_COUNT);
    out->other = *desc;
    out->other.threads = 1 + (int)(path >> 8) % 3;
    out->other.tile = TILE_MIN << (path >> 10) % 6;
    out->other.simd = (SimdChoice)((path >> 13) % SIMD_COUNT);
    out->against_truth = fuzz_take(bytes, 1) & 1;
    if (out->against_truth) { /* which takes its time */
        desc->width = (desc->width + 1) / 2;
        desc->height = (desc->height + 1) / 2;
    }
    /* Down to a near plane of 2^-124, as in soup_kinds.h. */
    double size = scale % 8 ? 1.0 : ldexp(1.0, -100 - (int)(scale >> 3) % 22);
    camera->near = 0.125 * size;
    camera->far = view & 1 ? INFINITY : 9.0 * size;
    camera->yfov = 1.4;
    if (view & 2) { /* projects by 1.0f exactly; as exact as a window of a power of two is */
        camera->yfov = 1.5707963267948966;
        desc->width = out->against_truth ? 32 : 64;
        desc->height = 32;
    }
    if (view & 4)
        camera->world = matrix_rotate_y((double)(view >> 3 & 31) / 32.0 - 0.5);
    soup_round(&camera->world, size);
    out->other.width = desc->width;
    out->other.height = desc->height;
    return (SoupWindow){desc->width, desc->height, tan(camera->yfov / 2.0), camera->near, 9.0};
}

/* Nothing to free. */
static inline void raster_decode(const uint8_t *data, size_t size, RasterInput *out)
{
    FuzzBytes bytes = {data, size};
    Random settings = random_seed(fuzz_take(&bytes, 4)), rest = random_seed(fuzz_take(&bytes, 4));
    memset(out->counts, 0, sizeof out->counts);
    out->desc = random_desc_settings(&settings);
    soup_make(&rest, &out->soup);
    soup_extremes(&rest, &out->soup);
    SoupWindow window = raster_window(&bytes, out);
    raster_meshes(&bytes, &window, out);
    for (int i = 0; i < SOUP_INSTANCES; i++)
        soup_round(&out->soup.instances[i].world, window.near / 0.125);
    out->soup.scene.instance_count = 1 + (size_t)(random_bits(&rest) % SOUP_INSTANCES);
}

#endif

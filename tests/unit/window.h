/* Vertices given in window space, for the tests of setup and clipping. */
#ifndef PEEL_TESTS_WINDOW_H
#define PEEL_TESTS_WINDOW_H

#include "ref/pipeline/setup.h"

/* A vertex at window (x, y, z) with w = 1, snapped as the viewport transform snaps it. */
static inline Vertex window_vertex(float x, float y, float z)
{
    Vertex vertex = {.window = {x, y, z, 1.0f}, .clip = {0, 0, 0, 1}};
    vertex.x_fixed8 = op_round_to_int(op_mul(op_sub(x, 0.5f), 256.0f));
    vertex.y_fixed8 = op_round_to_int(op_mul(op_sub(y, 0.5f), 256.0f));
    return vertex;
}

enum {
    WINDOW_SIZE = 64
};

typedef struct WindowCount {
    int count[WINDOW_SIZE][WINDOW_SIZE]; /* [y][x] */
} WindowCount;

static inline void window_count_pixel(void *context, const Setup *setup, int x, int y)
{
    (void)setup;
    WindowCount *counts = context;
    counts->count[y][x]++;
}

/* Adds the triangle's covered pixels. */
static inline void window_cover(const Vertex *a, const Vertex *b, const Vertex *c,
                                WindowCount *counts)
{
    const Vertex *const corners[3] = {a, b, c};
    if (setup_facing(corners, false) == FACING_NONE)
        return;
    Setup setup;
    setup_triangle(corners, false, WINDOW_SIZE, WINDOW_SIZE, &setup);
    setup_visit(&setup, (PixelRect){0, 0, WINDOW_SIZE - 1, WINDOW_SIZE - 1}, window_count_pixel,
                counts);
}

#endif

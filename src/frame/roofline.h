/* What a machine's processor can do at most, and what the lighting loop does of it: the kernels
 * that ref has once per instruction set, and how many operations the formula takes. */
#ifndef PEEL_FRAME_ROOFLINE_H
#define PEEL_FRAME_ROOFLINE_H

#include "base/result.h"
#include "frame/render_desc.h"

/* Single-precision operations of shading.h's loop per fragment and light, in the default form
 * (GGX_SOURCE, no back light): counted by tests/unit/test_roofline.c. */
enum {
    ROOFLINE_ADDS = 34, /* additions and subtractions */
    ROOFLINE_MULS = 52,
    ROOFLINE_CLAMPS = 7, /* minima and maxima */
    ROOFLINE_DIVS = 6,
    ROOFLINE_SQRTS = 2,
    ROOFLINE_ARITHMETIC = ROOFLINE_ADDS + ROOFLINE_MULS + ROOFLINE_CLAMPS,
    ROOFLINE_OPERATIONS = ROOFLINE_ARITHMETIC + ROOFLINE_DIVS + ROOFLINE_SQRTS
};

enum {
    ROOFLINE_CHAINS = 12,     /* independent, so that latency does not count */
    ROOFLINE_FRAGMENTS = 256, /* resident, a multiple of every width */
    ROOFLINE_LIGHTS = 128
};

/* What the lighting loop works on; made by roofline_lighting. */
typedef struct RooflineLighting RooflineLighting;

/* The kernels of one width. Each arithmetic one does rounds · ROOFLINE_CHAINS · lanes operations
 * (muladd twice as many: a product, and a sum of its own) and returns a value that depends on all.
 * fma is NULL where the width has none. */
typedef struct RooflineKernels {
    SimdChoice simd;
    int lanes;
    float (*muladd)(uint64_t rounds);
    float (*fma)(uint64_t rounds); /* one instruction, counted as two operations */
    float (*divide)(uint64_t rounds);
    float (*root)(uint64_t rounds);
    /* Of count floats, a multiple of 64. */
    float (*read)(const float *from, size_t count);
    void (*write)(float *to, size_t count);
    void (*copy)(float *to, const float *from, size_t count);
    /* Lights ROOFLINE_FRAGMENTS fragments by ROOFLINE_LIGHTS lights, all before the surfaces, as
     * ref's fast path does; rounds times over. */
    float (*light)(RooflineLighting *data, uint64_t rounds);
    Result (*lighting)(RooflineLighting **out); /* data of light; freed by free() */
} RooflineKernels;

/* Those that this processor has, narrowest first; static. */
typedef const RooflineKernels *(*RooflineTable)(size_t *count);

#endif

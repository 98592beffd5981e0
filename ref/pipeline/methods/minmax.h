/* What the methods of dual depth peeling share, the definition paths.
 *
 * This work is based on: Louis Bavoil, Kevin Myers, "Order Independent Transparency with Dual Depth
 * Peeling", NVIDIA, 2008.
 *
 * A first geometry pass finds each pixel's nearest and farthest visible fragment; every further
 * one, a peel, takes the fragments there and finds the nearest and farthest of those between. It is
 * over when no pixel has such a fragment, which a look at the pixels tells: N layers take
 * ceil(N/2) + 1 passes over the transparent list.
 *
 * Visible is what the opaque depth does not hide, compared as for single peels in the stored
 * format; the layers themselves are told apart as floats, so that fewer are lost than by d24 or
 * d16. There is no bias.
 *
 * A distance is gl_FragCoord.z clamped to [0, 1], a float whatever the depth format is; with
 * DEPTH_RANGE_REVERSED −z, so that it grows away from the eye. A pixel of a min-max buffer is
 * (−nearest, farthest), drawn with MAX; (−2, −2) where there is none. */
#ifndef PEEL_REF_MINMAX_H
#define PEEL_REF_MINMAX_H

#include "number/blend.h"
#include "ref/pipeline/stage.h"

/* What a method does per peel, and what it knows. */
typedef struct MinMaxMethod {
    void (*clear)(Stage *stage); /* its own targets, before the geometry pass */
    StageTile geometry;
    Result (*blend)(Stage *stage); /* lights or blends what was drawn, and traces it */
    /* In front of what a pass limit left. */
    float (*transmittance)(const Stage *stage, size_t pixel);
} MinMaxMethod;

/* The first member of the method's state: stage->method points to it. */
typedef struct MinMax {
    const MinMaxMethod *method;
    Image previous, current; /* RG32F: of the pass before, and of the one that runs */
    Image back;              /* accumulation of the back layers; cleared as stage->accum */
    Image front_id, back_id; /* primitives that the running pass takes; statistics only */
    int peel;                /* the one that runs, or ran last */
    Image *backs;            /* with a trace: back_id of the peels so far */
    size_t back_count, back_capacity;
} MinMax;

typedef enum MinMaxSide {
    MINMAX_PEELED, /* in front of both or behind both: taken before */
    MINMAX_FRONT,  /* the nearest; also where it is the farthest too */
    MINMAX_BACK,
    MINMAX_BETWEEN
} MinMaxSide;

/* A visible fragment of a peel. */
typedef struct MinMaxFragment {
    size_t pixel;
    float distance;
    MinMaxSide side;
} MinMaxFragment;

uint64_t minmax_bytes(const Pass *pass);
/* On failure *out holds what there is. The caller frees with minmax_free. */
Result minmax_create(const Pass *pass, const MinMaxMethod *method, MinMax *out);
void minmax_free(MinMax *minmax);

/* The first pass and the peels, up to desc->passes; sets the frame's peels and passes. */
Result minmax_peels(Stage *stage);

/* Whether the fragment shader goes on: neither hidden, nor masked. Notes which primitive is taken,
 * and widens the current min-max buffer by one that is between. */
bool minmax_visible(const StageVisit *visit, const Setup *setup, int x, int y, MinMaxFragment *out);

/* Blends the back accumulation under stage->accum. */
Result minmax_compose(Stage *stage);

/* Traces one buffer as "<method>.K.<what>". */
Result minmax_put(const Stage *stage, const char *what, const Image *image);

/* Clears to 0; to (0, 0, 0, 1), no colour and all transmitted. */
void minmax_clear_zero(Image *image);
void minmax_clear_accum(Image *image);

static inline MinMax *minmax_of(const Stage *stage)
{
    return stage->method;
}

static inline void *minmax_pixel(const Image *image, size_t pixel)
{
    return (char *)image->pixels + pixel * format_pixel_bytes(image->format);
}

/* Where a distance lies to the limits of the pass before. */
static inline MinMaxSide minmax_side(const float limits[2], float distance)
{
    float nearest = op_neg(limits[0]), farthest = limits[1];
    if (distance == nearest)
        return MINMAX_FRONT;
    if (distance == farthest)
        return MINMAX_BACK;
    return distance > nearest && distance < farthest ? MINMAX_BETWEEN : MINMAX_PEELED;
}

static inline void minmax_count_shaded(Stage *stage, int x, int y)
{
    uint32_t tile = pass_tile_at(stage->pass, x, y);
    stage->tile_counts[tile].shaded++;
}

static inline float minmax_distance(const Pass *pass, float z)
{
    float clamped = depth32f_from_float(z);
    return pass->reversed ? op_neg(clamped) : clamped;
}

/* The depth that a distance stands for. */
static inline float minmax_depth(const Pass *pass, float distance)
{
    return pass->reversed ? op_neg(distance) : distance;
}

#endif

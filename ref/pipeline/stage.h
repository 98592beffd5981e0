/* What the definition paths of all methods share: scalar passes over whole buffers.
 *
 * The opaque geometry and lighting passes, the accumulation buffer, the resolve, the counts, and
 * the pieces of a geometry pass that keeps the nearest fragment of each pixel. A pass is a task per
 * tile: pixels do not depend on each other, so neither the order of tiles nor the number of threads
 * changes a bit. A method runs
 *   stage_create, stage_opaque, its own passes over the transparent list, stage_finish, stage_free.
 */
#ifndef PEEL_REF_STAGE_H
#define PEEL_REF_STAGE_H

#include "ref/pipeline/details.h"
#include "ref/pipeline/fragment.h"
#include "ref/pipeline/mutate.h"
#include "ref/pipeline/pass.h"

typedef struct Stage Stage;
typedef void (*StageTile)(Stage *stage, uint32_t tile);

struct Stage {
    const Pass *pass;
    TraceSink *trace; /* may be NULL */
    Frame *frame;
    void *method; /* the method's own state */
    GBuffer opaque;
    Image accum;             /* cleared to (0, 0, 0, 1) */
    uint32_t *fragments;     /* per pixel: transparent fragments in front of the opaque depth */
    uint32_t *remaining;     /* of those, behind the last peel; the method counts both */
    uint32_t *winner;        /* scratch: index in its list of the fragment a geometry pass kept */
    PassCounts counts;       /* of the frame */
    PassCounts *tile_counts; /* the rest, one per tile */
    StageTile function;      /* of the pass that runs */
    const GBuffer *lit;      /* of the lighting pass that runs */
    bool forward;            /* diffuse holds lit colours (METHOD_FORWARD) */
    float alpha_test;        /* SHADING_ALPHA_TEST */
    Details details;         /* without pixels where nobody asks for them */
};

/* bytes: of the method's own buffers, which count against the limit. frame's images are allocated.
 * On failure nothing is left to free. */
Result stage_create(Pass *pass, TraceSink *trace, Frame *frame, void *method, uint64_t bytes,
                    Stage *out);
void stage_free(Stage *stage);

/* Of a list's G-buffer with its depth and primitive ids, for the sum given to stage_create. */
uint64_t stage_gbuffer_bytes(const Pass *pass, bool transparent);

/* Runs one pass: function for every tile, on all threads, in flushing mode. */
Result stage_run(Stage *stage, StageTile function);

/* The opaque geometry pass, traced. */
Result stage_opaque(Stage *stage);
/* The accumulation to no colour and full transmittance, as stage_create leaves it. */
void stage_clear_accum(Stage *stage);
/* Lights source and blends it under the accumulation; transparent: as a peel's. */
Result stage_light(Stage *stage, const GBuffer *source, bool transparent);
/* The opaque lighting pass, resolve and display, traced as the steps after frame->peels; counts
 * to the frame. */
Result stage_finish(Stage *stage);
/* The last two thirds of it, where the opaque colour is blended already. */
Result stage_resolve(Stage *stage);

/* A whole frame of a scene without transparent surfaces, by any method: all that it has to do. */
Result stage_opaque_only(Pass *pass, Frame *frame);

/* Traces one buffer under "opaque.<what>" (peel −1) or "peel.K.<what>", or a whole G-buffer. */
Result stage_put(const Stage *stage, int peel, const char *what, const Image *image);
/* After stage_light, for a trace with details: the colours that it blended. */
Result stage_put_source(const Stage *stage, int peel);
Result stage_put_gbuffer(const Stage *stage, int peel, const GBuffer *buffers);

/* Counts a peel's pixels, and of those the ones at the previous peel's depth (NULL: none). */
void stage_count_drawn(const GBuffer *layer, const Image *previous_depth, uint64_t *drawn,
                       uint64_t *repeated);
/* Adds a tile's stage->remaining, and the transmittance in front of them, to its counts. */
void stage_count_remaining(Stage *stage, uint32_t tile);

/* ---- shading and blending, watched where somebody asks ---- */

typedef void (*StageBlend)(PixelFormat format, const float source[4], void *pixel);

/* equation: blend's name, number/blend.h's; target: the buffer's. */
static inline void stage_blend(const Stage *stage, StageBlend blend, const char *equation,
                               const char *target, uint32_t primitive, const float source[4],
                               const Image *image, size_t pixel)
{
    PassWatch *watch = stage->pass->watch;
    unsigned char before[16];
    size_t bytes = format_pixel_bytes(image->format);
    void *at = (char *)image->pixels + pixel * bytes;
    if (watch)
        memcpy(before, at, bytes);
    blend(image->format, source, at);
    if (watch)
        watch->blend(watch, pixel, primitive, target, equation, image->format, source, before, at);
}

/* As mutate_shade. */
static inline bool stage_shade(const Stage *stage, size_t pixel, uint32_t primitive,
                               const ShadeForm *form, const Texel *texel, float source[4])
{
    const Pass *pass = stage->pass;
    if (!mutate_shade(pass, form, texel, source))
        return false;
    if (pass->watch)
        pass->watch->shade(pass->watch, pixel, primitive, form, texel, source);
    return true;
}

/* ---- pieces of a geometry pass ---- */

/* Where window column x and row y, y up, are in the buffers, whose rows run from the top. */
static inline int stage_column(const Pass *pass, int x)
{
    return x - pass->x0;
}

static inline int stage_row(const Pass *pass, int y)
{
    return pass->view.height - 1 - (y - pass->y0);
}

/* Pixel (x, y), y up, in them. */
static inline size_t stage_pixel(const Pass *pass, int x, int y)
{
    return (size_t)stage_row(pass, y) * (size_t)pass->view.width + (size_t)stage_column(pass, x);
}

static inline uint32_t stage_key(const Image *depth, size_t pixel)
{
    return ((const uint32_t *)depth->pixels)[pixel];
}

/* The context of a SetupVisit. */
typedef struct StageVisit {
    Stage *stage;
    GBuffer *target; /* NULL: nothing is drawn */
    const PrimitiveList *list;
    const Primitive *primitive; /* at hand */
} StageVisit;

/* A fragment that passed the method's tests: depth test, alpha mask, and if it is kept, its depth,
 * primitive and place in the list. */
static inline void stage_keep(const StageVisit *visit, const Setup *setup, int x, int y,
                              FragmentDepth depth)
{
    const Pass *pass = visit->stage->pass;
    size_t pixel = stage_pixel(pass, x, y);
    uint32_t *stored = (uint32_t *)visit->target->depth.pixels + pixel;
    if (!pass_depth_test(pass, depth.key, *stored) ||
        fragment_masked(pass, setup, visit->primitive, x, y))
        return;
    *stored = depth.key;
    ((uint32_t *)visit->target->primitive.pixels)[pixel] = visit->primitive->id;
    visit->stage->winner[pixel] = (uint32_t)(visit->primitive - visit->list->items);
}

/* Calls function for every covered pixel of the tile, primitive by primitive in draw order. */
static inline __attribute__((always_inline)) void stage_draw(const Bins *bins, uint32_t tile,
                                                             SetupVisit function, StageVisit *visit)
{
    const Pass *pass = visit->stage->pass;
    PixelRect rect = pass_tile_rect(pass, tile);
    for (size_t i = bins->first[tile]; i < bins->first[tile + 1]; i++) {
        Setup setup;
        visit->primitive = &visit->list->items[bins->item[i]];
        pass_setup(pass, visit->primitive, &setup);
        setup_visit(&setup, rect, function, visit);
    }
}

/* Runs the fragment shader for the fragments that the depth test left: the others' writes would
 * have been overwritten, and many layers drawn back to front would shade each many times. */
void stage_shade_winners(const StageVisit *visit, uint32_t tile);

#endif

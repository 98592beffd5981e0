/* What both paths of the pipeline share: the frame's inputs, binned primitives, the fragment. */
#ifndef PEEL_REF_PASS_H
#define PEEL_REF_PASS_H

#include "base/pool.h"
#include "frame/frame.h"
#include "frame/needs.h"
#include "frame/shading.h"
#include "frame/view.h"
#include "ref/pipeline/buffers.h"
#include "ref/pipeline/setup.h"
#include "ref/pipeline/shade.h"

#define PRIMITIVE_NONE UINT32_MAX

/* Per tile, the indices of the primitives whose bounding box meets it, in draw order. */
typedef struct Bins {
    size_t *first;  /* tile_count + 1 */
    uint32_t *item; /* indices into the list */
} Bins;

/* What the definition path shades and blends, where somebody asks: a pixel's history. The callbacks
 * are called in flushing mode, by the thread that draws; pixel: as stage_pixel counts; primitive:
 * whose fragment it is, PRIMITIVE_NONE where it is of several or of none. */
typedef struct PassWatch PassWatch;
struct PassWatch {
    void (*shade)(PassWatch *watch, size_t pixel, uint32_t primitive, const ShadeForm *form,
                  const Texel *texel, const float source[4]);
    void (*blend)(PassWatch *watch, size_t pixel, uint32_t primitive, const char *target,
                  const char *equation, PixelFormat format, const float source[4],
                  const void *before, const void *after);
};

typedef struct Pass {
    const RenderDesc *desc;
    const Scene *scene;
    View view;  /* its width and height are the buffers', which may be of a part of the frame */
    int x0, y0; /* window coordinates of the buffers' lower left pixel; 0 of a whole frame */
    PassWatch *watch; /* may be NULL */
    Pool *pool;
    Geometry geometry;
    Bins opaque_bins, transparent_bins;
    int tile; /* pixels per side: a power of two from TILE_MIN to TILE_MAX */
    uint32_t tile_columns, tile_count;
    uint64_t bytes, limit; /* reserved so far; the caller's --max-memory */
    bool fused, reversed;
    PixelFormat depth_format;
    GBufferLayout layout; /* of what fragments are rounded to */
    Needs needs;
    GBufferLayout stored[2]; /* of the opaque and the transparent list's buffers: what is needed */
} Pass;

/* traced: see needs_derive. */
Result pass_create(const Scene *scene, const RenderDesc *desc, bool traced, Pass *out);
void pass_free(Pass *pass);

/* A part of the frame, to be drawn alone by a definition path: buffers of the rectangle's size, the
 * same geometry and bits. desc: whole's, but with the rectangle's width and height; it and whole
 * must outlive *out. rect: at most TILE_MAX pixels a side, inside the frame. NO_MEMORY on failure.
 * The caller frees with pass_part_free. */
Result pass_part(const Pass *whole, const RenderDesc *desc, PixelRect rect, Pool *pool, Pass *out);
void pass_part_free(Pass *part);

/* Accounts for bytes about to be allocated; NO_MEMORY and a message past the limit. */
Result pass_reserve(Pass *pass, uint64_t bytes);

/* The tile's pixels in window coordinates (y up). */
PixelRect pass_tile_rect(const Pass *pass, uint32_t tile);

/* The tile that window pixel (x, y) is in. */
static inline uint32_t pass_tile_at(const Pass *pass, int x, int y)
{
    return (uint32_t)((y - pass->y0) / pass->tile) * pass->tile_columns +
           (uint32_t)((x - pass->x0) / pass->tile);
}

static inline void pass_setup(const Pass *pass, const Primitive *primitive, Setup *out)
{
    const Vertex *vertices = pass->geometry.vertices;
    const Vertex *const corners[3] = {&vertices[primitive->vertex[0]],
                                      &vertices[primitive->vertex[1]],
                                      &vertices[primitive->vertex[2]]};
    setup_make(corners, primitive->swap, pass->view.draws[primitive->draw].flipped, primitive->box,
               out);
}

/* Of the lighting pass of a peel, or of the opaque surfaces. */
static inline ShadeForm pass_shade_form(const Pass *pass, bool transparent)
{
    return (ShadeForm){.model = pass->desc->shading,
                       .ggx = pass->desc->ggx,
                       .back_light = pass->desc->back_light && transparent};
}

/* A fragment's depth as computed (gl_FragCoord.z) and as stored (depth_key). */
typedef struct FragmentDepth {
    float z;
    uint32_t key;
} FragmentDepth;

static inline FragmentDepth pass_fragment_depth(const Pass *pass, const Setup *setup, int x, int y)
{
    float z = setup_depth_at(pass->fused, setup, x, y);
    return (FragmentDepth){z, depth_key(pass->depth_format, z)};
}

/* Whether a transparent fragment is behind the stored opaque depth. */
static inline bool pass_hidden(const Pass *pass, FragmentDepth depth, uint32_t opaque)
{
    if (pass->desc->peel_test == PEEL_TEST_RAW) {
        float fetched = depth_fetch(pass->depth_format, opaque);
        return pass->reversed ? depth.z <= fetched : depth.z >= fetched;
    }
    return pass->reversed ? depth.key <= opaque : depth.key >= opaque;
}

/* Whether an earlier peel took it, or the layer in front of it. */
static inline bool pass_peeled(const Pass *pass, FragmentDepth depth, uint32_t previous)
{
    float bias = pass->desc->bias;
    bool raw = pass->desc->peel_test == PEEL_TEST_RAW;
    if (raw || bias > 0.0f) {
        float fetched = depth_fetch(pass->depth_format, previous);
        float z = raw ? depth.z : depth_fetch(pass->depth_format, depth.key);
        if (bias > 0.0f)
            fetched = pass->reversed ? op_sub(fetched, bias) : op_add(fetched, bias);
        return pass->reversed ? z >= fetched : z <= fetched;
    }
    return pass->reversed ? depth.key >= previous : depth.key <= previous;
}

/* Whether a stored depth is behind that of the previous layer, by more than the bias: what peeling
 * by depth and primitive asks. */
static inline bool pass_behind(const Pass *pass, uint32_t key, uint32_t previous)
{
    if (pass->reversed ? key >= previous : key <= previous)
        return false;
    float bias = pass->desc->bias;
    if (!(bias > 0.0f))
        return true;
    float z = depth_fetch(pass->depth_format, key);
    float fetched = depth_fetch(pass->depth_format, previous);
    return pass->reversed ? z < op_sub(fetched, bias) : z > op_add(fetched, bias);
}

/* Of two primitives at one depth: whether a is in front of b, where the order is by both. */
static inline bool pass_id_before(const Pass *pass, uint32_t a, uint32_t b)
{
    return pass->desc->depth_func == DEPTH_LEQUAL ? a > b : a < b;
}

/* Whether a fragment comes after the previous layer, by depth and primitive; previous_id:
 * PRIMITIVE_NONE where that was empty, so that nothing comes. */
static inline bool pass_comes_after(const Pass *pass, uint32_t key, uint32_t id, uint32_t previous,
                                    uint32_t previous_id)
{
    if (previous_id == PRIMITIVE_NONE)
        return false;
    if (key == previous)
        return pass_id_before(pass, previous_id, id);
    return pass_behind(pass, key, previous);
}

/* Whether further peels would have come to it: behind the previous layer, and not discarded with
 * it by the raw test, which cannot tell two 24-bit depths apart where a fetch rounds up. */
static inline bool pass_remains(const Pass *pass, FragmentDepth depth, uint32_t previous)
{
    bool behind = pass->reversed ? depth.key < previous : depth.key > previous;
    return behind && !pass_peeled(pass, depth, previous);
}

static inline bool pass_depth_test(const Pass *pass, uint32_t key, uint32_t stored)
{
    if (key == stored)
        return pass->desc->depth_func == DEPTH_LEQUAL;
    return pass->reversed ? key > stored : key < stored;
}

/* Counts of one tile or of the frame; see LayerStats. */
typedef struct PassCounts {
    uint32_t max;
    uint64_t fragments, peeled, repeated, remaining, shaded, overflowed;
    uint64_t residual_pixels;
    float residual_max;
} PassCounts;

/* Whether fragments can lie behind the last of `peels` peels: the limit was reached, or the raw
 * test went on repeating a layer. */
static inline bool pass_may_leave(const Pass *pass, int peels, int limit)
{
    return peels > 0 && (peels == limit || pass->desc->peel_test == PEEL_TEST_RAW);
}

/* Of a method that draws the transparent list peel by peel, until the limit or an empty one. */
static inline int pass_geometry_passes(const Pass *pass, int peels)
{
    int limit = render_desc_pass_limit(pass->desc);
    return peels + (peels < limit);
}

/* One pixel's transparent fragments in front of the opaque depth. */
static inline void pass_count_fragments(PassCounts *counts, uint32_t fragments)
{
    counts->max = fragments > counts->max ? fragments : counts->max;
    counts->fragments += fragments;
}

/* One pixel's fragments behind its last peel, and the transmittance in front of them. */
static inline void pass_count_remaining(PassCounts *counts, uint32_t remaining, float transmittance)
{
    if (remaining == 0)
        return;
    counts->remaining += remaining;
    counts->residual_pixels++;
    if (transmittance > counts->residual_max)
        counts->residual_max = transmittance;
}

void pass_counts_add(PassCounts *sum, const PassCounts *tile);
void pass_counts_report(const PassCounts *counts, Frame *frame);

/* The transmittance towards the background (see frame/shading.h, resolve). */
static inline float pass_background_weight(const Pass *pass, float transmittance,
                                           float opaque_alpha)
{
    bool seed = pass->desc->opaque_blend == OPAQUE_BLEND_SEED;
    return seed && opaque_alpha > SHADING_ALPHA_TEST ? 0.0f : transmittance;
}

#endif

/* What both paths of the pipeline share: the frame's inputs, binned primitives, the fragment. */
#ifndef PEEL_REF_PASS_H
#define PEEL_REF_PASS_H

#include "base/pool.h"
#include "frame/frame.h"
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

typedef struct Pass {
    const RenderDesc *desc;
    const Scene *scene;
    View view;
    Pool *pool;
    Geometry geometry;
    Bins opaque_bins, transparent_bins;
    int tile; /* pixels per side: a power of two from TILE_MIN to TILE_MAX */
    uint32_t tile_columns, tile_count;
    uint64_t bytes, limit; /* reserved so far; the caller's --max-memory */
    bool fused, reversed;
    PixelFormat depth_format;
    GBufferLayout layout;
} Pass;

Result pass_create(const Scene *scene, const RenderDesc *desc, Pass *out);
void pass_free(Pass *pass);

/* Accounts for bytes about to be allocated; NO_MEMORY and a message past the limit. */
Result pass_reserve(Pass *pass, uint64_t bytes);

/* The tile's pixels in window coordinates (y up). */
PixelRect pass_tile_rect(const Pass *pass, uint32_t tile);

/* The tile that window pixel (x, y) is in. */
static inline uint32_t pass_tile_at(const Pass *pass, int x, int y)
{
    return (uint32_t)(y / pass->tile) * pass->tile_columns + (uint32_t)(x / pass->tile);
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

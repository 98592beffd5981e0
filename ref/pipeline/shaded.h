/* Fragments that are shaded in the geometry pass and all blended: what methods that do not peel
 * share. */
#ifndef PEEL_REF_SHADED_H
#define PEEL_REF_SHADED_H

#include "ref/pipeline/stage.h"

typedef struct ShadedFragment {
    size_t pixel;    /* stage_pixel */
    float source[4]; /* premultiplied colour, alpha */
    float distance;  /* |z| in view space */
    float depth;     /* gl_FragCoord.z */
    uint32_t primitive;
} ShadedFragment;

/* The context of a SetupVisit; &draw goes to stage_draw. */
typedef struct ShadedVisit {
    StageVisit draw; /* first */
    PassCounts *counts;
} ShadedVisit;

static inline ShadedVisit shaded_visit(Stage *stage, uint32_t tile)
{
    return (ShadedVisit){{.stage = stage, .list = &stage->pass->geometry.transparent},
                         &stage->tile_counts[tile]};
}

/* Counts and shades the fragment at (x, y); false where it is behind the opaque depth or its alpha
 * is at most SHADING_ALPHA_TEST. visit: a ShadedVisit. Flushing mode. */
static inline bool shaded_fragment(const ShadedVisit *visit, const Setup *setup, int x, int y,
                                   ShadedFragment *out)
{
    Stage *stage = visit->draw.stage;
    const Pass *pass = stage->pass;
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    out->pixel = stage_pixel(pass, x, y);
    if (pass_hidden(pass, depth, stage_key(&stage->opaque.depth, out->pixel)))
        return false;
    stage->fragments[out->pixel]++;
    ShadeForm form = pass_shade_form(pass, true);
    Texel texel;
    fragment_surface(pass, setup, visit->draw.primitive, x, y, &texel);
    out->distance = op_abs(texel.position[2]);
    out->depth = depth.z;
    out->primitive = visit->draw.primitive->id;
    if (!stage_shade(stage, out->pixel, out->primitive, &form, &texel, out->source))
        return false;
    visit->counts->shaded++;
    return true;
}

/* After the one pass over the transparent list: passes, and that no fragment was lost. */
void shaded_count(Stage *stage);

#endif

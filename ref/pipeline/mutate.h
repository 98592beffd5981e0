/* The mistakes of frame/mutation.h that are no settings, where the definition path makes them.
 * Nothing here is reached while RenderDesc.mutations is 0. All in flushing mode but mutate_view. */
#ifndef PEEL_REF_MUTATE_H
#define PEEL_REF_MUTATE_H

#include "frame/mutation.h"
#include "ref/pipeline/pass.h"

static inline bool mutate_has(const Pass *pass, MutationId id)
{
    return (pass->desc->mutations & mutation_bit(id)) != 0;
}

/* Mutations that mutate_view makes, so that every path has them. */
#define MUTATE_VIEW                                                                                \
    (mutation_bit(MUTATION_LIGHTS_OFF_BY_ONE) | mutation_bit(MUTATION_BACK_FACES_CULLED) |         \
     mutation_bit(MUTATION_NORMALS_WRONG_SPACE))
void mutate_view(const Scene *scene, const RenderDesc *desc, View *view);

/* ---- geometry pass ---- */

/* Clears diffuse once more, to the alpha of MUTATION_GBUFFER_CLEAR_ALPHA_1. */
void mutate_clear(const Pass *pass, GBuffer *buffers);

/* The pixel, as stage_pixel counts, from which the depths for pixel (x, y), y up, are fetched. */
size_t mutate_fetch(const Pass *pass, int x, int y);
/* pass_hidden and pass_peeled. */
bool mutate_hidden(const Pass *pass, FragmentDepth depth, uint32_t opaque);
bool mutate_peeled(const Pass *pass, FragmentDepth depth, uint32_t previous);

/* Whether peels may repeat layers for ever, so that peeling until one is empty would not end. */
bool mutate_repeats(const Pass *pass);

/* ---- lighting pass ---- */

/* The alpha up to which the lighting pass discards. */
float mutate_alpha_test(const Pass *pass);
bool mutate_source(const Pass *pass, const ShadeForm *form, const Texel *texel, float source[4]);
void mutate_blend(const Pass *pass, bool transparent, const float source[4], void *pixel);

/* shade_pixel, or what the mutations make of it. */
static inline bool mutate_shade(const Pass *pass, const ShadeForm *form, const Texel *texel,
                                float source[4])
{
    return pass->desc->mutations ? mutate_source(pass, form, texel, source)
                                 : shade_pixel(&pass->view, form, texel, source);
}

/* ---- resolve ---- */

/* shade_final and shade_display; transmittance: towards the background. */
void mutate_resolve(const Pass *pass, const float accum[4], float transmittance, float final[4],
                    uint8_t display[4]);

#endif

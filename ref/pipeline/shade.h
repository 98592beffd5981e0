/* Lighting, resolve and display of one pixel: frame/shading.h, scalar. */
#ifndef PEEL_REF_SHADE_H
#define PEEL_REF_SHADE_H

#include "frame/render_desc.h"
#include "frame/shading.h"
#include "frame/view.h"
#include "number/op.h"
#include "ref/pipeline/buffers.h"

/* Which of the formula's variants a lighting pass uses. */
typedef struct ShadeForm {
    ShadingModel model;
    GgxForm ggx;
    bool back_light;
    bool lambert_whole; /* not divided by π: MUTATION_MISSING_1_OVER_PI */
} ShadeForm;

/* From fetched and decoded G-buffer values to the premultiplied source colour; false where the
 * alpha test discards. Flushing mode. */
bool shade_pixel(const View *view, const ShadeForm *form, const Texel *texel, float source[4]);

/* What a light adds to a pixel, and the sum up to it. */
typedef struct ShadeTerm {
    float n_dot_l, n_dot_h, h_dot_v, distance;
    float distribution, geometry, fresnel[3], specular; /* D, G, F, and s of frame/shading.h */
    float attenuation;
    float term[3], sum[3];
} ShadeTerm;

/* The terms of shade_pixel's sum: terms has room for view->light_count; ambient: what comes after
 * them. Not of SHADING_PHONG. Flushing mode. */
void shade_terms(const View *view, const ShadeForm *form, const Texel *texel, ShadeTerm *terms,
                 float ambient[3]);

/* The same without the alpha test, and faster: lights that change no bit are left out. */
void shade_skipping(const View *view, const ShadeForm *form, const Texel *texel, float source[4]);

/* Resolve: final colour over the background from an accumulated pixel whose transmittance to the
 * background is `transmittance`. Flushing mode, as below. */
static inline void shade_final(const View *view, const float accum[4], float transmittance,
                               float final[4])
{
    for (int i = 0; i < 3; i++)
        final[i] = op_canonical(op_add(accum[i], op_mul(view->background[i], transmittance)));
    final[3] = op_canonical(op_sub(1.0f, transmittance));
}

/* The display transform of a final colour to RGBA8. fused: see op_pow. */
static inline void shade_display(bool fused, const float final[4], uint8_t display[4])
{
    for (int i = 0; i < 3; i++) {
        float c = op_max(final[i], 0.0f);
        float mapped = op_div(c, op_add(c, 1.0f));
        display[i] = unorm8_from_float(op_pow(fused, mapped, SHADING_DISPLAY_POWER));
    }
    display[3] = 255;
}

#endif

/* frame/shading.h's lighting formula over Bounded numbers: its value is radiance_shade's where form
 * and normal are the same. */
#ifndef PEEL_REF_TRUTH_RADIANCE_BOUND_H
#define PEEL_REF_TRUTH_RADIANCE_BOUND_H

#include "frame/render_desc.h"
#include "frame/view.h"
#include "ref/truth/bounded.h"

#include <stdbool.h>

typedef struct BoundedSurface {
    Bounded position[3], normal[3]; /* the normal's length is 1, or 0 */
    Bounded diffuse[4], roughness, metallic, occlusion;
} BoundedSurface;

typedef struct BoundedForm {
    ShadingModel model;
    GgxForm ggx;
    bool back_light;
} BoundedForm;

/* v · inversesqrt(max(dot(v, v), SHADING_TINY)) */
void radiance_normalize_bound(const Bounded v[3], Bounded out[3]);

/* Linear, not multiplied by alpha. */
void radiance_shade_bound(const View *view, const BoundedSurface *surface, BoundedForm form,
                          Bounded rgb[3]);

#endif

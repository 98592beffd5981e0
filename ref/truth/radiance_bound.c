#include "ref/truth/radiance_bound.h"

typedef Bounded Real;

#define real_of              bounded_of
#define real_neg             bounded_neg
#define real_add             bounded_add
#define real_sub             bounded_sub
#define real_mul             bounded_mul
#define real_div             bounded_div
#define real_sqrt            bounded_sqrt
#define real_inversesqrt     bounded_inversesqrt
#define real_max             bounded_max
#define real_min             bounded_min
#define real_mix             bounded_mix
#define real_dot             bounded_dot
#define real_may_exceed      bounded_may_exceed
#define real_unless_negative bounded_unless_negative

#include "ref/truth/radiance_body.h"

void radiance_normalize_bound(const Bounded v[3], Bounded out[3])
{
    real_normalize(v, out);
}

void radiance_shade_bound(const View *view, const BoundedSurface *surface, BoundedForm form,
                          Bounded rgb[3])
{
    RealSurface real = {.roughness = surface->roughness,
                        .metallic = surface->metallic,
                        .occlusion = surface->occlusion};
    for (int i = 0; i < 3; i++) {
        real.position[i] = surface->position[i];
        real.normal[i] = surface->normal[i];
        real.diffuse[i] = surface->diffuse[i];
    }
    real_shade(view, &real, form.model, form.ggx, form.back_light, rgb);
}

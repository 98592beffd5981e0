/* frame/shading.h's lighting formula over any numbers, in its order of operations: one body for
 * double (radiance.c) and for Bounded (radiance_bound.c).
 *
 * The includer defines the type Real and, inline, real_of, real_neg, real_add, real_sub, real_mul,
 * real_div, real_sqrt, real_inversesqrt, real_max, real_min, real_mix, real_dot, real_may_exceed
 * and real_unless_negative, which bounded.h describes. */
#ifndef PEEL_REF_TRUTH_RADIANCE_BODY_H
#define PEEL_REF_TRUTH_RADIANCE_BODY_H

#include "frame/render_desc.h"
#include "frame/shading.h"
#include "frame/view.h"

#include <stdbool.h>

/* What the lighting pass has of a point. */
typedef struct RealSurface {
    Real position[3], normal[3];
    Real diffuse[3], roughness, metallic, occlusion;
} RealSurface;

/* What all lights share at one surface point; names as in frame/shading.h. */
typedef struct RealPoint {
    Real P[3], N[3], V[3];
    Real a2, am, k, km, GV, NV4;
    Real F0[3], Fm[3], lambert[3];
} RealPoint;

/* v scaled to length 1; where it is all but 0, as the formula's guard does. */
static inline void real_normalize(const Real v[3], Real out[3])
{
    Real scale = real_inversesqrt(real_max(real_dot(v, v), real_of((double)SHADING_TINY)));
    for (int i = 0; i < 3; i++)
        out[i] = real_mul(v[i], scale);
}

static inline RealPoint real_point(const RealSurface *surface)
{
    const Real one = real_of(1.0);
    RealPoint point;
    Real to_eye[3];
    for (int i = 0; i < 3; i++) {
        point.P[i] = surface->position[i];
        point.N[i] = surface->normal[i];
        to_eye[i] = real_neg(surface->position[i]);
    }
    real_normalize(to_eye, point.V);
    Real r = real_min(real_max(surface->roughness, real_of((double)SHADING_ROUGHNESS_MIN)), one);
    Real a = real_mul(r, r), k1 = real_add(r, one);
    point.a2 = real_mul(a, a);
    point.am = real_sub(point.a2, one);
    point.k = real_mul(real_mul(k1, k1), real_of(0.125));
    point.km = real_sub(one, point.k);
    Real NV = real_max(real_dot(point.N, point.V), real_of(0.0));
    point.GV = real_div(NV, real_add(real_mul(NV, point.km), point.k));
    point.NV4 = real_mul(real_of(4.0), NV);
    for (int i = 0; i < 3; i++) {
        point.F0[i] = real_mix(real_of((double)0.04f), surface->diffuse[i], surface->metallic);
        point.Fm[i] = real_sub(one, point.F0[i]);
        point.lambert[i] = real_div(real_mul(surface->diffuse[i], real_sub(one, surface->metallic)),
                                    real_of((double)SHADING_PI));
    }
    return point;
}

/* The distribution's denominator. */
static inline Real real_denominator(const RealPoint *point, const Real H[3], GgxForm ggx)
{
    const Real *N = point->N;
    Real NH = real_max(real_dot(N, H), real_of(0.0)), NH2 = real_mul(NH, NH), S[3];
    if (ggx == GGX_SOURCE)
        return real_add(real_mul(NH2, point->am), real_of(1.0));
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        S[i] = real_sub(real_mul(N[j], H[k]), real_mul(N[k], H[j]));
    }
    return real_max(real_add(real_mul(NH2, point->a2), real_dot(S, S)), point->a2);
}

/* Turns L to the normal's side, and takes the Lambert term of a light behind; u = dot(N, L).
 * Returns |u|. */
static inline Real real_mirror(const RealPoint *point, Real u, Real L[3], Real lambert[3])
{
    Real m = real_max(real_neg(u), real_of(0.0)), twice = real_mul(real_of(2.0), m);
    for (int i = 0; i < 3; i++) {
        L[i] = real_add(L[i], real_mul(twice, point->N[i]));
        lambert[i] = real_unless_negative(u, lambert[i]);
    }
    return real_max(u, m);
}

/* One light's term, added to sum. */
static inline void real_light(const RealPoint *point, const ViewLight *light, GgxForm ggx,
                              bool back_light, Real sum[3])
{
    const Real one = real_of(1.0), zero = real_of(0.0);
    Real D[3], L[3], h[3], H[3];
    for (int i = 0; i < 3; i++)
        D[i] = real_sub(real_of(light->position[i]), point->P[i]);
    Real d2 = real_max(real_dot(D, D), real_of((double)SHADING_DISTANCE2_MIN));
    Real q = real_min(real_mul(d2, real_of(light->inverse_range2)), one);
    if (!real_may_exceed(real_neg(q), -1.0))
        return; /* out of range: the whole term is multiplied by 0 */
    Real d = real_sqrt(d2), inverse = real_div(one, d);
    for (int i = 0; i < 3; i++)
        L[i] = real_mul(D[i], inverse);
    Real u = real_dot(point->N, L), NL = real_max(u, zero);
    Real lambert[3] = {point->lambert[0], point->lambert[1], point->lambert[2]};
    if (back_light)
        NL = real_mirror(point, u, L, lambert);
    if (!real_may_exceed(NL, 0.0))
        return; /* likewise */
    for (int i = 0; i < 3; i++)
        h[i] = real_add(point->V[i], L[i]);
    real_normalize(h, H);
    Real HV = real_max(real_dot(H, point->V), zero);
    Real den = real_denominator(point, H, ggx);
    Real dist = real_div(point->a2, real_mul(real_mul(real_of((double)SHADING_PI), den), den));
    Real GL = real_div(NL, real_add(real_mul(NL, point->km), point->k));
    Real x = real_min(real_max(real_sub(one, HV), zero), one);
    Real x2 = real_mul(x, x), x5 = real_mul(real_mul(x2, x2), x);
    Real s = real_div(real_mul(dist, real_mul(point->GV, GL)),
                      real_add(real_mul(point->NV4, NL), real_of((double)SHADING_SPECULAR_BIAS)));
    const float *att = light->attenuation;
    Real attenuation =
        real_div(one, real_add(real_add(real_of(att[0]), real_mul(real_of(att[1]), d)),
                               real_mul(real_of(att[2]), d2)));
    if (light->inverse_range2 > 0.0f)
        attenuation = real_mul(attenuation, real_sub(one, real_mul(q, q)));
    for (int i = 0; i < 3; i++) {
        Real F = real_add(point->F0[i], real_mul(point->Fm[i], x5));
        Real reflected = real_add(real_mul(real_sub(one, F), lambert[i]), real_mul(F, s));
        Real radiance = real_mul(real_mul(real_of(light->color[i]), attenuation), NL);
        sum[i] = real_add(sum[i], real_mul(reflected, radiance));
    }
}

static inline void real_phong(const RealSurface *surface, Real rgb[3])
{
    const Real light[3] = {real_of((double)SHADING_PHONG_LIGHT_X),
                           real_of((double)SHADING_PHONG_LIGHT_Y),
                           real_of((double)SHADING_PHONG_LIGHT_Z)};
    const Real *N = surface->normal, zero = real_of(0.0);
    Real NL = real_dot(N, light);
    Real x = real_max(real_sub(real_mul(real_mul(real_of(2.0), NL), N[2]), light[2]), zero);
    Real x2 = real_mul(x, x), x4 = real_mul(x2, x2), x8 = real_mul(x4, x4);
    Real x20 = real_mul(real_mul(x8, x8), x4), lit = real_max(NL, zero);
    for (int i = 0; i < 3; i++) {
        Real ambient =
            real_of((double)(i == 0 ? SHADING_PHONG_AMBIENT_R : SHADING_PHONG_AMBIENT_GB));
        rgb[i] = real_add(real_add(ambient, real_mul(lit, surface->diffuse[i])), x20);
    }
}

/* c of the formula. */
static inline void real_shade(const View *view, const RealSurface *surface, ShadingModel model,
                              GgxForm ggx, bool back_light, Real rgb[3])
{
    if (model == SHADING_PHONG) {
        real_phong(surface, rgb);
        return;
    }
    RealPoint point = real_point(surface);
    for (int i = 0; i < 3; i++)
        rgb[i] = real_of(0.0);
    for (size_t light = 0; light < view->light_count; light++)
        real_light(&point, &view->lights[light], ggx, back_light, rgb);
    for (int i = 0; i < 3; i++)
        rgb[i] = real_add(rgb[i], real_mul(real_mul(real_of(view->ambient[i]), surface->diffuse[i]),
                                           surface->occlusion));
}

#endif

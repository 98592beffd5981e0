/* peel_shade.h: the light that a surface sends to the eye, as Peel's renderers compute it. C99 or
 * C++, this one file. The same formula in GLSL is shade.glsl; both follow it operation by
 * operation, so that on the same inputs they have the same bits:
 *
 *     every operation in single precision, rounded to nearest; nothing fused or reordered
 *     (-ffp-contract=off, no -ffast-math); denormals are flushed to 0 (on x86: FTZ and DAZ);
 *     a dot product is summed from the last component to the first, as Mesa's llvmpipe does.
 *
 * Source: L. Rapetta, "OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling": Cook-Torrance
 * with GGX distribution, Schlick-GGX geometry term, Schlick's Fresnel. Everything is in view space;
 * the eye is at 0. */
#ifndef PEEL_SHADE_H
#define PEEL_SHADE_H

#include <math.h>

#define PEEL_SHADE_TINY          1e-20f
#define PEEL_SHADE_ALPHA_TEST    1e-4f
#define PEEL_SHADE_ROUGHNESS_MIN 0.045f
#define PEEL_SHADE_DISTANCE2_MIN 1e-4f
#define PEEL_SHADE_SPECULAR_BIAS 1e-4f
#define PEEL_SHADE_PI            3.14159265f
#define PEEL_SHADE_DISPLAY_POWER 0.45454547f /* 1/2.2 */

/* Flags of peel_shade. */
#define PEEL_SHADE_STABLE     1u /* --ggx stable */
#define PEEL_SHADE_BACK_LIGHT 2u /* --back-light on, for transparent surfaces */

typedef struct PeelShadeLight {
    float position[3];
    float color[3];
    float attenuation[3]; /* constant, linear, quadratic */
    float inverse_range2; /* 1/range^2; 0: without end */
} PeelShadeLight;

typedef struct PeelShadeSurface {
    float normal[3]; /* of length 1, turned to the viewer */
    float position[3];
    float base[4]; /* linear colour, and alpha */
    float roughness, metallic, occlusion;
} PeelShadeSurface;

static inline float peel_shade_max(float a, float b)
{
    return a > b ? a : b;
}

static inline float peel_shade_min(float a, float b)
{
    return a < b ? a : b;
}

static inline float peel_shade_dot(const float a[3], const float b[3])
{
    return (a[2] * b[2] + a[1] * b[1]) + a[0] * b[0];
}

/* v / |v|, 0 of 0. */
static inline void peel_shade_normalize(const float v[3], float out[3])
{
    float scale = 1.0f / sqrtf(peel_shade_max(peel_shade_dot(v, v), PEEL_SHADE_TINY));
    int i;
    for (i = 0; i < 3; i++)
        out[i] = v[i] * scale;
}

/* What does not depend on the light. */
typedef struct PeelShadeTerms {
    float V[3], f0[3], lambert[3];
    float a2, k, km, GV, NV4;
} PeelShadeTerms;

static inline PeelShadeTerms peel_shade_terms(const PeelShadeSurface *surface)
{
    PeelShadeTerms out;
    float eye[3], r, a, k1, NV;
    int i;
    for (i = 0; i < 3; i++)
        eye[i] = -surface->position[i];
    peel_shade_normalize(eye, out.V);
    r = peel_shade_min(peel_shade_max(surface->roughness, PEEL_SHADE_ROUGHNESS_MIN), 1.0f);
    a = r * r;
    out.a2 = a * a;
    k1 = r + 1.0f;
    out.k = k1 * k1 * 0.125f;
    out.km = 1.0f - out.k;
    NV = peel_shade_max(peel_shade_dot(surface->normal, out.V), 0.0f);
    out.GV = NV / (NV * out.km + out.k);
    out.NV4 = 4.0f * NV;
    for (i = 0; i < 3; i++) {
        out.f0[i] = 0.04f * (1.0f - surface->metallic) + surface->base[i] * surface->metallic;
        out.lambert[i] = surface->base[i] * (1.0f - surface->metallic) / PEEL_SHADE_PI;
    }
    return out;
}

/* The denominator of the GGX distribution, before it is squared. */
static inline float peel_shade_denominator(const float N[3], const float H[3], float a2,
                                           unsigned flags)
{
    float NH = peel_shade_max(peel_shade_dot(N, H), 0.0f), S[3];
    int i;
    if (!(flags & PEEL_SHADE_STABLE))
        return NH * NH * (a2 - 1.0f) + 1.0f;
    for (i = 0; i < 3; i++)
        S[i] = N[(i + 1) % 3] * H[(i + 2) % 3] - N[(i + 2) % 3] * H[(i + 1) % 3];
    return peel_shade_max(NH * NH * a2 + peel_shade_dot(S, S), a2);
}

/* Adds what one light reflects. */
static inline void peel_shade_light(const PeelShadeSurface *surface, const PeelShadeTerms *terms,
                                    const PeelShadeLight *light, unsigned flags, float sum[3])
{
    const float *N = surface->normal;
    float D[3], L[3], h[3], H[3], d2, d, u, NL, m, HV, den, dist, GL, x, x5, s, att, q;
    int i;
    for (i = 0; i < 3; i++)
        D[i] = light->position[i] - surface->position[i];
    d2 = peel_shade_max(peel_shade_dot(D, D), PEEL_SHADE_DISTANCE2_MIN);
    d = sqrtf(d2);
    for (i = 0; i < 3; i++)
        L[i] = D[i] * (1.0f / d);
    u = peel_shade_dot(N, L);
    NL = peel_shade_max(u, 0.0f);
    if (flags & PEEL_SHADE_BACK_LIGHT) {
        m = peel_shade_max(-u, 0.0f);
        NL = peel_shade_max(u, m);
        for (i = 0; i < 3; i++)
            L[i] = L[i] + 2.0f * m * N[i];
    }
    for (i = 0; i < 3; i++)
        h[i] = terms->V[i] + L[i];
    peel_shade_normalize(h, H);
    HV = peel_shade_max(peel_shade_dot(H, terms->V), 0.0f);
    den = peel_shade_denominator(N, H, terms->a2, flags);
    dist = terms->a2 / (PEEL_SHADE_PI * den * den);
    GL = NL / (NL * terms->km + terms->k);
    x = peel_shade_min(peel_shade_max(1.0f - HV, 0.0f), 1.0f);
    x5 = x * x * (x * x) * x;
    s = dist * (terms->GV * GL) / (terms->NV4 * NL + PEEL_SHADE_SPECULAR_BIAS);
    att = 1.0f / (light->attenuation[0] + light->attenuation[1] * d + light->attenuation[2] * d2);
    if (light->inverse_range2 > 0.0f) {
        q = peel_shade_min(d2 * light->inverse_range2, 1.0f);
        att = att * (1.0f - q * q);
    }
    for (i = 0; i < 3; i++) {
        float direct = (flags & PEEL_SHADE_BACK_LIGHT) && u < 0.0f ? 0.0f : terms->lambert[i];
        float F = terms->f0[i] + (1.0f - terms->f0[i]) * x5;
        sum[i] = sum[i] + ((1.0f - F) * direct + F * s) * (light->color[i] * att * NL);
    }
}

/* source: the colour multiplied by alpha, and alpha. Not for surfaces with an alpha of at most
 * PEEL_SHADE_ALPHA_TEST: these are left out. */
static inline void peel_shade(const PeelShadeSurface *surface, const PeelShadeLight *lights,
                              int light_count, const float ambient[3], unsigned flags,
                              float source[4])
{
    PeelShadeTerms terms = peel_shade_terms(surface);
    float sum[3] = {0.0f, 0.0f, 0.0f}, alpha = surface->base[3];
    int i;
    for (i = 0; i < light_count; i++)
        peel_shade_light(surface, &terms, &lights[i], flags, sum);
    for (i = 0; i < 3; i++)
        source[i] = (sum[i] + ambient[i] * surface->base[i] * surface->occlusion) * alpha;
    source[3] = alpha;
}

/* Blends a layer under what is in front of it: glBlendFuncSeparate(GL_DST_ALPHA, GL_ONE, GL_ZERO,
 * GL_ONE_MINUS_SRC_ALPHA). accum begins as (0, 0, 0, 1); its alpha is the transmittance. */
static inline void peel_shade_under(const float source[4], float accum[4])
{
    int i;
    for (i = 0; i < 3; i++)
        accum[i] = source[i] * accum[3] + accum[i];
    accum[3] = accum[3] * (1.0f - source[3]);
}

/* The final colour over the background, and its coverage. */
static inline void peel_shade_final(const float accum[4], const float background[3], float out[4])
{
    int i;
    for (i = 0; i < 3; i++)
        out[i] = accum[i] + background[i] * accum[3];
    out[3] = 1.0f - accum[3];
}

/* What is shown, 0 to 1, of a channel of the final colour. */
static inline float peel_shade_display(float c)
{
    c = peel_shade_max(c, 0.0f);
    return powf(c / (c + 1.0f), PEEL_SHADE_DISPLAY_POWER);
}

#endif

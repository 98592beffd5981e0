/* The lighting pass of LANES pixels: frame/shading.h through number/lanes.h, one body for every
 * width. With LANES 1 it is the definition. */
#ifndef PEEL_REF_SHADE_BODY_H
#define PEEL_REF_SHADE_BODY_H

#include "frame/shading.h"
#include "frame/view.h"
#include "number/lanes.h"
#include "ref/pipeline/shade.h"

/* Fetched G-buffer values, one array entry per lane; alpha has passed the alpha test. */
typedef struct ShadeBatch {
    float normal[3][LANES], position[3][LANES], diffuse[4][LANES], material[3][LANES];
    float source[4][LANES]; /* out: premultiplied colour and alpha */
} ShadeBatch;

/* What does not depend on the light. */
typedef struct Surface {
    Lanes normal[3], position[3], view[3];
    Lanes a2, a2_minus_1;
    Lanes k, one_minus_k;
    Lanes geometry_view; /* Schlick-GGX towards the eye */
    Lanes four_n_dot_v;
    Lanes f0[3], one_minus_f0[3];
    Lanes lambert[3];
} Surface;

/* v / |v|, guarded so that a zero vector stays zero. */
static inline void shade_normalize(const Lanes v[3], Lanes out[3])
{
    Lanes scale = lanes_inversesqrt(lanes_max(lanes_dot3(v, v), lanes_all(SHADING_TINY)));
    for (int i = 0; i < 3; i++)
        out[i] = lanes_mul(v[i], scale);
}

static inline void shade_surface(const ShadeBatch *batch, Surface *out)
{
    Lanes one = lanes_all(1.0f), zero = lanes_all(0.0f);
    Lanes to_eye[3];
    for (int i = 0; i < 3; i++) {
        out->normal[i] = lanes_load(batch->normal[i]);
        out->position[i] = lanes_load(batch->position[i]);
        to_eye[i] = LANES_NEG(out->position[i]);
    }
    shade_normalize(to_eye, out->view);

    Lanes roughness =
        lanes_min(lanes_max(lanes_load(batch->material[0]), lanes_all(SHADING_ROUGHNESS_MIN)), one);
    Lanes metallic = lanes_load(batch->material[1]);
    Lanes a = lanes_mul(roughness, roughness);
    out->a2 = lanes_mul(a, a);
    out->a2_minus_1 = lanes_sub(out->a2, one);
    Lanes k1 = lanes_add(roughness, one);
    out->k = lanes_mul(lanes_mul(k1, k1), lanes_all(0.125f));
    out->one_minus_k = lanes_sub(one, out->k);
    Lanes n_dot_v = lanes_max(lanes_dot3(out->normal, out->view), zero);
    out->geometry_view =
        lanes_div(n_dot_v, lanes_add(lanes_mul(n_dot_v, out->one_minus_k), out->k));
    out->four_n_dot_v = lanes_mul(lanes_all(4.0f), n_dot_v);
    for (int i = 0; i < 3; i++) {
        Lanes diffuse = lanes_load(batch->diffuse[i]);
        out->f0[i] = lanes_mix(lanes_all(0.04f), diffuse, metallic);
        out->one_minus_f0[i] = lanes_sub(one, out->f0[i]);
        out->lambert[i] =
            lanes_div(lanes_mul(diffuse, lanes_sub(one, metallic)), lanes_all(SHADING_PI));
    }
}

/* The distribution's denominator, in the form asked for. */
static inline Lanes shade_denominator(const ShadeForm *form, const Surface *surface,
                                      const Lanes half_vector[3])
{
    Lanes n_dot_h = lanes_max(lanes_dot3(surface->normal, half_vector), lanes_all(0.0f));
    Lanes n_dot_h2 = lanes_mul(n_dot_h, n_dot_h), sine[3];
    if (form->ggx == GGX_SOURCE)
        return lanes_add(lanes_mul(n_dot_h2, surface->a2_minus_1), lanes_all(1.0f));
    lanes_cross(surface->normal, half_vector, sine);
    return lanes_max(lanes_add(lanes_mul(n_dot_h2, surface->a2), lanes_dot3(sine, sine)),
                     surface->a2);
}

/* What a light adds is computed in four stages, each over a chunk of lights and through memory: one
 * light's operations depend on each other, different lights' do not, and a processor sees only so
 * far ahead. 16 lights are a few KiB. */
enum {
    SHADE_CHUNK = 16,
    SHADE_LIST = 128 /* lights that are looked at together */
};

/* One light, between stages. */
typedef struct Incidence {
    Lanes distance, falloff;           /* 1: falloff is 1/attenuation, but for the window */
    Lanes window;                      /* 1: where the light has a range */
    Lanes u, n_dot_l;                  /* 2: dot(N, L), and NL */
    Lanes half_sum[3], half_length;    /* 2: V + L, and its guarded length */
    Lanes denominator, fresnel_weight; /* 3: of the distribution; (1 - H.V)^5 */
} Incidence;

static inline void shade_to_light(const Surface *surface, const ViewLight *light, Lanes out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = lanes_sub(lanes_all(light->position[i]), surface->position[i]);
}

/* What a light's range leaves of it: exactly 0 beyond. */
static inline Lanes shade_window(const ViewLight *light, Lanes distance2)
{
    Lanes one = lanes_all(1.0f);
    Lanes q = lanes_min(lanes_mul(distance2, lanes_all(light->inverse_range2)), one);
    return lanes_sub(one, lanes_mul(q, q));
}

static inline Lanes shade_distance2(const Lanes to_light[3])
{
    return lanes_max(lanes_dot3(to_light, to_light), lanes_all(SHADING_DISTANCE2_MIN));
}

/* Stage 1. */
static inline void shade_distance(const Surface *surface, const ViewLight *light, Incidence *out)
{
    Lanes to_light[3];
    shade_to_light(surface, light, to_light);
    Lanes distance2 = shade_distance2(to_light);
    if (light->inverse_range2 > 0.0f)
        out->window = shade_window(light, distance2);
    out->distance = lanes_sqrt(distance2);
    out->falloff = lanes_add(lanes_add(lanes_all(light->attenuation[0]),
                                       lanes_mul(lanes_all(light->attenuation[1]), out->distance)),
                             lanes_mul(lanes_all(light->attenuation[2]), distance2));
}

/* Mirrors the directions of lights behind the surface to its normal's side. Returns |u|. */
static inline Lanes shade_mirror(const Surface *surface, Lanes u, Lanes direction[3])
{
    Lanes behind = lanes_max(LANES_NEG(u), lanes_all(0.0f));
    Lanes twice = lanes_mul(lanes_all(2.0f), behind);
    for (int i = 0; i < 3; i++)
        direction[i] = lanes_add(direction[i], lanes_mul(twice, surface->normal[i]));
    return lanes_max(u, behind);
}

/* Stage 2. */
static inline void shade_direction(bool back_light, const Surface *surface, const ViewLight *light,
                                   Incidence *out)
{
    Lanes direction[3], inverse_distance = lanes_div(lanes_all(1.0f), out->distance);
    shade_to_light(surface, light, direction);
    for (int i = 0; i < 3; i++)
        direction[i] = lanes_mul(direction[i], inverse_distance);
    Lanes u = lanes_dot3(surface->normal, direction);
    out->n_dot_l = lanes_max(u, lanes_all(0.0f));
    if (back_light) {
        out->u = u;
        out->n_dot_l = shade_mirror(surface, u, direction);
    }
    for (int i = 0; i < 3; i++) {
        direction[i] = lanes_add(surface->view[i], direction[i]);
        out->half_sum[i] = direction[i];
    }
    out->half_length =
        lanes_sqrt(lanes_max(lanes_dot3(direction, direction), lanes_all(SHADING_TINY)));
}

/* Stage 3. */
static inline void shade_half_vector(const ShadeForm *form, const Surface *surface, Incidence *out)
{
    Lanes one = lanes_all(1.0f), zero = lanes_all(0.0f), half_vector[3];
    Lanes scale = lanes_div(one, out->half_length);
    for (int i = 0; i < 3; i++)
        half_vector[i] = lanes_mul(out->half_sum[i], scale);
    Lanes h_dot_v = lanes_max(lanes_dot3(half_vector, surface->view), zero);
    out->denominator = shade_denominator(form, surface, half_vector);
    /* clamp(x, 0, 1), in the order that gives 0 for −0 and below. */
    Lanes x = lanes_min(lanes_max(lanes_sub(one, h_dot_v), zero), one);
    Lanes x2 = lanes_mul(x, x);
    out->fresnel_weight = lanes_mul(lanes_mul(x2, x2), x);
}

/* What one light's term is made of. */
typedef struct Reflection {
    Lanes distribution, geometry, specular, attenuation;
    Lanes fresnel[3], term[3];
} Reflection;

/* Stage 4. */
static inline __attribute__((always_inline)) void
shade_reflection(bool back_light, const Surface *surface, const ViewLight *light,
                 const Incidence *in, Reflection *out)
{
    Lanes one = lanes_all(1.0f), zero = lanes_all(0.0f), n_dot_l = in->n_dot_l;
    out->distribution = lanes_div(
        surface->a2, lanes_mul(lanes_mul(lanes_all(SHADING_PI), in->denominator), in->denominator));
    Lanes geometry_light =
        lanes_div(n_dot_l, lanes_add(lanes_mul(n_dot_l, surface->one_minus_k), surface->k));
    out->geometry = lanes_mul(surface->geometry_view, geometry_light);
    out->specular = lanes_div(
        lanes_mul(out->distribution, out->geometry),
        lanes_add(lanes_mul(surface->four_n_dot_v, n_dot_l), lanes_all(SHADING_SPECULAR_BIAS)));
    out->attenuation = lanes_div(one, in->falloff);
    if (light->inverse_range2 > 0.0f) /* as where the window was made; NOLINTNEXTLINE */
        out->attenuation = lanes_mul(out->attenuation, in->window);
    for (int i = 0; i < 3; i++) {
        Lanes lambert = surface->lambert[i];
        if (back_light)
            lambert = lanes_where_less(in->u, zero, zero, lambert);
        Lanes fresnel =
            lanes_add(surface->f0[i], lanes_mul(surface->one_minus_f0[i], in->fresnel_weight));
        Lanes reflected = lanes_add(lanes_mul(lanes_sub(one, fresnel), lambert),
                                    lanes_mul(fresnel, out->specular));
        Lanes radiance =
            lanes_mul(lanes_mul(lanes_all(light->color[i]), out->attenuation), n_dot_l);
        out->fresnel[i] = fresnel;
        out->term[i] = lanes_mul(reflected, radiance);
    }
}

static inline void shade_add(bool back_light, const Surface *surface, const ViewLight *light,
                             const Incidence *in, Lanes sum[3])
{
    Reflection reflection;
    shade_reflection(back_light, surface, light, in, &reflection);
    for (int i = 0; i < 3; i++)
        sum[i] = lanes_add(sum[i], reflection.term[i]);
}

/* Adds what `count` lights, at most SHADE_CHUNK, reflect, in their order. */
static inline void shade_chunk(const ShadeForm *form, const Surface *surface,
                               const ViewLight *const *lights, int count, Lanes sum[3])
{
    Incidence incidence[SHADE_CHUNK];
    bool back_light = form->back_light;
    for (int i = 0; i < count; i++)
        shade_distance(surface, lights[i], &incidence[i]);
    for (int i = 0; i < count; i++)
        shade_direction(back_light, surface, lights[i], &incidence[i]);
    for (int i = 0; i < count; i++)
        shade_half_vector(form, surface, &incidence[i]);
    for (int i = 0; i < count; i++)
        shade_add(back_light, surface, lights[i], &incidence[i], sum);
}

/* Lanes where 0 <= x <= 1, false for NaN. */
static inline LanesMask shade_in_unit(Lanes x)
{
    return lanes_mask_without(lanes_less(x, lanes_all(0x1.000002p0f)),
                              lanes_less(x, lanes_all(0.0f)));
}

/* |x| + |y| + |z|, at least the length. */
static inline Lanes shade_size(const Lanes v[3])
{
    Lanes sum = lanes_max(v[0], LANES_NEG(v[0]));
    for (int i = 1; i < 3; i++)
        sum = lanes_add(sum, lanes_max(v[i], LANES_NEG(v[i])));
    return sum;
}

/* Whether a light with NL = 0, or out of its range, in every lane adds +0 to every sum, so that it
 * can be left out: there is nothing to mirror, and no term can be negative or other than finite.
 *
 * With colours and metallic in [0, 1], rounding keeps F0, 1 − F0, F, 1 − F and the Lambert term in
 * [0, 1]. |N|² ≤ 1 + 2^-20 and |H|² ≤ 1 + 2^-21 keep the source's denominator above
 * a2 − 2.4e-6 ≥ 1.6e-6, so that the distribution is below 1e6, GV and GL below 8 and s below 1e12;
 * attenuation times colour is below 2e20 (view->light_reach), as no distance² reaches 2^101. So
 * reflected and color·att are finite and not negative, their product with NL = +0 is a zero, and
 * a sum, which began as +0 and to which nothing negative was added, is never −0: adding either zero
 * leaves it as it is. A window of 0 makes color·att such a zero. */
static inline bool shade_may_skip(const View *view, const ShadeForm *form, const ShadeBatch *batch,
                                  const Surface *surface)
{
    if (form->back_light || !(view->light_reach > 0.0f))
        return false;
    LanesMask plain =
        lanes_less(lanes_dot3(surface->normal, surface->normal), lanes_all(1.0f + 0x1p-20f));
    plain = lanes_mask_and(plain, lanes_less(shade_size(surface->position), lanes_all(0x1p48f)));
    plain = lanes_mask_and(plain, shade_in_unit(lanes_load(batch->material[1])));
    for (int i = 0; i < 3; i++)
        plain = lanes_mask_and(plain, shade_in_unit(lanes_load(batch->diffuse[i])));
    return lanes_mask_bits(plain) == LANES_FULL;
}

/* Lights of which dot(N, position) is less than this have NL = 0.
 *
 * dot(N, position) − dot(N, P) is d·u in exact arithmetic. With e = 2^-24 and
 * R = |position| + |P| ≥ |D|, the two dots and the difference are off by less than 4.2eR, and the
 * rounded u by less than 5.2e|D|/d: a margin of 16eR, and 2^-60 against what is flushed, leaves the
 * rounded u below 0. */
static inline Lanes shade_threshold(const View *view, const Surface *surface)
{
    Lanes size = lanes_add(lanes_all(view->light_reach), shade_size(surface->position));
    Lanes margin = lanes_add(lanes_mul(size, lanes_all(0x1p-20f)), lanes_all(0x1p-60f));
    return lanes_sub(lanes_dot3(surface->normal, surface->position), margin);
}

/* Whether the light is before the surface in some lane. */
static inline bool shade_faces(const Surface *surface, const ViewLight *light, Lanes threshold)
{
    Lanes position[3];
    for (int i = 0; i < 3; i++)
        position[i] = lanes_all(light->position[i]);
    LanesMask behind = lanes_less(lanes_dot3(surface->normal, position), threshold);
    return lanes_mask_bits(behind) != LANES_FULL;
}

/* Whether some lane is within the light's range. */
static inline bool shade_reaches(const Surface *surface, const ViewLight *light)
{
    if (!(light->inverse_range2 > 0.0f))
        return true;
    Lanes to_light[3];
    shade_to_light(surface, light, to_light);
    Lanes window = shade_window(light, shade_distance2(to_light));
    return lanes_mask_bits(lanes_less(lanes_all(0.0f), window)) != 0;
}

/* The next SHADE_LIST lights from `first` that may add something, to `out`. Returns how many. */
static inline int shade_select(const View *view, const Surface *surface, bool skip, size_t first,
                               const ViewLight **out)
{
    size_t end = view->light_count - first < SHADE_LIST ? view->light_count : first + SHADE_LIST;
    Lanes threshold = shade_threshold(view, surface);
    int facing = 0, count = 0;
    for (size_t i = first; i < end; i++) {
        out[facing] = &view->lights[i];
        facing += !skip || shade_faces(surface, &view->lights[i], threshold);
    }
    if (!skip || !view->ranged)
        return facing;
    for (int i = 0; i < facing; i++) {
        out[count] = out[i];
        count += shade_reaches(surface, out[i]);
    }
    return count;
}

/* skip: leave out the lights that add +0. */
static inline void shade_lights(const View *view, const ShadeForm *form, const Surface *surface,
                                bool skip, Lanes sum[3])
{
    const ViewLight *lights[SHADE_LIST];
    for (size_t first = 0; first < view->light_count; first += SHADE_LIST) {
        int count = shade_select(view, surface, skip, first, lights);
        for (int i = 0; i < count; i += SHADE_CHUNK)
            shade_chunk(form, surface, lights + i,
                        count - i < SHADE_CHUNK ? count - i : SHADE_CHUNK, sum);
    }
}

static inline void shade_phong(ShadeBatch *batch)
{
    const Lanes zero = lanes_all(0.0f), two = lanes_all(2.0f);
    const Lanes light[3] = {lanes_all(SHADING_PHONG_LIGHT_X), lanes_all(SHADING_PHONG_LIGHT_Y),
                            lanes_all(SHADING_PHONG_LIGHT_Z)};
    Lanes normal[3];
    for (int i = 0; i < 3; i++)
        normal[i] = lanes_load(batch->normal[i]);
    Lanes n_dot_l = lanes_dot3(normal, light);
    Lanes reflected_z = lanes_sub(lanes_mul(lanes_mul(two, n_dot_l), normal[2]), light[2]);
    Lanes x = lanes_max(reflected_z, zero);
    Lanes x2 = lanes_mul(x, x), x4 = lanes_mul(x2, x2), x8 = lanes_mul(x4, x4);
    Lanes x20 = lanes_mul(lanes_mul(x8, x8), x4);
    Lanes lit = lanes_max(n_dot_l, zero), alpha = lanes_load(batch->diffuse[3]);
    for (int i = 0; i < 3; i++) {
        Lanes ambient = lanes_all(i == 0 ? SHADING_PHONG_AMBIENT_R : SHADING_PHONG_AMBIENT_GB);
        Lanes c = lanes_add(ambient, lanes_mul(lit, lanes_load(batch->diffuse[i])));
        lanes_store(batch->source[i], lanes_mul(lanes_add(c, x20), alpha));
    }
    lanes_store(batch->source[3], alpha);
}

/* The Lambert term without its 1/π. */
static inline void shade_whole_lambert(const ShadeBatch *batch, Surface *surface)
{
    Lanes rest = lanes_sub(lanes_all(1.0f), lanes_load(batch->material[1]));
    for (int i = 0; i < 3; i++)
        surface->lambert[i] = lanes_mul(lanes_load(batch->diffuse[i]), rest);
}

static inline __attribute__((always_inline)) void
shade_ambient(const View *view, const ShadeBatch *batch, Lanes ambient[3])
{
    for (int i = 0; i < 3; i++)
        ambient[i] =
            lanes_mul(lanes_mul(lanes_all(view->ambient[i]), lanes_load(batch->diffuse[i])),
                      lanes_load(batch->material[2]));
}

/* Fills batch->source. skip: leave out lights where that changes no bit; without it this is the
 * definition. Flushing mode. */
static inline void shade_batch_skipping(const View *view, const ShadeForm *form, bool skip,
                                        ShadeBatch *batch)
{
    if (form->model == SHADING_PHONG) {
        shade_phong(batch);
        return;
    }
    Lanes sum[3] = {lanes_all(0.0f), lanes_all(0.0f), lanes_all(0.0f)};
    if (view->light_count > 0) {
        Surface surface;
        shade_surface(batch, &surface);
        if (form->lambert_whole)
            shade_whole_lambert(batch, &surface);
        skip = skip && shade_may_skip(view, form, batch, &surface);
        shade_lights(view, form, &surface, skip, sum);
    }
    Lanes alpha = lanes_load(batch->diffuse[3]), ambient[3];
    shade_ambient(view, batch, ambient);
    for (int i = 0; i < 3; i++)
        lanes_store(batch->source[i], lanes_mul(lanes_add(sum[i], ambient[i]), alpha));
    lanes_store(batch->source[3], alpha);
}

static inline void shade_batch(const View *view, const ShadeForm *form, ShadeBatch *batch)
{
    shade_batch_skipping(view, form, true, batch);
}

#endif

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

/* Mirrors the directions of lights behind the surface to its normal's side, and takes their
 * Lambert term; u = dot(N, L). Returns |u|. */
static inline Lanes shade_mirror(const Surface *surface, Lanes u, Lanes direction[3],
                                 Lanes lambert[3])
{
    Lanes zero = lanes_all(0.0f), behind = lanes_max(LANES_NEG(u), zero);
    Lanes twice = lanes_mul(lanes_all(2.0f), behind);
    for (int i = 0; i < 3; i++) {
        direction[i] = lanes_add(direction[i], lanes_mul(twice, surface->normal[i]));
        lambert[i] = lanes_where_less(u, zero, zero, lambert[i]);
    }
    return lanes_max(u, behind);
}

/* What a light's range leaves of it: exactly 0 beyond. */
static inline Lanes shade_window(const ViewLight *light, Lanes distance2)
{
    Lanes one = lanes_all(1.0f);
    Lanes q = lanes_min(lanes_mul(distance2, lanes_all(light->inverse_range2)), one);
    return lanes_sub(one, lanes_mul(q, q));
}

static inline void shade_light(const ShadeForm *form, const Surface *surface,
                               const ViewLight *light, Lanes sum[3])
{
    Lanes one = lanes_all(1.0f), zero = lanes_all(0.0f);
    Lanes to_light[3], direction[3], half_sum[3], half_vector[3];
    for (int i = 0; i < 3; i++)
        to_light[i] = lanes_sub(lanes_all(light->position[i]), surface->position[i]);
    Lanes distance2 = lanes_max(lanes_dot3(to_light, to_light), lanes_all(SHADING_DISTANCE2_MIN));
    Lanes distance = lanes_sqrt(distance2);
    Lanes inverse_distance = lanes_div(one, distance);
    for (int i = 0; i < 3; i++)
        direction[i] = lanes_mul(to_light[i], inverse_distance);
    Lanes u = lanes_dot3(surface->normal, direction), n_dot_l = lanes_max(u, zero);
    Lanes lambert[3] = {surface->lambert[0], surface->lambert[1], surface->lambert[2]};
    if (form->back_light)
        n_dot_l = shade_mirror(surface, u, direction, lambert);
    for (int i = 0; i < 3; i++)
        half_sum[i] = lanes_add(surface->view[i], direction[i]);
    shade_normalize(half_sum, half_vector);
    Lanes h_dot_v = lanes_max(lanes_dot3(half_vector, surface->view), zero);

    Lanes denominator = shade_denominator(form, surface, half_vector);
    Lanes distribution = lanes_div(
        surface->a2, lanes_mul(lanes_mul(lanes_all(SHADING_PI), denominator), denominator));
    Lanes geometry_light =
        lanes_div(n_dot_l, lanes_add(lanes_mul(n_dot_l, surface->one_minus_k), surface->k));
    /* clamp(x, 0, 1), in the order that gives 0 for −0 and below. */
    Lanes x = lanes_min(lanes_max(lanes_sub(one, h_dot_v), zero), one);
    Lanes x2 = lanes_mul(x, x);
    Lanes x5 = lanes_mul(lanes_mul(x2, x2), x);
    Lanes specular = lanes_div(
        lanes_mul(distribution, lanes_mul(surface->geometry_view, geometry_light)),
        lanes_add(lanes_mul(surface->four_n_dot_v, n_dot_l), lanes_all(SHADING_SPECULAR_BIAS)));
    Lanes attenuation =
        lanes_div(one, lanes_add(lanes_add(lanes_all(light->attenuation[0]),
                                           lanes_mul(lanes_all(light->attenuation[1]), distance)),
                                 lanes_mul(lanes_all(light->attenuation[2]), distance2)));
    if (light->inverse_range2 > 0.0f)
        attenuation = lanes_mul(attenuation, shade_window(light, distance2));
    for (int i = 0; i < 3; i++) {
        Lanes fresnel = lanes_add(surface->f0[i], lanes_mul(surface->one_minus_f0[i], x5));
        Lanes reflected =
            lanes_add(lanes_mul(lanes_sub(one, fresnel), lambert[i]), lanes_mul(fresnel, specular));
        Lanes radiance = lanes_mul(lanes_mul(lanes_all(light->color[i]), attenuation), n_dot_l);
        sum[i] = lanes_add(sum[i], lanes_mul(reflected, radiance));
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

/* Fills batch->source. Flushing mode. */
static inline void shade_batch(const View *view, const ShadeForm *form, ShadeBatch *batch)
{
    if (form->model == SHADING_PHONG) {
        shade_phong(batch);
        return;
    }
    Surface surface;
    shade_surface(batch, &surface);
    Lanes sum[3] = {lanes_all(0.0f), lanes_all(0.0f), lanes_all(0.0f)};
    for (size_t i = 0; i < view->light_count; i++)
        shade_light(form, &surface, &view->lights[i], sum);
    Lanes alpha = lanes_load(batch->diffuse[3]);
    for (int i = 0; i < 3; i++) {
        Lanes ambient =
            lanes_mul(lanes_mul(lanes_all(view->ambient[i]), lanes_load(batch->diffuse[i])),
                      lanes_load(batch->material[2]));
        lanes_store(batch->source[i], lanes_mul(lanes_add(sum[i], ambient), alpha));
    }
    lanes_store(batch->source[3], alpha);
}

#endif

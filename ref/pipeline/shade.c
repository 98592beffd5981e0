#include "ref/pipeline/shade.h"

#include "frame/shading.h"
#include "number/op.h"

/* v / |v|, guarded so that a zero vector stays zero. */
static void normalize(const float v[3], float out[3])
{
    float scale = op_inversesqrt(op_max(op_dot3(v, v), SHADING_TINY));
    for (int i = 0; i < 3; i++)
        out[i] = op_mul(v[i], scale);
}

/* What does not depend on the light. */
typedef struct Surface {
    float view[3];
    float a2, a2_minus_1;
    float k, one_minus_k;
    float geometry_view; /* Schlick-GGX towards the eye */
    float four_n_dot_v;
    float f0[3], one_minus_f0[3];
    float lambert[3];
} Surface;

static void prepare(const Texel *texel, Surface *out)
{
    const float *diffuse = texel->diffuse, *material = texel->material;
    float to_eye[3];
    for (int i = 0; i < 3; i++)
        to_eye[i] = op_neg(texel->position[i]);
    normalize(to_eye, out->view);

    float roughness = op_min(op_max(material[0], SHADING_ROUGHNESS_MIN), 1.0f);
    float metallic = material[1];
    float a = op_mul(roughness, roughness);
    out->a2 = op_mul(a, a);
    out->a2_minus_1 = op_sub(out->a2, 1.0f);
    float k1 = op_add(roughness, 1.0f);
    out->k = op_mul(op_mul(k1, k1), 0.125f);
    out->one_minus_k = op_sub(1.0f, out->k);
    float n_dot_v = op_max(op_dot3(texel->normal, out->view), 0.0f);
    out->geometry_view = op_div(n_dot_v, op_add(op_mul(n_dot_v, out->one_minus_k), out->k));
    out->four_n_dot_v = op_mul(4.0f, n_dot_v);
    for (int i = 0; i < 3; i++) {
        out->f0[i] = op_mix(0.04f, diffuse[i], metallic);
        out->one_minus_f0[i] = op_sub(1.0f, out->f0[i]);
        out->lambert[i] = op_div(op_mul(diffuse[i], op_sub(1.0f, metallic)), SHADING_PI);
    }
}

static void add_light(const Texel *texel, const Surface *surface, const ViewLight *light,
                      float sum[3])
{
    const float *normal = texel->normal;
    float to_light[3], direction[3], half_sum[3], half_vector[3];
    for (int i = 0; i < 3; i++)
        to_light[i] = op_sub(light->position[i], texel->position[i]);
    float distance2 = op_max(op_dot3(to_light, to_light), SHADING_DISTANCE2_MIN);
    float distance = op_sqrt(distance2);
    float inverse_distance = op_div(1.0f, distance);
    for (int i = 0; i < 3; i++) {
        direction[i] = op_mul(to_light[i], inverse_distance);
        half_sum[i] = op_add(surface->view[i], direction[i]);
    }
    normalize(half_sum, half_vector);

    float n_dot_l = op_max(op_dot3(normal, direction), 0.0f);
    float n_dot_h = op_max(op_dot3(normal, half_vector), 0.0f);
    float h_dot_v = op_max(op_dot3(half_vector, surface->view), 0.0f);

    float denominator = op_add(op_mul(op_mul(n_dot_h, n_dot_h), surface->a2_minus_1), 1.0f);
    float distribution =
        op_div(surface->a2, op_mul(op_mul(SHADING_PI, denominator), denominator));
    float geometry_light =
        op_div(n_dot_l, op_add(op_mul(n_dot_l, surface->one_minus_k), surface->k));
    float x = op_saturate(op_sub(1.0f, h_dot_v));
    float x2 = op_mul(x, x);
    float x5 = op_mul(op_mul(x2, x2), x);
    float specular =
        op_div(op_mul(distribution, op_mul(surface->geometry_view, geometry_light)),
               op_add(op_mul(surface->four_n_dot_v, n_dot_l), SHADING_SPECULAR_BIAS));
    float attenuation = op_div(
        1.0f, op_add(op_add(light->attenuation[0], op_mul(light->attenuation[1], distance)),
                     op_mul(light->attenuation[2], distance2)));
    for (int i = 0; i < 3; i++) {
        float fresnel = op_add(surface->f0[i], op_mul(surface->one_minus_f0[i], x5));
        float reflected = op_add(op_mul(op_sub(1.0f, fresnel), surface->lambert[i]),
                                 op_mul(fresnel, specular));
        float radiance = op_mul(op_mul(light->color[i], attenuation), n_dot_l);
        sum[i] = op_add(sum[i], op_mul(reflected, radiance));
    }
}

bool shade_pixel(const View *view, const Texel *texel, float source[4])
{
    float alpha = texel->diffuse[3];
    if (alpha <= SHADING_ALPHA_TEST)
        return false;
    Surface surface;
    prepare(texel, &surface);
    float sum[3] = {0, 0, 0};
    for (size_t i = 0; i < view->light_count; i++)
        add_light(texel, &surface, &view->lights[i], sum);
    for (int i = 0; i < 3; i++) {
        float ambient =
            op_mul(op_mul(view->ambient[i], texel->diffuse[i]), texel->material[2]);
        source[i] = op_mul(op_add(sum[i], ambient), alpha);
    }
    source[3] = alpha;
    return true;
}

void shade_final(const View *view, const float accum[4], float transmittance, float final[4])
{
    for (int i = 0; i < 3; i++)
        final[i] = op_canonical(op_add(accum[i], op_mul(view->background[i], transmittance)));
    final[3] = op_canonical(op_sub(1.0f, transmittance));
}

void shade_display(bool fused, const float final[4], uint8_t display[4])
{
    for (int i = 0; i < 3; i++) {
        float c = op_max(final[i], 0.0f);
        float mapped = op_div(c, op_add(c, 1.0f));
        display[i] = unorm8_from_float(op_pow(fused, mapped, SHADING_DISPLAY_POWER));
    }
    display[3] = 255;
}

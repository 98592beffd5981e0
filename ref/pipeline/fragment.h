/* The geometry pass's shader for one covered pixel. Inline, so that each instruction set that the
 * tile path is compiled for has its own. */
#ifndef PEEL_REF_FRAGMENT_H
#define PEEL_REF_FRAGMENT_H

#include "frame/mutation.h"
#include "frame/shading.h"
#include "ref/pipeline/encode.h"
#include "ref/pipeline/pass.h"
#include "ref/pipeline/texture.h"

/* A smooth varying at a pixel: the plane of attribute/w, times w. */
static inline float fragment_varying(const Pass *pass, const Setup *setup, const float values[3],
                                     float inverse_fragment_w, int x, int y)
{
    Plane plane = setup_plane(setup, op_mul(values[0], setup->corner[0]->window[3]),
                              op_mul(values[1], setup->corner[1]->window[3]),
                              op_mul(values[2], setup->corner[2]->window[3]));
    return op_mul(plane_at(pass->fused, &plane, x, y), inverse_fragment_w);
}

/* 1 / gl_FragCoord.w. */
static inline float fragment_inverse_w(const Pass *pass, const Setup *setup, int x, int y)
{
    const Vertex *const *v = setup->corner;
    Plane w = setup_plane(setup, v[0]->window[3], v[1]->window[3], v[2]->window[3]);
    return op_div(1.0f, plane_at(pass->fused, &w, x, y));
}

/* What the material and its textures at uv give: base colour and alpha, roughness and metallic. */
static inline void fragment_material(const Scene *scene, const Material *material,
                                     const float uv[2], float base[4], float surface[2])
{
    float sample[4];
    for (int i = 0; i < 4; i++)
        base[i] = material->base_color[i];
    surface[0] = material->roughness;
    surface[1] = material->metallic;
    if (material->base_color_texture) {
        texture_sample(&scene->textures[material->base_color_texture - 1], uv, sample);
        for (int i = 0; i < 4; i++)
            base[i] = op_mul(base[i], sample[i]);
    }
    if (material->metallic_roughness_texture) {
        texture_sample(&scene->textures[material->metallic_roughness_texture - 1], uv, sample);
        surface[0] = op_mul(surface[0], sample[1]);
        surface[1] = op_mul(surface[1], sample[2]);
    }
}

/* Texture coordinates at a pixel; 0 where the material has no texture. */
static inline void fragment_uv(const Pass *pass, const Setup *setup, const Material *material,
                               float inverse_w, int x, int y, float uv[2])
{
    const Vertex *const *v = setup->corner;
    bool textured = material->base_color_texture || material->metallic_roughness_texture;
    for (int i = 0; i < 2; i++)
        uv[i] = textured ? fragment_varying(pass, setup,
                                            (float[3]){v[0]->uv[i], v[1]->uv[i], v[2]->uv[i]},
                                            inverse_w, x, y)
                         : 0.0f;
}

/* Whether the alpha mask discards the fragment. Flushing mode. */
static inline bool fragment_masked(const Pass *pass, const Setup *setup, const Primitive *primitive,
                                   int x, int y)
{
    const Draw *draw = &pass->view.draws[primitive->draw];
    if (!draw->masked)
        return false;
    const Material *material = &pass->scene->materials[draw->material];
    float uv[2], base[4], surface[2];
    fragment_uv(pass, setup, material, fragment_inverse_w(pass, setup, x, y), x, y, uv);
    fragment_material(pass->scene, material, uv, base, surface);
    return base[3] < op_flush(material->alpha_cutoff);
}

/* The interpolated normal as the vertices' give it, each of length 1: what is left of it where the
 * fragment shader does not normalise. */
static inline void fragment_short_normal(const Pass *pass, const Setup *setup, float inverse_w,
                                         int x, int y, float normal[3])
{
    float scale[3];
    for (int i = 0; i < 3; i++) {
        const float *n = setup->corner[i]->normal;
        scale[i] = op_inversesqrt(op_max(op_dot3(n, n), SHADING_TINY));
    }
    for (int i = 0; i < 3; i++) {
        float corners[3];
        for (int k = 0; k < 3; k++)
            corners[k] = op_mul(setup->corner[k]->normal[i], scale[k]);
        normal[i] = fragment_varying(pass, setup, corners, inverse_w, x, y);
    }
}

/* The surface it shows, unquantised, its normal not encoded. Flushing mode. */
static inline void fragment_surface(const Pass *pass, const Setup *setup,
                                    const Primitive *primitive, int x, int y, Texel *out)
{
    const Draw *draw = &pass->view.draws[primitive->draw];
    const Material *material = &pass->scene->materials[draw->material];
    const Vertex *const *v = setup->corner;
    float inverse_w = fragment_inverse_w(pass, setup, x, y);
    float normal[3], uv[2];
    for (int i = 0; i < 3; i++) {
        out->position[i] = fragment_varying(
            pass, setup, (float[3]){v[0]->position[i], v[1]->position[i], v[2]->position[i]},
            inverse_w, x, y);
        normal[i] = fragment_varying(pass, setup,
                                     (float[3]){v[0]->normal[i], v[1]->normal[i], v[2]->normal[i]},
                                     inverse_w, x, y);
    }
    out->position[3] = 1.0f;

    float scale = op_inversesqrt(op_max(op_dot3(normal, normal), SHADING_TINY));
    if (pass->desc->mutations & mutation_bit(MUTATION_NORMALS_NOT_NORMALISED)) {
        fragment_short_normal(pass, setup, inverse_w, x, y, normal);
        scale = 1.0f;
    }
    bool turn = pass->desc->normals == NORMALS_FACED && !setup->front;
    for (int i = 0; i < 3; i++) {
        float n = op_mul(normal[i], scale);
        out->normal[i] = turn ? op_neg(n) : n;
    }
    out->normal[3] = 0.0f;
    fragment_uv(pass, setup, material, inverse_w, x, y, uv);
    fragment_material(pass->scene, material, uv, out->diffuse, out->material);
    if (!draw->transparent)
        out->diffuse[3] = 1.0f;
    out->material[2] = material->occlusion;
    out->material[3] = 1.0f;
}

/* A surface as the targets take it, in place. */
static inline void fragment_encode(const Pass *pass, Texel *texel)
{
    if (pass->layout.normal == FORMAT_RG16)
        encode_octahedral(texel->normal, texel->normal);
}

/* What it writes to its targets, unquantised. Flushing mode. */
static inline void fragment_shade(const Pass *pass, const Setup *setup, const Primitive *primitive,
                                  int x, int y, Texel *out)
{
    fragment_surface(pass, setup, primitive, x, y, out);
    fragment_encode(pass, out);
}

/* From what the lighting pass fetches at a pixel to what it shades: undoes the encodings, in
 * place. depth: the stored depth (depth_key). Flushing mode. */
static inline void fragment_decode(const Pass *pass, uint32_t depth, int x, int y, Texel *texel)
{
    if (pass->layout.normal == FORMAT_RG16)
        decode_octahedral(texel->normal, texel->normal);
    if (pass->layout.position == FORMAT_NONE)
        decode_position(&pass->view.unprojection, depth_fetch(pass->depth_format, depth), x, y,
                        texel->position);
}

#endif

/* The geometry pass's shader for one covered pixel. Inline, so that each instruction set that the
 * tile path is compiled for has its own. */
#ifndef PEEL_REF_FRAGMENT_H
#define PEEL_REF_FRAGMENT_H

#include "frame/shading.h"
#include "ref/pipeline/pass.h"

/* A smooth varying at a pixel: the plane of attribute/w, times w. */
static inline float fragment_varying(const Pass *pass, const Setup *setup, const float values[3],
                                     float inverse_fragment_w, int x, int y)
{
    Plane plane = setup_plane(setup, op_mul(values[0], setup->corner[0]->window[3]),
                              op_mul(values[1], setup->corner[1]->window[3]),
                              op_mul(values[2], setup->corner[2]->window[3]));
    return op_mul(plane_at(pass->fused, &plane, x, y), inverse_fragment_w);
}

/* What it writes to its targets, unquantised. Flushing mode. */
static inline void fragment_shade(const Pass *pass, const Setup *setup, const Primitive *primitive,
                                  int x, int y, Texel *out)
{
    const Draw *draw = &pass->view.draws[primitive->draw];
    const Material *material = &pass->scene->materials[draw->material];
    const Vertex *const *v = setup->corner;
    Plane w = setup_plane(setup, v[0]->window[3], v[1]->window[3], v[2]->window[3]);
    float inverse_w = op_div(1.0f, plane_at(pass->fused, &w, x, y));
    float normal[3];
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
    bool turn = pass->desc->normals == NORMALS_FACED && !setup->front;
    for (int i = 0; i < 3; i++) {
        float n = op_mul(normal[i], scale);
        out->normal[i] = turn ? op_neg(n) : n;
        out->diffuse[i] = material->base_color[i];
    }
    out->normal[3] = 0.0f;
    out->diffuse[3] = draw->transparent ? material->base_color[3] : 1.0f;
    out->material[0] = material->roughness;
    out->material[1] = material->metallic;
    out->material[2] = material->occlusion;
    out->material[3] = 1.0f;
}

#endif

#include "ref/pipeline/shade.h"

#define LANES 1
#include "ref/pipeline/shade_body.h"

static void load(const Texel *texel, ShadeBatch *out)
{
    for (int i = 0; i < 3; i++) {
        out->normal[i][0] = texel->normal[i];
        out->position[i][0] = texel->position[i];
        out->material[i][0] = texel->material[i];
    }
    for (int i = 0; i < 4; i++)
        out->diffuse[i][0] = texel->diffuse[i];
}

static void shade(const View *view, const ShadeForm *form, bool skip, const Texel *texel,
                  float source[4])
{
    ShadeBatch batch;
    load(texel, &batch);
    shade_batch_skipping(view, form, skip, &batch);
    for (int i = 0; i < 4; i++)
        source[i] = batch.source[i][0];
}

bool shade_pixel(const View *view, const ShadeForm *form, const Texel *texel, float source[4])
{
    if (texel->diffuse[3] <= SHADING_ALPHA_TEST)
        return false;
    shade(view, form, false, texel, source);
    return true;
}

void shade_skipping(const View *view, const ShadeForm *form, const Texel *texel, float source[4])
{
    shade(view, form, true, texel, source);
}

/* One light's stages, and what they leave out: N·H and H·V. */
static void explain(const ShadeForm *form, const Surface *surface, const ViewLight *light,
                    ShadeTerm *out)
{
    Incidence incidence = {0};
    Reflection reflection;
    float half_vector[3];
    shade_distance(surface, light, &incidence);
    shade_direction(form->back_light, surface, light, &incidence);
    shade_half_vector(form, surface, &incidence);
    shade_reflection(form->back_light, surface, light, &incidence, &reflection);
    float scale = op_div(1.0f, incidence.half_length);
    for (int i = 0; i < 3; i++)
        half_vector[i] = op_mul(incidence.half_sum[i], scale);
    *out = (ShadeTerm){.n_dot_l = incidence.n_dot_l,
                       .n_dot_h = op_max(op_dot3(surface->normal, half_vector), 0.0f),
                       .h_dot_v = op_max(op_dot3(half_vector, surface->view), 0.0f),
                       .distance = incidence.distance,
                       .distribution = reflection.distribution,
                       .geometry = reflection.geometry,
                       .specular = reflection.specular,
                       .attenuation = reflection.attenuation};
    for (int i = 0; i < 3; i++) {
        out->fresnel[i] = reflection.fresnel[i];
        out->term[i] = reflection.term[i];
    }
}

void shade_terms(const View *view, const ShadeForm *form, const Texel *texel, ShadeTerm *terms,
                 float ambient[3])
{
    ShadeBatch batch;
    Surface surface;
    float sum[3] = {0.0f, 0.0f, 0.0f};
    load(texel, &batch);
    shade_surface(&batch, &surface);
    for (size_t i = 0; i < view->light_count; i++) {
        explain(form, &surface, &view->lights[i], &terms[i]);
        for (int k = 0; k < 3; k++)
            terms[i].sum[k] = sum[k] = op_add(sum[k], terms[i].term[k]);
    }
    shade_ambient(view, &batch, ambient);
}

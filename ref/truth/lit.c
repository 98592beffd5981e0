#include "ref/truth/lit.h"

#include "frame/shading.h"

static Surface find_surface(const Soup *soup, const RenderDesc *desc, const Fragment *fragment,
                            int x, int y)
{
    const SoupVertex *vertices[3];
    soup_vertices(soup, fragment->triangle, vertices);
    const Corner *corners[3] = {&vertices[0]->corner, &vertices[1]->corner, &vertices[2]->corner};
    ExactPoint point;
    exact_at(corners, x, y, &point);
    bool turned = fragment->back && desc->normals == NORMALS_FACED;
    Surface surface = {0};
    for (int i = 0; i < 3; i++) {
        double position = 0.0, normal = 0.0;
        for (int corner = 0; corner < 3; corner++) {
            position += point.weight[corner] * vertices[corner]->position[i];
            normal += point.weight[corner] * vertices[corner]->normal[i];
        }
        surface.position[i] = position;
        surface.normal[i] = turned ? -normal : normal;
    }
    soup_material(soup, fragment->triangle, point.weight, &surface.material);
    return surface;
}

void lit_fragment(const Soup *soup, const RenderDesc *desc, const Fragment *fragment, int x, int y,
                  Lit *out)
{
    bool transparent = soup_draw(soup, fragment->triangle)->draw->transparent;
    *out = (Lit){.surface = find_surface(soup, desc, fragment, x, y)};
    out->surface.back_light = desc->back_light && transparent;
    out->surface.phong = desc->shading == SHADING_PHONG;
    out->z = -out->surface.position[2];
    double alpha = transparent ? out->surface.material.base_color[3] : 1.0;
    if (alpha <= (double)SHADING_ALPHA_TEST)
        return;
    out->alpha = alpha;
    radiance_shade(soup->view, &out->surface, out->rgb);
}

void lit_blend(const Lit *lit, double rgba[4])
{
    for (int i = 0; i < 3; i++)
        rgba[i] += lit->rgb[i] * lit->alpha * rgba[3];
    rgba[3] *= 1.0 - lit->alpha;
}

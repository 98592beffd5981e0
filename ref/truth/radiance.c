#include "ref/truth/radiance.h"

#include "frame/shading.h"

#include <math.h>

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double at_least(double x, double low)
{
    return x > low ? x : low;
}

/* v scaled to length 1; where it is all but 0, scaled as the formula's guard does. */
static void normalize(const double v[3], double out[3])
{
    double scale = 1.0 / sqrt(at_least(dot(v, v), SHADING_TINY));
    for (int i = 0; i < 3; i++)
        out[i] = v[i] * scale;
}

/* What all lights share at one surface point; names as in frame/shading.h. */
typedef struct Point {
    bool back_light;
    double P[3], N[3], V[3];
    double a2, k, NV, GV;
    double F0[3], lambert[3];
} Point;

static Point point_setup(const Surface *surface)
{
    const MaterialSample *material = &surface->material;
    Point point = {.back_light = surface->back_light};
    const double to_eye[3] = {-surface->position[0], -surface->position[1], -surface->position[2]};
    normalize(surface->normal, point.N);
    normalize(to_eye, point.V);
    double r = at_least(material->roughness, SHADING_ROUGHNESS_MIN);
    r = r < 1.0 ? r : 1.0;
    point.a2 = r * r * (r * r);
    point.k = (r + 1.0) * (r + 1.0) * 0.125;
    point.NV = at_least(dot(point.N, point.V), 0.0);
    point.GV = point.NV / (point.NV * (1.0 - point.k) + point.k);
    double metallic = material->metallic;
    for (int i = 0; i < 3; i++) {
        double diffuse = material->base_color[i];
        point.P[i] = surface->position[i];
        point.F0[i] = (double)0.04f * (1.0 - metallic) + diffuse * metallic;
        point.lambert[i] = diffuse * (1.0 - metallic) / (double)SHADING_PI;
    }
    return point;
}

/* Turns a light behind the surface to the front, as if the surface were lit from there; the cosine
 * between normal and light. */
static double mirror(const Point *point, double L[3])
{
    double NL = dot(point->N, L);
    if (NL >= 0.0)
        return NL;
    for (int i = 0; i < 3; i++)
        L[i] -= 2.0 * NL * point->N[i];
    return -NL;
}

/* One light's term, added to rgb. */
static void add_light(const Point *point, const ViewLight *light, double rgb[3])
{
    double D[3], L[3], h[3], H[3];
    for (int i = 0; i < 3; i++)
        D[i] = light->position[i] - point->P[i];
    double d2 = at_least(dot(D, D), SHADING_DISTANCE2_MIN);
    double d = sqrt(d2);
    for (int i = 0; i < 3; i++)
        L[i] = D[i] / d;
    bool behind = dot(point->N, L) < 0.0;
    if (behind && !point->back_light)
        return;
    double NL = mirror(point, L);
    if (NL == 0.0)
        return; /* the whole term is multiplied by it */
    for (int i = 0; i < 3; i++)
        h[i] = point->V[i] + L[i];
    normalize(h, H);
    double NH = at_least(dot(point->N, H), 0.0);
    double HV = at_least(dot(H, point->V), 0.0);
    double den = NH * NH * (point->a2 - 1.0) + 1.0;
    double distribution = point->a2 / ((double)SHADING_PI * den * den);
    double GL = NL / (NL * (1.0 - point->k) + point->k);
    double x = HV < 1.0 ? 1.0 - HV : 0.0;
    double x2 = x * x;
    double x5 = x2 * x2 * x;
    double s =
        distribution * (point->GV * GL) / (4.0 * point->NV * NL + (double)SHADING_SPECULAR_BIAS);
    double attenuation =
        1.0 / (light->attenuation[0] + light->attenuation[1] * d + light->attenuation[2] * d2);
    for (int i = 0; i < 3; i++) {
        double F = point->F0[i] + (1.0 - point->F0[i]) * x5;
        double diffused = behind ? 0.0 : (1.0 - F) * point->lambert[i];
        rgb[i] += (diffused + F * s) * (light->color[i] * attenuation * NL);
    }
}

static void shade_phong(const Surface *surface, double rgb[3])
{
    static const double light[3] = {SHADING_PHONG_LIGHT_X, SHADING_PHONG_LIGHT_Y,
                                    SHADING_PHONG_LIGHT_Z};
    static const double ambient[3] = {SHADING_PHONG_AMBIENT_R, SHADING_PHONG_AMBIENT_GB,
                                      SHADING_PHONG_AMBIENT_GB};
    double N[3];
    normalize(surface->normal, N);
    double NL = dot(N, light);
    double highlight = pow(at_least(2.0 * NL * N[2] - light[2], 0.0), 20.0);
    for (int i = 0; i < 3; i++)
        rgb[i] = ambient[i] + at_least(NL, 0.0) * surface->material.base_color[i] + highlight;
}

void radiance_shade(const View *view, const Surface *surface, double rgb[3])
{
    if (surface->phong) {
        shade_phong(surface, rgb);
        return;
    }
    Point point = point_setup(surface);
    for (int i = 0; i < 3; i++)
        rgb[i] = 0.0;
    for (size_t light = 0; light < view->light_count; light++)
        add_light(&point, &view->lights[light], rgb);
    for (int i = 0; i < 3; i++)
        rgb[i] += view->ambient[i] * surface->material.base_color[i] * surface->material.occlusion;
}

uint8_t radiance_display(double c)
{
    c = c > 0.0 ? c : 0.0; /* NaN becomes 0 */
    double mapped = c < 1e300 ? c / (c + 1.0) : 1.0;
    double value = pow(mapped, SHADING_DISPLAY_POWER) * 255.0;
    return (uint8_t)((value + 0x1.8p52) - 0x1.8p52);
}

#include "ref/truth/radiance.h"

#include <math.h>

/* ---- the formula in double ------------------------------------------------------------------- */

typedef double Real;

static inline double real_of(double x)
{
    return x;
}
static inline double real_neg(double a)
{
    return -a;
}
static inline double real_add(double a, double b)
{
    return a + b;
}
static inline double real_sub(double a, double b)
{
    return a - b;
}
static inline double real_mul(double a, double b)
{
    return a * b;
}
static inline double real_div(double a, double b)
{
    return a / b;
}
static inline double real_sqrt(double a)
{
    return sqrt(a);
}
static inline double real_inversesqrt(double a)
{
    return 1.0 / sqrt(a);
}
static inline double real_max(double a, double b)
{
    return a > b ? a : b;
}
static inline double real_min(double a, double b)
{
    return a < b ? a : b;
}
static inline double real_mix(double a, double b, double t)
{
    return a * (1.0 - t) + b * t;
}
static inline double real_dot(const double a[3], const double b[3])
{
    return (a[2] * b[2] + a[1] * b[1]) + a[0] * b[0];
}
static inline bool real_may_exceed(double a, double limit)
{
    return a > limit;
}
static inline double real_unless_negative(double u, double a)
{
    return u < 0.0 ? 0.0 : a;
}

#include "ref/truth/radiance_body.h"

void radiance_shade(const View *view, const Surface *surface, double rgb[3])
{
    const MaterialSample *material = &surface->material;
    RealSurface real = {.roughness = material->roughness,
                        .metallic = material->metallic,
                        .occlusion = material->occlusion};
    real_normalize(surface->normal, real.normal);
    for (int i = 0; i < 3; i++) {
        real.position[i] = surface->position[i];
        real.diffuse[i] = material->base_color[i];
    }
    real_shade(view, &real, surface->phong ? SHADING_PHONG : SHADING_GGX, GGX_SOURCE,
               surface->back_light, rgb);
}

/* ---- display --------------------------------------------------------------------------------- */

uint8_t radiance_display(double c)
{
    c = c > 0.0 ? c : 0.0; /* NaN becomes 0 */
    double mapped = c < 1e300 ? c / (c + 1.0) : 1.0;
    double value = pow(mapped, SHADING_DISPLAY_POWER) * 255.0;
    return (uint8_t)((value + 0x1.8p52) - 0x1.8p52);
}

#include "ref/truth/bound_texture.h"

#include "ref/truth/texture.h"

/* Along one axis: the texels that the sample may come from, and in texels how far it may be off. */
typedef struct Reach {
    long low, high; /* inclusive, not wrapped; bilinear: of the first texel of a pair */
    double error;
    int size;
    TextureWrap wrap;
} Reach;

/* error: of u; unit: roundoff of the computation. False where more than a texel may lie between. */
static bool reach(double u, double error, double unit, uint32_t size, TextureWrap wrap,
                  bool nearest, Reach *out)
{
    double c = u;
    if (wrap == WRAP_REPEAT) {
        c = u - floor(u);
    } else if (wrap == WRAP_MIRROR) {
        double period = u - 2.0 * floor(u / 2.0);
        c = period > 1.0 ? 2.0 - period : period;
    }
    c = c > 0.0 ? c : 0.0;
    c = c < 1.0 ? c : 1.0;
    /* At most two roundings of numbers up to 2, one of c · size and one of the half texel; the last
     * two once more for the value's own. */
    double wide = (error + 8.0 * unit) * size * BOUNDED_SLACK + BOUNDED_TINY;
    double x = c * size - (nearest ? 0.0 : 0.5);
    out->error = wide;
    out->size = (int)size;
    out->wrap = wrap;
    if (!(wide < 1.0))
        return false;
    out->low = (long)floor(x - wide);
    out->high = (long)floor(x + wide);
    return true;
}

static int wrapped(const Reach *reach, long i)
{
    long size = reach->size;
    if (reach->wrap == WRAP_REPEAT)
        return (int)(((i % size) + size) % size);
    return (int)(i < 0 ? 0 : i < size ? i : size - 1);
}

static double texel(const Texture *texture, const Reach *x, const Reach *y, long i, long j,
                    int channel)
{
    size_t row = (size_t)wrapped(y, j), column = (size_t)wrapped(x, i);
    return texture->texels[4 * (row * texture->width + column) + (size_t)channel];
}

/* fmax, which makes gcc 12.2 for aarch64 fail at -O3: "internal compiler error: in
 * vect_transform_reduction". */
static double larger(double a, double b)
{
    return b > a ? b : a;
}

/* The greatest difference of `value` to a nearest texel within reach. */
static double nearest_error(const Texture *texture, const Reach *x, const Reach *y, int channel,
                            double value)
{
    double greatest = 0.0;
    for (long j = y->low; j <= y->high; j++)
        for (long i = x->low; i <= x->high; i++)
            greatest = larger(greatest, fabs(texel(texture, x, y, i, j, channel) - value));
    return greatest;
}

/* The sample is continuous, also over the wrap; its slope along an axis is at most the greatest
 * difference of neighbours. Three mixes of four roundings of numbers up to `largest`. */
static double bilinear_error(const Texture *texture, const Reach *x, const Reach *y, int channel,
                             double unit)
{
    double slope_x = 0.0, slope_y = 0.0, largest = 0.0;
    for (long j = y->low; j <= y->high + 1; j++)
        for (long i = x->low; i <= x->high + 1; i++) {
            double t = texel(texture, x, y, i, j, channel);
            largest = larger(largest, fabs(t));
            if (i <= x->high)
                slope_x = larger(slope_x, fabs(texel(texture, x, y, i + 1, j, channel) - t));
            if (j <= y->high)
                slope_y = larger(slope_y, fabs(texel(texture, x, y, i, j + 1, channel) - t));
        }
    return slope_x * x->error + slope_y * y->error + 16.0 * unit * largest + BOUNDED_TINY;
}

/* errors: of u and v. */
static double sample_error(const Texture *texture, const Bounded uv[2], const double errors[2],
                           double unit, int channel, double value)
{
    Reach x, y;
    bool near =
        reach(uv[0].value, errors[0], unit, texture->width, texture->wrap_s, texture->nearest, &x);
    near &=
        reach(uv[1].value, errors[1], unit, texture->height, texture->wrap_t, texture->nearest, &y);
    if (!near)
        return fmax(fabs(value), fabs(1.0 - value));
    return texture->nearest ? nearest_error(texture, &x, &y, channel, value)
                            : bilinear_error(texture, &x, &y, channel, unit);
}

void bound_texture(const Texture *texture, const Bounded uv[2], Bounded rgba[4])
{
    const double at[2] = {uv[0].value, uv[1].value};
    const double exact[2] = {uv[0].exact, uv[1].exact}, single[2] = {uv[0].single, uv[1].single};
    double value[4];
    texture_lookup(texture, at, value);
    for (int i = 0; i < 4; i++)
        rgba[i] = (Bounded){value[i], sample_error(texture, uv, exact, BOUNDED_DOUBLE, i, value[i]),
                            sample_error(texture, uv, single, BOUNDED_SINGLE, i, value[i]) +
                                BOUNDED_DOUBLE};
}

void bound_material(const Texture *textures, const Material *material, const Bounded uv[2],
                    BoundedSurface *surface)
{
    for (int i = 0; i < 4; i++)
        surface->diffuse[i] = bounded_of(material->base_color[i]);
    surface->roughness = bounded_of(material->roughness);
    surface->metallic = bounded_of(material->metallic);
    surface->occlusion = bounded_of(material->occlusion);
    Bounded rgba[4];
    if (material->base_color_texture) {
        bound_texture(&textures[material->base_color_texture - 1], uv, rgba);
        for (int i = 0; i < 4; i++)
            surface->diffuse[i] = bounded_mul(surface->diffuse[i], rgba[i]);
    }
    if (material->metallic_roughness_texture) {
        bound_texture(&textures[material->metallic_roughness_texture - 1], uv, rgba);
        surface->roughness = bounded_mul(surface->roughness, rgba[1]);
        surface->metallic = bounded_mul(surface->metallic, rgba[2]);
    }
}

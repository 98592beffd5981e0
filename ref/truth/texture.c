#include "ref/truth/texture.h"

#include <math.h>

/* Two neighbouring texels along one axis and how far the sample is from the first to the second. */
typedef struct Pair {
    uint32_t first, second;
    double fraction;
} Pair;

static double wrap_coordinate(TextureWrap wrap, double u)
{
    double c = u;
    if (wrap == WRAP_REPEAT) {
        c = u - floor(u);
    } else if (wrap == WRAP_MIRROR) {
        double period = u - 2.0 * floor(u / 2.0);
        c = period > 1.0 ? 2.0 - period : period;
    }
    c = c > 0.0 ? c : 0.0; /* NaN becomes 0 */
    return c < 1.0 ? c : 1.0;
}

/* index is in [−1, size + 1]. */
static uint32_t wrap_index(TextureWrap wrap, int index, int size)
{
    if (wrap == WRAP_REPEAT)
        return (uint32_t)((index + size) % size);
    if (index < 0)
        return 0;
    return (uint32_t)(index < size ? index : size - 1);
}

static Pair find_pair(TextureWrap wrap, bool nearest, double u, uint32_t size)
{
    double x = wrap_coordinate(wrap, u) * size - (nearest ? 0.0 : 0.5);
    double whole = floor(x);
    int index = (int)whole, count = (int)size;
    return (Pair){wrap_index(wrap, index, count), wrap_index(wrap, index + 1, count), x - whole};
}

void texture_lookup(const Texture *texture, const double uv[2], double rgba[4])
{
    Pair x = find_pair(texture->wrap_s, texture->nearest, uv[0], texture->width);
    Pair y = find_pair(texture->wrap_t, texture->nearest, uv[1], texture->height);
    const float *upper = &texture->texels[(size_t)y.first * texture->width * 4];
    const float *lower = &texture->texels[(size_t)y.second * texture->width * 4];
    for (int i = 0; i < 4; i++) {
        double t00 = upper[4 * x.first + i];
        rgba[i] = t00;
        if (texture->nearest)
            continue;
        /* As differences, so that equal texels give exactly their value. */
        double t10 = upper[4 * x.second + i];
        double t01 = lower[4 * x.first + i], t11 = lower[4 * x.second + i];
        double top = t00 + x.fraction * (t10 - t00), bottom = t01 + x.fraction * (t11 - t01);
        rgba[i] = top + y.fraction * (bottom - top);
    }
}

void texture_material(const Texture *textures, const Material *material, const double uv[2],
                      MaterialSample *out)
{
    *out = (MaterialSample){.roughness = material->roughness,
                            .metallic = material->metallic,
                            .occlusion = material->occlusion};
    double base[4] = {1.0, 1.0, 1.0, 1.0};
    if (material->base_color_texture)
        texture_lookup(&textures[material->base_color_texture - 1], uv, base);
    for (int i = 0; i < 4; i++)
        out->base_color[i] = material->base_color[i] * base[i];
    if (material->metallic_roughness_texture) {
        double rgba[4];
        texture_lookup(&textures[material->metallic_roughness_texture - 1], uv, rgba);
        out->roughness *= rgba[1];
        out->metallic *= rgba[2];
    }
}

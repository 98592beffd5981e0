/* Sampling a texture by fetches and single-precision arithmetic: frame/shading.h. */
#ifndef PEEL_REF_TEXTURE_H
#define PEEL_REF_TEXTURE_H

#include "number/op.h"
#include "scene/scene.h"

/* The texels along one axis: `low` alone for nearest. */
typedef struct Tap {
    int low, high;
    float fraction; /* weight of high */
} Tap;

/* A texel coordinate from −1 to size into the image. */
static inline int texture_wrap_index(int i, int size, TextureWrap wrap)
{
    if (wrap == WRAP_REPEAT)
        return i < 0 ? i + size : i >= size ? i - size : i;
    return i < 0 ? 0 : i >= size ? size - 1 : i;
}

static inline Tap texture_tap(float u, uint32_t texels, TextureWrap wrap, bool nearest)
{
    int size = (int)texels;
    float c = u;
    if (wrap == WRAP_REPEAT) {
        c = op_sub(u, op_floor(u));
    } else if (wrap == WRAP_MIRROR) {
        float m = op_sub(u, op_mul(2.0f, op_floor(op_mul(u, 0.5f))));
        c = m > 1.0f ? op_sub(2.0f, m) : m;
    }
    float x = op_mul(op_saturate(c), (float)size);
    if (!nearest)
        x = op_sub(x, 0.5f);
    float floor = op_floor(x);
    int i = (int)floor;
    return (Tap){texture_wrap_index(i, size, wrap), texture_wrap_index(i + 1, size, wrap),
                 op_sub(x, floor)};
}

static inline const float *texture_texel(const Texture *texture, int x, int y)
{
    return texture->texels + 4 * ((size_t)y * texture->width + (size_t)x);
}

/* out: RGBA. Flushing mode. */
static inline void texture_sample(const Texture *texture, const float uv[2], float out[4])
{
    Tap x = texture_tap(uv[0], texture->width, texture->wrap_s, texture->nearest);
    Tap y = texture_tap(uv[1], texture->height, texture->wrap_t, texture->nearest);
    const float *t00 = texture_texel(texture, x.low, y.low);
    if (texture->nearest) {
        for (int i = 0; i < 4; i++)
            out[i] = t00[i];
        return;
    }
    const float *t10 = texture_texel(texture, x.high, y.low);
    const float *t01 = texture_texel(texture, x.low, y.high);
    const float *t11 = texture_texel(texture, x.high, y.high);
    for (int i = 0; i < 4; i++)
        out[i] = op_mix(op_mix(t00[i], t10[i], x.fraction), op_mix(t01[i], t11[i], x.fraction),
                        y.fraction);
}

#endif

/* What a G-buffer stores instead of a normal and a position, and back: frame/shading.h. */
#ifndef PEEL_REF_ENCODE_H
#define PEEL_REF_ENCODE_H

#include "frame/shading.h"
#include "frame/view.h"
#include "number/op.h"

/* Both directions mirror the lower half of the octahedron: p = (1 − |p.yx|)·s(p.xy). */
static inline void encode_fold(float p[2])
{
    float x = op_sub(1.0f, op_abs(p[1])), y = op_sub(1.0f, op_abs(p[0]));
    p[0] = op_mul(x, p[0] < 0.0f ? -1.0f : 1.0f);
    p[1] = op_mul(y, p[1] < 0.0f ? -1.0f : 1.0f);
}

/* normal: length 1, or shorter where the guard of its normalisation held. out: in [0, 1] before
 * rounding. Flushing mode, as all here. */
static inline void encode_octahedral(const float normal[3], float out[2])
{
    float length1 = op_add(op_add(op_abs(normal[0]), op_abs(normal[1])), op_abs(normal[2]));
    length1 = op_max(length1, SHADING_TINY);
    float p[2] = {op_div(normal[0], length1), op_div(normal[1], length1)};
    if (normal[2] < 0.0f)
        encode_fold(p);
    for (int i = 0; i < 2; i++)
        out[i] = op_add(op_mul(p[i], 0.5f), 0.5f);
}

/* stored: as fetched. Length 1 but for rounding. */
static inline void decode_octahedral(const float stored[2], float normal[3])
{
    float p[2];
    for (int i = 0; i < 2; i++)
        p[i] = op_sub(op_mul(stored[i], 2.0f), 1.0f);
    float z = op_sub(op_sub(1.0f, op_abs(p[0])), op_abs(p[1]));
    if (z < 0.0f)
        encode_fold(p);
    const float v[3] = {p[0], p[1], z};
    float scale = op_inversesqrt(op_max(op_dot3(v, v), SHADING_TINY));
    for (int i = 0; i < 3; i++)
        normal[i] = op_mul(v[i], scale);
}

/* depth: stored, as fetched; x, y: pixel, y up. */
static inline void decode_position(const Unprojection *from, float depth, int x, int y,
                                   float position[3])
{
    float inverse_z =
        op_max(op_add(op_mul(depth, from->depth_scale), from->depth_offset), from->inverse_far);
    float z = op_div(1.0f, inverse_z);
    const int pixel[2] = {x, y};
    for (int i = 0; i < 2; i++)
        position[i] =
            op_mul(op_add(op_mul((float)pixel[i], from->ray_scale[i]), from->ray_offset[i]), z);
    position[2] = op_neg(z);
}

#endif

/* Weighted blended: nearer and more opaque fragments weigh more in the average.
 *
 * This work is based on: M. McGuire, L. Bavoil, "Weighted Blended Order-Independent Transparency",
 * JCGT 2(2), 2013, equations 7 to 10.
 *
 * Per fragment, with shaded colour c, alpha a, z = |z| of its position in view space:
 *   weight 7:   q = z/5;   p = q·q;     r = 10
 *   weight 8:   q = z/10;  p = q·q·q;   r = 10
 *               s = z/200; s2 = s·s;    w = a·max(1e-2, min(3e3, r/((1e-5 + p) + s2·s2·s2)))
 *   weight 9:   s = z/200; s2 = s·s;    w = a·max(1e-2, min(3e3, 0.03/(1e-5 + s2·s2)))
 *   weight 10:  n = 1 − d; or d itself with DEPTH_RANGE_REVERSED, d being gl_FragCoord.z
 *               w = a·max(1e-2, 3e3·(n·n·n))
 *   sum += (c·a·w, a·w);  product: T = T·(1 − a) from 1
 * where the first colour is (c·a)·w and a·b·c is (a·b)·c. Per pixel:
 *   nothing where T = 1
 *   C = sum.rgb / max(sum.a, 1e-5);  alpha = 1 − T;  source = (C·alpha, alpha)
 * Trace: weighted-blended.sum, weighted-blended.product. */
#include "ref/pipeline/methods/methods.h"

#include "number/blend.h"
#include "ref/pipeline/sums.h"

static float clamped_weight(float numerator, float denominator)
{
    return op_max(1e-2f, op_min(3e3f, op_div(numerator, denominator)));
}

static float weight(const RenderDesc *desc, const ShadedFragment *fragment)
{
    float z = fragment->distance, near = fragment->depth;
    float s = op_div(z, 200.0f), s2 = op_mul(s, s), s4 = op_mul(s2, s2);
    float q;
    switch (desc->weight) {
    case WEIGHT_9:
        return clamped_weight(0.03f, op_add(1e-5f, s4));
    case WEIGHT_7:
        q = op_div(z, 5.0f);
        return clamped_weight(10.0f, op_add(op_add(1e-5f, op_mul(q, q)), op_mul(s4, s2)));
    case WEIGHT_8:
        q = op_div(z, 10.0f);
        return clamped_weight(10.0f,
                              op_add(op_add(1e-5f, op_mul(op_mul(q, q), q)), op_mul(s4, s2)));
    case WEIGHT_10:
        break;
    }
    if (desc->depth_range != DEPTH_RANGE_REVERSED)
        near = op_sub(1.0f, near);
    return op_max(1e-2f, op_mul(3e3f, op_mul(op_mul(near, near), near)));
}

static void write(const RenderDesc *desc, const ShadedFragment *fragment, float sum[4],
                  float second[4])
{
    float alpha = fragment->source[3], w = op_mul(alpha, weight(desc, fragment));
    for (int i = 0; i < 4; i++)
        sum[i] = op_mul(fragment->source[i], w);
    second[0] = alpha;
}

static bool combine(const float sum[4], float product, float source[4])
{
    if (product == 1.0f)
        return false;
    float total = op_max(sum[3], 1e-5f);
    source[3] = op_sub(1.0f, product);
    for (int i = 0; i < 3; i++)
        source[i] = op_mul(op_div(sum[i], total), source[3]);
    return true;
}

Result weighted_blended_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    static const SumsMethod method = {.name = "weighted-blended",
                                      .second = "product",
                                      .start = 1.0f,
                                      .blend = blend_product,
                                      .equation = "product",
                                      .write = write,
                                      .combine = combine};
    return sums_render(pass, trace, frame, &method);
}

/* Weighted average: all fragments of a pixel stand for as many equal ones.
 *
 * This work is based on: L. Bavoil, K. Myers, "Order Independent Transparency with Dual Depth
 * Peeling", NVIDIA, 2008, section "Weighted Average".
 *
 * Per fragment, with shaded colour c and alpha a: sum += (c·a, a) and count += 1. Per pixel:
 *   nothing where count = 0 or sum.a = 0
 *   C = sum.rgb / sum.a;  A = sum.a / count;  K = 1 − A
 *   T = 1, and count times: T = T·K
 *   alpha = 1 − T;  source = (C·alpha, alpha)
 * Trace: weighted-average.sum, weighted-average.count. */
#include "ref/pipeline/methods/methods.h"

#include "number/blend.h"
#include "ref/pipeline/sums.h"

#include <string.h>

static void write(const RenderDesc *desc, const ShadedFragment *fragment, float sum[4],
                  float second[4])
{
    (void)desc;
    memcpy(sum, fragment->source, sizeof fragment->source);
    second[0] = 1.0f;
}

static bool combine(const float sum[4], float count, float source[4])
{
    if (count == 0.0f || sum[3] == 0.0f)
        return false;
    float keep = op_sub(1.0f, op_div(sum[3], count));
    float transmittance = 1.0f;
    for (int i = 0; i < (int)count; i++)
        transmittance = op_mul(transmittance, keep);
    source[3] = op_sub(1.0f, transmittance);
    for (int i = 0; i < 3; i++)
        source[i] = op_mul(op_div(sum[i], sum[3]), source[3]);
    return true;
}

Result weighted_average_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    static const SumsMethod method = {.name = "weighted-average",
                                      .second = "count",
                                      .blend = blend_add,
                                      .equation = "add",
                                      .write = write,
                                      .combine = combine};
    return sums_render(pass, trace, frame, &method);
}

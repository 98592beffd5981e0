/* Weighted sum: the terms of sorted blending that do not depend on the order.
 *
 * This work is based on: H. Meshkin, "Sort-Independent Alpha Blending", GDC 2007, as described by
 * L. Bavoil, K. Myers, "Order Independent Transparency with Dual Depth Peeling", NVIDIA, 2008.
 *
 * Per fragment, with shaded colour c and alpha a: sum += (c·a, a). Per pixel: source = sum. Where
 * the alphas sum to more than 1 the transmittance left for what is behind is negative; float
 * accumulations keep it, others clamp it at 0.
 * Trace: weighted-sum.sum. */
#include "ref/pipeline/methods/methods.h"

#include "ref/pipeline/sums.h"

#include <string.h>

static void write(const RenderDesc *desc, const ShadedFragment *fragment, float sum[4],
                  float second[4])
{
    (void)desc;
    (void)second;
    memcpy(sum, fragment->source, sizeof fragment->source);
}

static bool combine(const float sum[4], float second, float source[4])
{
    (void)second;
    memcpy(source, sum, 4 * sizeof *source);
    return sum[3] != 0.0f;
}

Result weighted_sum_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    static const SumsMethod method = {
        .name = "weighted-sum", .second = "", .write = write, .combine = combine};
    return sums_render(pass, trace, frame, &method);
}

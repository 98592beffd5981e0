/* Weighted sum: the terms of sorted blending that do not depend on the order.
 *
 * This work is based on: H. Meshkin, "Sort-Independent Alpha Blending", GDC 2007, as described by
 * L. Bavoil, K. Myers, "Order Independent Transparency with Dual Depth Peeling", NVIDIA, 2008. */
#include "methods/methods.h"

#include "program.h"
#include "sums.h"

static Result create(Passes *passes, void *state)
{
    const SumsMethod method = {
        .name = "weighted-sum", .second = "", .shader = shader_weighted_sum_frag};
    return sums_create(passes, &method, state);
}

const GlMethod gl_weighted_sum = {sizeof(Sums), create, sums_draw, sums_destroy};

/* Weighted average: all fragments of a pixel stand for as many equal ones.
 *
 * This work is based on: L. Bavoil, K. Myers, "Order Independent Transparency with Dual Depth
 * Peeling", NVIDIA, 2008, section "Weighted Average". */
#include "methods/methods.h"

#include "program.h"
#include "sums.h"

static Result create(Passes *passes, void *state)
{
    const SumsMethod method = {.name = "weighted-average",
                               .second = "count",
                               .source = GL_ONE,
                               .destination = GL_ONE,
                               .shader = shader_weighted_average_frag};
    return sums_create(passes, &method, state);
}

const GlMethod gl_weighted_average = {sizeof(Sums), create, sums_draw, sums_destroy};

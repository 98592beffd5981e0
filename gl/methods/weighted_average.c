/* Weighted average: all fragments of a pixel stand for as many equal ones.
 *
 * This work is based on: L. Bavoil, K. Myers, "Order Independent Transparency with Dual Depth
 * Peeling", NVIDIA, 2008, section "Weighted Average". */
#include "methods/methods.h"

#include "program.h"
#include "sums.h"

Result gl_weighted_average(Passes *passes, Frame *out)
{
    const SumsMethod method = {.name = "weighted-average",
                               .second = "count",
                               .source = GL_ONE,
                               .destination = GL_ONE,
                               .shader = shader_weighted_average_frag};
    return sums_draw(passes, out, &method);
}

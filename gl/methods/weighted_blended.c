/* Weighted blended: nearer and more opaque fragments weigh more in the average.
 *
 * This work is based on: M. McGuire, L. Bavoil, "Weighted Blended Order-Independent Transparency",
 * JCGT 2(2), 2013, equations 7 to 10. */
#include "methods/methods.h"

#include "program.h"
#include "sums.h"

#include <stdio.h>

static Result create(Passes *passes, void *state)
{
    static const int equations[] = {
        [WEIGHT_9] = 9, [WEIGHT_7] = 7, [WEIGHT_8] = 8, [WEIGHT_10] = 10};
    SumsMethod method = {.name = "weighted-blended",
                         .second = "product",
                         .start = 1.0f,
                         .source = GL_ZERO,
                         .destination = GL_ONE_MINUS_SRC_COLOR,
                         .shader = shader_weighted_blended_frag};
    snprintf(method.defines, sizeof method.defines, "#define WEIGHT %d\n",
             equations[passes->desc->weight]);
    return sums_create(passes, &method, state);
}

const GlMethod gl_weighted_blended = {sizeof(Sums), create, sums_draw, sums_destroy};

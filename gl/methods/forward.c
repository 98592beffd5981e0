/* Depth peeling, front to back, shaded in the geometry pass.
 *
 * This work is based on: C. Everitt, "Interactive Order-Independent Transparency", 2001; L. Bavoil,
 * K. Myers, "Order Independent Transparency with Dual Depth Peeling", 2008. The passes are those of
 * methods/peel.c with other shaders: shaders/forward.frag.glsl stores lit colours, and
 * shaders/compose.frag.glsl blends them as they are. */
#include "methods/methods.h"

Result gl_forward(Passes *passes, Frame *out)
{
    return gl_peel(passes, out);
}

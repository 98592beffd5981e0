/* Depth peeling, front to back, shaded in the geometry pass.
 *
 * This work is based on: Cass Everitt, "Interactive Order-Independent Transparency", NVIDIA, 2001;
 * Louis Bavoil, Kevin Myers, "Order Independent Transparency with Dual Depth Peeling", NVIDIA,
 * 2008, which blends the peels under.
 *
 * The passes are those of methods/peel.c; what differs is what a fragment stores: its lit,
 * premultiplied colour (opaque.color, peel.K.color; render_desc_layout), which the full-screen pass
 * after it blends as it is. Stored in 32-bit floats that gives the bits of deferred peeling with a
 * full G-buffer. Only the fragments that the depth test leaves are shaded here; a GPU shades more.
 */
#include "ref/pipeline/methods/methods.h"

Result forward_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    return peel_render(pass, trace, frame);
}

/* The methods on OpenGL: one file each. */
#ifndef PEEL_GL_METHODS_H
#define PEEL_GL_METHODS_H

#include "../passes.h"

/* Each draws the frame up to the resolve pass and fills out->peels, geometry_passes and what it
 * counts in out->layers. With a trace, every buffer of it but "display" is read back. */
Result gl_dual(Passes *passes, Frame *out);
Result gl_forward_dual(Passes *passes, Frame *out);
Result gl_peel(Passes *passes, Frame *out);
Result gl_peel_id(Passes *passes, Frame *out);
Result gl_linked_list(Passes *passes, Frame *out);
Result gl_forward(Passes *passes, Frame *out);
Result gl_weighted_average(Passes *passes, Frame *out);
Result gl_weighted_sum(Passes *passes, Frame *out);
Result gl_weighted_blended(Passes *passes, Frame *out);
Result gl_painter(Passes *passes, Frame *out);

#endif

/* Deferred depth peeling on OpenGL. */
#ifndef PEEL_GL_METHODS_PEEL_H
#define PEEL_GL_METHODS_PEEL_H

#include "../passes.h"
#include "frame/frame.h"

/* Draws the frame up to the resolve pass; fills out->peels and out->layers.repeated. With a trace,
 * every buffer of it but "display" is read back. */
Result gl_peel(Passes *passes, Frame *out);

#endif

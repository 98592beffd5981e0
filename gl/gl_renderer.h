/* The pipeline in OpenGL 4.6 core on OSMesa. */
#ifndef PEEL_GL_RENDERER_H
#define PEEL_GL_RENDERER_H

#include "frame/frame.h"

/* See Renderer. One call at a time in a process: OSMesa's context belongs to the calling thread
 * while it runs. Fails with NO_GL when there is no 4.6 context or the driver reports an error.
 * desc->unfused is not chosen here: the driver's mode is fixed per process and reported in
 * Frame.fused; a driver of neither mode gives a warning. Times run from the upload to the
 * read-back, compiling shaders included, making the context not. */
Result gl_render(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out);

/* Finds out, by rendering, whether the driver fuses multiply-adds in fixed-function code. threads:
 * as in RenderDesc, for the process's first context decides it. */
Result gl_driver_fuses(int threads, bool *fused);

#endif

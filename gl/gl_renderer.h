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

/* How frames are drawn, beside what RenderDesc says; zero is what comparing needs. */
typedef struct GlOptions {
    bool every_pass;   /* methods that peel front to back draw and light desc->passes peels, empty
                        * or not, without asking how many fragments one had; with passes 0 they
                        * must ask */
    bool reject_early; /* full-screen lighting is depth-tested against its layer, so that pixels
                        * without a fragment never reach the shader; the image is the same, for a
                        * fragment at the cleared depth can only be with DEPTH_LEQUAL */
} GlOptions;

/* The same, kept between frames: the context, programs, buffers and uploads. */
typedef struct GlSession GlSession;

/* options: NULL for none. scene and trace (NULL is fine) must outlive the session; *out is NULL
 * on failure. The calling thread closes it. Several sessions may be open. */
Result gl_session_open(const Scene *scene, const RenderDesc *desc, const GlOptions *options,
                       TraceSink *trace, GlSession **out);
void gl_session_close(GlSession *session); /* NULL is fine */

/* Draws the frame and waits until it is finished; images: reads final and display back. Times are
 * those of drawing and waiting alone. On failure *out is empty. */
Result gl_session_frame(GlSession *session, bool images, Frame *out);

/* Finds out, by rendering, whether the driver fuses multiply-adds in fixed-function code. threads:
 * as in RenderDesc, for the process's first context decides it. */
Result gl_driver_fuses(int threads, bool *fused);

#endif

/* The ground truth: every fragment, sorted by exact depth, shaded and composited in double. */
#ifndef PEEL_REF_TRUTH_H
#define PEEL_REF_TRUTH_H

#include "frame/frame.h"

/* See Renderer. The trace receives opaque.primitive and peel.K.primitive by rectangles (steps 0
 * and K + 1), nothing else; a layer that a rectangle does not have is not sent for it. */
Result truth_render(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out);

#endif

/* The history of single pixels in exact order and double precision. */
#ifndef PEEL_REF_TRUTH_PIXEL_TRUTH_H
#define PEEL_REF_TRUTH_PIXEL_TRUTH_H

#include "frame/history.h"

typedef struct PixelTruth PixelTruth;

/* Transforms the scene once, for many pixels; scene must outlive *out. As truth_render fails. The
 * caller closes. */
Result pixel_truth_open(const Scene *scene, const RenderDesc *desc, PixelTruth **out);
void pixel_truth_close(PixelTruth *truth); /* NULL is fine */

/* (x, y): from the top left; BAD_INPUT outside the frame. Fragments come from front to back: the
 * transparent ones in front of the opaque surface, then that; what it hides is not kept. Their
 * depths, colours and blend steps are doubles, and final is what truth_render rounds. The caller
 * frees *out with history_free, after a failure too. */
Result pixel_truth_history(PixelTruth *truth, int x, int y, History *out);

#endif

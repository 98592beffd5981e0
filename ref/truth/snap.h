/* Snapping of corners to 1/256 pixel, certain: in double where the proven bound of the corner
 * (bound.h) does not reach half a subpixel, else in integers of any size (plane.h). */
#ifndef PEEL_REF_TRUTH_SNAP_H
#define PEEL_REF_TRUTH_SNAP_H

#include "ref/truth/coverage.h"

#include "frame/view.h"

/* corner, error: of draw's position (3 floats), soup.h. Unknown where the corner is behind the eye,
 * or more than 2^21 pixels away. *exact: set where integers decided. */
Snap snap_vertex(const View *view, const Draw *draw, const float *position, const Corner *corner,
                 const Corner *error, bool *exact);

#endif

/* Which arithmetic the driver's fixed-function code uses. */
#ifndef PEEL_GL_FUSES_H
#define PEEL_GL_FUSES_H

#include "context.h"

/* Draws one triangle and compares its interpolated depths with both predictions of number/op.h:
 * *fused tells whether the driver rounds a·b + c once. Changes bindings and the viewport. Kept for
 * the process after the first call. NO_GL when the driver follows neither. */
Result fuses_detect(Context *context, bool *fused);

#endif

/* Which arithmetic the driver's fixed-function code uses. */
#ifndef PEEL_GL_FUSES_H
#define PEEL_GL_FUSES_H

#include "context.h"

typedef enum FusesMode {
    FUSES_UNKNOWN = 0, /* neither prediction: not llvmpipe's arithmetic */
    FUSES_NOT,         /* a·b + c is rounded twice */
    FUSES_YES,         /* once */
} FusesMode;

/* Draws one triangle and compares its interpolated depths with both predictions of number/op.h.
 * Changes bindings and the viewport. Kept for the process after the first call, as a driver's mode
 * does not change. */
Result fuses_detect(Context *context, FusesMode *mode);

#endif

#ifndef PEEL_REF_METHODS_PEEL_H
#define PEEL_REF_METHODS_PEEL_H

#include "ref/pipeline/pass.h"

/* Deferred depth peeling, the definition path. frame's images are allocated; trace may be NULL. */
Result peel_render(Pass *pass, TraceSink *trace, Frame *frame);

#endif

/* The one table of methods; commands, tests, benchmarks and reports iterate it. */
#ifndef PEEL_FRAME_METHOD_H
#define PEEL_FRAME_METHOD_H

#include "frame/render_desc.h"

typedef struct MethodInfo {
    MethodId id;
    const char *name; /* as on the command line */
    const char *paper;
    const char *summary;
    bool exact;       /* converges to the sorted result with enough passes, ties apart */
    bool loses_ties;  /* keeps one of several fragments at equal depth: goes by depth alone */
    bool layers;      /* ref traces peel.K.primitive: its layers, front to back */
    double tolerance; /* at most this from truth at the 99th percentile, relative to max(1, value),
                       * in its best formats; 0 where it is not exact */
} MethodInfo;

/* Whether truth knows how far single precision may be from it (RenderDesc.bound): methods that
 * shade each layer from a G-buffer, or at once, and blend from front to back. */
bool method_has_bound(const RenderDesc *desc);

/* Whether its image should be the truth's: an exact method, and no outlines, which truth has not. */
bool method_is_judged(const RenderDesc *desc);

const MethodInfo *method_info(MethodId id);      /* static */
const MethodInfo *method_find(const char *name); /* NULL when there is none */

#endif

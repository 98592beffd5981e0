/* The buffers that gl makes for a frame, by name and format: what any GL renderer of the method
 * needs. tests/cross/test_plan.c holds their sum against what gl allocates. */
#ifndef PEEL_STUDY_PLAN_BUFFERS_H
#define PEEL_STUDY_PLAN_BUFFERS_H

#include "frame/needs.h"

enum {
    PLAN_BUFFERS_MAX = 40
};

typedef struct PlanBuffer {
    const char *name;   /* static */
    PixelFormat format; /* FORMAT_NONE: not one value a pixel */
    uint64_t bytes;     /* in all */
} PlanBuffer;

typedef struct PlanBuffers {
    PlanBuffer items[PLAN_BUFFERS_MAX];
    size_t count;
    uint64_t bytes; /* of all */
} PlanBuffers;

/* nodes: that linked lists must hold; else it is not looked at. A driver that binds less storage
 * than four nodes a pixel makes gl begin with fewer. NO_MEMORY on failure. */
Result plan_buffers(const Scene *scene, const View *view, const RenderDesc *desc,
                    const Needs *needs, uint64_t nodes, PlanBuffers *out);

#endif

/* ref/pipeline against OpenGL on one scene: every buffer of the trace and the final image, bit for
 * bit. Link bits.c. */
#ifndef PEEL_TESTS_BITS_H
#define PEEL_TESTS_BITS_H

#include "frame/frame.h"

typedef struct Bits {
    uint64_t pixels, values; /* compared, over all buffers */
    uint64_t differing;      /* values; and 1 where peels, passes, repeats or the final image
                              * differ */
    size_t buffers;          /* of the trace */
    int peels;               /* of ref */
    int geometry_passes[2];  /* of ref and gl */
    LayerStats layers;       /* of ref */
    bool fused;              /* the driver's mode, which ref follows */
    char difference[512];    /* the first one, "" if there is none */
} Bits;

/* Renders with both and compares. Where lists overflow, which nodes are lost depends on threads:
 * then the opaque buffers and the counts of nodes are compared. Fails where a renderer does, and
 * with INTERNAL where a trace lacks buffers or counts contradict each other. */
Result bits_measure(const Scene *scene, const RenderDesc *desc, Bits *out);

/* The same; what fails fails the test. */
void bits_compare(const Scene *scene, const RenderDesc *desc, Bits *out);

/* Renders twice with one renderer: the values that differ in all buffers of the trace, and 1 for
 * the final image. */
uint64_t bits_between(Renderer renderer, const Scene *scene, const RenderDesc *a,
                      const RenderDesc *b);

#endif

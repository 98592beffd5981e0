/* A driver's fixed-function blending of whole sets of vectors, as blend_check.h looks at it. */
#ifndef PEEL_STUDY_BLEND_DRIVER_H
#define PEEL_STUDY_BLEND_DRIVER_H

#include "blend/vectors.h"
#include "frame/experiment.h"
#include "study/blend_check.h"

typedef struct BlendDriverDesc {
    PixelFormat format;
    BlendEquation equation;
    unsigned sets;  /* bits 1 << VectorSet; those that the format does not have are left out */
    uint64_t limit; /* most vectors of each set, spread over it; 0: all, and of random ones 2^20 */
    uint64_t seed;  /* of the random ones */
    int threads, worst;
    void (*progress)(uint64_t vectors); /* NULL is fine */
} BlendDriverDesc;

/* Vectors that blend_driver_run blends. */
uint64_t blend_driver_vectors(const BlendDriverDesc *desc);

/* Blends them with the lab (sources of RGBA8 bounded as inputs_bounded says), reads every
 * destination back before it is blended, and judges what came out of it. *changed counts
 * destinations that the driver stored as something else (a NaN as another apart): what was read
 * back is then what the others blend, too. The caller frees *out with blend_report_free. */
Result blend_driver_run(Lab *driver, const BlendDriverDesc *desc, BlendReport *out,
                        uint64_t *changed);

#endif

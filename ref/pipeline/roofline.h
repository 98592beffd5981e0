/* The kernels of frame/roofline.h, compiled once per instruction set; see roofline_body.h. */
#ifndef PEEL_REF_ROOFLINE_H
#define PEEL_REF_ROOFLINE_H

#include "frame/roofline.h"

/* Those of each width; must not be called where the processor lacks it. */
extern const RooflineKernels roofline_scalar, roofline_sse2, roofline_avx2, roofline_avx512;

/* A RooflineTable. */
const RooflineKernels *roofline_kernels(size_t *count);

#endif

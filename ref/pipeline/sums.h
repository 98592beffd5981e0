/* What the single-pass methods share.
 *
 * The transparent list is drawn once. Every fragment in front of the opaque depth whose alpha
 * exceeds SHADING_ALPHA_TEST is shaded, and added to its pixel's sum in draw order; there is no
 * depth test among them. Then, at every pixel, a method makes one source colour of its sums, which
 * is blended under the accumulation; the opaque surfaces and the background follow.
 *
 * The sum has the format RGBA32F where the accumulation has, else RGBA16F, as in the papers: halves
 * are truncated at each addition and end at 65504. Pixels where a sum ends there, or is not finite,
 * are counted in LayerStats.overflowed. A second buffer, where a method has one, is R32F. */
#ifndef PEEL_REF_SUMS_H
#define PEEL_REF_SUMS_H

#include "ref/pipeline/shaded.h"

typedef struct SumsMethod {
    const char *name;     /* its buffers are traced as "name.sum" and "name.<second>", step 1 */
    const char *second;   /* "" where there is none */
    float start;          /* the second is cleared to this, the sum to 0 */
    StageBlend blend;     /* of the second */
    const char *equation; /* its name */
    /* What a fragment writes. Flushing mode, as below. */
    void (*write)(const RenderDesc *desc, const ShadedFragment *fragment, float sum[4],
                  float second[4]);
    /* The source of the under-blend; false: nothing is blended. */
    bool (*combine)(const float sum[4], float second, float source[4]);
} SumsMethod;

/* The whole frame, as every method's definition path. */
Result sums_render(Pass *pass, TraceSink *trace, Frame *frame, const SumsMethod *method);

#endif

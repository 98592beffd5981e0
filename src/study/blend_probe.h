/* Vectors that tell arithmetics apart: a part of each set of the format, simple ones first. */
#ifndef PEEL_STUDY_BLEND_PROBE_H
#define PEEL_STUDY_BLEND_PROBE_H

#include "base/result.h"
#include "blend/arithmetic.h"
#include "blend/vectors.h"
#include "study/blend_check.h"

typedef struct BlendProbe {
    BlendEquation equation;
    PixelFormat format;
    size_t count;
    float (*source)[4];
    unsigned char *destination; /* count pixels */
    VectorSet *set;             /* that each vector is of, and where; random ones with seed 0 */
    uint64_t *index;
} BlendProbe;

/* About `most` vectors. The caller frees with blend_probe_free, also after a failure. */
Result blend_probe_make(const BlendEquation *equation, PixelFormat format, size_t most,
                        BlendProbe *out);
void blend_probe_free(BlendProbe *probe);

/* What the arithmetic, which is not refused, makes of all vectors: count pixels, which the caller
 * frees; NULL when memory is exhausted. */
unsigned char *blend_probe_blend(const BlendProbe *probe, const Arithmetic *arithmetic);

/* The vector on which one's result is none of the others': the simplest by blend_case_complexity,
 * then the first; false if the probe has none. out->expected is what the first of the others gives,
 * out->got what one gives. one and others: of blend_probe_blend. */
bool blend_probe_apart(const BlendProbe *probe, const unsigned char *one, size_t count,
                       const unsigned char *const *others, BlendExample *out);

#endif

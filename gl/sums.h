/* What the single-pass methods share: see ref/pipeline/sums.h.
 *
 * A method's shader is two: the geometry pass (behind surface.glsl, peel_test.glsl and shade.glsl)
 * writes out_sum and, where there is a second buffer, out_second; with COMBINE defined, a
 * full-screen pass reads sum_buffer and second_buffer and writes the source colour. */
#ifndef PEEL_GL_SUMS_H
#define PEEL_GL_SUMS_H

#include "passes.h"

typedef struct SumsMethod {
    const char *name;           /* its buffers are traced as "name.sum", "name.<second>", step 1 */
    const char *second;         /* "" where there is none */
    float start;                /* the second is cleared to this, the sum to 0 */
    GLenum source, destination; /* blend factors of the second */
    const char *shader;
    char defines[64]; /* of the geometry pass */
} SumsMethod;

typedef struct Sums {
    Passes *passes;
    SumsMethod method;
    PixelFormat format[2];    /* of the sum and the second */
    int count;                /* of buffers */
    GLuint geometry, combine; /* programs */
    GLuint texture[2], buffer;
    void *pixels; /* of one buffer, read back */
} Sums;

/* What a GlMethod consists of; create for the rest. state: a Sums. method is copied. */
Result sums_create(Passes *passes, const SumsMethod *method, void *state);
Result sums_draw(void *state, Frame *out);
void sums_destroy(void *state);

#endif

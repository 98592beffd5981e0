/* What the methods of dual depth peeling share.
 *
 * This work is based on: L. Bavoil, K. Myers, "Order Independent Transparency with Dual Depth
 * Peeling", NVIDIA, 2008. Distances and min-max buffers are those of ref/pipeline's. */
#ifndef PEEL_GL_LIMITS_H
#define PEEL_GL_LIMITS_H

#include "passes.h"

typedef struct Limits {
    Passes *passes;
    GLuint first, count, copy_under; /* programs */
    GLuint textures[2];              /* RG32F: (−nearest, farthest); take turns */
    GLuint buffers[2];               /* framebuffers of one each */
    GLuint back, back_buffer;        /* accumulation of the back layers */
} Limits;

/* passes must outlive *out. On failure *out holds what there is. */
Result limits_create(Passes *passes, Limits *out);
void limits_destroy(Limits *limits);

/* Which of the two a peel, from 0, reads and draws. */
static inline int limits_previous(int peel)
{
    return peel & 1;
}
static inline int limits_current(int peel)
{
    return 1 - (peel & 1);
}

/* Clears the back accumulation and draws the first pass and the peels, up to desc->passes; sets the
 * frame's peels and passes. draw_peel gets state and the peel: it clears and draws its targets,
 * blends, traces. */
Result limits_peels(Limits *limits, Frame *frame, Result (*draw_peel)(void *state, int peel),
                    void *state);

/* A program of limits.frag.glsl over every pixel. */
Result limits_copy_program(const Passes *passes, const char *defines, GLuint *out);

/* Binds what a geometry pass reads: for peel_test.glsl, and the min-max buffer that the peel reads.
 */
void limits_bind(const Limits *limits, int peel);
/* The latter alone. */
void limits_bind_previous(const Limits *limits, int peel);

/* Puts the back accumulation under the frame's. */
void limits_compose(const Limits *limits);

/* Traces a colour attachment as "<method>.K.<what>". */
Result limits_trace(const Limits *limits, int peel, const char *what, GLuint framebuffer,
                    int attachment, PixelFormat format);

#endif

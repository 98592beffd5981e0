/* The methods on OpenGL: one file each. */
#ifndef PEEL_GL_METHODS_H
#define PEEL_GL_METHODS_H

#include "../passes.h"

/* A method's programs and buffers are its state: made once, they draw any number of frames. */
typedef struct GlMethod {
    size_t state_size; /* bytes; all 0 before create */
    /* passes outlives the state. On failure the state holds what there is: destroy it, too. */
    Result (*create)(Passes *passes, void *state);
    /* Draws the frame up to the resolve pass and fills out->peels, geometry_passes and what it
     * counts in out->layers, all of them 0 before. With a trace, every buffer of it but "display"
     * is read back. */
    Result (*draw)(void *state, Frame *out);
    void (*destroy)(void *state);
} GlMethod;

extern const GlMethod gl_dual, gl_forward_dual, gl_peel, gl_peel_id, gl_linked_list, gl_forward,
    gl_weighted_average, gl_weighted_sum, gl_weighted_blended, gl_painter;

#endif

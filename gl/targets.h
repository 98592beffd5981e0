/* The textures and framebuffers of one frame.
 *
 * One opaque G-buffer; two framebuffers for the peels that take turns, with a depth texture each
 * and one shared set of colour textures; the accumulation ("plain") buffer; the resolve buffer. */
#ifndef PEEL_GL_TARGETS_H
#define PEEL_GL_TARGETS_H

#include "context.h"
#include "frame/render_desc.h"

enum {
    GBUFFER_NORMAL,
    GBUFFER_POSITION,
    GBUFFER_DIFFUSE,
    GBUFFER_MATERIAL,
    GBUFFER_TARGETS
};

typedef struct Targets {
    int width, height;
    PixelFormat depth_format, accum_format;
    PixelFormat color_format[GBUFFER_TARGETS]; /* FORMAT_NONE: not stored */
    int attachment[GBUFFER_TARGETS];           /* its draw buffer and shader output; −1: none */
    int color_count;                           /* of those stored */
    GLuint opaque_depth, opaque_color[GBUFFER_TARGETS];
    /* R32UI copies of 24-bit depths that a fetch would confuse; 0 where they are not needed. */
    GLuint opaque_code, previous_code;
    GLuint peel_depth[2], peel_color[GBUFFER_TARGETS];
    GLuint accum, final, display;
    GLuint opaque_buffer, peel_buffer[2], plain_buffer, resolve_buffer; /* framebuffers */
    size_t bytes;                                                       /* of the textures */
} Targets;

/* Makes all of it. BAD_INPUT when desc's size passes a limit of the driver's, NO_MEMORY when it
 * needs more than desc->max_memory (4 GiB if 0), with what it would need; *out is then empty. */
Result targets_create(Context *context, const RenderDesc *desc, Targets *out);
void targets_destroy(Targets *targets); /* leaves an empty one */

/* Copies the depth integers of framebuffer to one of the code textures; nothing where it is 0. */
Result targets_copy_code(Targets *targets, GLuint framebuffer, GLuint code);

#endif

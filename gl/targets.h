/* The textures and framebuffers that every frame has, and the means to make a method's own.
 *
 * The opaque G-buffer; the accumulation ("plain") buffer; the resolve buffer. */
#ifndef PEEL_GL_TARGETS_H
#define PEEL_GL_TARGETS_H

#include "context.h"
#include "frame/needs.h"

enum {
    GBUFFER_NORMAL,
    GBUFFER_POSITION,
    GBUFFER_DIFFUSE,
    GBUFFER_MATERIAL,
    GBUFFER_TARGETS
};

/* A G-buffer: textures, 0 for a colour that is not stored, and the framebuffer that they make. */
typedef struct Layer {
    GLuint depth, color[GBUFFER_TARGETS], buffer;
    GLuint light_buffer; /* framebuffer of the accumulation with this depth */
} Layer;

typedef struct Targets {
    int width, height;
    PixelFormat depth_format, accum_format;
    /* Of both lists' G-buffers. FORMAT_NONE: not stored, or not needed. */
    PixelFormat color_format[GBUFFER_TARGETS];
    int attachment[GBUFFER_TARGETS]; /* its draw buffer and shader output; −1: none */
    int color_count;                 /* of those stored */
    bool lit;                        /* diffuse holds lit colours (METHOD_FORWARD) */
    Layer opaque;                    /* of an empty list: its depth alone */
    GLuint opaque_code;              /* see render_desc_needs_code; 0 where it is not needed */
    GLuint accum, final, display;
    GLuint plain_buffer, resolve_buffer; /* framebuffers of accum; of final and display */
    size_t bytes, limit;                 /* of the textures; the caller's --max-memory */
} Targets;

/* Makes all of it. BAD_INPUT when desc's size passes a limit of the driver's, NO_MEMORY when it
 * needs more than desc->max_memory (4 GiB if 0); *out is then empty. */
Result targets_create(Context *context, const RenderDesc *desc, const Needs *needs, Targets *out);
void targets_destroy(Targets *targets); /* leaves an empty one */

/* Accounts for bytes about to be allocated; NO_MEMORY and a message past the limit. */
Result targets_reserve(Targets *targets, size_t bytes);

/* A texture of the frame's size. NO_MEMORY, and *out is 0, when it passes the limit. The caller
 * deletes it. */
Result targets_texture(Targets *targets, PixelFormat format, GLuint *out);

/* A buffer of `bytes` bytes, at least 1, contents undefined. NO_MEMORY, and *out is 0, when it
 * passes the limit. The caller deletes it with targets_free_buffer. */
Result targets_buffer(Targets *targets, size_t bytes, GLuint *out);
void targets_free_buffer(Targets *targets, size_t bytes, GLuint *buffer); /* 0 is fine */

/* A framebuffer of `count` colour attachments, and a depth attachment unless depth is 0. NO_GL when
 * the driver does not take it. */
Result targets_framebuffer(int count, const GLuint *color, GLuint depth, GLuint *out);

/* A G-buffer in the frame's formats: a depth texture of its own, the colours those of `shared`
 * unless that is NULL. On failure *out holds what there is. */
Result targets_layer(Targets *targets, const Layer *shared, Layer *out);
void targets_destroy_layer(Layer *layer, bool shares_color); /* leaves an empty one */

/* Copies the depth integers of framebuffer to a code texture; nothing where it is 0. */
Result targets_copy_code(const Targets *targets, GLuint framebuffer, GLuint code);

#endif

/* What a frame needs of the pipeline: from the scene, what the camera makes of it and the request,
 * which lists, tests, texture fetches, G-buffer channels and lights can change an output.
 *
 * Leaving out the rest changes no bit of the final image, its display form or the counts
 * (tests/cross/test_needs.c). It does change a trace, so with one, or with RenderDesc.model_all,
 * all is needed. What the pixels show is not looked at: a list is needed if the scene has an
 * instance in it, visible from the camera or not. */
#ifndef PEEL_FRAME_NEEDS_H
#define PEEL_FRAME_NEEDS_H

#include "frame/view.h"

typedef enum NeedId {
    NEED_OPAQUE,             /* the passes over the opaque list; colours of its G-buffer */
    NEED_TRANSPARENT,        /* the method's own passes and buffers */
    NEED_CULLING,            /* a test of the side that a fragment shows, to discard it */
    NEED_FACING,             /* ... and to turn its normal */
    NEED_MASK,               /* the alpha mask's test */
    NEED_BASE_COLOR_TEXTURE, /* fetches of it */
    NEED_MATERIAL_TEXTURE,   /* of roughness and metallic */
    NEED_LIGHTS,             /* a loop over lights; without one ambient light remains */
    NEED_NORMAL,             /* of a fragment, computed and stored */
    NEED_POSITION,
    NEED_MATERIAL, /* stored: else the list has one roughness, metallic and occlusion */
    NEED_ACTED_ON, /* what follows is good to know, and nothing is left out for it */
    NEED_BACK_FACES = NEED_ACTED_ON, /* some are drawn */
    NEED_ALPHA,                      /* of each transparent fragment: it varies */
    NEED_ALPHA_TEST,                 /* it can discard a transparent fragment */
    NEED_DOUBLE,                     /* double precision */
    NEED_COUNT
} NeedId;

typedef struct Need {
    bool needed;
    const char *why; /* static; a clause without a full stop */
} Need;

typedef struct Needs {
    Need items[NEED_COUNT];
    bool all;                   /* nothing is left out but dark lights */
    size_t lights, dark_lights; /* that the frame draws; asked for, but they light nothing */
    /* Where NEED_MATERIAL is not needed: what all fragments of the opaque and of the transparent
     * list have that lighting looks at (roughness, metallic, occlusion, 1), unquantised; 0 in an
     * empty list. */
    float material[2][4];
} Needs;

const char *needs_name(NeedId id); /* "normals", "mask test", …; static */

/* traced: every buffer is asked for. view is of this scene and desc. */
void needs_derive(const Scene *scene, const View *view, const RenderDesc *desc, bool traced,
                  Needs *out);

static inline bool needs_has(const Needs *needs, NeedId id)
{
    return needs->items[id].needed;
}

/* wanted[i] (room for scene->texture_count) becomes whether a drawn material's texture i is
 * fetched. */
void needs_textures(const Needs *needs, const Scene *scene, const View *view, bool *wanted);

/* Whether the lighting pass of a G-buffer looks at positions; NEED_POSITION is also for weights. */
static inline bool needs_lit_position(const Needs *needs)
{
    return needs->all || needs_has(needs, NEED_LIGHTS);
}

/* Formats of a list's G-buffer as it is stored, FORMAT_NONE for what is left out: everything of an
 * empty list. (In render_desc_layout a position with FORMAT_NONE is one that is reconstructed.) */
GBufferLayout needs_layout(const Needs *needs, const RenderDesc *desc, bool transparent);

/* What a fetch of a stored material would have given, in the format that desc has for it; for
 * lists with NEED_MATERIAL not needed. Flushing mode. */
void needs_material(const Needs *needs, const RenderDesc *desc, bool transparent, float out[4]);

#endif

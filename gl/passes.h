/* The passes of a frame, each ready to run: geometry, lighting, resolve.
 *
 * Passes own every object of the driver's that a frame needs. They do not decide the order in
 * which they run; a method does (methods/). */
#ifndef PEEL_GL_PASSES_H
#define PEEL_GL_PASSES_H

#include "targets.h"
#include "upload.h"

typedef enum GeometryPass {
    GEOMETRY_OPAQUE = 0,
    GEOMETRY_FIRST_PEEL, /* nothing peeled before */
    GEOMETRY_NEXT_PEEL,
    GEOMETRY_PASSES
} GeometryPass;

typedef enum LightingPass {
    LIGHTING_OPAQUE = 0,
    LIGHTING_PEEL,
    LIGHTING_PASSES
} LightingPass;

typedef struct Passes {
    Context *context;
    const Scene *scene; /* borrowed */
    const RenderDesc *desc;
    const View *view;
    Targets targets;
    Meshes meshes;
    LightBuffer lights;
    Textures textures;
    GLuint geometry[GEOMETRY_PASSES], lighting[LIGHTING_PASSES], resolve; /* programs */
    GLuint samples;                                                       /* query */
} Passes;

/* Uploads the scene and builds programs and buffers; scene, desc and view must outlive *out. On
 * failure *out is empty. */
Result passes_create(Context *context, const Scene *scene, const RenderDesc *desc, const View *view,
                     Passes *out);
void passes_destroy(Passes *passes);

/* Clears the opaque G-buffer and the accumulation and draws the opaque list. */
Result passes_opaque_geometry(Passes *passes);

/* Clears the peels' G-buffer and draws peel `peel`, counted from 0, of the transparent list;
 * *samples is the number of fragments that passed, 0 when nothing is left to peel. */
Result passes_peel_geometry(Passes *passes, int peel, uint64_t *samples);

/* Shades peel `peel`, just drawn, and blends it under the accumulation. */
void passes_peel_lighting(Passes *passes, int peel);
/* Shades the opaque G-buffer and puts it behind the accumulation, as desc->opaque_blend says. */
void passes_opaque_lighting(Passes *passes);
/* Accumulation and background to the final image, and its display form. */
void passes_resolve(Passes *passes);

#endif

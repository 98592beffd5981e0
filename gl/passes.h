/* What the methods' passes are made of: the frame's objects, programs behind common sources, draws
 * of a list, full-screen passes, and the passes that all methods share.
 *
 * A method decides what runs in which order (methods/), and owns what only it needs. */
#ifndef PEEL_GL_PASSES_H
#define PEEL_GL_PASSES_H

#include "frame/needs.h"
#include "gl_renderer.h"
#include "targets.h"
#include "upload.h"

typedef struct Passes {
    Context *context;
    const Scene *scene; /* borrowed */
    const RenderDesc *desc;
    const View *view;
    Needs needs;
    TraceSink *trace; /* may be NULL */
    GlOptions options;
    void *pixels; /* scratch for read-back, 16 bytes a pixel; NULL without a trace */
    Targets targets;
    Meshes meshes;
    LightBuffer lights;
    Textures textures;
    GLuint opaque_geometry, opaque_lighting, peel_lighting, resolve; /* programs */
    GLuint samples;                                                  /* query */
} Passes;

/* Uploads the scene and builds programs and buffers. in: context to trace, which must outlive *out,
 * and options; the rest is 0. On failure *out is empty. */
Result passes_create(const Passes *in, Passes *out);
void passes_destroy(Passes *passes);

/* Sets what the passes of a frame expect of the driver's state; frames may have changed it. */
void passes_begin(const Passes *passes);

/* ---- programs ---- */

/* Fragment sources, in this order; they may use each other's functions. */
typedef struct PassesSource {
    bool surface;    /* surface.glsl */
    bool peel_test;  /* peel_test.glsl */
    bool octahedral; /* octahedral.glsl */
    bool gbuffer;    /* gbuffer.glsl */
    bool shade;      /* shade.glsl */
    bool unproject;  /* unproject.glsl */
    bool minmax;     /* minmax.glsl */
    const char *main;
} PassesSource;

/* A program that draws meshes (geometry.vert) or, where source->surface is false, one triangle that
 * covers the viewport. It has the switches of desc and the scene that those sources name, and
 * `defines` ("" for none); uniforms that no draw changes are set. The caller deletes it. */
Result passes_program(const Passes *passes, const char *name, const char *defines,
                      const PassesSource *source, GLuint *out);

/* Those that every method has, into passes. */
Result passes_build_programs(Passes *passes);

/* The G-buffer program of a geometry pass: TRANSPARENT, NEXT_PEEL or nothing. */
Result passes_geometry_program(const Passes *passes, const char *name, const char *defines,
                               GLuint *out);

/* ---- draws ---- */

/* The draws of one list, in order, to the bound framebuffer, without touching its depth test. */
void passes_draw_list(const Passes *passes, GLuint program, bool transparent);
/* Makes func, mirrored where desc->depth_range is, the depth function: at first desc's own is. */
void passes_depth_test(const RenderDesc *desc, DepthFunc func);
/* Counting the fragments that passed, of what is drawn between the two. The end fails when that
 * has failed: `what` names it. With samples NULL neither counts, nor waits for the driver; a query
 * whose result is not read would be added to the next one by llvmpipe. */
void passes_begin_count(const Passes *passes, const uint64_t *samples);
Result passes_end_count(const Passes *passes, const char *what, uint64_t *samples);
/* As passes_draw_list, with the depth test on, counted. */
Result passes_draw_counted(const Passes *passes, GLuint program, bool transparent,
                           uint64_t *samples);
/* Binds the opaque depth where peel_test.glsl reads it: its integers where there are any. */
void passes_bind_opaque_depth(const Passes *passes);
/* One draw; its index range in triangles, 0 and UINT32_MAX for all. */
void passes_draw_range(const Passes *passes, GLuint program, const Draw *draw, uint32_t first,
                       uint32_t count);
/* Its two halves: the uniforms and textures of a draw, and triangles of the draw that has them. */
void passes_use_draw(const Passes *passes, GLuint program, const Draw *draw);
void passes_draw_triangles(const Passes *passes, const Draw *draw, uint32_t first, uint32_t count);
/* program over every pixel of framebuffer. */
void passes_fullscreen(const Passes *passes, GLuint program, GLuint framebuffer);

/* Colours of a G-buffer to 0, its depth to the far end. */
void passes_clear_layer(const Passes *passes, const Layer *layer);

/* ---- the passes that methods share ---- */

/* Clears the opaque G-buffer and the accumulation, draws the opaque list, traces the G-buffer. */
Result passes_opaque(Passes *passes);
/* What it does before it draws, with the opaque framebuffer bound, and after. */
void passes_begin_opaque(const Passes *passes);
Result passes_end_opaque(Passes *passes);
/* Peels, up to desc->passes, until draw_peel, which gets state and the peel from 0, sets *more to
 * false, or fails. */
Result passes_peels(const Passes *passes, Result (*draw_peel)(void *state, int peel, bool *more),
                    void *state);
/* Shades a peel's G-buffer and blends it under the accumulation. */
void passes_light_layer(const Passes *passes, const Layer *layer);
/* Shades the opaque G-buffer and puts it behind the accumulation, as desc->opaque_blend says;
 * traces the accumulation as the step after `peels`. */
Result passes_finish(Passes *passes, int peels);
/* A whole frame, but for passes_resolve, of a scene without transparent surfaces. */
Result passes_opaque_only(Passes *passes, Frame *out);
/* The accumulation as it is now to the trace, if there is one: under that name, or as that of a
 * peel. */
Result passes_trace_accum(const Passes *passes, const char *name, int step);
Result passes_trace_peel_accum(const Passes *passes, int peel);
/* Accumulation and background to the final image, and its display form. */
void passes_resolve(Passes *passes);
/* Blending as number/blend.h's blend_under and blend_over. */
void passes_blend_under(void);
void passes_blend_over(void);

#endif

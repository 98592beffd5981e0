/* The pure-C pipeline: bit for bit what the GL pipeline stores. */
#ifndef PEEL_REF_PIPELINE_H
#define PEEL_REF_PIPELINE_H

#include "frame/frame.h"

/* See Renderer. With a trace, or REF_PATH_DEFINITION, the scalar pass-by-pass path runs; without
 * one the tile-resident path, which gives the same bits. */
Result pipeline_render(const Scene *scene, const RenderDesc *desc, TraceSink *trace, Frame *out);

/* What this build and this processor have for RenderDesc.simd. */
bool pipeline_simd_built(SimdChoice simd);
bool pipeline_simd_runs(SimdChoice simd);
/* Whether denormals are flushed by the processor's mode, or by instructions of ours. */
bool pipeline_flushes_in_hardware(void);

/* The definition path alone, of what pass (ref/pipeline/pass.h) draws. On failure *out holds what
 * there is; the caller frees it. */
struct Pass;
Result pipeline_definition(struct Pass *pass, TraceSink *trace, Frame *out);

#endif

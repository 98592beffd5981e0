/* The tile-resident path, compiled once per instruction set; see tile_body.h. */
#ifndef PEEL_REF_TILE_H
#define PEEL_REF_TILE_H

#include "ref/pipeline/pass.h"

/* One entry per width; the same bits. Those that the processor lacks must not be called. */
Result tile_render_scalar(Pass *pass, Frame *frame);
Result tile_render_sse2(Pass *pass, Frame *frame);
Result tile_render_avx2(Pass *pass, Frame *frame);
Result tile_render_avx512(Pass *pass, Frame *frame);

/* The entry for desc->simd: the widest that this processor has for SIMD_AUTO. UNSUPPORTED with a
 * message when it lacks the one asked for. */
Result tile_render(Pass *pass, Frame *frame);

#endif

/* The blends of a traced frame once more, in double, as a fixed-point accumulation would clamp
 * them.
 */
#ifndef PEEL_STUDY_REPLAY_H
#define PEEL_STUDY_REPLAY_H

#include "compare/store.h"

#include <stdbool.h>

/* Whether trace has the accumulation after each layer, blended under. */
bool replay_possible(const TraceStore *trace);

/* *out: the image `from` (FORMAT_RGBA32F, final) with the difference that clamping to [0, 1] makes,
 * of each source before it is blended and of each sum after; nothing is rounded otherwise. trace:
 * of the frame that `from` is of, with 32-bit accumulation. The caller frees *out. */
Result replay_clamped(const TraceStore *trace, const Image *from, Image *out);

#endif

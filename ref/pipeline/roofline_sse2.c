#define LANES         4
#define ROOFLINE      roofline_sse2
#define ROOFLINE_SIMD SIMD_SSE2
#include "ref/pipeline/roofline_body.h"

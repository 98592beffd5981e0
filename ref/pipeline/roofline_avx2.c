#define LANES         8
#define ROOFLINE      roofline_avx2
#define ROOFLINE_SIMD SIMD_AVX2
#include "ref/pipeline/roofline_body.h"

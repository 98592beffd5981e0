#define LANES         16
#define ROOFLINE      roofline_avx512
#define ROOFLINE_SIMD SIMD_AVX512
#include "ref/pipeline/roofline_body.h"

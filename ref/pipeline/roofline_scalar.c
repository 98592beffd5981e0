#define LANES         1
#define ROOFLINE      roofline_scalar
#define ROOFLINE_SIMD SIMD_SCALAR
#include "ref/pipeline/roofline_body.h"

#include "ref/pipeline/roofline.h"

const RooflineKernels *roofline_kernels(size_t *count)
{
    static RooflineKernels kernels[SIMD_COUNT];
    *count = 0;
    kernels[(*count)++] = roofline_scalar;
#if defined(__x86_64__) && !defined(PEEL_SOFTWARE_FLUSH)
    kernels[(*count)++] = roofline_sse2;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        kernels[(*count)++] = roofline_avx2;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("fma"))
        kernels[(*count)++] = roofline_avx512;
#endif
    return kernels;
}

#include "ref/pipeline/tile.h"

#include "number/op.h"
#include "ref/pipeline/pipeline.h"

typedef struct TileVariant {
    Result (*render)(Pass *pass, Frame *frame);
    bool available;
} TileVariant;

static TileVariant variant(SimdChoice simd)
{
    switch (simd) {
#if defined(__x86_64__) && !defined(PEEL_SOFTWARE_FLUSH)
    case SIMD_SSE2:
        return (TileVariant){tile_render_sse2, true};
    case SIMD_AVX2:
        return (TileVariant){tile_render_avx2,
                             __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")};
    case SIMD_AVX512:
        return (TileVariant){tile_render_avx512,
                             __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("fma")};
#endif
    case SIMD_SCALAR:
        return (TileVariant){tile_render_scalar, true};
    default:
        return (TileVariant){0};
    }
}

bool pipeline_simd_built(SimdChoice simd)
{
    return variant(simd).render != NULL;
}

bool pipeline_simd_runs(SimdChoice simd)
{
    return variant(simd).available;
}

bool pipeline_flushes_in_hardware(void)
{
    return OP_HARDWARE_FLUSH;
}

Result tile_render(Pass *pass, Frame *frame)
{
    SimdChoice simd = pass->desc->simd;
    for (SimdChoice widest = SIMD_COUNT - 1; simd == SIMD_AUTO; widest--)
        if (variant(widest).available)
            simd = widest;
    TileVariant chosen = variant(simd);
    if (!chosen.available)
        return result_fail(RESULT_UNSUPPORTED, "--simd %s: this processor does not have it",
                           simd_name(simd));
    return chosen.render(pass, frame);
}

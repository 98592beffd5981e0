#include "frame/render_desc.h"

void render_desc_seed_profile(RenderDesc *desc)
{
    desc->gbuffer = GBUFFER_SEED;
    desc->position = POSITION_BUFFER;
    desc->depth = FORMAT_D24;
    desc->accum = FORMAT_RGBA16;
    desc->depth_func = DEPTH_LEQUAL;
    desc->peel_test = PEEL_TEST_RAW;
    desc->cull = CULL_SEED;
    desc->normals = NORMALS_KEPT;
    desc->ggx = GGX_SOURCE;
    desc->back_light = false;
    desc->opaque_blend = OPAQUE_BLEND_SEED;
}

bool render_desc_is_seed(const RenderDesc *desc)
{
    RenderDesc seed = *desc;
    render_desc_seed_profile(&seed);
    return seed.gbuffer == desc->gbuffer && seed.position == desc->position &&
           seed.depth == desc->depth && seed.accum == desc->accum &&
           seed.depth_func == desc->depth_func && seed.peel_test == desc->peel_test &&
           seed.cull == desc->cull && seed.normals == desc->normals && seed.ggx == desc->ggx &&
           seed.back_light == desc->back_light && seed.opaque_blend == desc->opaque_blend;
}

const char *simd_name(SimdChoice simd)
{
    static const char *const names[SIMD_COUNT] = {"auto", "scalar", "sse2", "avx2", "avx512"};
    return names[simd];
}

const char *gbuffer_name(GBufferFormat format)
{
    static const char *const names[] = {"full", "seed", "compact"};
    return names[format];
}

bool render_desc_needs_code(const RenderDesc *desc)
{
    return render_desc_depth(desc) == FORMAT_D24 && desc->peel_test == PEEL_TEST_STORED;
}

bool render_desc_needs_previous_code(const RenderDesc *desc)
{
    if (desc->depth_range != DEPTH_RANGE_REVERSED)
        return false;
    if (desc->method == METHOD_PEEL_ID)
        return render_desc_depth(desc) == FORMAT_D24;
    return render_desc_needs_code(desc) && !(desc->bias > 0.0f);
}

PixelFormat render_desc_dual_format(const RenderDesc *desc, bool normal)
{
    if (desc->gbuffer == GBUFFER_FULL)
        return FORMAT_RGBA32F;
    return normal ? FORMAT_RGBA16 : FORMAT_RGBA8;
}

PixelFormat render_desc_sum_format(const RenderDesc *desc)
{
    return desc->accum == FORMAT_RGBA32F ? FORMAT_RGBA32F : FORMAT_RGBA16F;
}

GBufferLayout render_desc_layout(const RenderDesc *desc)
{
    static const GBufferLayout layouts[] = {
        [GBUFFER_FULL] = {FORMAT_RGBA32F, FORMAT_RGBA32F, FORMAT_RGBA32F, FORMAT_RGBA32F},
        [GBUFFER_SEED] = {FORMAT_RGBA32F, FORMAT_RGBA16F, FORMAT_RGBA8, FORMAT_RGBA8},
        [GBUFFER_COMPACT] = {FORMAT_RG16, FORMAT_NONE, FORMAT_RGBA8, FORMAT_RGBA8},
    };
    if (desc->method == METHOD_FORWARD)
        return (GBufferLayout){
            .normal = FORMAT_NONE,
            .position = FORMAT_NONE,
            .diffuse = desc->gbuffer == GBUFFER_FULL ? FORMAT_RGBA32F : desc->accum,
            .material = desc->peel_test == PEEL_TEST_RAW ? FORMAT_RGBA8 : FORMAT_NONE,
        };
    GBufferLayout layout =
        layouts[desc->method == METHOD_LINKED_LIST ? GBUFFER_COMPACT : desc->gbuffer];
    if (desc->position == POSITION_RECONSTRUCT)
        layout.position = FORMAT_NONE;
    return layout;
}

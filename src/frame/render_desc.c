#include "frame/render_desc.h"

#include <math.h>

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

/* ---- ranges ---- */

static Result check_choices(const RenderDesc *desc)
{
    const struct {
        const char *what;
        unsigned value, count;
    } choices[] = {
        {"method", desc->method, METHOD_COUNT},
        {"G-buffer", desc->gbuffer, GBUFFER_COMPACT + 1},
        {"source of positions", desc->position, POSITION_RECONSTRUCT + 1},
        {"depth range", desc->depth_range, DEPTH_RANGE_REVERSED + 1},
        {"depth function", desc->depth_func, DEPTH_LEQUAL + 1},
        {"peel test", desc->peel_test, PEEL_TEST_RAW + 1},
        {"culling", desc->cull, CULL_NONE + 1},
        {"treatment of normals", desc->normals, NORMALS_KEPT + 1},
        {"form of highlights", desc->ggx, GGX_STABLE + 1},
        {"blending of opaque surfaces", desc->opaque_blend, OPAQUE_BLEND_SEED + 1},
        {"shading", desc->shading, SHADING_PHONG + 1},
        {"draw order", desc->draw_order, DRAW_ORDER_SHUFFLE + 1},
        {"unit of sorting", desc->sort, SORT_TRIANGLES + 1},
        {"weight", desc->weight, WEIGHT_10 + 1},
        {"effect", desc->post, POST_EDGES + 1},
        {"path", desc->ref_path, REF_PATH_TILE + 1},
        {"instruction set", desc->simd, SIMD_COUNT},
    };
    for (size_t i = 0; i < sizeof choices / sizeof *choices; i++)
        if (choices[i].value >= choices[i].count)
            return result_fail(RESULT_BAD_INPUT, "%s %d: expected 0 to %u", choices[i].what,
                               (int)choices[i].value, choices[i].count - 1);
    return RESULT_OK;
}

static const char *format_name(PixelFormat format)
{
    return format < FORMAT_COUNT ? format_info(format)->name : "(none)";
}

static Result check_formats(const RenderDesc *desc)
{
    PixelFormat depth = render_desc_depth(desc);
    if (desc->accum >= FORMAT_COUNT || format_info(desc->accum)->channels != 4)
        return result_fail(RESULT_BAD_INPUT, "accumulation in format %s: expected four channels",
                           format_name(desc->accum));
    if (depth != FORMAT_D32F && depth != FORMAT_D24 && depth != FORMAT_D16)
        return result_fail(RESULT_BAD_INPUT, "depth in format %s: expected d32f, d24 or d16",
                           format_name(depth));
    return RESULT_OK;
}

static Result check_counts(const RenderDesc *desc)
{
    if (desc->passes < 0 || desc->passes > PASSES_MAX)
        return result_fail(RESULT_BAD_INPUT, "%d passes: expected 0 (auto) to %d", desc->passes,
                           PASSES_MAX);
    if (desc->tile != 0 &&
        (desc->tile < TILE_MIN || desc->tile > TILE_MAX || (desc->tile & (desc->tile - 1)) != 0))
        return result_fail(RESULT_BAD_INPUT,
                           "tiles of %d pixels: expected a power of two, %d to %d", desc->tile,
                           TILE_MIN, TILE_MAX);
    if (desc->nodes_per_pixel < 0 || desc->nodes_per_pixel > NODES_MAX)
        return result_fail(RESULT_BAD_INPUT, "%d nodes a pixel: expected 0 (no limit) to %d",
                           desc->nodes_per_pixel, NODES_MAX);
    if (desc->threads < 0 || desc->threads > THREADS_MAX)
        return result_fail(RESULT_BAD_INPUT, "%d threads: expected 0 (one per processor) to %d",
                           desc->threads, THREADS_MAX);
    return RESULT_OK;
}

Result render_desc_check(const RenderDesc *desc)
{
    if (desc->width < 1 || desc->height < 1 || desc->width > SIZE_MAX_PIXELS ||
        desc->height > SIZE_MAX_PIXELS)
        return result_fail(RESULT_BAD_INPUT, "size %d×%d: expected 1 to %d pixels a side",
                           desc->width, desc->height, SIZE_MAX_PIXELS);
    if (!(desc->bias >= 0.0f && desc->bias <= 1.0f))
        return result_fail(RESULT_BAD_INPUT, "bias %g: expected 0 to 1", (double)desc->bias);
    if (!isfinite(desc->time) || fabs(desc->time) > 1e6)
        return result_fail(RESULT_BAD_INPUT, "time %g: expected at most 1e6 seconds", desc->time);
    Result result = check_counts(desc);
    if (result == RESULT_OK)
        result = check_formats(desc);
    return result == RESULT_OK ? check_choices(desc) : result;
}

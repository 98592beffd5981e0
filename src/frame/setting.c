#include "frame/setting.h"

static const SettingInfo infos[SETTING_COUNT] = {
    [SETTING_CULL] = {"cull", {"gltf", "seed", "none"}},
    [SETTING_NORMALS] = {"normals", {"faced", "kept"}},
    [SETTING_SHADING] = {"shading", {"ggx", "phong"}},
    [SETTING_GGX] = {"ggx", {"source", "stable"}},
    [SETTING_BACK_LIGHT] = {"back-light", {"off", "on"}},
    [SETTING_DEPTH_FUNC] = {"depth-func", {"less", "lequal"}},
    [SETTING_DEPTH_RANGE] = {"depth-range", {"gl", "zero-one", "reversed"}},
    [SETTING_PEEL_TEST] = {"peel-test", {"stored", "raw"}},
    [SETTING_GBUFFER] = {"gbuffer", {"full", "seed", "compact"}},
    [SETTING_POSITION] = {"position", {"buffer", "reconstruct"}},
    [SETTING_DEPTH] = {"depth", {"d32f", "d24", "d16"}},
    [SETTING_ACCUM] = {"accum", {"rgba32f", "rgba16f", "rgba16", "rgba8"}},
    [SETTING_SORT] = {"sort", {"objects", "triangles"}},
    [SETTING_WEIGHT] = {"weight", {"9", "7", "8", "10"}},
    [SETTING_POST] = {"post", {"none", "edges"}},
    [SETTING_SIMD] = {"simd", {"auto", "scalar", "sse2", "avx2", "avx512"}},
    [SETTING_MODEL] = {"model", {"needed", "all"}},
};

static const PixelFormat depths[] = {FORMAT_D32F, FORMAT_D24, FORMAT_D16};
static const PixelFormat accums[] = {FORMAT_RGBA32F, FORMAT_RGBA16F, FORMAT_RGBA16, FORMAT_RGBA8};

const SettingInfo *setting_info(SettingId id)
{
    return &infos[id];
}

int setting_choice_count(SettingId id)
{
    int count = 0;
    while (count < SETTING_CHOICES_MAX && infos[id].choices[count])
        count++;
    return count;
}

/* Each enumeration of a RenderDesc counts its names as they stand above; formats do not. */
#define FIELDS(FIELD)                                                                              \
    FIELD(SETTING_CULL, cull, CullMode)                                                            \
    FIELD(SETTING_NORMALS, normals, NormalMode)                                                    \
    FIELD(SETTING_SHADING, shading, ShadingModel)                                                  \
    FIELD(SETTING_GGX, ggx, GgxForm)                                                               \
    FIELD(SETTING_BACK_LIGHT, back_light, bool)                                                    \
    FIELD(SETTING_DEPTH_FUNC, depth_func, DepthFunc)                                               \
    FIELD(SETTING_DEPTH_RANGE, depth_range, DepthRange)                                            \
    FIELD(SETTING_PEEL_TEST, peel_test, PeelTest)                                                  \
    FIELD(SETTING_GBUFFER, gbuffer, GBufferFormat)                                                 \
    FIELD(SETTING_POSITION, position, PositionSource)                                              \
    FIELD(SETTING_SORT, sort, SortUnit)                                                            \
    FIELD(SETTING_WEIGHT, weight, WeightEquation)                                                  \
    FIELD(SETTING_POST, post, PostEffect)                                                          \
    FIELD(SETTING_SIMD, simd, SimdChoice)                                                          \
    FIELD(SETTING_MODEL, model_all, bool)

void setting_put(RenderDesc *desc, SettingId id, int choice)
{
    switch (id) {
#define PUT(setting, member, Type)                                                                 \
    case setting:                                                                                  \
        desc->member = (Type)choice;                                                               \
        return;
        FIELDS(PUT)
#undef PUT
    case SETTING_DEPTH:
        desc->depth = depths[choice];
        return;
    case SETTING_ACCUM:
        desc->accum = accums[choice];
        return;
    case SETTING_COUNT:
        return;
    }
}

/* Which of count formats; the first where it is none of them. */
static int place(PixelFormat format, const PixelFormat *formats, int count)
{
    int i = count - 1;
    while (i > 0 && formats[i] != format)
        i--;
    return i;
}

int setting_get(const RenderDesc *desc, SettingId id)
{
    switch (id) {
#define GET(setting, member, Type)                                                                 \
    case setting:                                                                                  \
        return (int)desc->member;
        FIELDS(GET)
#undef GET
    case SETTING_DEPTH:
        return place(render_desc_depth(desc), depths, sizeof depths / sizeof *depths);
    case SETTING_ACCUM:
        return place(desc->accum, accums, sizeof accums / sizeof *accums);
    case SETTING_COUNT:
        break;
    }
    return 0;
}

/* Random settings: every method of the table, what each has of its own, formats, tests, shading and
 * draw order. */
#ifndef PEEL_TESTS_RANDOM_DESC_H
#define PEEL_TESTS_RANDOM_DESC_H

#include "soup_kinds.h"

#include "frame/render_desc.h"

#include <math.h>

/* Of peel as much as of two others. */
static inline MethodId random_desc_method(Random *random)
{
    uint64_t method = random_bits(random) % (METHOD_COUNT + 1);
    return method < METHOD_COUNT ? (MethodId)method : METHOD_PEEL;
}

static inline void random_desc_formats(Random *random, RenderDesc *desc)
{
    static const PixelFormat depths[] = {FORMAT_D32F, FORMAT_D24, FORMAT_D16};
    static const PixelFormat accums[] = {FORMAT_RGBA32F, FORMAT_RGBA16F, FORMAT_RGBA16,
                                         FORMAT_RGBA8};
    desc->depth = depths[random_bits(random) % 3];
    desc->accum = accums[random_bits(random) % 4];
    desc->gbuffer = (GBufferFormat)(random_bits(random) % 3);
    desc->position = (PositionSource)(random_bits(random) % 2);
    desc->depth_range = (DepthRange)(random_bits(random) % 3);
    desc->depth_func = (DepthFunc)(random_bits(random) % 2);
    desc->peel_test = (PeelTest)(random_bits(random) % 2);
    desc->cull = (CullMode)(random_bits(random) % 3);
    desc->normals = (NormalMode)(random_bits(random) % 2);
    desc->ggx = (GgxForm)(random_bits(random) % 2);
    desc->back_light = random_bits(random) % 2;
    desc->opaque_blend = (OpaqueBlend)(random_bits(random) % 2);
    desc->shading = random_bits(random) % 8 ? SHADING_GGX : SHADING_PHONG;
    desc->bias =
        random_bits(random) % 8 ? 0.0f : (float)ldexp(1.0, -(int)(random_bits(random) % 24));
}

/* Every method gets those of all: what means nothing to it must change nothing. */
static inline void random_desc_of_methods(Random *random, RenderDesc *desc)
{
    static const int nodes[] = {0, 0, 1, 2, 6, 40};
    desc->draw_order = (DrawOrder)(random_bits(random) % 3);
    desc->draw_seed = random_bits(random) >> 1;
    desc->sort = (SortUnit)(random_bits(random) % 2);
    desc->weight = (WeightEquation)(random_bits(random) % 4);
    desc->nodes_per_pixel = nodes[random_bits(random) % 6];
    desc->post = (PostEffect)(random_bits(random) % 2);
}

/* All but size, threads and the way of ref. One in four has the default formats, one the seed's. */
static inline RenderDesc random_desc_settings(Random *random)
{
    static const int passes[] = {0, 0, 1, 2, 5};
    RenderDesc desc = {.passes = passes[random_bits(random) % 5]};
    uint64_t profile = random_bits(random) % 4;
    if (profile == 1)
        render_desc_seed_profile(&desc);
    if (profile >= 2)
        random_desc_formats(random, &desc);
    desc.method = random_desc_method(random);
    random_desc_of_methods(random, &desc);
    return desc;
}

/* The same in a window that suits the soup. */
static inline RenderDesc random_desc(Random *random, SoupKind kind)
{
    static const int sizes[][2] = {{1, 1},    {33, 17},  {97, 61},  {130, 70}, {65, 64},
                                   {128, 96}, {255, 31}, {31, 200}, {160, 120}};
    static const int exact[][2] = {{64, 64}, {128, 64}, {32, 128}, {256, 64}, {128, 128}};
    const int *size =
        soup_kind_is_exact(kind) ? exact[random_bits(random) % 5] : sizes[random_bits(random) % 9];
    RenderDesc desc = random_desc_settings(random);
    desc.width = size[0];
    desc.height = size[1];
    return desc;
}

/* Random scene number `seed`: its kind, and settings and a window that suit it. */
static inline SoupKind random_case(uint64_t seed, RenderDesc *desc, Soup *soup)
{
    SoupKind kind = (SoupKind)(seed % SOUP_KINDS);
    Random random = random_seed(seed);
    *desc = random_desc(&random, kind);
    soup_make_kind(&random, kind, desc->width, desc->height, soup);
    return kind;
}

#endif

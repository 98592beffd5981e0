/* What the tests of single methods share: random soups under random settings, ref against OpenGL
 * bit for bit, and buffers of ref's trace. Link bits.c. */
#ifndef PEEL_TESTS_METHODS_H
#define PEEL_TESTS_METHODS_H

#include "bits.h"
#include "random_desc.h"
#include "testing.h"

#include "compare/store.h"
#include "ref/pipeline/pipeline.h"

static inline void methods_ok(Result result)
{
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

/* A soup of the kind that the seed says, and desc's method and a window that suits every kind. */
static inline void methods_make_soup(uint64_t seed, MethodId method, RenderDesc *desc, Soup *soup)
{
    Random random = random_seed(seed);
    SoupKind kind = (SoupKind)(seed % SOUP_KINDS);
    desc->width = 64;
    desc->height = soup_kind_is_exact(kind) ? 64 : 45;
    desc->method = method;
    soup_make_kind(&random, kind, desc->width, desc->height, soup);
    methods_ok(scene_validate(&soup->scene));
}

/* Of one random soup; *out: what was compared. */
static inline void methods_check_soup(uint64_t seed, MethodId method, Bits *out)
{
    static Soup soup;
    RenderDesc desc;
    SoupKind kind = random_case(seed, &desc, &soup);
    desc.method = method;
    methods_ok(scene_validate(&soup.scene));
    bits_compare(&soup.scene, &desc, out);
    ck_assert_msg(out->differing == 0, "seed %llu, %s: %s", (unsigned long long)seed,
                  soup_kind_name(kind), out->difference);
}

/* Renders with ref, and copies buffer `name` of its trace. The caller frees both. */
static inline void methods_buffer(const Scene *scene, const RenderDesc *desc, const char *name,
                                  Image *out, Frame *frame)
{
    TraceStore *store;
    methods_ok(store_create(0, &store));
    methods_ok(pipeline_render(scene, desc, store_sink(store), frame));
    int index = store_find(store, name);
    ck_assert_msg(index >= 0, "no buffer %s", name);
    methods_ok(store_image(store, index, out));
    store_destroy(store);
}

/* Squares that face the eye, one behind the other at depths[0] …, over the whole of a window of
 * 192 × 20 pixels; all of material 2, with this alpha and no texture, under one light at
 * the eye. */
static inline void methods_squares(Soup *soup, const double depths[], uint32_t count, float alpha)
{
    Random random = random_seed(4);
    soup_make(&random, soup);
    soup->camera.yfov = 1.0;
    soup->camera.near = 0.125;
    soup->camera.far = 1000.0;
    for (uint32_t i = 0; i < count; i++)
        soup_square(soup, i, depths[i], -1, 1);
    Material *material = &soup->materials[2];
    material->base_color_texture = material->metallic_roughness_texture = 0;
    material->alpha_mode = ALPHA_BLEND;
    material->base_color[3] = alpha;
    memset(soup->lights[0].position, 0, sizeof soup->lights[0].position);
    soup->scene.light_count = 1;
}

#endif

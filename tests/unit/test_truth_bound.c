/* The bound of truth's own rounding: pixels of built-in scenes and of random soups, recomputed at
 * 200 bits from the scene's floats to the colour, lie within it; and the frame's pixels are the
 * values that the bound is about. */
#include "mpfr_real.h"
#include "testing.h"

/* The random scenes, beside the truth's triangles of the same name. */
#define Soup RandomSoup
#include "../cross/soup_kinds.h"
#undef Soup

#include "ref/truth/bound.h"
#include "ref/truth/radiance_body.h"
#include "ref/truth/truth.h"
#include "scene/generate.h"

#include <math.h>
#include <stdio.h>

enum {
    SIZE = 64 /* one tile */
};

/* ---- one fragment at 200 bits ---------------------------------------------------------------- */

typedef struct RealCorner {
    Real x, y, w, position[3], normal[3], uv[2];
} RealCorner;

/* Column-major 3×3 part, or with the fourth column. */
static Real row_times(const float *m, int stride, int row, bool point, const Real v[3])
{
    Real sum = real_of(point ? (double)m[3 * stride + row] : 0.0);
    for (int i = 0; i < 3; i++)
        sum = real_add(sum, real_mul(real_of(m[stride * i + row]), v[i]));
    return sum;
}

static RealCorner make_corner(const View *view, const SoupDraw *draw, uint32_t vertex)
{
    RealCorner corner;
    const Mesh *mesh = draw->mesh;
    Real p[3], n[3];
    for (uint32_t i = 0; i < 3; i++) {
        p[i] = real_of(mesh->position[3 * vertex + i]);
        n[i] = real_of(mesh->normal[3 * vertex + i]);
    }
    for (int i = 0; i < 3; i++) {
        corner.position[i] = row_times(draw->draw->model_view, 4, i, true, p);
        corner.normal[i] = row_times(draw->draw->normal_matrix, 3, i, false, n);
    }
    for (uint32_t i = 0; i < 2; i++)
        corner.uv[i] = real_of(mesh->uv ? (double)mesh->uv[2 * vertex + i] : 0.0);
    Real clip[4];
    for (int i = 0; i < 4; i++)
        clip[i] = row_times(view->projection, 4, i, true, corner.position);
    corner.x = real_mul(real_add(clip[0], clip[3]), real_of(0.5 * view->width));
    corner.y = real_mul(real_add(clip[1], clip[3]), real_of(0.5 * view->height));
    corner.w = clip[3];
    return corner;
}

static Real cross(Real a, Real d, Real b, Real c)
{
    return real_sub(real_mul(a, d), real_mul(b, c));
}

static void find_weights(const RealCorner c[3], int x, int y, Real weight[3])
{
    Real dx[3], dy[3], sum = real_of(0.0);
    for (int i = 0; i < 3; i++) {
        dx[i] = real_sub(c[i].x, real_mul(real_of(x + 0.5), c[i].w));
        dy[i] = real_sub(c[i].y, real_mul(real_of(y + 0.5), c[i].w));
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        weight[i] = cross(dx[j], dy[k], dx[k], dy[j]);
        sum = real_add(sum, weight[i]);
    }
    for (int i = 0; i < 3; i++)
        weight[i] = real_div(weight[i], sum);
}

static Real mixed(const Real weight[3], Real a, Real b, Real c)
{
    return real_add(real_add(real_mul(weight[0], a), real_mul(weight[1], b)),
                    real_mul(weight[2], c));
}

/* ---- textures -------------------------------------------------------------------------------- */

static int wrapped(TextureWrap wrap, long i, long size)
{
    if (wrap == WRAP_REPEAT)
        return (int)(((i % size) + size) % size);
    return (int)(i < 0 ? 0 : i < size ? i : size - 1);
}

/* The two texels and the fraction between. */
static Real find_texels(TextureWrap wrap, bool nearest, Real u, uint32_t size, int texel[2])
{
    Real c = u, one = real_of(1.0);
    if (wrap == WRAP_REPEAT)
        c = real_sub(u, real_floor(u));
    if (wrap == WRAP_MIRROR) {
        Real two = real_of(2.0), m = real_sub(u, real_mul(two, real_floor(real_div(u, two))));
        c = mpfr_cmp(m, one) > 0 ? real_sub(two, m) : m;
    }
    c = real_min(real_max(c, real_of(0.0)), one);
    Real x = real_sub(real_mul(c, real_of(size)), real_of(nearest ? 0.0 : 0.5));
    Real low = real_floor(x);
    long i = mpfr_get_si(low, MPFR_RNDD);
    texel[0] = wrapped(wrap, i, (long)size);
    texel[1] = wrapped(wrap, i + 1, (long)size);
    return real_sub(x, low);
}

static void sample(const Texture *texture, const Real uv[2], Real rgba[4])
{
    int x[2], y[2];
    Real f = find_texels(texture->wrap_s, texture->nearest, uv[0], texture->width, x);
    Real g = find_texels(texture->wrap_t, texture->nearest, uv[1], texture->height, y);
    for (size_t i = 0; i < 4; i++) {
        Real t[2][2];
        for (int row = 0; row < 2; row++)
            for (int column = 0; column < 2; column++)
                t[row][column] = real_of(
                    texture->texels[4 * ((size_t)y[row] * texture->width + (size_t)x[column]) + i]);
        rgba[i] = texture->nearest
                      ? t[0][0]
                      : real_mix(real_mix(t[0][0], t[0][1], f), real_mix(t[1][0], t[1][1], f), g);
    }
}

/* ---- one pixel at 200 bits ------------------------------------------------------------------- */

static void set_material(const Soup *soup, const Material *material, const Real uv[2],
                         RealSurface *surface, Real *alpha)
{
    Real rgba[4];
    for (int i = 0; i < 3; i++)
        surface->diffuse[i] = real_of(material->base_color[i]);
    *alpha = real_of(material->base_color[3]);
    surface->roughness = real_of(material->roughness);
    surface->metallic = real_of(material->metallic);
    surface->occlusion = real_of(material->occlusion);
    if (material->base_color_texture) {
        sample(&soup->textures[material->base_color_texture - 1], uv, rgba);
        for (int i = 0; i < 3; i++)
            surface->diffuse[i] = real_mul(surface->diffuse[i], rgba[i]);
        *alpha = real_mul(*alpha, rgba[3]);
    }
    if (material->metallic_roughness_texture) {
        sample(&soup->textures[material->metallic_roughness_texture - 1], uv, rgba);
        surface->roughness = real_mul(surface->roughness, rgba[1]);
        surface->metallic = real_mul(surface->metallic, rgba[2]);
    }
}

static void blend(const Soup *soup, const RenderDesc *desc, const Fragment *fragment, int x, int y,
                  Real rgba[4])
{
    const SoupDraw *draw = soup_draw(soup, fragment->triangle);
    const uint32_t *index =
        &draw->mesh->index[3 * (size_t)(fragment->triangle - draw->first_triangle)];
    RealCorner c[3];
    for (int i = 0; i < 3; i++)
        c[i] = make_corner(soup->view, draw, index[i]);
    Real weight[3], normal[3], uv[2], alpha, rgb[3], one = real_of(1.0);
    RealSurface surface;
    find_weights(c, x, y, weight);
    for (int i = 0; i < 3; i++) {
        surface.position[i] = mixed(weight, c[0].position[i], c[1].position[i], c[2].position[i]);
        normal[i] = mixed(weight, c[0].normal[i], c[1].normal[i], c[2].normal[i]);
        if (fragment->back && desc->normals == NORMALS_FACED)
            normal[i] = real_neg(normal[i]);
    }
    for (int i = 0; i < 2; i++)
        uv[i] = mixed(weight, c[0].uv[i], c[1].uv[i], c[2].uv[i]);
    real_normalize(normal, surface.normal);
    set_material(soup, draw->material, uv, &surface, &alpha);
    bool transparent = draw->draw->transparent;
    if (!transparent)
        alpha = one;
    if (!real_may_exceed(alpha, (double)SHADING_ALPHA_TEST))
        return;
    real_shade(soup->view, &surface, desc->shading, GGX_SOURCE, desc->back_light && transparent,
               rgb);
    for (int i = 0; i < 3; i++)
        rgba[i] = real_add(rgba[i], real_mul(real_mul(rgb[i], alpha), rgba[3]));
    rgba[3] = real_mul(rgba[3], real_sub(one, alpha));
}

/* ---- comparison ------------------------------------------------------------------------------ */

typedef struct Totals {
    uint64_t values, unbounded;
    double ratio, worst; /* sum and greatest of error over bound */
} Totals;

static void check_pixel(const Soup *soup, BoundTriangles *triangles, const RenderDesc *desc,
                        const TileFragments *tile, int x, int row, const Frame *frame,
                        Totals *totals)
{
    int pixel = row * TRACE_TILE + x, y = soup->view->height - 1 - row;
    Bounded bound[4] = {bounded_of(0.0), bounded_of(0.0), bounded_of(0.0), bounded_of(1.0)};
    real_empty();
    Real exact[4] = {real_of(0.0), real_of(0.0), real_of(0.0), real_of(1.0)};
    const Fragment *opaque = &tile->opaque[pixel];
    for (uint32_t i = tile->first[pixel]; i <= tile->first[pixel + 1]; i++) {
        const Fragment *fragment = i < tile->first[pixel + 1] ? &tile->sorted[i] : opaque;
        if (fragment->triangle == FRAGMENT_NO_TRIANGLE)
            break;
        bound_blend(triangles, desc, fragment, x, y, bound);
        blend(soup, desc, fragment, x, y, exact);
    }
    bound_resolve(soup->view, desc->accum, bound);
    const float *final = image_pixel(&frame->final, x, row);
    const float *rounding = image_pixel(&frame->rounding, x, row);
    for (int i = 0; i < 4; i++) {
        Real e = i < 3 ? real_add(exact[i], real_mul(real_of(soup->view->background[i]), exact[3]))
                       : real_sub(real_of(1.0), exact[3]);
        totals->values++;
        if (!isfinite(bound[i].exact)) {
            totals->unbounded++;
            continue;
        }
        double off = real_distance(e, bound[i].value);
        ck_assert_msg(off <= bound[i].exact, "%d, %d, channel %d: %.17g is %g from exact, bound %g",
                      x, row, i, bound[i].value, off, bound[i].exact);
        ck_assert_double_le(off, (double)rounding[i]);
        if (bound[i].exact > 0.0) {
            totals->ratio += off / bound[i].exact;
            totals->worst = fmax(totals->worst, off / bound[i].exact);
        }
        double rounded = fabs((double) final[i] - bound[i].value);
        ck_assert_msg(rounded <=
                          1.0001 * BOUNDED_SINGLE * fabs(bound[i].value) + 1e-45 + bound[i].exact,
                      "%d, %d, channel %d: the frame has %.9g, not %.17g", x, row, i,
                      (double) final[i], bound[i].value);
    }
}

/* Some pixels of a scene that fits one tile. */
static void check_scene(const Scene *scene, RenderDesc desc, Random *random, int pixels,
                        Totals *totals)
{
    static TileFragments tile;
    Frame frame;
    View view;
    Soup soup;
    desc.bound = true;
    ck_assert_msg(truth_render(scene, &desc, NULL, &frame) == RESULT_OK, "%s", result_message());
    ck_assert(view_build(scene, &desc, &view) == RESULT_OK);
    Pool *pool = pool_create(1);
    ck_assert(soup_build(scene, &view, pool, (size_t)1 << 30, &soup) == RESULT_OK);
    tile = (TileFragments){.limit_bytes = (size_t)1 << 30};
    ck_assert(fragments_collect(&soup, &desc, 0, &tile) == RESULT_OK);
    BoundTriangles *triangles = bound_triangles_create(&soup, !desc.unfused);
    ck_assert_ptr_nonnull(triangles);
    for (int i = 0; i < pixels; i++)
        check_pixel(&soup, triangles, &desc, &tile,
                    (int)(random_bits(random) % (uint64_t)desc.width),
                    (int)(random_bits(random) % (uint64_t)desc.height), &frame, totals);
    bound_triangles_destroy(triangles);
    fragments_free(&tile);
    soup_free(&soup);
    pool_destroy(pool);
    view_free(&view);
    frame_free(&frame);
}

static void print_totals(const char *name, const Totals *totals)
{
    printf("%-18s %llu values, %llu without bound, error over bound: mean %.3g, greatest %.3g\n",
           name, (unsigned long long)totals->values, (unsigned long long)totals->unbounded,
           totals->ratio / (double)totals->values, totals->worst);
    fflush(stdout);
}

START_TEST(test_scenes)
{
    static const char *const names[] = {"teapot_hall", "tutorial", "chain", "crossing_planes",
                                        "lamps"};
    Scene scene;
    Totals totals = {0};
    Random random = random_seed(7);
    ck_assert(generate_find(names[_i])->generate(&scene) == RESULT_OK);
    RenderDesc desc = {.width = SIZE, .height = SIZE, .lights = 4, .back_light = _i % 2};
    check_scene(&scene, desc, &random, testing_samples(150), &totals);
    scene_free(&scene);
    print_totals(names[_i], &totals);
    ck_assert_uint_le(totals.unbounded, totals.values / 50);
    ck_assert_double_gt(totals.ratio / (double)totals.values, 1e-4); /* it says something */
}
END_TEST

START_TEST(test_soups)
{
    static RandomSoup soup_of_kind;
    Totals totals = {0};
    for (uint64_t seed = 1; seed <= (uint64_t)testing_samples(60); seed++) {
        SoupKind kind = (SoupKind)(seed % SOUP_KINDS);
        Random random = random_seed(seed);
        RenderDesc desc = {.width = SIZE,
                           .height = SIZE,
                           .normals = seed & 1 ? NORMALS_KEPT : NORMALS_FACED,
                           .cull = CULL_NONE,
                           .method = seed % 3 ? METHOD_PEEL : METHOD_FORWARD,
                           .shading = seed % 6 ? SHADING_GGX : SHADING_PHONG,
                           .back_light = seed & 2};
        soup_make_kind(&random, kind, SIZE, SIZE, &soup_of_kind);
        check_scene(&soup_of_kind.scene, desc, &random, 40, &totals);
    }
    print_totals("soups", &totals);
    ck_assert_uint_le(totals.unbounded, totals.values / 4);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("truth_bound");
    TCase *tcase = tcase_create("bound");
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(tcase, test_scenes, 0, 5);
    tcase_add_test(tcase, test_soups);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

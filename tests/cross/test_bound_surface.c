/* The bounds of interpolated surfaces against what ref interpolates: every position, normal, colour
 * and roughness in the G-buffers of random soups, and the depth. Here a forgotten rounding shows
 * that is too small to show in a lit pixel.
 *
 * PEEL_TEST_SEED=N runs one soup; PEEL_TEST_COUNT=N that many, from there or from 1. */
/* The random scenes, beside the truth's triangles of the same name. */
#define Soup RandomSoup
#include "soup_kinds.h"
#undef Soup

#include "testing.h"

#include "compare/store.h"
#include "ref/pipeline/buffers.h"
#include "ref/pipeline/encode.h"
#include "ref/pipeline/pipeline.h"
#include "ref/truth/bound.h"

#include <math.h>
#include <stdio.h>

enum {
    SIZE = 64, /* one tile */
    PEELS = 12 /* compared at most */
};

typedef enum Part {
    POSITION,
    NORMAL,
    DIFFUSE,
    MATERIAL,
    PARTS
} Part;
static const char *const part_names[PARTS] = {"position", "normal", "diffuse", "material"};

typedef struct Tally {
    uint64_t values, unbounded, over_half;
    double greatest; /* error over bound */
} Tally;

typedef struct Case {
    uint64_t seed;
    RenderDesc desc;
    View view;
    Soup soup;
    BoundTriangles *triangles;
    TileFragments *tile;
    TraceStore *trace;
    Tally (*tallies)[PARTS]; /* by kind of soup */
} Case;

static void ok(Result result)
{
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

static Image load(const TraceStore *trace, int peel, const char *what)
{
    char name[48];
    Image image = {0};
    snprintf(name, sizeof name, "peel.%d.%s", peel, what);
    if (peel < 0)
        snprintf(name, sizeof name, "opaque.%s", what);
    int index = store_find(trace, name);
    if (index >= 0)
        ok(store_image(trace, index, &image));
    return image;
}

static void check_value(const Case *of, Part part, int x, int row, float value, Bounded bound,
                        Tally *tally)
{
    tally->values++;
    if (!isfinite(bound.single)) {
        tally->unbounded++;
        return;
    }
    double error = fabs((double)value - bound.value);
    ck_assert_msg(error <= bound.single,
                  "PEEL_TEST_SEED=%llu: %d, %d: %s %.9g instead of %.17g, off by %g, bound %g",
                  (unsigned long long)of->seed, x, row, part_names[part], (double)value,
                  bound.value, error, bound.single);
    if (bound.single > 0.0) {
        tally->greatest = fmax(tally->greatest, error / bound.single);
        tally->over_half += error > 0.5 * bound.single;
    }
}

/* What the lighting pass fetches and decodes, part by part. */
static void fetch(const Case *of, const Image images[PARTS], const Image *depth, int x, int row,
                  float values[PARTS][4])
{
    uint32_t saved = op_enter();
    for (int part = 0; part < PARTS; part++)
        if (images[part].pixels)
            format_fetch(images[part].format, image_pixel(&images[part], x, row), values[part]);
    if (images[NORMAL].format == FORMAT_RG16)
        decode_octahedral(values[NORMAL], values[NORMAL]);
    if (!images[POSITION].pixels)
        decode_position(&of->view.unprojection,
                        depth_fetch(depth->format, *(const uint32_t *)image_pixel(depth, x, row)),
                        x, SIZE - 1 - row, values[POSITION]);
    op_leave(saved);
}

/* It may cover the pixel, and have that depth there. */
static void check_depth(const Case *of, const Fragment *fragment, int x, int row,
                        const Image *depth)
{
    BoundFragment bound;
    bound_fragment(of->triangles, &of->desc, fragment->triangle, x, SIZE - 1 - row, &bound);
    double z = (double)depth_fetch(depth->format, *(const uint32_t *)image_pixel(depth, x, row));
    ck_assert_msg(bound.possible && z >= bound.stored[0] && z <= bound.stored[1],
                  "PEEL_TEST_SEED=%llu: %d, %d: depth %.9g, expected %.17g to %.17g%s",
                  (unsigned long long)of->seed, x, row, z, bound.stored[0], bound.stored[1],
                  bound.possible ? "" : " and nothing");
}

/* Triangles that were kept bound as those looked at anew. */
static void check_kept(const Case *of, const Fragment *fragment, int x, int row)
{
    BoundTriangles *anew = bound_triangles_create(&of->soup, !of->desc.unfused);
    BoundTriangles *const both[2] = {of->triangles, anew};
    BoundedSurface surfaces[2];
    BoundFragment bounds[2];
    ck_assert_ptr_nonnull(anew);
    memset(surfaces, 0, sizeof surfaces);
    memset(bounds, 0, sizeof bounds);
    for (int i = 0; i < 2; i++) {
        bound_surface(both[i], &of->desc, fragment, x, SIZE - 1 - row, &surfaces[i]);
        bound_fragment(both[i], &of->desc, fragment->triangle, x, SIZE - 1 - row, &bounds[i]);
    }
    ck_assert_mem_eq(&surfaces[0], &surfaces[1], sizeof surfaces[0]);
    ck_assert_mem_eq(&bounds[0], &bounds[1], sizeof bounds[0]);
    bound_triangles_destroy(anew);
}

static void check_fragment(const Case *of, const Fragment *fragment, int x, int row,
                           const Image images[PARTS], const Image *depth)
{
    BoundedSurface surface;
    Tally *tallies = of->tallies[of->seed % SOUP_KINDS];
    bound_surface(of->triangles, &of->desc, fragment, x, SIZE - 1 - row, &surface);
    const Bounded material[3] = {surface.roughness, surface.metallic, surface.occlusion};
    const Bounded *bounds[PARTS] = {surface.position, surface.normal, surface.diffuse, material};
    float values[PARTS][4];
    fetch(of, images, depth, x, row, values);
    check_depth(of, fragment, x, row, depth);
    if ((row * SIZE + x) % 61 == 0)
        check_kept(of, fragment, x, row);
    for (int part = 0; part < PARTS; part++)
        for (int i = 0; i < 3 + (part == DIFFUSE); i++)
            check_value(of, (Part)part, x, row, values[part][i], bounds[part][i], &tallies[part]);
}

/* One layer's fragments, where ref and truth have the same. */
static void check_layer(const Case *of, int peel)
{
    Image images[PARTS], ids = load(of->trace, peel, "primitive"),
                         depth = load(of->trace, peel, "depth");
    for (int part = 0; part < PARTS; part++)
        images[part] = load(of->trace, peel, part_names[part]);
    for (int pixel = 0; ids.pixels && pixel < SIZE * SIZE; pixel++) {
        const TileFragments *tile = of->tile;
        uint32_t at = tile->first[pixel] + (uint32_t)(peel < 0 ? 0 : peel);
        const Fragment *fragment = peel < 0 ? &tile->opaque[pixel] : &tile->sorted[at];
        uint32_t id = ((const uint32_t *)ids.pixels)[pixel];
        bool there =
            peel < 0 ? fragment->triangle != FRAGMENT_NO_TRIANGLE : at < tile->first[pixel + 1];
        if (there && id == soup_primitive(&of->soup, fragment->triangle))
            check_fragment(of, fragment, pixel % SIZE, pixel / SIZE, images, &depth);
    }
    image_free(&ids);
    image_free(&depth);
    for (int part = 0; part < PARTS; part++)
        image_free(&images[part]);
}

static void run_case(uint64_t seed, Tally tallies[SOUP_KINDS][PARTS])
{
    static RandomSoup random_soup;
    static TileFragments tile;
    Random random = random_seed(seed);
    Case of = {.seed = seed, .tile = &tile, .tallies = tallies};
    of.desc = (RenderDesc){.width = SIZE,
                           .height = SIZE,
                           .threads = 1,
                           .cull = CULL_NONE,
                           .depth_range = (DepthRange)(random_bits(&random) % 3),
                           .normals = (NormalMode)(random_bits(&random) % 2),
                           .unfused = random_bits(&random) % 2};
    if (seed / SOUP_KINDS % 2) { /* every other soup of a kind is stored in fewer bits */
        of.desc.gbuffer = (GBufferFormat)(1 + random_bits(&random) % 2);
        of.desc.position = (PositionSource)(random_bits(&random) % 2);
        of.desc.depth =
            (PixelFormat[]){FORMAT_D32F, FORMAT_D24, FORMAT_D16}[random_bits(&random) % 3];
    }
    soup_make_kind(&random, (SoupKind)(seed % SOUP_KINDS), SIZE, SIZE, &random_soup);
    Frame frame;
    ok(store_create(0, &of.trace));
    ok(pipeline_render(&random_soup.scene, &of.desc, store_sink(of.trace), &frame));
    ok(view_build(&random_soup.scene, &of.desc, &of.view));
    Pool *pool = pool_create(1);
    ok(soup_build(&random_soup.scene, &of.view, pool, (size_t)1 << 30, &of.soup));
    of.triangles = bound_triangles_create(&of.soup, !of.desc.unfused);
    ck_assert_ptr_nonnull(of.triangles);
    tile = (TileFragments){.limit_bytes = (size_t)1 << 30};
    ok(fragments_collect(&of.soup, &of.desc, 0, &tile));
    for (int peel = -1; peel < frame.peels && peel < PEELS; peel++)
        check_layer(&of, peel);
    fragments_free(&tile);
    bound_triangles_destroy(of.triangles);
    soup_free(&of.soup);
    pool_destroy(pool);
    view_free(&of.view);
    frame_free(&frame);
    store_destroy(of.trace);
}

static uint64_t environment(const char *name, uint64_t otherwise)
{
    const char *text = getenv(name);
    return text ? strtoull(text, NULL, 0) : otherwise;
}

START_TEST(test_soups)
{
    static Tally tallies[SOUP_KINDS][PARTS];
    uint64_t only = environment("PEEL_TEST_SEED", 0), first = only ? only : 1;
    uint64_t wanted = environment("PEEL_TEST_COUNT", only ? 1 : 96);
    for (uint64_t i = 0; i < wanted; i++)
        run_case(first + i, tallies);
    printf("%-16s %-9s %10s %10s %10s %9s\n", "kind", "", "values", "unbounded", "over half",
           "greatest");
    for (int kind = 0; kind < SOUP_KINDS; kind++)
        for (int part = 0; part < PARTS; part++) {
            const Tally *tally = &tallies[kind][part];
            printf("%-16s %-9s %10llu %10llu %10llu %9.3f\n", soup_kind_name((SoupKind)kind),
                   part_names[part], (unsigned long long)tally->values,
                   (unsigned long long)tally->unbounded, (unsigned long long)tally->over_half,
                   tally->greatest);
            ck_assert(wanted < 96 || tally->values > 0);
            ck_assert(wanted < 96 || tally->greatest > 0.05);
        }
    fflush(stdout);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("bound_surface");
    TCase *tcase = tcase_create("bound_surface");
    tcase_set_timeout(tcase, 0); /* CTest's */
    tcase_add_test(tcase, test_soups);
    suite_add_tcase(suite, tcase);
    return testing_run_here(suite);
}

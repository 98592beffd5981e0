/* ref/pipeline against OpenGL on random adversarial scenes of every kind, every buffer of the trace
 * bit for bit.
 *
 * PEEL_TEST_SEED=N runs the one case that a failure names; PEEL_TEST_COUNT=N that many, from there
 * or from 1. A case that fails is reduced to a few triangles and written, as random-N.gltf in the
 * working directory, with the command that shows it. */
#include "bits.h"
#include "minimise.h"
#include "soup_kinds.h"
#include "testing.h"

#include "gl/gl_renderer.h"
#include "scene/gltf.h"

#include <stdio.h>
#include <unistd.h>

typedef struct Totals {
    uint64_t scenes, pixels, fragments, values, mismatches;
} Totals;

static void ok(Result result)
{
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

static uint64_t environment(const char *name, uint64_t otherwise)
{
    const char *text = getenv(name);
    return text ? strtoull(text, NULL, 0) : otherwise;
}

/* ---- settings ------------------------------------------------------------------------------- */

static void random_formats(Random *random, RenderDesc *desc)
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
}

static RenderDesc random_desc(Random *random, SoupKind kind)
{
    static const int sizes[][2] = {{1, 1},    {33, 17},  {97, 61},  {130, 70}, {65, 64},
                                   {128, 96}, {255, 31}, {31, 200}, {160, 120}};
    static const int exact[][2] = {{64, 64}, {128, 64}, {32, 128}, {256, 64}, {128, 128}};
    static const int passes[] = {0, 0, 1, 2, 5};
    const int *size =
        soup_kind_is_exact(kind) ? exact[random_bits(random) % 5] : sizes[random_bits(random) % 9];
    RenderDesc desc = {
        .width = size[0], .height = size[1], .passes = passes[random_bits(random) % 5]};
    uint64_t profile = random_bits(random) % 4;
    if (profile == 1)
        render_desc_seed_profile(&desc);
    if (profile >= 2)
        random_formats(random, &desc);
    return desc;
}

/* ---- one comparison ------------------------------------------------------------------------- */

static char difference[512]; /* what the latest comparison found first */

/* Renders with both. Returns the mismatches, which are added to totals with the rest, and sets
 * difference to the first. */
static uint64_t compare(const Scene *scene, const RenderDesc *desc, Totals *totals)
{
    Bits bits;
    bits_compare(scene, desc, &bits);
    totals->scenes++;
    totals->pixels += bits.pixels;
    totals->values += bits.values;
    totals->fragments += bits.layers.fragments;
    totals->mismatches += bits.differing;
    memcpy(difference, bits.difference, sizeof difference);
    return bits.differing;
}

static bool differs(const Scene *scene, const RenderDesc *desc)
{
    Totals totals = {0};
    return compare(scene, desc, &totals) > 0;
}

/* ---- a failure ------------------------------------------------------------------------------ */

/* Whether the file, read again, still shows the failure. */
static bool shows(const char *path, const RenderDesc *desc)
{
    Scene scene;
    ok(gltf_load(path, &scene));
    bool shown = differs(&scene, desc);
    scene_free(&scene);
    return shown;
}

static void report(uint64_t seed, SoupKind kind, const Scene *scene, const RenderDesc *desc)
{
    char path[64], folder[1024] = "", options[512];
    bool fused;
    Minimal minimal;
    printf("random: seed %llu, %s: %s\nrandom: PEEL_TEST_SEED=%llu runs this case; reducing it\n",
           (unsigned long long)seed, soup_kind_name(kind), difference, (unsigned long long)seed);
    fflush(stdout);
    ok(minimise(scene, desc, differs, &minimal));
    ok(gl_driver_fuses(0, &fused));
    snprintf(path, sizeof path, "random-%llu.gltf", (unsigned long long)seed);
    ok(gltf_write(&minimal.scene, path));
    minimal.desc.unfused = !fused;
    minimise_options(&minimal.desc, options, sizeof options);
    bool shown = shows(path, &minimal.desc);
    if (!getcwd(folder, sizeof folder))
        *folder = '\0';
    printf("random: %u triangles, %zu lights left: %s\n"
           "random: build/peel compare %s/%s %s\n",
           minimal.triangles, minimal.scene.light_count,
           shown ? difference : "the file does not show it", folder, path, options);
    fflush(stdout);
    uint32_t triangles = minimal.triangles;
    minimise_free(&minimal);
    ck_abort_msg("PEEL_TEST_SEED=%llu (%s): %s; %s has %u triangles", (unsigned long long)seed,
                 soup_kind_name(kind), difference, path, triangles);
}

/* ---- all scenes ----------------------------------------------------------------------------- */

static void run_case(uint64_t seed, Totals kinds[SOUP_KINDS])
{
    static Soup soup;
    SoupKind kind = (SoupKind)(seed % SOUP_KINDS);
    Random random = random_seed(seed);
    RenderDesc desc = random_desc(&random, kind);
    soup_make_kind(&random, kind, desc.width, desc.height, &soup);
    ok(scene_validate(&soup.scene));
    if (compare(&soup.scene, &desc, &kinds[kind]) > 0)
        report(seed, kind, &soup.scene, &desc);
}

static void print_row(const char *name, const Totals *totals)
{
    printf("%-16s %8llu %14llu %14llu %15llu %11llu\n", name, (unsigned long long)totals->scenes,
           (unsigned long long)totals->pixels, (unsigned long long)totals->fragments,
           (unsigned long long)totals->values, (unsigned long long)totals->mismatches);
}

static void print_totals(const Totals kinds[SOUP_KINDS])
{
    Totals all = {0};
    printf("%-16s %8s %14s %14s %15s %11s\n", "kind", "scenes", "pixels", "fragments", "values",
           "mismatches");
    for (int kind = 0; kind < SOUP_KINDS; kind++) {
        print_row(soup_kind_name((SoupKind)kind), &kinds[kind]);
        all.scenes += kinds[kind].scenes;
        all.pixels += kinds[kind].pixels;
        all.fragments += kinds[kind].fragments;
        all.values += kinds[kind].values;
        all.mismatches += kinds[kind].mismatches;
    }
    print_row("all", &all);
    printf("pixels compared: %llu, values: %llu, mismatches: %llu\n",
           (unsigned long long)all.pixels, (unsigned long long)all.values,
           (unsigned long long)all.mismatches);
    fflush(stdout);
}

static Totals totals[SOUP_KINDS];
static uint64_t first_seed, wanted;

/* Cases of one test: few enough for check's clock. */
enum {
    CHUNK = 500
};

START_TEST(test_scenes)
{
    uint64_t from = (uint64_t)_i * CHUNK;
    for (uint64_t i = from; i < from + CHUNK && i < wanted; i++)
        run_case(first_seed + i, totals);
}
END_TEST

START_TEST(test_totals)
{
    print_totals(totals);
    for (int kind = 0; kind < SOUP_KINDS && wanted >= 240; kind++)
        ck_assert_msg(totals[kind].fragments > 0, "%s: no transparent fragment in %llu scenes",
                      soup_kind_name((SoupKind)kind), (unsigned long long)totals[kind].scenes);
}
END_TEST

int main(void)
{
    uint64_t only = environment("PEEL_TEST_SEED", 0);
    first_seed = only ? only : 1;
    wanted = environment("PEEL_TEST_COUNT", only ? 1 : 240);
    Suite *suite = suite_create("random scenes");
    TCase *tcase = tcase_create("bits");
    tcase_set_timeout(tcase, 0); /* CTest's */
    tcase_add_loop_test(tcase, test_scenes, 0, (int)((wanted + CHUNK - 1) / CHUNK));
    tcase_add_test(tcase, test_totals);
    suite_add_tcase(suite, tcase);
    return testing_run_here(suite);
}

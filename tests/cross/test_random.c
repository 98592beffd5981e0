/* ref/pipeline against OpenGL on random adversarial scenes of every kind, by every method with
 * settings of every kind, every buffer of the trace bit for bit.
 *
 * PEEL_TEST_SEED=N runs the one case that a failure names; PEEL_TEST_COUNT=N that many, from there
 * or from 1. A case that fails is reduced to a few triangles and written, as random-N.gltf in the
 * working directory, with the command that shows it. */
#include "bits.h"
#include "minimise.h"
#include "random_desc.h"
#include "testing.h"

#include "frame/method.h"
#include "gl/gl_renderer.h"

#include <stdio.h>

typedef struct Totals {
    uint64_t scenes, pixels, fragments, values, mismatches;
    uint64_t lost; /* nodes that had no room in a list */
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

/* ---- one comparison ------------------------------------------------------------------------- */

static char difference[512]; /* what the latest comparison found first */

/* Renders with both, and sets difference to the first mismatch. */
static void compare(const Scene *scene, const RenderDesc *desc, Totals *out)
{
    Bits bits;
    bits_compare(scene, desc, &bits);
    *out = (Totals){.scenes = 1,
                    .pixels = bits.pixels,
                    .fragments = bits.layers.fragments,
                    .values = bits.values,
                    .mismatches = bits.differing,
                    .lost = bits.layers.lost_to_overflow};
    memcpy(difference, bits.difference, sizeof difference);
}

static bool differs(const Scene *scene, const RenderDesc *desc)
{
    Totals totals;
    compare(scene, desc, &totals);
    return totals.mismatches > 0;
}

/* ---- a failure ------------------------------------------------------------------------------ */

static void report(uint64_t seed, SoupKind kind, const Scene *scene, const RenderDesc *desc)
{
    char path[64];
    bool fused;
    MinimisedFile file;
    printf("random: seed %llu, %s: %s\nrandom: PEEL_TEST_SEED=%llu runs this case; reducing it\n",
           (unsigned long long)seed, soup_kind_name(kind), difference, (unsigned long long)seed);
    fflush(stdout);
    snprintf(path, sizeof path, "random-%llu.gltf", (unsigned long long)seed);
    ok(gl_driver_fuses(0, &fused));
    RenderDesc modelled = *desc;
    modelled.unfused = !fused;
    ok(minimise_to_file(scene, &modelled, differs, path, &file));
    printf("random: %u triangles, %zu lights left: %s\nrandom: %s\n", file.triangles, file.lights,
           file.shown ? difference : "the file does not show it", file.command);
    fflush(stdout);
    ck_abort_msg("PEEL_TEST_SEED=%llu (%s): %s; %s has %u triangles", (unsigned long long)seed,
                 soup_kind_name(kind), difference, path, file.triangles);
}

/* ---- all scenes ----------------------------------------------------------------------------- */

static Totals kinds[SOUP_KINDS], methods[METHOD_COUNT];
static uint64_t first_seed, wanted;

static void add(Totals *sum, const Totals *totals)
{
    sum->scenes += totals->scenes;
    sum->pixels += totals->pixels;
    sum->fragments += totals->fragments;
    sum->values += totals->values;
    sum->mismatches += totals->mismatches;
    sum->lost += totals->lost;
}

static void run_case(uint64_t seed)
{
    static Soup soup;
    RenderDesc desc;
    Totals totals;
    SoupKind kind = random_case(seed, &desc, &soup);
    ok(scene_validate(&soup.scene));
    compare(&soup.scene, &desc, &totals);
    add(&kinds[kind], &totals);
    add(&methods[desc.method], &totals);
    if (totals.mismatches > 0)
        report(seed, kind, &soup.scene, &desc);
}

static void print_row(const char *name, const Totals *totals)
{
    printf("%-16s %8llu %14llu %14llu %15llu %11llu\n", name, (unsigned long long)totals->scenes,
           (unsigned long long)totals->pixels, (unsigned long long)totals->fragments,
           (unsigned long long)totals->values, (unsigned long long)totals->mismatches);
}

static void print_totals(void)
{
    Totals all = {0};
    printf("%-16s %8s %14s %14s %15s %11s\n", "kind", "scenes", "pixels", "fragments", "values",
           "mismatches");
    for (int kind = 0; kind < SOUP_KINDS; kind++) {
        print_row(soup_kind_name((SoupKind)kind), &kinds[kind]);
        add(&all, &kinds[kind]);
    }
    for (int method = 0; method < METHOD_COUNT; method++)
        print_row(method_info((MethodId)method)->name, &methods[method]);
    print_row("all", &all);
    printf("pixels compared: %llu, values: %llu, mismatches: %llu\n",
           (unsigned long long)all.pixels, (unsigned long long)all.values,
           (unsigned long long)all.mismatches);
    fflush(stdout);
}

enum {
    SCENES = 160, /* enough for every kind and method, and lists without room */
    CHUNK = 500   /* cases of one test: few enough for check's clock */
};

START_TEST(test_scenes)
{
    uint64_t from = (uint64_t)_i * CHUNK;
    for (uint64_t i = from; i < from + CHUNK && i < wanted; i++)
        run_case(first_seed + i);
}
END_TEST

START_TEST(test_totals)
{
    print_totals();
    if (wanted < SCENES)
        return;
    for (int kind = 0; kind < SOUP_KINDS; kind++)
        ck_assert_msg(kinds[kind].fragments > 0, "%s: no transparent fragment in %llu scenes",
                      soup_kind_name((SoupKind)kind), (unsigned long long)kinds[kind].scenes);
    for (int method = 0; method < METHOD_COUNT; method++)
        ck_assert_msg(methods[method].fragments > 0, "%s: no transparent fragment in %llu scenes",
                      method_info((MethodId)method)->name,
                      (unsigned long long)methods[method].scenes);
    ck_assert_uint_gt(methods[METHOD_LINKED_LIST].lost, 0);
}
END_TEST

int main(void)
{
    uint64_t only = environment("PEEL_TEST_SEED", 0);
    first_seed = only ? only : 1;
    wanted = environment("PEEL_TEST_COUNT", only ? 1 : SCENES);
    Suite *suite = suite_create("random scenes");
    TCase *tcase = tcase_create("bits");
    tcase_set_timeout(tcase, 0); /* CTest's */
    tcase_add_loop_test(tcase, test_scenes, 0, (int)((wanted + CHUNK - 1) / CHUNK));
    tcase_add_test(tcase, test_totals);
    suite_add_tcase(suite, tcase);
    return testing_run_here(suite);
}

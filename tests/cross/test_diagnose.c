/* peel diagnose: every mistake of the catalogue, planted into every scene of a list, is found, or
 * makes the same file as another, or as the reference; through 8-bit PNG and float EXR.
 *
 * PEEL_TEST_FULL=1: all built-in scenes and some hard cases, larger. The table is printed. */
#include "planted.h"

#include <stdio.h>

/* What makes more of the mistakes visible. */
typedef enum Variant {
    AS_IT_IS = 0,
    HALF_OPAQUE, /* every other instance is opaque: they hide some of the others */
    DEPTH_24,    /* settings: another program may well have them */
    DEPTH_16,
    DEPTH_REVERSED
} Variant;

typedef struct Column {
    const char *scene;
    Variant variant;
} Column;

static const char *const variant_names[] = {"", ", every other instance opaque", ", --depth d24",
                                            ", --depth d16", ", --depth-range reversed"};
static const Column ci_columns[] = {{"tutorial", AS_IT_IS}, {"inside_glass", AS_IT_IS}};
static const Column full_columns[] = {
    {"teapot_hall", AS_IT_IS},
    {"teapot_hall_stress", AS_IT_IS},
    {"tutorial", AS_IT_IS},
    {"chain", AS_IT_IS},
    {"crossing_planes", AS_IT_IS},
    {"alpha_ladder", AS_IT_IS},
    {"lamps", AS_IT_IS},
    {"at_opaque_depth", AS_IT_IS},
    {"depth_16_aliasing", AS_IT_IS},
    {"inside_glass", AS_IT_IS},
    {"thin_shells", AS_IT_IS},
    {"alpha_threshold", AS_IT_IS},
    {"alpha_zero", AS_IT_IS},
    {"confetti", AS_IT_IS},
    {"zero_normals", AS_IT_IS},
    {"layers_64", AS_IT_IS},
    {"layers_one_ulp", DEPTH_REVERSED},
    {"near_far_wide", DEPTH_REVERSED},
    {"crossing_nearly_coplanar", DEPTH_REVERSED},
    {"far_infinite", DEPTH_REVERSED},
    {"chain", HALF_OPAQUE},
    {"crossing_planes", HALF_OPAQUE},
    {"tutorial", HALF_OPAQUE},
    {"raw_24", DEPTH_24},
    {"tutorial", DEPTH_16},
    {"thin_shells", DEPTH_16},
    {"teapot_hall_stress", DEPTH_16},
    {"at_opaque_depth", DEPTH_24},
    {"at_opaque_depth", DEPTH_16},
    {"at_opaque_depth", DEPTH_REVERSED},
};
enum {
    COLUMNS_FULL = sizeof full_columns / sizeof full_columns[0]
};

static const Column *columns;
static int column_count;
static RenderDesc desc;

static void choose(void)
{
    bool full = testing_full();
    columns = full ? full_columns : ci_columns;
    column_count = full ? COLUMNS_FULL : 2;
    desc = (RenderDesc){.width = full ? 96 : 48, .height = full ? 72 : 36, .lights = 8};
}

static void open_column(const Column *column, Scene *out)
{
    planted_scene(column->scene, out);
    for (size_t i = 0; column->variant == HALF_OPAQUE && i < out->instance_count; i += 2)
        out->materials[out->instances[i].material].alpha_mode = ALPHA_OPAQUE;
    desc.depth = column->variant == DEPTH_24   ? FORMAT_D24
                 : column->variant == DEPTH_16 ? FORMAT_D16
                                               : FORMAT_RGBA32F;
    desc.depth_range = column->variant == DEPTH_REVERSED ? DEPTH_RANGE_REVERSED : DEPTH_RANGE_GL;
}

/* ---- the table ---- */

/* '*' found, '=' equal to another, '.' invisible here, '!' none of these. */
static char outcomes[MUTATION_COUNT][COLUMNS_FULL][PLANTED_FILES];

static char outcome(const Scene *scene, MutationId id, PlantedFile file)
{
    GivenImage given = planted_mistake(scene, &desc, mutation_bit(id), file);
    GivenImage right = planted_mistake(scene, &desc, 0, file);
    size_t bytes =
        (size_t)desc.width * (size_t)desc.height * format_pixel_bytes(given.stored.format);
    bool same = memcmp(given.stored.pixels, right.stored.pixels, bytes) == 0, only;
    Diagnosis diagnosis;
    planted_diagnose(scene, &desc, &given, &diagnosis);
    bool found = planted_first(&diagnosis, mutation_bit(id), &only);
    char cell = '!';
    if (diagnosis.verdict == DIAGNOSE_AGREES && diagnosis.reason == DIAGNOSE_QUANTISED)
        cell = same || (diagnosis.invisible & mutation_bit(id)) ? '.' : '!';
    else if (diagnosis.verdict == DIAGNOSE_MISTAKE && found)
        cell = only ? '*' : '=';
    if (cell == '!') {
        char name[DIAGNOSE_NAME] = "nothing";
        if (diagnosis.count)
            diagnose_name(diagnosis.rows[0].mutations, name);
        printf("%s in %s, %s: %s, reason %d, first %s, %g\n", mutation_info(id)->name, scene->name,
               file == PLANTED_PNG ? "PNG" : "EXR", diagnose_verdict_name(diagnosis.verdict),
               (int)diagnosis.reason, name, diagnosis.count ? diagnosis.rows[0].explains : 0.0);
    }
    diagnose_free(&diagnosis);
    given_free(&given);
    given_free(&right);
    return cell;
}

static void print_table(void)
{
    int counts[128] = {0};
    for (int s = 0; s < column_count; s++)
        printf("%2d %s%s\n", s + 1, columns[s].scene, variant_names[columns[s].variant]);
    printf("%-28s", "PNG, EXR");
    for (int s = 0; s < column_count; s++)
        printf(" %2d", s + 1);
    for (int id = 0; id < MUTATION_COUNT; id++) {
        printf("\n%-28s", mutation_info((MutationId)id)->name);
        for (int s = 0; s < column_count; s++) {
            const char *cell = outcomes[id][s];
            printf(" %c%c", cell[0], cell[1]);
            counts[(int)cell[0]]++;
            counts[(int)cell[1]]++;
        }
    }
    printf("\n%d found (*), %d equal to another (=), %d invisible here (.), %d wrong (!)\n",
           counts['*'], counts['='], counts['.'], counts['!']);
}

static int wrong_of(MutationId id)
{
    int wrong = 0;
    for (int s = 0; s < column_count; s++)
        wrong += (outcomes[id][s][0] == '!') + (outcomes[id][s][1] == '!');
    return wrong;
}

START_TEST(test_planted)
{
    int wrong = 0, seen = 0;
    choose();
    for (int s = 0; s < column_count; s++) {
        Scene scene;
        open_column(&columns[s], &scene);
        for (int id = 0; id < MUTATION_COUNT; id++)
            for (int file = 0; file < PLANTED_FILES; file++)
                outcomes[id][s][file] = outcome(&scene, (MutationId)id, (PlantedFile)file);
        scene_free(&scene);
    }
    print_table();
    for (int id = 0; id < MUTATION_COUNT; id++) {
        wrong += wrong_of((MutationId)id);
        for (int s = 0; s < column_count; s++)
            seen += outcomes[id][s][PLANTED_EXR] == '*';
    }
    ck_assert_int_eq(wrong, 0);
    ck_assert_int_gt(seen, MUTATION_COUNT / 2);
}
END_TEST

/* Two mistakes at once: neither explains all, both do. */
START_TEST(test_pairs)
{
    static const MutationId pairs[][2] = {
        {MUTATION_NOT_PREMULTIPLIED, MUTATION_PEEL_BIAS_1E_3},
        {MUTATION_PREMULTIPLIED_TWICE, MUTATION_PASSES_4},
        {MUTATION_BACKGROUND_WEIGHTED_WRONGLY, MUTATION_BACK_FACES_CULLED},
        {MUTATION_MISSING_1_OVER_PI, MUTATION_DEPTH_NOT_SWAPPED},
        {MUTATION_SRGB_ENCODED_TWICE, MUTATION_LIGHTS_OFF_BY_ONE},
        {MUTATION_OPAQUE_TEST_STRICT, MUTATION_LAYERS_REVERSED}};
    Scene scene;
    bool only;
    choose();
    planted_scene("tutorial", &scene);
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
        for (int file = 0; file < PLANTED_FILES; file++) {
            uint64_t a = mutation_bit(pairs[i][0]), b = mutation_bit(pairs[i][1]);
            GivenImage given = planted_mistake(&scene, &desc, a | b, (PlantedFile)file);
            Diagnosis diagnosis;
            char name[DIAGNOSE_NAME], first[DIAGNOSE_NAME] = "nothing";
            planted_diagnose(&scene, &desc, &given, &diagnosis);
            if (diagnosis.count)
                diagnose_name(diagnosis.rows[0].mutations, first);
            /* One that is invisible beside the other is not asked for. */
            uint64_t wanted = a | b;
            wanted &= ~diagnosis.invisible;
            ck_assert_msg(diagnosis.verdict == DIAGNOSE_MISTAKE &&
                              planted_first(&diagnosis, wanted, &only),
                          "%s: %s, first %s", diagnose_name(a | b, name),
                          diagnose_verdict_name(diagnosis.verdict), first);
            diagnose_free(&diagnosis);
            given_free(&given);
        }
    scene_free(&scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("diagnose");
    TCase *tcase = tcase_create("planted");
    tcase_set_timeout(tcase, 1800);
    tcase_add_test(tcase, test_planted);
    tcase_add_test(tcase, test_pairs);
    suite_add_tcase(suite, tcase);
    return testing_run_here(suite);
}

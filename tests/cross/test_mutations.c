/* Every mistake of frame/mutation.h in ref: each changes some scene's image, all of it is finite,
 * two of them are both made, and some give what a right program gives with other settings.
 *
 * Prints, per scene, which mistakes are invisible there and which look alike. */
#include "testing.h"

#include "frame/mutation.h"
#include "ref/pipeline/pipeline.h"
#include "scene/generate.h"
#include "scene/hard_scenes.h"

#include <math.h>
#include <stdio.h>

/* A scene, built in or of the hard cases, and the depths with which it is hard. */
typedef struct Case {
    const char *scene;
    PixelFormat depth;
    DepthRange range;
} Case;

static const Case cases[] = {
    {.scene = "tutorial"},
    {.scene = "chain"},
    {.scene = "crossing_planes"},
    {.scene = "alpha_ladder"},
    {.scene = "lamps"},
    {.scene = "at_opaque_depth"},
    {.scene = "layers_64"},
    {.scene = "raw_24", .depth = FORMAT_D24},
    {.scene = "alpha_threshold"},
    {.scene = "near_far_wide", .range = DEPTH_RANGE_REVERSED},
    {.scene = "depth_16_aliasing"},
};
enum {
    CASES = sizeof cases / sizeof *cases
};

static void load(const char *name, Scene *out)
{
    const BuiltinScene *built_in = generate_find(name);
    const HardScene *hard = hard_scenes_find(name);
    ck_assert_msg(built_in || hard, "%s", name);
    ck_assert_int_eq(built_in ? built_in->generate(out) : hard->generate(out), RESULT_OK);
    static const float background[3] = {0.2f, 0.3f, 0.6f};
    memcpy(out->background, background, sizeof background);
}

static RenderDesc desc_of(const Case *of)
{
    return (RenderDesc){.width = 64, .height = 48, .depth = of->depth, .depth_range = of->range};
}

static void render(const Scene *scene, RenderDesc desc, uint64_t mutations, Frame *out)
{
    desc.mutations = mutations;
    desc.threads = 1; /* images are too small for more */
    ck_assert_msg(pipeline_render(scene, &desc, NULL, out) == RESULT_OK, "%s", result_message());
    for (int i = 0; i < 4 * desc.width * desc.height; i++)
        ck_assert_msg(isfinite(((const float *)out->final.pixels)[i]), "%dx%d, mutations %#llx",
                      desc.width, desc.height, (unsigned long long)mutations);
}

static bool same_pixels(const Image *a, const Image *b)
{
    return memcmp(a->pixels, b->pixels,
                  (size_t)a->width * (size_t)a->height * format_pixel_bytes(a->format)) == 0;
}

static bool same(const Frame *a, const Frame *b)
{
    return same_pixels(&a->final, &b->final) && same_pixels(&a->display, &b->display);
}

static const char *name_of(int id)
{
    return mutation_info((MutationId)id)->name;
}

/* Prints the mistakes that look like an earlier one. */
static void print_alike(const Frame frames[MUTATION_COUNT], const bool visible[MUTATION_COUNT])
{
    for (int id = 0; id < MUTATION_COUNT; id++)
        for (int other = 0; visible[id] && other < id; other++)
            if (visible[other] && same(&frames[id], &frames[other])) {
                printf("  %s looks like %s\n", name_of(id), name_of(other));
                break;
            }
}

/* All mistakes on one scene; counts where each is visible. */
static void check_scene(const Case *of, int scenes[MUTATION_COUNT])
{
    static Frame frames[MUTATION_COUNT];
    bool visible[MUTATION_COUNT];
    Scene scene;
    Frame right, again;
    load(of->scene, &scene);
    render(&scene, desc_of(of), 0, &right);
    printf("%s, invisible:", of->scene);
    for (int id = 0; id < MUTATION_COUNT; id++) {
        render(&scene, desc_of(of), mutation_bit((MutationId)id), &frames[id]);
        visible[id] = !same(&frames[id], &right);
        scenes[id] += visible[id];
        if (!visible[id])
            printf(" %s", name_of(id));
    }
    printf("\n");
    print_alike(frames, visible);
    /* None leaves anything behind, and none is in the definition. */
    RenderDesc desc = desc_of(of);
    desc.ref_path = REF_PATH_DEFINITION;
    render(&scene, desc, 0, &again);
    ck_assert(same(&again, &right));
    for (int id = 0; id < MUTATION_COUNT; id++)
        frame_free(&frames[id]);
    frame_free(&right);
    frame_free(&again);
    scene_free(&scene);
}

START_TEST(test_visible)
{
    int scenes[MUTATION_COUNT] = {0};
    setvbuf(stdout, NULL, _IOLBF, 0); /* a failure ends the process */
    for (int i = 0; i < CASES; i++)
        check_scene(&cases[i], scenes);
    for (int id = 0; id < MUTATION_COUNT; id++) {
        printf("%-28s visible on %d of %d scenes\n", name_of(id), scenes[id], (int)CASES);
        ck_assert_msg(scenes[id] > 0, "%s is visible nowhere", name_of(id));
    }
}
END_TEST

/* ---- what a mistake is the same as ---- */

static void check_same_as(const char *name, MutationId id, RenderDesc other)
{
    Scene scene;
    Frame mutated, expected, right;
    load(name, &scene);
    RenderDesc desc = {.width = 64, .height = 48};
    other.width = desc.width;
    other.height = desc.height;
    render(&scene, desc, 0, &right);
    render(&scene, desc, mutation_bit(id), &mutated);
    render(&scene, other, 0, &expected);
    ck_assert_msg(same(&mutated, &expected), "%s: %s", name, name_of((int)id));
    ck_assert_msg(!same(&mutated, &right), "%s: %s is invisible", name, name_of((int)id));
    frame_free(&mutated);
    frame_free(&expected);
    frame_free(&right);
    scene_free(&scene);
}

static int peels_of(const char *name)
{
    Scene scene;
    Frame frame;
    load(name, &scene);
    render(&scene, (RenderDesc){.width = 64, .height = 48}, 0, &frame);
    int peels = frame.peels;
    frame_free(&frame);
    scene_free(&scene);
    return peels;
}

static int lights_of(const char *name)
{
    Scene scene;
    load(name, &scene);
    int lights = (int)scene.light_count;
    scene_free(&scene);
    return lights;
}

START_TEST(test_same_as_settings)
{
    static const char *const names[] = {"tutorial", "chain", "crossing_planes"};
    for (int i = 0; i < 3; i++) {
        const char *name = names[i];
        ck_assert_int_gt(peels_of(name), 2);
        check_same_as(name, MUTATION_PASSES_SHORT, (RenderDesc){.passes = peels_of(name) - 1});
        check_same_as(name, MUTATION_ONE_DEPTH_BUFFER, (RenderDesc){.passes = 1});
        check_same_as(name, MUTATION_PEEL_DEPTH_NOT_CLEARED, (RenderDesc){.passes = 2});
        check_same_as(name, MUTATION_LIGHTS_OFF_BY_ONE,
                      (RenderDesc){.lights = lights_of(name) > 1 ? lights_of(name) - 1 : -1});
        check_same_as(name, MUTATION_ACCUMULATION_8_BIT, (RenderDesc){.accum = FORMAT_RGBA8});
        check_same_as(name, MUTATION_OBJECTS_SORTED, (RenderDesc){.method = METHOD_PAINTER});
    }
    check_same_as("layers_64", MUTATION_PASSES_8, (RenderDesc){.passes = 8});
}
END_TEST

/* Roughness squared once more, and nothing double-sided: as other materials would have it. */
START_TEST(test_same_as_materials)
{
    static const MutationId ids[] = {MUTATION_ROUGHNESS_SQUARED_TWICE, MUTATION_BACK_FACES_CULLED};
    const RenderDesc desc = {.width = 64, .height = 48};
    for (int i = 0; i < 2; i++) {
        Scene scene;
        Frame mutated, expected, right;
        load("tutorial", &scene);
        render(&scene, desc, 0, &right);
        render(&scene, desc, mutation_bit(ids[i]), &mutated);
        for (size_t k = 0; k < scene.material_count; k++) {
            Material *material = &scene.materials[k];
            if (ids[i] == MUTATION_BACK_FACES_CULLED)
                material->double_sided = false;
            else
                material->roughness *= material->roughness;
        }
        render(&scene, desc, 0, &expected);
        ck_assert_msg(same(&mutated, &expected), "%s", name_of((int)ids[i]));
        ck_assert(!same(&mutated, &right));
        frame_free(&mutated);
        frame_free(&expected);
        frame_free(&right);
        scene_free(&scene);
    }
}
END_TEST

static double error_sum(const Frame *frame, const Frame *right)
{
    double sum = 0.0;
    for (int i = 0; i < 4 * frame->final.width * frame->final.height; i++)
        sum += fabs((double)((const float *)frame->final.pixels)[i] -
                    (double)((const float *)right->final.pixels)[i]);
    return sum;
}

/* Rounding to the nearest half is right on average, truncation too dark; both round something. */
START_TEST(test_halves)
{
    Scene scene;
    Frame right, rounded, truncated;
    const RenderDesc desc = {.width = 64, .height = 48};
    load("tutorial", &scene);
    render(&scene, desc, 0, &right);
    render(&scene, desc, mutation_bit(MUTATION_ACCUMULATION_HALF_ROUNDED), &rounded);
    render(&scene, desc, mutation_bit(MUTATION_ACCUMULATION_HALF), &truncated);
    double nearest = error_sum(&rounded, &right), down = error_sum(&truncated, &right);
    ck_assert_msg(nearest > 0.0 && nearest < 0.6 * down, "%g, truncated %g", nearest, down);
    frame_free(&right);
    frame_free(&rounded);
    frame_free(&truncated);
    scene_free(&scene);
}
END_TEST

/* With a limit of passes the stale depth of the frame before is that of its last layer: the layers
 * behind it are what is left, and as many as the limit allows. */
START_TEST(test_stale)
{
    Scene scene;
    Frame stale, none;
    load("layers_64", &scene);
    RenderDesc desc = {.width = 64, .height = 48, .passes = 3};
    render(&scene, desc, mutation_bit(MUTATION_PREVIOUS_DEPTH_STALE), &stale);
    ck_assert_int_eq(stale.peels, 3);
    frame_free(&stale);
    desc.passes = 60; /* leaves 4 of the 64 */
    render(&scene, desc, mutation_bit(MUTATION_PREVIOUS_DEPTH_STALE), &stale);
    ck_assert_int_eq(stale.peels, 4);
    frame_free(&stale);
    desc.passes = 0;
    render(&scene, desc, mutation_bit(MUTATION_PREVIOUS_DEPTH_STALE), &none);
    ck_assert_int_eq(none.peels, 0);
    frame_free(&none);
    scene_free(&scene);
}
END_TEST

/* ---- two at once ---- */

START_TEST(test_pairs)
{
    Case of = {.scene = "chain"};
    static Frame single[MUTATION_COUNT];
    bool visible[MUTATION_COUNT];
    int both = 0, excluded = 0;
    Scene scene;
    Frame right, pair;
    RenderDesc desc = desc_of(&of);
    desc.width = 32;
    desc.height = 24;
    load(of.scene, &scene);
    render(&scene, desc, 0, &right);
    for (int a = 0; a < MUTATION_COUNT; a++) {
        render(&scene, desc, mutation_bit((MutationId)a), &single[a]);
        visible[a] = !same(&single[a], &right);
    }
    for (int a = 0; a < MUTATION_COUNT; a++)
        for (int b = a + 1; b < MUTATION_COUNT; b++) {
            render(&scene, desc, mutation_bit((MutationId)a) | mutation_bit((MutationId)b), &pair);
            bool excludes = mutation_excludes((MutationId)a, (MutationId)b);
            ck_assert_msg(!excludes || same(&pair, &single[b]), "%s, %s", name_of(a), name_of(b));
            excluded += excludes;
            both +=
                visible[a] && visible[b] && !same(&pair, &single[a]) && !same(&pair, &single[b]);
            frame_free(&pair);
        }
    printf("pairs: %d differ from both, %d exclude each other\n", both, excluded);
    ck_assert_int_gt(both, 400);
    for (int a = 0; a < MUTATION_COUNT; a++)
        frame_free(&single[a]);
    frame_free(&right);
    scene_free(&scene);
}
END_TEST

/* Pairs of which each has a part of its own. */
START_TEST(test_pair_parts)
{
    Scene scene;
    Frame pair, expected;
    load("chain", &scene);
    RenderDesc desc = {.width = 64, .height = 48};
    uint64_t bits = mutation_bit(MUTATION_BACKGROUND_FORGOTTEN);
    render(&scene, desc, bits | mutation_bit(MUTATION_PASSES_SHORT), &pair);
    desc.passes = peels_of("chain") - 1;
    render(&scene, desc, bits, &expected);
    ck_assert(same(&pair, &expected));
    frame_free(&pair);
    frame_free(&expected);
    scene_free(&scene);
}
END_TEST

/* ---- edges ---- */

static void check_all(const Scene *scene, RenderDesc desc)
{
    for (int id = 0; id < MUTATION_COUNT; id++) {
        Frame frame;
        render(scene, desc, mutation_bit((MutationId)id), &frame);
        frame_free(&frame);
    }
}

static void make_opaque(Scene *scene)
{
    for (size_t i = 0; i < scene->material_count; i++)
        scene->materials[i].alpha_mode = ALPHA_OPAQUE;
}

START_TEST(test_edges)
{
    Scene scene;
    load("tutorial", &scene);
    check_all(&scene, (RenderDesc){.width = 1, .height = 1});
    check_all(&scene, (RenderDesc){.width = 33, .height = 17, .lights = -1});
    check_all(&scene, (RenderDesc){.width = 33, .height = 17, .passes = 1, .tile = 8});
    check_all(&scene, (RenderDesc){.width = 33, .height = 17, .method = METHOD_FORWARD});
    check_all(&scene, (RenderDesc){.width = 33, .height = 17, .shading = SHADING_PHONG});
    check_all(&scene, (RenderDesc){.width = 33, .height = 17, .depth_range = DEPTH_RANGE_REVERSED});
    RenderDesc seed = {.width = 33, .height = 17};
    render_desc_seed_profile(&seed);
    check_all(&scene, seed);
    seed.gbuffer = GBUFFER_COMPACT;
    check_all(&scene, seed);
    make_opaque(&scene);
    check_all(&scene, (RenderDesc){.width = 33, .height = 17});
    scene_free(&scene);
    static const char *const hard[] = {"brightest", "half_overflow", "zero_normals", "confetti",
                                       "behind_the_eye"};
    for (int i = 0; i < 5; i++) {
        load(hard[i], &scene);
        check_all(&scene, (RenderDesc){.width = 24, .height = 18});
        scene_free(&scene);
    }
}
END_TEST

START_TEST(test_forward)
{
    Scene scene;
    Frame forward, deferred;
    load("chain", &scene);
    for (int id = 0; id < MUTATION_COUNT; id++) {
        RenderDesc desc = {.width = 32, .height = 24};
        render(&scene, desc, mutation_bit((MutationId)id), &deferred);
        desc.method = METHOD_FORWARD;
        render(&scene, desc, mutation_bit((MutationId)id), &forward);
        ck_assert_msg(same(&forward, &deferred), "%s", name_of(id));
        frame_free(&forward);
        frame_free(&deferred);
    }
    scene_free(&scene);
}
END_TEST

START_TEST(test_refused)
{
    Scene scene;
    Frame frame;
    load("chain", &scene);
    RenderDesc desc = {.width = 8,
                       .height = 8,
                       .method = METHOD_DUAL,
                       .mutations = mutation_bit(MUTATION_PASSES_SHORT)};
    ck_assert_int_eq(pipeline_render(&scene, &desc, NULL, &frame), RESULT_BAD_INPUT);
    desc.method = METHOD_PEEL;
    desc.mutations = UINT64_C(1) << MUTATION_COUNT;
    ck_assert_int_eq(pipeline_render(&scene, &desc, NULL, &frame), RESULT_BAD_INPUT);
    scene_free(&scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("mutations");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 600);
    tcase_add_test(all, test_visible);
    tcase_add_test(all, test_same_as_settings);
    tcase_add_test(all, test_same_as_materials);
    tcase_add_test(all, test_halves);
    tcase_add_test(all, test_stale);
    tcase_add_test(all, test_pairs);
    tcase_add_test(all, test_pair_parts);
    tcase_add_test(all, test_edges);
    tcase_add_test(all, test_forward);
    tcase_add_test(all, test_refused);
    suite_add_tcase(suite, all);
    return testing_run(suite);
}

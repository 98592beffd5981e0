/* Every method of the table held to what all promise. ref and OpenGL agree bit for bit: on the
 * built-in scenes, over a background, with textures and masks, in every accumulation format, and
 * after materials have changed. Of the exact ones, the order of drawing changes nothing where no
 * fragment is lost to a tie. Where two methods do the same arithmetic they give the same image. The
 * passes over the transparent list are as many as the method's paper says.
 *
 * A new row of the table is tested without a change here; where it takes more than one pass,
 * expected_passes must know. */
#include "layers.h"
#include "methods.h"

#include "compare/metrics.h"
#include "frame/method.h"
#include "gl/gl_renderer.h"
#include "ref/truth/truth.h"
#include "scene/generate.h"

enum {
    WIDTH = 96,
    HEIGHT = 54,
    LIGHTS = 2,
    SCENES_MAX = 16
};

static const Renderer renderers[] = {pipeline_render, gl_render};

static RenderDesc method_desc(int method)
{
    return (RenderDesc){
        .width = WIDTH, .height = HEIGHT, .lights = LIGHTS, .method = (MethodId)method};
}

static const char *name_of(const RenderDesc *desc)
{
    return method_info(desc->method)->name;
}

static void same_bits(const Scene *scene, const RenderDesc *desc, Bits *out)
{
    bits_compare(scene, desc, out);
    ck_assert_msg(out->differing == 0, "%s, %s: %s", scene->name, name_of(desc), out->difference);
}

static bool same_image(const Frame *a, const Frame *b)
{
    return memcmp(a->final.pixels, b->final.pixels,
                  (size_t)a->final.width * (size_t)a->final.height * 16) == 0;
}

/* Over the transparent list, where the deepest pixel has `layers` layers and none is tied. */
static int expected_passes(MethodId method, int layers)
{
    switch (method) {
    case METHOD_PEEL:
    case METHOD_FORWARD:
        return layers + 1; /* the last yields nothing */
    case METHOD_PEEL_ID:
        return 3 * layers + 1;
    case METHOD_DUAL:
    case METHOD_FORWARD_DUAL:
        return (layers + 1) / 2 + 1;
    default:
        return 1;
    }
}

/* The same bits, and as many passes as `layers` layers take. desc->unfused becomes the driver's. */
static void check(const Scene *scene, RenderDesc *desc, int layers)
{
    Bits bits;
    same_bits(scene, desc, &bits);
    desc->unfused = !bits.fused;
    int expected = expected_passes(desc->method, layers), ref = bits.geometry_passes[0];
    /* Lists may have been drawn again by gl, with more room (bits.c). */
    int again = desc->method == METHOD_LINKED_LIST && bits.geometry_passes[1] > ref;
    ck_assert_msg(ref == expected && bits.geometry_passes[1] == expected + again,
                  "%s, %s: %d passes of ref and %d of gl for %d layers, expected %d", scene->name,
                  name_of(desc), ref, bits.geometry_passes[1], layers, expected);
    ck_assert_uint_eq(bits.layers.max, (uint32_t)layers);
}

static int truth_layers(const Scene *scene)
{
    Frame truth;
    RenderDesc desc = method_desc(METHOD_PEEL);
    methods_ok(truth_render(scene, &desc, NULL, &truth));
    int layers = (int)truth.layers.max;
    frame_free(&truth);
    return layers;
}

/* Built-in scene `index`, over a background that is not black. */
static Scene generate(int index)
{
    size_t count;
    Scene scene;
    methods_ok(generate_table(&count)[index].generate(&scene));
    scene.background[0] = 0.25f;
    scene.background[2] = 1.5f;
    return scene;
}

static int scene_count(void)
{
    size_t count;
    generate_table(&count);
    return (int)count;
}

/* ---- ref against gl ------------------------------------------------------------------------- */

static int scene_layers[SCENES_MAX]; /* of truth; none of these scenes has a tie */

static void count_layers(void)
{
    ck_assert_int_le(scene_count(), SCENES_MAX);
    for (int i = 0; i < scene_count(); i++) {
        Scene scene = generate(i);
        scene_layers[i] = truth_layers(&scene);
        scene_free(&scene);
    }
}

START_TEST(test_scenes)
{
    for (int i = 0; i < scene_count(); i++) {
        Scene scene = generate(i);
        RenderDesc desc = method_desc(_i);
        ck_assert_int_gt(scene_layers[i], 1);
        check(&scene, &desc, scene_layers[i]);
        scene_free(&scene);
    }
}
END_TEST

/* Lists hold colours in 8 bits. */
static void check_exact(const Scene *scene, const RenderDesc *desc, const Frame *frame)
{
    Frame truth;
    FinalMetrics error;
    methods_ok(truth_render(scene, desc, NULL, &truth));
    metrics_final(&frame->final, &truth.final, &error);
    double bound = desc->method == METHOD_LINKED_LIST ? 1.0 / 255.0 : 2e-6;
    ck_assert_msg(error.max_abs <= bound, "%s: %g from truth", name_of(desc), error.max_abs);
    frame_free(&truth);
}

START_TEST(test_layers)
{
    static Layers layers;
    static const int counts[] = {0, 1, 2, 3, 7, LAYERS_MAX};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        RenderDesc desc = method_desc(_i);
        Frame frame;
        layers_ladder(counts[i], &layers);
        ck_assert_int_eq(truth_layers(&layers.scene), counts[i]);
        check(&layers.scene, &desc, counts[i]);
        methods_ok(pipeline_render(&layers.scene, &desc, NULL, &frame));
        ck_assert_uint_eq(frame.layers.fragments, (uint64_t)counts[i] * WIDTH * HEIGHT);
        ck_assert_uint_eq(frame.fragments_shaded, (uint64_t)(counts[i] + 1) * WIDTH * HEIGHT);
        if (method_info(desc.method)->exact)
            check_exact(&layers.scene, &desc, &frame);
        frame_free(&frame);
    }
}
END_TEST

/* A soup with every kind of material, some cut out by the alpha of a texture and some blended with
 * one. */
static void make_textured(Soup *soup)
{
    Random random = random_seed(4);
    soup_make_kind(&random, SOUP_PERSPECTIVE, WIDTH, HEIGHT, soup);
    soup_texture(&random, soup);
    for (uint32_t i = 0; i < SOUP_INSTANCES; i++)
        soup->instances[i].material = i % 8;
    for (int m = 0; m < SOUP_MESHES; m++)
        soup->meshes[m].uv = soup->uv[m];
    soup->materials[1].base_color_texture = 1;
    soup->materials[1].alpha_cutoff = 0.5f;
    soup->materials[2].base_color_texture = 2;
    soup->scene.background[1] = 0.75f;
    methods_ok(scene_validate(&soup->scene));
}

/* That both textures show: without the cut-out, and without the colours, the image differs. */
static void check_textures_show(Soup *soup, const RenderDesc *desc)
{
    Material kept[8];
    Frame frames[3];
    memcpy(kept, soup->materials, sizeof kept);
    for (int i = 0; i < 3; i++) {
        if (i == 1)
            soup->materials[1].alpha_mode = ALPHA_OPAQUE;
        if (i == 2)
            soup->materials[2].base_color_texture = 0;
        methods_ok(pipeline_render(&soup->scene, desc, NULL, &frames[i]));
        memcpy(soup->materials, kept, sizeof kept);
    }
    ck_assert(!same_image(&frames[0], &frames[1]) && !same_image(&frames[0], &frames[2]));
    for (int i = 0; i < 3; i++)
        frame_free(&frames[i]);
}

START_TEST(test_formats)
{
    static Soup soup;
    static const PixelFormat formats[] = {FORMAT_RGBA32F, FORMAT_RGBA16F, FORMAT_RGBA16,
                                          FORMAT_RGBA8};
    RenderDesc desc = method_desc(_i);
    make_textured(&soup);
    check_textures_show(&soup, &desc);
    for (int f = 0; f < 4; f++)
        for (desc.passes = 0; desc.passes <= 2; desc.passes += 2) {
            Bits bits;
            desc.accum = formats[f];
            same_bits(&soup.scene, &desc, &bits);
            ck_assert_uint_gt(bits.layers.max, 2);
            ck_assert_int_le(bits.peels, desc.passes ? desc.passes : (int)bits.layers.max);
        }
}
END_TEST

/* ---- materials that change at run time ------------------------------------------------------ */

static const double moving_depths[] = {2, 6, 5, 8, 4, 3};

enum {
    MOVING = sizeof moving_depths / sizeof *moving_depths,
    STATES = 5 /* the last is the first again */
};

/* What a program may do between two frames. */
static void set_state(int state, const Material *first, Layers *layers)
{
    Material *materials = layers->materials;
    memcpy(materials, first, sizeof layers->materials);
    switch (state) {
    case 1: /* one square to either list */
        materials[1].alpha_mode = ALPHA_OPAQUE;
        materials[1].base_color[3] = 1.0f;
        materials[5].alpha_mode = ALPHA_BLEND;
        materials[5].base_color[3] = 0.6f;
        break;
    case 2:
        scene_override_opacity(&layers->scene, 0.5f);
        break;
    case 3:
        scene_override_opacity(&layers->scene, 1.0f);
        break;
    default:
        break;
    }
}

/* All squares fill the window; the last is the farthest. */
static int expected_layers(const Layers *layers)
{
    double depths[MOVING + 1], nearest_opaque = INFINITY;
    int count = 0;
    memcpy(depths, moving_depths, sizeof moving_depths);
    depths[MOVING] = 40.0;
    for (int i = 0; i <= MOVING; i++)
        if (layers->materials[i].alpha_mode == ALPHA_OPAQUE)
            nearest_opaque = fmin(nearest_opaque, depths[i]);
    for (int i = 0; i <= MOVING; i++)
        count += layers->materials[i].alpha_mode == ALPHA_BLEND && depths[i] < nearest_opaque;
    return count;
}

START_TEST(test_materials_change)
{
    static Layers layers;
    Material first[LAYERS_MAX + 1];
    Frame frames[STATES][2];
    RenderDesc desc = method_desc(_i);
    layers_make(MOVING, moving_depths, &layers);
    layers.materials[5].alpha_mode = ALPHA_OPAQUE;
    memcpy(first, layers.materials, sizeof first);
    for (int state = 0; state < STATES; state++) {
        set_state(state, first, &layers);
        check(&layers.scene, &desc, expected_layers(&layers));
        for (int r = 0; r < 2; r++)
            methods_ok(renderers[r](&layers.scene, &desc, NULL, &frames[state][r]));
        ck_assert(same_image(&frames[state][0], &frames[state][1]));
        if (method_info(desc.method)->exact)
            check_exact(&layers.scene, &desc, &frames[state][0]);
    }
    for (int r = 0; r < 2; r++) {
        for (int state = 1; state < STATES - 1; state++)
            ck_assert(!same_image(&frames[state - 1][r], &frames[state][r]));
        ck_assert(same_image(&frames[0][r], &frames[STATES - 1][r]));
    }
    for (int i = 0; i < 2 * STATES; i++)
        frame_free(&frames[i / 2][i % 2]);
}
END_TEST

/* ---- the order of drawing ------------------------------------------------------------------- */

static uint64_t order_changes(Renderer renderer, const Scene *scene, const RenderDesc *desc,
                              DrawOrder order)
{
    RenderDesc turned = *desc;
    turned.draw_order = order;
    turned.draw_seed = 7;
    return bits_between(renderer, scene, desc, &turned);
}

/* Another order changes no bit in any buffer, or ref reports ties, which *ties counts. */
static uint64_t check_order(Renderer renderer, const Scene *scene, const RenderDesc *desc,
                            uint64_t *ties)
{
    Frame frame;
    methods_ok(pipeline_render(scene, desc, NULL, &frame));
    *ties = frame.layers.lost_to_ties;
    frame_free(&frame);
    uint64_t reversed = order_changes(renderer, scene, desc, DRAW_ORDER_REVERSE);
    uint64_t shuffled = order_changes(renderer, scene, desc, DRAW_ORDER_SHUFFLE);
    ck_assert_msg(reversed + shuffled == 0 || *ties > 0,
                  "%s, %s of %s: %llu values differ reversed and %llu shuffled, without a tie",
                  scene->name, renderer == gl_render ? "gl" : "ref", name_of(desc),
                  (unsigned long long)reversed, (unsigned long long)shuffled);
    return reversed + shuffled;
}

/* gl takes its time, and its bits are ref's: of the scenes of few triangles it draws every other,
 * or with PEEL_TEST_FULL all. */
static bool draws(Renderer renderer, const Scene *scene, int turn)
{
    return renderer == pipeline_render ||
           ((testing_full() || turn % 2 == 0) && scene_triangle_count(scene) < 20000);
}

/* Of any kind, in a window that suits all. */
static void make_soup(uint64_t seed, RenderDesc *desc, Soup *soup)
{
    Random random = random_seed(seed);
    desc->width = desc->height = 64;
    desc->depth_func = (DepthFunc)(seed & 1);
    soup_make_kind(&random, (SoupKind)(seed % SOUP_KINDS), 64, 64, soup);
    methods_ok(scene_validate(&soup->scene));
}

/* The painter sorts by an order of its own. */
static bool has_order(int method)
{
    return method_info((MethodId)method)->exact || method == METHOD_PAINTER;
}

static bool keeps_ties(int method)
{
    return has_order(method) && !method_info((MethodId)method)->loses_ties;
}

START_TEST(test_draw_order)
{
    for (int i = 0; i < scene_count() && has_order(_i); i++) {
        Scene scene = generate(i);
        RenderDesc desc = method_desc(_i);
        uint64_t ties;
        for (int r = 0; r < 2; r++)
            if (draws(renderers[r], &scene, i + _i)) {
                check_order(renderers[r], &scene, &desc, &ties);
                ck_assert_uint_eq(ties, 0);
            }
        scene_free(&scene);
    }
}
END_TEST

/* Two of three squares coincide. Of several colours MAX keeps the same whatever their order. */
START_TEST(test_draw_order_ties)
{
    static Layers layers;
    const double depths[] = {3, 3, 5};
    RenderDesc desc = method_desc(_i);
    layers_make(3, depths, &layers);
    for (int i = 0; i < 4 && has_order(_i); i++) {
        uint64_t ties;
        desc.depth_func = (DepthFunc)(i / 2);
        uint64_t changes = check_order(renderers[i % 2], &layers.scene, &desc, &ties);
        ck_assert_uint_eq(ties, keeps_ties(_i) ? 0 : WIDTH * HEIGHT);
        ck_assert_int_eq(changes > 0, !keeps_ties(_i) && desc.method != METHOD_FORWARD_DUAL);
    }
}
END_TEST

/* Soups are full of ties. */
START_TEST(test_draw_order_soups)
{
    static Soup soup;
    RenderDesc desc = method_desc(_i);
    for (uint64_t seed = 1; seed <= SOUP_KINDS && keeps_ties(_i); seed++) {
        uint64_t ties;
        make_soup(seed, &desc, &soup);
        for (int r = 0; r < (seed % 3 ? 1 : 2); r++) {
            check_order(renderers[r], &soup.scene, &desc, &ties);
            ck_assert_uint_eq(ties, 0);
        }
    }
}
END_TEST

/* ---- methods of the same arithmetic --------------------------------------------------------- */

/* The same final image, with ties or only without. */
static const struct {
    MethodId a, b;
    GBufferFormat gbuffer;
    bool ties;
} equal[] = {
    {METHOD_FORWARD, METHOD_PEEL, GBUFFER_FULL, true},
    {METHOD_PEEL_ID, METHOD_PEEL, GBUFFER_FULL, false},
    {METHOD_LINKED_LIST, METHOD_PEEL, GBUFFER_COMPACT, false},
    {METHOD_LINKED_LIST, METHOD_PEEL_ID, GBUFFER_COMPACT, true},
};

static void check_equal(Renderer renderer, const Scene *scene, const RenderDesc *like, size_t row)
{
    Frame a, b;
    RenderDesc desc = *like;
    desc.gbuffer = equal[row].gbuffer;
    desc.method = equal[row].b;
    methods_ok(renderer(scene, &desc, NULL, &b));
    desc.method = equal[row].a;
    methods_ok(renderer(scene, &desc, NULL, &a));
    ck_assert_msg(same_image(&a, &b), "%s: %s does not give the image of %s, --gbuffer %s",
                  scene->name, name_of(&desc), method_info(equal[row].b)->name,
                  gbuffer_name(desc.gbuffer));
    frame_free(&a);
    frame_free(&b);
}

/* Returns the ties that `peel` loses; only ref counts them. */
static uint64_t check_all_equal(Renderer renderer, const Scene *scene, const RenderDesc *desc)
{
    Frame peel;
    methods_ok(pipeline_render(scene, desc, NULL, &peel));
    uint64_t ties = peel.layers.lost_to_ties;
    if (ties == 0) /* the other path than the one that was compared with gl */
        ck_assert_int_eq(peel.geometry_passes, expected_passes(METHOD_PEEL, (int)peel.layers.max));
    frame_free(&peel);
    for (size_t row = 0; row < sizeof equal / sizeof *equal; row++)
        if (ties == 0 || equal[row].ties)
            check_equal(renderer, scene, desc, row);
    return ties;
}

START_TEST(test_equal)
{
    for (int i = 0; i < scene_count(); i++) {
        Scene scene = generate(i);
        RenderDesc desc = method_desc(METHOD_PEEL);
        if (draws(renderers[_i], &scene, i))
            ck_assert_uint_eq(check_all_equal(renderers[_i], &scene, &desc), 0);
        scene_free(&scene);
    }
}
END_TEST

START_TEST(test_equal_soups)
{
    static Soup soup;
    uint64_t tied = 0, untied = 0;
    for (uint64_t seed = 1; seed <= 6 * SOUP_KINDS; seed++) {
        RenderDesc desc = {0};
        make_soup(seed, &desc, &soup);
        uint64_t ties = check_all_equal(pipeline_render, &soup.scene, &desc);
        tied += ties > 0;
        untied += ties == 0;
    }
    ck_assert_uint_gt(tied, 10);
    ck_assert_uint_gt(untied, 10);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("methods");
    TCase *bits = tcase_create("bits"), *tcase = tcase_create("promises");
    tcase_set_timeout(bits, 300);
    tcase_set_timeout(tcase, 300);
    tcase_add_unchecked_fixture(bits, count_layers, NULL);
    tcase_add_loop_test(bits, test_scenes, 0, METHOD_COUNT);
    tcase_add_loop_test(bits, test_layers, 0, METHOD_COUNT);
    tcase_add_loop_test(bits, test_formats, 0, METHOD_COUNT);
    tcase_add_loop_test(bits, test_materials_change, 0, METHOD_COUNT);
    suite_add_tcase(suite, bits);
    tcase_add_loop_test(tcase, test_draw_order, 0, METHOD_COUNT);
    tcase_add_loop_test(tcase, test_draw_order_ties, 0, METHOD_COUNT);
    tcase_add_loop_test(tcase, test_draw_order_soups, 0, METHOD_COUNT);
    tcase_add_loop_test(tcase, test_equal, 0, 2);
    tcase_add_test(tcase, test_equal_soups);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

/* Method linked-list: ref/pipeline against OpenGL on random soups, and what the method promises. */
#include "layers.h"
#include "methods.h"

#include "frame/node.h"
#include "gl/gl_renderer.h"

#include <string.h>

enum {
    SOUPS = 2 /* per setting */
};

static bool same_image(const Frame *a, const Frame *b)
{
    return memcmp(a->final.pixels, b->final.pixels,
                  (size_t)a->final.width * (size_t)a->final.height * 16) == 0;
}

/* ---- ref against gl ---------------------------------------------------------------------------
 */

static const RenderDesc variants[] = {
    {.passes = 0},
    {.depth_func = DEPTH_LEQUAL},
    {.post = POST_EDGES},
    {.depth = FORMAT_D24},
    {.depth = FORMAT_D24, .depth_func = DEPTH_LEQUAL, .gbuffer = GBUFFER_SEED, .post = POST_EDGES},
    {.depth = FORMAT_D16, .accum = FORMAT_RGBA16F},
    {.depth_range = DEPTH_RANGE_ZERO_ONE, .passes = 2},
    {.depth_range = DEPTH_RANGE_REVERSED, .depth_func = DEPTH_LEQUAL},
    {.depth_range = DEPTH_RANGE_REVERSED, .depth = FORMAT_D24, .post = POST_EDGES},
    {.depth_range = DEPTH_RANGE_REVERSED, .depth = FORMAT_D24, .peel_test = PEEL_TEST_RAW},
    {.depth_range = DEPTH_RANGE_REVERSED,
     .depth = FORMAT_D16,
     .depth_func = DEPTH_LEQUAL,
     .peel_test = PEEL_TEST_RAW},
    {.depth = FORMAT_D24, .peel_test = PEEL_TEST_RAW, .cull = CULL_NONE, .accum = FORMAT_RGBA8},
    {.accum = FORMAT_RGBA16, .normals = NORMALS_KEPT, .back_light = true, .post = POST_EDGES},
    {.opaque_blend = OPAQUE_BLEND_SEED, .ggx = GGX_STABLE, .passes = 3, .cull = CULL_SEED},
    {.draw_order = DRAW_ORDER_SHUFFLE, .draw_seed = 7, .nodes_per_pixel = 40},
};

START_TEST(test_bits)
{
    static Soup soup;
    uint64_t fragments = 0;
    for (uint64_t i = 0; i < SOUPS; i++) {
        RenderDesc desc = variants[_i];
        uint64_t seed = 1 + (uint64_t)_i * SOUPS + i;
        Bits bits;
        methods_make_soup(seed, METHOD_LINKED_LIST, &desc, &soup);
        bits_compare(&soup.scene, &desc, &bits);
        ck_assert_msg(bits.differing == 0, "seed %llu: %s", (unsigned long long)seed,
                      bits.difference);
        fragments += bits.layers.fragments;
    }
    ck_assert_uint_gt(fragments, 0);
}
END_TEST

/* No pixel, no transparent instance, nothing at all. */
START_TEST(test_little)
{
    static Soup soup;
    RenderDesc desc = {0};
    Bits bits;
    methods_make_soup(13, METHOD_LINKED_LIST, &desc, &soup);
    desc.width = desc.height = 1;
    bits_compare(&soup.scene, &desc, &bits);
    ck_assert_msg(bits.differing == 0, "%s", bits.difference);
    methods_make_soup(13, METHOD_LINKED_LIST, &desc, &soup);
    for (int i = 0; i < 8; i++)
        soup.materials[i].alpha_mode = ALPHA_OPAQUE;
    bits_compare(&soup.scene, &desc, &bits);
    ck_assert_msg(bits.differing == 0, "%s", bits.difference);
    ck_assert_int_eq(bits.peels, 0);
    soup.scene.instance_count = 0;
    bits_compare(&soup.scene, &desc, &bits);
    ck_assert_msg(bits.differing == 0, "%s", bits.difference);
}
END_TEST

/* ---- promises ---------------------------------------------------------------------------------
 */

/* What peel finds, its ties included, in one pass. */
START_TEST(test_counts)
{
    static Soup soup;
    uint64_t tied = 0;
    for (uint64_t seed = 1; seed <= 6 * SOUP_KINDS; seed++) {
        RenderDesc desc = {.depth_func = (DepthFunc)(seed & 1)};
        Frame list, peel;
        methods_make_soup(seed, METHOD_LINKED_LIST, &desc, &soup);
        methods_ok(pipeline_render(&soup.scene, &desc, NULL, &list));
        desc.method = METHOD_PEEL;
        methods_ok(pipeline_render(&soup.scene, &desc, NULL, &peel));
        ck_assert_uint_eq(list.layers.fragments, peel.layers.fragments);
        ck_assert_uint_eq(list.layers.lost_to_ties, 0);
        ck_assert_uint_eq((uint64_t)list.peels, list.layers.max);
        ck_assert_int_eq(list.geometry_passes, 1);
        ck_assert_uint_le(list.layers.fragments, list.nodes);
        ck_assert_uint_eq(list.node_bytes, soup.scene.texture_count > 0 ? 24 : 16);
        tied += peel.layers.lost_to_ties;
        frame_free(&list);
        frame_free(&peel);
    }
    ck_assert_uint_gt(tied, 0);
}
END_TEST

/* Two overlapping squares of the same layer count, and what has no room. */
static void make_squares(Soup *soup, uint32_t count, RenderDesc *desc)
{
    Random random = random_seed(5);
    soup_make(&random, soup);
    soup->camera.yfov = 1.0;
    for (uint32_t i = 0; i < count; i++)
        soup_square(soup, i, 2.0 + i, -1, 1);
    methods_ok(scene_validate(&soup->scene));
    *desc = (RenderDesc){.width = 192, .height = 20, .method = METHOD_LINKED_LIST};
}

START_TEST(test_overflow)
{
    static Soup soup;
    RenderDesc desc;
    Frame full, short_of;
    Renderer renderer = _i ? gl_render : pipeline_render;
    make_squares(&soup, 6, &desc);
    methods_ok(renderer(&soup.scene, &desc, NULL, &full));
    ck_assert_uint_eq(full.nodes, 6 * 192 * 20);
    ck_assert_uint_eq(full.layers.fragments, full.nodes);
    ck_assert_uint_eq(full.layers.lost_to_overflow, 0);
    ck_assert_int_eq(full.geometry_passes, _i ? 2 : 1); /* gl guessed less */
    desc.nodes_per_pixel = 1;
    methods_ok(renderer(&soup.scene, &desc, NULL, &short_of));
    ck_assert_uint_eq(short_of.nodes, full.nodes);
    ck_assert_uint_eq(short_of.layers.lost_to_overflow, 5 * 192 * 20);
    ck_assert_uint_eq(short_of.layers.lost_to_ties, 0);
    ck_assert_uint_eq(short_of.layers.lost_to_pass_limit, 0);
    ck_assert_int_eq(short_of.geometry_passes, 1);
    ck_assert_uint_lt(short_of.buffer_bytes, full.buffer_bytes);
    ck_assert(!same_image(&full, &short_of));
    desc.nodes_per_pixel = 6; /* just enough */
    frame_free(&short_of);
    methods_ok(renderer(&soup.scene, &desc, NULL, &short_of));
    ck_assert_uint_eq(short_of.layers.lost_to_overflow, 0);
    ck_assert(same_image(&full, &short_of));
    frame_free(&full);
    frame_free(&short_of);
}
END_TEST

/* Which nodes ref loses depends neither on its tiles nor on threads. */
START_TEST(test_overflow_by_tiles)
{
    static Soup soup;
    RenderDesc desc;
    Frame first, frame;
    make_squares(&soup, 6, &desc);
    desc.nodes_per_pixel = 2;
    methods_ok(pipeline_render(&soup.scene, &desc, NULL, &first));
    ck_assert_uint_gt(first.layers.lost_to_overflow, 0);
    for (desc.tile = TILE_MIN; desc.tile <= TILE_MAX; desc.tile *= 2) {
        desc.threads = 1 + desc.tile / 64 % 3;
        methods_ok(pipeline_render(&soup.scene, &desc, NULL, &frame));
        ck_assert(same_image(&first, &frame));
        frame_free(&frame);
    }
    frame_free(&first);
}
END_TEST

/* A list that the limit on memory does not allow is refused. */
START_TEST(test_memory_limit)
{
    static Soup soup;
    RenderDesc desc;
    Frame frame;
    Renderer renderer = _i ? gl_render : pipeline_render;
    make_squares(&soup, 6, &desc);
    methods_ok(renderer(&soup.scene, &desc, NULL, &frame));
    desc.max_memory = (size_t)frame.buffer_bytes - 6 * 192 * 20 * 8;
    frame_free(&frame);
    ck_assert_int_eq(renderer(&soup.scene, &desc, NULL, &frame), RESULT_NO_MEMORY);
    frame_free(&frame);
}
END_TEST

START_TEST(test_pass_limit)
{
    static Soup soup;
    RenderDesc desc;
    Frame frame;
    Renderer renderer = _i ? gl_render : pipeline_render;
    make_squares(&soup, 6, &desc);
    desc.passes = 2;
    methods_ok(renderer(&soup.scene, &desc, NULL, &frame));
    ck_assert_int_eq(frame.peels, 2);
    ck_assert_uint_eq(frame.layers.max, 6);
    ck_assert_uint_eq(frame.layers.lost_to_pass_limit, 4 * 192 * 20);
    frame_free(&frame);
}
END_TEST

/* A transparent square on an opaque background: its outline is black at its own alpha. */
START_TEST(test_edges)
{
    static Soup soup;
    RenderDesc desc;
    Frame plain, edges;
    make_squares(&soup, 1, &desc);
    soup_square(&soup, 0, 2.0, -0.5, 0.5);
    soup.materials[2].base_color[3] = 0.5f;
    methods_ok(pipeline_render(&soup.scene, &desc, NULL, &plain));
    desc.post = POST_EDGES;
    methods_ok(pipeline_render(&soup.scene, &desc, NULL, &edges));
    int outline = 0;
    for (int y = 0; y < 20; y++)
        for (int x = 0; x < 192; x++) {
            const float *a = image_pixel(&plain.final, x, y), *b = image_pixel(&edges.final, x, y);
            bool edge = x == 48 || x == 143; /* the window's first and last rows are none */
            ck_assert_float_eq(a[3], b[3]);
            for (int c = 0; c < 3; c++)
                ck_assert_float_eq(b[c], edge ? soup.scene.background[c] * (1.0f - b[3]) : a[c]);
            outline += edge && a[0] > b[0];
        }
    ck_assert_int_eq(outline, 2 * 20);
    desc.method = METHOD_PEEL; /* the option means nothing elsewhere */
    desc.ref_path = REF_PATH_DEFINITION;
    frame_free(&edges);
    methods_ok(pipeline_render(&soup.scene, &desc, NULL, &edges));
    desc.post = POST_NONE;
    frame_free(&plain);
    methods_ok(pipeline_render(&soup.scene, &desc, NULL, &plain));
    ck_assert(same_image(&plain, &edges));
    frame_free(&plain);
    frame_free(&edges);
}
END_TEST

/* Every primitive finds the draw that it belongs to. */
START_TEST(test_materials)
{
    const NodeMaterial entries[] = {{.first_primitive = 3},
                                    {.first_primitive = 4},
                                    {.first_primitive = 9},
                                    {.first_primitive = 20},
                                    {.first_primitive = 4000000000u}};
    for (uint32_t count = 1; count <= 5; count++)
        for (uint32_t i = 0; i < count; i++) {
            uint32_t last = i + 1 < count ? entries[i + 1].first_primitive - 1 : UINT32_MAX - 1;
            ck_assert_ptr_eq(node_material(entries, count, entries[i].first_primitive),
                             &entries[i]);
            ck_assert_ptr_eq(node_material(entries, count, last), &entries[i]);
        }
}
END_TEST

/* More layers than the lists are sorted for at once, drawn front to back, back to front and in no
 * order: a shader's loops end somewhere. */
START_TEST(test_long_lists)
{
    enum {
        MANY = 520
    };
    static Layers layers;
    static Instance instances[MANY];
    RenderDesc desc = {.width = 2, .height = 1, .method = METHOD_LINKED_LIST};
    Bits bits;
    layers_ladder(LAYERS_MAX, &layers);
    for (int i = 0; i < MANY; i++) {
        int place = _i == 0 ? i : _i == 1 ? MANY - 1 - i : i * 77 % MANY;
        instances[i] = layers.instances[i % LAYERS_MAX];
        instances[i].world = matrix_translate(0, 0, -2.0 - 0.01 * place);
    }
    layers.scene.instances = instances;
    layers.scene.instance_count = MANY;
    for (int i = 0; i < LAYERS_MAX; i++)
        layers.materials[i].base_color[3] = 0.01f;
    bits_compare(&layers.scene, &desc, &bits);
    ck_assert_msg(bits.differing == 0, "%s", bits.difference);
    ck_assert_uint_eq(bits.layers.max, MANY);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("linked-list");
    TCase *bits = tcase_create("bits"), *tcase = tcase_create("promises");
    tcase_set_timeout(bits, 120);
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(bits, test_bits, 0, sizeof variants / sizeof *variants);
    tcase_add_test(bits, test_little);
    suite_add_tcase(suite, bits);
    tcase_add_test(tcase, test_counts);
    tcase_add_loop_test(tcase, test_overflow, 0, 2);
    tcase_add_test(tcase, test_overflow_by_tiles);
    tcase_add_loop_test(tcase, test_memory_limit, 0, 2);
    tcase_add_loop_test(tcase, test_pass_limit, 0, 2);
    tcase_add_test(tcase, test_edges);
    tcase_add_test(tcase, test_materials);
    tcase_add_loop_test(tcase, test_long_lists, 0, 3);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

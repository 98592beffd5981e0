/* What a scene does not need is left out (frame/needs.h) and changes no bit: final image, display
 * form and counts of every renderer, with and without RenderDesc.model_all, over scenes that lack
 * something. And it is left out: the frames need less memory. */
#include "testing.h"

#include "random_desc.h"

#include "gl/gl_renderer.h"
#include "ref/pipeline/pipeline.h"
#include "ref/truth/truth.h"

/* What is taken from a soup. */
typedef enum Kind {
    KIND_AS_IT_IS,
    KIND_NO_LIGHTS,
    KIND_BLACK_LIGHTS,
    KIND_ONE_BLACK_LIGHT,
    KIND_NO_TEXTURES,
    KIND_UNLIT_NO_TEXTURES,
    KIND_ONE_MATERIAL, /* of each list: base colours differ, and no textures */
    KIND_UNLIT_ONE_MATERIAL,
    KIND_PHONG,
    KIND_MASKS, /* no other opaque material */
    KIND_ONLY_OPAQUE,
    KIND_ONLY_TRANSPARENT,
    KIND_NOTHING,
    KIND_ALL_CULLED, /* every material single-sided */
    KINDS
} Kind;

static Soup soup;

static void set_mode(AlphaMode from, AlphaMode to)
{
    for (int i = 0; i < 8; i++)
        if (soup.materials[i].alpha_mode == from)
            soup.materials[i].alpha_mode = to;
}

static void drop_textures(void)
{
    soup.scene.texture_count = 0;
    for (int i = 0; i < 8; i++)
        soup.materials[i].base_color_texture = soup.materials[i].metallic_roughness_texture = 0;
}

static void use_one_surface(void)
{
    drop_textures();
    for (int i = 0; i < 8; i++) {
        bool transparent = soup.materials[i].alpha_mode == ALPHA_BLEND;
        soup.materials[i].roughness = transparent ? 0.3f : 0.71f;
        soup.materials[i].metallic = transparent ? 0.2f : 0.9f;
        soup.materials[i].occlusion = transparent ? 0.83f : 0.37f;
    }
}

static void blacken_lights(int count)
{
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            soup.lights[i].color[c] = i == 1 ? -0.0f : 0.0f;
    soup.scene.light_count = SOUP_LIGHTS;
}

static void take_away(Kind kind)
{
    switch (kind) {
    case KIND_AS_IT_IS:
    case KIND_PHONG:
    case KINDS:
        break;
    case KIND_NO_LIGHTS:
        soup.scene.light_count = 0;
        break;
    case KIND_BLACK_LIGHTS:
        blacken_lights(SOUP_LIGHTS);
        break;
    case KIND_ONE_BLACK_LIGHT:
        blacken_lights(1);
        break;
    case KIND_UNLIT_NO_TEXTURES:
        soup.scene.light_count = 0;
        drop_textures();
        break;
    case KIND_NO_TEXTURES:
        drop_textures();
        break;
    case KIND_UNLIT_ONE_MATERIAL:
        soup.scene.light_count = 0;
        use_one_surface();
        break;
    case KIND_ONE_MATERIAL:
        use_one_surface();
        break;
    case KIND_MASKS:
        set_mode(ALPHA_OPAQUE, ALPHA_MASK);
        break;
    case KIND_ONLY_OPAQUE:
        set_mode(ALPHA_BLEND, ALPHA_OPAQUE);
        break;
    case KIND_ONLY_TRANSPARENT:
        set_mode(ALPHA_OPAQUE, ALPHA_BLEND);
        set_mode(ALPHA_MASK, ALPHA_BLEND);
        break;
    case KIND_NOTHING:
        soup.scene.instance_count = 0;
        break;
    case KIND_ALL_CULLED:
        for (int i = 0; i < 8; i++)
            soup.materials[i].double_sided = false;
        break;
    }
}

static RenderDesc make(uint64_t seed, Kind kind)
{
    Random random = random_seed(seed);
    soup_make(&random, &soup);
    take_away(kind);
    ck_assert_msg(scene_validate(&soup.scene) == RESULT_OK, "%s", result_message());
    RenderDesc desc = random_desc_settings(&random);
    desc.width = 61;
    desc.height = 43;
    desc.threads = 2;
    if (kind == KIND_PHONG)
        desc.shading = SHADING_PHONG;
    return desc;
}

/* ---- the same bits ---- */

typedef struct Case {
    uint64_t seed;
    Kind kind;
    const RenderDesc *desc;
    const char *renderer;
} Case;

#define FAIL(run, what)                                                                            \
    ck_abort_msg("seed %llu, kind %d, %s, method %d: %s differ when all is modelled",              \
                 (unsigned long long)(run)->seed, (run)->kind, (run)->renderer,                    \
                 (run)->desc->method, what)

static void check_images(const Case *run, const Image *a, const Image *b)
{
    ck_assert_int_eq(a->width, b->width);
    ck_assert_int_eq(a->height, b->height);
    if (memcmp(a->pixels, b->pixels,
               (size_t)a->width * (size_t)a->height * format_pixel_bytes(a->format)) != 0)
        FAIL(run, "pixels");
}

static void check_same(const Case *run, const Frame *a, const Frame *b)
{
    const LayerStats *p = &a->layers, *q = &b->layers;
    check_images(run, &a->final, &b->final);
    check_images(run, &a->display, &b->display);
    if (a->peels != b->peels || a->geometry_passes != b->geometry_passes)
        FAIL(run, "passes");
    if (a->fragments_shaded != b->fragments_shaded || a->nodes != b->nodes)
        FAIL(run, "fragments");
    if (p->max != q->max || p->fragments != q->fragments || p->lost_to_ties != q->lost_to_ties ||
        p->lost_to_pass_limit != q->lost_to_pass_limit || p->repeated != q->repeated ||
        p->lost_to_overflow != q->lost_to_overflow || p->overflowed != q->overflowed)
        FAIL(run, "layers");
    if (a->residual_max != b->residual_max || a->residual_pixels != b->residual_pixels)
        FAIL(run, "residuals");
    ck_assert_uint_le(a->buffer_bytes, b->buffer_bytes);
}

/* Adds to *saved the bytes that were not needed. */
static void compare(const Case *run, Renderer renderer, uint64_t *saved)
{
    Frame frames[2];
    for (int i = 0; i < 2; i++) {
        RenderDesc desc = *run->desc;
        desc.model_all = i == 1;
        ck_assert_msg(renderer(&soup.scene, &desc, NULL, &frames[i]) == RESULT_OK, "%s",
                      result_message());
    }
    check_same(run, &frames[0], &frames[1]);
    *saved += frames[1].buffer_bytes - frames[0].buffer_bytes;
    frame_free(&frames[0]);
    frame_free(&frames[1]);
}

static bool lacks(Kind kind)
{
    return kind != KIND_AS_IT_IS && kind != KIND_ONE_BLACK_LIGHT && kind != KIND_NO_TEXTURES &&
           kind != KIND_MASKS && kind != KIND_ALL_CULLED;
}

/* One of each method; PEEL_TEST_COUNT=N for more. */
static uint64_t seeds(void)
{
    const char *text = getenv("PEEL_TEST_COUNT");
    return text ? strtoull(text, NULL, 0) : METHOD_COUNT;
}

START_TEST(test_same_bits)
{
    Kind kind = (Kind)_i;
    uint64_t saved_ref = 0, saved_gl = 0, saved_truth = 0;
    for (uint64_t seed = 1; seed <= seeds(); seed++) {
        RenderDesc desc = make(seed, kind);
        desc.method = (MethodId)(seed % METHOD_COUNT);
        if (desc.method == METHOD_LINKED_LIST) /* what overflows is lost by chance */
            desc.nodes_per_pixel = 0;
        Case run = {seed, kind, &desc, "gl"};
        if (testing_full() || (seed + seed / METHOD_COUNT + (uint64_t)kind) % 2 == 0)
            compare(&run, gl_render, &saved_gl);
        desc.ref_path = REF_PATH_DEFINITION;
        run.renderer = "ref, definition";
        compare(&run, pipeline_render, &saved_ref);
        desc.ref_path = REF_PATH_AUTO;
        run.renderer = "ref";
        if (desc.method == METHOD_PEEL) /* the others have one path */
            compare(&run, pipeline_render, &saved_ref);
        run.renderer = "truth";
        compare(&run, truth_render, &saved_truth);
    }
    if (lacks(kind)) {
        ck_assert_uint_gt(saved_ref, 0);
        ck_assert_uint_gt(saved_gl, 0);
    }
}
END_TEST

/* ---- what is left out ---- */

typedef struct Bytes {
    uint64_t gl, ref;
} Bytes;

static Bytes bytes_of(RenderDesc desc)
{
    Frame frame;
    Bytes bytes;
    ck_assert_int_eq(gl_render(&soup.scene, &desc, NULL, &frame), RESULT_OK);
    bytes.gl = frame.buffer_bytes;
    frame_free(&frame);
    desc.ref_path = REF_PATH_DEFINITION;
    ck_assert_int_eq(pipeline_render(&soup.scene, &desc, NULL, &frame), RESULT_OK);
    bytes.ref = frame.buffer_bytes;
    frame_free(&frame);
    return bytes;
}

/* Normal, position and material, 16 bytes each, of the opaque G-buffer and of the peels'. */
static const struct {
    Kind kind;
    uint64_t pixel_bytes;
} rows[] = {
    {KIND_ONE_MATERIAL, 2 * 16},        {KIND_UNLIT_NO_TEXTURES, 2 * 32},
    {KIND_UNLIT_ONE_MATERIAL, 2 * 48},  {KIND_PHONG, 2 * 32},
    {KIND_ONLY_OPAQUE, 4 * 16 + 2 * 4}, {KIND_ONLY_TRANSPARENT, 4 * 16},
    {KIND_NOTHING, 8 * 16 + 2 * 4},
};

START_TEST(test_left_out)
{
    RenderDesc desc = make(3, rows[_i].kind);
    desc = (RenderDesc){.width = 61, .height = 43, .shading = desc.shading};
    drop_textures();
    soup.instances[0].material = 0; /* opaque, if the kind has such */
    soup.instances[1].material = 2; /* transparent */
    if (rows[_i].kind == KIND_PHONG)
        desc.shading = SHADING_PHONG;
    bool lit = rows[_i].kind == KIND_ONLY_OPAQUE || rows[_i].kind == KIND_ONLY_TRANSPARENT;
    if (lit)
        soup.scene.light_count = SOUP_LIGHTS;
    Bytes needed = bytes_of(desc);
    desc.model_all = true;
    Bytes all = bytes_of(desc);
    /* gl's two depths of a peel; ref has a primitive id besides. Normals of vertices come on top
     * where there are no lights, lights in Phong. */
    uint64_t least = rows[_i].pixel_bytes * 61 * 43;
    ck_assert_uint_ge(all.gl - needed.gl, least);
    ck_assert_uint_ge(all.ref - needed.ref, least);
    ck_assert_uint_lt(all.gl - needed.gl, least + 20000);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("needs");
    TCase *tcase = tcase_create("needs");
    tcase_set_timeout(tcase, 600);
    tcase_add_loop_test(tcase, test_same_bits, 0, KINDS);
    tcase_add_loop_test(tcase, test_left_out, 0, (int)(sizeof rows / sizeof *rows));
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

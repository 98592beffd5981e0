/* The two paths of ref/pipeline, and those methods that have one: the same bits and the same
 * counts, whatever the scene, the settings and the number of threads; and what the definition path
 * traces. */
#include "testing.h"

#include "random_desc.h"

#include "base/memory.h"
#include "frame/frame.h"
#include "number/op.h"
#include "ref/pipeline/pipeline.h"

#include <stdio.h>

/* PEEL_TEST_SEED=N runs the one case that a failure names; PEEL_TEST_COUNT=N more of them. */
static uint64_t environment(const char *name, uint64_t otherwise)
{
    const char *text = getenv(name);
    return text ? strtoull(text, NULL, 0) : otherwise;
}

static uint64_t running; /* the case's seed, for messages */

/* Mostly peel: other methods have one path, and its threads alone to show. */
static RenderDesc paths_desc(Random *random)
{
    static const int sizes[][2] = {{1, 1}, {33, 17}, {130, 70}, {65, 64}};
    RenderDesc desc = random_desc_settings(random);
    if (random_bits(random) % 4)
        desc.method = METHOD_PEEL;
    const int *size = sizes[random_bits(random) % 8 ? 1 + random_bits(random) % 3 : 0];
    desc.width = size[0];
    desc.height = size[1];
    desc.unfused = random_bits(random) % 4 == 0;
    desc.threads = 1 + (int)(random_bits(random) % 8);
    desc.time = random_unit(random);
    desc.tile = TILE_MIN << random_bits(random) % 6;
    desc.simd = (SimdChoice)(random_bits(random) % SIMD_COUNT);
    return desc;
}

static void render(const Scene *scene, RenderDesc desc, RefPath path, TraceSink *trace, Frame *out)
{
    desc.ref_path = path;
    ck_assert_msg(pipeline_render(scene, &desc, trace, out) == RESULT_OK, "%s", result_message());
}

/* The tile path with desc.simd, or the widest there is where the processor lacks that. */
static void render_tile(const Scene *scene, RenderDesc desc, Frame *out)
{
    desc.ref_path = REF_PATH_TILE;
    Result result = pipeline_render(scene, &desc, NULL, out);
    if (result == RESULT_UNSUPPORTED) {
        desc.simd = SIMD_AUTO;
        result = pipeline_render(scene, &desc, NULL, out);
    }
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

static void check_images(const Image *got, const Image *expected, const char *name)
{
    size_t bytes = format_pixel_bytes(got->format);
    ck_assert_int_eq(got->width, expected->width);
    ck_assert_int_eq(got->height, expected->height);
    for (int y = 0; y < got->height; y++)
        for (int x = 0; x < got->width; x++)
            if (memcmp(image_pixel(got, x, y), image_pixel(expected, x, y), bytes) != 0)
                ck_abort_msg("PEEL_TEST_SEED=%llu: %s: pixel (%d, %d) differs",
                             (unsigned long long)running, name, x, y);
}

#define CHECK_EQUAL(member)                                                                        \
    ck_assert_msg(got->member == expected->member,                                                 \
                  "PEEL_TEST_SEED=%llu: " #member ": tile %.17g, definition %.17g",                \
                  (unsigned long long)running, (double)got->member, (double)expected->member)

static void check_frames(const Frame *got, const Frame *expected)
{
    check_images(&got->final, &expected->final, "final");
    check_images(&got->display, &expected->display, "display");
    CHECK_EQUAL(peels);
    CHECK_EQUAL(layers.max);
    CHECK_EQUAL(layers.fragments);
    CHECK_EQUAL(layers.lost_to_ties);
    CHECK_EQUAL(layers.lost_to_pass_limit);
    CHECK_EQUAL(layers.repeated);
    CHECK_EQUAL(layers.lost_to_overflow);
    CHECK_EQUAL(layers.overflowed);
    CHECK_EQUAL(geometry_passes);
    CHECK_EQUAL(fragments_shaded);
    CHECK_EQUAL(nodes);
    CHECK_EQUAL(residual_max);
    CHECK_EQUAL(residual_pixels);
}

static void check_case(uint64_t seed, uint64_t totals[4])
{
    static Soup soup;
    Random random = random_seed(running = seed);
    soup_make(&random, &soup);
    if (scene_validate(&soup.scene) != RESULT_OK)
        ck_abort_msg("%s", result_message());
    RenderDesc desc = paths_desc(&random);
    Frame definition, tile;
    render(&soup.scene, desc, REF_PATH_DEFINITION, NULL, &definition);
    desc.threads = 1 + (int)(random_bits(&random) % 8);
    render_tile(&soup.scene, desc, &tile);
    check_frames(&tile, &definition);
    totals[0] += tile.layers.fragments;
    totals[1] += tile.layers.lost_to_ties;
    totals[2] += tile.layers.lost_to_pass_limit;
    totals[3] += tile.layers.repeated;
    frame_free(&definition);
    frame_free(&tile);
}

START_TEST(test_soups)
{
    uint64_t totals[4] = {0}, only = environment("PEEL_TEST_SEED", 0);
    uint64_t count = environment("PEEL_TEST_COUNT", 400);
    if (only) {
        check_case(only, totals);
        return;
    }
    for (uint64_t seed = 1; seed <= count; seed++)
        check_case(seed, totals);
    for (int i = 0; i < 4; i++)
        ck_assert_msg(totals[i] > 0, "the soups never showed count %d", i);
}
END_TEST

/* ---- layers closer than the raw test can tell -------------------------------------------------
 */

/* With 24-bit depth and the raw test a layer one code behind another is discarded with it. A tile
 * that such a layer ends must count it as the frame does, however deep other tiles are. */
START_TEST(test_raw_test_loses_close_layers)
{
    static Soup soup;
    uint64_t lost = 0;
    for (int step = 1; step < 12; step++) {
        Random random = random_seed(1);
        soup_make(&random, &soup);
        soup.camera.yfov = 1.0;
        soup.camera.near = 1.0;
        soup.camera.far = 100.0;
        soup_square(&soup, 0, 5.0, -1, 0);
        soup_square(&soup, 1, 5.0 + step * 0x1p-20, -1, 0);
        for (uint32_t i = 2; i < 5; i++)
            soup_square(&soup, i, 5.0 + i, 0, 1);
        RenderDesc desc = {.width = 192,
                           .height = 20,
                           .depth = FORMAT_D24,
                           .peel_test = PEEL_TEST_RAW,
                           .threads = 1};
        for (desc.passes = 0; desc.passes < 4; desc.passes++) {
            Frame definition, tile;
            render(&soup.scene, desc, REF_PATH_DEFINITION, NULL, &definition);
            render(&soup.scene, desc, REF_PATH_TILE, NULL, &tile);
            check_frames(&tile, &definition);
            if (desc.passes == 0) {
                ck_assert_int_eq(tile.peels, 3);
                ck_assert_uint_eq(tile.layers.lost_to_pass_limit, 0);
                lost += tile.layers.lost_to_ties;
            }
            frame_free(&definition);
            frame_free(&tile);
        }
    }
    ck_assert_uint_gt(lost, 0);
}
END_TEST

/* With the raw test a fragment in front of the far plane may be stored at the far end, where the
 * depth test does not let it pass, unless it is LEQUAL. */
START_TEST(test_raw_test_stores_the_far_end)
{
    static Soup soup;
    Random random = random_seed(1);
    soup_make(&random, &soup);
    soup.camera.yfov = 1.0;
    soup.camera.near = 1.0;
    soup.camera.far = 100.0;
    for (uint32_t i = 0; i < 5; i++)
        soup_square(&soup, i, 99.99, -1, 0);
    for (int func = DEPTH_LESS; func <= DEPTH_LEQUAL; func++) {
        RenderDesc desc = {.width = 40,
                           .height = 20,
                           .depth = FORMAT_D16,
                           .depth_func = (DepthFunc)func,
                           .peel_test = PEEL_TEST_RAW};
        Frame definition, tile;
        render(&soup.scene, desc, REF_PATH_DEFINITION, NULL, &definition);
        render(&soup.scene, desc, REF_PATH_TILE, NULL, &tile);
        ck_assert_uint_gt(definition.layers.fragments, 0);
        ck_assert_int_eq(definition.peels > 0, func == DEPTH_LEQUAL);
        check_frames(&tile, &definition);
        frame_free(&definition);
        frame_free(&tile);
    }
}
END_TEST

/* ---- the trace ---------------------------------------------------------------------------------
 */

enum {
    RECORDS_MAX = 1024
};

typedef struct Record {
    char name[48];
    int step;
    Image image;
} Record;

typedef struct Recorder {
    TraceSink sink;
    int count, fail_at;
    Record records[RECORDS_MAX];
} Recorder;

static Result record(TraceSink *sink, const TraceBuffer *buffer)
{
    Recorder *recorder = (Recorder *)sink;
    if (recorder->count == recorder->fail_at)
        return result_fail(RESULT_IO, "the sink is full");
    Record *entry = &recorder->records[recorder->count++];
    snprintf(entry->name, sizeof entry->name, "%s", buffer->name);
    entry->step = buffer->step;
    ck_assert(buffer->x == 0 && buffer->y == 0 && buffer->width == buffer->image_width &&
              buffer->height == buffer->image_height);
    ck_assert_uint_eq(buffer->row_bytes,
                      (size_t)buffer->width * format_pixel_bytes(buffer->format));
    ck_assert(image_create(buffer->width, buffer->height, buffer->format, &entry->image) ==
              RESULT_OK);
    memcpy(entry->image.pixels, buffer->pixels, buffer->row_bytes * (size_t)buffer->height);
    return RESULT_OK;
}

static Recorder *recorder_make(int fail_at)
{
    Recorder *recorder = memory_array(1, sizeof *recorder);
    recorder->sink.put = record;
    recorder->fail_at = fail_at;
    return recorder;
}

static void recorder_free(Recorder *recorder)
{
    for (int i = 0; i < recorder->count; i++)
        image_free(&recorder->records[i].image);
    free(recorder);
}

/* The next record, which must have this name, step and format. */
static const Image *expect(const Recorder *recorder, int *at, const char *name, int step,
                           PixelFormat format)
{
    ck_assert_int_lt(*at, recorder->count);
    const Record *entry = &recorder->records[(*at)++];
    ck_assert_str_eq(entry->name, name);
    ck_assert_int_eq(entry->step, step);
    ck_assert_int_eq(entry->image.format, format);
    return &entry->image;
}

typedef struct Traced {
    const Image *depth, *primitive, *accum;
} Traced;

static Traced expect_gbuffer(const Recorder *recorder, int *at, const char *prefix, int step,
                             const RenderDesc *desc)
{
    GBufferLayout layout = render_desc_layout(desc);
    const struct {
        const char *what;
        PixelFormat format;
    } rows[] = {
        {"depth", render_desc_depth(desc)}, {"normal", layout.normal},
        {"position", layout.position},      {"diffuse", layout.diffuse},
        {"material", layout.material},      {"primitive", FORMAT_R32UI},
    };
    const Image *images[6] = {NULL};
    for (int i = 0; i < 6; i++) {
        char name[48];
        snprintf(name, sizeof name, "%s.%s", prefix, rows[i].what);
        if (rows[i].format != FORMAT_NONE)
            images[i] = expect(recorder, at, name, step, rows[i].format);
    }
    return (Traced){.depth = images[0], .primitive = images[5]};
}

static uint32_t word_at(const Image *image, size_t pixel)
{
    return ((const uint32_t *)image->pixels)[pixel];
}

/* Final is made of the last accumulation: rgb over the background, 1 − T. */
static __attribute__((noinline)) void check_final(const Image *accum, const Traced *opaque,
                                                  const RenderDesc *desc, const Scene *scene,
                                                  const Image *final)
{
    for (size_t i = 0; i < (size_t)desc->width * (size_t)desc->height; i++) {
        float a[4], weight;
        const float *got = (const float *) final->pixels + 4 * i;
        format_fetch(accum->format,
                     (const char *)accum->pixels + i * format_pixel_bytes(accum->format), a);
        weight = a[3];
        if (desc->opaque_blend == OPAQUE_BLEND_SEED && word_at(opaque->primitive, i) != UINT32_MAX)
            weight = 0.0f;
        for (int c = 0; c < 3; c++)
            ck_assert_float_bits(got[c], op_add(a[c], op_mul(scene->background[c], weight)));
        ck_assert_float_bits(got[3], op_sub(1.0f, weight));
    }
}

/* Peels lie strictly behind each other and in front of the opaque surface; a pixel with no
 * fragment is clear. Returns the peel's fragments. */
static uint64_t check_layer(const Traced *layer, const Traced *before, const Traced *opaque,
                            const RenderDesc *desc)
{
    uint64_t drawn = 0;
    PixelFormat depth_format = render_desc_depth(desc);
    uint32_t far = depth_format == FORMAT_D24   ? 0xffffffu
                   : depth_format == FORMAT_D16 ? 0xffffu
                                                : 0x3f800000u;
    bool reversed = desc->depth_range == DEPTH_RANGE_REVERSED;
    if (reversed)
        far = 0;
    for (size_t i = 0; i < (size_t)desc->width * (size_t)desc->height; i++) {
        uint32_t depth = word_at(layer->depth, i), behind = word_at(opaque->depth, i);
        uint32_t front = before ? word_at(before->depth, i) : 0;
        if (word_at(layer->primitive, i) == UINT32_MAX) {
            ck_assert_uint_eq(depth, far);
            continue;
        }
        drawn++;
        if ((reversed ? depth <= behind : depth >= behind) ||
            (before && (word_at(before->primitive, i) == UINT32_MAX ||
                        (reversed ? depth >= front : depth <= front))))
            ck_abort_msg("pixel %zu: depth 0x%x is out of order", i, depth);
    }
    return drawn;
}

static void check_trace(uint64_t seed)
{
    static Soup soup;
    Random random = random_seed(seed);
    soup_make(&random, &soup);
    RenderDesc desc = paths_desc(&random);
    desc.method = METHOD_PEEL;
    desc.peel_test = PEEL_TEST_STORED;
    Frame frame, plain;
    Recorder *recorder = recorder_make(-1);
    render(&soup.scene, desc, REF_PATH_AUTO, &recorder->sink, &frame);
    render_tile(&soup.scene, desc, &plain);
    check_frames(&plain, &frame);

    int at = 0;
    uint64_t drawn = 0;
    Traced opaque = expect_gbuffer(recorder, &at, "opaque", 0, &desc), before = {0};
    for (int peel = 0; peel < frame.peels; peel++) {
        char name[32];
        snprintf(name, sizeof name, "peel.%d", peel);
        Traced layer = expect_gbuffer(recorder, &at, name, peel + 1, &desc);
        snprintf(name, sizeof name, "peel.%d.accum", peel);
        expect(recorder, &at, name, peel + 1, desc.accum);
        uint64_t fragments = check_layer(&layer, peel ? &before : NULL, &opaque, &desc);
        ck_assert_uint_gt(fragments, 0);
        drawn += fragments;
        before = layer;
    }
    const Image *accum = expect(recorder, &at, "accum", frame.peels + 1, desc.accum);
    const Image *display = expect(recorder, &at, "display", frame.peels + 2, FORMAT_RGBA8);
    ck_assert_int_eq(at, recorder->count);
    check_images(display, &frame.display, "display");
    uint32_t saved = op_enter();
    check_final(accum, &opaque, &desc, &soup.scene, &frame.final);
    op_leave(saved);
    const LayerStats *layers = &frame.layers;
    ck_assert_uint_eq(layers->fragments, drawn + layers->lost_to_ties + layers->lost_to_pass_limit);
    if (desc.passes == 0)
        ck_assert_uint_eq(layers->lost_to_pass_limit, 0);
    recorder_free(recorder);
    frame_free(&frame);
    frame_free(&plain);
}

START_TEST(test_trace)
{
    for (uint64_t seed = 1; seed <= 60; seed++)
        check_trace(1000 + seed);
}
END_TEST

/* A sink that fails ends the rendering with its result and message, at every buffer. */
START_TEST(test_trace_failure)
{
    static Soup soup;
    Random random = random_seed(7);
    soup_make(&random, &soup);
    RenderDesc desc = {.width = 40, .height = 30, .passes = 2, .threads = 2};
    desc.cull = CULL_NONE;
    const int buffers = 6 + 2 * 7 + 2; /* opaque, two peels, accum and display */
    for (int at = 0; at <= buffers; at++) {
        Recorder *recorder = recorder_make(at);
        Frame frame;
        Result result = pipeline_render(&soup.scene, &desc, &recorder->sink, &frame);
        ck_assert_int_eq(result, at == buffers ? RESULT_OK : RESULT_IO);
        if (at < buffers)
            ck_assert_str_eq(result_message(), "the sink is full");
        ck_assert((at == buffers) == (frame.final.pixels != NULL));
        recorder_free(recorder);
        frame_free(&frame);
    }
}
END_TEST

/* Of fragments at one depth LESS keeps the earlier triangle of the scene and LEQUAL the later; the
 * other is lost. A transparent fragment at the opaque depth is hidden. */
START_TEST(test_ties)
{
    static Soup soup;
    for (int func = DEPTH_LESS; func <= DEPTH_LEQUAL; func++) {
        Random random = random_seed(1);
        soup_make(&random, &soup);
        soup.camera.yfov = 1.0;
        soup_square(&soup, 0, 2.0, -1, 1); /* triangles 0 and 1 */
        soup_square(&soup, 1, 2.0, -1, 1);
        soup_square(&soup, 2, 3.0, -1, 1); /* 4 and 5: behind the others, at the opaque depth */
        soup_square(&soup, 3, 3.0, -1, 1);
        soup.instances[3].material = 0;
        RenderDesc desc = {.width = 192, .height = 20, .depth_func = (DepthFunc)func};
        Frame frame;
        Recorder *recorder = recorder_make(-1);
        render(&soup.scene, desc, REF_PATH_AUTO, &recorder->sink, &frame);
        int at = 0;
        Traced opaque = expect_gbuffer(recorder, &at, "opaque", 0, &desc);
        Traced peel = expect_gbuffer(recorder, &at, "peel.0", 1, &desc);
        for (size_t i = 0; i < 192 * 20; i++) {
            ck_assert_uint_eq(word_at(opaque.primitive, i) / 2, 3);
            ck_assert_uint_eq(word_at(peel.primitive, i) / 2, func == DEPTH_LESS ? 0 : 1);
        }
        ck_assert_int_eq(frame.peels, 1);
        ck_assert_uint_eq(frame.layers.max, 2);
        ck_assert_uint_eq(frame.layers.lost_to_ties, 192 * 20);
        recorder_free(recorder);
        frame_free(&frame);
    }
}
END_TEST

/* ---- small things
 * --------------------------------------------------------------------------------
 */

START_TEST(test_empty)
{
    static Soup soup;
    Random random = random_seed(9);
    soup_make(&random, &soup);
    soup.scene.background[0] = 0.5f;
    soup.camera.world = matrix_translate(0, 0, -1e4); /* everything is behind */
    for (int path = REF_PATH_DEFINITION; path <= REF_PATH_TILE; path++) {
        Frame frame;
        render(&soup.scene, (RenderDesc){.width = 70, .height = 3}, (RefPath)path, NULL, &frame);
        ck_assert_int_eq(frame.peels, 0);
        ck_assert_uint_eq(frame.layers.fragments, 0);
        const float *pixel = image_pixel(&frame.final, 69, 2);
        ck_assert_float_bits(pixel[0], 0.5f);
        ck_assert_float_bits(pixel[3], 0.0f);
        frame_free(&frame);
    }
}
END_TEST

START_TEST(test_limits)
{
    static Soup soup;
    Random random = random_seed(9);
    soup_make(&random, &soup);
    Frame frame;
    RenderDesc desc = {.width = 640, .height = 480, .max_memory = 1 << 20};
    ck_assert_int_eq(pipeline_render(&soup.scene, &desc, NULL, &frame), RESULT_NO_MEMORY);
    ck_assert_ptr_null(frame.final.pixels);
    ck_assert_ptr_nonnull(strstr(result_message(), "--max-memory"));
    desc = (RenderDesc){.width = 8, .height = 8, .camera = 1};
    ck_assert_int_eq(pipeline_render(&soup.scene, &desc, NULL, &frame), RESULT_BAD_INPUT);
    ck_assert_ptr_null(frame.display.pixels);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("paths");
    TCase *tcase = tcase_create("paths");
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_soups);
    tcase_add_test(tcase, test_raw_test_loses_close_layers);
    tcase_add_test(tcase, test_raw_test_stores_the_far_end);
    tcase_add_test(tcase, test_trace);
    tcase_add_test(tcase, test_trace_failure);
    tcase_add_test(tcase, test_ties);
    tcase_add_test(tcase, test_empty);
    tcase_add_test(tcase, test_limits);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

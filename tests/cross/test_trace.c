/* What the definition path of peel traces: every buffer of every step, in order, and the image that
 * is made of it; and ties. */
#include "paths.h"

#include "base/memory.h"
#include "number/op.h"

#include <stdio.h>

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
    paths_render(&soup.scene, desc, REF_PATH_AUTO, &recorder->sink, &frame);
    paths_render_tile(&soup.scene, desc, &plain);
    paths_check_frames(&plain, &frame);

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
    paths_check_images(display, &frame.display, "display");
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
        paths_render(&soup.scene, desc, REF_PATH_AUTO, &recorder->sink, &frame);
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

int main(void)
{
    result_warnings_enable(false); /* lists without room */
    Suite *suite = suite_create("trace");
    TCase *tcase = tcase_create("trace");
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_trace);
    tcase_add_test(tcase, test_trace_failure);
    tcase_add_test(tcase, test_ties);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}

/* Random frames by both paths of ref/pipeline, and their comparison. */
#ifndef PEEL_TESTS_PATHS_H
#define PEEL_TESTS_PATHS_H

#include "testing.h"

#include "random_desc.h"

#include "frame/frame.h"
#include "ref/pipeline/pipeline.h"

static uint64_t paths_running; /* the case's seed, for messages */

/* Mostly peel: other methods have one path, and its threads alone to show. */
static inline RenderDesc paths_desc(Random *random)
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

static inline void paths_render(const Scene *scene, RenderDesc desc, RefPath path, TraceSink *trace,
                                Frame *out)
{
    desc.ref_path = path;
    ck_assert_msg(pipeline_render(scene, &desc, trace, out) == RESULT_OK, "%s", result_message());
}

/* The tile path with desc.simd, or the widest there is where the processor lacks that. */
static inline void paths_render_tile(const Scene *scene, RenderDesc desc, Frame *out)
{
    desc.ref_path = REF_PATH_TILE;
    Result result = pipeline_render(scene, &desc, NULL, out);
    if (result == RESULT_UNSUPPORTED) {
        desc.simd = SIMD_AUTO;
        result = pipeline_render(scene, &desc, NULL, out);
    }
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

static inline void paths_check_images(const Image *got, const Image *expected, const char *name)
{
    size_t bytes = format_pixel_bytes(got->format);
    ck_assert_int_eq(got->width, expected->width);
    ck_assert_int_eq(got->height, expected->height);
    for (int y = 0; y < got->height; y++)
        for (int x = 0; x < got->width; x++)
            if (memcmp(image_pixel(got, x, y), image_pixel(expected, x, y), bytes) != 0)
                ck_abort_msg("PEEL_TEST_SEED=%llu: %s: pixel (%d, %d) differs",
                             (unsigned long long)paths_running, name, x, y);
}

#define CHECK_EQUAL(member)                                                                        \
    ck_assert_msg(got->member == expected->member,                                                 \
                  "PEEL_TEST_SEED=%llu: " #member ": tile %.17g, definition %.17g",                \
                  (unsigned long long)paths_running, (double)got->member,                          \
                  (double)expected->member)

static inline void paths_check_frames(const Frame *got, const Frame *expected)
{
    paths_check_images(&got->final, &expected->final, "final");
    paths_check_images(&got->display, &expected->display, "display");
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

#endif

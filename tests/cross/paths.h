/* Random frames by both paths of ref/pipeline, and their comparison. */
#ifndef PEEL_TESTS_PATHS_H
#define PEEL_TESTS_PATHS_H

#include "testing.h"

#include "random_desc.h"

#include "frame/frame.h"
#include "ref/pipeline/pipeline.h"

#include <stdio.h>

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
static inline Result paths_tile(const Scene *scene, RenderDesc desc, Frame *out)
{
    desc.ref_path = REF_PATH_TILE;
    Result result = pipeline_render(scene, &desc, NULL, out);
    if (result == RESULT_UNSUPPORTED) {
        desc.simd = SIMD_AUTO;
        result = pipeline_render(scene, &desc, NULL, out);
    }
    return result;
}

static inline void paths_render_tile(const Scene *scene, RenderDesc desc, Frame *out)
{
    ck_assert_msg(paths_tile(scene, desc, out) == RESULT_OK, "%s", result_message());
}

/* ---- comparing ------------------------------------------------------------------------------ */

enum {
    PATHS_TEXT = 160
};

/* Whether a pixel differs; text: PATHS_TEXT bytes, which then say where. */
static inline bool paths_images_differ(const Image *got, const Image *expected, const char *name,
                                       char *text)
{
    size_t bytes = format_pixel_bytes(got->format);
    if (got->width != expected->width || got->height != expected->height) {
        snprintf(text, PATHS_TEXT, "%s: %d x %d, expected %d x %d", name, got->width, got->height,
                 expected->width, expected->height);
        return true;
    }
    for (int y = 0; y < got->height; y++)
        for (int x = 0; x < got->width; x++)
            if (memcmp(image_pixel(got, x, y), image_pixel(expected, x, y), bytes) != 0) {
                snprintf(text, PATHS_TEXT, "%s: pixel (%d, %d) differs", name, x, y);
                return true;
            }
    return false;
}

/* The same of a frame's images and counts. */
static inline bool paths_frames_differ(const Frame *got, const Frame *expected, char *text)
{
    const LayerStats *a = &got->layers, *b = &expected->layers;
    const struct {
        const char *name;
        double got, expected;
    } counts[] = {
        {"peels", got->peels, expected->peels},
        {"layers.max", a->max, b->max},
        {"layers.fragments", (double)a->fragments, (double)b->fragments},
        {"layers.lost_to_ties", (double)a->lost_to_ties, (double)b->lost_to_ties},
        {"layers.lost_to_pass_limit", (double)a->lost_to_pass_limit, (double)b->lost_to_pass_limit},
        {"layers.repeated", (double)a->repeated, (double)b->repeated},
        {"layers.lost_to_overflow", (double)a->lost_to_overflow, (double)b->lost_to_overflow},
        {"layers.overflowed", (double)a->overflowed, (double)b->overflowed},
        {"geometry_passes", got->geometry_passes, expected->geometry_passes},
        {"fragments_shaded", (double)got->fragments_shaded, (double)expected->fragments_shaded},
        {"nodes", (double)got->nodes, (double)expected->nodes},
        {"residual_max", got->residual_max, expected->residual_max},
        {"residual_pixels", (double)got->residual_pixels, (double)expected->residual_pixels},
    };
    if (paths_images_differ(&got->final, &expected->final, "final", text) ||
        paths_images_differ(&got->display, &expected->display, "display", text))
        return true;
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        if (memcmp(&counts[i].got, &counts[i].expected, sizeof(double)) != 0) {
            snprintf(text, PATHS_TEXT, "%s: tile %.17g, definition %.17g", counts[i].name,
                     counts[i].got, counts[i].expected);
            return true;
        }
    return false;
}

static inline void paths_check_images(const Image *got, const Image *expected, const char *name)
{
    char text[PATHS_TEXT] = "";
    ck_assert_msg(!paths_images_differ(got, expected, name, text), "PEEL_TEST_SEED=%llu: %s",
                  (unsigned long long)paths_running, text);
}

static inline void paths_check_frames(const Frame *got, const Frame *expected)
{
    char text[PATHS_TEXT] = "";
    ck_assert_msg(!paths_frames_differ(got, expected, text), "PEEL_TEST_SEED=%llu: %s",
                  (unsigned long long)paths_running, text);
}

#endif

/* A comparison made by hand, for the tests of what is reported about one. */
#ifndef PEEL_TESTS_SAMPLE_REPORT_H
#define PEEL_TESTS_SAMPLE_REPORT_H

#include "study/threeway.h"

#include "scratch.h"
#include "testing.h"

#include <math.h>

enum {
    WIDTH = 320,
    HEIGHT = 180,
    PEELS = 16,
    PER_PEEL = 6,
    BUFFERS = 5 + PEELS * PER_PEEL + 2
};

static Threeway report;
static BufferMetrics buffers[BUFFERS];
static PeelPicture peels[PEELS];

static inline void fill(Image *image, int peel, bool layer)
{
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++) {
            float *pixel = image_pixel(image, x, y);
            float u = (float)x / (float)image->width, v = (float)y / (float)image->height;
            float du = u - 0.2f - 0.05f * (float)peel, dv = v - 0.5f;
            bool inside = du * du + dv * dv < 0.03f;
            pixel[0] = layer && !inside ? 0.0f : 0.8f * u;
            pixel[1] = layer && !inside ? 0.0f : 0.5f * v;
            pixel[2] = layer && !inside ? 0.0f : 0.1f * (float)(peel + 1);
            pixel[3] = layer ? (inside ? 1.0f : 0.0f) : 0.5f;
        }
}

static inline Image make_image(int width, int height, PixelFormat format)
{
    Image image;
    ck_assert_int_eq(image_create(width, height, format, &image), RESULT_OK);
    return image;
}

static inline void make_frames(void)
{
    for (int i = 0; i < RENDERER_COUNT; i++) {
        Frame *frame = &report.frames[i];
        frame->final = make_image(WIDTH, HEIGHT, FORMAT_RGBA32F);
        frame->display = make_image(WIDTH, HEIGHT, FORMAT_RGBA8);
        fill(&frame->final, 3, false);
        for (int p = 0; p < WIDTH * HEIGHT * 4; p++)
            ((uint8_t *)frame->display.pixels)[p] =
                (uint8_t)(255 * ((float *)frame->final.pixels)[p]);
        *frame = (Frame){.final = frame->final,
                         .display = frame->display,
                         .peels = PEELS,
                         .time_ms = 100.0 * (i + 1),
                         .cpu_ms = 190.0 * (i + 1),
                         .threads = 2,
                         .fused = true,
                         .buffer_bytes = 12345678};
        strcpy(frame->version, "1.0 <&> \"quoted\"");
    }
    /* Eight decades of difference from left to right, one NaN. */
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            *(float *)image_pixel(&report.frames[RENDERER_TRUTH].final, x, y) +=
                y < 20 ? 0.0f : powf(10.0f, -8.0f + 8.0f * (float)x / WIDTH);
    *(float *)image_pixel(&report.frames[RENDERER_TRUTH].final, 100, 100) = NAN;
}

static inline void name_buffers(void)
{
    static const char *const parts[PER_PEEL] = {"depth",   "normal",   "position",
                                                "diffuse", "material", "accum"};
    for (int i = 0; i < BUFFERS; i++) {
        BufferMetrics *buffer = &buffers[i];
        *buffer = (BufferMetrics){.values = WIDTH * HEIGHT * 4};
        int peel = (i - 5) / PER_PEEL;
        if (i < 5)
            snprintf(buffer->name, sizeof buffer->name, "opaque.%s", parts[i]);
        else if (i < BUFFERS - 2)
            snprintf(buffer->name, sizeof buffer->name, "peel.%d.%s", peel, parts[(i - 5) % 6]);
        else
            strcpy(buffer->name, i == BUFFERS - 2 ? "accum" : "display");
    }
}

static inline void make_pairs(void)
{
    static const int sides[3][2] = {
        {RENDERER_REF, RENDERER_GL}, {RENDERER_REF, RENDERER_TRUTH}, {RENDERER_GL, RENDERER_TRUTH}};
    for (int i = 0; i < 3; i++) {
        PairReport *pair = &report.pairs[i];
        *pair = (PairReport){.a = sides[i][0], .b = sides[i][1], .has_unaffected = i > 0};
        pair->final = (FinalMetrics){.pixels = WIDTH * HEIGHT, .psnr = INFINITY};
        if (i == 0)
            continue;
        pair->final = (FinalMetrics){.pixels = WIDTH * HEIGHT,
                                     .differing = 51200,
                                     .nonfinite = 1,
                                     .max_abs = 0.97,
                                     .mean_abs = 0.01,
                                     .rmse = NAN,
                                     .psnr = 31.4,
                                     .max_ulp = UINT32_MAX};
        pair->unaffected = (UnaffectedMetrics){.pixels = 57000,
                                               .occupied = 41000,
                                               .max_abs = 1.25e-6,
                                               .max_rel = 1.25e-6,
                                               .p99_rel = 3.5e-7};
    }
    report.pairs[0].buffers = buffers;
    report.pairs[0].buffer_count = BUFFERS;
}

static inline void make_report(void)
{
    scratch_make();
    report = (Threeway){.scene_name = "gradients <1> & \"2\"",
                        .scene_path = "data/scenes/<gradients>'s.gltf",
                        .desc = {.width = WIDTH, .height = HEIGHT, .lights = 16},
                        .tolerance = 1e-4,
                        .peels = peels,
                        .peel_count = PEELS,
                        .agree = true};
    make_frames();
    name_buffers();
    make_pairs();
    report.structure.layers = (LayerStats){.max = PEELS,
                                           .fragments = 345678,
                                           .lost_to_ties = 9,
                                           .coverage_differs = 77,
                                           .exact_comparisons = 21,
                                           .ties = 7};
    report.structure.known = true;
    report.structure.order_inversions = 3;
    report.structure.same_scene = true;
    for (int i = 0; i < PEELS; i++) {
        peels[i] = (PeelPicture){.peel = i, .pixels = 5000 - 100 * (uint64_t)i};
        peels[i].accum = make_image(160, 90, FORMAT_RGBA32F);
        peels[i].added = make_image(160, 90, FORMAT_RGBA32F);
        fill(&peels[i].accum, i, false);
        fill(&peels[i].added, i, true);
    }
}

static inline void free_report(void)
{
    for (int i = 0; i < RENDERER_COUNT; i++)
        frame_free(&report.frames[i]);
    for (int i = 0; i < PEELS; i++) {
        image_free(&peels[i].accum);
        image_free(&peels[i].added);
    }
    scratch_remove();
}

/* peel.3.normal differs. */
static inline void make_differ(void)
{
    BufferMetrics *buffer = &buffers[5 + 3 * PER_PEEL + 1];
    *buffer = (BufferMetrics){"peel.3.normal", 230400, 17, 3, 2.4e-7, true, {12, 34, 2}};
    report.agree = false;
}

#endif

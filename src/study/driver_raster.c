/* Rules about triangles: where they are seen, and what is interpolated there. */
#include "study/driver_test.h"

#include <stdio.h>
#include <string.h>

enum {
    TRIANGLES = 96,
    MESHES = 8, /* of BATCH triangles */
    BATCH = 64,
    GRIDS = 8
};

static const char *const field_names[RASTER_FIELDS] = {
    "coverage",  "front facing", "gl_FragCoord.z", "gl_FragCoord.w",
    "varying x", "varying y",    "varying z",      "stored depth",
};

static const char *const corner_names[12] = {
    "clip0.x", "clip0.y", "clip0.z", "clip0.w", "clip1.x", "clip1.y",
    "clip1.z", "clip1.w", "clip2.x", "clip2.y", "clip2.z", "clip2.w",
};

static Experiment with_operands(Test *test, int count)
{
    Experiment experiment = test->rule->experiment;
    experiment.a = (const float(*)[4])test->a;
    experiment.b = (const float(*)[4])test->b;
    experiment.count = count;
    return experiment;
}

static void random_triangles(Test *test, int count)
{
    for (int i = 0; i < count; i++)
        inputs_triangle(&test->random, test->rule->triangle, &test->a[3 * i], &test->b[3 * i]);
}

/* corners: the triangle's, or NULL where no single one is meant. */
static void describe(Test *test, const float *corners, int pixel, const char *field,
                     uint32_t expected, uint32_t got)
{
    DriverExample *example =
        test_example(test, corners, corner_names, corners ? 12 : 0, expected, got);
    if (example)
        snprintf(example->place, sizeof example->place, "pixel %d, %d: %s", pixel % RASTER_WIDTH,
                 pixel / RASTER_WIDTH, field);
}

/* Pixels that only one side covers count for the coverage field alone. */
static void compare_fields(Test *test, const float *corners)
{
    for (int i = 0; i < RASTER_PIXELS; i++) {
        const uint32_t *expected = &test->expected[i * RASTER_FIELDS];
        const uint32_t *got = &test->got[i * RASTER_FIELDS];
        bool covered = expected[RASTER_TRIANGLE] && got[RASTER_TRIANGLE];
        for (int f = test->rule->field; f < test->rule->field_end; f++) {
            if (f != RASTER_TRIANGLE && !covered)
                continue;
            if (test_differs(test, expected[f], got[f]))
                describe(test, corners, i, field_names[f], expected[f], got[f]);
        }
    }
}

Result test_raster(Test *test)
{
    Experiment experiment = with_operands(test, 1);
    for (int i = 0; i < TRIANGLES; i++) {
        random_triangles(test, 1);
        Result result = test->model->run(test->model, &experiment, test->expected);
        if (result == RESULT_OK)
            result = test->driver->run(test->driver, &experiment, test->got);
        if (result != RESULT_OK)
            return result;
        compare_fields(test, test->a[0]);
    }
    return RESULT_OK;
}

/* The rule is that every pixel is hit once: the model is not asked. */
Result test_grid(Test *test)
{
    for (int i = 0; i < GRIDS; i++) {
        int count = inputs_grid(&test->random, test->a);
        Experiment experiment = with_operands(test, count);
        Result result = test->driver->run(test->driver, &experiment, test->got);
        if (result != RESULT_OK)
            return result;
        for (int p = 0; p < RASTER_PIXELS; p++)
            if (test_differs(test, 1, test->got[p]))
                describe(test, NULL, p, "triangles that cover it", 1, test->got[p]);
    }
    return RESULT_OK;
}

Result test_ties(Test *test)
{
    Experiment experiment = with_operands(test, 2);
    uint32_t kept = experiment.depth_func == DEPTH_LEQUAL ? 2 : 1;
    for (int i = 0; i < TRIANGLES / 4; i++) {
        random_triangles(test, 1);
        memcpy(test->a[3], test->a[0], 3 * sizeof test->a[0]);
        memcpy(test->b[3], test->b[0], 3 * sizeof test->b[0]);
        Result result = test->driver->run(test->driver, &experiment, test->got);
        if (result != RESULT_OK)
            return result;
        for (int p = 0; p < RASTER_PIXELS; p++) {
            uint32_t seen = test->got[p * RASTER_FIELDS + RASTER_TRIANGLE];
            if (seen && test_differs(test, kept, seen))
                describe(test, test->a[0], p, "which of two coinciding triangles is seen", kept,
                         seen);
        }
    }
    return RESULT_OK;
}

Result test_layouts(Test *test)
{
    Experiment experiment = with_operands(test, BATCH);
    for (int i = 0; i < MESHES; i++) {
        random_triangles(test, BATCH);
        experiment.layout = RASTER_FULL;
        Result result = test->driver->run(test->driver, &experiment, test->expected);
        for (int l = 1; l < RASTER_LAYOUTS && result == RESULT_OK; l++) {
            experiment.layout = (RasterLayout)l;
            result = test->driver->run(test->driver, &experiment, test->got);
            for (int p = 0; p < RASTER_PIXELS && result == RESULT_OK; p++) {
                uint32_t expected = test->expected[p * RASTER_FIELDS + RASTER_DEPTH];
                uint32_t got = test->got[p * RASTER_FIELDS + RASTER_DEPTH];
                if (test_differs(test, expected, got))
                    describe(test, NULL, p,
                             l == RASTER_DEPTH_ONLY ? "stored depth, depth-only pass"
                                                    : "stored depth, pass of four targets",
                             expected, got);
            }
        }
        if (result != RESULT_OK)
            return result;
    }
    return RESULT_OK;
}

Result test_samples(Test *test)
{
    Experiment query = with_operands(test, 1);
    Experiment pixels = query;
    pixels.kind = EXPERIMENT_RASTER;
    for (int i = 0; i < TRIANGLES; i++) {
        random_triangles(test, 1);
        uint32_t covered = 0, counted = 0;
        Result result = test->driver->run(test->driver, &pixels, test->got);
        for (int p = 0; p < RASTER_PIXELS && result == RESULT_OK; p++)
            covered += test->got[p * RASTER_FIELDS + RASTER_TRIANGLE] != 0;
        if (result == RESULT_OK)
            result = test->driver->run(test->driver, &query, &counted);
        if (result != RESULT_OK)
            return result;
        if (test_differs(test, covered, counted))
            test_example(test, test->a[0], corner_names, 12, covered, counted);
    }
    return RESULT_OK;
}

Result test_repeat(Test *test)
{
    Experiment experiment = with_operands(test, BATCH);
    for (int i = 0; i < MESHES; i++) {
        random_triangles(test, BATCH);
        Result result = test->driver->run(test->driver, &experiment, test->expected);
        if (result == RESULT_OK)
            result = test->driver->run(test->driver, &experiment, test->got);
        if (result != RESULT_OK)
            return result;
        for (int p = 0; p < RASTER_PIXELS * RASTER_FIELDS; p++)
            if (test_differs(test, test->expected[p], test->got[p]))
                describe(test, NULL, p / RASTER_FIELDS, field_names[p % RASTER_FIELDS],
                         test->expected[p], test->got[p]);
    }
    return RESULT_OK;
}

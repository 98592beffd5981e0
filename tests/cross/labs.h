/* What the tests of single values share: the rules' lab and the driver's, operands of seeded
 * inputs, and a comparison that prints what reproduces a difference.
 *
 * Loops over values abort on a difference instead of asserting each: check sends a message to its
 * parent process for every assertion. */
#ifndef PEEL_TESTS_LABS_H
#define PEEL_TESTS_LABS_H

#include "testing.h"

#include "gl/lab.h"
#include "number/op.h"
#include "ref/pipeline/experiment.h"
#include "study/driver_inputs.h"

#include <stdio.h>

static GlLab *driver;
static LabDriver driver_info;
static PipelineLab model;
static Random random_state;
static float a[EXPERIMENT_TEXELS][4], b[EXPERIMENT_TEXELS][4];
static uint32_t expected[EXPERIMENT_VALUES_MAX], got[EXPERIMENT_VALUES_MAX];

static inline void labs_open(void)
{
    ck_assert_msg(lab_open(0, &driver_info, &driver) == RESULT_OK, "%s", result_message());
    ck_assert_msg(driver_info.mode != FUSES_UNKNOWN, "%s interpolates as neither mode does",
                  driver_info.renderer);
    model = pipeline_lab(driver_info.mode == FUSES_YES);
    random_state = random_seed(2024);
}

static inline void labs_close(void)
{
    lab_close(driver);
}

static inline void labs_fill(InputSet set, double codes)
{
    for (int i = 0; i < EXPERIMENT_TEXELS; i++)
        for (int k = 0; k < 4; k++) {
            a[i][k] = inputs_value(&random_state, set, codes);
            b[i][k] = inputs_value(&random_state, set, codes);
        }
}

static inline void labs_run(Experiment *experiment)
{
    experiment->a = (const float(*)[4])a;
    experiment->b = (const float(*)[4])b;
    Lab *lab = lab_experiments(driver);
    ck_assert(model.lab.run(&model.lab, experiment, expected) == RESULT_OK);
    ck_assert_msg(lab->run(lab, experiment, got) == RESULT_OK, "%s", result_message());
}

typedef uint32_t (*LabsDistance)(uint32_t x, uint32_t y);

static inline uint32_t labs_float(uint32_t x, uint32_t y)
{
    return ulp_distance(op_from_bits(x), op_from_bits(y));
}
static inline uint32_t labs_half(uint32_t x, uint32_t y)
{
    return ulp_distance_half((uint16_t)x, (uint16_t)y);
}
static inline uint32_t labs_code(uint32_t x, uint32_t y)
{
    return x > y ? x - y : y - x;
}

/* Runs the experiment in both labs; what names it. */
static inline void labs_assert_equal(Experiment *experiment, LabsDistance distance,
                                     const char *what, int set)
{
    labs_run(experiment);
    size_t count = experiment_values(experiment);
    int values = count == EXPERIMENT_TEXELS ? 1 : 4;
    for (size_t i = 0; i < count; i++)
        if (expected[i] != got[i] && distance(expected[i], got[i]) != 0) {
            const float *x = a[i / (size_t)values], *y = b[i / (size_t)values];
            ck_abort_msg("%s, set %d, channel %zu of a (%a, %a, %a, %a) b (%a, %a, %a, %a): "
                         "driver 0x%08x, rules 0x%08x",
                         what, set, i % (size_t)values, (double)x[0], (double)x[1], (double)x[2],
                         (double)x[3], (double)y[0], (double)y[1], (double)y[2], (double)y[3],
                         got[i], expected[i]);
        }
}

#endif

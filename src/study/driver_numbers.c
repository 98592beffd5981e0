/* Rules about single values: operations, stored formats, blending. */
#include "number/op.h"
#include "study/driver_test.h"

#include <stdio.h>
#include <string.h>

enum {
    CLEARS = 2048
};

static double greatest_code(PixelFormat format)
{
    const FormatInfo *info = format_info(format);
    return info->unorm_max ? info->unorm_max : 2048.0;
}

static void fill(Test *test, InputSet set)
{
    const Experiment *experiment = &test->rule->experiment;
    double codes = greatest_code(experiment->format);
    bool color = experiment->kind != EXPERIMENT_OPERATION;
    for (int i = 0; i < EXPERIMENT_TEXELS; i++)
        for (int k = 0; k < 4; k++) {
            float a = inputs_value(&test->random, set, codes);
            float b = inputs_value(&test->random, set, codes);
            test->a[i][k] = color ? inputs_bounded(experiment->format, a) : a;
            test->b[i][k] = color ? inputs_bounded(experiment->format, b) : b;
        }
}

static void describe_operation(Test *test, size_t at)
{
    static const char *const pairs[] = {"a", "b"};
    static const char *const all[] = {"a.x", "a.y", "a.z", "a.w", "b.x", "b.y", "b.z", "b.w"};
    const OperationInfo *info = operation_info(test->rule->experiment.operation);
    const float *a = test->a[at / 4], *b = test->b[at / 4];
    float inputs[8] = {a[at % 4], b[at % 4]};
    if (!info->channelwise)
        for (int k = 0; k < 4; k++) {
            inputs[k] = a[k];
            inputs[4 + k] = b[k];
        }
    int count = info->channelwise ? info->operands : 4 * info->operands;
    DriverExample *example = test_example(test, inputs, info->channelwise ? pairs : all, count,
                                          test->expected[at], test->got[at]);
    if (example && !info->channelwise)
        snprintf(example->place, sizeof example->place, "channel %d", (int)(at % 4));
}

static void describe_blend(Test *test, size_t at)
{
    static const char *const names[] = {"source", "source alpha", "before", "before alpha"};
    const float *a = test->a[at / 4], *b = test->b[at / 4];
    const float inputs[] = {a[at % 4], a[3], b[at % 4], b[3]};
    DriverExample *example =
        test_example(test, inputs, names, 4, test->expected[at], test->got[at]);
    if (example)
        snprintf(example->place, sizeof example->place, "channel %d", (int)(at % 4));
}

static void describe_value(Test *test, float value, size_t at)
{
    static const char *const names[] = {"value"};
    test_example(test, &value, names, 1, test->expected[at], test->got[at]);
}

static void compare(Test *test, size_t count)
{
    const Experiment *experiment = &test->rule->experiment;
    size_t channels = experiment->kind == EXPERIMENT_OPERATION
                          ? 4
                          : (size_t)format_info(experiment->format)->channels;
    for (size_t i = 0; i < count; i++) {
        if (count > EXPERIMENT_TEXELS && i % 4 >= channels)
            continue;
        if (!test_differs(test, test->expected[i], test->got[i]))
            continue;
        if (experiment->kind == EXPERIMENT_OPERATION)
            describe_operation(test, i);
        else if (experiment->kind == EXPERIMENT_BLEND)
            describe_blend(test, i);
        else if (count == EXPERIMENT_TEXELS) /* depths */
            describe_value(test, test->a[i][0], i);
        else
            describe_value(test, test->a[i / 4][i % 4], i);
    }
}

static Result run_both(Test *test, const Experiment *experiment)
{
    Result result = test->model->run(test->model, experiment, test->expected);
    return result == RESULT_OK ? test->driver->run(test->driver, experiment, test->got) : result;
}

Result test_values(Test *test)
{
    Experiment experiment = test->rule->experiment;
    experiment.equation = equation_info(test->rule->equation)->equation;
    experiment.a = (const float(*)[4])test->a;
    experiment.b = (const float(*)[4])test->b;
    for (int i = 0; i < INPUT_SETS; i++) {
        if (!(test->rule->sets >> i & 1))
            continue;
        fill(test, (InputSet)(1 << i));
        Result result = run_both(test, &experiment);
        if (result != RESULT_OK)
            return result;
        compare(test, experiment_values(&experiment));
    }
    return RESULT_OK;
}

Result test_clear(Test *test)
{
    Experiment experiment = test->rule->experiment;
    experiment.a = (const float(*)[4])test->a;
    experiment.count = CLEARS;
    for (int i = 0; i < CLEARS; i++)
        for (int k = 0; k < 4; k++) {
            InputSet set = i % 8 == 0 ? INPUT_UNIT : i % 8 == 1 ? INPUT_SPECIAL : INPUT_CODES;
            test->a[i][k] =
                inputs_bounded(experiment.format,
                               inputs_value(&test->random, set, greatest_code(experiment.format)));
        }
    Result result = run_both(test, &experiment);
    int channels = format_info(experiment.format)->channels;
    for (int i = 0; i < 4 * CLEARS && result == RESULT_OK; i++)
        if (i % 4 < channels && test_differs(test, test->expected[i], test->got[i]))
            describe_value(test, test->a[i / 4][i % 4], (size_t)i);
    return result;
}

Result test_fetch(Test *test)
{
    static const char *const names[] = {"code"};
    const Experiment *experiment = &test->rule->experiment;
    const FormatInfo *info = format_info(experiment->format);
    Result result = run_both(test, experiment);
    for (int i = 0; i < 4 * EXPERIMENT_TEXELS && result == RESULT_OK; i++) {
        if (!test_differs(test, test->expected[i], test->got[i]))
            continue;
        float code = i % 4 < info->channels
                         ? (float)((uint32_t)i & (info->channel_bytes == 1 ? 0xffu : 0xffffu))
                         : 0.0f;
        DriverExample *example =
            test_example(test, &code, names, 1, test->expected[i], test->got[i]);
        if (example)
            snprintf(example->place, sizeof example->place, "channel %d", i % 4);
    }
    return result;
}

/* Every code of d16; of d24 a random sample and both ends. What is fetched is compared with the
 * code that the driver says it holds. */
Result test_depth_fetch(Test *test)
{
    static const char *const names[] = {"code"};
    Experiment experiment = test->rule->experiment;
    experiment.a = (const float(*)[4])test->a;
    uint32_t most = format_info(experiment.format)->unorm_max;
    Result result = RESULT_OK;
    for (int round = 0; round < 2 && result == RESULT_OK; round++) {
        for (int i = 0; i < EXPERIMENT_TEXELS; i++) {
            uint32_t code = (uint32_t)(2 * i + round);
            if (experiment.format == FORMAT_D24 && i >= 16)
                code = (uint32_t)random_bits(&test->random);
            test->a[i][0] = most ? (float)((i & 1 ? most - code : code) & most)
                                 : inputs_value(&test->random, INPUT_UNIT, 0.0);
        }
        result = test->driver->run(test->driver, &experiment, test->got);
        for (int i = 0; i < EXPERIMENT_TEXELS; i++)
            test->a[i][0] = most ? (float)test->got[2 * i] : op_from_bits(test->got[2 * i]);
        if (result == RESULT_OK)
            result = test->model->run(test->model, &experiment, test->expected);
        for (int i = 1; i < 2 * EXPERIMENT_TEXELS && result == RESULT_OK; i += 2)
            if (test_differs(test, test->expected[i], test->got[i]))
                test_example(test, test->a[i / 2], names, 1, test->expected[i], test->got[i]);
    }
    return result;
}

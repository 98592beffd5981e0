#include "study/driver.h"

#include "base/memory.h"
#include "base/progress.h"
#include "number/op.h"
#include "study/driver_rules.h"

#include <limits.h>
#include <stdlib.h>

static uint32_t distance(DriverValue value, uint32_t a, uint32_t b)
{
    switch (value) {
    case DRIVER_FLOAT:
        return ulp_distance(op_from_bits(a), op_from_bits(b));
    case DRIVER_HALF:
        return ulp_distance_half((uint16_t)a, (uint16_t)b);
    default:
        return a > b ? a - b : b - a;
    }
}

bool test_differs(Test *test, uint32_t expected, uint32_t got)
{
    DriverRule *out = test->out;
    out->samples++;
    if (expected == got)
        return false;
    uint32_t apart = distance(test->rule->value, expected, got);
    if (apart == 0) /* two NaN */
        return false;
    out->differing++;
    out->max_distance = apart > out->max_distance ? apart : out->max_distance;
    return true;
}

DriverExample *test_example(Test *test, const float *inputs, const char *const *names, int count,
                            uint32_t expected, uint32_t got)
{
    DriverRule *out = test->out;
    int complexity = 0;
    for (int i = 0; i < count; i++)
        complexity += inputs_complexity(inputs[i]);
    if (out->has_example && complexity >= test->complexity)
        return NULL;
    test->complexity = complexity;
    out->has_example = true;
    out->example = (DriverExample){.input_count = count,
                                   .input_names = names,
                                   .value = test->rule->value,
                                   .expected = expected,
                                   .got = got};
    for (int i = 0; i < count; i++)
        out->example.inputs[i] = inputs[i];
    return &out->example;
}

static DriverVerdict judge(const Rule *rule, const DriverRule *out)
{
    if (out->differing == 0)
        return DRIVER_EXACT;
    return rule->relied_on && out->max_distance > rule->allowance ? DRIVER_BROKEN : DRIVER_DIFFERS;
}

size_t driver_rule_count(void)
{
    size_t count;
    driver_rules(&count);
    return count;
}

const char *driver_rule_id(size_t index)
{
    size_t count;
    return driver_rules(&count)[index].id;
}

Result driver_run_rule(size_t index, Lab *model, Lab *driver, Renderer renderer, DriverRule *out)
{
    size_t count;
    const Rule *rule = &driver_rules(&count)[index];
    *out = (DriverRule){.id = rule->id,
                        .what = rule->what,
                        .section = rule->section,
                        .relied_on = rule->relied_on,
                        .value = rule->value,
                        .verdict = DRIVER_UNTESTED,
                        .reason = rule->reason};
    if (!rule->run)
        return RESULT_OK;
    Test test = {
        .rule = rule,
        .model = model,
        .driver = driver,
        .renderer = renderer,
        .random = random_seed(index + 1),
        .a = memory_array(EXPERIMENT_TEXELS, sizeof *test.a),
        .b = memory_array(EXPERIMENT_TEXELS, sizeof *test.b),
        .expected = memory_array(EXPERIMENT_VALUES_MAX, sizeof *test.expected),
        .got = memory_array(EXPERIMENT_VALUES_MAX, sizeof *test.got),
        .out = out,
    };
    Result result =
        test.a && test.b && test.expected && test.got ? rule->run(&test) : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        out->verdict = judge(rule, out);
    free(test.a);
    free(test.b);
    free(test.expected);
    free(test.got);
    return result;
}

static void add_up(DriverReport *report)
{
    for (size_t i = 0; i < report->count; i++)
        switch (report->rules[i].verdict) {
        case DRIVER_EXACT:
            report->exact++;
            break;
        case DRIVER_DIFFERS:
            report->differ++;
            break;
        case DRIVER_BROKEN:
            report->broken++;
            break;
        case DRIVER_UNTESTED:
            report->untested++;
            break;
        }
}

Result driver_run(Lab *model, Lab *driver, Renderer renderer, DriverReport *out)
{
    *out = (DriverReport){.count = driver_rule_count()};
    out->rules = memory_array(out->count, sizeof *out->rules);
    if (!out->rules)
        return RESULT_NO_MEMORY;
    Result result = RESULT_OK;
    progress_begin("rules", out->count);
    for (size_t i = 0; i < out->count && result == RESULT_OK; i++) {
        result = driver_run_rule(i, model, driver, renderer, &out->rules[i]);
        progress_step(i + 1);
    }
    progress_end();
    if (result == RESULT_OK)
        add_up(out);
    else
        driver_free(out);
    return result;
}

void driver_free(DriverReport *report)
{
    free(report->rules);
    *report = (DriverReport){0};
}

const char *driver_verdict_name(DriverVerdict verdict)
{
    static const char *const names[] = {"exact", "differs", "broken", "not tested"};
    return names[verdict];
}

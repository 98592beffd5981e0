/* Replays the blend steps that peel explain --json printed: from the printed hexadecimal floats
 * alone they must give the accumulation that a frame stores.
 *
 *   replay pixels COUNT SEED WIDTH HEIGHT       prints COUNT options --pixel X,Y
 *   replay check SCENE METHOD ACCUM WIDTH HEIGHT FILE
 *   replay sides FILE                           gl's steps, which are ref's, and the truth's
 *
 * Exit code 1 and a line for each pixel that does not. */
#include "base/random.h"
#include "frame/method.h"
#include "frame/pixel_trace.h"
#include "frame/setting.h"
#include "number/op.h"
#include "ref/pipeline/pipeline.h"
#include "scene/generate.h"
#include "step_blend.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int print_pixels(char **arguments)
{
    long count = strtol(arguments[0], NULL, 10);
    Random random = random_seed(strtoull(arguments[1], NULL, 10));
    uint64_t width = strtoull(arguments[2], NULL, 10), height = strtoull(arguments[3], NULL, 10);
    for (long i = 0; i < count; i++) {
        unsigned long long x = random_bits(&random) % width, y = random_bits(&random) % height;
        printf("--pixel %llu,%llu\n", x, y);
    }
    return 0;
}

/* ---- one pixel ---- */

typedef struct Target {
    const char *name;
    PixelFormat format;
    _Alignas(8) unsigned char pixel[16];
} Target;

enum {
    TARGETS = 4
};

static PixelFormat find_format(const char *name)
{
    PixelFormat format;
    if (format_find(name, &format))
        return format;
    fprintf(stderr, "no format %s\n", name);
    exit(1);
}

/* The step's target, cleared where it is new. */
static Target *target_of(Target targets[TARGETS], const json_t *step)
{
    const char *name = json_string_value(json_object_get(step, "target"));
    Target *target = targets;
    while (target->name && strcmp(target->name, name) != 0)
        target++;
    if (target->name)
        return target;
    *target = (Target){name, find_format(json_string_value(json_object_get(step, "format"))), {0}};
    step_clear(name, target->format, target->pixel);
    return target;
}

static double number(const json_t *array, size_t index)
{
    return strtod(json_string_value(json_array_get(array, index)), NULL);
}

static int is_stored(const Target *target, const json_t *values)
{
    for (int i = 0; i < format_info(target->format)->channels; i++) {
        double value = number(values, (size_t)i);
        if (!(value == (double)format_channel(target->format, target->pixel, i)))
            return 0;
    }
    return 1;
}

static bool blend(const json_t *step, Target *target)
{
    float source[4];
    for (int i = 0; i < 4; i++)
        source[i] = (float)number(json_object_get(step, "source"), (size_t)i);
    return step_blend(json_string_value(json_object_get(step, "equation")), target->format, source,
                      target->pixel);
}

/* NULL, or what is wrong. accum: the frame's; NULL where it is not known. */
static const char *replay(const json_t *history, const PixelValue *accum)
{
    Target targets[TARGETS] = {0};
    const json_t *steps = json_object_get(history, "blend"), *step;
    const char *format = json_string_value(json_object_get(history, "accum_format"));
    size_t i;
    targets[0] = (Target){"accum", find_format(format), {0}};
    step_clear("accum", targets[0].format, targets[0].pixel);
    json_array_foreach(steps, i, step)
    {
        Target *target = target_of(targets, step);
        if (!is_stored(target, json_object_get(step, "before")))
            return "a step begins with what the one before it did not leave";
        if (!blend(step, target))
            return "a step has an unknown equation";
        if (!is_stored(target, json_object_get(step, "after")))
            return "a step gives something else";
    }
    if (!is_stored(&targets[0], json_object_get(history, "accum")))
        return "the steps do not give the printed accumulation";
    if (accum && memcmp(targets[0].pixel, accum->bytes, format_pixel_bytes(accum->format)) != 0)
        return "the steps do not give the frame's accumulation";
    return NULL;
}

/* In double precision, as the truth blends. */
static const char *replay_truth(const json_t *history)
{
    const json_t *steps = json_object_get(history, "blend"), *step;
    double sum[4] = {0.0, 0.0, 0.0, 1.0};
    size_t i;
    json_array_foreach(steps, i, step)
    {
        const json_t *source = json_object_get(step, "source");
        for (size_t k = 0; k < 3; k++)
            sum[k] += number(source, k) * sum[3];
        sum[3] *= 1.0 - number(source, 3);
        for (size_t k = 0; k < 4; k++)
            if (sum[k] != number(json_object_get(step, "after"), k))
                return "a step of the truth gives something else";
    }
    for (size_t k = 0; k < 4; k++)
        if (sum[k] != number(json_object_get(history, "accum"), k))
            return "the truth's steps do not give its accumulation";
    return NULL;
}

/* ---- all of a file ---- */

static int fail(const char *what)
{
    fprintf(stderr, "%s: %s\n", what, result_message());
    return 1;
}

static int check(char **arguments)
{
    const BuiltinScene *builtin = generate_find(arguments[0]);
    const MethodInfo *method = method_find(arguments[1]);
    RenderDesc desc = {.width = atoi(arguments[3]),
                       .height = atoi(arguments[4]),
                       .method = method->id,
                       .accum = find_format(arguments[2])};
    json_error_t error;
    json_t *all = json_load_file(arguments[5], 0, &error), *one;
    Scene scene;
    Frame frame;
    int failed = 0;
    size_t i, count = json_array_size(all);
    PixelTrace *traces = calloc(count + 1, sizeof *traces);
    if (count == 0 || !traces)
        return fail("no array of histories");
    json_array_foreach(all, i, one)
    {
        const json_t *pixel = json_object_get(json_object_get(one, "ref"), "pixel");
        traces[i] = pixel_trace_of((int)json_integer_value(json_array_get(pixel, 0)),
                                   (int)json_integer_value(json_array_get(pixel, 1)));
    }
    PixelFan fan = pixel_fan_of(traces, count);
    if (builtin->generate(&scene) != RESULT_OK ||
        pipeline_render(&scene, &desc, &fan.sink, &frame) != RESULT_OK)
        return fail(arguments[0]);
    op_enter();
    size_t steps = 0;
    json_array_foreach(all, i, one)
    {
        const json_t *history = json_object_get(one, "ref");
        const char *wrong = replay(history, pixel_trace_find(&traces[i], "accum"));
        steps += json_array_size(json_object_get(history, "blend"));
        if (wrong)
            failed |=
                printf("%s, pixel %d,%d: %s\n", arguments[0], traces[i].x, traces[i].y, wrong) > 0;
        pixel_trace_free(&traces[i]);
    }
    printf("%zu pixels, %zu steps\n", count, steps);
    free(traces);
    frame_free(&frame);
    scene_free(&scene);
    json_decref(all);
    return failed;
}

/* gl and truth of every history of a file. */
static int check_sides(const char *path)
{
    json_error_t error;
    json_t *all = json_load_file(path, 0, &error), *one;
    int failed = 0;
    size_t i;
    op_enter();
    json_array_foreach(all, i, one)
    {
        const json_t *ref = json_object_get(one, "ref"), *gl = json_object_get(one, "gl");
        const char *wrong = replay(gl, NULL);
        if (!wrong && (!json_equal(json_object_get(ref, "accum"), json_object_get(gl, "accum")) ||
                       !json_equal(json_object_get(ref, "final"), json_object_get(gl, "final"))))
            wrong = "gl ends elsewhere than ref";
        if (!wrong && json_array_size(json_object_get(ref, "blend")) !=
                          json_array_size(json_object_get(gl, "blend")))
            wrong = "gl has other steps than ref";
        if (!wrong)
            wrong = replay_truth(json_object_get(one, "truth"));
        if (wrong)
            failed |= printf("history %zu: %s\n", i, wrong) > 0;
    }
    if (json_array_size(all) == 0)
        return fail("no array of histories");
    json_decref(all);
    return failed;
}

int main(int argc, char **argv)
{
    if (argc == 6 && strcmp(argv[1], "pixels") == 0)
        return print_pixels(argv + 2);
    if (argc == 8 && strcmp(argv[1], "check") == 0)
        return check(argv + 2);
    if (argc == 3 && strcmp(argv[1], "sides") == 0)
        return check_sides(argv[2]);
    fprintf(stderr, "replay: expected pixels, check or sides\n");
    return 1;
}

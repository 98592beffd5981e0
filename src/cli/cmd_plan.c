/* peel plan: what a scene needs, and the cheapest settings that reach an error. */
#include "cli/bind.h"
#include "cli/options.h"
#include "frame/method.h"
#include "ref/pipeline/count.h"
#include "report/plan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct PlanCommand {
    RenderOptions render;
    const char *json;
    bool search, has_metric;
    double max_error;
    PlanMetric metric;
    char *kept; /* what of the command line stays whatever is chosen */
} PlanCommand;

enum {
    KEY_JSON = 0x200,
    KEY_MAX_ERROR,
    KEY_METRIC
};

static const struct argp_option command_options[] = {
    {"json", KEY_JSON, "FILE", 0, "Write all of it as JSON", 0},
    {"max-error", KEY_MAX_ERROR, "E", 0,
     "Find the cheapest method, passes, accumulation and G-buffer formats whose difference from "
     "truth on this scene is at most E, by measuring ref; those given as options stay",
     0},
    {"metric", KEY_METRIC, "max|rmse|p99", 0,
     "What E is of: max (default: the greatest difference of all pixels), rmse or p99 (the 99th "
     "percentile of the pixels' greatest)",
     0},
    {0},
};

static error_t parse_metric(const char *text, PlanMetric *out)
{
    for (int i = 0; i < PLAN_METRICS; i++)
        if (strcmp(text, plan_metric_name((PlanMetric)i)) == 0) {
            *out = (PlanMetric)i;
            return 0;
        }
    return options_error("--metric %s: expected max, rmse or p99", text);
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    PlanCommand *command = state->input;
    switch (key) {
    case KEY_JSON:
        command->json = argument;
        return 0;
    case KEY_MAX_ERROR:
        command->search = true;
        return options_real(argument, 0.0, 1e30, &command->max_error)
                   ? 0
                   : options_error("--max-error %s: expected a number from 0", argument);
    case KEY_METRIC:
        command->has_metric = true;
        return parse_metric(argument, &command->metric);
    case ARGP_KEY_SUCCESS:
        return command->has_metric && !command->search
                   ? options_error("--metric: expected --max-error E, of which it says what E is")
                   : 0;
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &command->render;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&options_render_argp, 0, NULL, 1}, {0}};
static const struct argp command_argp = {
    command_options,
    parse,
    "SCENE",
    "Says what SCENE (.gltf, .glb, or the name of a built-in scene) needs as it is asked for: "
    "layers in each pixel, passes of each method, buffers and their bytes, and what ref and gl "
    "leave out because it changes no bit. With --max-error, also the cheapest settings that reach "
    "an error.\vExit code 2 when no settings reach it.",
    children,
    NULL,
    NULL};

/* ---- the answer as a command ---- */

/* Whether word is one of the options that the answer has in another form, maybe shortened as
 * getopt allows. *value: its value is the next word. */
static bool is_replaced(const char *word, bool *value)
{
    static const char *const names[] = {"json",   "max-error", "metric", "method",
                                        "passes", "accum",     "gbuffer"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (options_is_long(word, names[i], value))
            return true;
    return false;
}

/* NULL without memory. */
static char *kept_arguments(int argc, char **argv)
{
    char **words = calloc((size_t)argc + 1, sizeof *words), empty[] = "";
    int count = 1;
    bool value = false, options = true;
    if (!words)
        return NULL;
    words[0] = empty;
    for (int i = 1; i < argc; i++) {
        options &= strcmp(argv[i], "--") != 0;
        if (options && is_replaced(argv[i], &value))
            i += value;
        else
            words[count++] = argv[i];
    }
    char *text = options_command_line(count, words);
    free(words);
    return text;
}

/* NULL without memory. */
static char *answer_command(const PlanCommand *command, const PlanChoice *choice)
{
    char *text = NULL, passes[16] = "auto";
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    if (choice->passes > 0)
        snprintf(passes, sizeof passes, "%d", choice->passes);
    fprintf(out, "build/peel render --method %s --passes %s --accum %s --gbuffer %s -o image.exr%s",
            method_info(choice->method)->name, passes, format_info(choice->accum)->name,
            gbuffer_name(choice->gbuffer), command->kept);
    return fclose(out) == 0 ? text : NULL;
}

/* ---- the work ---- */

static PlanRequest request_of(const PlanCommand *command)
{
    const RenderOptions *render = &command->render;
    PlanRequest request = {.metric = command->metric, .max_error = command->max_error};
    PlanSpace *space = &request.space;
    space->passes = render->has_passes ? render->desc.passes : -1;
    for (int i = 0; i < METHOD_COUNT; i++)
        space->methods[i] = !render->has_method || render->desc.method == (MethodId)i;
    for (int i = 0; i < PLAN_ACCUMS; i++)
        space->accums[i] =
            render->settings[SETTING_ACCUM] < 0 || render->settings[SETTING_ACCUM] == i;
    for (int i = 0; i < PLAN_GBUFFERS; i++)
        space->gbuffers[i] =
            render->settings[SETTING_GBUFFER] < 0 || render->settings[SETTING_GBUFFER] == i;
    if (render->settings[SETTING_GBUFFER] < 0 &&
        render->settings[SETTING_POSITION] == POSITION_BUFFER)
        space->gbuffers[GBUFFER_COMPACT] = false; /* it stores no positions */
    return request;
}

static Result not_reached(const PlanSearch *search)
{
    const PlanChoice *best = &search->choices[search->best];
    char passes[16] = "auto";
    if (best->passes > 0)
        snprintf(passes, sizeof passes, "%d", best->passes);
    return result_fail(RESULT_UNSUPPORTED,
                       "--max-error %g: no settings reach it (%s); the best, %s with passes %s, "
                       "accum %s and gbuffer %s, has %.4g",
                       search->max_error, plan_metric_name(search->metric),
                       method_info(best->method)->name, passes, format_info(best->accum)->name,
                       gbuffer_name(best->gbuffer), best->error);
}

/* *reached: not, where there is a message for it. */
static Result search(const PlanCommand *command, const Scene *scene, const Plan *plan,
                     bool *reached)
{
    PlanSearch found;
    PlanRequest request = request_of(command);
    char *answer = NULL;
    Result result = plan_search(scene, plan, &request, bind_renderers[RENDERER_REF],
                                bind_renderers[RENDERER_TRUTH], &found);
    if (result != RESULT_OK)
        return result;
    *reached = found.chosen >= 0;
    if (*reached) {
        answer = answer_command(command, &found.choices[found.chosen]);
        if (!answer)
            result = result_fail(RESULT_NO_MEMORY, "out of memory");
    }
    if (result == RESULT_OK) {
        report_plan_choices(&found, answer, stdout);
        fflush(stdout); /* before a --json /dev/stdout */
    }
    if (result == RESULT_OK && command->json)
        result = report_plan_json(plan, &found, answer, command->json);
    if (result == RESULT_OK && !*reached)
        not_reached(&found);
    free(answer);
    plan_search_free(&found);
    return result;
}

static Result run(PlanCommand *command, bool *reached)
{
    Scene scene;
    Plan plan;
    Result result = options_check_output(command->json);
    if (result == RESULT_OK)
        result = options_load_scene(&command->render, &scene);
    if (result != RESULT_OK)
        return result;
    if (command->search && render_desc_edges(&command->render.desc))
        result = result_fail(RESULT_BAD_INPUT, "--post edges: --max-error compares plain images, "
                                               "expected none");
    if (result == RESULT_OK)
        result = plan_run(&scene, command->render.scene_path, &command->render.desc, count_layers,
                          bind_renderers[RENDERER_REF], &plan);
    if (result == RESULT_OK) {
        report_plan_print(&plan, stdout);
        fflush(stdout);
        if (command->search)
            result = search(command, &scene, &plan, reached);
        else if (command->json)
            result = report_plan_json(&plan, NULL, NULL, command->json);
        plan_free(&plan);
    }
    scene_free(&scene);
    return result;
}

int cmd_plan(int argc, char **argv)
{
    PlanCommand command = {.render = options_default()};
    int code = options_parse(&command_argp, argc, argv, &command);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    bool reached = true;
    command.kept = kept_arguments(argc, argv);
    Result result =
        command.kept ? run(&command, &reached) : result_fail(RESULT_NO_MEMORY, "out of memory");
    free(command.kept);
    if (result != RESULT_OK)
        return options_fail(result);
    if (!reached)
        options_fail(RESULT_UNSUPPORTED); /* says which error */
    return reached ? EXIT_AGREE : EXIT_DIFFER;
}

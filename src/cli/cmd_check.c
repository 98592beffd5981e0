/* peel check: somebody's image, or their passes, against the reference. */
#include "base/memory.h"
#include "cli/bind.h"
#include "cli/options.h"
#include "cli/options_given.h"
#include "frame/method.h"
#include "report/check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct CheckCommand {
    RenderOptions render;
    const char *theirs, *json, *report;
    CheckFile *files;
    size_t file_count, file_capacity;
    GivenMeaning meaning;
    double tolerance;
    char *line;
} CheckCommand;

enum {
    KEY_LAYER = 0x200,
    KEY_DEPTH_FILE,
    KEY_TOLERANCE,
    KEY_BOUND,
    KEY_JSON,
    KEY_REPORT
};

static const struct argp_option command_options[] = {
    {"layer", KEY_LAYER, "K FILE", 0,
     "Also compare their accumulation after peel K (from 0), or with forward methods the layer's "
     "colour",
     0},
    {"depth", KEY_DEPTH_FILE, "K FILE", 0,
     "Also compare their window depths of peel K, or 'opaque': EXR with one channel, or PNG; with "
     "the name of a format instead, the setting below",
     0},
    {"tolerance", KEY_TOLERANCE, "T", 0,
     "Allowed difference of linear values, relative to max(1, value) (default: the method's); of "
     "depths 1e-6, whatever T is",
     0},
    {"bound", KEY_BOUND, 0, 0,
     "Allow each pixel what single precision may do to it instead, from truth", 0},
    {"json", KEY_JSON, "FILE", 0, "Write the figures as JSON", 0},
    {"report", KEY_REPORT, "DIR", 0, "Write a page with pictures to DIR/index.html", 0},
    {0},
};

/* K, and the next word of the line. */
static error_t parse_file(const char *option, bool depth, const char *text,
                          struct argp_state *state, CheckCommand *command)
{
    CheckFile file = {.peel = -1, .depth = depth};
    if (!depth || strcmp(text, "opaque") != 0) {
        error_t error = options_count(option, text, 0, PASSES_MAX - 1, &file.peel);
        if (error)
            return error;
    }
    if (state->next >= state->argc)
        return options_error("%s %s: expected a file behind it", option, text);
    file.path = options_input(state->argv[state->next++]);
    void *files = command->files;
    Result result = memory_grow(&files, &command->file_capacity, command->file_count + 1,
                                sizeof *command->files);
    command->files = files;
    if (result != RESULT_OK)
        return options_error("%s", result_message());
    command->files[command->file_count++] = file;
    return 0;
}

static error_t parse_argument(char *argument, CheckCommand *command)
{
    if (!command->render.scene_path)
        return ARGP_ERR_UNKNOWN; /* for the rendering options */
    if (command->theirs)
        return options_error("'%s': expected one image or trace, already given as '%s'", argument,
                             command->theirs);
    command->theirs = options_input(argument);
    return 0;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    CheckCommand *command = state->input;
    switch (key) {
    case KEY_LAYER:
        return parse_file("--layer", false, argument, state, command);
    case KEY_DEPTH_FILE:
        if (options_depth_format(argument, &command->render))
            return 0;
        return parse_file("--depth", true, argument, state, command);
    case KEY_TOLERANCE:
        return options_real(argument, 0.0, 1e30, &command->tolerance)
                   ? 0
                   : options_error("--tolerance %s: expected a number from 0", argument);
    case KEY_BOUND:
        command->render.desc.bound = true;
        return 0;
    case KEY_JSON:
        command->json = argument;
        return 0;
    case KEY_REPORT:
        command->report = argument;
        return 0;
    case ARGP_KEY_ARG:
        return parse_argument(argument, command);
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &command->render;
        state->child_inputs[1] = &command->meaning;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {
    {&options_render_argp, 0, NULL, 1}, {&options_given_argp, 0, NULL, 0}, {0}};
static const struct argp command_argp = {
    command_options,
    parse,
    "SCENE THEIRS",
    "Renders SCENE and compares an image (PNG or EXR), or the passes (a trace: EXR of peel render "
    "--trace, or what peel_dump.h writes), of another renderer with it.\vExit code 0 when they "
    "agree, 2 when they differ, 3 when sizes differ, 4 for files that cannot be read.",
    children,
    NULL,
    NULL};

static Result prepare(const CheckCommand *command)
{
    const RenderDesc *desc = &command->render.desc;
    if (!command->theirs && command->file_count == 0)
        return result_fail(RESULT_BAD_INPUT,
                           "check: nothing to compare; expected an image or a trace behind the "
                           "scene, --layer or --depth");
    if (command->render.all_methods)
        return result_fail(RESULT_BAD_INPUT, "--method all: expected one of them here");
    if (desc->bound && !command->theirs)
        return result_fail(RESULT_BAD_INPUT, "--bound: it is of colours in the end, expected an "
                                             "image or a trace behind the scene");
    if (desc->bound && !method_has_bound(desc))
        return result_fail(RESULT_BAD_INPUT, "--bound: there is none for --method %s",
                           method_info(desc->method)->name);
    return options_check_outputs(command->json, NULL, command->report);
}

static Result check(const CheckCommand *command, const Scene *scene, CheckReport *report,
                    CheckSizes *sizes)
{
    CheckDesc desc = {.scene_path = command->render.scene_path,
                      .theirs = command->theirs,
                      .files = command->files,
                      .file_count = command->file_count,
                      .meaning = command->meaning,
                      .tolerance = command->tolerance};
    Result result = prepare(command);
    if (result == RESULT_OK)
        result = check_run(scene, &command->render.desc, bind_renderers[RENDERER_REF],
                           bind_renderers[RENDERER_TRUTH], &desc, report, sizes);
    if (result != RESULT_OK)
        return result;
    report_check_print(report, stdout);
    fflush(stdout); /* before a --json /dev/stdout */
    if (command->json)
        result = report_check_json(report, command->json);
    if (result == RESULT_OK && command->report)
        result = report_check_html(report, command->line, command->report);
    return result;
}

int cmd_check(int argc, char **argv)
{
    CheckCommand command = {.render = options_default(), .tolerance = -1.0};
    CheckReport report = {0};
    CheckSizes sizes = CHECK_SIZES_EQUAL;
    Scene scene;
    command.line = options_command_line(argc, argv);
    int code = options_parse(&command_argp, argc, argv, &command);
    Result result = RESULT_OK;
    if (code == 0)
        result = command.line ? options_load_scene(&command.render, &scene)
                              : result_fail(RESULT_NO_MEMORY, "out of memory");
    if (code == 0 && result == RESULT_OK) {
        result = check(&command, &scene, &report, &sizes);
        scene_free(&scene);
        code = report.agree ? EXIT_AGREE : EXIT_DIFFER;
    }
    if (result != RESULT_OK) {
        code = options_fail(result);
        code = sizes == CHECK_SIZES_DIFFER ? EXIT_SIZES : code;
    }
    check_free(&report);
    free(command.files);
    free(command.line);
    return code == OPTIONS_HELPED ? EXIT_AGREE : code;
}

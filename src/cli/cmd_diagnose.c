/* peel diagnose: which known mistake explains somebody's image. */
#include "cli/bind.h"
#include "cli/options.h"
#include "cli/options_given.h"
#include "report/diagnose.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct DiagnoseCommand {
    RenderOptions render;
    GivenMeaning meaning;
    const char *image, *json, *report;
    bool list;
    char *line; /* the command, to be shown in the report */
} DiagnoseCommand;

enum {
    KEY_LIST = 0x200,
    KEY_JSON,
    KEY_REPORT
};

static const struct argp_option command_options[] = {
    {"list", KEY_LIST, 0, 0, "List the catalogue of mistakes, with causes and cures", 0},
    {"json", KEY_JSON, "FILE", 0, "Write the verdict and the ranking as JSON", 0},
    {"report", KEY_REPORT, "DIR", 0, "Write a page with pictures to DIR/index.html", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    DiagnoseCommand *command = state->input;
    switch (key) {
    case KEY_LIST:
        command->list = true;
        return 0;
    case KEY_JSON:
        command->json = argument;
        return 0;
    case KEY_REPORT:
        command->report = argument;
        return 0;
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &command->render;
        state->child_inputs[1] = &command->meaning;
        return 0;
    case ARGP_KEY_ARG:
        if (!command->render.scene_path || command->image)
            return ARGP_ERR_UNKNOWN; /* the first is the scene; a third is one too many */
        command->image = options_input(argument);
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
    "SCENE IMAGE\n--list",
    "Renders SCENE as it is and with every known mistake, and says which of them explains IMAGE "
    "(PNG or EXR), a rendering by another program with the same settings.\vExit code 0 when the "
    "image is right, 2 when a mistake explains it or nothing does, 3 when its size is another, 4 "
    "when it cannot be read.",
    children,
    NULL,
    NULL};

static Result check(const DiagnoseCommand *command)
{
    if (!command->image)
        return result_fail(RESULT_BAD_INPUT, "diagnose: expected a scene and an image, PNG or EXR");
    if (command->render.all_methods)
        return result_fail(RESULT_BAD_INPUT, "--method all: expected one of them here");
    return options_check_outputs(command->json, NULL, command->report);
}

static Result diagnose(const DiagnoseCommand *command, const Scene *scene, const GivenImage *given,
                       Diagnosis *out)
{
    const RenderDesc *desc = &command->render.desc;
    Result result =
        diagnose_run(scene, desc, given, &command->meaning, bind_renderers[RENDERER_REF], out);
    if (result != RESULT_OK)
        return result;
    DiagnoseSubject subject = {scene->name, command->render.scene_path, command->image, desc,
                               command->line};
    report_diagnose_print(&subject, out, stdout);
    fflush(stdout); /* before a --json /dev/stdout */
    if (command->json)
        result = report_diagnose_json(&subject, out, command->json);
    if (result == RESULT_OK && command->report)
        result = report_diagnose_html(&subject, out, command->report);
    if (result != RESULT_OK)
        diagnose_free(out);
    return result;
}

static int run(DiagnoseCommand *command)
{
    Scene scene;
    GivenImage given = {0};
    Diagnosis diagnosis = {0};
    int code = 0;
    const int size[] = {command->render.desc.width, command->render.desc.height};
    Result result = check(command);
    if (result == RESULT_OK)
        result = given_load(command->image, size, &given);
    if (result != RESULT_OK) {
        given_free(&given);
        return options_fail(result);
    }
    result = options_load_scene(&command->render, &scene);
    if (result == RESULT_OK) {
        code = options_given_size(command->image, &given, size[0], size[1]);
        result = code ? RESULT_OK : diagnose(command, &scene, &given, &diagnosis);
        scene_free(&scene);
    }
    given_free(&given);
    if (result != RESULT_OK)
        return options_fail(result);
    if (code == 0)
        code = diagnosis.verdict == DIAGNOSE_AGREES ? EXIT_AGREE : EXIT_DIFFER;
    diagnose_free(&diagnosis);
    return code;
}

static int list(const DiagnoseCommand *command)
{
    const GivenMeaning *meaning = &command->meaning;
    if (command->render.scene_path || command->image || command->json || command->report ||
        command->render.given || meaning->encoding || meaning->rows || meaning->alpha)
        return options_fail(result_fail(
            RESULT_BAD_INPUT, "diagnose --list: expected no scene, no image and no other option"));
    report_diagnose_list(stdout);
    return EXIT_AGREE;
}

int cmd_diagnose(int argc, char **argv)
{
    DiagnoseCommand command = {.render = options_default()};
    command.render.scene_optional = true; /* for --list */
    command.line = options_command_line(argc, argv);
    int code = options_parse(&command_argp, argc, argv, &command);
    if (code)
        code = code == OPTIONS_HELPED ? EXIT_AGREE : code;
    else if (command.list)
        code = list(&command);
    else if (!command.line)
        code = options_fail(result_fail(RESULT_NO_MEMORY, "out of memory"));
    else
        code = run(&command);
    free(command.line);
    return code;
}

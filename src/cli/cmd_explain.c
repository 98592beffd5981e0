/* peel explain: the algorithm step by step, as a page. */
#include "cli/bind.h"
#include "cli/explain_page.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct ExplainCommand {
    RenderOptions render;
    const char *output;
} ExplainCommand;

static const struct argp_option command_options[] = {
    {"output", 'o', "DIR", 0, "Write the page to DIR/index.html", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    ExplainCommand *command = state->input;
    switch (key) {
    case 'o':
        command->output = argument;
        return 0;
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &command->render;
        return 0;
    case ARGP_KEY_SUCCESS:
        return command->output ? 0
                               : options_error("explain: expected -o DIR, --pixel X,Y or --course");
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&options_render_argp, 0, NULL, 1}, {0}};
static const struct argp command_argp = {
    command_options,
    parse,
    "SCENE -o DIR",
    "Shows how SCENE (.gltf, .glb, or the name of a built-in scene) is rendered, step by step and "
    "down to one pixel's bits: writes a page that works from disk, with the pipeline in it. The "
    "image's size is 320x180 unless --size says otherwise. See also the --help of `peel explain "
    "--pixel 0,0`, one pixel's history in the terminal, and of `peel explain --course`.",
    children,
    NULL,
    NULL};

static Result run(ExplainCommand *command, const char *line)
{
    Scene scene;
    if (!line)
        return result_fail(RESULT_NO_MEMORY, "out of memory");
    if (command->render.all_methods)
        return result_fail(RESULT_BAD_INPUT, "--method all: expected one of them here");
    Result result = options_load_scene(&command->render, &scene);
    if (result != RESULT_OK)
        return result;
    result = options_open_directory(command->output);
    if (result == RESULT_OK)
        result = explain_page_write(
            &command->render, &scene,
            &(ExplainPage){.dir = command->output, .file = "index.html", .command = line}, NULL);
    scene_free(&scene);
    if (result == RESULT_OK)
        printf("%s/index.html\n", command->output);
    return result;
}

static bool has_option(int argc, char **argv, const char *option)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
        if (strncmp(argv[i], option, strlen(option)) == 0)
            return true;
    return false;
}

int cmd_explain(int argc, char **argv)
{
    bool page = has_option(argc, argv, "-o") || has_option(argc, argv, "--output");
    if (page && has_option(argc, argv, "--pixel")) {
        options_error("explain: --pixel prints to the terminal and -o writes a page: expected one");
        return EXIT_BAD_INPUT;
    }
    if (has_option(argc, argv, "--pixel"))
        return cmd_explain_pixel(argc, argv);
    if (has_option(argc, argv, "--course"))
        return cmd_explain_course(argc, argv);
    ExplainCommand command = {.render = options_default()};
    command.render.desc.width = 320;
    command.render.desc.height = 180;
    int code = options_parse(&command_argp, argc, argv, &command);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    char *line = options_command_line(argc, argv);
    Result result = run(&command, line);
    free(line);
    return result == RESULT_OK ? EXIT_AGREE : options_fail(result);
}

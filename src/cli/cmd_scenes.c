/* peel scenes: the built-in scenes, and what a renderer of others needs of a scene. */
#include "cli/bind.h"
#include "cli/options.h"
#include "gl/program.h"
#include "report/contract.h"
#include "scene/generate.h"
#include "scene/gltf.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct ScenesOptions {
    RenderOptions render;
    const char *output, *export;
    bool contract;
} ScenesOptions;

enum {
    KEY_EXPORT = 0x200,
    KEY_CONTRACT
};

static const struct argp_option scenes_options[] = {
    {"output", 'o', "FILE", 0, "Write the scene as .gltf (one file) or .glb", 0},
    {"export", KEY_EXPORT, "DIR", 0,
     "Write what another renderer needs to make the image that the rendering options ask for: the "
     "scene, matrices and lights as exact floats, the shading formula, headers and a page. NAME "
     "may "
     "be a file here",
     0},
    {"contract", KEY_CONTRACT, 0, 0, "With -o FILE: write that page alone, as HTML", 0},
    {0},
};

static error_t check_line(const ScenesOptions *options)
{
    const char *name = options->render.scene_path;
    if (options->contract)
        return options->output && !name && !options->export && !options->render.given
                   ? 0
                   : options_error("scenes --contract: expected -o FILE and nothing else");
    if (options->render.given && !options->export)
        return options_error("scenes: --%s says how a scene is rendered; expected --export, too",
                             options->render.given);
    if (options->render.all_methods)
        return options_error("scenes --export: --method all: expected a single method");
    if (options->output && options->export)
        return options_error("scenes --export: expected no -o beside it");
    if (name && !options->output && !options->export)
        return options_error("scenes %s: expected -o FILE or --export DIR", name);
    if (!name && (options->output || options->export))
        return options_error("scenes %s: expected the name of a scene",
                             options->output ? options->output : options->export);
    return 0;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    ScenesOptions *options = state->input;
    switch (key) {
    case 'o':
        options->output = argument;
        return 0;
    case KEY_EXPORT:
        options->export = argument;
        return 0;
    case KEY_CONTRACT:
        options->contract = true;
        return 0;
    case ARGP_KEY_INIT:
        options->render.scene_optional = true;
        state->child_inputs[0] = &options->render;
        return 0;
    case ARGP_KEY_SUCCESS:
        return check_line(options);
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&options_render_argp, 0, NULL, 1}, {0}};
static const struct argp scenes_argp = {scenes_options,
                                        parse,
                                        "[NAME -o FILE | NAME --export DIR]",
                                        "Lists the built-in scenes, writes one as glTF 2.0, or "
                                        "exports what another renderer needs. The "
                                        "files in data/scenes are made with -o.",
                                        children,
                                        NULL,
                                        NULL};

static int list(void)
{
    size_t count;
    const BuiltinScene *scenes = generate_table(&count);
    for (size_t i = 0; i < count; i++)
        printf("%-20s %s\n", scenes[i].name, scenes[i].summary);
    return EXIT_AGREE;
}

/* One built-in scene as it is, whatever the rendering options say. */
static Result write_scene(const char *name, const char *path)
{
    const BuiltinScene *builtin = generate_find(name);
    if (!builtin)
        return result_fail(RESULT_BAD_INPUT, "'%s' is no built-in scene; 'peel scenes' lists them",
                           name);
    Scene scene;
    Result result = builtin->generate(&scene);
    if (result == RESULT_OK) {
        result = gltf_write(&scene, path);
        scene_free(&scene);
    }
    return result;
}

/* The command that checks an image of what is exported: its rendering options are the words of this
 * one that are neither the scene nor --export and its folder. The caller frees. */
static char *check_command(const ScenesOptions *options, int argc, char **argv)
{
    static char command[] = "peel check", scene[] = "scene.gltf", theirs[] = "THEIRS";
    char **words = calloc((size_t)argc + 4, sizeof *words), *line = NULL;
    int count = 3;
    bool value = false;
    if (words) {
        words[0] = command;
        words[1] = scene;
        words[2] = theirs;
    }
    for (int i = 1; words && i < argc; i++) {
        if (options_is_long(argv[i], "export", &value))
            i += value;
        else if (argv[i] != options->render.scene_path)
            words[count++] = argv[i];
    }
    if (words)
        line = options_command_line(count, words);
    free(words);
    return line;
}

static Result export(ScenesOptions *options, char *line)
{
    char constants[PROGRAM_CONSTANTS];
    Scene scene;
    if (!line)
        return result_fail(RESULT_NO_MEMORY, "out of memory");
    Result result = options_load_scene(&options->render, &scene);
    if (result != RESULT_OK)
        return result;
    program_constants(constants);
    ContractDesc contract = {.name = scene.name,
                             .scene = &scene,
                             .desc = options->render.desc,
                             .check = strstr(line, "peel check"),
                             .glsl_constants = constants,
                             .glsl_shade = shader_shade};
    result = options_open_directory(options->export);
    if (result == RESULT_OK)
        result = report_contract_write(&contract, options->export);
    scene_free(&scene);
    return result;
}

int cmd_scenes(int argc, char **argv)
{
    ScenesOptions options = {.render = options_default()};
    int code = options_parse(&scenes_argp, argc, argv, &options);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    Result result = RESULT_OK;
    if (options.contract) {
        result = report_contract_page(options.output);
    } else if (options.export) {
        char *line = check_command(&options, argc, argv);
        result = export(&options, line);
        free(line);
    } else if (options.output) {
        result = write_scene(options.render.scene_path, options.output);
    } else {
        return list();
    }
    return result == RESULT_OK ? EXIT_AGREE : options_fail(result);
}

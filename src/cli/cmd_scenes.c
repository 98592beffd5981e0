/* peel scenes: the built-in scenes. */
#include "cli/bind.h"
#include "cli/options.h"
#include "scene/generate.h"
#include "scene/gltf.h"

#include <stdio.h>

typedef struct ScenesOptions {
    const char *name, *output;
} ScenesOptions;

static const struct argp_option scenes_options[] = {
    {"output", 'o', "FILE", 0, "Write the scene as .gltf (one file) or .glb", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    ScenesOptions *options = state->input;
    switch (key) {
    case 'o':
        options->output = argument;
        return 0;
    case ARGP_KEY_ARG:
        if (options->name)
            return options_error("'%s': expected one scene, already given as '%s'", argument,
                                 options->name);
        options->name = argument;
        return 0;
    case ARGP_KEY_SUCCESS:
        if (options->name && !options->output)
            return options_error("scenes %s: expected -o FILE", options->name);
        if (options->output && !options->name)
            return options_error("scenes -o %s: expected the name of a scene", options->output);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp scenes_argp = {
    scenes_options,
    parse,
    "[NAME -o FILE]",
    "Lists the built-in scenes, or writes one as glTF 2.0. The files in data/scenes are made so.",
    NULL,
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

int cmd_scenes(int argc, char **argv)
{
    ScenesOptions options = {0};
    int code = options_parse(&scenes_argp, argc, argv, &options);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    if (!options.name)
        return list();
    const BuiltinScene *builtin = generate_find(options.name);
    if (!builtin)
        return options_fail(result_fail(
            RESULT_BAD_INPUT, "'%s' is no built-in scene; 'peel scenes' lists them", options.name));
    Scene scene;
    Result result = builtin->generate(&scene);
    if (result == RESULT_OK) {
        result = gltf_write(&scene, options.output);
        scene_free(&scene);
    }
    return result == RESULT_OK ? EXIT_AGREE : options_fail(result);
}

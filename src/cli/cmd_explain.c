/* peel explain: the algorithm step by step, as a page. */
#include "base/progress.h"
#include "cli/bind.h"
#include "cli/options.h"
#include "report/explain.h"

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
        return command->output ? 0 : options_error("explain: expected -o DIR or --pixel X,Y");
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
    "image's size is 320x180 unless --size says otherwise.",
    children,
    NULL,
    NULL};

/* ---- the page ---- */

typedef struct Sides {
    Frame frames[RENDERER_COUNT];
    TraceStore *traces[RENDERER_COUNT];
    char missing[RENDERER_COUNT][256]; /* why there is no frame; "" where there is one */
} Sides;

static Result render(const Scene *scene, const RenderDesc *desc, int renderer, Sides *sides)
{
    TraceStore **trace = &sides->traces[renderer];
    Result result = renderer == RENDERER_TRUTH ? RESULT_OK : store_create(0, trace);
    if (result != RESULT_OK)
        return result;
    if (*trace)
        store_sink(*trace)->details = true;
    progress_begin(threeway_renderer_name(renderer), 0);
    result = bind_renderers[renderer](scene, desc, *trace ? store_sink(*trace) : NULL,
                                      &sides->frames[renderer]);
    progress_end();
    return result;
}

/* The page can do without gl or the truth, and then says why. */
static Result render_beside(const RenderOptions *options, const Scene *scene,
                            const RenderDesc *desc, int renderer, Sides *sides)
{
    Result result = renderer == RENDERER_GL ? options_check_fma(options) : RESULT_OK;
    if (result == RESULT_OK)
        result = render(scene, desc, renderer, sides);
    if (result != RESULT_NO_GL && result != RESULT_UNSUPPORTED)
        return result;
    snprintf(sides->missing[renderer], sizeof sides->missing[renderer], "%s", result_message());
    return RESULT_OK;
}

/* gl first: where nobody says so, ref fuses as the driver does. */
static Result render_all(const RenderOptions *options, const Scene *scene, RenderDesc *desc,
                         Sides *sides)
{
    Result result = render_beside(options, scene, desc, RENDERER_GL, sides);
    if (result == RESULT_OK && !sides->missing[RENDERER_GL][0])
        desc->unfused = !sides->frames[RENDERER_GL].fused;
    if (result == RESULT_OK)
        result = render(scene, desc, RENDERER_REF, sides);
    if (result == RESULT_OK)
        result = render_beside(options, scene, desc, RENDERER_TRUTH, sides);
    return result;
}

static ExplainSide side_of(const Sides *sides, int renderer)
{
    bool missing = sides->missing[renderer][0];
    return (ExplainSide){.frame = missing ? NULL : &sides->frames[renderer],
                         .trace = sides->traces[renderer],
                         .missing = sides->missing[renderer]};
}

static Result write(const ExplainCommand *command, const Scene *scene, const char *line)
{
    Sides sides = {0};
    RenderDesc desc = command->render.desc;
    Result result = render_all(&command->render, scene, &desc, &sides);
    if (result == RESULT_OK) {
        ExplainDesc explain = {.name = scene->name ? scene->name : command->render.scene_path,
                               .command = line,
                               .scene = scene,
                               .desc = desc,
                               .ref = side_of(&sides, RENDERER_REF),
                               .gl = side_of(&sides, RENDERER_GL),
                               .truth = side_of(&sides, RENDERER_TRUTH)};
        result = report_explain_write(&explain, command->output);
    }
    for (int i = 0; i < RENDERER_COUNT; i++) {
        frame_free(&sides.frames[i]);
        store_destroy(sides.traces[i]);
    }
    return result;
}

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
        result = write(command, &scene, line);
    scene_free(&scene);
    if (result == RESULT_OK)
        printf("%s/index.html\n", command->output);
    return result;
}

static bool asks_for_pixel(int argc, char **argv)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
        if (strncmp(argv[i], "--pixel", strlen("--pixel")) == 0)
            return true;
    return false;
}

int cmd_explain(int argc, char **argv)
{
    if (asks_for_pixel(argc, argv))
        return cmd_explain_pixel(argc, argv);
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

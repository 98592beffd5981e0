/* peel explain --pixel: what one pixel went through, down to the bits. */
#include "base/file.h"
#include "base/memory.h"
#include "base/progress.h"
#include "cli/bind.h"
#include "cli/options.h"
#include "cli/terminal.h"
#include "ref/pipeline/retrace.h"
#include "ref/truth/pixel_truth.h"
#include "report/history.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct PixelCommand {
    RenderOptions render;
    const char *json;
    PixelTrace *pixels; /* gl's buffers there */
    size_t pixel_count, pixel_room;
    bool wanted[RENDERER_COUNT], chosen;
} PixelCommand;

/* What the renderers keep between pixels. */
typedef struct Work {
    const PixelCommand *command;
    const Scene *scene;
    RenderDesc desc;
    Retrace *retrace;
    PixelTruth *truth;
    Frame gl;
    char missing[256]; /* why there is no gl */
} Work;

enum {
    KEY_PIXEL = 0x200,
    KEY_JSON,
    KEY_RENDERERS,
    NARROWEST = 80 /* columns */
};

static const struct argp_option command_options[] = {
    {"pixel", KEY_PIXEL, "X,Y", 0,
     "The pixel, from the top left; given more than once, all of them", 0},
    {"json", KEY_JSON, "FILE", 0,
     "Write it as JSON instead; more than one pixel as an array. Numbers are hexadecimal floats",
     0},
    {"renderers", KEY_RENDERERS, "LIST", 0, "Which of ref,gl,truth (default all)", 0},
    {0},
};

static error_t parse_pixel(const char *text, PixelCommand *command)
{
    int x, y;
    if (!options_pair(text, ',', 0, &x, &y))
        return options_error("--pixel %s: expected X,Y, counted from the top left", text);
    void *array = command->pixels;
    Result result = memory_grow(&array, &command->pixel_room, command->pixel_count + 1,
                                sizeof *command->pixels);
    command->pixels = array;
    if (result != RESULT_OK)
        return options_error("--pixel: out of memory");
    command->pixels[command->pixel_count++] = pixel_trace_of(x, y);
    return 0;
}

static error_t parse_renderer(const char *part, void *context)
{
    PixelCommand *command = context;
    int renderer = bind_find_renderer(part);
    if (renderer < 0)
        return options_error("--renderers %s: expected some of ref,gl,truth", part);
    command->wanted[renderer] = true;
    return 0;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    PixelCommand *command = state->input;
    switch (key) {
    case KEY_PIXEL:
        return parse_pixel(argument, command);
    case KEY_JSON:
        command->json = argument;
        return 0;
    case KEY_RENDERERS:
        memset(command->wanted, 0, sizeof command->wanted);
        return options_list("renderers", argument, parse_renderer, command);
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
    "SCENE --pixel X,Y",
    "Prints what one pixel of SCENE went through: every fragment and what became of it, every "
    "blend step with its bits, and the results of ref, gl and truth beside each other.",
    children,
    NULL,
    NULL};

/* ---- the work ---- */

/* Opened by its name it could not be a socket, which is what some programs give their children. */
static bool is_standard_output(const char *path)
{
    return path && strcmp(path, "/dev/stdout") == 0;
}

static Result check(const PixelCommand *command)
{
    const RenderDesc *desc = &command->render.desc;
    if (command->render.all_methods)
        return result_fail(RESULT_BAD_INPUT, "--method all: expected one of them here");
    for (size_t i = 0; i < command->pixel_count; i++) {
        const PixelTrace *pixel = &command->pixels[i];
        if (pixel->x < 0 || pixel->y < 0 || pixel->x >= desc->width || pixel->y >= desc->height)
            return result_fail(RESULT_BAD_INPUT,
                               "--pixel %d,%d: expected 0,0 to %d,%d, from the top left", pixel->x,
                               pixel->y, desc->width - 1, desc->height - 1);
    }
    return is_standard_output(command->json) ? RESULT_OK : options_check_output(command->json);
}

/* gl first: where nobody says so, ref fuses as the driver does. It can be missing. */
static Result render_gl(Work *work)
{
    const PixelCommand *command = work->command;
    if (!command->wanted[RENDERER_GL])
        return RESULT_OK;
    PixelFan fan = pixel_fan_of(command->pixels, command->pixel_count);
    Result result = options_check_fma(&command->render);
    progress_begin("gl", 0);
    if (result == RESULT_OK)
        result = bind_renderers[RENDERER_GL](work->scene, &work->desc, &fan.sink, &work->gl);
    progress_end();
    if (result == RESULT_OK)
        work->desc.unfused = !work->gl.fused;
    if (result != RESULT_NO_GL && result != RESULT_UNSUPPORTED)
        return result;
    snprintf(work->missing, sizeof work->missing, "%s", result_message());
    return RESULT_OK;
}

static Result begin(Work *work)
{
    const PixelCommand *command = work->command;
    Result result = render_gl(work);
    if (result == RESULT_OK && (command->wanted[RENDERER_REF] || work->gl.final.pixels))
        result = retrace_open(work->scene, &work->desc, &work->retrace);
    if (result == RESULT_OK && command->wanted[RENDERER_TRUTH])
        result = pixel_truth_open(work->scene, &work->desc, &work->truth);
    return result;
}

static void end(Work *work)
{
    frame_free(&work->gl);
    retrace_close(work->retrace);
    pixel_truth_close(work->truth);
}

/* ---- output ---- */

static void put_json(const Work *work, const History histories[RENDERER_COUNT], Text *out)
{
    bool first = true;
    text_print(out, "{");
    for (int i = 0; i < RENDERER_COUNT; i++) {
        if (!work->command->wanted[i])
            continue;
        text_print(out, "%s\"%s\":", first ? "" : ",", threeway_renderer_name(i));
        first = false;
        if (histories[i].renderer)
            history_json(&histories[i], work->scene, out);
        else
            text_print(out, "null");
    }
    text_print(out, "}");
}

static Result print(const Work *work, const History histories[RENDERER_COUNT])
{
    const History *sides[RENDERER_COUNT];
    for (int i = 0; i < RENDERER_COUNT; i++)
        sides[i] = histories[i].renderer ? &histories[i] : NULL;
    const HistorySides all = {.scene_name = work->scene->name ? work->scene->name : "",
                              .scene = work->scene,
                              .width = work->desc.width,
                              .height = work->desc.height,
                              .ref = sides[RENDERER_REF],
                              .gl = sides[RENDERER_GL],
                              .truth = sides[RENDERER_TRUTH],
                              .missing = work->missing[0] ? work->missing : NULL};
    const HistoryStyle style = {terminal_columns(NARROWEST), terminal_has_colour()};
    return report_history(&all, style, stdout);
}

/* json: NULL to print. */
static Result tell(Work *work, const PixelTrace *pixel, Text *json)
{
    const PixelCommand *command = work->command;
    History histories[RENDERER_COUNT] = {0};
    Result result = RESULT_OK;
    if (command->wanted[RENDERER_REF])
        result = retrace_pixel(work->retrace, pixel->x, pixel->y, &histories[RENDERER_REF]);
    if (result == RESULT_OK && work->gl.final.pixels)
        result = retrace_traced(work->retrace, "gl", pixel, &work->gl, &histories[RENDERER_GL]);
    if (result == RESULT_OK && command->wanted[RENDERER_TRUTH])
        result = pixel_truth_history(work->truth, pixel->x, pixel->y, &histories[RENDERER_TRUTH]);
    if (result == RESULT_OK && json)
        put_json(work, histories, json);
    else if (result == RESULT_OK)
        result = print(work, histories);
    for (int i = 0; i < RENDERER_COUNT; i++)
        history_free(&histories[i]);
    return result;
}

static Result write_json(const char *path, const Text *json)
{
    FileWriter writer;
    if (json->result != RESULT_OK)
        return json->result;
    if (is_standard_output(path)) {
        fwrite(json->bytes, 1, json->count, stdout); /* main looks for errors */
        return RESULT_OK;
    }
    Result result = file_writer_open(path, &writer);
    if (result != RESULT_OK)
        return result;
    result = file_writer_put(&writer, json->bytes, json->count);
    Result closed = file_writer_close(&writer, result == RESULT_OK);
    return result == RESULT_OK ? closed : result;
}

static Result tell_all(Work *work)
{
    const PixelCommand *command = work->command;
    bool many = command->pixel_count > 1;
    Text json = {0};
    Result result = RESULT_OK;
    text_print(&json, many ? "[" : "");
    for (size_t i = 0; i < command->pixel_count && result == RESULT_OK; i++) {
        if (i > 0 && command->json)
            text_print(&json, ",\n");
        else if (i > 0)
            printf("\n");
        result = tell(work, &command->pixels[i], command->json ? &json : NULL);
    }
    text_print(&json, many ? "]\n" : "\n");
    if (result == RESULT_OK && command->json)
        result = write_json(command->json, &json);
    text_free(&json);
    return result;
}

static Result run(PixelCommand *command)
{
    Scene scene;
    Result result = options_load_scene(&command->render, &scene);
    if (result != RESULT_OK)
        return result;
    Work work = {.command = command, .scene = &scene, .desc = command->render.desc};
    result = check(command);
    if (result == RESULT_OK)
        result = begin(&work);
    if (result == RESULT_OK)
        result = tell_all(&work);
    end(&work);
    scene_free(&scene);
    return result;
}

int cmd_explain_pixel(int argc, char **argv)
{
    PixelCommand command = {.render = options_default(), .wanted = {true, true, true}};
    int code = options_parse(&command_argp, argc, argv, &command);
    Result result = code ? RESULT_OK : run(&command);
    for (size_t i = 0; i < command.pixel_count; i++)
        pixel_trace_free(&command.pixels[i]);
    free(command.pixels);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    return result == RESULT_OK ? EXIT_AGREE : options_fail(result);
}

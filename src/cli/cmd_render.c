/* peel render: one renderer to an image file, and every buffer to a trace. */
#include "base/memory.h"
#include "base/progress.h"
#include "cli/bind.h"
#include "cli/options.h"
#include "compare/store.h"
#include "frame/mutation.h"
#include "image/exr.h"
#include "image/exr_deep.h"
#include "image/png.h"
#include "ref/truth/truth.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct RenderCommand {
    RenderOptions render;
    int renderer;
    const char *output, *trace;
    bool deep;
} RenderCommand;

enum {
    KEY_WITH = 0x200,
    KEY_TRACE,
    KEY_DEEP,
    KEY_MUTATE
};

static const struct argp_option command_options[] = {
    {"with", KEY_WITH, "ref|gl|truth", 0, "Renderer: ref (default), gl or truth", 0},
    {"output", 'o', "FILE", 0,
     "PNG: display-transformed; EXR: linear R, G, B over the background, A = coverage", 0},
    {"trace", KEY_TRACE, "FILE", 0, "Every buffer of every step as one multi-part EXR", 0},
    {"deep", KEY_DEEP, 0, 0, "With truth and EXR: every fragment of every pixel, front to back", 0},
    {"mutate", KEY_MUTATE, "NAME[,NAME...]", 0,
     "With ref and method peel or forward: makes known mistakes, to see what they look like "
     "(teaching, testing); peel diagnose --list has their names",
     0},
    {0},
};

static error_t parse_mutation(const char *name, void *context)
{
    RenderDesc *desc = context;
    MutationId id = mutation_find(name);
    if (id == MUTATION_COUNT)
        return options_error("--mutate %s: expected known mistakes; peel diagnose --list has them",
                             name);
    desc->mutations |= mutation_bit(id);
    return 0;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    RenderCommand *command = state->input;
    switch (key) {
    case KEY_WITH:
        command->renderer = bind_find_renderer(argument);
        return command->renderer >= 0
                   ? 0
                   : options_error("--with %s: expected ref, gl or truth", argument);
    case 'o':
        command->output = argument;
        return options_has_extension(argument, ".png") || options_has_extension(argument, ".exr")
                   ? 0
                   : options_error("-o %s: expected a name ending in .png or .exr", argument);
    case KEY_TRACE:
        command->trace = argument;
        return options_has_extension(argument, ".exr")
                   ? 0
                   : options_error("--trace %s: expected a name ending in .exr", argument);
    case KEY_DEEP:
        command->deep = true;
        return 0;
    case KEY_MUTATE:
        return options_list("--mutate", argument, parse_mutation, &command->render.desc);
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &command->render;
        return 0;
    case ARGP_KEY_SUCCESS:
        return command->output || command->trace ? 0 : options_error("render: expected -o FILE");
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&options_render_argp, 0, NULL, 1}, {0}};
static const struct argp command_argp = {
    command_options,
    parse,
    "SCENE -o FILE",
    "Renders SCENE (.gltf, .glb, or the name of a built-in scene) with one renderer.",
    children,
    NULL,
    NULL};

static Result write_parts(const TraceStore *store, ExrWriter *writer)
{
    for (int i = 0; i < store_count(store); i++) {
        Image image;
        Result result = store_image(store, i, &image);
        if (result == RESULT_OK) {
            result = exr_writer_part(writer, &image);
            image_free(&image);
        }
        if (result != RESULT_OK)
            return result;
    }
    return RESULT_OK;
}

static Result write_trace(const TraceStore *store, const char *path)
{
    int count = store_count(store);
    ExrPart *parts = memory_array((size_t)count, sizeof *parts);
    if (!parts)
        return RESULT_NO_MEMORY;
    for (int i = 0; i < count; i++) {
        const StoredBuffer *buffer = store_buffer(store, i);
        parts[i] = (ExrPart){buffer->name, buffer->format, buffer->width, buffer->height};
    }
    ExrWriter *writer;
    Result result = exr_writer_open(path, parts, count, &writer);
    if (result == RESULT_OK) {
        result = write_parts(store, writer);
        Result closed = exr_writer_close(writer, result == RESULT_OK);
        result = result == RESULT_OK ? closed : result;
    }
    free(parts);
    return result;
}

static Result check_mutations(const RenderCommand *command)
{
    if (command->render.desc.mutations && command->renderer != RENDERER_REF)
        return result_fail(RESULT_BAD_INPUT, "--mutate: expected --with ref, not %s",
                           threeway_renderer_name(command->renderer));
    return RESULT_OK;
}

static Result check_deep(const RenderCommand *command)
{
    if (!command->deep)
        return RESULT_OK;
    if (command->renderer != RENDERER_TRUTH)
        return result_fail(RESULT_BAD_INPUT, "--deep: expected --with truth, not %s",
                           threeway_renderer_name(command->renderer));
    if (command->trace)
        return result_fail(RESULT_BAD_INPUT, "--deep: expected no --trace beside it");
    if (!options_has_extension(command->output, ".exr"))
        return result_fail(RESULT_BAD_INPUT, "--deep: -o %s: expected a name ending in .exr",
                           command->output);
    return RESULT_OK;
}

/* What can be known before the work. */
static Result check(const RenderCommand *command)
{
    if (command->render.all_methods)
        return result_fail(RESULT_BAD_INPUT, "--method all: expected one of them here");
    Result result = check_mutations(command);
    if (result == RESULT_OK)
        result = check_deep(command);
    if (result == RESULT_OK)
        result = options_check_outputs(command->output, command->trace, NULL);
    if (result == RESULT_OK && command->renderer == RENDERER_GL)
        result = options_check_fma(&command->render);
    return result;
}

static Result render(const RenderCommand *command, const Scene *scene, TraceStore *store,
                     Frame *out)
{
    const RenderDesc *desc = &command->render.desc;
    progress_begin(threeway_renderer_name(command->renderer), 0);
    Result result =
        bind_renderers[command->renderer](scene, desc, store ? store_sink(store) : NULL, out);
    progress_end();
    if (result != RESULT_OK)
        return result;
    bool png = command->output && options_has_extension(command->output, ".png");
    if (png) {
        image_free(&out->final); /* room for the file */
        result = png_write(&out->display, command->output);
    } else if (command->output) {
        result = exr_write(&out->final, command->output);
    }
    if (result == RESULT_OK && store)
        result = write_trace(store, command->trace);
    if (result != RESULT_OK)
        frame_free(out);
    return result;
}

static Result render_deep(const RenderCommand *command, const Scene *scene, Frame *out)
{
    DeepImage deep;
    progress_begin("truth", 0);
    Result result = truth_render_deep(scene, &command->render.desc, &deep, out);
    progress_end();
    if (result != RESULT_OK)
        return result;
    result = exr_deep_write(&deep, command->output);
    if (result == RESULT_OK)
        printf("deep: %llu samples, %u in one pixel\n", (unsigned long long)deep.sample_count,
               deep_most(&deep));
    else
        frame_free(out);
    deep_free(&deep);
    return result;
}

static void print_summary(const RenderCommand *command, const Frame *frame)
{
    printf("%s: %dx%d, %d peels, %.1f ms (cpu %.1f ms, %d threads), %.1f MiB\n",
           threeway_renderer_name(command->renderer), frame->display.width, frame->display.height,
           frame->peels, frame->time_ms, frame->cpu_ms, frame->threads,
           (double)frame->buffer_bytes / (1 << 20));
    if (frame->residual_pixels)
        printf("pass limit: transmittance up to %.6g remains in front of %llu fragments in "
               "%llu pixels\n",
               frame->residual_max, (unsigned long long)frame->layers.lost_to_pass_limit,
               (unsigned long long)frame->residual_pixels);
    const LayerStats *layers = &frame->layers;
    if (command->renderer == RENDERER_TRUTH)
        printf(
            "order: %llu comparisons, %llu of them in exact arithmetic, %llu ties, %llu undecided; "
            "coverage: %llu in exact arithmetic\n",
            (unsigned long long)layers->comparisons, (unsigned long long)layers->exact_comparisons,
            (unsigned long long)layers->ties, (unsigned long long)layers->undecided,
            (unsigned long long)layers->exact_coverage);
}

int cmd_render(int argc, char **argv)
{
    RenderCommand command = {.render = options_default()};
    int code = options_parse(&command_argp, argc, argv, &command);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    Scene scene;
    Frame frame;
    TraceStore *store = NULL;
    Result result = options_load_scene(&command.render, &scene);
    if (result != RESULT_OK)
        return options_fail(result);
    result = check(&command);
    if (result == RESULT_OK && command.trace)
        result = store_create(0, &store);
    if (result == RESULT_OK)
        result = command.deep ? render_deep(&command, &scene, &frame)
                              : render(&command, &scene, store, &frame);
    if (result == RESULT_OK) {
        print_summary(&command, &frame);
        frame_free(&frame);
    }
    store_destroy(store);
    scene_free(&scene);
    return result == RESULT_OK ? EXIT_AGREE : options_fail(result);
}

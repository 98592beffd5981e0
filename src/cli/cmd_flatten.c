/* peel flatten: a deep image to a flat one. */
#include "cli/bind.h"
#include "cli/options.h"
#include "image/exr.h"
#include "image/exr_deep.h"
#include "image/png.h"
#include "ref/truth/radiance.h"

#include <stdio.h>

typedef struct FlattenOptions {
    const char *input, *output;
    size_t max_memory;
} FlattenOptions;

enum {
    KEY_MEMORY = 0x300
};

static const struct argp_option flatten_options[] = {
    {"output", 'o', "FILE", 0,
     "EXR: linear, premultiplied R, G, B over black, A = coverage; PNG: display-transformed", 0},
    {"max-memory", KEY_MEMORY, "BYTES", 0, "Refuse to need more for the samples (default 4G)", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    FlattenOptions *options = state->input;
    switch (key) {
    case 'o':
        options->output = argument;
        return options_has_extension(argument, ".png") || options_has_extension(argument, ".exr")
                   ? 0
                   : options_error("-o %s: expected a name ending in .png or .exr", argument);
    case KEY_MEMORY:
        return options_memory(argument, &options->max_memory);
    case ARGP_KEY_ARG:
        if (options->input)
            return options_error("'%s': expected one file, already given as '%s'", argument,
                                 options->input);
        options->input = options_input(argument);
        return 0;
    case ARGP_KEY_SUCCESS:
        if (!options->input)
            return options_error("flatten: expected a deep EXR file");
        return options->output ? 0 : options_error("flatten: expected -o FILE");
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp flatten_argp = {
    flatten_options,
    parse,
    "FILE -o FILE",
    "Composites the samples of a deep EXR front to back over black, in double precision. The file "
    "may be another program's: scanlines with channels R, G, B, A and Z.",
    NULL,
    NULL,
    NULL};

static Result write_display(const Image *flat, const char *path)
{
    Image display;
    Result result = image_create(flat->width, flat->height, FORMAT_RGBA8, &display);
    if (result != RESULT_OK)
        return result;
    size_t pixels = (size_t)flat->width * (size_t)flat->height;
    for (size_t i = 0; i < 4 * pixels; i++)
        ((uint8_t *)display.pixels)[i] =
            i % 4 == 3 ? 255 : radiance_display((double)((float *)flat->pixels)[i]);
    result = png_write(&display, path);
    image_free(&display);
    return result;
}

static Result flatten(const FlattenOptions *options)
{
    DeepImage deep;
    Image flat = {0};
    size_t limit = options->max_memory ? options->max_memory : RENDER_MEMORY_DEFAULT;
    Result result = options_check_output(options->output);
    if (result == RESULT_OK)
        result = exr_deep_read(options->input, limit, &deep);
    if (result != RESULT_OK)
        return result;
    result = deep_room(&deep, (size_t)deep.width * (size_t)deep.height *
                                  format_pixel_bytes(FORMAT_RGBA32F));
    if (result == RESULT_OK)
        result = deep_flatten(&deep, &flat);
    if (result == RESULT_OK)
        result = options_has_extension(options->output, ".png")
                     ? write_display(&flat, options->output)
                     : exr_write_at(&flat, deep.has_window ? &deep.window : NULL, options->output);
    if (result == RESULT_OK)
        printf("%s: %dx%d pixels, %llu samples, %u in one pixel\n", options->input, deep.width,
               deep.height, (unsigned long long)deep.sample_count, deep_most(&deep));
    image_free(&flat);
    deep_free(&deep);
    return result;
}

int cmd_flatten(int argc, char **argv)
{
    FlattenOptions options = {0};
    int code = options_parse(&flatten_argp, argc, argv, &options);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    Result result = flatten(&options);
    return result == RESULT_OK ? EXIT_AGREE : options_fail(result);
}

/* peel diff: two images, deep images or traces. */
#include "cli/bind.h"
#include "cli/options.h"
#include "compare/diff_files.h"
#include "image/exr_planes.h"
#include "image/png.h"
#include "report/diff.h"
#include "report/heatmap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct DiffCommand {
    RenderOptions render; /* with --scene */
    DiffFilesOptions files;
    const char *paths[DIFF_SIDES];
    const char *scene, *output, *json;
    double scale;
    bool magnitude, only_if_different, quiet, verbose;
} DiffCommand;

enum {
    KEY_FAIL = 0x300,
    KEY_FAIL_RELATIVE,
    KEY_FAIL_PERCENT,
    KEY_HARD_FAIL,
    KEY_ALLOW,
    KEY_WARN,
    KEY_WARN_RELATIVE,
    KEY_WARN_PERCENT,
    KEY_HARD_WARN,
    KEY_ONLY_IF_DIFFERENT,
    KEY_ABS,
    KEY_SCALE,
    KEY_WORST,
    KEY_CHANNELS,
    KEY_JSON,
    KEY_SCENE,
    WORST_DEFAULT = 5
};

static const struct argp_option command_options[] = {
    {0, 0, 0, 0, "Thresholds, as idiff has them (a single dash will do: -fail 0.01):", 1},
    {"fail", KEY_FAIL, "VAL", 0, "Failure threshold of the absolute difference (default 1e-6)", 1},
    {"failrelative", KEY_FAIL_RELATIVE, "VAL", 0,
     "Failure threshold relative to the mean magnitude; both must be exceeded (default 0)", 1},
    {"failpercent", KEY_FAIL_PERCENT, "PERCENT", 0, "Allow so many pixels over it (default 0)", 1},
    {"hardfail", KEY_HARD_FAIL, "VAL", 0, "Fail if any value exceeds this (default inf)", 1},
    {"allowfailures", KEY_ALLOW, "N", 0, "N pixels may be over the thresholds (default 0)", 1},
    {"warn", KEY_WARN, "VAL", 0,
     "Warning threshold (default 1e-6, but without any of these options only where a pixel is over "
     "the failure threshold, too)",
     1},
    {"warnrelative", KEY_WARN_RELATIVE, "VAL", 0, "Relative warning threshold (default 0)", 1},
    {"warnpercent", KEY_WARN_PERCENT, "PERCENT", 0, "Allow so many pixels over it (default 0)", 1},
    {"hardwarn", KEY_HARD_WARN, "VAL", 0, "Warn if any value exceeds this (default inf)", 1},
    {0, 0, 0, 0, "What is compared:", 2},
    {"all", 'a', 0, 0, "All parts, by name (of two traces always); else the first", 2},
    {"channels", KEY_CHANNELS, "R,G,B", 0, "These channels alone; both files must have them", 2},
    {"perceptual", 'p', 0, 0,
     "Also whether a person would see it (Yee 2004), where there are R, G and B", 2},
    {0, 0, 0, 0, "What is said:", 3},
    {"verbose", 'v', 0, 0, "The figures of parts that pass, too", 3},
    {"quiet", 'q', 0, 0, "Nothing: the exit code says it", 3},
    {"output", 'o', "FILE", 0,
     "Of the first part that differs: PNG, a heat map of each pixel's greatest difference (black "
     "equal, then 1e-8 to 1 on a logarithmic scale, magenta not finite); EXR, A - B of every "
     "channel",
     3},
    {"od", KEY_ONLY_IF_DIFFERENT, 0, 0, "Write -o only if something differs", 3},
    {"abs", KEY_ABS, 0, 0, "In an EXR the absolute difference", 3},
    {"scale", KEY_SCALE, "FACTOR", 0, "Multiply what -o writes (default 1)", 3},
    {"worst", KEY_WORST, "N", 0, "So many of the worst pixels (default 5)", 3},
    {"json", KEY_JSON, "FILE", 0, "Every figure", 3},
    {"scene", KEY_SCENE, "SCENE", 0,
     "What A or B shows, with the options below (its size is the images'): the class of each "
     "pixel that differs, why ref is not truth there",
     4},
    {0},
};

static error_t parse_real(const char *name, const char *text, double *out)
{
    return options_real(text, 0.0, (double)INFINITY, out)
               ? 0
               : options_error("-%s %s: expected a number from 0", name, text);
}

static error_t parse_percent(const char *name, const char *text, double *out)
{
    return options_real(text, 0.0, 100.0, out)
               ? 0
               : options_error("-%s %s: expected a number from 0 to 100", name, text);
}

static error_t parse_threshold(int key, char *argument, DiffOptions *options)
{
    DiffThreshold *fail = &options->fail, *warn = &options->warn;
    long long allowed;
    options->warn_always |= key >= KEY_WARN && key <= KEY_HARD_WARN;
    switch (key) {
    case KEY_FAIL:
        return parse_real("fail", argument, &fail->absolute);
    case KEY_FAIL_RELATIVE:
        return parse_real("failrelative", argument, &fail->relative);
    case KEY_FAIL_PERCENT:
        return parse_percent("failpercent", argument, &fail->percent);
    case KEY_HARD_FAIL:
        return parse_real("hardfail", argument, &fail->hard);
    case KEY_WARN:
        return parse_real("warn", argument, &warn->absolute);
    case KEY_WARN_RELATIVE:
        return parse_real("warnrelative", argument, &warn->relative);
    case KEY_WARN_PERCENT:
        return parse_percent("warnpercent", argument, &warn->percent);
    case KEY_HARD_WARN:
        return parse_real("hardwarn", argument, &warn->hard);
    case KEY_ALLOW:
        if (!options_integer(argument, 0, 1LL << 40, &allowed))
            return options_error("-allowfailures %s: expected a whole number from 0", argument);
        fail->allowed = warn->allowed = (uint64_t)allowed;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t parse_output(const char *text, DiffCommand *command)
{
    command->output = text;
    return options_has_extension(text, ".png") || options_has_extension(text, ".exr")
               ? 0
               : options_error("-o %s: expected a name ending in .png or .exr", text);
}

static error_t parse_scale(const char *text, double *out)
{
    return options_real(text, -1e30, 1e30, out)
               ? 0
               : options_error("-scale %s: expected a number", text);
}

static error_t parse_file(const char *text, DiffCommand *command)
{
    int at = command->paths[0] ? 1 : 0;
    if (command->paths[1])
        return options_error("'%s': expected two files, already given as '%s' and '%s'", text,
                             command->paths[0], command->paths[1]);
    command->paths[at] = options_input(text);
    return 0;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    DiffCommand *command = state->input;
    switch (key) {
    case 'a':
        command->files.all = true;
        return 0;
    case 'p':
        command->files.diff.perceptual = true;
        return 0;
    case 'q':
        command->quiet = true;
        return 0;
    case 'v':
        command->verbose = true;
        return 0;
    case 'o':
        return parse_output(argument, command);
    case KEY_ONLY_IF_DIFFERENT:
        command->only_if_different = true;
        return 0;
    case KEY_ABS:
        command->magnitude = true;
        return 0;
    case KEY_SCALE:
        return parse_scale(argument, &command->scale);
    case KEY_WORST:
        return options_count("--worst", argument, 0, DIFF_WORST_MAX, &command->files.diff.worst);
    case KEY_CHANNELS:
        command->files.channels = argument;
        return *argument ? 0 : options_error("--channels: expected names with commas between");
    case KEY_JSON:
        command->json = argument;
        return 0;
    case KEY_SCENE:
        command->scene = command->render.scene_path = options_input(argument);
        return 0;
    case ARGP_KEY_ARG:
        return parse_file(argument, command);
    case ARGP_KEY_SUCCESS:
        if (command->render.given && !command->scene)
            return options_error("diff: --%s says how a scene is rendered; expected --scene, too",
                                 command->render.given);
        return command->paths[1] ? 0 : options_error("diff: expected two files");
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &command->render;
        return 0;
    default:
        return parse_threshold(key, argument, &command->files.diff);
    }
}

static const struct argp_child children[] = {{&options_render_argp, 0, NULL, 5}, {0}};
static const struct argp command_argp = {
    command_options,
    parse,
    "A B",
    "Compares two images (PNG, OpenEXR with any channels and parts), two deep OpenEXR files sample "
    "by sample, or two traces buffer by buffer, in idiff's words and with the distance of the "
    "stored values in ULP.\vExit code 0 pass, 1 warning, 2 failure, 3 sizes differ, 4 bad input. "
    "What one side alone has not finite (NaN, infinity) is always a failure.",
    children,
    NULL,
    NULL};

/* ---- what is written ---- */

static Result write_heatmap(const DiffPart *part, double scale, const char *path)
{
    Image image;
    float *scaled = part->errors;
    for (size_t i = 0; i < part->pixels; i++)
        scaled[i] = (float)((double)scaled[i] * fabs(scale));
    Result result = heatmap_differences(scaled, part->width, part->height, &image);
    if (result == RESULT_OK)
        result = png_write(&image, path);
    image_free(&image);
    return result;
}

/* Of deep images each pixel's greatest error. */
static Result write_difference(const DiffCommand *command, const DiffReport *report,
                               const DiffPart *part)
{
    Planes planes;
    Result result;
    if (part->deep)
        return result_fail(RESULT_UNSUPPORTED,
                           "-o %s: of deep images there is only a heat map, "
                           "expected a name ending in .png",
                           command->output);
    result =
        diff_image(&report->of[0], &report->of[1], command->scale, command->magnitude, &planes);
    if (result == RESULT_OK)
        result = exr_planes_write(&planes, command->output);
    planes_free(&planes);
    return result;
}

static Result write_picture(const DiffCommand *command, const DiffReport *report)
{
    if (!command->output || report->pictured < 0 ||
        (command->only_if_different && report->first < 0))
        return RESULT_OK;
    const DiffPart *part = &report->parts[report->pictured];
    return options_has_extension(command->output, ".png")
               ? write_heatmap(part, command->scale, command->output)
               : write_difference(command, report, part);
}

/* ---- classes ---- */

static Result classify(DiffCommand *command, const DiffReport *report, Budget *out)
{
    const DiffPart *part = &report->parts[report->pictured];
    RenderDesc *desc = &command->render.desc;
    Scene scene;
    if (command->render.all_methods)
        return result_fail(RESULT_BAD_INPUT, "--method all: expected a single method");
    if (desc->width && (desc->width != part->width || desc->height != part->height))
        return result_fail(RESULT_BAD_INPUT, "--size %dx%d: the images have %dx%d pixels",
                           desc->width, desc->height, part->width, part->height);
    desc->width = part->width;
    desc->height = part->height;
    Result result = options_load_scene(&command->render, &scene);
    if (result != RESULT_OK)
        return result;
    result =
        budget_run(&scene, desc, bind_renderers[RENDERER_REF], bind_renderers[RENDERER_TRUTH], out);
    scene_free(&scene);
    return result;
}

/* ---- the command ---- */

static int exit_code(const DiffReport *report)
{
    static const int codes[] = {EXIT_AGREE, EXIT_WARN, EXIT_DIFFER};
    return report->sizes_differ ? EXIT_SIZES : codes[report->verdict];
}

static void report_sizes(const DiffReport *report)
{
    const DiffSize *a = &report->sizes[0], *b = &report->sizes[1];
    char from[DIFF_SIDES][48] = {"", ""};
    if (a->width == b->width && a->height == b->height) {
        snprintf(from[0], sizeof from[0], " from %d,%d", a->x, a->y);
        snprintf(from[1], sizeof from[1], " from %d,%d", b->x, b->y);
    }
    options_fail(
        result_fail(RESULT_BAD_INPUT, "sizes differ: %s%s%s has %dx%d pixels%s, %s has %dx%d%s",
                    report->paths[0], *report->size_part ? ": " : "", report->size_part, a->width,
                    a->height, from[0], report->paths[1], b->width, b->height, from[1]));
}

static Result show(DiffCommand *command, const DiffReport *report)
{
    Budget budget = {0};
    ReportDiff diff = {report, &command->files, NULL};
    Result result = RESULT_OK;
    if (command->scene && report->pictured >= 0 && !report->sizes_differ) {
        result = classify(command, report, &budget);
        diff.budget = &budget;
    }
    if (result == RESULT_OK && !command->quiet && !report->sizes_differ)
        report_diff_print(&diff, command->verbose, stdout);
    fflush(stdout); /* before a --json /dev/stdout */
    if (result == RESULT_OK && command->json)
        result = report_diff_json(&diff, exit_code(report), command->json);
    if (result == RESULT_OK && !report->sizes_differ)
        result = write_picture(command, report);
    budget_free(&budget);
    return result;
}

static Result diff(DiffCommand *command, DiffReport *report)
{
    Result result = options_check_outputs(command->output, command->json, NULL);
    command->files.diff.max_bytes =
        command->render.desc.max_memory ? command->render.desc.max_memory : RENDER_MEMORY_DEFAULT;
    if (result == RESULT_OK && !command->quiet)
        printf("Comparing \"%s\" and \"%s\"\n", command->paths[0], command->paths[1]);
    fflush(stdout);
    if (result == RESULT_OK)
        result = diff_files(command->paths[0], command->paths[1], &command->files, report);
    if (result == RESULT_OK && report->sizes_differ && !command->quiet)
        report_sizes(report);
    return result == RESULT_OK ? show(command, report) : result;
}

int cmd_diff(int argc, char **argv)
{
    DiffCommand command = {.render = options_default(), .scale = 1.0};
    DiffReport report = {0};
    command.render.desc.width = command.render.desc.height = 0; /* the images' */
    command.render.scene_path = "";                             /* no argument is one */
    command.files.diff = diff_options_default();
    command.files.diff.worst = WORST_DEFAULT;
    int code = options_parse_dash(&command_argp, argc, argv, &command);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    Result result = diff(&command, &report);
    code = result == RESULT_OK ? exit_code(&report) : options_fail(result);
    diff_report_free(&report);
    return code;
}

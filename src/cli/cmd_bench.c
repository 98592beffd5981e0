/* peel bench: speed against error. */
#include "base/file.h"
#include "cli/bind.h"
#include "cli/options.h"
#include "frame/method.h"
#include "ref/pipeline/roofline.h"
#include "report/bench.h"
#include "report/roofline.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct BenchCommand {
    RenderOptions render; /* the settings, of every scene */
    BenchPlan plan;       /* its axes; what is left empty gets a default */
    const char *scenes[BENCH_AXIS_MAX];
    Scene loaded[BENCH_AXIS_MAX];
    int scene_count;
    bool has_renderers, paper, no_errors, roofline;
    const char *json, *report;
} BenchCommand;

enum {
    KEY_RENDERERS = 0x200,
    KEY_METHOD,
    KEY_PASSES,
    KEY_LIGHTS,
    KEY_FORMATS,
    KEY_THREADS,
    KEY_SIZE,
    KEY_RUNS,
    KEY_NO_ERROR,
    KEY_PRESET,
    KEY_ROOFLINE,
    KEY_JSON,
    KEY_REPORT
};

static const struct argp_option command_options[] = {
    {0, 0, 0, 0, "What is measured; every combination:", 1},
    {"renderers", KEY_RENDERERS, "LIST", 0,
     "Of ref, gl (with passes given: every pass is drawn and lit, empty or not, without asking the "
     "driver), gl-early (its lighting also rejected early by a depth test; the same image), truth "
     "(default ref,gl,gl-early)",
     1},
    {"method", KEY_METHOD, "LIST", 0, "Transparency methods, or all (default peel)", 1},
    {"passes", KEY_PASSES, "LIST", 0, "Peels at most, or auto (default auto)", 1},
    {"lights", KEY_LIGHTS, "LIST", 0, "First N lights of the scene, each (default all)", 1},
    {"formats", KEY_FORMATS, "LIST", 0,
     "Of default, seed, compact, d32f, d24, d16, rgba32f, rgba16f, rgba16, rgba8, or several with "
     "+ "
     "between: compact+rgba16f (default default)",
     1},
    {"threads", KEY_THREADS, "LIST", 0, "Of ref and of the GL driver (default one per processor)",
     1},
    {"size", KEY_SIZE, "LIST", 0, "Image sizes WxH (default 1280x720)", 1},
    {"runs", KEY_RUNS, "N", 0, "Frames of each renderer, in turn, after one (default 3)", 1},
    {"no-error", KEY_NO_ERROR, 0, 0, "Do not render truth to hold the images against", 1},
    {"preset", KEY_PRESET, "paper", 0,
     "paper: teapot_hall and teapot_hall_stress, 1920x1080, passes 4,8,12,16, lights "
     "16,32,64,128, threads 2; what is given beside it counts",
     1},
    {"roofline", KEY_ROOFLINE, 0, 0,
     "Instead: what this machine's arithmetic and memory do at most, and what ref's lighting loop "
     "does of it; takes --threads (one value) and --json",
     1},
    {"json", KEY_JSON, "FILE", 0, "Write the rows as JSON", 1},
    {"report", KEY_REPORT, "DIR", 0, "Write a page with plots to DIR/index.html", 1},
    {0},
};

/* ---- axes ------------------------------------------------------------------------------------ */

/* Whether there is room for one more value. */
static error_t check_room(const char *name, int count)
{
    return count < BENCH_AXIS_MAX
               ? 0
               : options_error("%s: expected at most %d values", name, BENCH_AXIS_MAX);
}

static error_t add_renderer(const char *text, void *context)
{
    BenchCommand *command = context;
    for (int i = 0; i < BENCH_RENDERERS; i++)
        if (strcmp(text, bench_renderer_name(i)) == 0) {
            command->plan.renderers[i] = true;
            return 0;
        }
    return options_error("--renderers %s: expected ref, gl, gl-early or truth", text);
}

static error_t add_method(const char *text, void *context)
{
    BenchPlan *plan = context;
    RenderDesc desc = {0};
    if (strcmp(text, "all") == 0) {
        for (int i = 0; i < METHOD_COUNT; i++)
            if (add_method(method_info((MethodId)i)->name, plan))
                return EINVAL;
        return 0;
    }
    error_t error = check_room("--method", plan->method_count);
    if (error == 0)
        error = options_method(text, &desc);
    if (error == 0)
        plan->methods[plan->method_count++] = desc.method;
    return error;
}

static error_t add_passes(const char *text, void *context)
{
    BenchPlan *plan = context;
    RenderDesc desc = {0};
    error_t error = check_room("--passes", plan->pass_count);
    if (error == 0)
        error = options_passes(text, &desc);
    if (error == 0)
        plan->passes[plan->pass_count++] = desc.passes;
    return error;
}

static error_t add_lights(const char *text, void *context)
{
    BenchPlan *plan = context;
    RenderDesc desc = {0};
    error_t error = check_room("--lights", plan->light_count);
    if (error == 0)
        error = options_lights(text, &desc);
    if (error == 0)
        plan->lights[plan->light_count++] = desc.lights;
    return error;
}

static error_t add_format(const char *text, void *context)
{
    BenchPlan *plan = context;
    error_t error = check_room("--formats", plan->format_count);
    if (error)
        return error;
    if (!bench_format_parse(text, &plan->formats[plan->format_count]))
        return options_error("--formats %s: expected default, seed, compact, a depth format (d32f, "
                             "d24, d16) or an accumulation format (rgba32f, rgba16f, rgba16, "
                             "rgba8), or several with + between",
                             text);
    plan->format_count++;
    return 0;
}

static error_t add_threads(const char *text, void *context)
{
    BenchPlan *plan = context;
    error_t error = check_room("--threads", plan->thread_count);
    if (error == 0)
        error =
            options_count("--threads", text, 1, THREADS_MAX, &plan->threads[plan->thread_count]);
    plan->thread_count += error == 0;
    return error;
}

static error_t add_size(const char *text, void *context)
{
    BenchPlan *plan = context;
    RenderDesc desc = {0};
    error_t error = check_room("--size", plan->size_count);
    if (error == 0)
        error = options_size(text, &desc);
    if (error == 0)
        plan->sizes[plan->size_count++] = (BenchSize){desc.width, desc.height};
    return error;
}

static error_t add_scene(const char *text, BenchCommand *command)
{
    error_t error = check_room("scenes", command->scene_count);
    if (error == 0)
        command->scenes[command->scene_count++] = options_input(text);
    return error;
}

static void set_paper(BenchCommand *command)
{
    static const int passes[] = {4, 8, 12, 16}, lights[] = {16, 32, 64, 128};
    BenchPlan *plan = &command->plan;
    if (!command->scene_count) {
        command->scenes[command->scene_count++] = "teapot_hall";
        command->scenes[command->scene_count++] = "teapot_hall_stress";
    }
    if (!plan->pass_count) {
        memcpy(plan->passes, passes, sizeof passes);
        plan->pass_count = 4;
    }
    if (!plan->light_count) {
        memcpy(plan->lights, lights, sizeof lights);
        plan->light_count = 4;
    }
    if (!plan->size_count)
        plan->sizes[plan->size_count++] = (BenchSize){1920, 1080};
    if (!plan->thread_count)
        plan->threads[plan->thread_count++] = 2;
}

static void set_defaults(BenchCommand *command)
{
    BenchPlan *plan = &command->plan;
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    if (command->paper)
        set_paper(command);
    if (!command->has_renderers)
        plan->renderers[BENCH_REF] = plan->renderers[BENCH_GL] = plan->renderers[BENCH_GL_EARLY] =
            true;
    if (!plan->method_count)
        plan->methods[plan->method_count++] = METHOD_PEEL;
    if (!plan->pass_count)
        plan->passes[plan->pass_count++] = 0;
    if (!plan->light_count)
        plan->lights[plan->light_count++] = 0;
    if (!plan->format_count)
        bench_format_parse("default", &plan->formats[plan->format_count++]);
    if (!plan->thread_count)
        plan->threads[plan->thread_count++] = processors > 0 ? (int)processors : 1;
    if (!plan->size_count)
        plan->sizes[plan->size_count++] =
            (BenchSize){command->render.desc.width, command->render.desc.height};
    if (!plan->runs)
        plan->runs = 3;
    plan->errors = !command->no_errors;
    plan->fma_fixed = command->render.fma != FMA_AUTO;
}

static error_t parse_other(int key, char *argument, BenchCommand *command)
{
    switch (key) {
    case KEY_RUNS:
        return options_count("--runs", argument, 1, BENCH_RUNS_MAX, &command->plan.runs);
    case KEY_NO_ERROR:
        command->no_errors = true;
        return 0;
    case KEY_ROOFLINE:
        command->roofline = true;
        return 0;
    case KEY_PRESET:
        command->paper = true;
        return strcmp(argument, "paper") == 0
                   ? 0
                   : options_error("--preset %s: expected paper", argument);
    case KEY_JSON:
        command->json = argument;
        return 0;
    case KEY_REPORT:
        command->report = argument;
        return 0;
    case ARGP_KEY_ARG:
        return add_scene(argument, command);
    case ARGP_KEY_SUCCESS:
        return command->scene_count || command->paper || command->roofline
                   ? 0
                   : options_error("no scene given; expected .gltf or .glb files or names of "
                                   "built-in scenes");
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    BenchCommand *command = state->input;
    BenchPlan *plan = &command->plan;
    switch (key) {
    case KEY_RENDERERS:
        command->has_renderers = true;
        return options_list("--renderers", argument, add_renderer, command);
    case KEY_METHOD:
        return options_list("--method", argument, add_method, plan);
    case KEY_PASSES:
        return options_list("--passes", argument, add_passes, plan);
    case KEY_LIGHTS:
        return options_list("--lights", argument, add_lights, plan);
    case KEY_FORMATS:
        return options_list("--formats", argument, add_format, plan);
    case KEY_THREADS:
        return options_list("--threads", argument, add_threads, plan);
    case KEY_SIZE:
        return options_list("--size", argument, add_size, plan);
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &command->render;
        return 0;
    default:
        return parse_other(key, argument, command);
    }
}

static const struct argp_child children[] = {{&options_settings_argp, 0, NULL, 2}, {0}};
static const struct argp command_argp = {
    command_options,
    parse,
    "SCENE...",
    "Measures how long frames take and how far they are from truth. Times are those of frames in "
    "the steady state: contexts, uploads, shader compilation and one frame come before, then the "
    "renderers draw in turn.\vEvery number of threads has a process of its own, with "
    "LP_NUM_THREADS "
    "set to it. Rows with a * are on the Pareto front of CPU time and root mean square error. Exit "
    "code 0, or 2 when the images of ref, gl and gl-early differ in a bit.",
    children,
    NULL,
    NULL};

/* ---- the command ----------------------------------------------------------------------------- */

static Result load_scenes(BenchCommand *command)
{
    BenchPlan *plan = &command->plan;
    for (int i = 0; i < command->scene_count; i++) {
        RenderOptions options = command->render;
        options.scene_path = command->scenes[i];
        Result result = options_load_scene(&options, &command->loaded[i]);
        if (result != RESULT_OK)
            return result;
        plan->scenes[i] = (BenchScene){&command->loaded[i], options.desc};
        plan->scene_count++;
    }
    return RESULT_OK;
}

static void print_group(void *context, const BenchReport *report, size_t first)
{
    (void)context;
    report_bench_print(report, first, stdout);
}

static Result write_files(const BenchCommand *command, const BenchReport *report, const char *line)
{
    Result result = RESULT_OK;
    if (command->json)
        result = report_bench_json(report, command->json);
    if (result == RESULT_OK && command->report)
        result = report_bench_html(report, line, command->report);
    return result;
}

/* A setting that is given, and that a format changes, would count for nothing. */
static Result check_formats(const BenchCommand *command)
{
    const int *given = command->render.settings;
    for (int f = 0; f < command->plan.format_count; f++) {
        const BenchFormat *format = &command->plan.formats[f];
        RenderDesc desc = {0};
        for (int i = 0; i < SETTING_COUNT; i++)
            if (given[i] >= 0)
                setting_put(&desc, (SettingId)i, given[i]);
        bench_format_apply(format, &desc);
        for (int i = 0; i < SETTING_COUNT; i++)
            if (given[i] >= 0 && setting_get(&desc, (SettingId)i) != given[i])
                return result_fail(RESULT_BAD_INPUT,
                                   "--formats %s: it has another --%s; expected one of the two",
                                   format->name, setting_info((SettingId)i)->name);
    }
    return RESULT_OK;
}

static Result run(BenchCommand *command, const char *line, BenchReport *report)
{
    Result result = check_formats(command);
    if (result == RESULT_OK)
        result = load_scenes(command);
    if (result == RESULT_OK)
        result = options_check_outputs(command->json, NULL, command->report);
    if (result != RESULT_OK)
        return result;
    command->plan.bound = bind_bench;
    command->plan.truth = bind_renderers[RENDERER_TRUTH];
    printf("%zu rows, %d runs each\n", bench_row_count(&command->plan), command->plan.runs);
    result = bench_run(&command->plan, print_group, NULL, report);
    if (result != RESULT_OK)
        return result;
    report_bench_print_ratios(report, stdout);
    fflush(stdout); /* before a --json /dev/stdout */
    return write_files(command, report, line);
}

enum {
    ROOFLINE_STRETCH_MS = 40
};

/* Whether there is anything that a measurement of the machine alone has no use for. */
static bool has_frames(const BenchCommand *command)
{
    const BenchPlan *plan = &command->plan;
    return command->scene_count || command->has_renderers || command->paper || command->no_errors ||
           command->report || command->render.given || plan->runs || plan->method_count ||
           plan->pass_count || plan->light_count || plan->format_count || plan->size_count ||
           plan->thread_count > 1;
}

static int run_roofline(const BenchCommand *command)
{
    const BenchPlan *plan = &command->plan;
    RooflineReport report;
    Result result = options_check_output(command->json);
    if (has_frames(command))
        result = result_fail(RESULT_BAD_INPUT, "--roofline: expected no scene and no options but "
                                               "--json and one value of --threads");
    if (result == RESULT_OK)
        result = roofline_run(roofline_kernels, plan->threads[0], ROOFLINE_STRETCH_MS, &report);
    if (result != RESULT_OK)
        return options_fail(result);
    report_roofline_print(&report, stdout);
    fflush(stdout); /* before a --json /dev/stdout */
    if (command->json)
        result = report_roofline_json(&report, command->json);
    return result == RESULT_OK ? EXIT_AGREE : options_fail(result);
}

static int finish(Result result, const BenchReport *report)
{
    if (result != RESULT_OK)
        return options_fail(result);
    if (report->differing == 0)
        return EXIT_AGREE;
    fprintf(stderr,
            "peel: in %zu of %zu rows the image differs from the first renderer's, expected "
            "the same bits\n",
            report->differing, report->count);
    return EXIT_DIFFER;
}

int cmd_bench(int argc, char **argv)
{
    static BenchCommand command;
    BenchReport report = {0};
    char *line = options_command_line(argc, argv);
    command = (BenchCommand){.render = options_default()};
    int code = options_parse(&command_argp, argc, argv, &command);
    if (code) {
        free(line);
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    }
    if (command.roofline) {
        free(line);
        return run_roofline(&command);
    }
    set_defaults(&command);
    Result result =
        line ? run(&command, line, &report) : result_fail(RESULT_NO_MEMORY, "out of memory");
    code = finish(result, &report);
    bench_free(&report);
    for (int i = 0; i < command.plan.scene_count; i++)
        scene_free(&command.loaded[i]);
    free(line);
    return code;
}

/* peel compare: all three renderers on one scene. */
#include "base/progress.h"
#include "cli/bind.h"
#include "cli/options.h"
#include "frame/method.h"
#include "image/png.h"
#include "report/budget.h"
#include "report/html.h"
#include "report/table.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct CompareCommand {
    RenderOptions render;
    const char *json, *report, *classes;
    bool budget;
    double tolerance;
    char *line; /* the command, to be shown in the report */
} CompareCommand;

enum {
    KEY_JSON = 0x200,
    KEY_REPORT,
    KEY_TOLERANCE,
    KEY_BOUND,
    KEY_BUDGET,
    KEY_CLASSES
};

static const struct argp_option command_options[] = {
    {"json", KEY_JSON, "FILE", 0, "Write the figures as JSON", 0},
    {"report", KEY_REPORT, "DIR", 0,
     "Write a page with pictures to DIR/index.html; with --method all, one about all methods, and "
     "each "
     "method's own in DIR/METHOD",
     0},
    {"tolerance", KEY_TOLERANCE, "T", 0,
     "Allowed difference from truth at the 99th percentile, relative to max(1, value), where both "
     "see the same fragments in the same order (default: the method's, see peel methods); what "
     "approximates is not judged",
     0},
    {"budget", KEY_BUDGET, 0, 0,
     "Also render with one thing changed at a time, and say what each adds to the difference "
     "between ref and truth, and why each pixel differs; with --bound, rounding beyond the bound "
     "is unexplained",
     0},
    {"classes", KEY_CLASSES, "FILE", 0,
     "Write a PNG in which each pixel's colour says why it differs (with --budget's table as its "
     "legend)",
     0},
    {"bound", KEY_BOUND, NULL, 0,
     "Also compute, for every pixel, how far single precision may be from truth, and compare", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    CompareCommand *command = state->input;
    switch (key) {
    case KEY_JSON:
        command->json = argument;
        return 0;
    case KEY_REPORT:
        command->report = argument;
        return 0;
    case KEY_TOLERANCE:
        return options_real(argument, 0.0, 1e30, &command->tolerance)
                   ? 0
                   : options_error("--tolerance %s: expected a number from 0", argument);
    case KEY_BUDGET:
        command->budget = true;
        return 0;
    case KEY_CLASSES:
        command->classes = argument;
        command->budget = true;
        return 0;
    case KEY_BOUND:
        command->render.desc.bound = true;
        return 0;
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
    "SCENE",
    "Renders SCENE (.gltf, .glb, or the name of a built-in scene) with ref, gl and truth and "
    "compares every buffer.\vExit code 0 when ref and gl agree bit for bit and ref agrees with "
    "truth within the tolerance, else 2.",
    children,
    NULL,
    NULL};

/* The same failure, with the method in its message. */
static Result name_method(Result result, MethodId id)
{
    char message[512];
    snprintf(message, sizeof message, "%s", result_message());
    return result_fail(result, "%s: %s", method_info(id)->name, message);
}

/* Renders and compares by one method, prints its row, and writes its page. */
static Result compare_method(const CompareCommand *command, const Scene *scene, MethodId id,
                             Threeway *report)
{
    RenderDesc desc = command->render.desc;
    char context[64];
    desc.method = id;
    desc.bound = desc.bound && method_has_bound(&desc);
    snprintf(context, sizeof context, "method %d of %d, %s", (int)id + 1, METHOD_COUNT,
             method_info(id)->name);
    progress_context(context);
    Result result = threeway_run(scene, command->render.scene_path, &desc, bind_renderers,
                                 command->tolerance, command->report != NULL, report);
    progress_context(NULL);
    if (result != RESULT_OK)
        return name_method(result, id);
    if (id == 0)
        report_methods_head(report, stdout);
    report_methods_row(report, stdout);
    if (command->report)
        result = report_html_write_method(report, command->line, command->report);
    threeway_release_images(report);
    if (result != RESULT_OK)
        threeway_free(report);
    return result;
}

/* Every method of the table. *agree: whether all of them do. */
static Result compare_methods(const CompareCommand *command, const Scene *scene, bool *agree)
{
    static Threeway reports[METHOD_COUNT];
    size_t count = 0;
    if (command->budget)
        return result_fail(RESULT_BAD_INPUT, "%s: expected a single --method",
                           command->classes ? "--classes" : "--budget");
    Result result = options_check_outputs(command->json, NULL, command->report);
    if (result == RESULT_OK)
        result = options_check_fma(&command->render);
    *agree = true;
    for (int i = 0; i < METHOD_COUNT && result == RESULT_OK; i++) {
        result = compare_method(command, scene, (MethodId)i, &reports[i]);
        if (result == RESULT_OK)
            *agree &= reports[count++].agree;
    }
    if (result == RESULT_OK) {
        report_methods_foot(stdout);
        printf("\n%s\n", *agree ? "AGREE" : "DIFFER");
        fflush(stdout);
    }
    if (result == RESULT_OK && command->json)
        result = report_json_write_all(reports, count, command->json);
    if (result == RESULT_OK && command->report)
        result = report_html_write_all(reports, count, command->line, command->report);
    for (size_t i = 0; i < METHOD_COUNT; i++)
        threeway_free(&reports[i]);
    return result;
}

/* Frees nothing of report; *budget is the caller's to free. */
static Result explain(const CompareCommand *command, const Scene *scene, Threeway *report,
                      Budget *budget)
{
    RenderDesc desc = report->desc;
    Image image = {0};
    desc.unfused = !report->frames[RENDERER_REF].fused;
    Result result = budget_run(scene, &desc, bind_renderers[RENDERER_REF],
                               bind_renderers[RENDERER_TRUTH], budget);
    if (result != RESULT_OK)
        return result;
    report->budget = budget;
    report_budget_print(budget, stdout);
    if (command->classes)
        result = report_classes_image(budget, &image);
    if (command->classes && result == RESULT_OK)
        result = png_write(&image, command->classes);
    image_free(&image);
    return result;
}

static Result compare(const CompareCommand *command, const Scene *scene, Threeway *report)
{
    Result result = options_check_outputs(command->json, command->classes, command->report);
    if (result == RESULT_OK)
        result = options_check_fma(&command->render);
    if (result == RESULT_OK)
        result = threeway_run(scene, command->render.scene_path, &command->render.desc,
                              bind_renderers, command->tolerance, command->report != NULL, report);
    if (result != RESULT_OK)
        return result;
    report_table_print(report, stdout);
    Budget budget = {0};
    if (command->budget)
        result = explain(command, scene, report, &budget);
    fflush(stdout); /* before a --json /dev/stdout */
    if (result == RESULT_OK && command->json)
        result = report_json_write(report, command->json);
    if (result == RESULT_OK && command->report)
        result = report_html_write(report, command->line, command->report);
    report->budget = NULL;
    budget_free(&budget);
    if (result != RESULT_OK)
        threeway_free(report);
    return result;
}

int cmd_compare(int argc, char **argv)
{
    CompareCommand command = {.render = options_default(), .tolerance = -1.0};
    command.line = options_command_line(argc, argv);
    int code = options_parse(&command_argp, argc, argv, &command);
    if (code) {
        free(command.line);
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    }
    Scene scene;
    Threeway report = {0};
    bool agree = false;
    Result result = command.line ? options_load_scene(&command.render, &scene)
                                 : result_fail(RESULT_NO_MEMORY, "out of memory");
    if (result == RESULT_OK) {
        result = command.render.all_methods ? compare_methods(&command, &scene, &agree)
                                            : compare(&command, &scene, &report);
        scene_free(&scene);
    }
    free(command.line);
    if (result != RESULT_OK)
        return options_fail(result);
    code = agree || report.agree ? EXIT_AGREE : EXIT_DIFFER;
    threeway_free(&report);
    return code;
}

/* peel compare: all three renderers on one scene. */
#include "base/file.h"
#include "cli/bind.h"
#include "cli/options.h"
#include "frame/method.h"
#include "report/html.h"
#include "report/table.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct CompareCommand {
    RenderOptions render;
    const char *json, *report;
    double tolerance;
    char *line; /* the command, to be shown in the report */
} CompareCommand;

enum {
    KEY_JSON = 0x200,
    KEY_REPORT,
    KEY_TOLERANCE,
    KEY_BOUND
};

static const struct argp_option command_options[] = {
    {"json", KEY_JSON, "FILE", 0, "Write the figures as JSON", 0},
    {"report", KEY_REPORT, "DIR", 0, "Write a page with pictures to DIR/index.html", 0},
    {"tolerance", KEY_TOLERANCE, "T", 0,
     "Allowed difference from truth at the 99th percentile, relative to max(1, value), where both "
     "see the same fragments in the same order (default: the method's, see peel methods)",
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

/* The command as a shell would take it again. */
static char *command_line(int argc, char **argv)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    fprintf(out, "build/%s", argv[0]);
    for (int i = 1; i < argc; i++) {
        bool plain = argv[i][0] != '\0';
        for (const char *c = argv[i]; *c; c++)
            plain &= isalnum((unsigned char)*c) || strchr("_-./=,:+%@", *c) != NULL;
        if (plain) {
            fprintf(out, " %s", argv[i]);
            continue;
        }
        fputs(" '", out);
        for (const char *c = argv[i]; *c; c++)
            *c == '\'' ? (void)fputs("'\\''", out) : (void)fputc(*c, out);
        fputc('\'', out);
    }
    fclose(out);
    return text;
}

/* Made, and found writable, before minutes of work and not after. */
static Result open_directory(const char *path)
{
    Result result = file_make_directories(path);
    if (result == RESULT_OK && access(path, W_OK) != 0)
        result =
            result_fail(RESULT_IO, "%s: cannot write to this directory: %s", path, strerror(errno));
    return result;
}

/* Every method of the table. *agree: whether all of them do. */
static Result compare_methods(const CompareCommand *command, const Scene *scene, bool *agree)
{
    static Threeway reports[METHOD_COUNT];
    size_t count = 0;
    Result result = options_check_output(command->json);
    if (result == RESULT_OK && command->report)
        result = result_fail(RESULT_BAD_INPUT, "--report: expected a single --method");
    if (result == RESULT_OK)
        result = options_check_fma(&command->render);
    *agree = true;
    for (int i = 0; i < METHOD_COUNT && result == RESULT_OK; i++) {
        RenderDesc desc = command->render.desc;
        desc.method = method_info((MethodId)i)->id;
        desc.bound = desc.bound && method_has_bound(&desc);
        result = threeway_run(scene, command->render.scene_path, &desc, bind_renderers,
                              command->tolerance, false, &reports[count]);
        if (result != RESULT_OK)
            break;
        threeway_release_images(&reports[count]);
        if (count == 0)
            report_methods_head(&reports[0], stdout);
        report_methods_row(&reports[count], stdout);
        *agree = *agree && reports[count++].agree;
    }
    if (result == RESULT_OK) {
        report_methods_foot(stdout);
        printf("\n%s\n", *agree ? "AGREE" : "DIFFER");
        fflush(stdout);
    }
    if (result == RESULT_OK && command->json)
        result = report_json_write_all(reports, count, command->json);
    for (size_t i = 0; i < count; i++)
        threeway_free(&reports[i]);
    return result;
}

static Result compare(const CompareCommand *command, const Scene *scene, Threeway *report)
{
    Result result = command->report ? open_directory(command->report) : RESULT_OK;
    if (result == RESULT_OK)
        result = options_check_output(command->json);
    if (result == RESULT_OK)
        result = options_check_fma(&command->render);
    if (result == RESULT_OK)
        result = threeway_run(scene, command->render.scene_path, &command->render.desc,
                              bind_renderers, command->tolerance, command->report != NULL, report);
    if (result != RESULT_OK)
        return result;
    report_table_print(report, stdout);
    fflush(stdout); /* before a --json /dev/stdout */
    if (command->json)
        result = report_json_write(report, command->json);
    if (result == RESULT_OK && command->report)
        result = report_html_write(report, command->line, command->report);
    if (result != RESULT_OK)
        threeway_free(report);
    return result;
}

int cmd_compare(int argc, char **argv)
{
    CompareCommand command = {.render = options_default(), .tolerance = -1.0};
    command.line = command_line(argc, argv);
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

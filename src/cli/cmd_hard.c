/* peel hard: the catalogue of hard cases. */
#include "base/file.h"
#include "base/memory.h"
#include "cli/bind.h"
#include "cli/options.h"
#include "report/hard.h"
#include "scene/gltf.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct HardCommand {
    const HardCase **cases; /* those named; count 0: all */
    size_t count, capacity;
    const char *json, *report, *folder;
    bool list, slice;
    char *line; /* the command, to be shown on the page */
} HardCommand;

enum {
    KEY_LIST = 0x200,
    KEY_JSON,
    KEY_REPORT,
    KEY_CI,
    KEY_EXPORT,
    KEY_GL
};

static const struct argp_option command_options[] = {
    {"list", KEY_LIST, 0, 0, "List the cases, why each is hard, and the source", 0},
    {"json", KEY_JSON, "FILE", 0, "Write the figures as JSON", 0},
    {"report", KEY_REPORT, "DIR", 0, "Write a page with pictures to DIR/index.html", 0},
    {"ci", KEY_CI, 0, 0, "Of every case the first three configurations only", 0},
    {"export", KEY_EXPORT, "DIR", 0, "Write the cases' scenes to DIR/NAME.gltf and do nothing else",
     0},
    {"gl", KEY_GL, OPTIONS_GL_NAMES, 0, OPTIONS_GL_HELP, 0},
    {0},
};

static error_t add_case(const char *name, HardCommand *command)
{
    const HardCase *hard = hard_find(name);
    if (!hard)
        return options_error("'%s' is no hard case; 'peel hard --list' lists them", name);
    void *cases = command->cases;
    if (memory_grow(&cases, &command->capacity, command->count + 1, sizeof *command->cases) !=
        RESULT_OK)
        return options_error("%s", result_message());
    command->cases = cases;
    command->cases[command->count++] = hard;
    return 0;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    HardCommand *command = state->input;
    switch (key) {
    case KEY_LIST:
        command->list = true;
        return 0;
    case KEY_JSON:
        command->json = argument;
        return 0;
    case KEY_REPORT:
        command->report = argument;
        return 0;
    case KEY_CI:
        command->slice = true;
        return 0;
    case KEY_EXPORT:
        command->folder = argument;
        return 0;
    case KEY_GL:
        return options_gl(argument);
    case ARGP_KEY_ARG:
        return add_case(argument, command);
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp command_argp = {
    command_options,
    parse,
    "[CASE...]",
    "Renders the hard cases (all, or those named) with ref, gl and truth in many configurations, "
    "and holds each against its own expectation.\vExit code 0 when all expectations hold, else 2.",
    NULL,
    NULL,
    NULL};

static int list(const HardCommand *command)
{
    size_t count;
    if (command->count || command->json || command->report || command->folder || command->slice)
        return options_fail(
            result_fail(RESULT_BAD_INPUT, "hard --list: expected neither a case nor an option"));
    const HardScene *scenes = hard_scenes_table(&count);
    for (size_t i = 0; i < count; i++)
        printf("%-26s %s\n%-26s %s\n", scenes[i].name, scenes[i].why, "", scenes[i].source);
    return EXIT_AGREE;
}

static Result export_scene(const HardScene *hard, const char *folder)
{
    size_t size = strlen(folder) + strlen(hard->name) + sizeof "/.gltf";
    char *path = memory_array(size, 1);
    if (!path)
        return RESULT_NO_MEMORY;
    snprintf(path, size, "%s/%s.gltf", folder, hard->name);
    Scene scene;
    Result result = hard->generate(&scene);
    if (result == RESULT_OK) {
        result = gltf_write(&scene, path);
        scene_free(&scene);
    }
    free(path);
    return result;
}

static Result export_scenes(const HardCommand *command)
{
    Result result = file_make_directories(command->folder);
    for (size_t i = 0; i < command->count && result == RESULT_OK; i++)
        result = export_scene(hard_scenes_find(command->cases[i]->name), command->folder);
    return result;
}

/* Without names: all. */
static Result choose_cases(HardCommand *command)
{
    size_t all, named = command->count;
    const HardCase *cases = hard_cases(&all);
    for (size_t i = 0; named == 0 && i < all; i++)
        if (add_case(cases[i].name, command))
            return RESULT_NO_MEMORY;
    return RESULT_OK;
}

/* What makes the page again. Without names: all. */
static char *command_line(const HardCommand *command, bool all)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    fprintf(out, "build/peel hard%s --report %s", command->slice ? " --ci" : "",
            command->report ? command->report : "out");
    for (size_t i = 0; i < command->count && !all; i++)
        fprintf(out, " %s", command->cases[i]->name);
    (void)fclose(out);
    return text;
}

static Result run_cases(const HardCommand *command, HardReport *reports, HardTotals *totals)
{
    Result result = options_check_outputs(command->json, NULL, command->report);
    for (size_t i = 0; i < command->count && result == RESULT_OK; i++) {
        result = hard_run(command->cases[i], command->slice, bind_renderers, &reports[i]);
        if (result != RESULT_OK)
            break;
        report_hard_print(&reports[i], stdout);
        report_hard_add(&reports[i], totals);
    }
    return result;
}

static Result examine(const HardCommand *command, HardTotals *totals)
{
    HardReport *reports = memory_array(command->count, sizeof *reports);
    if (!reports)
        return RESULT_NO_MEMORY;
    result_warnings_enable(false); /* of lists without room; the table says more */
    Result result = run_cases(command, reports, totals);
    result_warnings_enable(true);
    if (result == RESULT_OK) {
        report_hard_print_totals(totals, stdout);
        fflush(stdout); /* before a --json /dev/stdout */
    }
    if (result == RESULT_OK && command->json)
        result = report_hard_json(reports, command->count, command->json);
    if (result == RESULT_OK && command->report)
        result = report_hard_html(reports, command->count, command->line, command->report);
    for (size_t i = 0; i < command->count; i++)
        hard_free(&reports[i]);
    free(reports);
    return result;
}

int cmd_hard(int argc, char **argv)
{
    HardCommand command = {0};
    HardTotals totals = {0};
    int code = options_parse(&command_argp, argc, argv, &command);
    if (code || command.list) {
        free(command.cases);
        return code && code != OPTIONS_HELPED ? code : code ? EXIT_AGREE : list(&command);
    }
    bool all = command.count == 0;
    Result result = choose_cases(&command);
    if (result == RESULT_OK && command.folder && (command.json || command.report || command.slice))
        result = result_fail(RESULT_BAD_INPUT,
                             "hard --export: expected neither --json nor --report nor --ci");
    command.line = command_line(&command, all);
    if (result == RESULT_OK && !command.line)
        result = result_fail(RESULT_NO_MEMORY, "out of memory");
    if (result == RESULT_OK)
        result = command.folder ? export_scenes(&command) : examine(&command, &totals);
    free(command.cases);
    free(command.line);
    if (result != RESULT_OK)
        return options_fail(result);
    return totals.failed ? EXIT_DIFFER : EXIT_AGREE;
}

/* peel explain --course: the lessons on the built-in scenes. */
#include "cli/bind.h"
#include "cli/explain_page.h"
#include "report/course.h"
#include "scene/generate.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct CourseCommand {
    const char *output;
} CourseCommand;

enum {
    KEY_COURSE = 0x200
};

static const struct argp_option command_options[] = {
    {"course", KEY_COURSE, NULL, 0, "The course", 0},
    {"output", 'o', "DIR", 0, "Write it to DIR: index.html and a page for each lesson", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    CourseCommand *command = state->input;
    switch (key) {
    case 'o':
        command->output = argument;
        return 0;
    case KEY_COURSE:
        return 0;
    case ARGP_KEY_ARG:
        return options_error("explain --course: '%s': its scenes are built in", argument);
    case ARGP_KEY_SUCCESS:
        return command->output ? 0 : options_error("explain --course: expected -o DIR");
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp command_argp = {
    command_options,
    parse,
    "--course -o DIR",
    "Writes a course of six short lessons about transparency by depth peeling, each a page of "
    "`peel explain` with a text and a question. It works from disk.",
    NULL,
    NULL,
    NULL};

static Result write_lesson(const CourseCommand *command, int number, size_t *room)
{
    const CourseLesson *lesson = &course_lessons[number - 1];
    char file[16], line[96], lights[24] = "";
    course_file(number, file);
    RenderOptions options = options_default();
    options.scene_path = lesson->scene;
    options.desc.width = 320;
    options.desc.height = 180;
    options.desc.lights = lesson->lights;
    if (lesson->lights > 0)
        snprintf(lights, sizeof lights, " --lights %d", lesson->lights);
    snprintf(line, sizeof line, "peel explain %s%s -o DIR", lesson->scene, lights);
    ExplainLesson told = {.number = number, .titles = course_titles, .count = COURSE_LESSONS};
    ExplainPage page = {
        .dir = command->output, .file = file, .command = line, .max_bytes = *room, .lesson = &told};
    Scene scene;
    size_t bytes = 0;
    Result result = options_load_scene(&options, &scene);
    if (result != RESULT_OK)
        return result;
    result = explain_page_write(&options, &scene, &page, &bytes);
    scene_free(&scene);
    *room -= bytes;
    return result;
}

static Result run(const CourseCommand *command, const char *line)
{
    if (!line)
        return result_fail(RESULT_NO_MEMORY, "out of memory");
    Result result = options_open_directory(command->output);
    size_t room = EXPLAIN_MAX_BYTES; /* of all pages together */
    for (int number = 1; number <= COURSE_LESSONS && result == RESULT_OK; number++)
        result = write_lesson(command, number, &room);
    if (result == RESULT_OK)
        result = course_write_index(command->output, line);
    if (result == RESULT_OK)
        printf("%s/index.html\n", command->output);
    return result;
}

int cmd_explain_course(int argc, char **argv)
{
    CourseCommand command = {0};
    int code = options_parse(&command_argp, argc, argv, &command);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    char *line = options_command_line(argc, argv);
    Result result = run(&command, line);
    free(line);
    return result == RESULT_OK ? EXIT_AGREE : options_fail(result);
}

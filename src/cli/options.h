/* Options shared by the commands that render, and how a command line fails. */
#ifndef PEEL_CLI_OPTIONS_H
#define PEEL_CLI_OPTIONS_H

#include "frame/render_desc.h"
#include "frame/setting.h"
#include "scene/scene.h"

#include <argp.h>

/* The documented exit codes of all commands. */
enum {
    EXIT_AGREE = 0,
    EXIT_WARN = 1,
    EXIT_DIFFER = 2,
    EXIT_SIZES = 3,
    EXIT_BAD_INPUT = 4
};

typedef enum FmaChoice {
    FMA_AUTO = 0,
    FMA_ON,
    FMA_OFF
} FmaChoice;

typedef struct RenderOptions {
    const char *scene_path; /* the argument SCENE; NULL until it is parsed */
    bool scene_optional;    /* of the command: whether there may be none */
    RenderDesc desc;
    const char *camera; /* name or index; NULL: the first */
    bool has_opacity, has_background;
    bool all_methods;            /* --method all, of commands that take it */
    bool has_method, has_passes; /* one was given */
    const char *given;           /* the first option that says how to render; NULL: none */
    double opacity, background[3];
    FmaChoice fma;
    int profile;                 /* −1: not given; 1: seed */
    int settings[SETTING_COUNT]; /* −1: as the profile or the default has it; else what was given */
} RenderOptions;

/* Child parsers; their input is a RenderOptions. The first takes SCENE as its argument; the other
 * has none, and all options but those that a benchmark has lists of: size, lights, method, passes,
 * threads. */
extern const struct argp options_render_argp;
extern const struct argp options_settings_argp;

/* The defaults of the command line: 1280×720. */
RenderOptions options_default(void);

/* Parses a command's line. Returns 0, OPTIONS_HELPED after --help, or EXIT_BAD_INPUT after a
 * one-line message. */
enum {
    OPTIONS_HELPED = -1
};
int options_parse(const struct argp *argp, int argc, char **argv, void *input);
/* The same where a single dash may begin long options too: -fail as well as --fail. */
int options_parse_dash(const struct argp *argp, int argc, char **argv, void *input);

/* Until it is called again with NULL, options_parse parses nothing: it gives what it would parse by
 * to visit and returns OPTIONS_HELPED. dash: a single dash may begin long options. */
typedef void (*OptionsVisit)(void *context, const struct argp *argp, bool dash);
void options_describe(OptionsVisit visit, void *context);

/* For parsers: one line on stderr, and the error code that options_parse turns into exit 4. */
error_t options_error(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* The whole of text as a number in [low, high]; false otherwise. */
bool options_integer(const char *text, long long low, long long high, long long *out);
bool options_real(const char *text, double low, double high, double *out);

/* "AxB", "A,B", ...: two whole numbers from low to SIZE_MAX_PIXELS; false otherwise. */
bool options_pair(const char *text, char between, int low, int *first, int *second);

/* Values of options that several commands have; 0, or the error of options_error. --gl chooses for
 * the process. */
#define OPTIONS_BLEND_FORMATS "rgba8|rgba16|rgba16f|rgba32f|rg32f|r32f"
#define OPTIONS_GL_NAMES      "osmesa|egl"
#define OPTIONS_GL_HELP       "Where OpenGL comes from: osmesa (default) or egl"
error_t options_gl(const char *text);
error_t options_size(const char *text, RenderDesc *desc);
error_t options_lights(const char *text, RenderDesc *desc);
error_t options_method(const char *text, RenderDesc *desc);
error_t options_passes(const char *text, RenderDesc *desc);
error_t options_fma(const char *text, FmaChoice *out);
/* Whether text is a value of --depth, which it then sets: for a command whose --depth takes files,
 * too. */
bool options_depth_format(const char *text, RenderOptions *options);
error_t options_count(const char *name, const char *text, int low, int high, int *out);
error_t options_memory(const char *text, size_t *out);

/* Gives every part of text between commas to item; the first error ends it. name: of the option. */
error_t options_list(const char *name, const char *text,
                     error_t (*item)(const char *part, void *context), void *context);

/* Whether path has a name that ends so: ".png". */
bool options_has_extension(const char *path, const char *extension);

/* Tells Mesa's software driver not to fuse, for off. Before the first GL context. */
void options_apply_fma(FmaChoice fma);

/* Loads the scene (a file, or a built-in scene by name) and applies camera, opacity, background
 * and arithmetic mode to it and options->desc. The caller frees the scene. */
Result options_load_scene(RenderOptions *options, Scene *out);

/* Refuses --fma where the GL driver here does not do it; call it before rendering with gl. */
Result options_check_fma(const RenderOptions *options);

/* Whether a word of a command line that was parsed is the long option `name`, which takes a value;
 * it may be abbreviated. */
bool options_is_long(const char *word, const char *name, bool *value_follows);

/* A file that the command reads, which none of its outputs may be: call it when path, which it
 * returns, is parsed. */
const char *options_input(const char *path);

/* Whether a file can be made or replaced at path (NULL is fine): found out before the work. */
Result options_check_output(const char *path);

/* The same of a command's outputs, each of which may be NULL: two files, which must not be one, nor
 * the page in the directory `report`, which is made. */
Result options_check_outputs(const char *first, const char *second, const char *report);

/* Makes a directory, and finds it writable, before minutes of work and not after. path, an argument
 * of the program: if the command fails and has written nothing into it, it goes again. */
Result options_open_directory(const char *path);
/* Removes it again where it was made and is empty. */
void options_drop_directory(void);

/* The command as a shell would take it again: argv[0] is "peel <command>", or empty to have the
 * arguments alone, each behind a space; NULL when memory is exhausted. The caller frees. */
char *options_command_line(int argc, char **argv);

/* Prints "peel: <message>", removes an empty directory that options_open_directory made, and
 * returns EXIT_BAD_INPUT. */
int options_fail(Result result);

#endif

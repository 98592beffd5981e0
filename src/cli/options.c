#define _GNU_SOURCE /* asprintf */
#include "cli/options.h"

#include "base/file.h"
#include "base/progress.h"
#include "gl/gl_renderer.h"
#include "scene/generate.h"
#include "scene/gltf_child.h"

#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- failing ---- */

static bool reported; /* a parser has printed its line */

static const char *made_directory; /* by options_open_directory; NULL: it was there, or none */

error_t options_error(const char *format, ...)
{
    char text[RESULT_LINE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    options_fail(result_fail(RESULT_BAD_INPUT, "%s", text)); /* which makes it one line */
    reported = true;
    return EINVAL;
}

void options_drop_directory(void)
{
    if (made_directory)
        rmdir(made_directory); /* if nothing is in it */
}

int options_fail(Result result)
{
    const char *message = result_message();
    fprintf(stderr, "peel: %s\n", *message ? message : result_text(result));
    options_drop_directory();
    return EXIT_BAD_INPUT;
}

/* The options of a parser and its children that a word may mean. */
typedef struct Meant {
    int whole, begun; /* whose name it is, and whose names begin so */
    bool value;       /* one of them takes a value */
} Meant;

static void find_meant(const struct argp *argp, bool is_long, const char *name, size_t length,
                       Meant *meant)
{
    const struct argp_option *option = argp->options; /* NULL: it has none */
    for (; option && (option->name || option->doc); option++) {
        bool begun = is_long ? option->name && strncmp(option->name, name, length) == 0
                             : option->key == *name;
        if (!begun)
            continue;
        bool whole = !is_long || strlen(option->name) == length;
        meant->begun++;
        meant->whole += whole;
        meant->value |= option->arg != NULL;
    }
    for (const struct argp_child *child = argp->children; child && child->argp; child++)
        find_meant(child->argp, is_long, name, length, meant);
}

/* Whether getopt would take word: no option at all, or one option of the parser. */
static bool is_known(const struct argp *argp, unsigned flags, const char *word)
{
    Meant meant = {0};
    if (word[0] != '-' || word[1] == '\0')
        return true;
    const char *name = word + 1 + (word[1] == '-');
    bool is_long = word[1] == '-' || ((flags & ARGP_LONG_ONLY) && word[2]);
    size_t length = strcspn(name, "=");
    find_meant(argp, is_long, name, length, &meant);
    bool one = meant.whole > 0 || meant.begun == 1;
    return one && (!is_long || !name[length] || meant.value);
}

static struct {
    OptionsVisit visit;
    void *context;
} description;

void options_describe(OptionsVisit visit, void *context)
{
    description.visit = visit;
    description.context = context;
}

const char *options_input(const char *path)
{
    file_keep(path);
    return path;
}

static int parse(const struct argp *argp, unsigned flags, int argc, char **argv, void *input)
{
    reported = false;
    if (description.visit) {
        description.visit(description.context, argp, flags & ARGP_LONG_ONLY);
        return OPTIONS_HELPED;
    }
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], "--help") == 0) {
            argp_help(argp, stdout, ARGP_HELP_STD_HELP & ~ARGP_HELP_EXIT_OK, argv[0]);
            return OPTIONS_HELPED;
        }
    /* getopt would print two lines of its own, and argp has hidden options. */
    error_t error = argp_parse(argp, argc, argv, ARGP_NO_ERRS | ARGP_NO_HELP | flags, NULL, input);
    if (error == 0)
        return 0;
    if (!reported) {
        const char *word = argv[argc - 1];
        for (int i = argc - 1; i > 0; i--)
            if (!is_known(argp, flags, argv[i]))
                word = argv[i];
        options_error("'%s' is no option or argument here, or lacks its value; see '%s --help'",
                      word, argv[0]);
    }
    return EXIT_BAD_INPUT;
}

int options_parse(const struct argp *argp, int argc, char **argv, void *input)
{
    return parse(argp, 0, argc, argv, input);
}

int options_parse_dash(const struct argp *argp, int argc, char **argv, void *input)
{
    return parse(argp, ARGP_LONG_ONLY, argc, argv, input);
}

/* ---- numbers ---- */

bool options_integer(const char *text, long long low, long long high, long long *out)
{
    char *end;
    errno = 0;
    long long value = strtoll(text, &end, 10);
    if (errno || isspace((unsigned char)*text) || end == text || *end || value < low ||
        value > high)
        return false;
    *out = value;
    return true;
}

bool options_real(const char *text, double low, double high, double *out)
{
    char *end;
    double value = strtod(text, &end);
    if (isspace((unsigned char)*text) || end == text || *end || !(value >= low && value <= high))
        return false;
    *out = value;
    return true;
}

error_t options_list(const char *name, const char *text,
                     error_t (*item)(const char *part, void *context), void *context)
{
    char *copy = strdup(text), *rest = copy, *part;
    error_t error = copy ? 0 : options_error("%s: out of memory", name);
    while (error == 0 && (part = strsep(&rest, ",")))
        error = *part ? item(part, context)
                      : options_error("%s '%s': expected values with commas between", name, text);
    free(copy);
    return error;
}

bool options_has_extension(const char *path, const char *extension)
{
    size_t length = strlen(path), wanted = strlen(extension);
    return length > wanted && strcasecmp(path + length - wanted, extension) == 0;
}

char *options_command_line(int argc, char **argv)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    fprintf(out, "%s%s", *argv[0] ? "build/" : "", argv[0]);
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
    (void)fclose(out);
    return text;
}

RenderOptions options_default(void)
{
    RenderOptions options = {.desc = {.width = 1280, .height = 720}, .profile = -1};
    for (int i = 0; i < SETTING_COUNT; i++)
        options.settings[i] = -1;
    return options;
}

/* ---- the scene ---- */

/* What will be written, by options_check_output. */
static const char *outputs[4];
static int output_count;

static Result load(const char *path, size_t max_memory, Scene *out)
{
    const BuiltinScene *builtin = generate_find(path);
    if (builtin) /* a file of such a name is no glTF file; a folder may be: of its page, say */
        return builtin->generate(out);
    if (access(path, F_OK) != 0 && !strpbrk(path, "./"))
        return result_fail(RESULT_IO,
                           "%s: no such file, and no built-in scene of that name; see "
                           "'peel scenes'",
                           path);
    progress_begin("loading", 0);
    Result result = gltf_child_load(path, max_memory, out);
    progress_end();
    return result;
}

static Result choose_camera(const char *text, const Scene *scene, int *out)
{
    for (size_t i = 0; i < scene->camera_count; i++)
        if (strcmp(scene->cameras[i].name, text) == 0) {
            *out = (int)i;
            return RESULT_OK;
        }
    long long index;
    if (options_integer(text, 0, (long long)scene->camera_count - 1, &index)) {
        *out = (int)index;
        return RESULT_OK;
    }
    return result_fail(RESULT_BAD_INPUT,
                       "--camera %s: the scene has no such camera, expected a name or 0 to %zu",
                       text, scene->camera_count - 1);
}

static Result apply_names(RenderOptions *options)
{
    RenderDesc *desc = &options->desc;
    if (options->profile == 1)
        render_desc_seed_profile(desc);
    for (int i = 0; i < SETTING_COUNT; i++)
        if (options->settings[i] >= 0)
            setting_put(desc, (SettingId)i, options->settings[i]);
    if (desc->gbuffer == GBUFFER_COMPACT && options->settings[SETTING_POSITION] == POSITION_BUFFER)
        return result_fail(RESULT_BAD_INPUT, "--position buffer: a compact G-buffer stores no "
                                             "positions, expected reconstruct");
    return RESULT_OK;
}

Result options_load_scene(RenderOptions *options, Scene *out)
{
    Result result = load(options->scene_path, options->desc.max_memory, out);
    if (result != RESULT_OK)
        return result;
    for (int i = 0; i < output_count && result == RESULT_OK; i++)
        result = file_check_kept(outputs[i]); /* what the scene names is known now */
    if (result == RESULT_OK && options->camera)
        result = choose_camera(options->camera, out, &options->desc.camera);
    if (result != RESULT_OK) {
        scene_free(out);
        return result;
    }
    if (options->has_opacity)
        scene_override_opacity(out, (float)options->opacity);
    for (int i = 0; options->has_background && i < 3; i++)
        out->background[i] = (float)options->background[i];
    result = apply_names(options);
    options->desc.unfused = options->fma == FMA_OFF;
    options_apply_fma(options->fma);
    if (result != RESULT_OK)
        scene_free(out);
    return result;
}

void options_apply_fma(FmaChoice fma)
{
    /* Mesa reads it at its first call, once per process: hides FMA (and AVX) from its compiler. */
    if (fma == FMA_OFF)
        setenv("GALLIUM_OVERRIDE_CPU_CAPS", "sse4.1", 1);
}

Result options_check_fma(const RenderOptions *options)
{
    bool fused;
    if (options->fma == FMA_AUTO)
        return RESULT_OK;
    Result result = gl_driver_fuses(options->desc.threads, &fused);
    if (result == RESULT_OK && fused != (options->fma == FMA_ON))
        result = result_fail(RESULT_NO_GL, "--fma %s: the GL driver here %s multiply-adds",
                             fused ? "off" : "on", fused ? "fuses" : "does not fuse");
    return result;
}

bool options_is_long(const char *word, const char *name, bool *value_follows)
{
    size_t length = strncmp(word, "--", 2) == 0 ? strcspn(word + 2, "=") : 0;
    *value_follows = length > 0 && word[2 + length] == '\0';
    return length > 0 && strncmp(word + 2, name, length) == 0;
}

/* The path of a file, that it has or will have, without links. The caller frees; NULL: none. */
static char *place_of(const char *path)
{
    char *place = realpath(path, NULL), *copy = place ? NULL : strdup(path), *joined = NULL;
    if (!copy)
        return place;
    char *slash = strrchr(copy, '/');
    const char *name = slash ? slash + 1 : copy, *folder = slash == copy ? "/" : slash ? copy : ".";
    if (slash)
        *slash = '\0';
    place = realpath(folder, NULL);
    if (place && asprintf(&joined, "%s/%s", place, name) < 0)
        joined = NULL;
    free(place);
    free(copy);
    return joined;
}

static bool same_place(const char *a, const char *b)
{
    struct stat status;
    if (stat(a, &status) == 0 && !S_ISREG(status.st_mode))
        return false; /* a device takes both */
    char *places[2] = {place_of(a), place_of(b)};
    bool same = places[0] && places[1] && strcmp(places[0], places[1]) == 0;
    free(places[0]);
    free(places[1]);
    return same;
}

Result options_check_output(const char *path)
{
    struct stat status;
    FileWriter writer;
    int error = 0;
    if (!path)
        return RESULT_OK;
    Result result = file_check_kept(path);
    if (result != RESULT_OK)
        return result;
    if (output_count < (int)(sizeof outputs / sizeof outputs[0]))
        outputs[output_count++] = path;
    bool exists = stat(path, &status) == 0;
    if (exists && S_ISDIR(status.st_mode))
        error = EISDIR;
    else if (exists && access(path, W_OK) != 0)
        error = errno;
    if (error)
        return result_fail(RESULT_IO, "%s: cannot write this file: %s", path, strerror(error));
    if (exists && !S_ISREG(status.st_mode))
        return RESULT_OK; /* opening it may wait, or end what reads it */
    result = file_writer_open(path, &writer);
    return result == RESULT_OK ? file_writer_close(&writer, false) : result;
}

/* Files of a page that an input may well be named like; what else it may be is found out when it is
 * written. */
static Result check_page(const char *report)
{
    static const char *const names[] = {"index.html", "theirs.png", "reference.png",
                                        "difference.png"};
    Result result = RESULT_OK;
    for (size_t i = 0; i < sizeof names / sizeof names[0] && result == RESULT_OK; i++) {
        char *path;
        if (asprintf(&path, "%s/%s", report, names[i]) < 0)
            return result_fail(RESULT_NO_MEMORY, "%s: out of memory", report);
        result = file_check_kept(path);
        free(path);
    }
    return result;
}

Result options_check_outputs(const char *first, const char *second, const char *report)
{
    char *page = NULL;
    Result result = report ? options_open_directory(report) : RESULT_OK;
    if (result == RESULT_OK && report && asprintf(&page, "%s/index.html", report) < 0) {
        page = NULL;
        result = result_fail(RESULT_NO_MEMORY, "%s: out of memory", report);
    }
    const char *paths[] = {first, second, page};
    for (int i = 0; i < 2; i++)
        for (int k = i + 1; k < 3 && result == RESULT_OK; k++)
            if (paths[i] && paths[k] && same_place(paths[i], paths[k]))
                result =
                    result_fail(RESULT_BAD_INPUT,
                                "%s: two outputs in one file, expected another name", paths[i]);
    free(page);
    if (result == RESULT_OK && report)
        result = check_page(report);
    if (result == RESULT_OK)
        result = options_check_output(first);
    return result == RESULT_OK ? options_check_output(second) : result;
}

Result options_open_directory(const char *path)
{
    bool there = access(path, F_OK) == 0;
    Result result = file_make_directories(path);
    if (result == RESULT_OK && !there)
        made_directory = path;
    if (result == RESULT_OK && access(path, W_OK) != 0)
        result =
            result_fail(RESULT_IO, "%s: cannot write to this directory: %s", path, strerror(errno));
    return result;
}

/* peel blend eval: a calculator of blends. */
#include "cli/bind.h"
#include "cli/options.h"
#include "cli/terminal.h"
#include "report/blend_eval.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum {
    ARITHMETICS_MOST = 128,
    WIDTH_LEAST = 40, /* columns */
    BRIEF_FROM = 17   /* layers: more than that and nobody reads every step */
};

typedef struct EvalCommand {
    const char *layers_path, *start, *json;
    BlendEquation equation;
    PixelFormat format;
    enum {
        COLOURS_DEFAULT = 0,
        COLOURS_STRAIGHT,
        COLOURS_PREMULTIPLIED
    } colours;
    bool brief, full, all;
    int width;                         /* 0: the terminal's */
    EvalNamed named[ARITHMETICS_MOST]; /* names are owned */
    size_t named_count;
    BlendLayers layers;
} EvalCommand;

enum {
    KEY_LAYERS = 0x200,
    KEY_DESTINATION,
    KEY_EQUATION,
    KEY_FORMAT,
    KEY_ARITHMETIC,
    KEY_STRAIGHT,
    KEY_PREMULTIPLIED,
    KEY_BRIEF,
    KEY_FULL,
    KEY_WIDTH,
    KEY_JSON
};

static const struct argp_option command_options[] = {
    {"layers", KEY_LAYERS, "FILE", 0, "Layers of a file, a line each (-: standard input)", 0},
    {"equation", KEY_EQUATION, "NAME", 0,
     "under (default), over, over-premultiplied, over-transmittance, add, max, weighted-sum, "
     "product, replace, keep, seed, or factors in GL's words: one,one-minus-src-alpha[:FUNC]",
     0},
    {"format", KEY_FORMAT, OPTIONS_BLEND_FORMATS, 0,
     "What is stored after each layer: rgba32f (default), rgba16f, rgba16, rgba8, rg32f, r32f", 0},
    {"arithmetic", KEY_ARITHMETIC, "A", 0,
     "exact (default), driver, another name of 'peel blend check --list', or key=value pairs; "
     "several with commas go side by side; all: every named one",
     0},
    {"straight", KEY_STRAIGHT, NULL, 0,
     "Colours are not yet multiplied by their alpha (default of under and over)", 0},
    {"premultiplied", KEY_PREMULTIPLIED, NULL, 0,
     "Colours are sources as a shader puts them out (default of the other equations)", 0},
    {"destination", KEY_DESTINATION, "R,G,B,A", 0,
     "What is there before the first layer (default: cleared)", 0},
    {"brief", KEY_BRIEF, NULL, 0, "One line a layer (default from 17 layers)", 0},
    {"full", KEY_FULL, NULL, 0, "Every step of every layer", 0},
    {"width", KEY_WIDTH, "N", 0, "Columns of the output (default: the terminal's, else 100)", 0},
    {"json", KEY_JSON, "FILE", 0, "Write all of it as JSON", 0},
    {0},
};

/* ---- options ---- */

static error_t parse_format(const char *text, PixelFormat *out)
{
    if (arithmetic_find_format(text, out))
        return 0;
    return options_error("--format %s: expected rgba32f, rgba16f, rgba16, rgba8, rg32f or r32f",
                         text);
}

static error_t add_arithmetic(const char *name, EvalCommand *command)
{
    if (command->named_count == ARITHMETICS_MOST)
        return options_error("--arithmetic %s: expected at most %d", name, ARITHMETICS_MOST);
    EvalNamed *named = &command->named[command->named_count];
    if (arithmetic_parse(name, &named->arithmetic) != RESULT_OK)
        return options_error("--%s", result_message());
    named->name = strdup(name);
    command->named_count += named->name != NULL;
    return named->name ? 0 : options_error("--arithmetic: out of memory");
}

/* Names with commas between; key=value pairs with commas between are one. */
static error_t parse_arithmetics(const char *text, EvalCommand *command)
{
    char *copy = strdup(text);
    error_t error = copy ? 0 : options_error("--arithmetic: out of memory");
    if (strcmp(text, "all") == 0) {
        command->all = true;
        free(copy);
        return error;
    }
    for (char *at = copy; at && error == 0;) {
        char *end = strchr(at, ','), *next = end ? end + 1 : NULL;
        while (end && memchr(at, '=', (size_t)(end - at)) && strchr(next, '=') &&
               strcspn(next, ",") > strcspn(next, "=")) {
            end = strchr(next, ',');
            next = end ? end + 1 : NULL;
        }
        if (end)
            *end = '\0';
        error = add_arithmetic(at, command);
        at = next;
    }
    free(copy);
    return error;
}

static error_t add_layer(const char *text, EvalCommand *command)
{
    char place[32];
    snprintf(place, sizeof place, "layer %zu", command->layers.count + 1);
    return blend_layers_add(place, text, strlen(text), &command->layers) == RESULT_OK
               ? 0
               : options_error("%s", result_message());
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    EvalCommand *command = state->input;
    switch (key) {
    case KEY_LAYERS:
        command->layers_path = options_input(argument);
        return 0;
    case KEY_EQUATION:
        return equation_parse(argument, &command->equation) == RESULT_OK
                   ? 0
                   : options_error("--%s", result_message());
    case KEY_FORMAT:
        return parse_format(argument, &command->format);
    case KEY_ARITHMETIC:
        return parse_arithmetics(argument, command);
    case KEY_STRAIGHT:
    case KEY_PREMULTIPLIED:
        command->colours = key == KEY_STRAIGHT ? COLOURS_STRAIGHT : COLOURS_PREMULTIPLIED;
        return 0;
    case KEY_DESTINATION:
        command->start = argument;
        return 0;
    case KEY_BRIEF:
    case KEY_FULL:
        command->brief = key == KEY_BRIEF;
        command->full = key == KEY_FULL;
        return 0;
    case KEY_WIDTH:
        return options_count("--width", argument, WIDTH_LEAST, 1000, &command->width);
    case KEY_JSON:
        command->json = argument;
        return 0;
    case ARGP_KEY_ARG:
        return add_layer(argument, command);
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp command_argp = {
    command_options,
    parse,
    "[R,G,B,A...]",
    "Blends layers, front to back, and shows every number on the way: operands, factors, products, "
    "sums, what is stored, and what each rounding adds, in decimal, as hexadecimal float and as "
    "exact fraction. A layer is red,green,blue,alpha: 0.5, 1/3, 128/255, 0x1p-1, inf, nan, or a "
    "code #rrggbbaa.\v"
    "Half a red pane in front of half a green one, in 8 bits:\n\n"
    "  peel blend eval --format rgba8 '#ff000080' '#00ff0080'\n\n"
    "Of the green, T*a*c = 127/255 * 128/255 = 63.749/255 arrives, which no code is: 64 is "
    "stored, 0.251 codes too much. --arithmetic exact,driver shows beside it how a GL driver gets "
    "there, --arithmetic all what other programs make of it.\n\n"
    "Thirds, which are no floats, in four layers, a line each:\n\n"
    "  peel blend eval --brief $(yes 1/3,1/3,1/3,1/3 | head -4)\n\n"
    "It should let through 16/81, and stores 1.9 units in the last place (ULP) less. Under and "
    "over give the same light by other roundings: the last table shows both.",
    NULL,
    NULL,
    NULL};

static void free_words(int count, char **words)
{
    for (int i = 0; i < count; i++)
        free(words[i]);
    free(words);
}

/* Numbers may begin with a minus, which getopt would take for an option: with a blank before it it
 * does not, and the numbers' reader skips blanks. Returns the arguments, argc of them, each to be
 * freed; NULL without memory. */
static char **protect_numbers(int argc, char **argv)
{
    char **out = calloc((size_t)argc + 1, sizeof *out);
    for (int i = 0; out && i < argc; i++) {
        const char *word = argv[i];
        bool number = word[0] == '-' && (isdigit((unsigned char)word[1]) || word[1] == '.' ||
                                         strncasecmp(word + 1, "inf", 3) == 0 ||
                                         strncasecmp(word + 1, "nan", 3) == 0);
        out[i] = malloc(strlen(word) + 2);
        if (!out[i]) {
            free_words(i, out);
            return NULL;
        }
        sprintf(out[i], "%s%s", number ? " " : "", word);
    }
    return out;
}

/* ---- the work ---- */

/* NULL unless colours have to be multiplied by alpha; *multiply says so. */
static Result choose_colours(const EvalCommand *command, bool *multiply)
{
    const BlendEquation *equation = &command->equation;
    bool ordered = equation_id(equation) == EQUATION_UNDER || blend_eval_is_over(equation);
    *multiply =
        command->colours == COLOURS_STRAIGHT || (command->colours == COLOURS_DEFAULT && ordered);
    if (!blend_eval_takes_straight(equation))
        return RESULT_OK;
    *multiply = false;
    if (command->colours == COLOURS_PREMULTIPLIED && equation_id(equation) == EQUATION_OVER)
        return result_fail(RESULT_BAD_INPUT, "--premultiplied: over takes straight colours, "
                                             "expected --equation over-premultiplied");
    return RESULT_OK;
}

static bool is_wrong(const char *name, PixelFormat format)
{
    for (size_t i = 0; i < arithmetic_count(); i++)
        if (strcmp(name, arithmetic_info(i)->name) == 0)
            return arithmetic_is_wrong(arithmetic_info(i), format);
    return false;
}

/* The named arithmetics, without those that are not defined here, unless they were asked for. */
static Result choose_arithmetics(EvalCommand *command)
{
    for (size_t i = 0; command->all && i < arithmetic_count(); i++) {
        const ArithmeticInfo *info = arithmetic_info(i);
        if (!arithmetic_refuses(&info->arithmetic, &command->equation, command->format) &&
            add_arithmetic(info->name, command))
            return result_fail(RESULT_NO_MEMORY, "--arithmetic: out of memory");
    }
    if (command->named_count == 0 && add_arithmetic("exact", command))
        return result_fail(RESULT_NO_MEMORY, "--arithmetic: out of memory");
    for (size_t i = 0; i < command->named_count; i++) {
        EvalNamed *named = &command->named[i];
        const char *refusal =
            arithmetic_refuses(&named->arithmetic, &command->equation, command->format);
        if (refusal)
            return result_fail(RESULT_UNSUPPORTED, "--arithmetic %s: %s: %s", named->name,
                               format_info(command->format)->name, refusal);
        named->wrong = is_wrong(named->name, command->format);
    }
    return RESULT_OK;
}

static Result evaluate(EvalCommand *command, BlendColour *start)
{
    EvalDesc desc = {.equation = command->equation,
                     .format = command->format,
                     .layers = &command->layers,
                     .start = command->start ? start : NULL};
    EvalView view = {.width = command->width ? command->width : terminal_columns(WIDTH_LEAST),
                     .colour = terminal_has_colour()};
    Result result = options_check_output(command->json);
    if (result == RESULT_OK)
        result = choose_colours(command, &desc.multiply);
    if (result == RESULT_OK && command->start)
        result = blend_colour_read("--destination", command->start, strlen(command->start),
                                   format_info(command->format)->channels, start);
    if (result == RESULT_OK && command->layers_path)
        result = blend_layers_load(command->layers_path, &command->layers);
    if (result == RESULT_OK && command->layers.count == 0)
        result = result_fail(RESULT_BAD_INPUT, "blend eval: no layers: expected R,G,B,A for each, "
                                               "or --layers FILE");
    if (result == RESULT_OK)
        result = choose_arithmetics(command);
    if (result != RESULT_OK)
        return result;
    view.brief = command->brief || (!command->full && command->layers.count >= BRIEF_FROM);
    result = report_blend_eval_print(&desc, command->named, command->named_count, &view, stdout);
    fflush(stdout); /* before a --json /dev/stdout */
    if (result == RESULT_OK && command->json)
        result = report_blend_eval_json(&desc, command->named, command->named_count, command->json);
    return result;
}

int cmd_blend_eval(int argc, char **argv)
{
    EvalCommand command = {.equation = equation_info(EQUATION_UNDER)->equation};
    char **words = protect_numbers(argc, argv);
    if (!words)
        return options_fail(result_fail(RESULT_NO_MEMORY, "out of memory"));
    int code = options_parse(&command_argp, argc, words, &command);
    if (code == 0) {
        BlendColour start;
        blend_colour_init(&start);
        Result result = evaluate(&command, &start);
        blend_colour_clear(&start);
        code = result == RESULT_OK ? EXIT_AGREE : options_fail(result);
    }
    for (size_t i = 0; i < command.named_count; i++)
        free((char *)command.named[i].name);
    blend_layers_free(&command.layers);
    free_words(argc, words); /* argp moves them about, but loses none */
    return code == OPTIONS_HELPED ? EXIT_AGREE : code;
}

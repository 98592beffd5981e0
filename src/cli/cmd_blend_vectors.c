/* peel blend vectors: test vectors of blending, with results. */
#include "base/progress.h"
#include "blend/sequence.h"
#include "blend/vector_results.h"
#include "cli/bind.h"
#include "cli/options.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    RANDOM_COUNT = 65536
};

typedef struct VectorsCommand {
    VectorHeader header;
    Arithmetic arithmetic;
    const char *output, *arithmetic_name;
    VectorForm form;
    int threads; /* 0: one per processor */
    bool has_set, has_format, has_form, has_equation, has_count;
    bool all, checksum, list;
} VectorsCommand;

enum {
    KEY_SET = 0x300,
    KEY_FORMAT,
    KEY_EQUATION,
    KEY_ARITHMETIC,
    KEY_SEED,
    KEY_COUNT,
    KEY_FIRST,
    KEY_FORM,
    KEY_CHECKSUM,
    KEY_LIST,
    KEY_THREADS
};

static const struct argp_option vectors_options[] = {
    {"set", KEY_SET, "exhaustive|directed|random|sequences", 0,
     "exhaustive (default of rgba8: all triples of codes), directed (default else: special values "
     "and constructed cases), random, or sequences (2 to 256 layers, front to back)",
     0},
    {"format", KEY_FORMAT, OPTIONS_BLEND_FORMATS, 0,
     "rgba8 (default), rgba16, rgba16f, rgba32f, rg32f or r32f", 0},
    {"equation", KEY_EQUATION, "EQUATION", 0,
     "A name (--list) or factors in GL's words: 'one,one-minus-src-alpha', 'one,one:max'. Default "
     "under",
     0},
    {"arithmetic", KEY_ARITHMETIC, "NAME", 0,
     "Whose results to write: a name (--list), or fields as 'precision=float,store=truncate'. "
     "Default exact. all, with --checksum: every named one",
     0},
    {"seed", KEY_SEED, "N", 0, "Of random and sequences (default 1)", 0},
    {"count", KEY_COUNT, "N", 0, "How many (default: the whole set; of random 65536)", 0},
    {"first", KEY_FIRST, "N", 0, "The index of the first (default 0)", 0},
    {"form", KEY_FORM, "csv|jsonl|bin", 0,
     "csv, jsonl or bin (default: by the ending of FILE, .csv, .jsonl or .bin; else csv)", 0},
    {"output", 'o', "FILE", 0, "Write to FILE (default, and -: standard output)", 0},
    {"checksum", KEY_CHECKSUM, 0, 0,
     "Instead of the vectors print the SHA-256 of the operands and of the results", 0},
    {"threads", KEY_THREADS, "N", 0, "Of --checksum (default: one per processor)", 0},
    {"list", KEY_LIST, 0, 0, "Print the sets, equations and arithmetics, and end", 0},
    {0},
};

/* ---- the command line ---- */

static error_t set_set(const char *text, VectorsCommand *command)
{
    for (int i = 0; i < VECTORS_SET_COUNT; i++)
        if (strcmp(text, vectors_set_name((VectorSet)i)) == 0) {
            command->header.spec.set = (VectorSet)i;
            command->has_set = true;
            return 0;
        }
    return options_error("--set %s: expected exhaustive, directed, random or sequences", text);
}

static error_t set_format(const char *text, VectorsCommand *command)
{
    if (arithmetic_find_format(text, &command->header.spec.format)) {
        command->has_format = true;
        return 0;
    }
    return options_error("--format %s: expected rgba8, rgba16, rgba16f, rgba32f, rg32f or r32f",
                         text);
}

/* What names of files end in; without the dot they are names of the forms too. */
static const struct {
    const char *ending;
    VectorForm form;
} endings[] = {{".csv", VECTOR_CSV},
               {".jsonl", VECTOR_JSON_LINES},
               {".ndjson", VECTOR_JSON_LINES},
               {".bin", VECTOR_BINARY}};
enum {
    ENDINGS = sizeof endings / sizeof *endings
};

static error_t set_form(const char *text, VectorsCommand *command)
{
    command->has_form = true;
    for (int i = 0; i < ENDINGS; i++)
        if (strcmp(text, endings[i].ending + 1) == 0 ||
            strcmp(text, vector_form_name(endings[i].form)) == 0) {
            command->form = endings[i].form;
            return 0;
        }
    return options_error("--form %s: expected csv, jsonl or bin", text);
}

static error_t set_number(const char *name, const char *text, uint64_t *out)
{
    long long value;
    if (!options_integer(text, 0, VECTORS_NUMBER_MAX, &value))
        return options_error("--%s %s: expected an integer from 0 to 2^53 - 1", name, text);
    *out = (uint64_t)value;
    return 0;
}

static error_t set_arithmetic(const char *text, VectorsCommand *command)
{
    command->all = strcmp(text, "all") == 0;
    command->arithmetic_name = text;
    if (command->all || arithmetic_parse(text, &command->arithmetic) == RESULT_OK)
        return 0;
    return options_error("--%s", result_message());
}

static error_t set_equation(const char *text, VectorsCommand *command)
{
    command->has_equation = true;
    return equation_parse(text, &command->header.equation) == RESULT_OK
               ? 0
               : options_error("--%s", result_message());
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    VectorsCommand *command = state->input;
    switch (key) {
    case KEY_SET:
        return set_set(argument, command);
    case KEY_FORMAT:
        return set_format(argument, command);
    case KEY_EQUATION:
        return set_equation(argument, command);
    case KEY_ARITHMETIC:
        return set_arithmetic(argument, command);
    case KEY_SEED:
        return set_number("seed", argument, &command->header.spec.seed);
    case KEY_COUNT:
        command->has_count = true;
        return set_number("count", argument, &command->header.count);
    case KEY_FIRST:
        return set_number("first", argument, &command->header.first);
    case KEY_FORM:
        return set_form(argument, command);
    case 'o':
        command->output = argument;
        return 0;
    case KEY_THREADS:
        return options_count("--threads", argument, 1, THREADS_MAX, &command->threads);
    case KEY_CHECKSUM:
        command->checksum = true;
        return 0;
    case KEY_LIST:
        command->list = true;
        return 0;
    case ARGP_KEY_ARG:
        return options_error("'%s': expected no arguments but options", argument);
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp vectors_argp = {
    vectors_options,
    parse,
    "",
    "Writes what to blend, and what an arithmetic makes of it, for comparing another "
    "implementation: replace the results by its own and give the file to 'peel blend check', or "
    "compare checksums.\v"
    "The same options write the same bytes on every machine. --checksum is of raw bytes: let your "
    "program blend the vectors in their order and write every resulting pixel as it is stored, "
    "little-endian (of sequences the last pixel of each). Then\n"
    "\n"
    "  peel blend vectors --format rgba8 --checksum --arithmetic all\n"
    "  sha256sum results.bin\n"
    "\n"
    "names the arithmetic whose line has the same sum; 'operands' is the sum of each vector's "
    "source (four floats) and destination pixel.\n"
    "\n"
    "  peel blend vectors --format rgba16f --equation over -o over.csv\n"
    "  peel blend vectors --set random --seed 7 --count 1000 --form jsonl\n"
    "  peel blend vectors --set sequences --format rgba16f -o layers.csv\n",
    NULL,
    NULL,
    NULL};

/* ---- what is asked for ---- */

static Result choose_range(VectorsCommand *command)
{
    VectorHeader *header = &command->header;
    bool counted = header->spec.set == VECTORS_RANDOM || header->spec.set == VECTORS_SEQUENCES;
    uint64_t usual = header->spec.set == VECTORS_RANDOM ? RANDOM_COUNT : SEQUENCE_COUNT;
    if (!counted) {
        uint64_t all = vectors_count(&header->spec);
        if (!command->has_count)
            header->count = header->first < all ? all - header->first : 0;
        if (header->first >= all || header->count > all - header->first)
            return result_fail(RESULT_BAD_INPUT,
                               "--first %" PRIu64 " --count %" PRIu64 ": the set has %" PRIu64
                               " vectors",
                               header->first, header->count, all);
    } else if (!command->has_count) {
        header->count = usual;
    }
    header->spec.count = header->first + header->count;
    if (header->count == 0)
        return result_fail(RESULT_BAD_INPUT, "--count 0: expected at least 1");
    return vectors_check(&header->spec);
}

static Result choose_equation(VectorsCommand *command)
{
    BlendEquation *equation = &command->header.equation;
    if (!command->has_equation)
        *equation = equation_info(EQUATION_UNDER)->equation;
    if (command->header.spec.set == VECTORS_SEQUENCES && equation_id(equation) != EQUATION_UNDER)
        return result_fail(RESULT_BAD_INPUT, "--set sequences: expected --equation under");
    const char *refused = command->all ? NULL
                                       : arithmetic_refuses(&command->arithmetic, equation,
                                                            command->header.spec.format);
    if (refused)
        return result_fail(RESULT_BAD_INPUT, "--arithmetic %s: %s", command->arithmetic_name,
                           refused);
    return RESULT_OK;
}

static Result choose_form(VectorsCommand *command)
{
    const char *output = command->output;
    if (command->has_form || strcmp(output, "-") == 0 || strncmp(output, "/dev/", 5) == 0)
        return RESULT_OK;
    for (int i = 0; i < ENDINGS; i++)
        if (options_has_extension(output, endings[i].ending)) {
            command->form = endings[i].form;
            return RESULT_OK;
        }
    return result_fail(RESULT_BAD_INPUT,
                       "-o %s: expected a name ending in .csv, .jsonl or .bin, or --form", output);
}

static Result choose(VectorsCommand *command)
{
    VectorHeader *header = &command->header;
    if (!command->has_format)
        header->spec.format = FORMAT_RGBA8;
    if (!command->has_set)
        header->spec.set =
            header->spec.format == FORMAT_RGBA8 ? VECTORS_EXHAUSTIVE : VECTORS_DIRECTED;
    if (!command->output)
        command->output = "-";
    snprintf(header->arithmetic, sizeof header->arithmetic, "%s", command->arithmetic_name);
    Result result = vectors_check(&header->spec);
    if (result == RESULT_OK)
        result = choose_range(command);
    if (result == RESULT_OK)
        result = choose_equation(command);
    if (result == RESULT_OK && command->all && !command->checksum)
        result = result_fail(RESULT_BAD_INPUT, "--arithmetic all: expected --checksum");
    if (result == RESULT_OK && command->checksum && strcmp(command->output, "-") != 0)
        result = result_fail(RESULT_BAD_INPUT, "--checksum: expected no -o, it prints");
    if (result == RESULT_OK && command->checksum && command->has_form)
        result = result_fail(RESULT_BAD_INPUT, "--checksum: expected no --form, it prints");
    if (result == RESULT_OK && command->threads && !command->checksum)
        result = result_fail(RESULT_BAD_INPUT, "--threads: expected --checksum");
    if (result == RESULT_OK && !command->checksum)
        result = choose_form(command);
    if (result == RESULT_OK && !command->checksum && command->form == VECTOR_BINARY &&
        strcmp(command->output, "-") == 0 && isatty(STDOUT_FILENO))
        result = result_fail(RESULT_BAD_INPUT, "--form bin: expected -o FILE, or a pipe");
    return result;
}

/* ---- what is done ---- */

static void print_list(void)
{
    printf("Sets\n");
    for (int f = 0; f < ARITHMETIC_FORMATS; f++)
        for (int s = 0; s < VECTORS_SET_COUNT; s++) {
            VectorSpec spec = {(VectorSet)s, arithmetic_formats[f], 0, 0};
            if (vectors_check(&spec) != RESULT_OK)
                continue;
            printf("  %-8s %-11s", format_info(arithmetic_formats[f])->name,
                   vectors_set_name(spec.set));
            if (vectors_count(&spec))
                printf("%" PRIu64 " vectors", vectors_count(&spec));
            else
                printf("as many as --count says");
            printf("\n");
        }
    printf("\nEquations\n");
    for (int i = 0; i < EQUATION_COUNT; i++) {
        const EquationInfo *info = equation_info((EquationId)i);
        printf("  %-20s %s\n", info->name, info->what);
    }
    printf("\nArithmetics (* wrong)\n");
    for (size_t i = 0; i < arithmetic_count(); i++) {
        const ArithmeticInfo *info = arithmetic_info(i);
        printf("%c %-28s %s\n", info->wrong ? '*' : ' ', info->name, info->what);
    }
}

static Result print_checksums(const VectorsCommand *command)
{
    const VectorHeader *header = &command->header;
    size_t most = arithmetic_count() + 1, count = 0;
    const Arithmetic **arithmetics = calloc(most, sizeof *arithmetics);
    const char **names = calloc(most, sizeof *names);
    char(*sums)[VECTOR_DIGEST_TEXT] = calloc(most, sizeof *sums), operands[VECTOR_DIGEST_TEXT];
    Result result = arithmetics && names && sums
                        ? RESULT_OK
                        : result_fail(RESULT_NO_MEMORY, "checksums: out of memory");
    for (size_t i = 0; i + 1 < most && command->all && result == RESULT_OK; i++) {
        const ArithmeticInfo *info = arithmetic_info(i);
        if (arithmetic_refuses(&info->arithmetic, &header->equation, header->spec.format))
            continue;
        arithmetics[count] = &info->arithmetic;
        names[count++] = info->name;
    }
    if (!command->all && result == RESULT_OK) {
        arithmetics[count] = &command->arithmetic;
        names[count++] = command->arithmetic_name;
    }
    if (result == RESULT_OK)
        result =
            vector_results_checksums(header, count, arithmetics, command->threads, operands, sums);
    if (result == RESULT_OK)
        printf("%s  operands\n", operands);
    for (size_t i = 0; i < count && result == RESULT_OK; i++)
        printf("%s  %s\n", sums[i], names[i]);
    free(arithmetics);
    free(names);
    free(sums);
    return result;
}

int cmd_blend_vectors(int argc, char **argv)
{
    VectorsCommand command = {.header = {.spec = {.seed = 1}}, .arithmetic_name = "exact"};
    int code = options_parse(&vectors_argp, argc, argv, &command);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    signal(SIGPIPE, SIG_IGN); /* a reader that went away is an error of writing */
    if (command.list) {
        if (command.output || command.checksum)
            return options_fail(
                result_fail(RESULT_BAD_INPUT, "--list: expected neither -o nor --checksum"));
        print_list();
        return EXIT_AGREE;
    }
    Result result = choose(&command);
    if (!command.checksum && strcmp(command.output, "-") == 0 && isatty(STDOUT_FILENO))
        progress_off();
    if (result == RESULT_OK && command.checksum)
        result = print_checksums(&command);
    else if (result == RESULT_OK)
        result = vector_results_write(command.output, command.form, &command.header,
                                      &command.arithmetic);
    return result == RESULT_OK ? EXIT_AGREE : options_fail(result);
}

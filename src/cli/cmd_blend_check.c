/* peel blend check: whose arithmetic somebody's results for test vectors are. */
#include "blend/vector_file.h"
#include "cli/bind.h"
#include "cli/blend_check.h"
#include "report/blend_check.h"

#include "base/memory.h"
#include "base/progress.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    KEY_AGAINST = 0x400,
    KEY_FAIL,
    KEY_WARN,
    KEY_API,
    KEY_JSON,
    KEY_WORST,
    KEY_GL,
    KEY_FORMAT,
    KEY_EQUATION,
    KEY_SET,
    KEY_LIMIT,
    KEY_SEED,
    KEY_THREADS,
    KEY_FMA,
    KEY_LIST,
    WORST_DEFAULT = 3,
    WORST_MAX = 1000,
    LIST_EFFORT = 6000 /* vectors looked at for each format and equation */
};

static const struct argp_option command_options[] = {
    {0, 0, 0, 0, "A file of results:", 1},
    {"against", KEY_AGAINST, "ARITHMETIC", 0,
     "Judge by this one alone: a name of --list, or its fields as key=value", 1},
    {"fail", KEY_FAIL, "N", 0, "With --against: exit 2 above N ULP, or codes (default 0)", 1},
    {"warn", KEY_WARN, "N", 0, "With --against: exit 1 above N ULP, or codes (default 0)", 1},
    {"api", KEY_API, "gl|vulkan|d3d11|any", 0,
     "Whose rules count for the exit code: gl, vulkan, d3d11 or any (default: outside only where "
     "none of them is kept)",
     1},
    {0, 0, 0, 0, "The local GL driver instead of a file:", 2},
    {"gl", KEY_GL, OPTIONS_GL_NAMES, OPTION_ARG_OPTIONAL,
     "Blend all vectors with it: osmesa (default) or egl", 2},
    {"format", KEY_FORMAT, OPTIONS_BLEND_FORMATS, 0,
     "These formats (default all), with commas between", 2},
    {"equation", KEY_EQUATION, "E", 0, "A name or factors (default: all that have a name)", 2},
    {"set", KEY_SET, "S", 0, "exhaustive, directed, random, with commas between (default all)", 2},
    {"limit", KEY_LIMIT, "N", 0, "At most N vectors of each set, spread over it", 2},
    {"seed", KEY_SEED, "N", 0, "Of the random vectors (default 0)", 2},
    {"fma", KEY_FMA, "on|off", 0,
     "Whether Mesa's software driver fuses multiply-adds (default: as the processor can)", 2},
    {0, 0, 0, 0, "What there is:", 3},
    {"list", KEY_LIST, 0, 0,
     "Every named arithmetic, and by format (and with --verbose by equation) the simplest vector "
     "that shows each wrong one",
     3},
    {0, 0, 0, 0, "What is said:", 4},
    {"json", KEY_JSON, "FILE", 0, "Every figure", 4},
    {"worst", KEY_WORST, "N", 0, "So many of the worst values, with their steps (default 3)", 4},
    {"verbose", 'v', 0, 0, "Every arithmetic, and every row", 4},
    {"threads", KEY_THREADS, "N", 0, "Threads that compare (default: one per processor)", 4},
    {0},
};

static error_t parse_ulp(const char *name, const char *text, uint32_t *out)
{
    long long value;
    if (!options_integer(text, 0, UINT32_MAX - 1, &value))
        return options_error("%s %s: expected a whole number from 0", name, text);
    *out = (uint32_t)value;
    return 0;
}

static error_t parse_against(const char *text, BlendCheckCommand *command)
{
    if (arithmetic_parse(text, &command->against) != RESULT_OK)
        return options_error("--against: %s", result_message());
    command->has_against = true;
    return 0;
}

static error_t parse_api(const char *text, BlendApi *out)
{
    for (int i = 0; i < API_SUITE; i++)
        if (strcmp(text, blend_api_name((BlendApi)i)) == 0) {
            *out = (BlendApi)i;
            return 0;
        }
    *out = API_COUNT;
    return strcmp(text, "any") == 0
               ? 0
               : options_error("--api %s: expected gl, vulkan, d3d11 or any", text);
}

static error_t parse_format(const char *text, void *context)
{
    BlendCheckCommand *command = context;
    for (int i = 0; i < ARITHMETIC_FORMATS; i++)
        if (strcmp(text, format_info(arithmetic_formats[i])->name) == 0) {
            command->formats |= 1u << i;
            return 0;
        }
    return options_error("--format %s: expected rgba8, rgba16, rgba16f, rgba32f, rg32f or r32f",
                         text);
}

static error_t parse_set(const char *text, void *context)
{
    BlendCheckCommand *command = context;
    for (int i = 0; i < VECTORS_SET_COUNT; i++)
        if (i != VECTORS_SEQUENCES && strcmp(text, vectors_set_name((VectorSet)i)) == 0) {
            command->sets |= 1u << i;
            return 0;
        }
    return options_error("--set %s: expected exhaustive, directed or random", text);
}

static error_t parse_equation(const char *text, BlendCheckCommand *command)
{
    if (equation_parse(text, &command->equation) != RESULT_OK)
        return options_error("--%s", result_message());
    command->has_equation = true;
    return 0;
}

static error_t parse_count(const char *name, const char *text, long long low, uint64_t *out)
{
    long long value;
    if (!options_integer(text, low, INT64_MAX, &value))
        return options_error("%s %s: expected a whole number from %lld", name, text, low);
    *out = (uint64_t)value;
    return 0;
}

static error_t parse_gl(const char *argument, BlendCheckCommand *command)
{
    command->gl = true;
    return argument ? options_gl(argument) : 0;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    BlendCheckCommand *command = state->input;
    switch (key) {
    case KEY_AGAINST:
        return parse_against(argument, command);
    case KEY_FAIL:
        return parse_ulp("--fail", argument, &command->fail);
    case KEY_WARN:
        return parse_ulp("--warn", argument, &command->warn);
    case KEY_API:
        return parse_api(argument, &command->api);
    case KEY_GL:
        return parse_gl(argument, command);
    case KEY_FORMAT:
        return options_list("--format", argument, parse_format, command);
    case KEY_EQUATION:
        return parse_equation(argument, command);
    case KEY_SET:
        return options_list("--set", argument, parse_set, command);
    case KEY_LIMIT:
        return parse_count("--limit", argument, 1, &command->limit);
    case KEY_SEED:
        return parse_count("--seed", argument, 0, &command->seed);
    case KEY_THREADS:
        return options_count("--threads", argument, 1, THREADS_MAX, &command->threads);
    case KEY_FMA:
        return options_fma(argument, &command->fma);
    case KEY_LIST:
        command->list = true;
        return 0;
    case KEY_JSON:
        command->json = argument;
        return 0;
    case KEY_WORST:
        return options_count("--worst", argument, 0, WORST_MAX, &command->worst);
    case 'v':
        command->verbose = true;
        return 0;
    case ARGP_KEY_ARG:
        if (command->path)
            return options_error("'%s': check takes one FILE", argument);
        command->path = options_input(argument);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp command_argp = {
    command_options,
    parse,
    "[FILE]",
    "Says whose arithmetic made the results in FILE (of 'peel blend vectors'; '-': standard "
    "input), how many values differ from each, by how much, and whether they are within what "
    "OpenGL, Vulkan and Direct3D allow; --gl: the same of the local driver's blending.\vExit code "
    "0 when all results are a right named arithmetic's, 1 when they are within the rules but no "
    "named arithmetic's, 2 when they are outside the rules or a named wrong arithmetic's, 4 for a "
    "bad file or option. With --against: 0 up to --warn, 1 up to --fail, 2 above; of --gl: the "
    "worst row's.",
    NULL,
    NULL,
    NULL};

/* ---- a file ---------------------------------------------------------------------------------- */

typedef struct Block {
    float (*source)[4];
    void *destination, *results;
    bool *given; /* of sequences */
} Block;

static Result make_block(PixelFormat format, Block *out)
{
    size_t count = VECTOR_BLOCK, bytes = format_pixel_bytes(format);
    *out = (Block){memory_array(count, sizeof *out->source), memory_array(count, bytes),
                   memory_array(count, bytes), memory_array(count, sizeof *out->given)};
    return out->source && out->destination && out->results && out->given ? RESULT_OK
                                                                         : RESULT_NO_MEMORY;
}

static void free_block(Block *block)
{
    free(block->source);
    free(block->destination);
    free(block->results);
    free(block->given);
}

static Result stream(VectorReader *reader, const VectorHeader *header, BlendCheck *check)
{
    Block block;
    uint64_t index = header->first;
    size_t count = 1;
    Result result = make_block(header->spec.format, &block);
    progress_begin("vectors", header->count);
    while (result == RESULT_OK && count > 0) {
        result = vector_reader_next(reader, block.source, block.destination, block.results, &count);
        if (result == RESULT_OK && count > 0)
            result =
                blend_check_add(check, header->spec.set, index, count,
                                (const float(*)[4])block.source, block.destination, block.results);
        index += count;
        progress_step(index - header->first);
    }
    progress_end();
    free_block(&block);
    return result;
}

/* --against: what its greatest difference says. */
static int against_code(const BlendCheckCommand *command, const BlendReport *report)
{
    const BlendTally *groups = report->candidates[0].groups;
    uint32_t most = groups[GROUP_COLOR].max_ulp > groups[GROUP_ALPHA].max_ulp
                        ? groups[GROUP_COLOR].max_ulp
                        : groups[GROUP_ALPHA].max_ulp;
    uint32_t warn = command->warn, fail = command->fail > warn ? command->fail : warn;
    return most > fail ? EXIT_DIFFER : most > warn ? EXIT_WARN : EXIT_AGREE;
}

int blend_check_code(const BlendCheckCommand *command, const BlendReport *report)
{
    static const int codes[] = {[BLEND_NAMED] = EXIT_AGREE,
                                [BLEND_UNNAMED] = EXIT_WARN,
                                [BLEND_WRONG] = EXIT_DIFFER,
                                [BLEND_OUTSIDE] = EXIT_DIFFER};
    if (report->has_against)
        return against_code(command, report);
    return codes[blend_verdict(report, command->api)];
}

static Result say(const BlendCheckCommand *command, const VectorHeader *header,
                  const BlendReport *report, int *code)
{
    char vectors[80];
    snprintf(vectors, sizeof vectors, "%s vectors %llu to %llu", vectors_set_name(header->spec.set),
             (unsigned long long)header->first,
             (unsigned long long)(header->first + report->vectors - 1));
    *code = blend_check_code(command, report);
    ReportBlend blend = {.report = report,
                         .api = command->api,
                         .note = header->arithmetic,
                         .subject = command->path,
                         .vectors = vectors,
                         .verbose = command->verbose,
                         .code = *code};
    Result result = report_blend_print(&blend, stdout);
    fflush(stdout); /* before a --json /dev/stdout */
    if (result == RESULT_OK && command->json)
        result = report_blend_json(&blend, 1, command->json);
    return result;
}

static Result check_vectors(const BlendCheckCommand *command, VectorReader *reader,
                            const VectorHeader *header, int *code)
{
    BlendCheck *check = NULL;
    BlendReport report = {0};
    BlendCheckDesc desc = {.format = header->spec.format,
                           .equation = header->equation,
                           .against = command->has_against ? &command->against : NULL,
                           .worst = command->worst,
                           .threads = command->threads,
                           .every = command->verbose};
    const char *refused =
        desc.against ? arithmetic_refuses(desc.against, &desc.equation, desc.format) : NULL;
    if (refused)
        return result_fail(RESULT_BAD_INPUT, "--against: %s", refused);
    Result result = blend_check_open(&desc, &check);
    if (result == RESULT_OK)
        result = stream(reader, header, check);
    if (result == RESULT_OK) {
        blend_check_finish(check, &report);
        result = report.vectors ? say(command, header, &report, code)
                                : result_fail(RESULT_BAD_INPUT, "%s: expected at least one vector",
                                              command->path);
    }
    blend_report_free(&report);
    blend_check_close(check);
    return result;
}

static int sequences_code(const SequenceReport *report)
{
    size_t best = sequence_report_best(report);
    if (best != SIZE_MAX)
        return arithmetic_is_wrong(report->candidates[best].info, report->format) ? EXIT_DIFFER
                                                                                  : EXIT_AGREE;
    return report->outside ? EXIT_DIFFER : EXIT_WARN;
}

static Result check_sequences(const BlendCheckCommand *command, VectorReader *reader,
                              const VectorHeader *header, int *code)
{
    Block block;
    SequenceReport report;
    int layers = 1;
    Result result = make_block(header->spec.format, &block);
    if (result == RESULT_OK && command->has_against)
        result = result_fail(RESULT_BAD_INPUT, "%s: --against is not for sequences", command->path);
    if (result == RESULT_OK)
        result = sequence_report_start(header->spec.format, &report);
    else
        report = (SequenceReport){0};
    progress_begin("sequences", header->count);
    for (uint64_t i = 0; result == RESULT_OK && layers > 0; i++) {
        result =
            vector_reader_next_sequence(reader, &layers, block.source, block.results, block.given);
        if (result == RESULT_OK && layers > 0)
            result =
                sequence_report_add(&report, header->first + i, layers,
                                    (const float(*)[4])block.source, block.results, block.given);
        progress_step(i);
    }
    progress_end();
    if (result == RESULT_OK && report.sequences == 0)
        result = result_fail(RESULT_BAD_INPUT, "%s: expected at least one sequence", command->path);
    if (result == RESULT_OK) {
        *code = sequences_code(&report);
        report_blend_sequences(&report, command->path, stdout);
        fflush(stdout);
        if (command->json)
            result = report_blend_sequences_json(&report, command->path, *code, command->json);
    }
    sequence_report_free(&report);
    free_block(&block);
    return result;
}

static Result check_file(const BlendCheckCommand *command, int *code)
{
    VectorReader *reader = NULL;
    VectorHeader header;
    Result result = vector_reader_open(command->path, &header, &reader);
    if (result == RESULT_OK)
        result = header.spec.set == VECTORS_SEQUENCES
                     ? check_sequences(command, reader, &header, code)
                     : check_vectors(command, reader, &header, code);
    vector_reader_close(reader);
    return result;
}

/* ---- the list -------------------------------------------------------------------------------- */

static Result print_list(const BlendCheckCommand *command)
{
    BlendWrongList list;
    EquationId equation = command->has_equation ? equation_id(&command->equation) : EQUATION_COUNT;
    if (command->has_equation && equation == EQUATION_COUNT)
        return result_fail(RESULT_BAD_INPUT, "--list --equation: expected a name");
    progress_begin("vectors that show wrong arithmetics", 0);
    Result result = blend_wrong_list(command->formats, equation, LIST_EFFORT, &list);
    progress_end();
    if (result != RESULT_OK)
        return result;
    report_blend_list(&list, command->verbose, stdout);
    fflush(stdout);
    if (command->json)
        result = report_blend_list_json(&list, command->json);
    blend_wrong_free(&list);
    return result;
}

static Result check_usage(const BlendCheckCommand *command)
{
    int modes = (command->path != NULL) + command->gl + command->list;
    if (modes != 1)
        return result_fail(RESULT_BAD_INPUT, "blend check: expected one of FILE, --gl and --list");
    if (!command->gl &&
        (command->sets || command->limit || command->seed || command->fma != FMA_AUTO))
        return result_fail(RESULT_BAD_INPUT,
                           "blend check: --set, --limit, --seed and --fma go with --gl");
    if (command->path && (command->formats || command->has_equation))
        return result_fail(RESULT_BAD_INPUT,
                           "blend check: --format and --equation are the file's own; they go with "
                           "--gl and --list");
    if (!command->has_against && (command->fail || command->warn))
        return result_fail(RESULT_BAD_INPUT, "blend check: --fail and --warn go with --against");
    if (command->has_against && !command->path)
        return result_fail(RESULT_BAD_INPUT, "blend check: --against goes with FILE");
    return options_check_output(command->json);
}

int cmd_blend_check(int argc, char **argv)
{
    BlendCheckCommand command = {.api = API_COUNT, .worst = WORST_DEFAULT};
    int code = options_parse_dash(&command_argp, argc, argv, &command);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    Result result = check_usage(&command);
    if (result == RESULT_OK)
        result = command.list ? print_list(&command)
                 : command.gl ? blend_check_gl(&command, &code)
                              : check_file(&command, &code);
    return result == RESULT_OK ? code : options_fail(result);
}

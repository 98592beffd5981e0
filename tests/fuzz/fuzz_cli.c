/* Command lines: words with a 0 behind each, as the whole program takes them, up to where a command
 * has parsed its options and would begin its work. Whatever they are, the program ends with 0, or
 * with 4 and one line; it makes no file. */
#define _GNU_SOURCE /* open_memstream */
#include "fuzz.h"

#include "cli/options.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    WORDS_MAX = 64
};

/* The program's main, and what its commands call: the build gives them these names. */
int peel_main(int argc, char **argv);
int __real_options_parse(const struct argp *argp, int argc, char **argv, void *input);
int __real_options_parse_dash(const struct argp *argp, int argc, char **argv, void *input);
int __wrap_options_parse(const struct argp *argp, int argc, char **argv, void *input);
int __wrap_options_parse_dash(const struct argp *argp, int argc, char **argv, void *input);

int __wrap_options_parse(const struct argp *argp, int argc, char **argv, void *input)
{
    int code = __real_options_parse(argp, argc, argv, input);
    return code ? code : OPTIONS_HELPED;
}

int __wrap_options_parse_dash(const struct argp *argp, int argc, char **argv, void *input)
{
    int code = __real_options_parse_dash(argp, argc, argv, input);
    return code ? code : OPTIONS_HELPED;
}

/* Runs it, with the standard streams in memory. The caller frees *errors. */
static int run(int argc, char **argv, char **errors)
{
    FILE *saved_output = stdout, *saved_errors = stderr;
    static FILE *nowhere;
    size_t length;
    if (!nowhere)
        nowhere = fopen("/dev/null", "w");
    FILE *stream = open_memstream(errors, &length);
    FUZZ_CHECK(nowhere && stream, "streams");
    stdout = nowhere;
    stderr = stream;
    int code = peel_main(argc, argv);
    stdout = saved_output;
    stderr = saved_errors;
    fclose(stream);
    FUZZ_CHECK(strlen(*errors) == length, "a 0 byte among the errors");
    return code;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *words[WORDS_MAX + 2] = {(char[]){"peel"}}, *errors;
    int count = 1;
    char *line = malloc(size + 1);
    FUZZ_CHECK(line, "out of memory");
    memcpy(line, data, size);
    line[size] = '\0';
    for (size_t at = 0; at < size && count <= WORDS_MAX; at += strlen(line + at) + 1)
        words[count++] = line + at;
    int code = run(count, words, &errors);
    size_t length = strlen(errors);
    if (code == EXIT_AGREE)
        FUZZ_CHECK(length == 0, "success, and '%s'", errors);
    else
        FUZZ_CHECK(code == EXIT_BAD_INPUT && strncmp(errors, "peel: ", 6) == 0 && length > 7 &&
                       strchr(errors, '\n') == errors + length - 1,
                   "exit code %d, and '%s'", code, errors);
    free(errors);
    free(line);
    return 0;
}

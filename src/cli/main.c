/* peel: the command line. One file per command; see bind.h. */
#include "base/file.h"
#include "base/result.h"
#include "cli/bind.h"
#include "cli/completion.h"
#include "cli/manual.h"
#include "cli/options.h"
#include "cli/version.h"

#include <errno.h>
#include <fcntl.h>
#include <gmp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const Command commands[] = {
    {"render", "one renderer to PNG, EXR or deep EXR, with --trace every buffer", cmd_render, NULL},
    {"bench", "speed against error, over scenes, passes, lights, threads and more", cmd_bench,
     NULL},
    {"blend", "blend arithmetic: test vectors, checking results, a calculator", cmd_blend,
     blend_subcommands},
    {"check", "somebody's image or passes against the reference", cmd_check, NULL},
    {"compare", "all three renderers; table, JSON, report", cmd_compare, NULL},
    {"diagnose", "which known mistake explains an image by another program", cmd_diagnose, NULL},
    {"diff", "two images or traces: idiff's figures and exit codes, and ULP", cmd_diff, NULL},
    {"driver", "what the local GL driver keeps of the number rules", cmd_driver, NULL},
    {"explain", "step by step: a page with the pipeline in it, or one pixel's history", cmd_explain,
     NULL},
    {"flatten", "a deep EXR to a flat EXR or PNG", cmd_flatten, NULL},
    {"hard", "the hard cases, each against its own expectation", cmd_hard, NULL},
    {"methods", "list the methods of --method", cmd_methods, NULL},
    {"plan", "what a scene needs, and the cheapest settings that reach an error", cmd_plan, NULL},
    {"scenes", "list the built-in scenes, or write one as glTF", cmd_scenes, NULL},
    {0},
};

static void print_help(FILE *out)
{
    fprintf(out, "Usage: peel COMMAND [OPTION...] [ARGUMENT...]\n"
                 "The reference for order-independent transparency by depth peeling.\n\n");
    for (const Command *command = commands; command->name; command++)
        fprintf(out, "  peel %-9s %s\n", command->name, command->summary);
    fprintf(
        out,
        "\n'peel COMMAND --help' shows a command's options, 'peel --man COMMAND | man -l -' its\n"
        "manual page, 'peel --version' what this build is of ('--version --json': as JSON), and\n"
        "'peel --completion bash', zsh or fish prints completion for that shell.\n\n"
        "Exit codes: 0 agree or done, 1 warning threshold, 2 differ beyond the threshold,\n"
        "3 sizes differ, 4 bad input, usage or environment (one line on stderr says "
        "what).\n");
}

/* Files must not be opened under the numbers of streams that were closed. What cannot be printed
 * is an error: so a closed standard output refuses to be written to. */
static void open_standard_streams(void)
{
    static const int modes[] = {O_RDONLY, O_RDONLY, O_RDWR};
    for (int descriptor = 0; descriptor <= STDERR_FILENO; descriptor++)
        if (fcntl(descriptor, F_GETFD) < 0 && open("/dev/null", modes[descriptor]) != descriptor)
            abort();
}

/* Leaves neither a temporary file nor a progress line behind. */
static void clean_up(void)
{
    static const char clear_line[] = "\r\033[K";
    file_remove_temporaries();
    if (isatty(STDERR_FILENO) && write(STDERR_FILENO, clear_line, sizeof clear_line - 1) < 0) {
        /* nothing more to do */
    }
}

static void on_signal(int number)
{
    int error = errno;
    clean_up();
    raise(number); /* SA_RESETHAND: ends the program as the signal does, once it is not blocked */
    errno = error;
}

static void handle_signals(void)
{
    signal(SIGXFSZ, SIG_IGN); /* a file that grows too large is a failed write */
    struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESETHAND | SA_NODEFER};
    sigemptyset(&action.sa_mask);
    for (const int *number = file_ending_signals; *number; number++) {
        struct sigaction now;
        if (sigaction(*number, NULL, &now) == 0 && now.sa_handler == SIG_DFL)
            sigaction(*number, &action, NULL);
    }
}

/* GMP has no other way to fail than to end the program. */
static void *exact_memory(void *memory, size_t bytes)
{
    void *out = realloc(memory, bytes);
    if (out)
        return out;
    clean_up();
    fprintf(stderr, "peel: out of memory: %zu bytes for exact arithmetic\n", bytes);
    _exit(EXIT_BAD_INPUT);
}

static void *exact_allocate(size_t bytes)
{
    return exact_memory(NULL, bytes);
}

static void *exact_reallocate(void *memory, size_t old, size_t bytes)
{
    (void)old;
    return exact_memory(memory, bytes);
}

static int run(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "peel: no command given; see 'peel --help'\n");
        return EXIT_BAD_INPUT;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "help") == 0) {
        print_help(stdout);
        return EXIT_AGREE;
    }
    if (strcmp(argv[1], "--version") == 0)
        return version_print(argc - 2, argv + 2);
    if (strcmp(argv[1], "--man") == 0)
        return manual_print(argc - 2, argv + 2);
    if (strcmp(argv[1], "--completion") == 0)
        return completion_print(argc - 2, argv + 2);
    for (const Command *command = commands; command->name; command++) {
        if (strcmp(argv[1], command->name) != 0)
            continue;
        char name[32];
        snprintf(name, sizeof name, "peel %s", command->name);
        argv[1] = name;
        return command->run(argc - 1, argv + 1);
    }
    return options_fail(
        result_fail(RESULT_BAD_INPUT, "'%s' is no command; see 'peel --help'", argv[1]));
}

int main(int argc, char **argv)
{
    open_standard_streams();
    handle_signals();
    /* argp's own: the layout of help, by which it may not end, and options only in front. */
    unsetenv("ARGP_HELP_FMT");
    unsetenv("POSIXLY_CORRECT");
    mp_set_memory_functions(exact_allocate, exact_reallocate, NULL);
    result_warnings_enable(true);
    file_write_once();
    int code = run(argc, argv);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fprintf(stderr, "peel: standard output: write failed\n");
        return EXIT_BAD_INPUT;
    }
    return code;
}

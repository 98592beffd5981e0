/* peel blend: blend arithmetic as a product of its own. One file per subcommand. */
#include "cli/bind.h"
#include "cli/options.h"

#include <stdio.h>
#include <string.h>

const Command blend_subcommands[] = {
    {"check", "somebody's results for test vectors: which arithmetic made them", cmd_blend_check,
     NULL},
    {"eval", "a calculator: every intermediate value of a blend", cmd_blend_eval, NULL},
    {"vectors", "test vectors of blending, with results", cmd_blend_vectors, NULL},
    {0},
};

static void print_help(void)
{
    printf("Usage: peel blend SUBCOMMAND [OPTION...] [ARGUMENT...]\n"
           "Blend arithmetic: what it should give, and what somebody's gives.\n\n");
    for (const Command *command = blend_subcommands; command->name; command++)
        printf("  peel blend %-8s %s\n", command->name, command->summary);
    printf("\n'peel blend SUBCOMMAND --help' shows a subcommand's options.\n");
}

int cmd_blend(int argc, char **argv)
{
    if (argc < 2)
        return options_fail(
            result_fail(RESULT_BAD_INPUT, "blend: expected check, eval or vectors"));
    if (strcmp(argv[1], "--help") == 0) {
        print_help();
        return EXIT_AGREE;
    }
    for (const Command *command = blend_subcommands; command->name; command++) {
        if (strcmp(argv[1], command->name) != 0)
            continue;
        char name[48];
        snprintf(name, sizeof name, "%s %s", argv[0], command->name);
        argv[1] = name;
        return command->run(argc - 1, argv + 1);
    }
    return options_fail(
        result_fail(RESULT_BAD_INPUT, "blend: '%s': expected check, eval or vectors", argv[1]));
}

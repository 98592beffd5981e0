/* The command line as a table, made of the parsers' own: for the manual and for completion, which
 * so have what --help has. */
#ifndef PEEL_CLI_DESCRIBE_H
#define PEEL_CLI_DESCRIBE_H

#include "base/text.h"

#include <argp.h>
#include <stdbool.h>
#include <stddef.h>

enum {
    DESCRIBED_COMMANDS = 32,
    DESCRIBED_FORMS = 3,
    DESCRIBED_OPTIONS = 96
};

typedef struct DescribedCommand {
    char name[32]; /* "render", "blend check" */
    const char *summary;
    const struct argp *forms[DESCRIBED_FORMS]; /* the command's ways to be called, one or more; none
                                                * of one that has subcommands */
    size_t form_count;
    bool dash; /* a single dash may begin long options */
} DescribedCommand;

typedef struct DescribedOption {
    const struct argp_option *option;
    const char *group; /* of which it is one, with a colon; NULL: none */
} DescribedOption;

/* What an option, or a command's argument, takes. */
typedef enum DescribedKind {
    DESCRIBED_NOTHING,
    DESCRIBED_FREE,   /* no list of it */
    DESCRIBED_VALUES, /* words: one of them, or of some lists several */
    DESCRIBED_FILE,   /* words: how its name ends; none: any file */
    DESCRIBED_FOLDER,
    DESCRIBED_SCENE /* words: built-in scenes; or a .gltf or .glb file */
} DescribedKind;

/* All commands, each before its subcommands; returns their number. */
size_t describe_commands(DescribedCommand out[DESCRIBED_COMMANDS]);

/* The options of all forms, each once, in the order of --help; returns their number. */
size_t describe_options(const DescribedCommand *command, DescribedOption out[DESCRIBED_OPTIONS]);

/* words: appended, with a space behind each. */
DescribedKind describe_value(const struct argp_option *option, Text *words);
/* Of the command's arguments: SCENE of "SCENE -o FILE". words: values; endings: of files. */
DescribedKind describe_arguments(const DescribedCommand *command, Text *words, Text *endings);

/* key of an option that is a letter, else 0. */
char describe_letter(const struct argp_option *option);

#endif

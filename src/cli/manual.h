/* peel --man [COMMAND]: manual pages, of the table of describe.h and of manual.roff. */
#ifndef PEEL_CLI_MANUAL_H
#define PEEL_CLI_MANUAL_H

/* argv: nothing, a command, or a command and its subcommand; or --list. Prints a page for man, or
 * with --list the names of all; returns the exit code. */
int manual_print(int argc, char **argv);

#endif

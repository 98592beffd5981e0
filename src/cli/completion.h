/* peel --completion SHELL: what a shell needs to complete Peel's command lines. */
#ifndef PEEL_CLI_COMPLETION_H
#define PEEL_CLI_COMPLETION_H

/* argv: bash, zsh or fish. Prints a script that the shell reads; returns the exit code. */
int completion_print(int argc, char **argv);

#endif

/* peel --version: what this program is, of what it was built, and what it runs on. */
#ifndef PEEL_CLI_VERSION_H
#define PEEL_CLI_VERSION_H

/* argv: nothing, or --json. Prints; returns the exit code. Opens no GL context. */
int version_print(int argc, char **argv);

#endif

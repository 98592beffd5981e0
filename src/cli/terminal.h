/* The terminal that standard output goes to, if it goes to one. */
#ifndef PEEL_CLI_TERMINAL_H
#define PEEL_CLI_TERMINAL_H

#include <stdbool.h>

/* Columns to print in: what COLUMNS says, else what the terminal has, else 100; `least` where that
 * is less. */
int terminal_columns(int least);

/* Whether to print in colours: on a terminal that TERM names, unless that is "dumb" or NO_COLOR is
 * set. */
bool terminal_has_colour(void);

#endif

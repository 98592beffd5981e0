/* Options of the commands that take somebody's image: what its values mean. */
#ifndef PEEL_CLI_OPTIONS_GIVEN_H
#define PEEL_CLI_OPTIONS_GIVEN_H

#include "compare/given.h"

#include <argp.h>

/* A child parser; its input is a GivenMeaning, which is DETECT where no option says. */
extern const struct argp options_given_argp;

/* EXIT_SIZES and one line on stderr when the image has another size than is rendered; else 0. */
int options_given_size(const char *path, const GivenImage *given, int width, int height);

#endif

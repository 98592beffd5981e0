#include "cli/options_given.h"

#include "cli/options.h"

#include <stdio.h>
#include <string.h>

enum {
    KEY_ENCODING = 0x300,
    KEY_FLIP,
    KEY_NO_FLIP,
    KEY_ALPHA
};

static const struct argp_option given_options[] = {
    {"encoding", KEY_ENCODING, "NAME", 0,
     "Of their colours: linear, srgb, or seed (the display transform of peel render); default: "
     "found out",
     0},
    {"flip", KEY_FLIP, 0, 0, "The first row of their files is the bottom one (default: found out)",
     0},
    {"no-flip", KEY_NO_FLIP, 0, 0, "... is the top one", 0},
    {"alpha", KEY_ALPHA, "NAME", 0,
     "Of their image: none, coverage or transmittance (default: found out)", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    GivenMeaning *meaning = state->input;
    switch (key) {
    case KEY_ENCODING:
        for (int i = GIVEN_LINEAR; i <= GIVEN_SEED; i++)
            if (strcmp(argument, given_encoding_name((GivenEncoding)i)) == 0)
                meaning->encoding = (GivenEncoding)i;
        return meaning->encoding
                   ? 0
                   : options_error("--encoding %s: expected linear, srgb or seed", argument);
    case KEY_FLIP:
        meaning->rows = GIVEN_BOTTOM_UP;
        return 0;
    case KEY_NO_FLIP:
        meaning->rows = GIVEN_TOP_DOWN;
        return 0;
    case KEY_ALPHA:
        for (int i = GIVEN_ALPHA_NONE; i <= GIVEN_TRANSMITTANCE; i++)
            if (strcmp(argument, given_alpha_name((GivenAlpha)i)) == 0)
                meaning->alpha = (GivenAlpha)i;
        return meaning->alpha
                   ? 0
                   : options_error("--alpha %s: expected none, coverage or transmittance",
                                   argument);
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp options_given_argp = {given_options, parse, NULL, NULL, NULL, NULL, NULL};

int options_given_size(const char *path, const GivenImage *given, int width, int height)
{
    const Image *stored = &given->stored;
    if (stored->width == width && stored->height == height)
        return 0;
    options_fail(
        result_fail(RESULT_BAD_INPUT,
                    "%s: the image has %dx%d pixels, expected %dx%d; --size says what is rendered",
                    path, stored->width, stored->height, width, height));
    return EXIT_SIZES;
}

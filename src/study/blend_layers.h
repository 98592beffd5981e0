/* Colours as people write them, for `peel blend eval`: one at a time, or a file of layers. */
#ifndef PEEL_STUDY_BLEND_LAYERS_H
#define PEEL_STUDY_BLEND_LAYERS_H

#include "base/result.h"
#include "number/rational.h"

#include <stddef.h>

enum {
    BLEND_LAYERS_MOST = 4096,
    BLEND_LAYERS_BITS = 1 << 20 /* of the fraction that is the exact result: a minute or so */
};

/* Red, green, blue, alpha, exactly as written. */
typedef struct BlendColour {
    Rational channels[4];
} BlendColour;

/* Front to back. Starts as {0}; whoever has it frees it. */
typedef struct BlendLayers {
    BlendColour *colours;
    size_t count, room;
    size_t bits; /* what the exact result may need */
} BlendLayers;

void blend_colour_init(BlendColour *out);
void blend_colour_clear(BlendColour *colour);

/* "r,g,b,a", numbers as numeral_read has them, or codes of 8 or 16 bits: "#rrggbb", "#rrggbbaa",
 * "#rrrrggggbbbbaaaa". least: how many numbers it must have, the others are 0, alpha 1; 4 unless
 * the format has fewer channels. out: initialised. BAD_INPUT with `place`, the text and what was
 * expected. */
Result blend_colour_read(const char *place, const char *text, size_t length, int least,
                         BlendColour *out);

/* Appends a colour. BAD_INPUT where it is none, or where the layers are more than BLEND_LAYERS_MOST
 * or have too many digits. */
Result blend_layers_add(const char *place, const char *text, size_t length, BlendLayers *layers);

/* Appends those of a file, "-" for standard input: a line each, numbers between commas or blanks;
 * empty lines and those that begin with '#' and are no colour are left out. BAD_INPUT with
 * "path:line: ...". */
Result blend_layers_load(const char *path, BlendLayers *layers);

void blend_layers_free(BlendLayers *layers);

#endif

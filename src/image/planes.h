/* An image of any channels in memory: of each a plane of stored values, under its name. */
#ifndef PEEL_IMAGE_PLANES_H
#define PEEL_IMAGE_PLANES_H

#include "image/image.h"

#include <stdint.h>

typedef struct Plane {
    char *name; /* "R", "left.A", …; owned */
    FormatKind kind;
    uint32_t unorm_max; /* the integer that means 1; 0 unless KIND_UNORM */
    uint32_t *bits;     /* width · height stored values, each in the low end; owned */
} Plane;

typedef struct Planes {
    int x, y; /* of the first pixel in the coordinates that the file counts in */
    int width, height;
    int count;
    Plane *planes; /* R, G, B, A or Y first, then the others as they come; owned */
} Planes;

/* NO_MEMORY when so many planes would take more than max_bytes (0: no limit); label begins the
 * message. */
Result planes_fit(int width, int height, int count, size_t max_bytes, const char *label);

/* Zeroed planes without names, of KIND_FLOAT, which planes_fit. The caller frees with planes_free,
 * after a failure too. */
Result planes_create(int width, int height, int count, size_t max_bytes, const char *label,
                     Planes *out);
void planes_free(Planes *planes); /* leaves empty planes; empty ones are fine */

Result planes_name(Plane *plane, const char *name); /* copies it; NO_MEMORY */

/* R, G, B, A and Y in front of all others, which keep their order. */
void planes_sort(Planes *planes);

/* Index of a channel; −1 when there is none of that name. */
int planes_find(const Planes *planes, const char *name);

/* Leaves only the channels of names (commas between), in that order; false, and nothing changes,
 * when one of them is missing. */
bool planes_keep(Planes *planes, const char *names);

/* The first `channels` channels of image, of 1 to 4: Y; Y, A; R, G, B; R, G, B, A. Of the first two
 * the image has grey in R, G and B. NO_MEMORY leaves nothing to free. */
Result planes_from_image(const Image *image, int channels, Planes *out);

/* A stored value as a number: floats and halves exactly, unorm as integer / unorm_max rounded to
 * float, integers as they are. */
double planes_value(FormatKind kind, uint32_t unorm_max, uint32_t bits);

/* "float", "half", "uint", "unorm8", …; static. */
const char *planes_kind_name(FormatKind kind, uint32_t unorm_max);

#endif

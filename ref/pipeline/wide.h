/* Coverage by triangles that are too large for the driver's arithmetic (setup_is_wide), which none
 * is that its clipper leaves within the viewport; but next to w = 0 rounding puts corners anywhere.
 * There the driver decides by blocks of 64, 16 and 4 pixels, in 32 bits that overflow. (It may
 * shade fragments outside of the frame then, which queries and lists count.) */
#ifndef PEEL_REF_WIDE_H
#define PEEL_REF_WIDE_H

#include "ref/pipeline/geometry.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct WidePlane {
    int64_t c;
    int32_t dx, dy; /* of a pixel to the left, and up; multiples of 256 */
    uint32_t reach; /* from a pixel's corner with the least value to that with the greatest */
} WidePlane;

typedef struct Wide {
    WidePlane planes[3];
    PixelRect tiles; /* that the triangle's box touches */
    bool alone;      /* the box is within one tile */
} Wide;

/* The pixels of all tiles that box touches, in width x height: all that may be covered. */
PixelRect wide_bounds(PixelRect box, int width, int height);

struct Setup;

void wide_make(const struct Setup *setup, Wide *out);

/* Whether pixel (x, y) of the frame is covered. */
bool wide_covers(const Wide *wide, int x, int y);

#endif

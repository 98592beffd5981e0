/* Inputs of the driver's experiments: seeded, the same on every machine. */
#ifndef PEEL_STUDY_DRIVER_INPUTS_H
#define PEEL_STUDY_DRIVER_INPUTS_H

#include "base/random.h"
#include "frame/experiment.h"

/* Bits, to be combined. */
typedef enum InputSet {
    INPUT_UNIT = 1 << 0,     /* [0, 1) */
    INPUT_SIGNED = 1 << 1,   /* [−8, 8) */
    INPUT_WIDE = 1 << 2,     /* either sign, 2^−30 … 2^30 */
    INPUT_POSITIVE = 1 << 3, /* 2^−10 … 2^10 */
    INPUT_DENORMAL = 1 << 4, /* below and a little above 2^−126 */
    INPUT_SPECIAL = 1 << 5,  /* zeros, infinities, NaN, ends of formats */
    INPUT_BITS = 1 << 6,     /* any bits */
    INPUT_CODES = 1 << 7,    /* near the codes of a format and half-way between them */
    INPUT_SETS = 8
} InputSet;

/* One value. codes: the greatest code of INPUT_CODES. */
float inputs_value(Random *random, InputSet set, double codes);

/* x as shaders store it: without AVX the driver turns 2^31/255 and more, of either sign, into 0 in
 * RGBA8, so they clamp before; here to 1.5 or -1.5. */
float inputs_bounded(PixelFormat format, float x);

/* Kinds of triangles, as corners in clip space. */
typedef enum TriangleKind {
    TRIANGLE_LARGE,       /* w 1, inside the view volume, some pixels' area at least */
    TRIANGLE_HALF_PIXEL,  /* corners on multiples of half a pixel: centres lie on edges */
    TRIANGLE_SUBPIXEL,    /* corners near 1/512 pixel: snapping decides */
    TRIANGLE_PERSPECTIVE, /* inside, w 1/4 … 16 */
    TRIANGLE_CLIPPED,     /* across the planes of the view volume and behind the eye */
} TriangleKind;

/* Corners 0 … 2 of one triangle and three varyings for each. */
void inputs_triangle(Random *random, TriangleKind kind, float clip[3][4], float varying[3][4]);

/* A crooked grid that covers the viewport with no overlap, some of it in perspective: returns the
 * number of triangles, at most INPUTS_GRID_MAX. Corners are shared to the bit. */
enum {
    INPUTS_GRID_MAX = 2 * 24 * 24
};
int inputs_grid(Random *random, float clip[][4]);

/* Significant bits of a value: what makes an example simple. */
int inputs_complexity(float x);

#endif

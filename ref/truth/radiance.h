/* frame/shading.h's lighting formula in double precision, and the display transform. */
#ifndef PEEL_REF_TRUTH_RADIANCE_H
#define PEEL_REF_TRUTH_RADIANCE_H

#include "frame/view.h"
#include "ref/truth/texture.h"

#include <stdbool.h>
#include <stdint.h>

/* A point of a surface in view space. */
typedef struct Surface {
    double position[3];
    double normal[3]; /* any length; normalised here */
    MaterialSample material;
    bool back_light; /* lights behind it add their specular lobe */
    bool phong;      /* the tutorial's directional light instead of the scene's */
} Surface;

/* What the surface sends to the eye: linear, not multiplied by alpha. */
void radiance_shade(const View *view, const Surface *surface, double rgb[3]);

/* Linear radiance to one 8-bit display value: c/(c + 1), power, nearest even; NaN gives 0. */
uint8_t radiance_display(double c);

#endif

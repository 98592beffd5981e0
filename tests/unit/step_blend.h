/* The blends that a history's steps name. */
#ifndef PEEL_TESTS_STEP_BLEND_H
#define PEEL_TESTS_STEP_BLEND_H

#include "number/blend.h"

#include <string.h>

/* What the pixel of a step's target holds before the first step. */
static inline void step_clear(const char *target, PixelFormat format, void *pixel)
{
    if (strcmp(target, "accum") == 0 || strcmp(target, "back") == 0)
        blend_clear(format, pixel);
    else if (strcmp(target, "product") == 0)
        memcpy(pixel, &(float){1.0f}, sizeof(float));
    else
        memset(pixel, 0, format_pixel_bytes(format));
}

/* false: no equation has that name. */
static inline bool step_blend(const char *equation, PixelFormat format, const float source[4],
                              void *pixel)
{
    static const struct {
        const char *name;
        void (*blend)(PixelFormat format, const float source[4], void *pixel);
    } equations[] = {{"under", blend_under},
                     {"over", blend_over},
                     {"add", blend_add},
                     {"product", blend_product},
                     {"opaque_seed", blend_opaque_seed}};
    for (size_t i = 0; i < sizeof equations / sizeof *equations; i++)
        if (strcmp(equation, equations[i].name) == 0) {
            equations[i].blend(format, source, pixel);
            return true;
        }
    return false;
}

#endif

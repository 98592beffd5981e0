/* What is blended: factors and functions as OpenGL has them.
 *
 * Each stored channel becomes func(source · factor, destination · factor); MIN and MAX take no
 * factors. Formats without alpha read a destination alpha of 1, those without a channel drop it.
 * Source: OpenGL 4.6 core, section 17.3.6. Not modelled: the constant colour, dual sources, logic
 * operations, sRGB targets, write masks. */
#ifndef PEEL_NUMBER_BLEND_EQUATION_H
#define PEEL_NUMBER_BLEND_EQUATION_H

typedef enum BlendFactor {
    FACTOR_ZERO = 0,
    FACTOR_ONE,
    FACTOR_SRC_COLOR, /* per channel: of alpha the source's alpha */
    FACTOR_ONE_MINUS_SRC_COLOR,
    FACTOR_DST_COLOR,
    FACTOR_ONE_MINUS_DST_COLOR,
    FACTOR_SRC_ALPHA,
    FACTOR_ONE_MINUS_SRC_ALPHA,
    FACTOR_DST_ALPHA,
    FACTOR_ONE_MINUS_DST_ALPHA,
    FACTOR_SRC_ALPHA_SATURATE, /* min(source alpha, 1 − destination alpha); of alpha 1 */
    FACTOR_COUNT
} BlendFactor;

typedef enum BlendFunc {
    BLEND_FUNC_ADD = 0,
    BLEND_FUNC_SUBTRACT,         /* source − destination */
    BLEND_FUNC_REVERSE_SUBTRACT, /* destination − source */
    BLEND_FUNC_MIN,
    BLEND_FUNC_MAX,
    BLEND_FUNC_COUNT
} BlendFunc;

typedef struct BlendEquation {
    BlendFactor source, destination;             /* of red, green and blue */
    BlendFactor source_alpha, destination_alpha; /* of alpha */
    BlendFunc func, func_alpha;
} BlendEquation;

/* Initialisers of those that the renderers blend with; blend/equation.h has them and more as a
 * table. */
#define BLEND_EQUATION_UNDER                                                                       \
    {                                                                                              \
        FACTOR_DST_ALPHA, FACTOR_ONE, FACTOR_ZERO, FACTOR_ONE_MINUS_SRC_ALPHA, BLEND_FUNC_ADD,     \
            BLEND_FUNC_ADD                                                                         \
    }
#define BLEND_EQUATION_OVER_TRANSMITTANCE                                                          \
    {                                                                                              \
        FACTOR_ONE, FACTOR_ONE_MINUS_SRC_ALPHA, FACTOR_ZERO, FACTOR_ONE_MINUS_SRC_ALPHA,           \
            BLEND_FUNC_ADD, BLEND_FUNC_ADD                                                         \
    }
/* Four channels alike. */
#define BLEND_EQUATION_ALL(source, destination, func)                                              \
    {                                                                                              \
        source, destination, source, destination, func, func                                       \
    }
#define BLEND_EQUATION_ADD BLEND_EQUATION_ALL(FACTOR_ONE, FACTOR_ONE, BLEND_FUNC_ADD)
#define BLEND_EQUATION_MAX BLEND_EQUATION_ALL(FACTOR_ONE, FACTOR_ONE, BLEND_FUNC_MAX)
#define BLEND_EQUATION_PRODUCT                                                                     \
    BLEND_EQUATION_ALL(FACTOR_ZERO, FACTOR_ONE_MINUS_SRC_COLOR, BLEND_FUNC_ADD)
#define BLEND_EQUATION_SEED BLEND_EQUATION_ALL(FACTOR_DST_ALPHA, FACTOR_ONE, BLEND_FUNC_ADD)
#define BLEND_EQUATION_REPLACE                                                                     \
    BLEND_EQUATION_ALL(FACTOR_SRC_ALPHA, FACTOR_ONE_MINUS_SRC_ALPHA, BLEND_FUNC_ADD)
#define BLEND_EQUATION_KEEP                                                                        \
    BLEND_EQUATION_ALL(FACTOR_ONE_MINUS_DST_ALPHA, FACTOR_ONE, BLEND_FUNC_ADD)

#endif

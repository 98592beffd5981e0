/* The equations with names: the factors and functions of number/blend_equation.h, parsed and
 * printed. */
#ifndef PEEL_BLEND_EQUATION_H
#define PEEL_BLEND_EQUATION_H

#include "base/result.h"
#include "number/blend_equation.h"

typedef enum EquationId {
    EQUATION_UNDER = 0, /* behind what is there; its alpha is transmittance */
    EQUATION_OVER,      /* straight source colours; alphas are coverage */
    EQUATION_OVER_PREMULTIPLIED,
    EQUATION_ADD,
    EQUATION_MAX,
    EQUATION_WEIGHTED_SUM, /* colours weighted by their alpha, and the sum of the weights */
    EQUATION_PRODUCT,      /* of 1 − source: the weighted methods' revealage */
    EQUATION_SEED,         /* number/blend.h: blend_opaque_seed and those below */
    EQUATION_OVER_TRANSMITTANCE,
    EQUATION_REPLACE,
    EQUATION_KEEP,
    EQUATION_COUNT
} EquationId;

typedef struct EquationInfo {
    const char *name; /* "over-premultiplied", as the command line and files spell it */
    const char *what; /* one line */
    BlendEquation equation;
} EquationInfo;

const EquationInfo *equation_info(EquationId id); /* static */
/* The name of the table that these factors and functions have; EQUATION_COUNT if none. */
EquationId equation_id(const BlendEquation *equation);
const char *equation_factor_name(BlendFactor factor); /* "one-minus-src-alpha"; static */
const char *equation_func_name(BlendFunc func);       /* "reverse-subtract"; static */

/* A name of the table, or factors "SOURCE,DESTINATION[,SOURCE_ALPHA,DESTINATION_ALPHA]" in GL's
 * words with '-' for '_', with ":FUNC[,FUNC_ALPHA]" behind where they are not both add:
 * "dst-alpha,one,zero,one-minus-src-alpha", "one,one:max". BAD_INPUT with a message otherwise. */
Result equation_parse(const char *text, BlendEquation *out);

/* The table's name, or the factors as equation_parse reads them. out: room for
 * EQUATION_TEXT bytes. */
enum {
    EQUATION_TEXT = 160
};
void equation_print(const BlendEquation *equation, char out[EQUATION_TEXT]);

#endif

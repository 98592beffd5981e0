/* How blending is computed: which roundings, in which order, from which numbers.
 *
 * Pixels are in the format's memory layout (number/format.h): rgba8, rgba16, rgba16f, rgba32f,
 * rg32f or r32f. Sources are four floats, as a shader puts them out. Callers are NOT in flushing
 * mode; these functions enter and leave it as they need. Results never depend on the processor. */
#ifndef PEEL_BLEND_ARITHMETIC_H
#define PEEL_BLEND_ARITHMETIC_H

#include "base/result.h"
#include "blend/equation.h"
#include "number/format.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum ArithmeticKind {
    ARITHMETIC_EXACT = 0, /* the exact result of the stored operands, rounded once, to nearest even;
                           * of unorm formats the source is stored first */
    ARITHMETIC_DRIVER,    /* llvmpipe's, measured: number/blend.h */
    ARITHMETIC_STEPS      /* one operation after the other, as the other fields say */
} ArithmeticKind;

typedef enum BlendPrecision {
    PRECISION_FLOAT = 0, /* products and sums are rounded to 24 bits */
    PRECISION_HALF,
    PRECISION_DOUBLE,
    PRECISION_CODES /* integers of the format; unorm only */
} BlendPrecision;

typedef enum BlendRounding {
    BLEND_NEAREST_EVEN = 0,
    BLEND_TOWARD_ZERO,
    BLEND_NEAREST_AWAY, /* ties away from zero: (int)(x + 0.5) */
    BLEND_UPWARD
} BlendRounding;

/* a·b / (2^n − 1) of integers of n bits. */
typedef enum CodeProduct {
    CODES_NEAREST = 0,  /* the exact quotient to nearest: t = ab + 2^(n−1); (t + (t >> n)) >> n */
    CODES_DRIVER,       /* t = ab; t += t >> n; (t + 2^(n−1)) >> n */
    CODES_FLOOR,        /* ab / (2^n − 1) */
    CODES_SHIFT,        /* ab >> n */
    CODES_SHIFT_ROUND,  /* (ab + 2^(n−1)) >> n */
    CODES_SHIFT_MOST,   /* (ab + 2^n − 1) >> n */
    CODES_SHIFT_STRETCH /* a·(b + (b >> (n − 1))) >> n */
} CodeProduct;

/* What programs get wrong; bits 1 << mistake. Whoever adds one proves that the vectors show it. */
typedef enum BlendMistake {
    MISTAKE_FACTORS_SWAPPED = 0,
    MISTAKE_COUNT
} BlendMistake;

typedef struct Arithmetic {
    ArithmeticKind kind;
    /* Of ARITHMETIC_STEPS: */
    BlendPrecision precision;
    BlendRounding rounding; /* of products and sums */
    BlendRounding store;    /* of the result into the format */
    CodeProduct product;    /* of PRECISION_CODES */
    bool fused;             /* the last product is added without being rounded */
    bool flush;             /* denormal operands and results are zeros of their sign */
    bool source_stored;     /* the source is first rounded to the format */
    /* Of any kind: */
    uint32_t mistakes;
} Arithmetic;

typedef struct ArithmeticInfo {
    const char *name; /* "codes-shift", as the command line and files spell it */
    const char *what; /* one line: the formula, or what is wrong and where it comes from */
    Arithmetic arithmetic;
    bool wrong; /* outside what the APIs' rules allow, or what nobody would want */
} ArithmeticInfo;

/* All named ones: exact, driver, right ones, wrong ones. Static. */
size_t arithmetic_count(void);
const ArithmeticInfo *arithmetic_info(size_t i);

/* A name, or comma-separated key=value of the fields (precision=float|half|double|codes,
 * rounding= and store=nearest|truncate|away|up, product=nearest|driver|floor|shift|shift-round|
 * shift-most|shift-stretch, fused=, flush= and source-stored=yes|no, mistake=NAME). BAD_INPUT with
 * a message otherwise. */
Result arithmetic_parse(const char *text, Arithmetic *out);

/* The fields as arithmetic_parse reads them, of ARITHMETIC_STEPS and without those that are as the
 * default: "precision=half,store=truncate"; "exact" or "driver" of the other kinds, with mistakes
 * behind. out: room for ARITHMETIC_TEXT bytes. */
enum {
    ARITHMETIC_TEXT = 192
};
void arithmetic_print(const Arithmetic *arithmetic, char out[ARITHMETIC_TEXT]);

/* Whether this arithmetic is defined for the format and equation: codes are of unorm formats; the
 * driver's is known for the equations that were measured. NULL, or why not in one line (static). */
const char *arithmetic_refuses(const Arithmetic *arithmetic, const BlendEquation *equation,
                               PixelFormat format);

/* Blends count sources onto count pixels. The combination must not be refused. */
void arithmetic_blend(const Arithmetic *arithmetic, const BlendEquation *equation,
                      PixelFormat format, size_t count, const float (*source)[4], void *pixels);

/* One channel of one blend, value by value; what arithmetic_blend does in its plain path. Values
 * are doubles that hold the float, half or code exactly; codes of PRECISION_CODES, and of the
 * driver's unorm blends, are integers, not quotients. */
typedef struct BlendSteps {
    double source, destination;               /* operands as used: after source_stored, fetch */
    double source_factor, destination_factor; /* after 1 − x was rounded */
    double source_product, destination_product;
    double sum;      /* or difference, minimum, maximum; rounded, not yet stored */
    uint32_t stored; /* bits of the format */
    bool codes;      /* the values are integers */
} BlendSteps;

/* out: one of each stored channel. ARITHMETIC_EXACT has operands, factors and products only where
 * doubles hold them; sum is NaN where none does. */
void arithmetic_steps(const Arithmetic *arithmetic, const BlendEquation *equation,
                      PixelFormat format, const float source[4], const void *pixel,
                      BlendSteps out[4]);

#endif

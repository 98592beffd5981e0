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

enum {
    ARITHMETIC_FORMATS = 6
};
/* The formats that are blended, in the order of reports. */
extern const PixelFormat arithmetic_formats[ARITHMETIC_FORMATS];

/* The one of that name; false where there is none, and *out is left. */
bool arithmetic_find_format(const char *name, PixelFormat *out);

typedef enum ArithmeticKind {
    ARITHMETIC_EXACT = 0, /* the exact result of the stored operands, rounded once, to nearest even;
                           * of unorm formats the source is stored first */
    ARITHMETIC_DRIVER,    /* llvmpipe's, measured: number/blend.h */
    ARITHMETIC_STEPS      /* one operation after the other, as the other fields say */
} ArithmeticKind;

typedef enum BlendPrecision {
    PRECISION_FLOAT = 0, /* operands, products and sums are rounded to 24 bits */
    PRECISION_HALF,      /* the same to 11 */
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
    CODES_NEAREST = 0, /* the exact quotient to nearest: t = ab + 2^(n−1); (t + (t >> n)) >> n */
    CODES_DRIVER,      /* t = ab; t += t >> n; (t + 2^(n−1)) >> n */
    CODES_FLOOR,       /* ab / (2^n − 1) */
    CODES_SHIFT,       /* ab >> n */
    CODES_SHIFT_ROUND, /* (ab + 2^(n−1)) >> n */
    CODES_SHIFT_MOST,  /* (ab + 2^n − 1) >> n */
    CODES_SHIFT_STRETCH, /* a·(b + (b >> (n − 1))) >> n */
    CODES_SHIFT_PLUS,    /* a·(b + 1) >> n; b is the factor */
    CODES_RECIPROCAL     /* ab·(2^n + 1) >> 2n: the reciprocal without its rounding */
} CodeProduct;

/* What programs get wrong; bits 1 << mistake, of ARITHMETIC_STEPS. Whoever adds one proves that the
 * vectors show it. */
typedef enum BlendMistake {
    MISTAKE_FACTORS_SWAPPED = 0,
    MISTAKE_ALPHA_AS_COLOR,        /* alpha is blended with the colours' factors and function */
    MISTAKE_COVERAGE,              /* the stored alpha is complemented where it is a factor */
    MISTAKE_ALPHA_FIRST,           /* colours are blended with the alpha that was just stored */
    MISTAKE_DESTINATION_ALPHA_ONE, /* the stored alpha is read as 1 */
    MISTAKE_UNPREMULTIPLIED,       /* the source's colours are divided by its alpha */
    MISTAKE_ALPHA_TWICE,           /* they are multiplied by it once more */
    MISTAKE_EARLY_OUT,     /* source alpha ≥ 1 leaves out the destination, where its factor is
                            * 1 − source alpha; stored alpha ≤ 0 keeps the pixel, where it is the
                            * source's factor */
    MISTAKE_EARLY_OUT_254, /* the same from 254/255 on, and up to 1/255 */
    MISTAKE_CLAMPED_EARLY, /* the source is clamped to [0, 1], of float formats too */
    MISTAKE_CLAMPED_LATE,  /* of unorm formats only the result is clamped */
    MISTAKE_WRAPS,         /* a sum of codes is taken modulo 2^bits; codes only */
    MISTAKE_EIGHT_BITS, /* rgba16 is blended in 8 bits, and the result is times 257; codes only */
    MISTAKE_EIGHT_BITS_SHIFTED, /* the same, and the result is shifted by 8 */
    MISTAKE_COMPLEMENT_CODES,   /* 1 − x is computed in 8 bits */
    MISTAKE_THROUGH_HALF,       /* the result is rounded to half before it is stored */
    MISTAKE_NAN_ZERO,           /* NaN is stored as 0 */
    MISTAKE_GAMMA,              /* colours are squared, blended, and the root is stored */
    MISTAKE_COUNT
} BlendMistake;

typedef struct Arithmetic {
    ArithmeticKind kind;
    /* Of ARITHMETIC_STEPS: */
    BlendPrecision precision;
    BlendRounding rounding; /* of products and sums */
    BlendRounding store;    /* of the result into the format */
    CodeProduct product;    /* of PRECISION_CODES */
    bool
        fused;  /* the last product, of the destination or of its factor 1 the source's, is added
                 * without being rounded. Of ARITHMETIC_DRIVER: the processor fuses, see op_muladd */
    bool flush; /* denormal operands and results are zeros of their sign, stored halves too */
    bool source_stored; /* the source is first rounded to the format */
    uint32_t mistakes;
} Arithmetic;

typedef struct ArithmeticInfo {
    const char *name; /* "codes-shift", as the command line and files spell it */
    const char *what; /* one line: the formula, or what is wrong and where it comes from */
    Arithmetic arithmetic;
    bool wrong; /* outside what the APIs' rules allow, or what nobody would want, in all formats;
                 * see arithmetic_is_wrong */
} ArithmeticInfo;

/* All named ones: exact, driver, right ones, wrong ones. Static. */
size_t arithmetic_count(void);
const ArithmeticInfo *arithmetic_info(size_t i);

/* Whether it is wrong in the format: wrong in all, or computed with fewer digits than the format's
 * numbers have (halves have 11), which the APIs do not allow (Vulkan 1.3, Blending: "a precision
 * and dynamic range no lower than that used to represent destination components"). */
bool arithmetic_is_wrong(const ArithmeticInfo *info, PixelFormat format);

/* A name, or comma-separated key=value of the fields (precision=float|half|double|codes,
 * rounding= and store=nearest|truncate|away|up, product=nearest|driver|floor|shift|shift-round|
 * shift-most|shift-stretch|shift-plus|reciprocal, fused=, flush= and source-stored=yes|no,
 * mistake=NAME, which may be given several times). BAD_INPUT with a message otherwise. */
Result arithmetic_parse(const char *text, Arithmetic *out);

/* The name of the table, or key=value of the fields that are not 0, as arithmetic_parse reads them.
 * out: room for ARITHMETIC_TEXT bytes. */
enum {
    ARITHMETIC_TEXT = 768
};
void arithmetic_print(const Arithmetic *arithmetic, char out[ARITHMETIC_TEXT]);

const char *arithmetic_mistake_name(BlendMistake mistake); /* "factors-swapped"; static */

/* Whether this arithmetic is defined for the format and equation: codes are of unorm formats, and
 * some mistakes are of some formats. NULL, or why not in one line (static). */
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

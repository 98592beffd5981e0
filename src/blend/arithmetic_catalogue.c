/* The named arithmetics, and arithmetics as text.
 *
 * Right is what the APIs allow: one rounding an operation, to nearest or toward zero (OpenGL says
 * no more than how accurate it is), denormals kept or flushed (Direct3D flushes), and of integers
 * what keeps 0 and 1 (glBlendFunc: converting codes "must leave the values 0 and 1 invariant")
 * and is less than a code off. study/blend_rules.c has the sources. */
#include "blend/arithmetic.h"

#include <stdio.h>
#include <string.h>

#define STEPS(...)   .arithmetic = {.kind = ARITHMETIC_STEPS, __VA_ARGS__}
#define CODES(...)   STEPS(.precision = PRECISION_CODES, __VA_ARGS__)
#define MISTAKE(m)   .arithmetic = {.kind = ARITHMETIC_STEPS, .mistakes = 1u << (m)}, .wrong = true
#define CODES_BUT(m) CODES(.mistakes = 1u << (m)), .wrong = true

static const ArithmeticInfo infos[] = {
    {"exact", "the exact result of the stored operands, rounded once, to nearest even",
     .arithmetic = {.kind = ARITHMETIC_EXACT}},
    {"driver", "Mesa 22.3's llvmpipe on a processor with FMA, as measured (NUMBERS.md)",
     .arithmetic = {.kind = ARITHMETIC_DRIVER, .fused = true}},
    {"driver-unfused",
     "Mesa 22.3's llvmpipe on a processor without FMA: other than driver in r32f only",
     .arithmetic = {.kind = ARITHMETIC_DRIVER}},

    /* Floats. */
    {"separate", "float operations one by one, stored to nearest: C, GLSL precise, HLSL precise",
     STEPS(.fused = false)},
    {"separate-truncated",
     "float operations one by one, stored toward zero: Direct3D from float to half",
     STEPS(.store = BLEND_TOWARD_ZERO)},
    {"separate-flushed", "float operations with denormals as zeros, stored to nearest: Direct3D",
     STEPS(.flush = true)},
    {"separate-flushed-truncated", "float operations with denormals as zeros, stored toward zero",
     STEPS(.flush = true, .store = BLEND_TOWARD_ZERO)},
    {"fused",
     "float operations, the last product added in one rounding: what compilers contract to",
     STEPS(.fused = true)},
    {"fused-truncated",
     "float operations, the last product added in one rounding, stored toward zero",
     STEPS(.fused = true, .store = BLEND_TOWARD_ZERO)},
    {"fused-flushed",
     "float operations with denormals as zeros, the last product added in one rounding: GPUs",
     STEPS(.fused = true, .flush = true)},
    {"fused-flushed-truncated",
     "float operations, denormals as zeros, the last product fused, stored toward zero",
     STEPS(.fused = true, .flush = true, .store = BLEND_TOWARD_ZERO)},
    {"source-stored", "the source rounded to the format, then float operations: a target read back",
     STEPS(.source_stored = true)},
    {"source-stored-truncated",
     "the source brought to the format toward zero, and the result: float operations between",
     STEPS(.source_stored = true, .store = BLEND_TOWARD_ZERO)},
    {"away", "float operations, stored with ties away from zero: (int)(x*255 + 0.5)",
     STEPS(.store = BLEND_NEAREST_AWAY)},
    {"source-stored-away",
     "source and result rounded to the format with ties away from zero: (int)(x*255 + 0.5)",
     STEPS(.source_stored = true, .store = BLEND_NEAREST_AWAY)},
    {"truncated", "every operation and the store toward zero: GL does not say which way",
     STEPS(.rounding = BLEND_TOWARD_ZERO, .store = BLEND_TOWARD_ZERO)},
    {"double", "double operations, stored to nearest: a careful software renderer",
     STEPS(.precision = PRECISION_DOUBLE)},
    {"half",
     "half operations, each to nearest: mediump, rgba16f blending units; wrong in longer formats",
     STEPS(.precision = PRECISION_HALF)},
    {"half-fused",
     "half operations, the last product added in one rounding: half FMA; wrong in longer formats",
     STEPS(.precision = PRECISION_HALF, .fused = true)},
    {"half-truncated", "half operations, each toward zero; wrong in longer formats",
     STEPS(.precision = PRECISION_HALF, .rounding = BLEND_TOWARD_ZERO, .store = BLEND_TOWARD_ZERO)},

    /* Integers; formulas for 8 bits. */
    {"codes-nearest",
     "t = ab + 128; (t + (t >> 8)) >> 8: pixman's MUL_UN8, Skia's SkMulDiv255Round",
     CODES(.product = CODES_NEAREST)},
    {"codes-driver", "t = ab; t += t >> 8; (t + 128) >> 8: llvmpipe's lp_build_mul_norm",
     CODES(.product = CODES_DRIVER)},
    {"codes-floor", "ab / 255, the remainder dropped: integer division in C",
     CODES(.product = CODES_FLOOR)},
    {"codes-shift-most", "(ab + 255) >> 8: a shift for the division, upward",
     CODES(.product = CODES_SHIFT_MOST)},
    {"codes-shift-stretch", "a*(b + (b >> 7)) >> 8: b stretched so that 255 is 256",
     CODES(.product = CODES_SHIFT_STRETCH)},
    {"codes-shift-plus", "a*(b + 1) >> 8, b the factor: Skia's SkAlphaMul",
     CODES(.product = CODES_SHIFT_PLUS)},

    /* Wrong: 1 times 1 is not 1. */
    {"codes-shift", "ab >> 8: white times white is 254", CODES(.product = CODES_SHIFT),
     .wrong = true},
    {"codes-shift-round", "(ab + 128) >> 8: white times white is 254",
     CODES(.product = CODES_SHIFT_ROUND), .wrong = true},
    {"codes-reciprocal", "ab*257 >> 16 without the 128 that belongs to ab: white is 254",
     CODES(.product = CODES_RECIPROCAL), .wrong = true},

    /* Wrong: another equation. */
    {"factors-swapped", "source's and destination's factor interchanged",
     MISTAKE(MISTAKE_FACTORS_SWAPPED)},
    {"alpha-as-color", "glBlendFunc for glBlendFuncSeparate: alpha has the colours' factors",
     MISTAKE(MISTAKE_ALPHA_AS_COLOR)},
    {"coverage", "the stored alpha taken for coverage where it is transmittance, or otherwise",
     MISTAKE(MISTAKE_COVERAGE)},
    {"alpha-first", "colours are blended with the alpha that this blend has just stored",
     MISTAKE(MISTAKE_ALPHA_FIRST)},
    {"destination-alpha-one", "the stored alpha read as 1, as of a target without alpha",
     MISTAKE(MISTAKE_DESTINATION_ALPHA_ONE)},
    {"unpremultiplied", "the source's colours divided by its alpha",
     MISTAKE(MISTAKE_UNPREMULTIPLIED)},
    {"alpha-twice", "the source's colours multiplied by its alpha once more",
     MISTAKE(MISTAKE_ALPHA_TWICE)},
    {"gamma", "colours squared, blended, and the root stored: blending as of sRGB, with gamma 2",
     MISTAKE(MISTAKE_GAMMA)},

    /* Wrong: short cuts. */
    {"early-out",
     "alpha >= 1 leaves out the destination, T <= 0 the source: NaN, infinity, alpha "
     "beyond 1",
     MISTAKE(MISTAKE_EARLY_OUT)},
    {"early-out-254", "alpha >= 254/255 leaves out the destination, T <= 1/255 the source",
     MISTAKE(MISTAKE_EARLY_OUT_254)},
    {"clamped-early", "the source clamped to [0, 1], though the format is float",
     MISTAKE(MISTAKE_CLAMPED_EARLY)},
    {"clamped-late", "a unorm target's source not clamped before it is blended: OpenGL clamps it",
     MISTAKE(MISTAKE_CLAMPED_LATE)},
    {"nan-zero", "NaN stored as 0 in float formats: Direct3D keeps it", MISTAKE(MISTAKE_NAN_ZERO)},

    /* Wrong: too few bits. */
    {"complement-codes", "1 - x computed in 8 bits, the rest in float",
     MISTAKE(MISTAKE_COMPLEMENT_CODES)},
    {"through-half", "the result rounded to half, then to the format",
     MISTAKE(MISTAKE_THROUGH_HALF)},
    {"codes-wrap", "a sum beyond the greatest code wraps around", CODES_BUT(MISTAKE_WRAPS)},
    {"codes-eight-bits", "rgba16 blended in its upper 8 bits, times 257",
     CODES_BUT(MISTAKE_EIGHT_BITS)},
    {"codes-eight-bits-shifted",
     "rgba16 blended in its upper 8 bits, times 256 instead of 257: white is 65280",
     CODES_BUT(MISTAKE_EIGHT_BITS_SHIFTED)},
};

enum {
    INFO_COUNT = sizeof infos / sizeof *infos
};

size_t arithmetic_count(void)
{
    return INFO_COUNT;
}

const ArithmeticInfo *arithmetic_info(size_t i)
{
    return &infos[i];
}

bool arithmetic_is_wrong(const ArithmeticInfo *info, PixelFormat format)
{
    const FormatInfo *target = format_info(format);
    bool halves =
        info->arithmetic.kind == ARITHMETIC_STEPS && info->arithmetic.precision == PRECISION_HALF;
    bool longer = target->kind == KIND_FLOAT || target->unorm_max >= 1u << 11;
    return info->wrong || (halves && longer);
}

static const char *const precisions[] = {"float", "half", "double", "codes", NULL};
static const char *const roundings[] = {"nearest", "truncate", "away", "up", NULL};
static const char *const products[] = {"nearest",     "driver",     "floor",         "shift",
                                       "shift-round", "shift-most", "shift-stretch", "shift-plus",
                                       "reciprocal",  NULL};
static const char *const answers[] = {"no", "yes", NULL};
static const char *const mistakes[MISTAKE_COUNT + 1] = {
    [MISTAKE_FACTORS_SWAPPED] = "factors-swapped",
    [MISTAKE_ALPHA_AS_COLOR] = "alpha-as-color",
    [MISTAKE_COVERAGE] = "coverage",
    [MISTAKE_ALPHA_FIRST] = "alpha-first",
    [MISTAKE_DESTINATION_ALPHA_ONE] = "destination-alpha-one",
    [MISTAKE_UNPREMULTIPLIED] = "unpremultiplied",
    [MISTAKE_ALPHA_TWICE] = "alpha-twice",
    [MISTAKE_EARLY_OUT] = "early-out",
    [MISTAKE_EARLY_OUT_254] = "early-out-254",
    [MISTAKE_CLAMPED_EARLY] = "clamped-early",
    [MISTAKE_CLAMPED_LATE] = "clamped-late",
    [MISTAKE_WRAPS] = "wraps",
    [MISTAKE_EIGHT_BITS] = "eight-bits",
    [MISTAKE_EIGHT_BITS_SHIFTED] = "eight-bits-shifted",
    [MISTAKE_COMPLEMENT_CODES] = "complement-codes",
    [MISTAKE_THROUGH_HALF] = "through-half",
    [MISTAKE_NAN_ZERO] = "nan-zero",
    [MISTAKE_GAMMA] = "gamma",
};

const char *arithmetic_mistake_name(BlendMistake mistake)
{
    return mistakes[mistake];
}

static int find(const char *const *names, const char *text, size_t length)
{
    for (int i = 0; names[i]; i++)
        if (strlen(names[i]) == length && memcmp(names[i], text, length) == 0)
            return i;
    return -1;
}

typedef enum Field {
    FIELD_PRECISION = 0,
    FIELD_ROUNDING,
    FIELD_STORE,
    FIELD_PRODUCT,
    FIELD_FUSED,
    FIELD_FLUSH,
    FIELD_SOURCE_STORED,
    FIELD_MISTAKE,
    FIELD_COUNT
} Field;

static const struct {
    const char *key, *expected;
    const char *const *values;
} fields[FIELD_COUNT] = {
    [FIELD_PRECISION] = {"precision", "float, half, double or codes", precisions},
    [FIELD_ROUNDING] = {"rounding", "nearest, truncate, away or up", roundings},
    [FIELD_STORE] = {"store", "nearest, truncate, away or up", roundings},
    [FIELD_PRODUCT] = {"product",
                       "nearest, driver, floor, shift, shift-round, shift-most, shift-stretch, "
                       "shift-plus or reciprocal",
                       products},
    [FIELD_FUSED] = {"fused", "yes or no", answers},
    [FIELD_FLUSH] = {"flush", "yes or no", answers},
    [FIELD_SOURCE_STORED] = {"source-stored", "yes or no", answers},
    [FIELD_MISTAKE] = {"mistake", "a mistake, such as factors-swapped", mistakes},
};

static void set_field(Arithmetic *out, Field field, int value)
{
    switch (field) {
    case FIELD_PRECISION:
        out->precision = (BlendPrecision)value;
        break;
    case FIELD_ROUNDING:
        out->rounding = (BlendRounding)value;
        break;
    case FIELD_STORE:
        out->store = (BlendRounding)value;
        break;
    case FIELD_PRODUCT:
        out->product = (CodeProduct)value;
        break;
    case FIELD_FUSED:
        out->fused = value;
        break;
    case FIELD_FLUSH:
        out->flush = value;
        break;
    case FIELD_SOURCE_STORED:
        out->source_stored = value;
        break;
    default:
        out->mistakes |= 1u << value;
    }
}

/* The value of a field other than mistakes. */
static int get_field(const Arithmetic *arithmetic, Field field)
{
    const int values[] = {
        [FIELD_PRECISION] = (int)arithmetic->precision,
        [FIELD_ROUNDING] = (int)arithmetic->rounding,
        [FIELD_STORE] = (int)arithmetic->store,
        [FIELD_PRODUCT] = (int)arithmetic->product,
        [FIELD_FUSED] = arithmetic->fused,
        [FIELD_FLUSH] = arithmetic->flush,
        [FIELD_SOURCE_STORED] = arithmetic->source_stored,
    };
    return values[field];
}

static Result parse_field(const char *text, size_t length, Arithmetic *out)
{
    const char *equals = memchr(text, '=', length);
    for (int i = 0; equals && i < FIELD_COUNT; i++) {
        size_t key = (size_t)(equals - text);
        if (strlen(fields[i].key) != key || memcmp(fields[i].key, text, key) != 0)
            continue;
        int value = find(fields[i].values, equals + 1, length - key - 1);
        if (value < 0)
            return result_fail(RESULT_BAD_INPUT, "arithmetic: '%.*s': expected %s", (int)length,
                               text, fields[i].expected);
        set_field(out, (Field)i, value);
        return RESULT_OK;
    }
    return result_fail(RESULT_BAD_INPUT,
                       "arithmetic: '%.*s': expected a name, or key=value of precision, rounding, "
                       "store, product, fused, flush, source-stored, mistake",
                       (int)length, text);
}

Result arithmetic_parse(const char *text, Arithmetic *out)
{
    for (size_t i = 0; i < INFO_COUNT; i++)
        if (strcmp(infos[i].name, text) == 0) {
            *out = infos[i].arithmetic;
            return RESULT_OK;
        }
    Arithmetic parsed = {.kind = ARITHMETIC_STEPS};
    for (const char *end;; text = end + 1) {
        end = strchr(text, ',');
        Result result = parse_field(text, end ? (size_t)(end - text) : strlen(text), &parsed);
        if (result != RESULT_OK)
            return result;
        if (!end)
            break;
    }
    *out = parsed;
    return RESULT_OK;
}

static bool same(const Arithmetic *a, const Arithmetic *b)
{
    if (a->kind != ARITHMETIC_STEPS || b->kind != ARITHMETIC_STEPS)
        return a->kind == b->kind && (a->kind == ARITHMETIC_EXACT || a->fused == b->fused);
    bool equal = a->mistakes == b->mistakes;
    for (int i = 0; i < FIELD_MISTAKE; i++)
        equal = equal && get_field(a, (Field)i) == get_field(b, (Field)i);
    return equal;
}

void arithmetic_print(const Arithmetic *arithmetic, char out[ARITHMETIC_TEXT])
{
    for (size_t i = 0; i < INFO_COUNT; i++)
        if (same(arithmetic, &infos[i].arithmetic)) {
            snprintf(out, ARITHMETIC_TEXT, "%s", infos[i].name);
            return;
        }
    int at = 0;
    out[0] = '\0';
    for (int i = 0; i < FIELD_MISTAKE; i++)
        if (get_field(arithmetic, (Field)i))
            at += snprintf(out + at, (size_t)(ARITHMETIC_TEXT - at), "%s%s=%s", at ? "," : "",
                           fields[i].key, fields[i].values[get_field(arithmetic, (Field)i)]);
    for (int i = 0; i < MISTAKE_COUNT; i++)
        if (arithmetic->mistakes >> i & 1)
            at += snprintf(out + at, (size_t)(ARITHMETIC_TEXT - at), "%smistake=%s", at ? "," : "",
                           mistakes[i]);
}

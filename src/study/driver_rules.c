/* The rules, in the order of the pipeline's page of number conventions. */
#include "study/driver_rules.h"

#define NUMBERS_SETS (INPUT_UNIT | INPUT_SIGNED | INPUT_WIDE)
#define ODD_SETS     (INPUT_SPECIAL | INPUT_BITS | INPUT_DENORMAL)

/* Arguments are initializers, which take no parentheses where they are in braces.
 * NOLINTBEGIN(bugprone-macro-parentheses) */
/* Single operations. */
#define OPERATION(id_, what_, operation_, sets_)                                                   \
    {                                                                                              \
        .id = id_, .what = what_, .section = "Arithmetic", .run = test_values,                     \
        .experiment = {.kind = EXPERIMENT_OPERATION, .operation = operation_}, .sets = sets_       \
    }
#define VERTEX(id_, what_, operation_, sets_)                                                      \
    {                                                                                              \
        .id = id_, .what = what_, .section = "Arithmetic", .run = test_values,                     \
        .experiment = {.kind = EXPERIMENT_OPERATION, .operation = operation_, .vertex = true},     \
        .sets = sets_                                                                              \
    }
/* Triangles, one by one. */
#define RASTER(id_, what_, value_, triangle_, first_, end_, zero_, format_)                        \
    {                                                                                              \
        .id = id_, .what = what_, .section = "From clip to pixel", .value = value_,                \
        .run = test_raster, .triangle = triangle_, .field = first_, .field_end = end_,             \
        .experiment = {                                                                            \
            .kind = EXPERIMENT_RASTER,                                                             \
            .format = format_,                                                                     \
            .zero_to_one = zero_                                                                   \
        }                                                                                          \
    }
#define FORMAT(id_, what_, value_, run_, kind_, format_, sets_)                                    \
    {                                                                                              \
        .id = id_, .what = what_, .section = "Stored formats", .value = value_, .run = run_,       \
        .experiment = {.kind = kind_, .format = format_}, .sets = sets_                            \
    }
#define BLEND(id_, what_, relied_, allowance_, value_, format_, equation_, sets_)                  \
    {                                                                                              \
        .id = id_, .what = what_, .section = "Blending", .relied_on = relied_,                     \
        .allowance = allowance_, .value = value_, .run = test_values,                              \
        .experiment = {.kind = EXPERIMENT_BLEND, .format = format_}, .equation = equation_,        \
        .sets = sets_                                                                              \
    }
#define PEELING(id_, what_, value_, run_, kind_, format_, func_)                                   \
    {                                                                                              \
        .id = id_, .what = what_, .section = "Peeling", .relied_on = true, .value = value_,        \
        .run = run_, .triangle = TRIANGLE_PERSPECTIVE, .experiment = {                             \
            .kind = kind_,                                                                         \
            .format = format_,                                                                     \
            .depth_func = func_                                                                    \
        }                                                                                          \
    }
#define UNTESTED(id_, what_, reason_)                                                              \
    {                                                                                              \
        .id = id_, .what = what_, .section = "Not tested", .reason = reason_                       \
    }
/* NOLINTEND(bugprone-macro-parentheses) */

static const Rule rules[] = {
    OPERATION("add", "a + b", OPERATION_ADD, NUMBERS_SETS),
    OPERATION("sub", "a - b", OPERATION_SUB, NUMBERS_SETS),
    OPERATION("mul", "a * b", OPERATION_MUL, NUMBERS_SETS),
    OPERATION("div", "a / b", OPERATION_DIV, NUMBERS_SETS),
    OPERATION("div-constant", "a / 3.14159265", OPERATION_DIV_CONSTANT, NUMBERS_SETS),
    OPERATION("mul-add", "a * b + a: two roundings", OPERATION_MULADD, NUMBERS_SETS),
    OPERATION("fma", "fma(a, b, a): two roundings", OPERATION_FMA, NUMBERS_SETS),
    OPERATION("sqrt", "sqrt", OPERATION_SQRT, INPUT_UNIT | INPUT_POSITIVE),
    OPERATION("inversesqrt", "inversesqrt: 1 / sqrt", OPERATION_INVERSESQRT,
              INPUT_UNIT | INPUT_POSITIVE),
    OPERATION("dot", "dot, from the last component", OPERATION_DOT, NUMBERS_SETS),
    OPERATION("cross", "cross", OPERATION_CROSS, NUMBERS_SETS),
    OPERATION("matrix", "mat4 * vec4(p, 1)", OPERATION_MATRIX, NUMBERS_SETS),
    OPERATION("normalize", "normalize: v * inversesqrt(dot)", OPERATION_NORMALIZE, NUMBERS_SETS),
    OPERATION("mix", "mix: a * (1 - t) + b * t", OPERATION_MIX, NUMBERS_SETS),
    OPERATION("min", "min", OPERATION_MIN, NUMBERS_SETS),
    OPERATION("max", "max", OPERATION_MAX, NUMBERS_SETS),
    OPERATION("clamp", "clamp to [0, 1]", OPERATION_CLAMP, NUMBERS_SETS),
    OPERATION("abs", "abs", OPERATION_ABS, NUMBERS_SETS),
    OPERATION("floor", "floor", OPERATION_FLOOR, NUMBERS_SETS),
    OPERATION("select", "a < b ? x : y", OPERATION_SELECT, NUMBERS_SETS),
    OPERATION("exp2", "exp2: Mesa's polynomial", OPERATION_EXP2, INPUT_UNIT | INPUT_SIGNED),
    OPERATION("log2", "log2: Mesa's polynomial", OPERATION_LOG2, INPUT_UNIT | INPUT_POSITIVE),
    OPERATION("pow", "pow: exp2(log2(x) * y)", OPERATION_POW, INPUT_UNIT | INPUT_POSITIVE),
    VERTEX("vertex-matrix", "mat4 * vec4(p, 1), vertex stage", OPERATION_MATRIX, NUMBERS_SETS),
    VERTEX("vertex-mul-add", "a * b + a, vertex stage", OPERATION_MULADD, NUMBERS_SETS),
    OPERATION("denormal-add", "denormals are zero: a + b", OPERATION_ADD, INPUT_DENORMAL),
    OPERATION("denormal-mul", "denormals are zero: a * b", OPERATION_MUL,
              INPUT_DENORMAL | INPUT_BITS),
    VERTEX("vertex-denormal-add", "the same, vertex stage: a + b", OPERATION_ADD, INPUT_DENORMAL),
    VERTEX("vertex-denormal-mul", "the same, vertex stage: a * b", OPERATION_MUL,
           INPUT_DENORMAL | INPUT_BITS),
    OPERATION("denormal-copy", "copies keep denormals", OPERATION_COPY,
              INPUT_DENORMAL | INPUT_BITS),
    OPERATION("special-add", "infinities, NaN: a + b", OPERATION_ADD, INPUT_SPECIAL),
    OPERATION("special-div", "infinities, NaN: a / b", OPERATION_DIV, INPUT_SPECIAL),
    OPERATION("special-sqrt", "negative, infinite, NaN: sqrt", OPERATION_SQRT, ODD_SETS),
    OPERATION("special-min", "NaN, equal operands: min", OPERATION_MIN, ODD_SETS),
    OPERATION("special-max", "NaN, equal operands: max", OPERATION_MAX, ODD_SETS),
    OPERATION("special-clamp", "NaN gives 0: clamp to [0, 1]", OPERATION_CLAMP, ODD_SETS),
    OPERATION("special-abs", "any bits: abs", OPERATION_ABS, ODD_SETS),
    OPERATION("special-floor", "any bits: floor", OPERATION_FLOOR, ODD_SETS),
    OPERATION("special-select", "NaN is not less: a < b ? x : y", OPERATION_SELECT, ODD_SETS),
    OPERATION("special-exp2", "any bits: exp2", OPERATION_EXP2, ODD_SETS),
    OPERATION("special-log2", "any bits: log2", OPERATION_LOG2, ODD_SETS),
    OPERATION("special-pow", "any bits: pow", OPERATION_POW, ODD_SETS),

    {.id = "pixel-centre",
     .what = "gl_FragCoord.xy: pixels' centres",
     .section = "From clip to pixel",
     .relied_on = true,
     .run = test_values,
     .experiment = {.kind = EXPERIMENT_OPERATION, .operation = OPERATION_PIXEL},
     .sets = INPUT_UNIT},
    RASTER("snapping", "viewport, corners to 1/256 pixel", DRIVER_CODE, TRIANGLE_SUBPIXEL,
           RASTER_TRIANGLE, RASTER_TRIANGLE + 1, false, FORMAT_D32F),
    RASTER("fill-rule", "left and lower edges are inside", DRIVER_CODE, TRIANGLE_HALF_PIXEL,
           RASTER_TRIANGLE, RASTER_TRIANGLE + 1, false, FORMAT_D32F),
    RASTER("coverage", "triangles in perspective: pixels", DRIVER_CODE, TRIANGLE_PERSPECTIVE,
           RASTER_TRIANGLE, RASTER_TRIANGLE + 1, false, FORMAT_D32F),
    RASTER("clip-coverage", "clipped, -w to w: pixels", DRIVER_CODE, TRIANGLE_CLIPPED,
           RASTER_TRIANGLE, RASTER_TRIANGLE + 1, false, FORMAT_D32F),
    RASTER("clip-depth", "clipped, -w to w: depth", DRIVER_FLOAT, TRIANGLE_CLIPPED, RASTER_Z,
           RASTER_Z + 1, false, FORMAT_D32F),
    RASTER("clip-varying", "clipped, -w to w: varyings", DRIVER_FLOAT, TRIANGLE_CLIPPED, RASTER_X,
           RASTER_X_END, false, FORMAT_D32F),
    RASTER("clip01-coverage", "clipped, 0 to w: pixels", DRIVER_CODE, TRIANGLE_CLIPPED,
           RASTER_TRIANGLE, RASTER_TRIANGLE + 1, true, FORMAT_D32F),
    RASTER("clip01-depth", "clipped, 0 to w: depth", DRIVER_FLOAT, TRIANGLE_CLIPPED, RASTER_Z,
           RASTER_Z + 1, true, FORMAT_D32F),
    RASTER("depth", "interpolation of gl_FragCoord.z", DRIVER_FLOAT, TRIANGLE_PERSPECTIVE, RASTER_Z,
           RASTER_Z + 1, false, FORMAT_D32F),
    RASTER("depth-flat", "the same where w is 1", DRIVER_FLOAT, TRIANGLE_LARGE, RASTER_Z,
           RASTER_Z + 1, false, FORMAT_D32F),
    RASTER("fragment-w", "interpolation of gl_FragCoord.w", DRIVER_FLOAT, TRIANGLE_PERSPECTIVE,
           RASTER_W, RASTER_W + 1, false, FORMAT_D32F),
    RASTER("varying", "interpolation of varyings", DRIVER_FLOAT, TRIANGLE_PERSPECTIVE, RASTER_X,
           RASTER_X_END, false, FORMAT_D32F),
    RASTER("varying-flat", "the same where w is 1", DRIVER_FLOAT, TRIANGLE_LARGE, RASTER_X,
           RASTER_X_END, false, FORMAT_D32F),
    RASTER("drawn-d32f", "depth as drawn, d32f", DRIVER_FLOAT, TRIANGLE_PERSPECTIVE, RASTER_DEPTH,
           RASTER_FIELDS, false, FORMAT_D32F),
    RASTER("drawn-d24", "depth as drawn, d24", DRIVER_CODE, TRIANGLE_PERSPECTIVE, RASTER_DEPTH,
           RASTER_FIELDS, false, FORMAT_D24),
    RASTER("drawn-d16", "depth as drawn, d16", DRIVER_CODE, TRIANGLE_PERSPECTIVE, RASTER_DEPTH,
           RASTER_FIELDS, false, FORMAT_D16),

    FORMAT("store-rgba32f", "rgba32f keeps bits", DRIVER_FLOAT, test_values, EXPERIMENT_STORE,
           FORMAT_RGBA32F, INPUT_UNIT | INPUT_BITS),
    FORMAT("store-rgba16f", "rgba16f truncates", DRIVER_HALF, test_values, EXPERIMENT_STORE,
           FORMAT_RGBA16F, INPUT_UNIT | INPUT_CODES | ODD_SETS),
    FORMAT("store-rgba16", "rgba16 rounds to even", DRIVER_CODE, test_values, EXPERIMENT_STORE,
           FORMAT_RGBA16, INPUT_UNIT | INPUT_CODES | ODD_SETS),
    FORMAT("store-rgba8", "rgba8 rounds to even", DRIVER_CODE, test_values, EXPERIMENT_STORE,
           FORMAT_RGBA8, INPUT_UNIT | INPUT_CODES | ODD_SETS),
    FORMAT("store-rg16", "rg16 rounds to even", DRIVER_CODE, test_values, EXPERIMENT_STORE,
           FORMAT_RG16, INPUT_UNIT | INPUT_CODES | ODD_SETS),
    FORMAT("clear-rgba32f", "a clear, as a store: rgba32f", DRIVER_FLOAT, test_clear,
           EXPERIMENT_CLEAR, FORMAT_RGBA32F, 0),
    FORMAT("clear-rgba16f", "rgba16f", DRIVER_HALF, test_clear, EXPERIMENT_CLEAR, FORMAT_RGBA16F,
           0),
    FORMAT("clear-rgba16", "rgba16, but ties up", DRIVER_CODE, test_clear, EXPERIMENT_CLEAR,
           FORMAT_RGBA16, 0),
    FORMAT("clear-rgba8", "rgba8", DRIVER_CODE, test_clear, EXPERIMENT_CLEAR, FORMAT_RGBA8, 0),
    FORMAT("clear-rg16", "rg16, but ties up", DRIVER_CODE, test_clear, EXPERIMENT_CLEAR,
           FORMAT_RG16, 0),
    FORMAT("fetch-rgba16f", "a fetch is exact: rgba16f", DRIVER_FLOAT, test_fetch, EXPERIMENT_FETCH,
           FORMAT_RGBA16F, 0),
    FORMAT("fetch-rgba16", "i * (1/65535): rgba16", DRIVER_FLOAT, test_fetch, EXPERIMENT_FETCH,
           FORMAT_RGBA16, 0),
    FORMAT("fetch-rgba8", "i * (1/255): rgba8", DRIVER_FLOAT, test_fetch, EXPERIMENT_FETCH,
           FORMAT_RGBA8, 0),
    FORMAT("fetch-rg16", "i * (1/65535): rg16", DRIVER_FLOAT, test_fetch, EXPERIMENT_FETCH,
           FORMAT_RG16, 0),
    FORMAT("store-d32f", "d32f keeps bits in [0, 1]", DRIVER_FLOAT, test_values,
           EXPERIMENT_DEPTH_STORE, FORMAT_D32F, INPUT_UNIT | INPUT_CODES),
    FORMAT("store-d24", "d24 rounds to even", DRIVER_CODE, test_values, EXPERIMENT_DEPTH_STORE,
           FORMAT_D24, INPUT_UNIT | INPUT_CODES),
    FORMAT("store-d16", "d16: in z * 65535/65536 + 128", DRIVER_CODE, test_values,
           EXPERIMENT_DEPTH_STORE, FORMAT_D16, INPUT_UNIT | INPUT_CODES),
    FORMAT("clamp-d32f", "clamped to [0, 1], NaN 1: d32f", DRIVER_FLOAT, test_values,
           EXPERIMENT_DEPTH_STORE, FORMAT_D32F, ODD_SETS),
    FORMAT("clamp-d24", "d24", DRIVER_CODE, test_values, EXPERIMENT_DEPTH_STORE, FORMAT_D24,
           ODD_SETS),
    FORMAT("clamp-d16", "d16", DRIVER_CODE, test_values, EXPERIMENT_DEPTH_STORE, FORMAT_D16,
           ODD_SETS),
    FORMAT("fetch-d32f", "d32f is fetched as stored", DRIVER_FLOAT, test_depth_fetch,
           EXPERIMENT_DEPTH_FETCH, FORMAT_D32F, 0),
    FORMAT("fetch-d24", "i * (1/16777215): d24", DRIVER_FLOAT, test_depth_fetch,
           EXPERIMENT_DEPTH_FETCH, FORMAT_D24, 0),
    FORMAT("fetch-d16", "i * (1/65535): d16", DRIVER_FLOAT, test_depth_fetch,
           EXPERIMENT_DEPTH_FETCH, FORMAT_D16, 0),

    BLEND("under-rgba32f", "s * T + d, T * (1 - s): rgba32f", true, 4, DRIVER_FLOAT, FORMAT_RGBA32F,
          EQUATION_UNDER, INPUT_UNIT),
    BLEND("under-rgba16f", "the same, truncated: rgba16f", true, 2, DRIVER_HALF, FORMAT_RGBA16F,
          EQUATION_UNDER, INPUT_UNIT),
    BLEND("under-rgba16", "the same in integers: rgba16", true, 2, DRIVER_CODE, FORMAT_RGBA16,
          EQUATION_UNDER, INPUT_UNIT),
    BLEND("under-rgba8", "rgba8", true, 2, DRIVER_CODE, FORMAT_RGBA8, EQUATION_UNDER, INPUT_UNIT),
    BLEND("under-odd-rgba32f", "any source: rgba32f", false, 0, DRIVER_FLOAT, FORMAT_RGBA32F,
          EQUATION_UNDER, INPUT_SIGNED | ODD_SETS),
    BLEND("under-odd-rgba16f", "rgba16f, denormals kept", false, 0, DRIVER_HALF, FORMAT_RGBA16F,
          EQUATION_UNDER, INPUT_SIGNED | ODD_SETS),
    BLEND("under-odd-rgba16", "rgba16", false, 0, DRIVER_CODE, FORMAT_RGBA16, EQUATION_UNDER,
          INPUT_SIGNED | ODD_SETS),
    BLEND("under-odd-rgba8", "rgba8", false, 0, DRIVER_CODE, FORMAT_RGBA8, EQUATION_UNDER,
          INPUT_SIGNED | ODD_SETS),
    BLEND("seed-rgba32f", "(DST_ALPHA, ONE), any: rgba32f", false, 0, DRIVER_FLOAT, FORMAT_RGBA32F,
          EQUATION_SEED, INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("seed-rgba16f", "rgba16f", false, 0, DRIVER_HALF, FORMAT_RGBA16F, EQUATION_SEED,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("seed-rgba16", "rgba16", false, 0, DRIVER_CODE, FORMAT_RGBA16, EQUATION_SEED,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("seed-rgba8", "rgba8", false, 0, DRIVER_CODE, FORMAT_RGBA8, EQUATION_SEED,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("over-rgba32f", "s + d * (1 - sA), any: rgba32f", false, 0, DRIVER_FLOAT, FORMAT_RGBA32F,
          EQUATION_OVER_TRANSMITTANCE, INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("over-rgba16f", "rgba16f", false, 0, DRIVER_HALF, FORMAT_RGBA16F,
          EQUATION_OVER_TRANSMITTANCE, INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("over-rgba16", "rgba16", false, 0, DRIVER_CODE, FORMAT_RGBA16,
          EQUATION_OVER_TRANSMITTANCE, INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("over-rgba8", "rgba8", false, 0, DRIVER_CODE, FORMAT_RGBA8, EQUATION_OVER_TRANSMITTANCE,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("add-rgba32f", "(ONE, ONE): rgba32f", false, 0, DRIVER_FLOAT, FORMAT_RGBA32F,
          EQUATION_ADD, INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("add-rgba16f", "rgba16f", false, 0, DRIVER_HALF, FORMAT_RGBA16F, EQUATION_ADD,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("add-rgba16", "rgba16", false, 0, DRIVER_CODE, FORMAT_RGBA16, EQUATION_ADD,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("add-rgba8", "rgba8", false, 0, DRIVER_CODE, FORMAT_RGBA8, EQUATION_ADD,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("add-rg32f", "rg32f", false, 0, DRIVER_FLOAT, FORMAT_RG32F, EQUATION_ADD,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("add-r32f", "r32f", false, 0, DRIVER_FLOAT, FORMAT_R32F, EQUATION_ADD,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("product-rgba32f", "d * (1 - s): rgba32f", false, 0, DRIVER_FLOAT, FORMAT_RGBA32F,
          EQUATION_PRODUCT, INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("product-rgba16f", "rgba16f", false, 0, DRIVER_HALF, FORMAT_RGBA16F, EQUATION_PRODUCT,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("product-rgba16", "rgba16", false, 0, DRIVER_CODE, FORMAT_RGBA16, EQUATION_PRODUCT,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("product-rgba8", "rgba8", false, 0, DRIVER_CODE, FORMAT_RGBA8, EQUATION_PRODUCT,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("product-r32f", "r32f", false, 0, DRIVER_FLOAT, FORMAT_R32F, EQUATION_PRODUCT,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("max-rgba32f", "the greater of s and d: rgba32f", false, 0, DRIVER_FLOAT, FORMAT_RGBA32F,
          EQUATION_MAX, INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("max-rg32f", "rg32f", false, 0, DRIVER_FLOAT, FORMAT_RG32F, EQUATION_MAX,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("max-rgba16f", "rgba16f", false, 0, DRIVER_HALF, FORMAT_RGBA16F, EQUATION_MAX,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("max-rgba16", "rgba16", false, 0, DRIVER_CODE, FORMAT_RGBA16, EQUATION_MAX,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("max-rgba8", "rgba8", false, 0, DRIVER_CODE, FORMAT_RGBA8, EQUATION_MAX,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("replace-rgba32f", "s * sA + d * (1 - sA): rgba32f", false, 0, DRIVER_FLOAT,
          FORMAT_RGBA32F, EQUATION_REPLACE, INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("replace-rgba16f", "rgba16f", false, 0, DRIVER_HALF, FORMAT_RGBA16F, EQUATION_REPLACE,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("replace-rgba16", "rgba16", false, 0, DRIVER_CODE, FORMAT_RGBA16, EQUATION_REPLACE,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("replace-rgba8", "rgba8", false, 0, DRIVER_CODE, FORMAT_RGBA8, EQUATION_REPLACE,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("keep-rgba32f", "s * (1 - dA) + d: rgba32f", false, 0, DRIVER_FLOAT, FORMAT_RGBA32F,
          EQUATION_KEEP, INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("keep-rgba16f", "rgba16f", false, 0, DRIVER_HALF, FORMAT_RGBA16F, EQUATION_KEEP,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("keep-rgba16", "rgba16", false, 0, DRIVER_CODE, FORMAT_RGBA16, EQUATION_KEEP,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),
    BLEND("keep-rgba8", "rgba8", false, 0, DRIVER_CODE, FORMAT_RGBA8, EQUATION_KEEP,
          INPUT_UNIT | INPUT_SIGNED | ODD_SETS),

    PEELING("shared-edges", "meshes cover each pixel once", DRIVER_CODE, test_grid,
            EXPERIMENT_OVERLAP, FORMAT_NONE, DEPTH_LESS),
    {.id = "facing",
     .what = "gl_FrontFacing: counter-clockwise",
     .section = "Peeling",
     .relied_on = true,
     .value = DRIVER_CODE,
     .run = test_raster,
     .triangle = TRIANGLE_LARGE,
     .field = RASTER_FRONT,
     .field_end = RASTER_FRONT + 1,
     .experiment = {.kind = EXPERIMENT_RASTER, .format = FORMAT_D32F}},
    PEELING("ties-less", "LESS: of equal depths the first", DRIVER_CODE, test_ties,
            EXPERIMENT_RASTER, FORMAT_D32F, DEPTH_LESS),
    PEELING("ties-lequal", "LEQUAL: of equal depths the last", DRIVER_CODE, test_ties,
            EXPERIMENT_RASTER, FORMAT_D32F, DEPTH_LEQUAL),
    PEELING("passes-d32f", "other shaders, same depth: d32f", DRIVER_FLOAT, test_layouts,
            EXPERIMENT_RASTER, FORMAT_D32F, DEPTH_LESS),
    PEELING("passes-d24", "d24", DRIVER_CODE, test_layouts, EXPERIMENT_RASTER, FORMAT_D24,
            DEPTH_LESS),
    PEELING("passes-d16", "d16", DRIVER_CODE, test_layouts, EXPERIMENT_RASTER, FORMAT_D16,
            DEPTH_LESS),
    PEELING("samples-passed", "the count that ends the peels", DRIVER_CODE, test_samples,
            EXPERIMENT_SAMPLES, FORMAT_D32F, DEPTH_LESS),
    {.id = "repeat",
     .what = "the same clipped frame twice",
     .section = "Peeling",
     .relied_on = true,
     .value = DRIVER_CODE,
     .run = test_repeat,
     .triangle = TRIANGLE_CLIPPED,
     .experiment = {.kind = EXPERIMENT_RASTER, .format = FORMAT_D32F}},
    PEELING("peels-d32f", "each layer once, in order: d32f", DRIVER_FLOAT, test_peels,
            EXPERIMENT_RASTER, FORMAT_D32F, DEPTH_LESS),
    PEELING("peels-d24", "d24", DRIVER_CODE, test_peels, EXPERIMENT_RASTER, FORMAT_D24, DEPTH_LESS),
    PEELING("peels-d16", "d16", DRIVER_CODE, test_peels, EXPERIMENT_RASTER, FORMAT_D16, DEPTH_LESS),

    UNTESTED("multisampling", "several samples a pixel", "the pipeline has one sample"),
    UNTESTED("upper-left", "clip control GL_UPPER_LEFT", "the pipeline's origin is the lower left"),
    UNTESTED("infinite-w", "corners with w beyond 1e37",
             "no rule is known: llvmpipe's bins overflow"),
    UNTESTED("huge-rgba8", "rgba8 of 2^31/255 and more",
             "depends on the processor; shaders clamp first"),
    UNTESTED("filtering", "the driver's texture filters",
             "the pipeline fetches texels and filters itself"),
    UNTESTED("lines-points", "lines and points", "the pipeline draws triangles only"),
};

const Rule *driver_rules(size_t *count)
{
    *count = sizeof rules / sizeof *rules;
    return rules;
}

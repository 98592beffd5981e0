/* Experiments on the number rules: small inputs whose outputs the rules determine to the bit.
 *
 * An experiment is data. A Lab carries it out: ref/pipeline's says what the rules give, gl's what
 * the driver does, and study/driver compares the two. Pixels are GL's: (0, 0) is the bottom left.
 * Multisampling, lines, textures with filters and GL_UPPER_LEFT are not covered. */
#ifndef PEEL_FRAME_EXPERIMENT_H
#define PEEL_FRAME_EXPERIMENT_H

#include "base/result.h"
#include "frame/render_desc.h"
#include "number/blend_equation.h"
#include "number/format.h"

#include <stddef.h>
#include <stdint.h>

enum {
    EXPERIMENT_WIDTH = 256, /* of the operands and colour targets */
    EXPERIMENT_HEIGHT = 128,
    EXPERIMENT_TEXELS = EXPERIMENT_WIDTH * EXPERIMENT_HEIGHT,
    RASTER_WIDTH = 125, /* of the targets that triangles are drawn to */
    RASTER_HEIGHT = 61,
    RASTER_PIXELS = RASTER_WIDTH * RASTER_HEIGHT
};

typedef enum Operation {
    OPERATION_ADD,
    OPERATION_SUB,
    OPERATION_MUL,
    OPERATION_DIV,
    OPERATION_DIV_CONSTANT,
    OPERATION_MULADD,
    OPERATION_FMA,
    OPERATION_SQRT,
    OPERATION_INVERSESQRT,
    OPERATION_DOT,
    OPERATION_CROSS,
    OPERATION_MATRIX,
    OPERATION_NORMALIZE,
    OPERATION_MIX,
    OPERATION_MIN,
    OPERATION_MAX,
    OPERATION_CLAMP,
    OPERATION_ABS,
    OPERATION_FLOOR,
    OPERATION_SELECT,
    OPERATION_EXP2,
    OPERATION_LOG2,
    OPERATION_POW,
    OPERATION_COPY,
    OPERATION_PIXEL, /* gl_FragCoord.xy */
    OPERATION_COUNT
} Operation;

typedef struct OperationInfo {
    const char *glsl; /* statements that set `precise vec4 r` from vec4 a and b */
    int operands;     /* 1: a only */
    bool channelwise; /* r[i] depends on a[i] and b[i] only */
} OperationInfo;

const OperationInfo *operation_info(Operation operation); /* static */

/* Inputs are a and b; outputs are uint32_t: bits of floats or halves, or codes. */
typedef enum ExperimentKind {
    EXPERIMENT_OPERATION, /* 4 floats a texel: operation(a, b) in a shader */
    EXPERIMENT_STORE,     /* 4 codes a texel: a stored in a colour format */
    EXPERIMENT_CLEAR,     /* 4 codes for each of `count` texels: a target cleared to a */
    EXPERIMENT_FETCH, /* 4 floats a texel: codes 4·i … 4·i + 3 of a format, modulo its size */
    EXPERIMENT_DEPTH_STORE, /* 1 code a texel: gl_FragDepth = a.x */
    EXPERIMENT_DEPTH_FETCH, /* 2 values a texel: the code (d24, d16) or depth near a.x that could be
                             * put into a texture, and the float that is fetched */
    EXPERIMENT_BLEND,       /* 4 codes a texel: a blended onto b, which is stored first */
    EXPERIMENT_RASTER,      /* RASTER_FIELDS values a pixel: `count` triangles, see below */
    EXPERIMENT_OVERLAP,     /* 1 count a pixel: how many of the triangles cover it */
    EXPERIMENT_SAMPLES      /* 1 count: what GL_SAMPLES_PASSED says of the triangles */
} ExperimentKind;

typedef enum RasterField {
    RASTER_TRIANGLE, /* 1 + index of the triangle seen, 0 for none: the other fields are then 0 */
    RASTER_FRONT,    /* 1 or 0 */
    RASTER_Z,        /* gl_FragCoord.z */
    RASTER_W,        /* gl_FragCoord.w */
    RASTER_X,        /* three smooth varyings */
    RASTER_X_END = RASTER_X + 3,
    RASTER_DEPTH = RASTER_X_END, /* stored */
    RASTER_FIELDS
} RasterField;

/* Which shaders and targets draw; the rules say that depth does not depend on it. All but
 * RASTER_FULL give RASTER_DEPTH only, as 0 where nothing is. */
typedef enum RasterLayout {
    RASTER_FULL = 0,
    RASTER_DEPTH_ONLY,
    RASTER_DISCARD,
    RASTER_LAYOUTS
} RasterLayout;

typedef struct Experiment {
    ExperimentKind kind;
    Operation operation;
    bool vertex;        /* the operation is done in the vertex stage */
    PixelFormat format; /* of colour or depth */
    BlendEquation equation;
    /* EXPERIMENT_TEXELS vec4 each; for triangles, 3·count corners: clip position, and varyings
     * in x, y, z. The caller's. */
    const float (*a)[4], (*b)[4];
    uint32_t
        *before; /* EXPERIMENT_BLEND: NULL, or room for what b was stored as, 4 codes a texel */
    int count;
    bool zero_to_one; /* clip space depth 0…w */
    DepthFunc depth_func;
    RasterLayout layout;
} Experiment;

/* Most values that an experiment gives. */
#define EXPERIMENT_VALUES_MAX ((size_t)4 * EXPERIMENT_TEXELS)

size_t experiment_values(const Experiment *experiment);

typedef struct Lab Lab;
struct Lab {
    /* out: room for experiment_values. A failure leaves it undefined. */
    Result (*run)(Lab *lab, const Experiment *experiment, uint32_t *out);
};

#endif

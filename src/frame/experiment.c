#include "frame/experiment.h"

static const OperationInfo operations[OPERATION_COUNT] = {
    [OPERATION_ADD] = {"r = a + b;", 2, true},
    [OPERATION_SUB] = {"r = a - b;", 2, true},
    [OPERATION_MUL] = {"r = a * b;", 2, true},
    [OPERATION_DIV] = {"r = a / b;", 2, true},
    [OPERATION_DIV_CONSTANT] = {"r = a / 3.14159265;", 1, true},
    [OPERATION_MULADD] = {"r = a * b + a;", 2, true},
    [OPERATION_FMA] = {"r = fma(a, b, a);", 2, true},
    [OPERATION_SQRT] = {"r = sqrt(a);", 1, true},
    [OPERATION_INVERSESQRT] = {"r = inversesqrt(a);", 1, true},
    [OPERATION_DOT] = {"precise float d = dot(a.xyz, b.xyz); r = vec4(d);", 2, false},
    [OPERATION_CROSS] = {"precise vec3 c = cross(a.xyz, b.xyz); r = vec4(c, 0.0);", 2, false},
    [OPERATION_MATRIX] = {"r = mat4(a, a.wzyx, b.yxwz, b) * vec4(b.zxy, 1.0);", 2, false},
    [OPERATION_NORMALIZE] = {"precise vec3 n = normalize(a.xyz); r = vec4(n, 0.0);", 1, false},
    [OPERATION_MIX] = {"r = mix(a, b, 0.3);", 2, true},
    [OPERATION_MIN] = {"r = min(a, b);", 2, true},
    [OPERATION_MAX] = {"r = max(a, b);", 2, true},
    [OPERATION_CLAMP] = {"r = clamp(a, 0.0, 1.0);", 1, true},
    [OPERATION_ABS] = {"r = abs(a);", 1, true},
    [OPERATION_FLOOR] = {"r = floor(a);", 1, true},
    [OPERATION_SELECT] = {"precise float s = a.x < b.x ? 1.0 : b.x; r = vec4(s);", 2, false},
    [OPERATION_EXP2] = {"r = exp2(a);", 1, true},
    [OPERATION_LOG2] = {"r = log2(a);", 1, true},
    [OPERATION_POW] = {"r = pow(a, b);", 2, true},
    [OPERATION_COPY] = {"r = a;", 1, true},
    [OPERATION_PIXEL] = {"r = vec4(PIXEL, 0.0, 0.0);", 1, false},
};

const OperationInfo *operation_info(Operation operation)
{
    return &operations[operation];
}

size_t experiment_values(const Experiment *experiment)
{
    switch (experiment->kind) {
    case EXPERIMENT_CLEAR:
        return (size_t)4 * (size_t)experiment->count;
    case EXPERIMENT_DEPTH_STORE:
        return EXPERIMENT_TEXELS;
    case EXPERIMENT_DEPTH_FETCH:
        return (size_t)2 * EXPERIMENT_TEXELS;
    case EXPERIMENT_RASTER:
        return (size_t)RASTER_FIELDS * RASTER_PIXELS;
    case EXPERIMENT_OVERLAP:
        return RASTER_PIXELS;
    case EXPERIMENT_SAMPLES:
        return 1;
    default:
        return (size_t)4 * EXPERIMENT_TEXELS;
    }
}

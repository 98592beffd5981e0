#include "ref/pipeline/experiment.h"

#include "number/op.h"

static void cross_of(const float a[4], const float b[4], float out[4])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = op_sub(op_mul(a[j], b[k]), op_mul(a[k], b[j]));
    }
    out[3] = 0.0f;
}

/* From the first column; the fourth term is the column itself. */
static void matrix_of(const float a[4], const float b[4], float out[4])
{
    const float columns[4][4] = {{a[0], a[1], a[2], a[3]},
                                 {a[3], a[2], a[1], a[0]},
                                 {b[1], b[0], b[3], b[2]},
                                 {b[0], b[1], b[2], b[3]}};
    const float v[3] = {b[2], b[0], b[1]};
    for (int i = 0; i < 4; i++) {
        float sum = op_add(op_mul(columns[0][i], v[0]), op_mul(columns[1][i], v[1]));
        out[i] = op_add(op_add(sum, op_mul(columns[2][i], v[2])), columns[3][i]);
    }
}

static void normalize_of(const float a[4], float out[4])
{
    float scale = op_inversesqrt(op_dot3(a, a));
    for (int i = 0; i < 3; i++)
        out[i] = op_mul(a[i], scale);
    out[3] = 0.0f;
}

static float channel(bool fused, Operation operation, float a, float b)
{
    switch (operation) {
    case OPERATION_ADD:
        return op_add(a, b);
    case OPERATION_SUB:
        return op_sub(a, b);
    case OPERATION_MUL:
        return op_mul(a, b);
    case OPERATION_DIV:
        return op_div(a, b);
    case OPERATION_DIV_CONSTANT:
        return op_div(a, 3.14159265f);
    case OPERATION_MULADD:
    case OPERATION_FMA: /* shaders never fuse */
        return op_add(op_mul(a, b), a);
    case OPERATION_SQRT:
        return op_sqrt(a);
    case OPERATION_INVERSESQRT:
        return op_inversesqrt(a);
    case OPERATION_MIX:
        return op_mix(a, b, 0.3f);
    case OPERATION_MIN:
        return op_min(a, b);
    case OPERATION_MAX:
        return op_max(a, b);
    case OPERATION_CLAMP:
        return op_saturate(a);
    case OPERATION_ABS:
        return op_abs(a);
    case OPERATION_FLOOR:
        return op_floor(a);
    case OPERATION_EXP2:
        return op_exp2(fused, a);
    case OPERATION_LOG2:
        return op_log2(fused, a);
    case OPERATION_POW:
        return op_pow(fused, a, b);
    default:
        return a; /* OPERATION_COPY */
    }
}

static bool less(float a, float b)
{
    return op_flush(a) < op_flush(b);
}

void experiment_operation(bool fused, Operation operation, const float a[4], const float b[4],
                          int x, int y, float out[4])
{
    switch (operation) {
    case OPERATION_DOT:
        out[0] = out[1] = out[2] = out[3] = op_dot3(a, b);
        return;
    case OPERATION_CROSS:
        cross_of(a, b, out);
        return;
    case OPERATION_MATRIX:
        matrix_of(a, b, out);
        return;
    case OPERATION_NORMALIZE:
        normalize_of(a, out);
        return;
    case OPERATION_SELECT:
        out[0] = out[1] = out[2] = out[3] = less(a[0], b[0]) ? 1.0f : b[0];
        return;
    case OPERATION_PIXEL:
        out[0] = (float)x + 0.5f;
        out[1] = (float)y + 0.5f;
        out[2] = out[3] = 0.0f;
        return;
    default:
        for (int i = 0; i < 4; i++)
            out[i] = channel(fused, operation, a[i], b[i]);
    }
}

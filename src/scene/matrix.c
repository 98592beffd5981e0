#include "scene/matrix.h"

#include <math.h>

/* π/2 in three parts: the first two have 33 significant bits, so that their products with a
 * quadrant number below 2^17 are exact. Source: W. J. Cody, W. Waite, "Software Manual for the
 * Elementary Functions", 1980, section 8; the split is the one of Sun's fdlibm. */
#define HALF_PI_1   0x1.921fb544p+0
#define HALF_PI_2   0x1.0b4611a6p-34
#define HALF_PI_3   0x1.3198a2e037073p-69
#define TWO_OVER_PI 0x1.45f306dc9c883p-1
#define ANGLE_LIMIT 1e5

Matrix matrix_identity(void)
{
    return matrix_scale(1.0, 1.0, 1.0);
}

Matrix matrix_multiply(const Matrix *a, const Matrix *b)
{
    Matrix product;
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++) {
            double sum = a->m[r] * b->m[4 * c];
            for (int k = 1; k < 4; k++)
                sum += a->m[4 * k + r] * b->m[4 * c + k];
            product.m[4 * c + r] = sum;
        }
    return product;
}

Matrix matrix_translate(double x, double y, double z)
{
    Matrix a = matrix_identity();
    a.m[12] = x;
    a.m[13] = y;
    a.m[14] = z;
    return a;
}

Matrix matrix_scale(double x, double y, double z)
{
    return (Matrix){{[0] = x, [5] = y, [10] = z, [15] = 1.0}};
}

Matrix matrix_rotate_y(double angle)
{
    double s = matrix_sin(angle), c = matrix_cos(angle);
    return (Matrix){{[0] = c, [2] = -s, [5] = 1.0, [8] = s, [10] = c, [15] = 1.0}};
}

/* The cofactors of the upper-left 3×3 in the places of the elements. */
static void cofactors3(const Matrix *a, double out[9])
{
    for (int c = 0; c < 3; c++) {
        const double *u = a->m + 4 * ((c + 1) % 3), *v = a->m + 4 * ((c + 2) % 3);
        for (int r = 0; r < 3; r++) {
            int s = (r + 1) % 3, t = (r + 2) % 3;
            out[3 * c + r] = u[s] * v[t] - u[t] * v[s];
        }
    }
}

static double determinant_from(const Matrix *a, const double cofactors[9])
{
    return (a->m[0] * cofactors[0] + a->m[1] * cofactors[1]) + a->m[2] * cofactors[2];
}

double matrix_determinant3(const Matrix *a)
{
    double cofactors[9];
    cofactors3(a, cofactors);
    return determinant_from(a, cofactors);
}

bool matrix_invert_affine(const Matrix *a, Matrix *out)
{
    double cofactors[9];
    cofactors3(a, cofactors);
    double determinant = determinant_from(a, cofactors);
    if (!isfinite(determinant) || determinant == 0.0)
        return false;
    Matrix inverse = {{[15] = 1.0}};
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++)
            inverse.m[4 * c + r] = cofactors[3 * r + c] / determinant;
    for (int r = 0; r < 3; r++)
        inverse.m[12 + r] = -((inverse.m[r] * a->m[12] + inverse.m[4 + r] * a->m[13]) +
                              inverse.m[8 + r] * a->m[14]);
    for (int i = 0; i < 16; i++)
        if (!isfinite(inverse.m[i]))
            return false;
    *out = inverse;
    return true;
}

void matrix_normal(const Matrix *a, double out[9])
{
    double cofactors[9];
    cofactors3(a, cofactors);
    double determinant = determinant_from(a, cofactors);
    for (int i = 0; i < 9; i++)
        out[i] = determinant == 0.0 ? cofactors[i] : cofactors[i] / determinant;
}

Matrix matrix_perspective(double yfov, double aspect, double near, double far)
{
    double focal = 1.0 / matrix_tan(yfov * 0.5);
    Matrix a = {{[0] = focal / aspect, [5] = focal, [10] = -1.0, [11] = -1.0, [14] = -2.0 * near}};
    if (isfinite(far)) {
        a.m[10] = (far + near) / (near - far);
        a.m[14] = 2.0 * far * near / (near - far);
    }
    return a;
}

Matrix matrix_perspective_zero_one(double yfov, double aspect, double near, double far)
{
    Matrix a = matrix_perspective(yfov, aspect, near, far);
    a.m[10] = isfinite(far) ? far / (near - far) : -1.0;
    a.m[14] = isfinite(far) ? far * near / (near - far) : -near;
    return a;
}

Matrix matrix_perspective_reversed(double yfov, double aspect, double near, double far)
{
    Matrix a = matrix_perspective(yfov, aspect, near, far);
    a.m[10] = isfinite(far) ? near / (far - near) : 0.0;
    a.m[14] = isfinite(far) ? far * near / (far - near) : near;
    return a;
}

static double dot(const double a[3], const double b[3])
{
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void normalize(double a[3])
{
    double length = sqrt(dot(a, a));
    for (int i = 0; i < 3; i++)
        a[i] /= length;
}

Matrix matrix_look_at(const double eye[3], const double target[3], const double up[3])
{
    double back[3] = {eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]};
    double right[3], above[3];
    normalize(back);
    cross(up, back, right);
    normalize(right);
    cross(back, right, above);
    Matrix a = {{[15] = 1.0}};
    const double *rows[3] = {right, above, back};
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            a.m[4 * c + r] = rows[r][c];
        a.m[12 + r] = -dot(rows[r], eye);
    }
    return a;
}

void matrix_round(const Matrix *a, float out[16])
{
    for (int i = 0; i < 16; i++)
        out[i] = (float)a->m[i];
}

void matrix_point(const Matrix *a, const double point[3], double out[3])
{
    double moved[3];
    for (int r = 0; r < 3; r++)
        moved[r] =
            ((a->m[r] * point[0] + a->m[4 + r] * point[1]) + a->m[8 + r] * point[2]) + a->m[12 + r];
    for (int r = 0; r < 3; r++)
        out[r] = moved[r];
}

/* An angle as quadrant·π/2 + (high + low), |high| ≤ π/4 and a little. */
typedef struct Reduced {
    int quadrant; /* modulo 4 */
    double high, low;
} Reduced;

static Reduced reduce(double angle)
{
    double turns = angle * TWO_OVER_PI;
    int count = (int)(turns < 0.0 ? turns - 0.5 : turns + 0.5);
    double k = (double)count;
    double a = angle - k * HALF_PI_1; /* exact, and so is the next product */
    double b = k * HALF_PI_2;
    double high = a - b;
    double part = high - a;
    double low = (a - (high - part)) - (b + part); /* high's rounding error */
    return (Reduced){count & 3, high, low - k * HALF_PI_3};
}

/* Taylor polynomials; what they leave out is below 1e-19 for |x| ≤ π/4. */
static double polynomial(const double *coefficients, int count, double x)
{
    double sum = coefficients[count - 1];
    for (int i = count - 2; i >= 0; i--)
        sum = sum * x + coefficients[i];
    return sum;
}

static double sine_near_zero(double x, double low)
{
    static const double terms[] = {-1.0 / 6.0,
                                   1.0 / 120.0,
                                   -1.0 / 5040.0,
                                   1.0 / 362880.0,
                                   -1.0 / 39916800.0,
                                   1.0 / 6227020800.0,
                                   -1.0 / 1307674368000.0,
                                   1.0 / 355687428096000.0,
                                   -1.0 / 121645100408832000.0};
    double x2 = x * x;
    double tail = (x * x2) * polynomial(terms, sizeof terms / sizeof terms[0], x2);
    return x + (tail + low * (1.0 - 0.5 * x2));
}

static double cosine_near_zero(double x, double low)
{
    static const double terms[] = {
        1.0 / 24.0,        -1.0 / 720.0,         1.0 / 40320.0,          -1.0 / 3628800.0,
        1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0, -1.0 / 6402373705728000.0};
    double x2 = x * x;
    double half = 0.5 * x2;
    double head = 1.0 - half;
    double error = (1.0 - head) - half; /* of the subtraction above */
    double tail = (x2 * x2) * polynomial(terms, sizeof terms / sizeof terms[0], x2);
    return head + (error + (tail - x * low));
}

/* Sine of the reduced angle, `shift` quadrants on. */
static double sine_of(double angle, int shift)
{
    if (!(angle >= -ANGLE_LIMIT && angle <= ANGLE_LIMIT))
        return NAN;
    Reduced reduced = reduce(angle);
    int quadrant = (reduced.quadrant + shift) & 3;
    double value = quadrant & 1 ? cosine_near_zero(reduced.high, reduced.low)
                                : sine_near_zero(reduced.high, reduced.low);
    return quadrant & 2 ? -value : value;
}

double matrix_sin(double angle)
{
    return sine_of(angle, 0);
}

double matrix_cos(double angle)
{
    return sine_of(angle, 1);
}

double matrix_tan(double angle)
{
    return matrix_sin(angle) / matrix_cos(angle);
}

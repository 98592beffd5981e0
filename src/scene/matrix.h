/* Matrices that feed a pipeline: double precision, + − × ÷ √ and our own trigonometry in a fixed
 * order, so that every machine hands the renderers the same floats.
 *
 * Column-major: element (row r, column c) is m[4·c + r]; vectors are columns. Angles in radians. */
#ifndef PEEL_SCENE_MATRIX_H
#define PEEL_SCENE_MATRIX_H

#include <stdbool.h>

typedef struct Matrix {
    double m[16];
} Matrix;

Matrix matrix_identity(void);
Matrix matrix_multiply(const Matrix *a, const Matrix *b); /* a·b */
Matrix matrix_translate(double x, double y, double z);
Matrix matrix_scale(double x, double y, double z);
Matrix matrix_rotate_y(double angle);

/* Inverse of an affine matrix (last row 0 0 0 1). False, and *out untouched, when it is singular
 * or not finite. */
bool matrix_invert_affine(const Matrix *a, Matrix *out);

/* Inverse transpose of the upper-left 3×3, column-major in out[9]: turns normals. A singular
 * matrix gives the cofactors themselves, which have the right direction wherever it exists. */
void matrix_normal(const Matrix *a, double out[9]);

double matrix_determinant3(const Matrix *a); /* of the upper-left 3×3 */

/* OpenGL perspective to depths −1…1. yfov in (0, π), aspect > 0, 0 < near < far. far may be
 * INFINITY. Source: glTF 2.0, 3.10.3.3 and 3.10.3.4. */
Matrix matrix_perspective(double yfov, double aspect, double near, double far);

/* The same to depths 0 near … 1 far, and to 1 near … 0 far. */
Matrix matrix_perspective_zero_one(double yfov, double aspect, double near, double far);
Matrix matrix_perspective_reversed(double yfov, double aspect, double near, double far);

/* View matrix: eye at `eye`, looking at `target`; up must not be parallel to the gaze. */
Matrix matrix_look_at(const double eye[3], const double target[3], const double up[3]);

void matrix_round(const Matrix *a, float out[16]); /* each element to float, once */
void matrix_point(const Matrix *a, const double point[3], double out[3]); /* affine */

/* Sine, cosine and tangent for |angle| ≤ 1e5; NaN beyond. Reduction by multiples of π/2 in three
 * parts, then Taylor polynomials. Maximum error measured against MPFR over 6 million angles, those
 * next to multiples of π/2 included: sin 0.816 ULP at −0x1.3382d1de88384p+16, cos 0.825 ULP at
 * 0x1.62490369cb686p+16, tan 2.17 ULP at 0x1.c9d3734ce27fdp+14. */
double matrix_sin(double angle);
double matrix_cos(double angle);
double matrix_tan(double angle);

#endif

/* Proven bounds of what exact.h computes in double, against the exact numbers: the mesh's floats
 * and the view's float matrices taken as they are, and no operation rounded (plane.h).
 *
 * Proof. Let u = 2^-53, hats mark computed numbers, and corner i be (Xᵢ, Yᵢ, Zᵢ, Wᵢ), known to
 * within εXᵢ, … (soup.h). To nearest, an operation errs by at most u · |its result|; sums, and
 * products of corners, lie on a grid of 2^-896 or coarser, so nothing underflows before the depth.
 *  1. Over the pixels of a rectangle, |dx̂ᵢ| is greatest at an end, mᵢ, since rounding keeps order;
 *     dx̂ᵢ = X̂ᵢ − (x + ½)Ŵᵢ errs by at most ηᵢ = εXᵢ + (x + ½)(εWᵢ + u|Ŵᵢ|) + u·mᵢ; dy likewise.
 *  2. Edge function êᵢ = dx̂ⱼdŷₖ − dx̂ₖdŷⱼ errs by at most Eᵢ: the errors of its factors with their
 *     product, and two roundings of each product. This is where edges cancel, and Eᵢ is then large
 *     against êᵢ, as it should be.
 *  3. D = Σ eᵢWᵢ, the corners' determinant, is the same at every pixel: computed at one of them,
 *     with the errors of its factors and four roundings per term, it is at least D₀ in size.
 *  4. For any number d, the plane's depth is Σ eᵢ(Zᵢ + Wᵢ) / 2D = d + R / 2D with
 *     R = Σ eᵢrᵢ, rᵢ = Zᵢ + Wᵢ − 2d·Wᵢ. Here d is the depth that exact.c came to, whatever its
 *     divisions did: it errs by |R| / 2D ≤ (|R̂| + the bound of R̂'s error) / 2D₀. R̂ errs by the
 *     errors of its factors, and six roundings per term. Products in it that underflow change it by
 *     less than 2^-1070 each, so with D₀ ≥ 2^-900 the depth by less than 2^-100, which is added.
 *  5. Clamping to [0, 1] brings no two numbers farther apart.
 * The bounds' own arithmetic only adds, multiplies and divides non-negative numbers, but for
 * |D̂| − error; EXACT_SLACK covers it. Overflow gives infinity or NaN, which bound nothing and are
 * never taken for certain. The thread must not flush denormals. */
#ifndef PEEL_REF_TRUTH_BOUND_H
#define PEEL_REF_TRUTH_BOUND_H

#include "ref/truth/soup.h"

typedef enum Verdict {
    VERDICT_NO,
    VERDICT_YES,
    VERDICT_UNSURE /* doubles cannot tell */
} Verdict;

/* For one triangle, over a rectangle of pixels. */
typedef struct Bound {
    double edge[3];    /* the edge functions' error */
    double q[3], w[3]; /* corners' z + w, and w */
    double q_error[3]; /* of rᵢ: this, and |d| times the next */
    double d_error[3];
    double determinant;    /* |D| is at least this; −1 if it may be 0, or out of range */
    bool clockwise;        /* D is negative */
    double snapping_error; /* of corners' window coordinates, in pixels; infinite behind the eye */
} Bound;

/* The rectangle's ends, inclusive, in pixels with y up; not empty, within the viewport. */
typedef struct BoundRect {
    int x_low, x_high, y_low, y_high;
} BoundRect;

void bound_setup(const SoupVertex *const vertices[3], BoundRect rect, Bound *out);

/* point: by exact_at, at a pixel of the rectangle. */

/* Whether the plane has a depth there: the triangle has an area as seen from the eye, and the point
 * lies in front of the eye. */
Verdict bound_has_depth(const Bound *bound, const ExactPoint *point);
/* Whether the pixel's centre is in the triangle and in the view volume: ExactPoint.inside, were it
 * exact. */
Verdict bound_inside(const Bound *bound, const ExactPoint *point);
/* How much point->plane errs at most; infinite or NaN where nothing is known. Means something where
 * the plane has a depth. */
double bound_depth(const Bound *bound, const ExactPoint *point);

#endif

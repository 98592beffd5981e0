/* What single precision may make of a triangle's attributes at a pixel: how far the pipeline's
 * interpolated values may be from those of the exact triangle.
 *
 * Analysed is the pipeline's order of operations: vertex transform, clipping (no guard band;
 * Sutherland–Hodgman, plane by plane), viewport, plane setup on unsnapped window positions,
 * attribute/w times w (ref/pipeline/NUMBERS.md states each step). Nothing of it is run here:
 * vertices are transformed and clipped in double, and every rounding is bounded.
 *
 * The bound does not grow with what moves a vertex along its triangle: a plane through points of
 * the exact plane is the exact plane, wherever they lie in it. So of each corner of a piece only
 * the distance of its stored values from the exact plane counts (dev), and for the conditioning of
 * the setup also how far it may have moved within (spread).
 * Source: Higham, "Accuracy and Stability of Numerical Algorithms", 2nd edition, 2002. */
#ifndef PEEL_REF_TRUTH_SINGLE_H
#define PEEL_REF_TRUTH_SINGLE_H

#include "frame/view.h"
#include "ref/truth/bounded.h"

#include <stdbool.h>

/* Components of a vertex: clip coordinates, then the smooth varyings. */
enum {
    SINGLE_CLIP = 0,
    SINGLE_POSITION = 4,
    SINGLE_NORMAL = 7,
    SINGLE_UV = 10,
    SINGLE_COMPONENTS = 12,
    SINGLE_CORNERS_MAX = 9,
    SINGLE_DECISIONS_MAX = 8,
    SINGLE_KEPT = 2
};

typedef struct SingleVertex {
    double value[SINGLE_COMPONENTS];
    /* Distance of the pipeline's value from a point of the exact triangle, … */
    double dev[SINGLE_COMPONENTS];
    /* … and of that point from value. */
    double spread[SINGLE_COMPONENTS];
    bool cut; /* made by the clipper */
} SingleVertex;

typedef struct SinglePolygon {
    int count;  /* 0: nothing is left */
    bool whole; /* it was not clipped: the corners are in the triangle's order, not a fan */
    SingleVertex corner[SINGLE_CORNERS_MAX];
} SinglePolygon;

/* Magnitudes and errors of what setup has of a corner; dev as in SingleVertex. */
typedef struct SingleCorner {
    const SingleVertex *vertex;
    double x, y;         /* window */
    double dev_x, dev_y; /* of the stored window position from the exact point's */
    double all_x, all_y; /* the same from (x, y): spread is in it */
    double z, dev_z, all_z;
    double g, dev_g, all_g, g_most; /* 1/w */
} SingleCorner;

typedef struct SingleViewport {
    double scale[3], translate[3];
    bool half_depth; /* the view volume is 0 ≤ z ≤ w */
    bool fused;
} SingleViewport;

SingleViewport single_viewport(const View *view, bool fused);

/* A mesh's vertex; uv may be NULL. */
void single_vertex(const View *view, const Draw *draw, const float position[3],
                   const float normal[3], const float *uv, SingleVertex *out);

/* Clips a triangle. Where rounding may decide on which side of a plane a corner lies, bit i of
 * choices is the i-th such decision (set: inside); returns how many there were, more than
 * SINGLE_DECISIONS_MAX where that is not known. */
int single_clip(const SingleViewport *viewport, const SingleVertex triangle[3], unsigned choices,
                SinglePolygon *out);

/* One of the polygons that clipping may leave, and its corners in the window. */
typedef struct SingleFan {
    int decisions; /* that rounding may take, of single_clip */
    bool known;    /* the corners are */
    SinglePolygon polygon;
    SingleCorner corner[SINGLE_CORNERS_MAX]; /* points into polygon */
} SingleFan;

/* What no pixel changes: a triangle's exact corners, and the first of the polygons that clipping
 * may leave. Not to be copied. */
typedef struct SingleTriangle {
    SingleViewport viewport;
    SingleVertex vertex[3];
    int kept;
    SingleFan fan[SINGLE_KEPT];
} SingleTriangle;

/* triangle: viewport and vertices are set; sets the rest. */
void single_clipped(SingleTriangle *triangle);

/* The exact triangle around a pixel's centre, for gradients: homogeneous window coordinates less
 * the centre's. */
typedef struct SinglePixel {
    int x, y; /* y up */
    Bounded cofactor_x[3], cofactor_y[3], determinant;
    double inverse_w_x, inverse_w_y; /* |gradient| of 1/w in pixels, at most */
    Bounded inverse_w;               /* at the centre */
} SinglePixel;

/* Whether the pipeline's pieces of the triangle may cover the pixel's centre, and whether they
 * must, whichever way each corner is rounded and snapped. */
typedef struct SingleCover {
    bool possible, certain;
} SingleCover;

SingleCover single_cover(const SingleTriangle *triangle, const SinglePixel *pixel);

/* Whether two of the pipeline's pieces of the triangle may cover the pixel's centre: rounding may
 * fold what clipping leaves. */
bool single_may_overlap(const SingleTriangle *triangle, const SinglePixel *pixel);

/* attribute: value and exact at the pixel, SINGLE_POSITION … used − 1; fills their single with the
 * greatest over all pieces that may cover the pixel, ∞ where there is none. depth: the same of the
 * window depth, or NULL. *facing_certain: no piece is so thin that its facing depends on rounding.
 */
void single_errors(const SingleTriangle *triangle, const SinglePixel *pixel, int used,
                   Bounded attribute[SINGLE_COMPONENTS], Bounded *depth, bool *facing_certain);

#endif

/* The order of the fragments of a pixel, certain: by exact depth (plane.h), compared in double
 * where the proven bounds of both depths (bound.h) do not meet, else in integers of any size.
 *
 * Equal means equal by proof. Such fragments go by primitive id: with DEPTH_LESS the earlier
 * triangle is in front, with DEPTH_LEQUAL the later. A reversed depth range does not change the
 * order: depths are window depths from 0 near to 1 far, clamped. */
#ifndef PEEL_REF_TRUTH_ORDER_H
#define PEEL_REF_TRUTH_ORDER_H

#include "ref/truth/bound.h"
#include "ref/truth/plane.h"

#define FRAGMENT_NO_TRIANGLE UINT32_MAX

typedef struct Fragment {
    double depth;      /* window depth in [0, 1] */
    float error;       /* the exact depth is no farther from it than this; 0: it is the depth */
    uint32_t triangle; /* in the soup's numbering; FRAGMENT_NO_TRIANGLE: no fragment, depth 1 */
    uint16_t pixel;    /* in the tile: row · TRACE_TILE + column, row 0 at the top */
    bool back;         /* a back face, after mirroring */
    bool unsure;       /* snapped and unsnapped coverage disagree here */
    bool is_fixed;     /* the plane has no depth here: depth is exact by definition */
} Fragment;

enum {
    ORDER_CACHE = 128 /* planes; a power of two */
};

typedef struct OrderPlane {
    bool allocated, known;
    uint32_t triangle;
    Plane plane;
} OrderPlane;

typedef struct OrderCounts {
    uint64_t comparisons;       /* of two depths */
    uint64_t exact_comparisons; /* of those, in integers */
    uint64_t undecided;         /* of those, without a result: 0 (not even infinite corners) */
    uint64_t exact_coverage;    /* whether a plane has a depth, or covers a pixel: in integers */
} OrderCounts;

/* One worker's scratch, reused. Zeroed is valid, but for soup. */
typedef struct Order {
    const Soup *soup;
    int x, y;          /* the tile of the fragments: its top left pixel in the image */
    bool always_exact; /* for tests: never by double */
    OrderCounts counts;
    bool allocated;
    PlaneWork work;
    mpz_t numerator[2], denominator[2], product[2];
    OrderPlane planes[ORDER_CACHE];
} Order;

/* Negative, 0 or positive: a is nearer than, as near as, farther than b. Both are of one pixel. */
int order_compare(Order *order, const Fragment *a, const Fragment *b);
/* Negative or positive: equal depths by id. */
int order_compare_all(Order *order, const Fragment *a, const Fragment *b, DepthFunc func);

/* Gives fragment its depth, error and is_fixed; its triangle and pixel are set, point is exact_at's
 * there. */
void order_set_depth(Order *order, const Bound *bound, const Corner *const corners[3],
                     const ExactPoint *point, Fragment *fragment);

/* ExactPoint.inside, exactly; then *clockwise is exact too. (x, y): y up. */
bool order_inside(Order *order, const Bound *bound, const ExactPoint *point, uint32_t triangle,
                  int x, int y, bool *clockwise);

void order_free(Order *order); /* the numbers, not the struct */

#endif

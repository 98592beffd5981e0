/* Which pixels a triangle covers by the GL contract: clipped, vertices snapped to 1/256 pixel,
 * integer edge functions, each pixel of a shared edge once.
 *
 * One triangle, one sample at the pixel's centre. It does not interpolate anything (exact.h does),
 * and knows nothing of culling. */
#ifndef PEEL_REF_TRUTH_COVERAGE_H
#define PEEL_REF_TRUTH_COVERAGE_H

#include "ref/truth/exact.h"

#include <stdbool.h>
#include <stdint.h>

/* A triangle cut by six planes has at most nine corners. */
enum {
    COVERAGE_CORNERS_MAX = 9,
    COVERAGE_PIECES_MAX = COVERAGE_CORNERS_MAX - 2
};

/* A corner's window coordinates in 1/256 pixel, 0 at the first pixel's centre, rounded to nearest,
 * ties to even. */
typedef struct Snap {
    int32_t x, y;
    bool known; /* else coverage_setup rounds the corner's doubles */
} Snap;

/* A triangle of snapped vertices: edge i is a[i]·x + b[i]·y + c[i] at pixel (x, y), positive
 * inside. */
typedef struct CoveragePiece {
    int64_t a[3], b[3], c[3];
    bool clockwise; /* in window space with y up */
    bool empty;     /* no area after snapping: covers nothing */
} CoveragePiece;

typedef struct Coverage {
    CoveragePiece pieces[COVERAGE_PIECES_MAX];
    int piece_count;
    bool whole;    /* nothing was cut off: piece 0 is the snapped triangle */
    int64_t slack; /* whole only: snapping moves no edge function by more than this */
    /* Pixels, inclusive, inside the viewport, that the triangle may cover, snapped or not. */
    int x_low, x_high, y_low, y_high;
} Coverage;

/* How a pixel lies to the snapped triangle, and whether the unsnapped one may differ there. */
typedef enum CoverageAt {
    COVERAGE_OUTSIDE,       /* neither covers it */
    COVERAGE_OUTSIDE_CLOSE, /* not covered; the exact triangle may cover it */
    COVERAGE_INSIDE_CLOSE,  /* covered; the exact triangle may not cover it */
    COVERAGE_INSIDE         /* both cover it */
} CoverageAt;

/* Clips, snaps and sets up a triangle for a viewport of width × height pixels (each at most
 * 16384). snaps: of the three corners; for those that clipping leaves. Where an edge crosses the
 * view volume's border the new corner is computed and snapped in double: there GL's contract fixes
 * no rounding. False when it covers nothing, snapped or not, or has a non-finite corner. */
bool coverage_setup_snapped(const Corner *const corners[3], const Snap snaps[3], int width,
                            int height, Coverage *out);
/* The same without snaps. */
bool coverage_setup(const Corner *const corners[3], int width, int height, Coverage *out);

/* (x, y): a pixel within the bounds of coverage, y up. *clockwise: of the piece that covers it;
 * untouched outside. */
CoverageAt coverage_at(const Coverage *coverage, int x, int y, bool *clockwise);

/* Whether all pixels of a rectangle (inclusive, y up) are COVERAGE_OUTSIDE; false where that is
 * not cheap to see. */
bool coverage_misses(const Coverage *coverage, int x_low, int y_low, int x_high, int y_high);

#endif

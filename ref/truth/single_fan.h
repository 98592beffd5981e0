/* The pieces that the pipeline's clipping makes of a triangle, in the window, with their errors:
 * which of them may cover a pixel. What single_cover and single_errors share. */
#ifndef PEEL_REF_TRUTH_SINGLE_FAN_H
#define PEEL_REF_TRUTH_SINGLE_FAN_H

#include "ref/truth/single.h"

/* How far a corner may be snapped, and more. */
#define SINGLE_SNAP 0x1p-8

/* The edge function opposite corner i at the origin, and its error when each coordinate is off by
 * its own and by `moved`. */
double single_edge(const SingleCorner c[3], int i, double moved, double *error);

/* The doubled area; its error as above. */
double single_area(const SingleCorner c[3], double moved, double *error);

/* Whether the piece's snapped corners may cover the origin. */
bool single_may_cover(const SingleCorner c[3]);

/* All polygons that clipping may leave, one after the other. */
typedef struct FanWalk {
    unsigned choices;
    int count, decisions;
    SingleFan made; /* one that is not kept */
} FanWalk;

void single_begin_walk(FanWalk *walk);

/* NULL: that were all. After one with too many decisions there is none. */
const SingleFan *single_next_fan(const SingleTriangle *triangle, FanWalk *walk);

/* A polygon's corners around the pixel's centre. */
void single_set_corners(const SingleFan *fan, const SinglePixel *pixel,
                        SingleCorner corners[SINGLE_CORNERS_MAX]);

/* Number i, from 2, of a polygon's fan. */
void single_piece(const SinglePolygon *polygon, const SingleCorner *corners, int i,
                  SingleCorner out[3]);

#endif

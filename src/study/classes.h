/* Why a pixel differs from truth. */
#ifndef PEEL_STUDY_CLASSES_H
#define PEEL_STUDY_CLASSES_H

#include "compare/structure.h"
#include "frame/frame.h"

#include <stdbool.h>

/* Why a pixel is not truth's: what fragments ref has there, or else the greatest share. */
typedef enum PixelClass {
    CLASS_EQUAL,
    CLASS_OPAQUE_FLIP, /* another opaque triangle */
    CLASS_COVERAGE, /* a fragment that only one of them has, because of snapped vertices' rounding
                     */
    CLASS_LOST_TIE,
    CLASS_LOST_LIMIT,
    CLASS_LOST_BIAS,
    CLASS_LOST_OVERFLOW, /* of a list */
    CLASS_REPEATED,
    CLASS_INVERSION,
    CLASS_METHOD, /* it approximates */
    CLASS_DEPTH,
    CLASS_GBUFFER,
    CLASS_ACCUM, /* clamping included */
    CLASS_ROUNDING,
    CLASS_UNEXPLAINED,
    CLASS_COUNT
} PixelClass;

/* By the fragments of a pixel: `actual` is of desc; `best` of peel-id in the best formats, which
 * tells what single precision can have, and `stored` the same in desc's format of depth, what that
 * can have, with its depths. CLASS_EQUAL where truth has the same in the same order. Drops
 * repetitions from actual. */
PixelClass class_of_fragments(const RenderDesc *desc, StructurePixel *actual,
                              const StructurePixel *truth, const StructurePixel *best,
                              const StructurePixel *stored);

const char *class_key(PixelClass class);  /* "equal", …; static */
const char *class_text(PixelClass class); /* one line; static */

#endif

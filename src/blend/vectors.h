/* Test vectors of blending: sources and destinations, the same on every machine.
 *
 * A set is a function from its specification and an index to a vector, so any part can be made
 * alone and nothing needs to be kept. VECTORS_VERSION changes when any vector does. */
#ifndef PEEL_BLEND_VECTORS_H
#define PEEL_BLEND_VECTORS_H

#include "base/result.h"
#include "blend/equation.h"
#include "number/format.h"

#include <stddef.h>
#include <stdint.h>

enum {
    VECTORS_VERSION = 1
};

typedef enum VectorSet {
    VECTORS_EXHAUSTIVE = 0, /* rgba8: 2^24 vectors (source, destination alpha, destination); all
                             * channels of each are such triples */
    VECTORS_DIRECTED,       /* every pair and triple of the format's special values: zeros of both
                             * signs, denormals, halfway cases, overflow, NaN, infinity, alpha
                             * below 1 */
    VECTORS_RANDOM,
    VECTORS_SET_COUNT
} VectorSet;

typedef struct VectorSpec {
    VectorSet set;
    PixelFormat format;
    uint64_t seed;  /* of VECTORS_RANDOM */
    uint64_t count; /* of VECTORS_RANDOM; the others know theirs */
} VectorSpec;

const char *vectors_set_name(VectorSet set); /* "exhaustive"; static */

/* BAD_INPUT with a message where there is no such set of the format. */
Result vectors_check(const VectorSpec *spec);

uint64_t vectors_count(const VectorSpec *spec);

/* Vectors first … first + count − 1, which exist. source: count vec4. Sources of unorm formats are
 * codes / greatest code, rounded to nearest, which every right conversion stores as that code;
 * VECTORS_DIRECTED also has sources between codes. destination: count pixels of the format. */
void vectors_make(const VectorSpec *spec, uint64_t first, size_t count, float (*source)[4],
                  void *destination);

#endif

/* Test vectors of blending: sources and destinations, the same on every machine.
 *
 * A set is a function from its specification and an index to a vector, so any part can be made
 * alone and nothing needs to be kept. VECTORS_VERSION changes when any vector does.
 *
 * Exhaustive sets are all triples of a list of codes: vector i has
 *   source code list[i / n²], destination alpha list[i / n % n], destination list[i % n]
 * in red; in green source and destination change places, in blue both are read from the list's
 * other end; source alpha is list[(the three places' sum) % n]. So in every colour channel each
 * triple of source, destination and either alpha occurs once, and each pair of alphas n times.
 * rgba8: n = 256 and list[k] = k. rgba16: n = 256, of codes where arithmetic goes wrong. */
#ifndef PEEL_BLEND_VECTORS_H
#define PEEL_BLEND_VECTORS_H

#include "base/result.h"
#include "number/format.h"

#include <stddef.h>
#include <stdint.h>

enum {
    VECTORS_VERSION = 1
};

/* Seeds and indices: what a double, as of JSON, holds. */
#define VECTORS_NUMBER_MAX (((int64_t)1 << 53) - 1)

typedef enum VectorSet {
    VECTORS_EXHAUSTIVE = 0, /* of unorm formats: 2^24 vectors */
    VECTORS_DIRECTED,       /* all triples of the format's special values (zeros of both signs,
                             * denormals, overflow, NaN, infinity, alpha below 1), and constructed
                             * ones: halfway cases of every operation, cancellation, boundaries */
    VECTORS_RANDOM,
    VECTORS_SEQUENCES, /* blend/sequence.h: has other functions */
    VECTORS_SET_COUNT
} VectorSet;

typedef struct VectorSpec {
    VectorSet set;
    PixelFormat format;
    uint64_t seed;  /* of VECTORS_RANDOM and VECTORS_SEQUENCES */
    uint64_t count; /* of these two; the others know theirs */
} VectorSpec;

const char *vectors_set_name(VectorSet set); /* "exhaustive"; static */

/* BAD_INPUT with a message where there is no such set of the format, or a number is too great. */
Result vectors_check(const VectorSpec *spec);

uint64_t vectors_count(const VectorSpec *spec);

/* Vectors first … first + count − 1, which exist. source: count vec4. Sources of unorm formats are
 * codes / greatest code, rounded to nearest, which every right conversion stores as that code;
 * VECTORS_DIRECTED also has sources between codes. destination: count pixels of the format.
 * Callers are not in flushing mode. */
void vectors_make(const VectorSpec *spec, uint64_t first, size_t count, float (*source)[4],
                  void *destination);

#endif

/* Single vectors, before they are packed: what vectors.c puts together. */
#ifndef PEEL_BLEND_VECTOR_VALUES_H
#define PEEL_BLEND_VECTOR_VALUES_H

#include "base/random.h"
#include "number/format.h"

#include <stdint.h>

typedef struct Vector {
    float source[4];
    uint32_t destination[4]; /* bits of the format; those without a channel are dropped */
} Vector;

enum {
    VECTOR_CODES = 256, /* of an exhaustive set's list */
    VECTOR_SPECIALS = 64
};

/* Code k, in [0, VECTOR_CODES), of the list of an exhaustive set. */
uint32_t vector_values_code(PixelFormat format, uint32_t k);

/* Code / greatest code, rounded to nearest. */
float vector_values_unorm(PixelFormat format, uint32_t code);

/* Special value k, in [0, VECTOR_SPECIALS): as a source, and as bits of a destination. */
float vector_values_special_source(PixelFormat format, uint32_t k);
uint32_t vector_values_special_bits(PixelFormat format, uint32_t k);

/* The bits of a float or half format nearest below or at x in magnitude; of an unorm format the
 * code nearest to x·(greatest code). */
uint32_t vector_values_bits(PixelFormat format, float x);

/* Random vectors; random: of this one vector. */
void vector_values_random(PixelFormat format, Random *random, Vector *out);

/* Constructed vectors of the directed set: how many, and which is number i. */
uint64_t vector_values_constructed(PixelFormat format);
void vector_values_construct(PixelFormat format, uint64_t i, Vector *out);

#endif

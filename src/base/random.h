/* A small seeded generator: the same numbers on every machine. Not for secrets. */
#ifndef PEEL_BASE_RANDOM_H
#define PEEL_BASE_RANDOM_H

#include <stdint.h>

typedef struct Random {
    uint64_t state;
} Random;

static inline Random random_seed(uint64_t seed)
{
    return (Random){seed};
}

/* SplitMix64. Source: Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators",
 * OOPSLA 2014, figure 10. Full period 2^64; any seed is good, 0 included. */
static inline uint64_t random_bits(Random *random)
{
    uint64_t z = (random->state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Uniform in [0, 1): a multiple of 2^-53. */
static inline double random_unit(Random *random)
{
    return (double)(random_bits(random) >> 11) * 0x1p-53;
}

static inline double random_range(Random *random, double low, double high)
{
    return low + (high - low) * random_unit(random);
}

#endif

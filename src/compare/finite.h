/* A sink that hands every buffer on and counts the stored values that are NaN or infinite. */
#ifndef PEEL_COMPARE_FINITE_H
#define PEEL_COMPARE_FINITE_H

#include "frame/trace.h"

#include <stdint.h>

typedef struct Finite {
    TraceSink sink;     /* hand &finite->sink to a renderer */
    TraceSink *next;    /* may be NULL; must outlive it */
    uint64_t nonfinite; /* values of floats and halves */
} Finite;

Finite finite_before(TraceSink *next);

#endif

/* Arithmetics that a report cannot tell from the one that it found. */
#ifndef PEEL_STUDY_BLEND_TWINS_H
#define PEEL_STUDY_BLEND_TWINS_H

#include "study/blend_check.h"

typedef struct BlendTwin {
    size_t candidate;     /* a named one that gives all the values, too */
    bool apart;           /* whether any vector of the sets would tell it from the best */
    BlendExample example; /* the simplest such; expected: the best's */
} BlendTwin;

/* The twins of candidate `best`, which gives all values. out: the caller frees; NULL where there
 * are none. */
Result blend_twins(const BlendReport *report, size_t best, BlendTwin **out, size_t *count);

#endif

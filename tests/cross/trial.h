/* What one scene goes through in the campaign: three checks, each of which ends in a count of what
 * should not be. Link trial.c, bits.c and truths.c. */
#ifndef PEEL_TESTS_TRIAL_H
#define PEEL_TESTS_TRIAL_H

#include "study/classes.h"

typedef enum TrialId {
    TRIAL_GL,    /* ref (its definition, traced) against gl, every buffer bit for bit */
    TRIAL_PATHS, /* ref's tile path against its definition: images and counts */
    TRIAL_TRUTH, /* ref against truth: see trial.c */
    TRIAL_COUNT
} TrialId;

typedef struct TrialFigures {
    uint64_t pixels, values, fragments; /* compared with gl; transparent fragments of ref */
    uint64_t classes[CLASS_COUNT];      /* pixels, against truth */
    uint64_t bounded, unbounded; /* pixels with the same fragments, and those without bound */
    double max_ratio;            /* of error over bound */
    uint64_t differences;        /* values; 1 for a frame; pixels unexplained: 0 if all is well */
    char text[512];              /* the first of them, or "" */
} TrialFigures;

const char *trial_name(TrialId trial); /* "ref and gl", …; static */

/* *out: the figures of this check alone. Fails as the renderers do. */
Result trial_run(TrialId trial, const Scene *scene, const RenderDesc *desc, TrialFigures *out);

/* desc as a command shows it: for TRIAL_TRUTH another method where desc's has no bound. */
RenderDesc trial_desc(TrialId trial, const RenderDesc *desc);

#endif

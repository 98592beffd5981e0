/* The steps of a check. Private to study/check. */
#ifndef PEEL_STUDY_CHECK_STEPS_H
#define PEEL_STUDY_CHECK_STEPS_H

#include "compare/store.h"
#include "image/exr.h"
#include "study/check.h"

/* What a CheckFile holds: one of the two. */
typedef struct CheckLoaded {
    GivenImage image;
    Image depth; /* in its own format; the first channel counts */
    bool half;   /* the depths were stored as halves */
} CheckLoaded;

typedef struct CheckRun {
    RenderDesc desc;
    const float *background; /* the scene's */
    const CheckDesc *check;
    CheckReport *report;
    CheckSizes *sizes;
    GivenImage image;
    TraceStore *theirs, *reference; /* reference NULL: no buffers are compared */
    CheckLoaded *files;             /* one for each of check->files */
    Frame truth;                    /* with bounds, where desc asks for them */
} CheckRun;

/* Fills the report's steps from what is loaded and rendered. */
Result check_steps(CheckRun *run);

#endif

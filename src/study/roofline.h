/* The roofline of the machine, measured, and how near the lighting loop comes to it. */
#ifndef PEEL_STUDY_ROOFLINE_H
#define PEEL_STUDY_ROOFLINE_H

#include "frame/roofline.h"

/* Per second of a thread's own processor time, the best of several stretches: of one thread alone,
 * and the sum over all threads that ran at once. 0 where it does not apply. */
typedef struct RooflineRate {
    double one, all;
} RooflineRate;

typedef struct RooflineWidth {
    SimdChoice simd;
    int lanes;
    RooflineRate muladd, fma, divide, root; /* operations; a fused multiply-add is two */
    RooflineRate light;                     /* fragments times lights */
} RooflineWidth;

typedef struct RooflineReport {
    int threads;
    RooflineWidth widths[SIMD_COUNT]; /* narrowest first */
    size_t count;
    RooflineRate read, write, copy; /* bytes, beyond caches; copy: read and written */
} RooflineReport;

/* What one thread reaches, and what bounds it, in nanoseconds per fragment and light. */
typedef struct RooflineLoop {
    double ns;
    double flops;      /* per second, ROOFLINE_OPERATIONS each */
    double share;      /* of the peak of separate products and sums */
    double arithmetic; /* least ns for the sums, products, minima and maxima */
    double divider;    /* least ns for the divisions and roots */
} RooflineLoop;

RooflineLoop roofline_loop(const RooflineWidth *width);

/* threads: 0 for one per processor. stretch_ms: how long each measurement takes, at least; several
 * are made of each. */
Result roofline_run(RooflineTable table, int threads, double stretch_ms, RooflineReport *out);

#endif

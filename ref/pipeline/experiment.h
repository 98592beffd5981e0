/* What the rules give for an experiment, by the pipeline's own arithmetic. */
#ifndef PEEL_REF_EXPERIMENT_H
#define PEEL_REF_EXPERIMENT_H

#include "frame/experiment.h"

typedef struct PipelineLab {
    Lab lab;
    bool fused; /* see op_muladd */
} PipelineLab;

/* Owns nothing. EXPERIMENT_SAMPLES counts covered pixels; layouts give the same depth. */
PipelineLab pipeline_lab(bool fused);

/* ---- parts, in flushing mode ---- */

/* One texel of EXPERIMENT_OPERATION. */
void experiment_operation(bool fused, Operation operation, const float a[4], const float b[4],
                          int x, int y, float out[4]);
/* EXPERIMENT_RASTER, EXPERIMENT_OVERLAP and EXPERIMENT_SAMPLES. */
void experiment_raster(bool fused, const Experiment *experiment, uint32_t *out);

#endif

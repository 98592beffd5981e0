/* What a frame needs, and the cheapest settings that reach an error. */
#ifndef PEEL_STUDY_PLAN_H
#define PEEL_STUDY_PLAN_H

#include "frame/frame.h"
#include "frame/layers.h"
#include "study/plan_buffers.h"

typedef struct Plan {
    const char *scene_name, *scene_path; /* borrowed */
    RenderDesc desc;
    LayerCounts layers;
    Needs needs;
    int passes[METHOD_COUNT]; /* geometry passes over the transparent list for all layers */
    PlanBuffers buffers;      /* of gl */
    uint64_t bytes_of_all;    /* of these, if nothing was left out */
    Frame frame;              /* ref's, without its images */
} Plan;

/* Counts layers, and renders once with ref to know its memory. out is empty on failure; the caller
 * frees with plan_free. */
Result plan_run(const Scene *scene, const char *path, const RenderDesc *desc, LayerCounter counter,
                Renderer ref, Plan *out);
void plan_free(Plan *plan); /* leaves an empty one */

/* ---- the cheapest settings ---- */

typedef enum PlanMetric {
    PLAN_MAX = 0, /* greatest absolute difference of a channel from truth, over all pixels */
    PLAN_RMSE,
    PLAN_P99, /* 99th percentile of the pixels' greatest differences */
    PLAN_METRICS
} PlanMetric;

const char *plan_metric_name(PlanMetric metric); /* "max", "rmse", "p99"; static */

enum {
    PLAN_ACCUMS = 4,
    PLAN_GBUFFERS = 3
};

/* What may be chosen: all that is true. */
typedef struct PlanSpace {
    bool methods[METHOD_COUNT];
    bool accums[PLAN_ACCUMS]; /* RGBA32F, RGBA16F, RGBA16, RGBA8 */
    bool gbuffers[PLAN_GBUFFERS];
    int passes; /* the only number of passes, 0 for auto; negative: any */
} PlanSpace;

typedef struct PlanChoice {
    MethodId method;
    int passes; /* 0: auto */
    PixelFormat accum;
    GBufferFormat gbuffer;
    int runs;               /* that the times are medians of */
    double cpu_ms, wall_ms; /* of ref */
    double error;           /* by the metric; infinite where a pixel is not finite */
    bool pareto, chosen;    /* nothing measured is both faster and better; the answer */
} PlanChoice;

typedef struct PlanSearch {
    PlanMetric metric;
    double max_error;
    PlanChoice *choices;
    size_t count;
    int chosen; /* index; −1: nothing reaches max_error */
    int best;   /* of the least error */
} PlanSearch;

typedef struct PlanRequest {
    PlanSpace space;
    PlanMetric metric;
    double max_error;
} PlanRequest;

/* Measures on this scene: of each method its best settings first, and if these reach max_error,
 * other formats and fewer passes. What cannot be the answer is measured once, what can and what is
 * on the front three times. plan: of the same scene. What does not fit into memory is no choice.
 * *out is empty on failure; the caller frees with plan_search_free. */
Result plan_search(const Scene *scene, const Plan *plan, const PlanRequest *request, Renderer ref,
                   Renderer truth, PlanSearch *out);
void plan_search_free(PlanSearch *search);

/* The desc of a choice. */
RenderDesc plan_choice_desc(const RenderDesc *desc, const PlanChoice *choice);

#endif

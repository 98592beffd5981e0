/* Speed against error: renderers in turn over scenes, sizes, lights, threads, methods, formats and
 * passes.
 *
 * What is measured is a frame in the steady state: uploads, shader compilation and one frame come
 * before; then every renderer draws a frame, runs times over, and the median counts. Each row's
 * image is held against truth's. Nothing here knows how a renderer works. */
#ifndef PEEL_STUDY_BENCH_H
#define PEEL_STUDY_BENCH_H

#include "frame/frame.h"

enum {
    BENCH_AXIS_MAX = 32, /* values of one axis */
    BENCH_RUNS_MAX = 100
};

typedef enum BenchRendererId {
    BENCH_REF,
    BENCH_GL,
    BENCH_GL_EARLY,
    BENCH_TRUTH,
    BENCH_RENDERERS
} BenchRendererId;

const char *bench_renderer_name(int renderer); /* "ref", "gl", "gl-early", "truth"; static */

/* How a renderer draws frames of one scene. A frame's time_ms and cpu_ms are its times. */
typedef struct BenchRenderer {
    /* scene and desc outlive the state. On failure *state is NULL. */
    Result (*open)(const Scene *scene, const RenderDesc *desc, void **state);
    Result (*frame)(void *state, bool images, Frame *out); /* out->final, display on request */
    void (*close)(void *state);                            /* NULL is fine */
} BenchRenderer;

/* Words with + between, each of default, seed, compact, or a depth or accumulation format. */
typedef struct BenchFormat {
    char name[48];
    bool seed;                 /* the profile, first */
    int gbuffer, depth, accum; /* the enums' values (gbuffer: compact); −1: as it is */
} BenchFormat;

bool bench_format_parse(const char *text, BenchFormat *out);
void bench_format_apply(const BenchFormat *format, RenderDesc *desc);

typedef struct BenchScene {
    const Scene *scene;
    RenderDesc desc; /* camera and all that is no axis */
} BenchScene;

typedef struct BenchSize {
    int width, height;
} BenchSize;

/* Every combination is measured. An axis has at least one value. */
typedef struct BenchPlan {
    BenchScene scenes[BENCH_AXIS_MAX];
    BenchSize sizes[BENCH_AXIS_MAX];
    int lights[BENCH_AXIS_MAX]; /* as RenderDesc: 0 all, negative none */
    int threads[BENCH_AXIS_MAX];
    MethodId methods[BENCH_AXIS_MAX];
    BenchFormat formats[BENCH_AXIS_MAX];
    int passes[BENCH_AXIS_MAX]; /* 0: until a peel is empty */
    int scene_count, size_count, light_count, thread_count, method_count, format_count, pass_count;
    bool renderers[BENCH_RENDERERS]; /* which are measured */
    int runs;
    bool errors;                /* whether truth is rendered to hold images against */
    bool fma_fixed;             /* refuse a driver of another mode than the scenes' desc.unfused */
    const BenchRenderer *bound; /* BENCH_RENDERERS of them; in a process per group */
    Renderer truth;
} BenchPlan;

typedef struct BenchRow {
    int scene, format;          /* indices into the plan's */
    int width, height, threads; /* threads: as asked for */
    int lights;                 /* that the scene has lit */
    MethodId method;
    int passes;
    int renderer;           /* BenchRendererId */
    double cpu_ms, wall_ms; /* medians */
    double spread;          /* of CPU time: (greatest − least) / median */
    double wall_spread;
    double max_abs, rmse; /* of the final image against truth's; NaN without truth */
    uint64_t peak_bytes;  /* of the renderer's images, lists and uploads */
    uint64_t differing;   /* pixels of final and display that are not the first renderer's */
    int peels;            /* that the renderer drew */
    bool pareto; /* no row of this scene, size, lights and threads is as fast and as exact, and
                  * better in one of the two */
} BenchRow;

typedef struct BenchReport {
    const BenchPlan *plan;
    BenchRow *rows;
    size_t count;
    size_t differing; /* rows whose image is not the first renderer's */
} BenchReport;

size_t bench_row_count(const BenchPlan *plan);

/* BAD_INPUT when a scene has fewer lights than an axis value. group: called with the rows of each
 * scene, size, lights and threads when they are complete; may be NULL. The caller frees *out with
 * bench_free; plan must outlive it. */
typedef void (*BenchGroup)(void *context, const BenchReport *report, size_t first);
Result bench_run(const BenchPlan *plan, BenchGroup group, void *context, BenchReport *out);
void bench_free(BenchReport *report);

#endif

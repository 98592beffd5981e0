#include "study/roofline.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/pool.h"
#include "base/progress.h"

#include <assert.h>
#include <stdlib.h>

enum {
    STRETCHES = 5,
    BUFFER_BYTES = 256 << 20, /* over all threads, each of the two */
    BUFFER_LEAST = 32 << 20   /* of one thread */
};

typedef enum Kind {
    MULADD,
    FMA,
    DIVIDE,
    ROOT,
    LIGHT,
    READ,
    WRITE,
    COPY
} Kind;

typedef struct Job {
    const RooflineKernels *kernels;
    Kind kind;
    uint64_t rounds;
    RooflineLighting **lighting; /* one per thread */
    float **from, **to;          /* one per thread, of count floats */
    size_t count;
    double *rates;       /* one per thread */
    volatile float sink; /* so that no kernel is left out */
} Job;

/* What rounds of a kernel do, in the unit of its rate. */
static double work_of(const Job *job)
{
    double rounds = (double)job->rounds, chains = (double)ROOFLINE_CHAINS * job->kernels->lanes;
    double bytes = (double)job->count * sizeof(float);
    switch (job->kind) {
    case MULADD:
    case FMA:
        return 2.0 * rounds * chains;
    case DIVIDE:
    case ROOT:
        return rounds * chains;
    case LIGHT:
        return rounds * ROOFLINE_FRAGMENTS * ROOFLINE_LIGHTS;
    case COPY:
        return 2.0 * rounds * bytes;
    default:
        return rounds * bytes;
    }
}

static void run_kernel(Job *job, uint32_t index)
{
    const RooflineKernels *kernels = job->kernels;
    switch (job->kind) {
    case MULADD:
        job->sink = kernels->muladd(job->rounds);
        return;
    case FMA:
        job->sink = kernels->fma(job->rounds);
        return;
    case DIVIDE:
        job->sink = kernels->divide(job->rounds);
        return;
    case ROOT:
        job->sink = kernels->root(job->rounds);
        return;
    case LIGHT:
        job->sink = kernels->light(job->lighting[index], job->rounds);
        return;
    default:
        for (uint64_t i = 0; i < job->rounds; i++)
            if (job->kind == READ)
                job->sink = kernels->read(job->from[index], job->count);
            else if (job->kind == WRITE)
                kernels->write(job->to[index], job->count);
            else
                kernels->copy(job->to[index], job->from[index], job->count);
    }
}

static Result time_kernel(void *context, uint32_t index, int worker)
{
    Job *job = context;
    (void)worker;
    double start = clock_thread_ms();
    run_kernel(job, index);
    double seconds = 1e-3 * (clock_thread_ms() - start);
    job->rates[index] = seconds > 0.0 ? work_of(job) / seconds : 0.0;
    return RESULT_OK;
}

/* As many rounds as take stretch_ms. */
static void calibrate(Job *job, double stretch_ms)
{
    for (job->rounds = 1;; job->rounds *= 2) {
        double start = clock_thread_ms();
        run_kernel(job, 0);
        if (clock_thread_ms() - start >= stretch_ms || job->rounds >= UINT64_MAX / 4)
            return;
    }
}

static Result measure(Job *job, Pool *pool, double stretch_ms, RooflineRate *out)
{
    int threads = pool_threads(pool);
    calibrate(job, stretch_ms);
    for (int i = 0; i < STRETCHES; i++) {
        double sum = 0.0;
        time_kernel(job, 0, 0);
        out->one = job->rates[0] > out->one ? job->rates[0] : out->one;
        Result result = pool_run(pool, (uint32_t)threads, time_kernel, job);
        if (result != RESULT_OK)
            return result;
        for (int k = 0; k < threads; k++)
            sum += job->rates[k];
        out->all = sum > out->all ? sum : out->all;
    }
    return RESULT_OK;
}

static Result measure_width(Job *job, Pool *pool, double stretch_ms, RooflineWidth *out)
{
    const struct {
        Kind kind;
        RooflineRate *rate;
    } rates[] = {{MULADD, &out->muladd},
                 {FMA, &out->fma},
                 {DIVIDE, &out->divide},
                 {ROOT, &out->root},
                 {LIGHT, &out->light}};
    Result result = RESULT_OK;
    *out = (RooflineWidth){.simd = job->kernels->simd, .lanes = job->kernels->lanes};
    for (int i = 0; i < pool_threads(pool) && result == RESULT_OK; i++)
        result = job->kernels->lighting(&job->lighting[i]);
    for (size_t i = 0; i < sizeof rates / sizeof *rates && result == RESULT_OK; i++) {
        job->kind = rates[i].kind;
        if (job->kind != FMA || job->kernels->fma)
            result = measure(job, pool, stretch_ms, rates[i].rate);
    }
    for (int i = 0; i < pool_threads(pool); i++) {
        free(job->lighting[i]);
        job->lighting[i] = NULL;
    }
    return result;
}

/* With the widest kernels; written first, so that every page is there. */
static Result measure_memory(Job *job, Pool *pool, double stretch_ms, RooflineReport *out)
{
    assert(job->kernels); /* at least the scalar ones were measured */
    int threads = pool_threads(pool);
    size_t bytes = (size_t)BUFFER_BYTES / (size_t)threads;
    bytes = bytes > BUFFER_LEAST ? bytes : BUFFER_LEAST;
    job->count = bytes / sizeof(float) / 64 * 64;
    Result result = RESULT_OK;
    for (int i = 0; i < threads && result == RESULT_OK; i++) {
        job->from[i] = memory_array(job->count, sizeof(float));
        job->to[i] = memory_array(job->count, sizeof(float));
        if (!job->from[i] || !job->to[i])
            result = RESULT_NO_MEMORY;
        else
            job->kernels->write(job->from[i], job->count);
    }
    const struct {
        Kind kind;
        RooflineRate *rate;
    } rates[] = {{WRITE, &out->write}, {READ, &out->read}, {COPY, &out->copy}};
    for (size_t i = 0; i < sizeof rates / sizeof *rates && result == RESULT_OK; i++) {
        job->kind = rates[i].kind;
        result = measure(job, pool, stretch_ms, rates[i].rate);
    }
    for (int i = 0; i < threads; i++) {
        free(job->from[i]);
        free(job->to[i]);
    }
    return result;
}

static Result run(Job *job, RooflineTable table, Pool *pool, double stretch_ms, RooflineReport *out)
{
    const RooflineKernels *kernels = table(&out->count);
    Result result = RESULT_OK;
    progress_begin("roofline", 0);
    for (size_t i = 0; i < out->count && result == RESULT_OK; i++) {
        job->kernels = &kernels[i];
        result = measure_width(job, pool, stretch_ms, &out->widths[i]);
    }
    if (result == RESULT_OK)
        result = measure_memory(job, pool, stretch_ms, out);
    progress_end();
    return result;
}

Result roofline_run(RooflineTable table, int threads, double stretch_ms, RooflineReport *out)
{
    *out = (RooflineReport){0};
    Pool *pool = pool_create(threads);
    if (!pool)
        return RESULT_NO_MEMORY;
    size_t count = (size_t)pool_threads(pool);
    out->threads = pool_threads(pool);
    Job job = {.lighting = memory_array(count, sizeof *job.lighting),
               .from = memory_array(count, sizeof *job.from),
               .to = memory_array(count, sizeof *job.to),
               .rates = memory_array(count, sizeof *job.rates)};
    Result result = job.lighting && job.from && job.to && job.rates
                        ? run(&job, table, pool, stretch_ms, out)
                        : RESULT_NO_MEMORY;
    free(job.lighting);
    free(job.from);
    free(job.to);
    free(job.rates);
    pool_destroy(pool);
    return result;
}

RooflineLoop roofline_loop(const RooflineWidth *width)
{
    return (RooflineLoop){
        .ns = 1e9 / width->light.one,
        .flops = width->light.one * ROOFLINE_OPERATIONS,
        .share = width->light.one * ROOFLINE_OPERATIONS / width->muladd.one,
        .arithmetic = 1e9 * ROOFLINE_ARITHMETIC / width->muladd.one,
        .divider = 1e9 * (ROOFLINE_DIVS / width->divide.one + ROOFLINE_SQRTS / width->root.one),
    };
}

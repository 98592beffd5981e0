/* A worker pool: runs independent, numbered tasks on a fixed number of threads.
 *
 * Tasks must write only what their own index owns; results are then the same for any number of
 * threads. It does not order, cancel or nest tasks. */
#ifndef PEEL_BASE_POOL_H
#define PEEL_BASE_POOL_H

#include "base/result.h"

#include <stdint.h>

typedef struct Pool Pool;

/* index in [0, count); worker in [0, pool_threads()), so that a task can use per-worker scratch.
 * The first failure (lowest index among those run) becomes the result of pool_run. */
typedef Result (*PoolTask)(void *context, uint32_t index, int worker);

/* threads ≥ 1 workers, the caller included; 0 means one per online processor. NULL on failure. */
Pool *pool_create(int threads);
void pool_destroy(Pool *pool); /* NULL is fine */
int pool_threads(const Pool *pool);

/* Runs task for every index, in any order, and returns when all are done. After a failure the
 * tasks not yet started are skipped. */
Result pool_run(Pool *pool, uint32_t count, PoolTask task, void *context);

#endif

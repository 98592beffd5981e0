/* Work in a process of its own, which hands back records of one size: for what a process can do
 * only once, such as starting a GL driver with some number of threads. */
#ifndef PEEL_BASE_CHILD_H
#define PEEL_BASE_CHILD_H

#include "base/result.h"

#include <stddef.h>

typedef struct ChildWork {
    /* Runs in the child: calls child_put with records. Its result and message become child_run's.
     * What it leaves open ends with the process. */
    Result (*run)(void *context, int pipe);
    void *context;
    size_t record_size;
    /* Runs in the caller's process, for each record in order. */
    void (*take)(void *context, const void *record);
    void *take_context;
} ChildWork;

/* The caller must have no other thread. INTERNAL when the child ends without a result: by a signal,
 * say. The child ends when its parent does. */
Result child_run(const ChildWork *work);

/* record: work->record_size bytes. IO when the parent no longer listens. */
Result child_put(int pipe, const ChildWork *work, const void *record);

#endif

#include "base/pool.h"

#include "base/memory.h"
#include "base/progress.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct Worker {
    Pool *pool;
    int index;
    pthread_t thread;
} Worker;

struct Pool {
    int threads;
    Worker *workers; /* threads − 1 of them: the caller is worker 0 */
    pthread_mutex_t mutex;
    pthread_cond_t wake, idle;
    unsigned generation; /* counts pool_run calls, so that a worker joins each once */
    int busy;
    bool stop;
    /* The current run. */
    PoolTask task;
    void *context;
    uint32_t count;
    atomic_uint next;
    atomic_bool failed;
    uint32_t failed_index;
    Result result;
    char message[1024];
};

static void record_failure(Pool *pool, uint32_t index, Result result)
{
    pthread_mutex_lock(&pool->mutex);
    if (pool->result == RESULT_OK || index < pool->failed_index) {
        pool->result = result;
        pool->failed_index = index;
        snprintf(pool->message, sizeof pool->message, "%s", result_message());
    }
    pthread_mutex_unlock(&pool->mutex);
    atomic_store(&pool->failed, true);
}

static void run_tasks(Pool *pool, int worker)
{
    while (!atomic_load(&pool->failed)) {
        uint32_t index = atomic_fetch_add(&pool->next, 1);
        if (index >= pool->count)
            break;
        Result result = pool->task(pool->context, index, worker);
        if (result != RESULT_OK)
            record_failure(pool, index, result);
        progress_add();
    }
}

static void *worker_main(void *argument)
{
    Worker *worker = argument;
    Pool *pool = worker->pool;
    unsigned seen = 0;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        while (!pool->stop && pool->generation == seen)
            pthread_cond_wait(&pool->wake, &pool->mutex);
        if (pool->stop)
            break;
        seen = pool->generation;
        pthread_mutex_unlock(&pool->mutex);
        run_tasks(pool, worker->index);
        pthread_mutex_lock(&pool->mutex);
        if (--pool->busy == 0)
            pthread_cond_signal(&pool->idle);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

Pool *pool_create(int threads)
{
    if (threads <= 0) {
        long online = sysconf(_SC_NPROCESSORS_ONLN);
        threads = online > 0 ? (int)online : 1;
    }
    Pool *pool = memory_array(1, sizeof *pool);
    if (!pool)
        return NULL;
    pool->workers = memory_array((size_t)threads, sizeof *pool->workers);
    if (!pool->workers) {
        free(pool);
        return NULL;
    }
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->wake, NULL);
    pthread_cond_init(&pool->idle, NULL);
    pool->threads = 1;
    for (int i = 1; i < threads; i++) {
        Worker *worker = &pool->workers[i - 1];
        worker->pool = pool;
        worker->index = i;
        if (pthread_create(&worker->thread, NULL, worker_main, worker) != 0)
            break; /* fewer threads give the same results */
        pool->threads++;
    }
    return pool;
}

void pool_destroy(Pool *pool)
{
    if (!pool)
        return;
    pthread_mutex_lock(&pool->mutex);
    pool->stop = true;
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->mutex);
    for (int i = 0; i < pool->threads - 1; i++)
        pthread_join(pool->workers[i].thread, NULL);
    pthread_cond_destroy(&pool->wake);
    pthread_cond_destroy(&pool->idle);
    pthread_mutex_destroy(&pool->mutex);
    free(pool->workers);
    free(pool);
}

int pool_threads(const Pool *pool)
{
    return pool->threads;
}

Result pool_run(Pool *pool, uint32_t count, PoolTask task, void *context)
{
    pthread_mutex_lock(&pool->mutex);
    pool->task = task;
    pool->context = context;
    pool->count = count;
    pool->result = RESULT_OK;
    atomic_store(&pool->next, 0);
    atomic_store(&pool->failed, false);
    pool->busy = pool->threads - 1;
    pool->generation++;
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->mutex);
    run_tasks(pool, 0);
    pthread_mutex_lock(&pool->mutex);
    while (pool->busy > 0)
        pthread_cond_wait(&pool->idle, &pool->mutex);
    Result result = pool->result;
    pthread_mutex_unlock(&pool->mutex);
    return result == RESULT_OK ? RESULT_OK : result_fail(result, "%s", pool->message);
}

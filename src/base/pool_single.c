/* The pool of a platform without threads: the caller is the only worker. */
#include "base/memory.h"
#include "base/pool.h"

#include <stdlib.h>

struct Pool {
    char unused;
};

Pool *pool_create(int threads)
{
    (void)threads;
    return memory_array(1, sizeof(Pool));
}

void pool_destroy(Pool *pool)
{
    free(pool);
}

int pool_threads(const Pool *pool)
{
    (void)pool;
    return 1;
}

Result pool_run(Pool *pool, uint32_t count, PoolTask task, void *context)
{
    (void)pool;
    Result result = RESULT_OK;
    for (uint32_t i = 0; i < count && result == RESULT_OK; i++)
        result = task(context, i, 0);
    return result;
}

#include "base/json_memory.h"

#include <jansson.h>
#include <stdlib.h>

static _Thread_local bool failed;

static void *allocate(size_t size)
{
    void *memory = malloc(size);
    failed |= !memory;
    return memory;
}

void json_memory_begin(void)
{
    json_set_alloc_funcs(allocate, free);
    failed = false;
}

Result json_memory_check(const char *path, Result result)
{
    return failed ? result_fail(RESULT_NO_MEMORY, "%s: out of memory for its JSON", path) : result;
}

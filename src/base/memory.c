#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>

void *memory_array(size_t count, size_t size)
{
    bool fits = size == 0 || count <= (size_t)PTRDIFF_MAX / size;
    void *array = fits ? calloc(count ? count : 1, size) : NULL;
    if (!array)
        result_fail(RESULT_NO_MEMORY, "out of memory: %zu elements of %zu bytes", count, size);
    return array;
}

Result memory_grow(void **array, size_t *capacity, size_t needed, size_t size)
{
    if (needed <= *capacity)
        return RESULT_OK;
    size_t grown = *capacity ? *capacity : 16;
    while (grown < needed && grown <= SIZE_MAX / 2)
        grown *= 2;
    if (grown < needed || grown > SIZE_MAX / size)
        return result_fail(RESULT_NO_MEMORY, "out of memory: %zu elements of %zu bytes", needed,
                           size);
    void *moved = realloc(*array, grown * size);
    if (!moved)
        return result_fail(RESULT_NO_MEMORY, "out of memory: %zu elements of %zu bytes", grown,
                           size);
    *array = moved;
    *capacity = grown;
    return RESULT_OK;
}

#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

/* From this size on large pages are asked for: touching a frame's arrays page by page would
 * otherwise take a tenth of its time. */
#define LARGE_BYTES ((size_t)4 << 20)
#define PAGE_BYTES  ((uintptr_t)4096)

static void use_large_pages(void *array, size_t bytes)
{
#ifdef MADV_HUGEPAGE
    if (bytes < LARGE_BYTES)
        return;
    size_t before = (PAGE_BYTES - (uintptr_t)array % PAGE_BYTES) % PAGE_BYTES;
    size_t whole = (bytes - before) / PAGE_BYTES * PAGE_BYTES;
    madvise((char *)array + before, whole, MADV_HUGEPAGE); /* a wish: failure changes nothing */
#else
    (void)array;
    (void)bytes;
#endif
}

void *memory_array(size_t count, size_t size)
{
    bool fits = size == 0 || count <= (size_t)PTRDIFF_MAX / size;
    void *array = fits ? calloc(count ? count : 1, size ? size : 1) : NULL;
    if (!array)
        result_fail(RESULT_NO_MEMORY, "out of memory: %zu elements of %zu bytes", count, size);
    else
        use_large_pages(array, count * size);
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

/* Allocation with overflow checks. Free with free(). */
#ifndef PEEL_BASE_MEMORY_H
#define PEEL_BASE_MEMORY_H

#include "base/result.h"

#include <stddef.h>

/* count × size zeroed bytes; NULL and a message when that overflows or memory is exhausted.
 * A count of 0 gives a valid pointer to no elements. */
void *memory_array(size_t count, size_t size);

/* Grows *array (capacity elements of size bytes, owned by the caller) to hold at least `needed`
 * elements, doubling; new elements are not initialised. On failure nothing changes. */
Result memory_grow(void **array, size_t *capacity, size_t needed, size_t size);

#endif

#include "web/platform.h"

#include <stdlib.h>

static int (*current_compare)(const void *a, const void *b, void *context);
static void *current_context;

static int compare_items(const void *a, const void *b)
{
    return current_compare(a, b, current_context);
}

void qsort_r(void *items, size_t count, size_t size,
             int (*compare)(const void *a, const void *b, void *context), void *context)
{
    current_compare = compare;
    current_context = context;
    qsort(items, count, size, compare_items);
}

/* What wasi-libc lacks of the C library that peel-core uses; included before every file. */
#ifndef PEEL_WEB_PLATFORM_H
#define PEEL_WEB_PLATFORM_H

#include <stddef.h>

/* glibc's; one call at a time. */
void qsort_r(void *items, size_t count, size_t size,
             int (*compare)(const void *a, const void *b, void *context), void *context);

#endif

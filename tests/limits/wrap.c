#define _GNU_SOURCE /* fopencookie */
#include "wrap.h"

#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

static WrapPlan *plan;

WrapPlan *wrap_plan(void)
{
    return plan;
}

/* Whether this call is one that fails. */
static bool fails(void)
{
    if (!plan || !atomic_load(&plan->fails_at))
        return plan && (atomic_fetch_add(&plan->counted, 1), false);
    long number = atomic_fetch_add(&plan->counted, 1) + 1, at = atomic_load(&plan->fails_at);
    if (number != at && !(atomic_load(&plan->for_good) && number > at))
        return false;
    atomic_fetch_add(&plan->failed, 1);
    errno = ENOMEM;
    return true;
}

/* WRAP(type, name, parameters, arguments): name fails as the plan says, with NULL and ENOMEM. */
#define WRAP(type, name, parameters, arguments)                                                    \
    type __real_##name parameters;                                                                 \
    type __wrap_##name parameters;                                                                 \
    type __wrap_##name parameters                                                                  \
    {                                                                                              \
        return fails() ? NULL : __real_##name arguments;                                           \
    }

WRAP(void *, malloc, (size_t size), (size))
WRAP(void *, calloc, (size_t count, size_t size), (count, size))
WRAP(void *, realloc, (void *memory, size_t size), (memory, size))
WRAP(char *, strdup, (const char *text), (text))
WRAP(char *, realpath, (const char *path, char *resolved), (path, resolved))
WRAP(FILE *, fopen, (const char *path, const char *mode), (path, mode))
WRAP(FILE *, fdopen, (int descriptor, const char *mode), (descriptor, mode))
WRAP(FILE *, tmpfile, (void), ())
WRAP(DIR *, opendir, (const char *path), (path))

int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*start)(void *), void *argument);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*start)(void *), void *argument);

int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*start)(void *), void *argument)
{
    return fails() ? EAGAIN : __real_pthread_create(thread, attributes, start, argument);
}

int __real_setenv(const char *name, const char *value, int overwrite);
int __wrap_setenv(const char *name, const char *value, int overwrite);

int __wrap_setenv(const char *name, const char *value, int overwrite)
{
    return fails() ? -1 : __real_setenv(name, value, overwrite);
}

/* ---- a stream to memory, whose growth can fail as the C library's can ---- */

typedef struct Memory {
    char **text;
    size_t *size;
    size_t capacity;
} Memory;

static ssize_t memory_write(void *cookie, const char *bytes, size_t count)
{
    Memory *memory = cookie;
    if (*memory->size + count >= memory->capacity) {
        size_t capacity = 2 * (*memory->size + count) + 64;
        char *grown = __wrap_realloc(*memory->text, capacity);
        if (!grown)
            return 0;
        *memory->text = grown;
        memory->capacity = capacity;
    }
    memcpy(*memory->text + *memory->size, bytes, count);
    *memory->size += count;
    (*memory->text)[*memory->size] = 0;
    return (ssize_t)count;
}

static int memory_close(void *cookie)
{
    free(cookie);
    return 0;
}

FILE *__wrap_open_memstream(char **text, size_t *size);

FILE *__wrap_open_memstream(char **text, size_t *size)
{
    char *first = __wrap_calloc(1, 1);
    Memory *memory = first ? __real_calloc(1, sizeof *memory) : NULL;
    FILE *stream =
        memory ? fopencookie(memory, "w",
                             (cookie_io_functions_t){.write = memory_write, .close = memory_close})
               : NULL;
    if (!stream) {
        free(first);
        free(memory);
        return NULL;
    }
    *memory = (Memory){text, size, 1};
    *text = first;
    *size = 0;
    return stream;
}

bool wrap_begin(void)
{
    void *shared =
        mmap(NULL, sizeof *plan, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED)
        return false;
    plan = shared;
    return true;
}

/* An OpenGL core context, 4.5 at least, on OSMesa or EGL, current on the thread that opened it. */
#ifndef PEEL_GL_CONTEXT_H
#define PEEL_GL_CONTEXT_H

#include "api.h"

#include <stddef.h>

typedef struct Context Context;

/* Limits the renderer depends on. */
typedef struct ContextLimits {
    int texture_size; /* pixels a side */
    int viewport[2];  /* pixels */
    int draw_buffers;
    int uniform_block; /* bytes */
    int storage_block; /* bytes */
} ContextLimits;

typedef enum ContextKind {
    CONTEXT_OSMESA = 0,
    CONTEXT_EGL /* without a surface */
} ContextKind;

/* Where contexts come from; for the process, before its first one. */
void context_choose(ContextKind kind);

/* The file of the library that contexts come from, as the loader finds it; "" where it does not.
 * Makes no context. */
void context_library(char *path, size_t size);

/* Opens a context, loads gl and reports driver errors to it. threads > 0 asks llvmpipe for that
 * many rasterizer threads; only the first context of a process can, and only where LP_NUM_THREADS
 * is not set. NO_GL when there is no such context. The caller closes it on the same thread. */
Result context_open(int threads, Context **out);
void context_close(Context *context); /* NULL is fine */

/* Makes it current again after another one was opened or closed on this thread. */
Result context_use(Context *context);

const ContextLimits *context_limits(const Context *context);

/* Rasterizer threads in effect, at least 1. */
int context_threads(void);

/* Finishes pending work and fails with NO_GL (NO_MEMORY where the driver had none) and the
 * driver's text if it has reported an error since the last check. where: a few words. */
Result context_check(Context *context, const char *where);

#endif

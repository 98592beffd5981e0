/* The ways to a context without a window: what context.c needs of each. */
#ifndef PEEL_GL_PLATFORM_H
#define PEEL_GL_PLATFORM_H

#include "api.h"

#include <stddef.h>

typedef struct Platform {
    /* Makes an OpenGL core context that draws nowhere by itself; the library is loaded at the
     * first call and stays, for Mesa's threads and exit handlers live in it. NO_GL with what is
     * missing. The caller gives *out back to close. */
    Result (*open)(void **out);
    bool (*use)(void *handle); /* makes it current; NULL: none */
    void (*close)(void *handle);
    ApiFunction (*lookup)(const char *name);
    const char *file; /* the library's, for the loader */
} Platform;

extern const Platform platform_osmesa, platform_egl;

/* One function of a library, to be found by name. */
typedef struct PlatformSymbol {
    const char *name;
    void *slot; /* a pointer to a function */
} PlatformSymbol;

/* Fills the slots from the library `file`, of Debian's packages `packages`. NO_GL names what is
 * missing. */
Result platform_load(const char *file, const char *packages, const PlatformSymbol *symbols,
                     size_t count);

#endif

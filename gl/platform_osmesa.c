#include "platform.h"

#include <GL/osmesa.h>

#include <stdlib.h>

/* The window that OSMesa insists on; nothing is drawn to it. */
enum {
    WINDOW_PIXELS = 16
};

typedef struct Handle {
    OSMesaContext context;
    unsigned char window[WINDOW_PIXELS * WINDOW_PIXELS * 4];
} Handle;

static struct {
    OSMesaContext (*create)(const int *attributes, OSMesaContext shared);
    GLboolean (*make_current)(OSMesaContext context, void *buffer, GLenum type, GLsizei width,
                              GLsizei height);
    void (*destroy)(OSMesaContext context);
    OSMESAproc (*proc_address)(const char *name);
} osmesa;

static Result load(void)
{
    static const PlatformSymbol symbols[] = {
        {"OSMesaCreateContextAttribs", &osmesa.create},
        {"OSMesaMakeCurrent", &osmesa.make_current},
        {"OSMesaDestroyContext", &osmesa.destroy},
        {"OSMesaGetProcAddress", &osmesa.proc_address},
    };
    if (osmesa.proc_address)
        return RESULT_OK;
    return platform_load(platform_osmesa.file, "package libosmesa6", symbols,
                         sizeof symbols / sizeof *symbols);
}

static bool use_osmesa(void *handle)
{
    Handle *self = handle;
    return self ? osmesa.make_current(self->context, self->window, GL_UNSIGNED_BYTE, WINDOW_PIXELS,
                                      WINDOW_PIXELS)
                : osmesa.make_current(NULL, NULL, 0, 0, 0);
}

static void close_osmesa(void *handle)
{
    Handle *self = handle;
    osmesa.destroy(self->context);
    free(self);
}

static Result open_osmesa(void **out)
{
    static const int attributes[] = {OSMESA_FORMAT,
                                     OSMESA_RGBA,
                                     OSMESA_DEPTH_BITS,
                                     0,
                                     OSMESA_PROFILE,
                                     OSMESA_CORE_PROFILE,
                                     OSMESA_CONTEXT_MAJOR_VERSION,
                                     4,
                                     OSMESA_CONTEXT_MINOR_VERSION,
                                     6,
                                     0};
    Result result = load();
    if (result != RESULT_OK)
        return result;
    Handle *self = calloc(1, sizeof *self);
    if (!self)
        return result_fail(RESULT_NO_MEMORY, "OpenGL: no memory for a context");
    self->context = osmesa.create(attributes, NULL);
    if (!self->context || !use_osmesa(self)) {
        if (self->context)
            osmesa.destroy(self->context);
        free(self);
        return result_fail(RESULT_NO_GL, "OSMesa: cannot make an OpenGL 4.6 core context");
    }
    *out = self;
    return RESULT_OK;
}

static ApiFunction lookup_osmesa(const char *name)
{
    return (ApiFunction)osmesa.proc_address(name);
}

const Platform platform_osmesa = {open_osmesa, use_osmesa, close_osmesa, lookup_osmesa,
                                  "libOSMesa.so.8"};

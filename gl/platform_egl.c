/* EGL without a surface: Mesa's surfaceless platform, else each device there is, else the default
 * display, so that a graphics processor's driver is found, too. */
#include "platform.h"

#define EGL_NO_PLATFORM_SPECIFIC_TYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <stdlib.h>
#include <string.h>

enum {
    DEVICES_MAX = 16
};

static struct {
    __eglMustCastToProperFunctionPointerType (*proc_address)(const char *name);
    const char *(*query_string)(EGLDisplay display, EGLint name);
    EGLDisplay (*display)(EGLNativeDisplayType native);
    EGLBoolean (*initialize)(EGLDisplay display, EGLint *major, EGLint *minor);
    EGLBoolean (*bind_api)(EGLenum api);
    EGLBoolean (*choose_config)(EGLDisplay display, const EGLint *attributes, EGLConfig *configs,
                                EGLint size, EGLint *count);
    EGLContext (*create)(EGLDisplay display, EGLConfig config, EGLContext shared,
                         const EGLint *attributes);
    EGLBoolean (*make_current)(EGLDisplay display, EGLSurface draw, EGLSurface read,
                               EGLContext context);
    EGLBoolean (*destroy)(EGLDisplay display, EGLContext context);
} egl;

/* The display that gave the first context; never terminated, for contexts come and go. */
static EGLDisplay found;

static Result load(void)
{
    static const PlatformSymbol symbols[] = {
        {"eglGetProcAddress", &egl.proc_address},
        {"eglQueryString", &egl.query_string},
        {"eglGetDisplay", &egl.display},
        {"eglInitialize", &egl.initialize},
        {"eglBindAPI", &egl.bind_api},
        {"eglChooseConfig", &egl.choose_config},
        {"eglCreateContext", &egl.create},
        {"eglMakeCurrent", &egl.make_current},
        {"eglDestroyContext", &egl.destroy},
    };
    if (egl.destroy)
        return RESULT_OK;
    return platform_load(platform_egl.file, "packages libegl1, libegl-mesa0 and libgl1-mesa-dri",
                         symbols, sizeof symbols / sizeof *symbols);
}

static bool has_word(const char *words, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = words; at && (at = strstr(at, word)); at += length)
        if ((at == words || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0'))
            return true;
    return false;
}

static bool use_egl(void *handle)
{
    return egl.make_current(found, EGL_NO_SURFACE, EGL_NO_SURFACE,
                            handle ? handle : EGL_NO_CONTEXT);
}

/* A current context of version 4.minor, or EGL_NO_CONTEXT. Without a surface no configuration is
 * needed where the display can do without. */
static EGLContext create(EGLDisplay display, EGLint minor)
{
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 minor,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    static const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                    EGL_NONE};
    EGLConfig config = EGL_NO_CONFIG_KHR;
    EGLint count = 0;
    const char *extensions = egl.query_string(display, EGL_EXTENSIONS);
    if (!has_word(extensions, "EGL_KHR_surfaceless_context"))
        return EGL_NO_CONTEXT;
    if (!has_word(extensions, "EGL_KHR_no_config_context") &&
        (!egl.choose_config(display, wanted, &config, 1, &count) || count < 1))
        return EGL_NO_CONTEXT;
    EGLContext context = egl.create(display, config, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT)
        return context;
    if (egl.make_current(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
        return context;
    egl.destroy(display, context);
    return EGL_NO_CONTEXT;
}

static EGLContext try_display(EGLDisplay display)
{
    if (display == EGL_NO_DISPLAY || !egl.initialize(display, NULL, NULL))
        return EGL_NO_CONTEXT;
    EGLContext context = create(display, 6);
    if (context == EGL_NO_CONTEXT)
        context = create(display, 5);
    if (context != EGL_NO_CONTEXT)
        found = display;
    return context;
}

static EGLContext try_all(void)
{
    const char *client = egl.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    PFNEGLGETPLATFORMDISPLAYEXTPROC platform_display =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)egl.proc_address("eglGetPlatformDisplayEXT");
    PFNEGLQUERYDEVICESEXTPROC query_devices =
        (PFNEGLQUERYDEVICESEXTPROC)egl.proc_address("eglQueryDevicesEXT");
    EGLContext context = EGL_NO_CONTEXT;
    if (platform_display && has_word(client, "EGL_MESA_platform_surfaceless"))
        context =
            try_display(platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL));
    EGLDeviceEXT devices[DEVICES_MAX];
    EGLint count = 0;
    if (context == EGL_NO_CONTEXT && platform_display && query_devices &&
        has_word(client, "EGL_EXT_platform_device") && query_devices(DEVICES_MAX, devices, &count))
        for (EGLint i = 0; i < count && context == EGL_NO_CONTEXT; i++)
            context = try_display(platform_display(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL));
    if (context == EGL_NO_CONTEXT)
        context = try_display(egl.display(EGL_DEFAULT_DISPLAY));
    return context;
}

static Result open_egl(void **out)
{
    Result result = load();
    if (result != RESULT_OK)
        return result;
    egl.bind_api(EGL_OPENGL_API);
    EGLContext context = found ? try_display(found) : try_all();
    if (context == EGL_NO_CONTEXT)
        return result_fail(RESULT_NO_GL,
                           "EGL: no display here gives an OpenGL 4.5 core context without a "
                           "surface (Debian's packages libegl-mesa0 and libgl1-mesa-dri do)");
    *out = context;
    return RESULT_OK;
}

static void close_egl(void *handle)
{
    egl.destroy(found, handle);
}

static ApiFunction lookup_egl(const char *name)
{
    return (ApiFunction)egl.proc_address(name);
}

const Platform platform_egl = {open_egl, use_egl, close_egl, lookup_egl, "libEGL.so.1"};

#define _GNU_SOURCE /* dlinfo */
#include "context.h"

#include "platform.h"

#include <dlfcn.h>
#include <link.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CONTEXT_LEAKS_CHECKED
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define CONTEXT_LEAKS_CHECKED
#endif

#ifdef CONTEXT_LEAKS_CHECKED
/* OSMesa never frees a context's window buffer, some 160 bytes a context: OSMesaDestroyContext in
 * Mesa 22.3 forgets it. The leak checker asks for these by name. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libOSMesa.so\n";
}

const char *__lsan_default_options(void);
const char *__lsan_default_options(void)
{
    return "print_suppressions=0";
}
#endif

struct Context {
    void *handle; /* the platform's */
    ContextLimits limits;
    char failure[512]; /* the first error the driver reported, "" if none */
};

static const Platform *platform = &platform_osmesa;
static Context *current;

static void APIENTRY on_message(GLenum source, GLenum type, GLuint id, GLenum severity,
                                GLsizei length, const GLchar *message, const void *user)
{
    (void)source, (void)id, (void)length;
    Context *context = (Context *)user;
    if (type != GL_DEBUG_TYPE_ERROR && severity != GL_DEBUG_SEVERITY_HIGH)
        return;
    if (!context->failure[0])
        snprintf(context->failure, sizeof context->failure, "%s", message);
}

Result platform_load(const char *file, const char *packages, const PlatformSymbol *symbols,
                     size_t count)
{
    void *library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
    if (!library)
        return result_fail(RESULT_NO_GL, "OpenGL: %s (Debian's %s)", dlerror(), packages);
    for (size_t i = 0; i < count; i++) {
        void *address = dlsym(library, symbols[i].name);
        if (!address)
            return result_fail(RESULT_NO_GL, "OpenGL: %s is missing from %s", symbols[i].name,
                               file);
        memcpy(symbols[i].slot, &address, sizeof address);
    }
    return RESULT_OK;
}

/* Mesa crashes in a context of a driver that it does not have, and where a vector has no room for
 * 32 bits. It reads the width as here: in any base, its low 32 bits; what begins with no number is
 * left alone. */
static Result check_environment(void)
{
    const char *name = getenv("GALLIUM_DRIVER"), *width = getenv("LP_NATIVE_VECTOR_WIDTH");
    if (name && *name && strcmp(name, "llvmpipe") != 0 && strcmp(name, "softpipe") != 0)
        return result_fail(RESULT_NO_GL, "GALLIUM_DRIVER=%s: expected llvmpipe or softpipe", name);
    char *end;
    if (width && (unsigned)strtol(width, &end, 0) < 32 && end != width)
        return result_fail(RESULT_NO_GL, "LP_NATIVE_VECTOR_WIDTH=%s: expected 32 bits or more",
                           width);
    return RESULT_OK;
}

int context_threads(void)
{
    const char *text = getenv("LP_NUM_THREADS");
    long threads = text ? strtol(text, NULL, 0) : sysconf(_SC_NPROCESSORS_ONLN);
    return threads < 1 ? 1 : threads > 1024 ? 1024 : (int)threads;
}

static void *pass_through(void *gate)
{
    pthread_mutex_lock(gate);
    pthread_mutex_unlock(gate);
    return NULL;
}

/* Whether so many threads can be there at once. */
static bool can_start(int count)
{
    pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
    pthread_t *threads = calloc((size_t)count, sizeof *threads);
    int started = 0;
    if (!threads)
        return false;
    pthread_mutex_lock(&gate);
    while (started < count && pthread_create(&threads[started], NULL, pass_through, &gate) == 0)
        started++;
    pthread_mutex_unlock(&gate);
    for (int i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
    free(threads);
    return started == count;
}

/* llvmpipe waits for ever for a thread that it could not start: where there are too few for its
 * rasterizer, its compute shaders and its cache, it shall have none. */
static void check_threads(void)
{
    if (!can_start(2 * context_threads() + 2))
        setenv("LP_NUM_THREADS", "0", 1);
}

/* llvmpipe reads its environment once, when the first context is made. */
static void prepare_environment(int threads)
{
    static bool prepared;
    if (prepared)
        return;
    prepared = true;
    /* llvmpipe offers 4.5; what it lacks of 4.6 is not used here. */
    setenv("MESA_GL_VERSION_OVERRIDE", "4.6", 1);
    setenv("MESA_GLSL_VERSION_OVERRIDE", "460", 1);
    /* Mesa complains on stderr, in a line of its own, when it cannot make its cache. */
    const char *home = getenv("XDG_CACHE_HOME") ? getenv("XDG_CACHE_HOME") : getenv("HOME");
    if (!home || access(home, W_OK) != 0)
        setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    setenv("EGL_LOG_LEVEL", "fatal", 0); /* its complaints, too */
    if (threads > 0) {
        char text[16];
        snprintf(text, sizeof text, "%d", threads);
        setenv("LP_NUM_THREADS", text, 0);
    }
    check_threads();
}

static Result check_driver(Context *context)
{
    GLint major = 0, minor = 0, samples = 0;
    gl.GetIntegerv(GL_MAJOR_VERSION, &major);
    gl.GetIntegerv(GL_MINOR_VERSION, &minor);
    if (major * 10 + minor < 45)
        return result_fail(RESULT_NO_GL, "OpenGL: version 4.5 expected, %s has %d.%d",
                           (const char *)gl.GetString(GL_RENDERER), major, minor);
    gl.GetIntegerv(GL_SAMPLES, &samples);
    if (samples != 0)
        return result_fail(RESULT_NO_GL, "OpenGL: no multisampling expected, %d samples found",
                           samples);
    ContextLimits *limits = &context->limits;
    gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &limits->texture_size);
    gl.GetIntegerv(GL_MAX_VIEWPORT_DIMS, limits->viewport);
    gl.GetIntegerv(GL_MAX_DRAW_BUFFERS, &limits->draw_buffers);
    gl.GetIntegerv(GL_MAX_UNIFORM_BLOCK_SIZE, &limits->uniform_block);
    gl.GetIntegerv(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limits->storage_block);
    return RESULT_OK;
}

static Result start(Context *context)
{
    Result result = check_environment();
    if (result == RESULT_OK)
        result = platform->open(&context->handle);
    if (result != RESULT_OK)
        return result;
    current = context;
    result = api_load(platform->lookup);
    if (result == RESULT_OK)
        result = check_driver(context);
    if (result != RESULT_OK)
        return result;
    gl.Enable(GL_DEBUG_OUTPUT);
    gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    gl.DebugMessageCallback(on_message, context);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl.ClampColor(GL_CLAMP_READ_COLOR, GL_FALSE);
    return context_check(context, "context");
}

Result context_open(int threads, Context **out)
{
    *out = NULL;
    prepare_environment(threads);
    Context *context = calloc(1, sizeof *context);
    if (!context)
        return result_fail(RESULT_NO_MEMORY, "OpenGL: no memory for a context");
    Result result = start(context);
    if (result != RESULT_OK) {
        context_close(context);
        return result;
    }
    *out = context;
    return RESULT_OK;
}

void context_close(Context *context)
{
    if (!context)
        return;
    if (context->handle) {
        if (current == context) {
            platform->use(NULL);
            current = NULL;
        }
        platform->close(context->handle);
    }
    free(context);
}

void context_choose(ContextKind kind)
{
    platform = kind == CONTEXT_EGL ? &platform_egl : &platform_osmesa;
}

void context_library(char *path, size_t size)
{
    struct link_map *map = NULL;
    void *library = dlopen(platform->file, RTLD_LAZY | RTLD_LOCAL); /* stays, as platform.h says */
    bool found = library && dlinfo(library, RTLD_DI_LINKMAP, &map) == 0;
    snprintf(path, size, "%s", found ? map->l_name : "");
}

Result context_use(Context *context)
{
    if (current != context && !platform->use(context->handle))
        return result_fail(RESULT_NO_GL, "OpenGL: cannot return to a context");
    current = context;
    return RESULT_OK;
}

const ContextLimits *context_limits(const Context *context)
{
    return &context->limits;
}

Result context_check(Context *context, const char *where)
{
    gl.Finish();
    GLenum error = gl.GetError();
    if (error == GL_NO_ERROR && !context->failure[0])
        return RESULT_OK;
    Result code = error == GL_OUT_OF_MEMORY ? RESULT_NO_MEMORY : RESULT_NO_GL;
    char text[sizeof context->failure];
    if (context->failure[0])
        memcpy(text, context->failure, sizeof text);
    else
        snprintf(text, sizeof text, "error 0x%04x", error);
    context->failure[0] = '\0';
    return result_fail(code, "OpenGL: %s: %s", where, text);
}

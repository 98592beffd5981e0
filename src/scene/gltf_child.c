#include "scene/gltf_child.h"

#include "scene/blob.h"
#include "scene/gltf.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct Load {
    const char *path;
    size_t max_memory;
    /* In the child. */
    int pipe;
    uint64_t bytes; /* of the files so far */
    size_t memory;  /* what it may take now */
    /* In the parent. */
    Scene *scene;
    Result read; /* what blob_read made of the child's scene; INTERNAL: there is none */
} Load;

ChildLimits gltf_child_limits(uint64_t bytes, size_t max_memory)
{
    uint64_t more = GLTF_CHILD_MEMORY_MAX - GLTF_CHILD_MEMORY, memory = max_memory;
    if (!memory)
        memory = GLTF_CHILD_MEMORY +
                 (bytes < more / GLTF_CHILD_PER_BYTE ? bytes * GLTF_CHILD_PER_BYTE : more);
    if (memory > SIZE_MAX / 2)
        memory = SIZE_MAX / 2;
    uint64_t gibibytes = (memory + (((uint64_t)1 << 30) - 1)) >> 30;
    return (ChildLimits){.memory = (size_t)memory,
                         .seconds =
                             GLTF_CHILD_SECONDS * (double)(gibibytes < 1000 ? gibibytes : 1000)};
}

/* ---- in the child ---------------------------------------------------------------------------- */

static Result on_file(void *context, const char *path, uint64_t bytes)
{
    Load *load = context;
    load->bytes += bytes;
    const ChildLimits limits = gltf_child_limits(load->bytes, load->max_memory);
    load->memory = limits.memory;
    Result result = child_reads(load->pipe, path);
    return result ? result : child_limit(load->pipe, &limits);
}

static Result run(void *context, int pipe)
{
    Load *load = context;
    Scene scene;
    unsigned char *bytes = NULL;
    size_t count = 0;
    load->pipe = pipe;
    Result result = gltf_load_files(load->path, on_file, load, &scene);
    if (!result)
        result = blob_write(&scene, &bytes, &count);
    if (!result)
        result = child_put(pipe, bytes, count);
    if (result == RESULT_NO_MEMORY)
        result_fail(
            result,
            "%s: loading it takes more memory than %zu MiB (--max-memory), or than there is",
            load->path, load->memory >> 20);
    return result;
}

/* ---- in the parent --------------------------------------------------------------------------- */

static void take(void *context, const void *record, size_t size)
{
    Load *load = context;
    load->read = blob_read(record, size, load->scene);
}

/* Messages about the child do not name the file. Libraries may crash where they find no memory. */
static Result name_file(const char *path, Result result, size_t memory)
{
    if (result == RESULT_INTERNAL)
        result_fail(result, "%s: cannot load: %s; of memory it may take %zu MiB (--max-memory)",
                    path, result_message(), memory >> 20);
    else if (strncmp(result_message(), path, strlen(path)) != 0)
        result_fail(result, "%s: cannot load: %s", path, result_message());
    return result == RESULT_INTERNAL ? RESULT_BAD_INPUT : result;
}

Result gltf_child_load(const char *path, size_t max_memory, Scene *out)
{
    struct stat info;
    *out = (Scene){0};
    uint64_t bytes = stat(path, &info) == 0 ? (uint64_t)info.st_size : 0;
    Load load = {.path = path, .max_memory = max_memory, .scene = out, .read = RESULT_INTERNAL};
    const ChildWork work = {.run = run,
                            .context = &load,
                            .take = take,
                            .take_context = &load,
                            .name = "the library that reads it",
                            .quiet = true,
                            .limits = gltf_child_limits(bytes, max_memory)};
    load.memory = work.limits.memory;
    Result result = child_run(&work);
    if (!result)
        result = load.read;
    if (!result)
        return RESULT_OK;
    scene_free(out);
    return name_file(path, result, load.memory);
}

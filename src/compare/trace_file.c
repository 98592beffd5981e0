#include "compare/trace_file.h"

#include "base/file.h"
#include "base/text.h"
#include "frame/method.h"
#include "image/dump.h"
#include "image/exr.h"
#include "image/exr_planes.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool begins(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

int trace_name_peel(const char *name)
{
    const char *rest;
    int peel = trace_peel_number(name, &rest);
    return peel >= 0 && *rest == '.' ? peel : -1;
}

int trace_name_step(const char *name)
{
    int peel = trace_name_peel(name);
    if (peel >= 0)
        return peel + 1;
    return begins(name, "opaque.") ? 0 : INT_MAX;
}

static bool is_buffer_name(const char *name)
{
    if (trace_name_step(name) != INT_MAX || strcmp(name, "accum") == 0 ||
        strcmp(name, "display") == 0)
        return true;
    for (int i = 0; i < METHOD_COUNT; i++) {
        const char *method = method_info((MethodId)i)->name;
        if (begins(name, method) && name[strlen(method)] == '.')
            return true;
    }
    return false;
}

static Result is_dump(const char *path, bool *is)
{
    char head[sizeof DUMP_MAGIC - 1];
    size_t count;
    Result result = file_head(path, head, sizeof head, &count);
    *is = result == RESULT_OK && count == sizeof head && memcmp(head, DUMP_MAGIC, count) == 0;
    return result;
}

Result trace_file_is(const char *path, bool *is)
{
    bool exr;
    ExrFile *file = NULL;
    Result result = is_dump(path, is);
    if (result != RESULT_OK || *is)
        return result;
    result = exr_is(path, &exr);
    if (result != RESULT_OK || !exr)
        return result;
    result = exr_file_open(path, &file);
    /* A single part with a name like "display" or "sum.rgba" is an image, unless Peel wrote it. */
    bool single = result == RESULT_OK && exr_file_count(file) == 1 && !exr_file_is_trace(file);
    for (int i = 0; result == RESULT_OK && i < exr_file_count(file) && !*is; i++) {
        const char *name = exr_file_name(file, i);
        *is = single ? trace_name_step(name) != INT_MAX : is_buffer_name(name);
    }
    exr_file_close(file);
    return result;
}

typedef struct Reader {
    const char *path;
    TraceStore *store;
} Reader;

static Result put(void *context, const char *name, const Image *image)
{
    const Reader *reader = context;
    char line[DUMP_NAME];
    snprintf(line, sizeof line, "%s", name);
    text_make_line(line);
    name = line;
    if (store_find(reader->store, name) >= 0)
        return result_fail(RESULT_BAD_INPUT, "%s: buffer %s comes twice, expected once",
                           reader->path, name);
    return trace_put(store_sink(reader->store), name, trace_name_step(name), image->format,
                     image->width, image->height, image->pixels);
}

static Result read_exr(const char *path, Reader *reader)
{
    ExrFile *file;
    Result result = exr_file_open(path, &file);
    for (int i = 0; result == RESULT_OK && i < exr_file_count(file); i++) {
        const char *name = exr_file_name(file, i);
        Image image;
        result = exr_file_image(file, i, &image);
        if (result == RESULT_OK && is_buffer_name(name) && strlen(name) < DUMP_NAME)
            result = put(reader, name, &image);
        image_free(&image);
    }
    exr_file_close(file);
    return result;
}

Result trace_file_read(const char *path, TraceStore *store)
{
    Reader reader = {path, store};
    bool dump;
    Result result = is_dump(path, &dump);
    if (result != RESULT_OK)
        return result;
    return dump ? dump_read(path, put, &reader) : read_exr(path, &reader);
}

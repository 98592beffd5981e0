#include "base/file.h"

#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static Result fail_write(const char *path, int error)
{
    return result_fail(error == ENOMEM ? RESULT_NO_MEMORY : RESULT_IO,
                       "%s: cannot write this file: %s", path, strerror(error));
}

/* The temporaries of open writers. More than there are slots are merely not cleaned up. */
enum {
    TEMPORARIES = 64
};
static _Atomic(const char *) temporaries[TEMPORARIES];

static void remember(const char *name)
{
    for (int i = 0; i < TEMPORARIES; i++) {
        const char *none = NULL;
        if (atomic_compare_exchange_strong(&temporaries[i], &none, name))
            return;
    }
}

static void forget(const char *name)
{
    for (int i = 0; name && i < TEMPORARIES; i++) {
        const char *same = name;
        if (atomic_compare_exchange_strong(&temporaries[i], &same, NULL))
            return;
    }
}

const int file_ending_signals[] = {SIGINT,  SIGTERM, SIGHUP,  SIGPIPE, SIGABRT, SIGQUIT,
                                   SIGXCPU, SIGALRM, SIGUSR1, SIGUSR2, SIGPWR,  0};

void file_remove_temporaries(void)
{
    for (int i = 0; i < TEMPORARIES; i++) {
        const char *name = atomic_load(&temporaries[i]);
        if (name)
            unlink(name);
    }
}

/* How much of path names its folder, the slash included. */
static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* Creates a file in path's folder under a name that nobody uses; the name does not grow with
 * path's, which may be as long as names can be. Not mkstemp, whose files only their owner may
 * read. */
static int create_temporary(const char *path, char **temporary)
{
    size_t folder = folder_length(path), size = folder + 64;
    char *name = malloc(size);
    if (!name)
        return -1;
    int descriptor = -1, error = EEXIST;
    for (int attempt = 0; descriptor < 0 && error == EEXIST && attempt < 100; attempt++) {
        snprintf(name, size, "%.*s.peel-%ld-%d.tmp", (int)folder, path, (long)getpid(), attempt);
        remember(name); /* before it is there: a signal may come at once */
        descriptor = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        error = errno;
        if (descriptor < 0)
            forget(name);
    }
    if (descriptor >= 0) {
        *temporary = name;
        return descriptor;
    }
    free(name);
    errno = error;
    return -1;
}

/* What the symbolic link at path names, from where path is seen from. NULL: errno says why. */
static char *link_target(const char *path)
{
    char target[PATH_MAX];
    ssize_t length = readlink(path, target, sizeof target);
    if (length < 0)
        return NULL;
    if (length == (ssize_t)sizeof target) {
        errno = ENAMETOOLONG;
        return NULL;
    }
    size_t folder = target[0] == '/' ? 0 : folder_length(path);
    char *joined = malloc(folder + (size_t)length + 1);
    if (!joined)
        return NULL;
    memcpy(joined, path, folder);
    memcpy(joined + folder, target, (size_t)length);
    joined[folder + (size_t)length] = 0;
    return joined;
}

/* Sets writer->path, where there is no file, to what a chain of symbolic links leads to. */
static bool follow_dangling(FileWriter *writer)
{
    struct stat status;
    for (int links = 0; lstat(writer->path, &status) == 0 && S_ISLNK(status.st_mode); links++) {
        if (links == 40) {
            errno = ELOOP;
            return false;
        }
        char *target = link_target(writer->path);
        if (!target)
            return false;
        free(writer->path);
        writer->path = target;
    }
    return true;
}

/* A file that one of the program's own streams goes to, as /dev/stdout may be: what that has
 * written stays. −1: it is none. */
static int open_stream(const struct stat *status)
{
    for (int stream = STDOUT_FILENO; stream <= STDERR_FILENO; stream++) {
        struct stat own;
        int mode = fcntl(stream, F_GETFL);
        if (mode < 0 || (mode & O_ACCMODE) == O_RDONLY || fstat(stream, &own) != 0 ||
            own.st_dev != status->st_dev || own.st_ino != status->st_ino)
            continue;
        fflush(stdout);
        return fcntl(stream, F_DUPFD_CLOEXEC, 0);
    }
    return -1;
}

/* A device must not be replaced by a regular file; a symbolic link stays, its target changes or
 * comes into being. A file that may not be written is not replaced either, and rights stay. */
static int open_target(FileWriter *writer)
{
    struct stat status;
    if (stat(writer->path, &status) != 0) {
        if (errno != ENOENT || !*writer->path || !follow_dangling(writer))
            return -1;
        /* NOLINTNEXTLINE(clang-analyzer-unix.Malloc): release() frees the path */
        return create_temporary(writer->path, &writer->temporary);
    }
    if (!S_ISREG(status.st_mode))
        return open(writer->path, O_WRONLY | O_CLOEXEC); /* a directory refuses */
    int own = open_stream(&status);
    writer->shared = own >= 0;
    if (writer->shared)
        return own;
    char *resolved = access(writer->path, W_OK) == 0 ? realpath(writer->path, NULL) : NULL;
    if (!resolved)
        return -1;
    free(writer->path);
    writer->path = resolved;
    int descriptor = create_temporary(writer->path, &writer->temporary);
    if (descriptor >= 0 && fchmod(descriptor, status.st_mode & 0777) != 0) {
        /* a file system without rights */
    }
    return descriptor;
}

static void release(FileWriter *writer)
{
    free(writer->path);
    forget(writer->temporary);
    free(writer->temporary);
    *writer = (FileWriter){0};
}

/* They last as long as the program. */
typedef struct Kept {
    char *place; /* without links */
    bool written;
} Kept;
static Kept *kept;
static size_t kept_count, kept_capacity;
static bool once;

static void keep(const char *path, bool written)
{
    void *places = kept;
    char *place = realpath(path, NULL);
    if (place && memory_grow(&places, &kept_capacity, kept_count + 1, sizeof *kept) == RESULT_OK) {
        kept = places;
        kept[kept_count++] = (Kept){place, written};
    } else {
        free(place);
    }
}

void file_keep(const char *path)
{
    struct stat status;
    if (stat(path, &status) == 0 && S_ISREG(status.st_mode)) /* a device takes both */
        keep(path, false);
}

void file_write_once(void)
{
    once = true;
}

Result file_check_kept(const char *path)
{
    char *place = kept_count ? realpath(path, NULL) : NULL;
    const Kept *found = NULL;
    for (size_t i = 0; place && i < kept_count; i++)
        if (strcmp(kept[i].place, place) == 0)
            found = &kept[i];
    free(place);
    if (!found)
        return RESULT_OK;
    return found->written ? result_fail(RESULT_BAD_INPUT,
                                        "%s: two outputs in one file, expected another name", path)
                          : result_fail(RESULT_BAD_INPUT,
                                        "%s: an input, expected another name for the output", path);
}

Result file_writer_open(const char *path, FileWriter *out)
{
    *out = (FileWriter){0};
    Result result = file_check_kept(path);
    if (result != RESULT_OK)
        return result;
    out->path = strdup(path);
    if (!out->path)
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory", path);
    int descriptor = open_target(out);
    if (descriptor >= 0) {
        out->stream = fdopen(descriptor, "wb");
        if (out->stream)
            return RESULT_OK;
    }
    int error = errno;
    if (descriptor >= 0)
        close(descriptor);
    if (out->temporary)
        unlink(out->temporary);
    release(out);
    return fail_write(path, error);
}

Result file_writer_standard(FileWriter *out)
{
    static const char name[] = "standard output";
    fflush(stdout);
    int descriptor = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
    *out = (FileWriter){.path = strdup(name)};
    if (out->path && descriptor >= 0)
        out->stream = fdopen(descriptor, "wb");
    if (out->stream)
        return RESULT_OK;
    int error = errno;
    if (descriptor >= 0)
        close(descriptor);
    release(out);
    return fail_write(name, error);
}

/* Keeps the first error. */
static Result note(FileWriter *writer, int error)
{
    if (!writer->error)
        writer->error = error ? error : EIO;
    return fail_write(writer->path, writer->error);
}

Result file_writer_put(FileWriter *writer, const void *data, size_t size)
{
    errno = 0;
    if (writer->error || (size && fwrite(data, 1, size, writer->stream) != size))
        return note(writer, errno);
    return RESULT_OK;
}

Result file_writer_print(FileWriter *writer, const char *format, ...)
{
    errno = 0;
    int printed = -1;
    if (!writer->error) {
        va_list arguments;
        va_start(arguments, format);
        printed = vfprintf(writer->stream, format, arguments);
        va_end(arguments);
    }
    return printed < 0 ? note(writer, errno) : RESULT_OK;
}

Result file_writer_put_at(FileWriter *writer, const void *data, size_t size, uint64_t offset)
{
    if (writer->error)
        return note(writer, 0);
    if (writer->shared)
        return note(writer, ESPIPE);
    const char *bytes = data;
    while (size) {
        ssize_t written = pwrite(fileno(writer->stream), bytes, size, (off_t)offset);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return note(writer, written < 0 ? errno : ENOSPC);
        bytes += written;
        size -= (size_t)written;
        offset += (uint64_t)written;
    }
    return RESULT_OK;
}

Result file_writer_close(FileWriter *writer, bool commit)
{
    if (!writer->stream)
        return RESULT_OK;
    Result result = RESULT_OK;
    errno = 0;
    if (fclose(writer->stream) != 0 && !writer->error)
        writer->error = errno ? errno : EIO;
    if (writer->temporary) {
        if (commit && !writer->error && rename(writer->temporary, writer->path) != 0)
            writer->error = errno;
        if (!commit || writer->error)
            unlink(writer->temporary);
    }
    if (commit && writer->error)
        result = fail_write(writer->path, writer->error);
    else if (commit && writer->temporary && once)
        keep(writer->path, true);
    release(writer);
    return result;
}

Result file_write(const char *path, const void *data, size_t size)
{
    FileWriter writer;
    Result result = file_writer_open(path, &writer);
    if (result != RESULT_OK)
        return result;
    file_writer_put(&writer, data, size);
    return file_writer_close(&writer, true);
}

Result file_make_directories(const char *path)
{
    char *partial = strdup(path);
    if (!partial)
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory", path);
    int error = *path ? 0 : ENOENT;
    for (char *end = partial; !error && *end;) {
        end += strspn(end, "/");
        end += strcspn(end, "/");
        char saved = *end;
        *end = 0;
        struct stat status;
        if (stat(partial, &status) == 0)
            error = S_ISDIR(status.st_mode) ? 0 : ENOTDIR;
        else if (mkdir(partial, 0777) != 0 && errno != EEXIST)
            error = errno;
        *end = saved;
    }
    free(partial);
    if (error)
        return result_fail(RESULT_IO, "%s: cannot make this directory: %s", path, strerror(error));
    return RESULT_OK;
}

/* A regular file, open, and its size. */
static Result open_regular(const char *path, FILE **out, uint64_t *size)
{
    struct stat info;
    /* Looked at before it is opened: opening a pipe would wait for its other end. */
    if (stat(path, &info))
        return result_fail(RESULT_IO, "%s: cannot read: %s", path, strerror(errno));
    if (!S_ISREG(info.st_mode))
        return result_fail(RESULT_BAD_INPUT, "%s: not a regular file", path);
    *size = (uint64_t)info.st_size;
    *out = fopen(path, "rb");
    return *out ? RESULT_OK : result_fail(RESULT_IO, "%s: cannot read: %s", path, strerror(errno));
}

Result file_load(const char *path, unsigned char **bytes, size_t *count)
{
    FILE *file = NULL;
    uint64_t size = 0;
    Result result = open_regular(path, &file, &size);
    if (result != RESULT_OK)
        return result;
    *bytes = NULL;
    if (size > UINT32_MAX)
        result = result_fail(RESULT_BAD_INPUT, "%s: larger than 4 GiB", path);
    *count = (size_t)size;
    if (result == RESULT_OK)
        *bytes = memory_array(*count + 1, 1);
    if (result == RESULT_OK && !*bytes)
        result = RESULT_NO_MEMORY;
    if (!result && fread(*bytes, 1, *count, file) != *count) {
        result = result_fail(RESULT_IO, "%s: cannot read all of its %zu bytes", path, *count);
        free(*bytes);
        *bytes = NULL;
    }
    (void)fclose(file);
    return result;
}

Result file_head(const char *path, void *bytes, size_t size, size_t *count)
{
    FILE *file = NULL;
    uint64_t all = 0;
    Result result = open_regular(path, &file, &all);
    if (result != RESULT_OK)
        return result;
    *count = fread(bytes, 1, size, file);
    (void)fclose(file);
    return RESULT_OK;
}

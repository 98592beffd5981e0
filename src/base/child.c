#define _GNU_SOURCE /* F_SETPIPE_SZ */
#include "base/child.h"

#include "base/clock.h"
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    PIPE_BYTES = 1 << 20 /* wished for: fewer turns between the two processes */
};

/* What a child says, before every record and as its last word. */
typedef enum Kind {
    KIND_RECORD = 0, /* size bytes follow */
    KIND_READS,      /* so do those of a path */
    KIND_WARNING,
    KIND_LIMITS,
    KIND_END
} Kind;

typedef struct Header {
    Kind kind;
    Result result;
    size_t size;
    ChildLimits limits;
    char message[1024];
} Header;

/* ---- in the child ---------------------------------------------------------------------------- */

static bool write_all(int pipe, const void *data, size_t size)
{
    const char *at = data;
    while (size > 0) {
        ssize_t written = write(pipe, at, size);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return false;
        at += written;
        size -= (size_t)written;
    }
    return true;
}

static Result put(int pipe, const Header *header, const void *record)
{
    if (write_all(pipe, header, sizeof *header) && write_all(pipe, record, header->size))
        return RESULT_OK;
    return result_fail(RESULT_IO, "child process: cannot write to its parent: %s", strerror(errno));
}

Result child_put(int pipe, const void *record, size_t size)
{
    const Header header = {.kind = KIND_RECORD, .size = size};
    return put(pipe, &header, record);
}

Result child_reads(int pipe, const char *path)
{
    const Header header = {.kind = KIND_READS, .size = strlen(path) + 1};
    return put(pipe, &header, path);
}

static void put_warning(void *context, const char *line)
{
    Header header = {.kind = KIND_WARNING};
    snprintf(header.message, sizeof header.message, "%s", line);
    put(*(const int *)context, &header, NULL);
}

/* Bytes of heap and private mappings that the process has; 0 where the system does not tell. */
static size_t data_bytes(void)
{
    char text[256] = "", *at = text;
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    bool read = file && fgets(text, sizeof text, file);
    for (int field = 0; read && field < 6; field++)
        pages = strtoul(at, &at, 10);
    if (file)
        (void)fclose(file);
    return pages * (size_t)sysconf(_SC_PAGESIZE);
}

/* A soft limit, which may rise again; 0: what the process began with. */
static void set_limit(int resource, rlim_t value)
{
    static struct rlimit first[RLIM_NLIMITS];
    struct rlimit limit = first[resource];
    if (limit.rlim_max == 0 && getrlimit(resource, &limit) == 0)
        first[resource] = limit;
    if (value && value < limit.rlim_cur)
        limit.rlim_cur = value;
    setrlimit(resource, &limit);
}

static void apply(const ChildLimits *limits)
{
    static size_t before;
    if (before == 0)
        before = data_bytes();
#ifndef CHILD_SANITIZED
    set_limit(RLIMIT_DATA, limits->memory ? before + limits->memory : 0);
#endif
    set_limit(RLIMIT_CPU, (rlim_t)ceil(limits->seconds));
}

Result child_limit(int pipe, const ChildLimits *limits)
{
    const Header header = {.kind = KIND_LIMITS, .limits = *limits};
    apply(limits);
    return put(pipe, &header, NULL);
}

/* The program's handlers are about its own files and terminal. What it ignores stays ignored, but
 * for what ends a child at its limit or without its parent. No core file is left. */
static void reset_signals(void)
{
    for (const int *number = file_ending_signals; *number; number++) {
        struct sigaction now;
        bool always = *number == SIGXCPU || *number == SIGPIPE;
        if (always || (sigaction(*number, NULL, &now) == 0 && now.sa_handler != SIG_IGN))
            signal(*number, SIG_DFL);
    }
    setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
}

static void be_quiet(void)
{
#ifndef CHILD_SANITIZED
    int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
#endif
}

static _Noreturn void be_child(const ChildWork *work, int pipe, pid_t parent)
{
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(EXIT_FAILURE);
    reset_signals();
    result_warnings_redirect(put_warning, &pipe);
    if (work->quiet)
        be_quiet();
    apply(&work->limits);
    Header header = {.kind = KIND_END, .result = work->run(work->context, pipe)};
    if (header.result != RESULT_OK)
        snprintf(header.message, sizeof header.message, "%s", result_message());
    fflush(stdout);
    _exit(put(pipe, &header, NULL) == RESULT_OK ? EXIT_SUCCESS : EXIT_FAILURE);
}

/* ---- in the parent --------------------------------------------------------------------------- */

typedef struct Child {
    const ChildWork *work;
    pid_t process;
    int pipe;
    ChildLimits limits;
    Clock start;
    bool late; /* it was waited for as long as may be */
} Child;

/* Whether there is something to read, or nothing will come. */
static bool wait_for(Child *child)
{
    for (;;) {
        double wall_ms, cpu_ms, left_ms = -1.0;
        if (child->limits.seconds > 0.0) {
            clock_elapsed(&child->start, &wall_ms, &cpu_ms);
            left_ms = 1e3 * CHILD_PATIENCE * child->limits.seconds - wall_ms;
            child->late = left_ms <= 0.0;
        }
        if (child->late)
            return false;
        struct pollfd ready = {.fd = child->pipe, .events = POLLIN};
        if (poll(&ready, 1, left_ms < 0.0 ? -1 : left_ms < 1e6 ? (int)left_ms + 1 : 1000000) > 0)
            return true;
    }
}

static bool read_all(Child *child, void *data, size_t size)
{
    char *at = data;
    while (size > 0) {
        if (!wait_for(child))
            return false;
        ssize_t got = read(child->pipe, at, size);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        at += got;
        size -= (size_t)got;
    }
    return true;
}

/* False without the whole record: *result is then a failure of the parent's, or OK. */
static bool take_record(Child *child, Kind kind, size_t size, Result *result)
{
    char *record = malloc(size ? size : 1);
    *result = RESULT_OK;
    if (!record)
        *result =
            result_fail(RESULT_NO_MEMORY, "out of memory: %zu bytes of a child process", size);
    bool taken = record && read_all(child, record, size);
    if (taken && kind == KIND_RECORD)
        child->work->take(child->work->take_context, record, size);
    else if (taken && size > 0 && record[size - 1] == '\0')
        file_keep(record);
    free(record);
    return taken;
}

/* Takes what the child says until its last word, or a failure of the parent's: *result. False when
 * the child ended before. */
static bool listen_to(Child *child, Result *result)
{
    Header header;
    while (read_all(child, &header, sizeof header)) {
        header.message[sizeof header.message - 1] = '\0';
        switch (header.kind) {
        case KIND_RECORD:
        case KIND_READS:
            if (!take_record(child, header.kind, header.size, result))
                return *result != RESULT_OK;
            break;
        case KIND_WARNING:
            result_warn("%s", header.message);
            break;
        case KIND_LIMITS:
            child->limits = header.limits;
            break;
        case KIND_END:
            *result = header.result ? result_fail(header.result, "%s", header.message) : RESULT_OK;
            return true;
        default: /* it has written over its own memory */
            return false;
        }
    }
    return false;
}

/* Or nobody is told how a child ended, and its number may be another's: a program may have begun
 * so. */
static void heed_children(void)
{
    struct sigaction now;
    if (sigaction(SIGCHLD, NULL, &now) == 0 && now.sa_handler == SIG_IGN)
        signal(SIGCHLD, SIG_DFL);
}

static Result start(const ChildWork *work, Child *child)
{
    int ends[2];
    pid_t parent = getpid();
    heed_children();
    *child = (Child){.work = work, .limits = work->limits, .start = clock_now()};
    fflush(stdout); /* or the child would print it again */
    if (pipe(ends) != 0)
        return result_fail(RESULT_IO, "child process: no pipe: %s", strerror(errno));
    fcntl(ends[1], F_SETPIPE_SZ, PIPE_BYTES);
    child->process = fork();
    if (child->process == 0) {
        close(ends[0]);
        be_child(work, ends[1], parent);
    }
    close(ends[1]);
    child->pipe = ends[0];
    if (child->process > 0)
        return RESULT_OK;
    close(ends[0]);
    return result_fail(RESULT_IO, "child process: cannot start: %s", strerror(errno));
}

static Result tell_end(const Child *child, int status)
{
    const char *name = child->work->name ? child->work->name : "child process";
    double seconds = child->limits.seconds;
    if (child->late)
        return result_fail(RESULT_BAD_INPUT, "%s took more than %g s", name,
                           CHILD_PATIENCE * seconds);
    if (seconds > 0.0 && WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
        return result_fail(RESULT_BAD_INPUT, "%s took more than %g s of processor time", name,
                           ceil(seconds));
    if (WIFSIGNALED(status))
        return result_fail(RESULT_INTERNAL, "%s ended by signal %d (%s)", name, WTERMSIG(status),
                           strsignal(WTERMSIG(status)));
    return result_fail(RESULT_INTERNAL, "%s ended without a result, exit code %d", name,
                       WEXITSTATUS(status));
}

Result child_run(const ChildWork *work)
{
    Child child;
    int status = 0;
    Result result = start(work, &child);
    if (result != RESULT_OK)
        return result;
    bool told = listen_to(&child, &result);
    close(child.pipe);
    if (!told || result != RESULT_OK)
        kill(child.process, SIGKILL); /* changes nothing for one that has ended */
    while (waitpid(child.process, &status, 0) < 0 && errno == EINTR)
        ;
    return told ? result : tell_end(&child, status);
}
